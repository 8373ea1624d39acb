//! What stages of the device compute, on the CPU and written for reading: their definition, and
//! what tests compare them with.
//!
//! Functions have the names of the files in `shader/`; [`TWINS`] says for each stage where its
//! definition is, or why it has none.

mod gather_lights;

use glam::{DVec2, Vec3};

pub(crate) use self::gather_lights::{InTheWay, LitPoint, gather_lights};
use crate::layout::{Cone, DevicePrimitive, DeviceRay, SPHERE, TileRange};
use crate::sort_rays::octahedral;

/// Where the definition of a stage is.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Twin {
    /// In this module, under the stage's name.
    Here,
    /// Elsewhere, for this reason.
    Elsewhere(&'static str),
}

const BY_ANSWER: &str = "what it finds is compared with the engine `brute` of the CPU and judged by \
                         the oracle (tests/suite/agreement.rs)";

const BY_PICTURE: &str = "the stage of this name of the renderer on the CPU (rayflock-render); pictures of \
                          both are compared (tests/suite/frames.rs)";

const BY_TRACING: &str = "rays from the camera hit what the stages of gpu:compute find for the \
                          same rays (src/frame/scan/tests.rs)";

const BY_EVALUATOR: &str = "the frames of `Evaluator` (rayflock-scene), written by the host; what the \
                            device writes is compared with it (src/frame/deform/tests.rs)";

/// Every stage.
pub(crate) const TWINS: &[(&str, Twin)] = &[
    ("brute/cross", Twin::Elsewhere(BY_ANSWER)),
    ("raster/bound_primitives", Twin::Here),
    (
        "raster/bound_tiles",
        Twin::Elsewhere(
            "`bound_tiles` over rays in textures; what it rejects wrongly is missed by raster/trace_tile",
        ),
    ),
    ("raster/trace_tile", Twin::Elsewhere(BY_ANSWER)),
    ("shared/bound_scene", Twin::Here),
    ("compute/count_cells", Twin::Here),
    (
        "compute/sum_cells",
        Twin::Elsewhere("sums that `place_cells` adds up; the test of that one has several groups"),
    ),
    ("compute/place_cells", Twin::Here),
    (
        "compute/order_primitives",
        Twin::Elsewhere(
            "each to its place; the test of `place_cells` finds each once, where its cell is",
        ),
    ),
    (
        "compute/size_chunks",
        Twin::Elsewhere("two sums; its test has orders of which either is better"),
    ),
    ("compute/take_order", Twin::Elsewhere("a copy; as for `size_chunks`")),
    ("compute/bound_chunks", Twin::Here),
    ("compute/bound_blocks", Twin::Here),
    ("compute/bound_tiles", Twin::Here),
    (
        "compute/bound_nodes",
        Twin::Elsewhere("any cone around the children will do; `refine` compares what comes of it"),
    ),
    ("compute/seed_pairs", Twin::Elsewhere("the first level of `refine`")),
    (
        "compute/plan_dispatch",
        Twin::Elsewhere("a division; too few workgroups leave blocks out of `fill_lists`"),
    ),
    ("compute/refine", Twin::Here),
    ("compute/plan_lists", Twin::Here),
    ("compute/fill_lists", Twin::Elsewhere("the lists that `refine` makes")),
    ("compute/trace_tile", Twin::Elsewhere(BY_ANSWER)),
    ("subfields/mark_directions", Twin::Here),
    (
        "subfields/open_subfields",
        Twin::Elsewhere("any frame and any window will do that `write_tiles` agrees with"),
    ),
    ("subfields/write_tiles", Twin::Here),
    (
        "subfields/place_tiles",
        Twin::Elsewhere("the tests of `write_tiles` find each entry in a place of its own"),
    ),
    ("subfields/trace_rays", Twin::Elsewhere(BY_ANSWER)),
    ("frame/camera_rays", Twin::Elsewhere(BY_PICTURE)),
    ("frame/scan_primitives", Twin::Elsewhere(BY_TRACING)),
    ("frame/take_scanned", Twin::Elsewhere(BY_TRACING)),
    ("frame/count_rays", Twin::Here),
    (
        "frame/order_wave",
        Twin::Elsewhere(
            "each to its place; the test of `count_rays` finds each once, where its key is",
        ),
    ),
    ("frame/shade_surface", Twin::Elsewhere(BY_PICTURE)),
    (
        "frame/add_emitted",
        Twin::Elsewhere(
            "the stage `accumulate` of the renderer, as far as it needs no shadow rays",
        ),
    ),
    ("frame/shadow_rays", Twin::Elsewhere(BY_PICTURE)),
    (
        "frame/add_lit",
        Twin::Elsewhere("the stage `accumulate` of the renderer, for what shadow rays decide"),
    ),
    ("frame/deform_vertices", Twin::Elsewhere(BY_EVALUATOR)),
    ("frame/write_triangles", Twin::Elsewhere(BY_EVALUATOR)),
    ("frame/gather_lights", Twin::Here),
    (
        "frame/leave_photons",
        Twin::Elsewhere("the renderer's caustics/shoot; pictures of both are compared"),
    ),
    (
        "frame/sort_photons",
        Twin::Elsewhere(
            "each photon is found once, where its bucket lies (src/frame/photons/tests.rs)",
        ),
    ),
    (
        "frame/place_photons",
        Twin::Elsewhere("the test of `sort_photons` finds each bucket in a place of its own"),
    ),
    (
        "frame/gather_photons",
        Twin::Elsewhere("the renderer's caustics/gather; pictures of both are compared"),
    ),
];

