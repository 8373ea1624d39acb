//! Hands converted rays to Embree: what its users would do, and all that is charged to it.
//!
//! Tasks of about a thousand rays on the current rayon pool. Packets lie on the stack; of a
//! packet's hit only what Embree reads is initialised each time.

use rayon::prelude::*;

use super::ffi::{DenormalsAreZero, Tracer};
use super::layout::{self, Arguments, INVALID_ID, Ray16, RayHit, RayHit16, Valid, WIDTH};
use super::rays::{CHUNK, Found, FoundBlock, RayBlock};

/// Finds the nearest hits, one ray at a time; `found.len() == rays.len()`.
pub(super) fn closest_singles(
    tracer: Tracer<'_>,
    arguments: &Arguments,
    rays: &[layout::Ray],
    found: &mut [Found],
) {
    let chunks = rays.par_chunks(CHUNK).zip(found.par_chunks_mut(CHUNK));
    chunks.for_each(|(rays, found)| {
        let _guard = DenormalsAreZero::new();
        let mut hit = RayHit::default();
        for (ray, found) in rays.iter().zip(found) {
            (hit.ray, hit.geom_id, hit.inst_id) = (*ray, INVALID_ID, INVALID_ID);
            if ray.t_near <= ray.t_far {
                tracer.intersect(&mut hit, arguments);
            }
            let RayHit { u, v, geom_id, prim_id, .. } = hit;
            *found = Found { t: hit.ray.t_far, u, v, geom_id, prim_id };
        }
    });
}

/// Finds the nearest hits, sixteen rays at a time; `found.len() == blocks.len()`.
pub(super) fn closest_packets(
    tracer: Tracer<'_>,
    arguments: &Arguments,
    blocks: &[RayBlock],
    found: &mut [FoundBlock],
) {
    let chunks = blocks.par_chunks(CHUNK / WIDTH).zip(found.par_chunks_mut(CHUNK / WIDTH));
    chunks.for_each(|(blocks, found)| {
        let _guard = DenormalsAreZero::new();
        let mut packet = RayHit16::default();
        for (block, found) in blocks.iter().zip(found) {
            load(block, &mut packet.ray);
            packet.geom_id = [INVALID_ID; WIDTH];
            packet.inst_id = [INVALID_ID; WIDTH];
            tracer.intersect_16(&valid(block), &mut packet, arguments);
            let RayHit16 { u, v, geom_id, prim_id, .. } = packet;
            *found = FoundBlock { t: packet.ray.t_far, u, v, geom_id, prim_id };
        }
    });
}

/// Finds out whether anything is hit, one ray at a time; `occluded.len() == rays.len()`.
pub(super) fn occluded_singles(
    tracer: Tracer<'_>,
    arguments: &Arguments,
    rays: &[layout::Ray],
    occluded: &mut [bool],
) {
    let chunks = rays.par_chunks(CHUNK).zip(occluded.par_chunks_mut(CHUNK));
    chunks.for_each(|(rays, occluded)| {
        let _guard = DenormalsAreZero::new();
        for (ray, occluded) in rays.iter().zip(occluded) {
            let mut traced = *ray;
            if ray.t_near <= ray.t_far {
                tracer.occluded(&mut traced, arguments);
            }
            *occluded = traced.t_far == f32::NEG_INFINITY;
        }
    });
}

/// Finds out whether anything is hit, sixteen rays at a time; the last block holds the rays that
/// are left, `occluded.len().div_ceil(16) == blocks.len()`.
pub(super) fn occluded_packets(
    tracer: Tracer<'_>,
    arguments: &Arguments,
    blocks: &[RayBlock],
    occluded: &mut [bool],
) {
    let chunks = blocks.par_chunks(CHUNK / WIDTH).zip(occluded.par_chunks_mut(CHUNK));
    chunks.for_each(|(blocks, occluded)| {
        let _guard = DenormalsAreZero::new();
        let mut packet = Ray16::default();
        for (block, occluded) in blocks.iter().zip(occluded.chunks_mut(WIDTH)) {
            load(block, &mut packet);
            tracer.occluded_16(&valid(block), &mut packet, arguments);
            for (occluded, t_far) in occluded.iter_mut().zip(packet.t_far) {
                *occluded = t_far == f32::NEG_INFINITY;
            }
        }
    });
}

#[inline(always)]
fn load(block: &RayBlock, packet: &mut Ray16) {
    packet.org = block.org;
    packet.dir = block.dir;
    packet.t_near = block.t_near;
    packet.t_far = block.t_far;
    packet.mask = block.mask;
}

#[inline(always)]
fn valid(block: &RayBlock) -> Valid {
    let mut valid = [0; WIDTH];
    for (valid, (t_near, t_far)) in valid.iter_mut().zip(block.t_near.iter().zip(&block.t_far)) {
        *valid = -i32::from(t_near <= t_far);
    }
    Valid(valid)
}
