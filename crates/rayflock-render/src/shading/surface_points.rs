//! What sixteen hits mean in the world: [`surface_point`], for triangles all at once.
//!
//! What a hit needs of its mesh is written down as a row; rows are brought into columns, and the
//! arithmetic is done on these. Other primitives are asked one by one.
//!
//! **Invariants.** The same bits as from [`surface_point`], at every level. (test)
//!
//! **Cost.** For sixteen triangles, about 250 operations, with four roots and divisions, where any
//! has normals, else 60; besides their rows, of about 60 operations each.

use std::mem::offset_of;
use std::ops::Range;

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use rayflock_geom::simd::{LANES, Lanes, Select, Simd, SimdBase, SimdMask, f32x16, mask32x16};
use rayflock_geom::{Hit, HitBuffer, PrimId, PrimKind, Ray, RayBatch};

use super::surface_point::{
    SLACK, SMOOTH_COS, SurfacePoint, attributes_of, corners_of, outward_normal, surface_point,
    vertex_normals,
};
use crate::frame_shading::{FrameShading, ShadedObject};
use crate::triple::{
    Triple, add, columns_at, dot, is_something, normalized_or_zero, scale, select, store, subtract,
    weighted,
};

/// What the point of a ray on a triangle depends on, in world space.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Row {
    corners: [Vec3; 3],
    /// Those of the vertices, of any length; zero where the mesh has none.
    normals: [Vec3; 3],
    /// Of the triangle, of unit length.
    outward: Vec3,
    /// Of the ray.
    direction: Vec3,
    /// Barycentric coordinates.
    uv: [f32; 2],
    /// Columns are read by three, and four scalars of each row at a time.
    padding: [f32; 2],
}