/// A sphere: centre and radius; a negative radius where there is nothing.
pub(crate) type DeviceSphere = [f32; 4];

/// The sphere around a primitive.
pub(crate) fn bound_primitives(prim: &DevicePrimitive) -> DeviceSphere {
    let [a, b, c] = [prim.a, prim.b, prim.c].map(Vec3::from);
    if prim.mask == 0 {
        return with_radius(a, -1.0);
    }
    if prim.kind == SPHERE {
        return with_radius(a, b.x);
    }
    let center = 0.5 * a.min(b).min(c) + 0.5 * a.max(b).max(c);
    let radius = [a, b, c].map(|corner| corner.distance(center)).into_iter().fold(0.0, f32::max);
    with_radius(center, radius)
}

/// The sphere around a chunk of primitives.
pub(crate) fn bound_chunks(prims: &[DevicePrimitive]) -> DeviceSphere {
    around(prims.iter().map(bound_primitives))
}

/// The sphere around a block of chunks.
pub(crate) fn bound_blocks(chunks: &[DeviceSphere]) -> DeviceSphere {
    around(chunks.iter().copied())
}

fn around(spheres: impl Iterator<Item = DeviceSphere> + Clone) -> DeviceSphere {
    let spheres = spheres.filter(|sphere| sphere[3] >= 0.0);
    let centers = spheres.clone().map(center);
    let low = centers.clone().fold(Vec3::INFINITY, Vec3::min);
    let high = centers.fold(Vec3::NEG_INFINITY, Vec3::max);
    let middle = 0.5 * low + 0.5 * high;
    let reach = spheres.map(|sphere| center(sphere).distance(middle) + sphere[3]);
    with_radius(middle, reach.fold(-1.0, f32::max))
}

