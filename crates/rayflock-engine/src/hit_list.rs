//! All hits of each ray, from near to far.
//!
//! The closest hit of all rays is asked for again and again, each time beyond the hit before, for
//! the rays that still had one. Any engine of this crate serves: hits are asked for at exactly the
//! distance that another engine found, and distances of engines on the graphics card are not the
//! same in every bit. Rays keep their order and what they share.
//!
//! An object is met once at one distance: a ray through the common edge of two triangles of a mesh
//! crosses its surface there once, which is what counting is for. Surfaces of different objects at
//! the same distance are all listed. The closest hit names the lowest object alone, so where there
//! are several objects, an engine that holds them in reversed order tells which rays have more than
//! one, and those rays ask every object for itself.
//!
//! **Cost.** A batch for each hit of the ray that has most. Where there are several objects, twice
//! that, and a commit of all of them, reversed, in every call; a commit of each object whenever
//! surfaces of two coincide.

use glam::Vec3;
use rayflock_geom::{
    Column, ColumnElement, FrameChanges, Geometry, GeometryObject, Hit, HitBuffer, NO_ID, ObjectId,
    RayBatch, RayOrder,
};

use crate::{EngineError, EngineKind, RayEngine, TraceStats, create};

/// All hits of a batch, those of the first ray first, from near to far.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitList {
    /// The hits of ray `i` are those from `splits[i]` to `splits[i + 1]`; one entry more than rays.
    pub splits: Vec<usize>,
    /// The ray of each hit.
    pub ray_idx: Vec<usize>,
    /// What was hit.
    pub hits: HitBuffer,
}

/// Lists all hits of `rays` in `geometry`, which is the current frame of `engine`.
///
/// # Errors
/// [`EngineError`] when an engine cannot hold the geometry: not those of this crate.
pub fn list_hits(
    engine: &mut dyn RayEngine,
    geometry: &Geometry,
    rays: &RayBatch<'_>,
) -> Result<(HitList, TraceStats), EngineError> {
    let several_objects = geometry.objects().len() > 1;
    let mut others = several_objects.then(|| Others::new(geometry)).transpose()?;
    let (mut found, mut stats) = (Vec::new(), TraceStats::default());
    let mut hits = HitBuffer::default();
    let mut layer = Layer::first(rays);
    while !layer.ray_idx.is_empty() {
        let batch = layer.batch(rays);
        hits.reset(batch.len());
        stats += engine.closest_hit(&batch, &mut hits.as_hits());

        let first_new = found.len();
        let hit_rows = (0..hits.len()).filter(|&row| hits.object_id[row] != NO_ID);
        found.extend(hit_rows.map(|row| (layer.ray_idx[row], hits.get(row))));
        if let Some(others) = &mut others {
            let at_hits = Layer::at(rays, &found[first_new..]);
            stats += others.add(rays, &at_hits, &mut found)?;
        }
        layer = Layer::beyond(rays, &found[first_new..]);
    }
    stats.rays = rays.len() as u64;
    Ok((HitList::sorted(rays.len(), &found), stats))
}

impl HitList {
    /// Sorts hits by their rays; those of a ray stay in their order.
    fn sorted(ray_count: usize, found: &[(usize, Hit)]) -> Self {
        let mut splits = vec![0; ray_count + 1];
        for (ray_idx, _) in found {
            splits[ray_idx + 1] += 1;
        }
        for ray_idx in 0..ray_count {
            splits[ray_idx + 1] += splits[ray_idx];
        }
        let mut next = splits.clone();
        let mut list =
            Self { splits, ray_idx: vec![0; found.len()], hits: HitBuffer::new(found.len()) };
        for (ray_idx, hit) in found {
            let place = next[*ray_idx];
            next[*ray_idx] += 1;
            list.ray_idx[place] = *ray_idx;
            list.hits.as_hits().offer(place, hit);
        }
        list
    }
}

/// Some rays of a batch, limited to intervals of their own.
struct Layer {
    /// Which rays of the batch, in rising order.
    ray_idx: Vec<usize>,
    origin: Vec<Vec3>,
    direction: Vec<Vec3>,
    t_min: Vec<f32>,
    t_max: Vec<f32>,
    mask: Vec<u32>,
}

