//! Hands what engines found over to the caller's columns, in parallel.
//!
//! Engines say what they found of a ray by its position in the batch: from a slice in the caller's
//! order, or through a table of places. Sixteen rays at a time are brought into columns and
//! written where they are nearer; where ids have to decide between equally near hits, one by one.
//! Ids come from ranks: hits of one object after another take a subtraction each.
//!
//! **Invariants.** Columns change as by [`Hits::offer`], ray by ray.
//!
//! **Cost.** 16 bytes a ray are read, columns that are absent cost nothing. With all columns, 1 to
//! 2 ns a ray and thread within the cache (AVX-512 server core).

use std::ops::Range;

use rayflock_geom::simd::{
    Bytes, LANES, Select, Simd, SimdBase, SimdMask, dispatch, f32x16, mask32x16, u32x16,
};
use rayflock_geom::{Hit, Hits};
use rayon::prelude::*;
use tracing::debug_span;

use crate::packet::{Nearest, Question};
use crate::primitives::{PrimitiveTable, RankedObject};

/// Rays that one task hands over at most.
const RAYS_PER_TASK: usize = 4096;

/// Offers the nearest hit of each ray of a batch, by its position.
pub(crate) fn offer_hits(
    table: &PrimitiveTable,
    nearest: impl Fn(usize) -> Nearest + Sync,
    hits: &mut Hits<'_>,
) {
    let _span = debug_span!("offer_hits").entered();
    offer_part(table, &nearest, 0, hits.reborrow());
}

/// Writes whether each ray is occluded, by its position.
pub(crate) fn tell_occluded(is_occluded: impl Fn(usize) -> bool + Sync, occluded: &mut [bool]) {
    let _span = debug_span!("tell_occluded").entered();
    occluded.par_chunks_mut(RAYS_PER_TASK).enumerate().for_each(|(task_idx, occluded)| {
        for (idx, occluded) in occluded.iter_mut().enumerate() {
            *occluded = is_occluded(task_idx * RAYS_PER_TASK + idx);
        }
    });
}

/// The caller's columns: what is asked, and where the answers go.
#[derive(Debug)]
pub(crate) enum AnswerColumns<'a> {
    Hits(Hits<'a>),
    Occluded(&'a mut [bool]),
}

impl<'a> AnswerColumns<'a> {
    pub(crate) const fn len(&self) -> usize {
        match self {
            Self::Hits(hits) => hits.len(),
            Self::Occluded(occluded) => occluded.len(),
        }
    }

    pub(crate) const fn question(&self) -> Question {
        match self {
            Self::Hits(_) => Question::Closest,
            Self::Occluded(_) => Question::Occluded,
        }
    }

    /// Beyond which `t` hits are of no interest, for each ray, if that is known.
    pub(crate) const fn t_bounds(&self) -> Option<&[f32]> {
        match self {
            Self::Hits(hits) => Some(hits.t),
            Self::Occluded(_) => None,
        }
    }

    /// The answers of the first rays, and those of the others.
    pub(crate) fn split_at(self, middle: usize) -> (Self, Self) {
        match self {
            Self::Hits(hits) => {
                let (left, right) = hits.split_at(middle);
                (Self::Hits(left), Self::Hits(right))
            }
            Self::Occluded(occluded) => {
                let (left, right) = occluded.split_at_mut(middle);
                (Self::Occluded(left), Self::Occluded(right))
            }
        }
    }

    /// Takes what was found, ray by ray.
    #[inline(always)]
    pub(crate) fn take<S: Simd>(self, simd: S, table: &'a PrimitiveTable, found: &[Nearest]) {
        match self {
            Self::Hits(hits) => {
                let mut receiver = Receiver { table, object: RankedObject::NONE, hits };
                receiver.take(simd, &|idx| found[idx], 0);
            }
            Self::Occluded(occluded) => {
                for (occluded, found) in occluded.iter_mut().zip(found) {
                    *occluded = !found.is_none();
                }
            }
        }
    }
}

/// Offers the hits of the rays from `first_ray` on.
fn offer_part(
    table: &PrimitiveTable,
    nearest: &(impl Fn(usize) -> Nearest + Sync),
    first_ray: usize,
    hits: Hits<'_>,
) {
    if hits.len() > RAYS_PER_TASK {
        // Parts of whole vectors.
        let middle = (hits.len() / 2).next_multiple_of(LANES);
        let (left, right) = hits.split_at(middle);
        rayon::join(
            || offer_part(table, nearest, first_ray, left),
            || offer_part(table, nearest, first_ray + middle, right),
        );
        return;
    }
    let mut receiver = Receiver { table, object: RankedObject::NONE, hits };
    dispatch!(table.simd().level(), simd => receiver.take(simd, nearest, first_ray));
}

/// The caller's columns for the rays of one task.
struct Receiver<'a> {
    table: &'a PrimitiveTable,
    /// The object that was hit last.
    object: RankedObject,
    hits: Hits<'a>,
}