/// What up to sixteen rays hit.
#[derive(Debug)]
pub(crate) struct SurfacePoints<'a> {
    /// Objects and positions of the triangles that were hit.
    triangles: [Option<(&'a ShadedObject, usize)>; LANES],
    /// What is known of the triangles, the others being of no meaning.
    rows: [Row; LANES],
    columns: Columns,
    /// Points of other primitives.
    others: [Option<SurfacePoint>; LANES],
}

impl<'a> SurfacePoints<'a> {
    /// What `rays`, at most sixteen of `batch`, hit.
    #[inline(always)]
    pub(crate) fn new<S: Simd>(
        simd: S,
        frame: &'a FrameShading,
        (batch, hits): (&RayBatch<'_>, &HitBuffer),
        rays: Range<usize>,
    ) -> Self {
        let mut triangles = [None; LANES];
        let mut rows = [Row::zeroed(); LANES];
        let mut others = [None; LANES];
        for (lane, ray_idx) in rays.enumerate().take(LANES) {
            let (ray, hit) = (batch.ray(ray_idx), hits.get(ray_idx));
            let Some(object) = frame.object(hit.object_id) else { continue };
            if let PrimKind::Triangle(triangle_idx) = object.surface.mesh.prim_kind(hit.prim_id) {
                rows[lane] = Row::new(object, triangle_idx, &ray, &hit);
                triangles[lane] = Some((object, triangle_idx));
            } else {
                others[lane] = surface_point(frame, &ray, &hit);
            }
        }
        let columns = Columns::new(simd, &rows);
        Self { triangles, rows, columns, others }
    }

    /// The point that ray `lane` of them hit; `None` for a miss.
    #[inline(always)]
    pub(crate) fn get(&self, lane: usize) -> Option<SurfacePoint> {
        let Some((object, triangle_idx)) = self.triangles[lane] else {
            return self.others[lane];
        };
        let of =
            |columns: &[Lanes; 3]| Vec3::new(columns[0][lane], columns[1][lane], columns[2][lane]);
        let columns = &self.columns;
        let [u, v] = self.rows[lane].uv;
        let (uv, tint) = attributes_of(object, triangle_idx, [1.0 - u - v, u, v]);
        Some(SurfacePoint {
            position: of(&columns.position),
            shadow_position: of(&columns.shadow_position),
            facet_normal: of(&columns.facet_normal),
            normal: of(&columns.normal),
            from_outside: columns.from_outside >> lane & 1 == 1,
            slack: columns.slack[lane],
            uv,
            tint,
            // Triangles come first among the primitives.
            material: object.surface.attributes.materials.get(PrimId(triangle_idx as u32)),
        })
    }
}

impl Row {
    #[inline(always)]
    fn new(object: &ShadedObject, triangle_idx: usize, ray: &Ray, hit: &Hit) -> Self {
        let corners = corners_of(object, triangle_idx);
        Self {
            corners,
            normals: vertex_normals(object, triangle_idx).unwrap_or([Vec3::ZERO; 3]),
            outward: outward_normal(object, corners),
            direction: ray.direction,
            uv: [hit.u, hit.v],
            padding: [0.0; 2],
        }
    }
}

/// What is found of sixteen triangles; see [`SurfacePoint`].
#[derive(Clone, Copy, Debug)]
#[repr(C, align(64))]
struct Columns {
    position: [Lanes; 3],
    shadow_position: [Lanes; 3],
    facet_normal: [Lanes; 3],
    normal: [Lanes; 3],
    slack: Lanes,
    /// A bit for each lane.
    from_outside: u64,
}

impl Columns {
    #[inline(always)]
    fn new<S: Simd>(simd: S, rows: &[Row; LANES]) -> Self {
        let corners = triples_at(simd, rows, offset_of!(Row, corners));
        let direction = columns_at(simd, rows, offset_of!(Row, direction));
        let [u, v, _] = columns_at(simd, rows, offset_of!(Row, uv));
        let shares = [f32x16::splat(simd, 1.0) - u - v, u, v];
        let position = weighted(&corners, &shares);

        // Turn the normal to the viewer, and step off the surface.
        let outward = columns_at(simd, rows, offset_of!(Row, outward));
        let from_outside = dot(outward, direction).simd_le(f32x16::splat(simd, 0.0));
        let facet_normal = scale(&outward, sign(simd, from_outside));
        let slack = slack(simd, &corners);
        let mut found = Smooth {
            normal: facet_normal,
            shadow_position: add(&position, &scale(&facet_normal, slack)),
        };
        let normals = triples_at(simd, rows, offset_of!(Row, normals));
        found.smooth(simd, (&corners, &normals), &shares, &position);

        let mut columns = Self {
            position: [[0.0; LANES]; 3],
            shadow_position: [[0.0; LANES]; 3],
            facet_normal: [[0.0; LANES]; 3],
            normal: [[0.0; LANES]; 3],
            slack: *slack,
            from_outside: from_outside.to_bitmask(),
        };
        store(&position, &mut columns.position);
        store(&found.shadow_position, &mut columns.shadow_position);
        store(&facet_normal, &mut columns.facet_normal);
        store(&found.normal, &mut columns.normal);
        columns
    }
}

/// What normals of vertices change.
struct Smooth<S: Simd> {
    normal: Triple<S>,
    shadow_position: Triple<S>,
}

impl<S: Simd> Smooth<S> {
    /// Takes the shading normals from those of the vertices, where there are any.
    #[inline(always)]
    fn smooth(
        &mut self,
        simd: S,
        (corners, normals): (&[Triple<S>; 3], &[Triple<S>; 3]),
        shares: &Triple<S>,
        position: &Triple<S>,
    ) {
        let facet_normal = self.normal;
        let (zero, smooth_cos) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, SMOOTH_COS));
        let mut units = [
            normalized_or_zero(simd, &normals[0]),
            normalized_or_zero(simd, &normals[1]),
            normalized_or_zero(simd, &normals[2]),
        ];
        let normal = normalized_or_zero(simd, &weighted(&units, shares));
        let is_smooth = is_something(simd, &normal);
        if !is_smooth.any_true() {
            return;
        }
        let side = sign(simd, !dot(normal, facet_normal).simd_lt(zero));
        select(is_smooth, &mut self.normal, &scale(&normal, side));

        let mut is_lifted = is_smooth;
        let mut lifts = [[zero; 3]; 3];
        for ((unit, corner), lift) in units.iter_mut().zip(corners).zip(&mut lifts) {
            *unit = scale(unit, side);
            is_lifted &= dot(*unit, facet_normal).simd_gt(smooth_cos);
            *lift = scale(unit, dot(subtract(*corner, *position), *unit).max(zero));
        }
        let lifted = add(&self.shadow_position, &weighted(&lifts, shares));
        select(is_lifted, &mut self.shadow_position, &lifted);
    }
}