/// The cone around the rays of a tile; the sine is 2 around all directions, -1 around no ray.
pub(crate) fn bound_tiles(rays: &[DeviceRay]) -> Cone {
    let active = rays.iter().filter(|ray| ray.is_active());
    let origins = active.clone().map(|ray| Vec3::from(ray.origin));
    let units = active.clone().map(|ray| Vec3::from(ray.direction).normalize());
    let low = origins.clone().fold(Vec3::INFINITY, Vec3::min);
    let high = origins.clone().fold(Vec3::NEG_INFINITY, Vec3::max);
    if low.x > high.x {
        return Cone { center: [0.0; 3], radius: 0.0, axis: [0.0, 0.0, 1.0], sin: -1.0 };
    }
    let middle = 0.5 * low + 0.5 * high;
    let axis = units.clone().sum::<Vec3>().normalize_or(Vec3::Z);
    let radius = origins.map(|origin| origin.distance(middle)).fold(0.0, f32::max);
    let cos = units.clone().map(|unit| unit.dot(axis)).fold(1.0, f32::min);
    let sin = units.map(|unit| (unit - unit.dot(axis) * axis).length()).fold(0.0, f32::max);
    let is_bounded = cos >= 0.05 && sin < 0.998;
    let reaches_behind = active.clone().any(|ray| ray.t_min < 0.0);
    let (center, axis) = (middle.to_array(), axis.to_array());
    if reaches_behind {
        return Cone { center, radius: 1e30, axis, sin: 2.0 };
    }
    Cone { center, radius, axis, sin: if is_bounded { sin } else { 2.0 } }
}

/// How far a sphere is from being touched by a cone, over the distances at work: not above 0 where
/// it is touched. A list holds the blocks of which the cone of its tile says
/// so, unless that bounds nothing.
pub(crate) fn refine(cone: &Cone, sphere: DeviceSphere) -> f32 {
    if cone.sin < 0.0 || sphere[3] < 0.0 {
        return f32::INFINITY;
    }
    if cone.sin > 1.0 {
        return f32::NEG_INFINITY;
    }
    let (v, axis) = (center(sphere) - Vec3::from(cone.center), Vec3::from(cone.axis));
    let radii = cone.radius + sphere[3];
    let along = v.dot(axis);
    let across = (v - along * axis).length();
    let cos = (1.0 - cone.sin * cone.sin).sqrt();
    let apart = (across * cos - along * cone.sin).max(-along) - radii;
    apart / (v.abs().element_sum() + radii)
}

/// Where the list of each tile begins, from how many blocks each has.
pub(crate) fn plan_lists(counts: &[u32]) -> Vec<TileRange> {
    let mut end = 0;
    let place = |&count: &u32| {
        let first = end;
        end += count;
        TileRange { first, count }
    };
    counts.iter().map(place).collect()
}

/// The box around the primitives that rays may see: least and largest coordinates.
pub(crate) fn bound_scene(prims: &[DevicePrimitive]) -> [Vec3; 2] {
    let reach = |prim: &DevicePrimitive| {
        let [a, b, c] = [prim.a, prim.b, prim.c].map(Vec3::from);
        if prim.kind == SPHERE { [a - b.x, a + b.x] } else { [a.min(b).min(c), a.max(b).max(c)] }
    };
    let seen = prims.iter().filter(|prim| prim.mask != 0).map(reach);
    let nothing = [Vec3::INFINITY, Vec3::NEG_INFINITY];
    seen.fold(nothing, |[low, high], [a, b]| [low.min(a), high.max(b)])
}

/// The cell of a primitive in a scene between these corners, and how far its place on the finest
/// level that it may be on is from another one, in cells.
pub(crate) fn count_cells(
    prim: &DevicePrimitive,
    [low, high]: [Vec3; 2],
    finest: u32,
) -> (u32, f32) {
    let [x, y, z, radius] = bound_primitives(prim);
    let edge = (high - low).max_element();
    let level = (edge / (2.0 * radius)).log2().clamp(0.0, finest as f32);
    let place = (Vec3::new(x, y, z) - low) / edge * f32::from(1_u16 << level as u32);
    let cell = place.as_uvec3().min(glam::UVec3::splat((1 << level as u32) - 1));
    let bits = (0..10).map(|bit| {
        let of_axis = |axis: usize| (cell[axis] >> bit & 1) << (3 * bit + axis as u32);
        of_axis(0) | of_axis(1) | of_axis(2)
    });
    let code: u32 = bits.sum();
    let first_of_level = ((1 << (3 * level as u32)) - 1) / 7;
    let margin = (place - place.round()).abs().min_element().min((level - level.round()).abs());
    (first_of_level + code, margin)
}