impl Receiver<'_> {
    /// Takes the hits of all rays.
    #[inline(always)]
    fn take<S: Simd>(&mut self, simd: S, nearest: &impl Fn(usize) -> Nearest, first_ray: usize) {
        let whole = self.hits.len() / LANES * LANES;
        for start in (0..whole).step_by(LANES) {
            let mut found = [Nearest::NONE; LANES];
            for (lane, found) in found.iter_mut().enumerate() {
                *found = nearest(first_ray + start + lane);
            }
            self.take_lanes(simd, &found, start);
        }
        for idx in whole..self.hits.len() {
            self.take_one(idx, &nearest(first_ray + idx));
        }
    }

    /// Takes the hits of sixteen rays.
    #[inline(always)]
    fn take_lanes<S: Simd>(&mut self, simd: S, found: &[Nearest; LANES], start: usize) {
        let place = start..start + LANES;
        let [t, u, v, rank] = columns_of(simd, found);
        let t: f32x16<S> = t.bitcast();
        let t_here = f32x16::from_slice(simd, &self.hits.t[place.clone()]);
        let is_hit = !rank.simd_eq(u32x16::splat(simd, u32::MAX));
        let nearer = is_hit & t.simd_lt(t_here);
        if (is_hit & t.simd_eq(t_here)).any_true() {
            for (lane, found) in found.iter().enumerate() {
                self.take_one(start + lane, found);
            }
        } else if nearer.any_true() {
            nearer.select(t, t_here).store_slice(&mut self.hits.t[place.clone()]);
            self.write_uv(simd, [u, v], nearer, place.clone());
            self.write_ids(simd, rank, nearer, place);
        }
    }

    #[cold]
    fn take_one(&mut self, idx: usize, found: &Nearest) {
        if !found.is_none() {
            let (object_id, prim_id) = self.table.object_of_rank(found.rank).ids(found.rank);
            let Nearest { t, u, v, .. } = *found;
            self.hits.offer(idx, &Hit { t, u, v, object_id, prim_id });
        }
    }

    /// Writes the barycentric coordinates of the lanes in `nearer`, given as bits.
    #[inline(always)]
    fn write_uv<S: Simd>(
        &mut self,
        simd: S,
        [u, v]: [u32x16<S>; 2],
        nearer: mask32x16<S>,
        place: Range<usize>,
    ) {
        let Some(uv) = &mut self.hits.uv else { return };
        let (low, high) = uv[place].as_flattened_mut().split_at_mut(LANES);
        let here = f32x16::from_slice(simd, low).deinterleave(f32x16::from_slice(simd, high));
        let (u, v) = (nearer.select(u.bitcast(), here.0), nearer.select(v.bitcast(), here.1));
        let (first, second) = u.interleave(v);
        first.store_slice(low);
        second.store_slice(high);
    }

    /// Writes the ids of the lanes in `nearer`.
    #[inline(always)]
    fn write_ids<S: Simd>(
        &mut self,
        simd: S,
        rank: u32x16<S>,
        nearer: mask32x16<S>,
        place: Range<usize>,
    ) {
        if self.hits.object_id.is_none() && self.hits.prim_id.is_none() {
            return;
        }
        let [object_id, prim_id] = self.ids(simd, rank, nearer);
        let columns = [(&mut self.hits.object_id, object_id), (&mut self.hits.prim_id, prim_id)];
        for (column, ids) in columns {
            if let Some(column) = column {
                let column = &mut column[place.clone()];
                let here = u32x16::from_slice(simd, column);
                nearer.select(ids, here).store_slice(column);
            }
        }
    }

    /// Objects and primitives of the lanes in `nearer`.
    #[inline(always)]
    fn ids<S: Simd>(&mut self, simd: S, rank: u32x16<S>, nearer: mask32x16<S>) -> [u32x16<S>; 2] {
        let prim_id = rank - u32x16::splat(simd, self.object.first_rank);
        let elsewhere = nearer & prim_id.simd_ge(u32x16::splat(simd, self.object.prim_count));
        if !elsewhere.any_true() {
            return [u32x16::splat(simd, self.object.object_id.0), prim_id];
        }
        let (mut object_ids, mut prim_ids) = ([0; LANES], [0; LANES]);
        let mut remaining = nearer.to_bitmask();
        while remaining != 0 {
            let lane = remaining.trailing_zeros() as usize;
            remaining &= remaining - 1;
            self.object = self.table.object_of_rank(rank[lane]);
            let (object_id, prim_id) = self.object.ids(rank[lane]);
            (object_ids[lane], prim_ids[lane]) = (object_id.0, prim_id.0);
        }
        [u32x16::from_slice(simd, &object_ids), u32x16::from_slice(simd, &prim_ids)]
    }
}