impl Layer {
    /// All rays.
    fn first(rays: &RayBatch<'_>) -> Self {
        let all = 0..rays.len();
        let interval = |ray_idx| {
            let ray = rays.ray(ray_idx);
            (ray_idx, ray.t_min, ray.t_max)
        };
        Self::gather(rays, all.map(interval))
    }

    /// The rays of these hits, from beyond them on.
    fn beyond(rays: &RayBatch<'_>, hits: &[(usize, Hit)]) -> Self {
        let mut hits: Vec<_> = hits.iter().map(|(ray_idx, hit)| (*ray_idx, hit.t)).collect();
        hits.sort_unstable_by_key(|(ray_idx, _)| *ray_idx);
        hits.dedup_by_key(|(ray_idx, _)| *ray_idx);
        let beyond = |(ray_idx, t): (usize, f32)| (ray_idx, t.next_up(), rays.ray(ray_idx).t_max);
        Self::gather(rays, hits.into_iter().map(beyond))
    }

    /// The rays of these hits, at the hits alone.
    fn at(rays: &RayBatch<'_>, hits: &[(usize, Hit)]) -> Self {
        Self::gather(rays, hits.iter().map(|(ray_idx, hit)| (*ray_idx, hit.t, hit.t)))
    }

    fn gather(rays: &RayBatch<'_>, intervals: impl Iterator<Item = (usize, f32, f32)>) -> Self {
        let (mut ray_idx, mut t_min, mut t_max) = (Vec::new(), Vec::new(), Vec::new());
        for (idx, from, to) in intervals {
            ray_idx.push(idx);
            t_min.push(from);
            t_max.push(to);
        }
        let origin = if rays.direction().uniform().is_some() {
            // A batch is as long as its rays' own columns: one of the two must be such.
            ray_idx.iter().map(|&idx| rays.origin().get(idx)).collect()
        } else {
            gather_column(rays.origin(), &ray_idx)
        };
        let direction = gather_column(rays.direction(), &ray_idx);
        let mask = gather_column(rays.mask(), &ray_idx);
        Self { ray_idx, origin, direction, t_min, t_max, mask }
    }

    /// The rays as a batch; what all rays of `rays` share is still shared.
    fn batch<'a>(&'a self, rays: &RayBatch<'a>) -> RayBatch<'a> {
        let direction =
            rays.direction().uniform().map_or((&self.direction).into(), Column::Uniform);
        let origin = match rays.origin().uniform() {
            Some(origin) if direction.uniform().is_none() => Column::Uniform(origin),
            _ => (&self.origin).into(),
        };
        let mask = rays.mask().uniform().map_or((&self.mask).into(), Column::Uniform);
        let is_whole = self.ray_idx.len() == rays.len();
        let order = match rays.order() {
            RayOrder::Image { .. } if !is_whole => RayOrder::Coherent,
            RayOrder::Groups(_) if !is_whole => RayOrder::Unordered,
            order => order,
        };
        let batch = RayBatch::new(origin, direction)
            .and_then(|batch| batch.with_interval(&self.t_min, &self.t_max))
            .and_then(|batch| batch.with_mask(mask));
        match batch {
            Ok(batch) => batch.with_order(order),
            Err(error) => unreachable!("columns gathered by one list are equally long: {error}"),
        }
    }
}

/// The values of these rays; nothing where all rays share one.
fn gather_column<T: ColumnElement>(column: &Column<'_, T>, ray_idx: &[usize]) -> Vec<T> {
    match column {
        Column::Uniform(_) => Vec::new(),
        Column::PerRay { .. } => ray_idx.iter().map(|&idx| column.get(idx)).collect(),
    }
}

/// Finds what lies exactly where the closest hit is, of other objects.
struct Others {
    objects: Geometry,
    /// Holds the objects in reversed order, so that it names the highest one.
    reversed: Box<dyn RayEngine>,
    /// Holds one object at a time.
    single: Box<dyn RayEngine>,
}

impl Others {
    fn new(geometry: &Geometry) -> Result<Self, EngineError> {
        let reverse = |object: &GeometryObject| {
            let mut object = object.clone();
            object.id = reversed(object.id.0);
            object
        };
        let objects = geometry.objects().iter().map(reverse).collect();
        let Ok(frame) = Geometry::new(objects) else {
            unreachable!("reversed ids are as unique as ids")
        };
        let mut reversed = create(EngineKind::Auto);
        reversed.commit(&frame, &FrameChanges::all())?;
        Ok(Self { objects: geometry.clone(), reversed, single: create(EngineKind::Auto) })
    }