/// Among 2^`bits` cells along each side, those of a ray's origin in a scene between these corners and
/// of its direction, as places: the key has their bits.
pub(crate) fn count_rays(ray: &DeviceRay, [low, high]: [Vec3; 2], bits: u32) -> [f32; 5] {
    let origin = (Vec3::from(ray.origin) - low) / (high - low).max_element();
    let direction = octahedral(Vec3::from(ray.direction)).map(|place| 0.5 * place + 0.5);
    let cells = (1_u32 << bits) as f32;
    let places = [origin.x, origin.y, origin.z, direction[0], direction[1]];
    places.map(|place| (place * cells).clamp(0.0, cells - 1.0))
}

/// How many entries there are before each, given counts.
pub(crate) fn place_cells(counts: &[u32]) -> Vec<u32> {
    let before = |sum: &mut u32, count: &u32| {
        *sum += count;
        Some(*sum - count)
    };
    counts.iter().scan(0, before).collect()
}

/// Where a direction lies among `edge` x `edge` cells of the unfolded hemisphere: column and row.
pub(crate) fn mark_directions(direction: Vec3, edge: u32) -> [f32; 2] {
    let upward = if direction.z < 0.0 { -direction } else { direction };
    let scaled = upward / upward.abs().max_element();
    let flat = scaled / scaled.abs().element_sum();
    [flat.x + flat.y, flat.x - flat.y].map(|place| 0.5 * edge as f32 * (place + 1.0))
}

/// How far a primitive is from touching a square tile with this middle, in tiles: not above 0 where
/// it is touched. The tile lists the primitives of which that is so. Seen along the direction of the
/// subfield, the primitive is a triangle with these corners or, if it is a sphere, an ellipse with
/// the first for its centre and the second for its half axes.
pub(crate) fn write_tiles(prim: &DevicePrimitive, places: [DVec2; 3], middle: DVec2) -> f64 {
    if prim.kind == SPHERE {
        let [center, axes, _] = places;
        let apart = ((center - middle).abs() - 0.5).max(DVec2::ZERO);
        return ((apart / axes).length() - 1.0) * axes.min_element();
    }
    let corners = places.map(|place| place - middle);
    let [a, b, c] = corners;
    let edges = [b - a, c - b, a - c].map(|edge| edge.perp().normalize_or_zero());
    let apart = |axis: DVec2| {
        let along = corners.map(|corner| corner.dot(axis));
        let [low, high] = [f64::min, f64::max].map(|pick| along.into_iter().reduce(pick));
        let reach = 0.5 * axis.abs().element_sum();
        low.zip(high).map_or(0.0, |(low, high)| low.max(-high) - reach)
    };
    edges.into_iter().chain([DVec2::X, DVec2::Y]).map(apart).fold(f64::NEG_INFINITY, f64::max)
}

fn center([x, y, z, _]: DeviceSphere) -> Vec3 {
    Vec3::new(x, y, z)
}

fn with_radius(center: Vec3, radius: f32) -> DeviceSphere {
    [center.x, center.y, center.z, radius]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::shaders::ALL;

    #[test]
    fn every_stage_has_a_definition_or_a_reason() {
        let mut stages: Vec<_> = ALL.iter().map(|shader| shader.name).collect();
        // Some stages have several forms.
        stages.dedup();
        let told: Vec<_> = TWINS.iter().map(|(name, _)| *name).collect();
        assert_eq!(told, stages);
        for (name, twin) in TWINS {
            if let Twin::Elsewhere(reason) = twin {
                assert!(!reason.is_empty(), "{name}");
            }
        }
    }
}