/// 1 where `is_positive`, else -1.
#[inline(always)]
fn sign<S: Simd>(simd: S, is_positive: mask32x16<S>) -> f32x16<S> {
    is_positive.select(f32x16::splat(simd, 1.0), f32x16::splat(simd, -1.0))
}

/// How far off their surface rays start.
#[inline(always)]
fn slack<S: Simd>(simd: S, corners: &[Triple<S>; 3]) -> f32x16<S> {
    let mut largest = f32x16::splat(simd, f32::MIN_POSITIVE);
    for corner in corners {
        for coordinate in corner {
            largest = largest.max(coordinate.abs());
        }
    }
    largest * f32x16::splat(simd, SLACK)
}

/// Three times three columns.
#[inline(always)]
fn triples_at<S: Simd>(simd: S, rows: &[Row; LANES], offset: usize) -> [Triple<S>; 3] {
    [
        columns_at(simd, rows, offset),
        columns_at(simd, rows, offset + size_of::<Vec3>()),
        columns_at(simd, rows, offset + 2 * size_of::<Vec3>()),
    ]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use rayflock_geom::simd::{SimdLevel, dispatch};
    use rayflock_geom::{Geometry, NO_ID};
    use rayflock_scene::{Evaluator, builtin};

    use super::*;
    use crate::shading::sampling::PathSeed;

    /// Rays and what they hit, anywhere on the objects of `geometry`; some miss.
    fn hits_on(geometry: &Geometry, count: usize) -> (Vec<Vec3>, HitBuffer) {
        let (mut directions, mut hits) = (Vec::new(), HitBuffer::new(count));
        for ray_idx in 0..count {
            let random = |set| PathSeed::of_walks(2).unit_4_cube(ray_idx as u32, set);
            let ([x, y, z, t], [object, prim, u, v]) = (random(0), random(1));
            directions.push(2.0 * Vec3::new(x, y, z) - 1.0);
            let objects = geometry.objects();
            let object = &objects[(object * objects.len() as f32) as usize];
            let prim_count = object.shape.prim_count() as f32;
            let is_hit = !ray_idx.is_multiple_of(9);
            hits.t[ray_idx] = if is_hit { t } else { f32::INFINITY };
            hits.uv[ray_idx] = [u, v * (1.0 - u)];
            hits.object_id[ray_idx] = if is_hit { object.id.0 } else { NO_ID };
            hits.prim_id[ray_idx] = if is_hit { (prim * prim_count) as u32 } else { NO_ID };
        }
        (directions, hits)
    }

    #[test]
    fn lanes_are_what_one_hit_after_another_means() {
        for name in ["museum4", "cornell", "stadium"] {
            let scene = Arc::new(builtin::build(name).unwrap());
            let mut evaluator = Evaluator::new(Arc::clone(&scene), None).unwrap();
            let frame = evaluator.evaluate(0.3).unwrap();
            let shading = FrameShading::unlit(&scene, frame).unwrap();
            let (directions, hits) = hits_on(&frame.geometry, 1000);
            let batch = RayBatch::new(Vec3::new(0.3, 1.0, 0.2), &directions).unwrap();
            let one = |ray_idx| surface_point(&shading, &batch.ray(ray_idx), &hits.get(ray_idx));
            for level in SimdLevel::available() {
                for start in (0..hits.len()).step_by(LANES) {
                    let rays = start..hits.len().min(start + LANES);
                    let found = dispatch!(level.level(), simd => {
                        SurfacePoints::new(simd, &shading, (&batch, &hits), rays.clone())
                    });
                    for (lane, ray_idx) in rays.enumerate() {
                        assert_eq!(found.get(lane), one(ray_idx), "{name} {level}");
                    }
                }
            }
        }
    }
}