    /// Appends to `found` what lies where the rays of `at_hits` have their hits, which are the last
    /// ones of `found`.
    fn add(
        &mut self,
        rays: &RayBatch<'_>,
        at_hits: &Layer,
        found: &mut Vec<(usize, Hit)>,
    ) -> Result<TraceStats, EngineError> {
        let nearest = found[found.len() - at_hits.ray_idx.len()..].to_vec();
        let mut hits = HitBuffer::new(nearest.len());
        let mut stats = self.reversed.closest_hit(&at_hits.batch(rays), &mut hits.as_hits());
        let has_others = |row: &usize| {
            let highest = hits.object_id[*row];
            highest != NO_ID && reversed(highest) != nearest[*row].1.object_id
        };
        let shared: Vec<_> =
            (0..nearest.len()).filter(has_others).map(|row| nearest[row]).collect();
        if shared.is_empty() {
            return Ok(stats);
        }

        let at_shared = Layer::at(rays, &shared);
        for object in self.objects.objects() {
            let alone = self.objects.subset(|other| other.id == object.id);
            self.single.commit(&alone, &FrameChanges::all())?;
            hits.reset(shared.len());
            stats += self.single.closest_hit(&at_shared.batch(rays), &mut hits.as_hits());
            for (row, (ray_idx, nearest)) in shared.iter().enumerate() {
                let hit = hits.get(row);
                if !hit.is_miss() && hit.object_id != nearest.object_id {
                    found.push((*ray_idx, hit));
                }
            }
        }
        Ok(stats)
    }
}

/// An id that sorts the other way round; its own inverse.
const fn reversed(id: u32) -> ObjectId {
    ObjectId(NO_ID - 1 - id)
}

#[cfg(test)]
mod tests {
    use rayflock_geom::{Mesh, Sphere};
    use rayflock_testkit::Rng;
    use rayflock_testkit::scenes::{SoupKind, triangle_soup};

    use super::*;