/// Sixteen rows of four numbers as four columns: twice, what lies at even places comes before
/// what lies at odd ones.
#[inline(always)]
fn columns_of<S: Simd>(simd: S, found: &[Nearest; LANES]) -> [u32x16<S>; 4] {
    let words: &[u32] = bytemuck::cast_slice(found);
    let load = u32x16::from_slice;
    let (first, second) = (load(simd, &words[..16]), load(simd, &words[16..32]));
    let (third, fourth) = (load(simd, &words[32..48]), load(simd, &words[48..]));
    let ((even_0, odd_0), (even_1, odd_1)) =
        (first.deinterleave(second), third.deinterleave(fourth));
    let ((t, v), (u, rank)) = (even_0.deinterleave(even_1), odd_0.deinterleave(odd_1));
    [t, u, v, rank]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::Vec3;
    use rayflock_geom::simd::SimdLevel;
    use rayflock_geom::{
        FrameChanges, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, PrimId, Sphere,
    };
    use rayflock_testkit::Rng;

    use super::*;

    /// Objects of 1, 2, ... primitives, one without any among them, and all ids by rank.
    fn table(simd: SimdLevel) -> (PrimitiveTable, Vec<(ObjectId, PrimId)>) {
        let mesh = |count| Arc::new(Mesh::from_spheres(vec![Sphere::new(Vec3::ONE, 1.0); count]));
        let counts = [1, 2, 0, 40, 5, 300, 1];
        let objects = (3_u32..).step_by(2).map(ObjectId).zip(counts);
        let ids = objects
            .clone()
            .flat_map(|(id, count)| (0..count as u32).map(move |prim| (id, PrimId(prim))));
        let objects = objects.clone().map(|(id, count)| GeometryObject::new(id, mesh(count)));
        let mut table = PrimitiveTable::new(simd);
        table.commit(&Geometry::new(objects.collect()).unwrap(), &FrameChanges::all());
        (table, ids.collect())
    }

    /// Misses and hits of runs of neighbouring ranks, at few distances so that many are equal.
    fn random_nearest(rng: &mut Rng, len: usize, rank_count: usize) -> Vec<Nearest> {
        let mut rank = 0;
        let hit = |_| {
            rank = if rng.one_in(20) { rng.below(rank_count) } else { (rank + 1) % rank_count };
            let t = 1.0 + rng.below(3) as f32;
            let nearest = Nearest { t, u: rng.unit(), v: rng.unit(), rank: rank as u32 };
            if rng.one_in(3) { Nearest::NONE } else { nearest }
        };
        (0..len).map(hit).collect()
    }

    /// What other engines may have left: misses, hits at the same distances, NaN.
    fn random_hits(rng: &mut Rng, len: usize, is_fresh: bool) -> HitBuffer {
        let mut hits = HitBuffer::new(len);
        for idx in (0..len).filter(|_| !is_fresh) {
            hits.t[idx] = rng.pick(&[1.0, 2.0, 3.0, f32::INFINITY, f32::NAN, -1.0]);
            (hits.object_id[idx], hits.prim_id[idx]) = (rng.below(9) as u32, rng.below(40) as u32);
        }
        hits
    }

    /// All columns, or those whose bit is set.
    fn columns(hits: &mut HitBuffer, bits: usize) -> Hits<'_> {
        let mut hits = hits.as_hits();
        hits.uv = hits.uv.filter(|_| bits & 1 != 0);
        hits.object_id = hits.object_id.filter(|_| bits & 2 != 0);
        hits.prim_id = hits.prim_id.filter(|_| bits & 4 != 0);
        hits
    }

    fn bits(hits: &HitBuffer) -> Vec<[u32; 5]> {
        let uv = hits.uv.iter().map(|uv| uv.map(f32::to_bits));
        let ids = hits.object_id.iter().zip(&hits.prim_id);
        let rays = hits.t.iter().zip(uv).zip(ids);
        rays.map(|((t, [u, v]), (&object, &prim))| [t.to_bits(), u, v, object, prim]).collect()
    }

    #[test]
    fn columns_change_as_by_offering_ray_by_ray() {
        let mut rng = Rng::new(17);
        for simd in SimdLevel::available() {
            let (table, ids) = table(simd);
            for len in [0, 1, 15, 16, 17, 100, 3 * RAYS_PER_TASK + 5] {
                for bits_of_columns in 0..8 {
                    let nearest = random_nearest(&mut rng, len, ids.len());
                    let mut found = random_hits(&mut rng, len, bits_of_columns % 3 == 0);
                    let mut expected = found.clone();
                    let mut receiver = columns(&mut expected, bits_of_columns);
                    for (idx, nearest) in nearest.iter().enumerate() {
                        if let Some(&(object_id, prim_id)) = ids.get(nearest.rank as usize) {
                            let Nearest { t, u, v, .. } = *nearest;
                            receiver.offer(idx, &Hit { t, u, v, object_id, prim_id });
                        }
                    }
                    let mut receiver = columns(&mut found, bits_of_columns);
                    offer_hits(&table, |ray_idx| nearest[ray_idx], &mut receiver);
                    assert_eq!(bits(&found), bits(&expected), "{len} rays, {simd}");
                }
            }
        }
    }

    #[test]
    fn every_ray_is_told_whether_it_is_occluded() {
        for len in [0, 1, RAYS_PER_TASK + 1] {
            let mut occluded = vec![true; len];
            tell_occluded(|ray_idx| ray_idx % 3 == 0, &mut occluded);
            assert!((0..len).all(|ray_idx| occluded[ray_idx] == (ray_idx % 3 == 0)));
        }
    }
}