    /// A closed box of twelve triangles.
    fn cuboid(min: Vec3, max: Vec3) -> Mesh {
        let corner = |bits: usize| {
            let pick = |axis: usize| if bits & (1 << axis) == 0 { min[axis] } else { max[axis] };
            Vec3::new(pick(0), pick(1), pick(2))
        };
        let quads: [[u32; 4]; 6] =
            [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
        let triangles = quads.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]);
        let triangles: Vec<_> = triangles.collect();
        Mesh::from_triangles((0..8).map(corner).collect(), triangles).unwrap()
    }

    /// Three boxes on top of each other, one of which has two twins, beside a sphere.
    fn stack() -> Geometry {
        let floor = |z: f32| cuboid(Vec3::new(0.0, 0.0, z), Vec3::new(1.0, 1.0, z + 1.0));
        let ball = Mesh::from_spheres(vec![Sphere::new(Vec3::new(4.0, 0.5, 0.0), 1.0)]);
        let objects =
            [(2, floor(0.0)), (4, floor(1.0)), (5, floor(2.0)), (7, floor(2.0)), (9, ball)];
        let objects = objects.into_iter().map(|(id, mesh)| GeometryObject::new(ObjectId(id), mesh));
        Geometry::new(objects.collect()).unwrap()
    }

    fn list(kind: EngineKind, geometry: &Geometry, rays: &RayBatch<'_>) -> HitList {
        let mut engine = create(kind);
        engine.commit(geometry, &FrameChanges::all()).unwrap();
        list_hits(&mut *engine, geometry, rays).unwrap().0
    }

    #[test]
    fn surfaces_of_objects_that_touch_are_all_listed() {
        // Through the diagonals of faces, where two triangles of a box meet, and elsewhere.
        let origins =
            [(0.5, 0.5), (4.0, 0.5), (0.25, 0.5), (9.0, 0.0)].map(|(x, y)| Vec3::new(x, y, -5.0));
        let rays = RayBatch::new(&origins[..], Vec3::Z).unwrap();
        for kind in EngineKind::ALL {
            let found = list(kind, &stack(), &rays);
            assert_eq!(found.splits, [0, 8, 10, 18, 18], "{kind}");
            assert_eq!(found.ray_idx[7..12], [0, 1, 1, 2, 2]);
            let through_stack = [(5.0, 2), (6.0, 2), (6.0, 4), (7.0, 4), (7.0, 5), (7.0, 7)];
            for (place, (t, object_id)) in through_stack.into_iter().enumerate() {
                assert_eq!((found.hits.t[place], found.hits.object_id[place]), (t, object_id));
                assert_eq!(
                    (found.hits.t[10 + place], found.hits.object_id[10 + place]),
                    (t, object_id)
                );
            }
            assert_eq!(found.hits.t[8..10], [4.0, 6.0]);
        }
    }

    #[test]
    fn rays_that_are_all_the_same_have_the_same_hits() {
        let origins = [Vec3::new(0.25, 0.5, -5.0); 3];
        let rays = RayBatch::new(&origins[..], Vec3::Z).unwrap().unified();
        assert!(rays.origin().uniform().is_some() && rays.direction().uniform().is_some());
        let found = list(EngineKind::Auto, &stack(), &rays);
        assert_eq!(found.splits, [0, 8, 16, 24]);
        let past = RayBatch::new(Vec3::splat(9.0), Vec3::Z).unwrap();
        assert_eq!(list(EngineKind::Auto, &stack(), &past).splits, [0, 0]);
    }

    #[test]
    fn intervals_and_masks_hold_for_every_hit() {
        let mut objects = stack().objects().to_vec();
        objects[1].mask = 2;
        let geometry = Geometry::new(objects).unwrap();
        let origins = [Vec3::new(0.25, 0.5, -5.0); 3];
        let rays = RayBatch::new(&origins[..], Vec3::Z).unwrap();
        let rays = rays.with_interval(&[0.0_f32, 6.0, 9.0][..], &[6.5_f32, 7.0, 8.0][..]).unwrap();
        let rays = rays.with_mask(&[u32::MAX, 1, u32::MAX][..]).unwrap();
        let found = list(EngineKind::Auto, &geometry, &rays);
        let t = |ray: usize| found.hits.t[found.splits[ray]..found.splits[ray + 1]].to_vec();
        assert_eq!(t(0), [5.0, 6.0, 6.0]);
        assert_eq!(t(1), [6.0, 7.0, 7.0], "the middle box is not seen");
        assert_eq!(t(2), []);
    }

    #[test]
    fn there_are_as_many_hits_as_triangles_that_brute_force_finds_one_by_one() {
        let mut rng = Rng::new(5);
        let soup = triangle_soup(&mut rng, SoupKind::Plain, 300, Vec3::ZERO, 1.5);
        let object = GeometryObject::new(ObjectId(0), soup);
        let geometry = Geometry::new(vec![object]).unwrap();
        let origins: Vec<_> = (0..200).map(|_| rng.in_cube() - 4.0 * Vec3::Z).collect();
        let rays = RayBatch::new(&origins, Vec3::new(0.03, 0.01, 1.0)).unwrap();
        let found = list(EngineKind::Hierarchy, &geometry, &rays);
        let mesh = &geometry.objects()[0].shape;
        let mut expected = vec![Vec::new(); rays.len()];
        for triangle in mesh.triangles() {
            let alone = Mesh::from_triangles(mesh.vertices().to_vec(), vec![*triangle]).unwrap();
            let alone = Geometry::new(vec![GeometryObject::new(ObjectId(0), alone)]).unwrap();
            let mut engine = create(EngineKind::Brute);
            engine.commit(&alone, &FrameChanges::all()).unwrap();
            let mut hits = HitBuffer::new(rays.len());
            engine.closest_hit(&rays, &mut hits.as_hits());
            for (ray_idx, expected) in expected.iter_mut().enumerate() {
                expected.extend(Some(hits.t[ray_idx]).filter(|t| t.is_finite()));
            }
        }
        let most = expected.iter().map(Vec::len).max().unwrap_or_default();
        assert!(most > 3, "the soup is too thin: {most}");
        for (ray_idx, mut expected) in expected.into_iter().enumerate() {
            expected.sort_by(f32::total_cmp);
            assert_eq!(found.hits.t[found.splits[ray_idx]..found.splits[ray_idx + 1]], expected);
        }
    }
}
