//! Answers of devices against the definition, and by the oracle where the two differ.
//!
//! A hit agrees when it is on the same primitive and `t` differs by no more than [`TOLERANCE`] of
//! the distances at work. What does not agree must be a tie, an edge or an outline: the oracle
//! finds the device's answer as right as the definition's.

use glam::Vec3;
use rayflock_engine::{EngineKind, RayEngine};
use rayflock_geom::{
    FrameChanges, Geometry, GeometryObject, Hit, HitBuffer, ObjectId, Ray, RayBatch, RayOrder,
};
use rayflock_testkit::Rng;
use rayflock_testkit::oracle::{Oracle, Verdict};
use rayflock_testkit::rays::{RayForm, RaySet, every_order};
use rayflock_testkit::scenes::{ClosedMesh, SceneRecipe, SoupKind, spheres, triangle_soup};

use crate::device::engines;
use crate::scenes::{commit_to, frames};

/// How far `t` may be off, relative to the distance of the hit plus the size of the frame.
const TOLERANCE: f64 = 1e-5;

/// What came of comparing a batch.
#[derive(Debug, Default)]
pub(crate) struct Tally {
    pub(crate) hits: usize,
    /// Other primitives, or hits where the other sees none, that are as right.
    pub(crate) ties: usize,
}

/// A frame, its definition and its judge.
pub(crate) struct Bench {
    geometry: Geometry,
    definition: Box<dyn RayEngine>,
    oracle: Oracle,
    size: f64,
}

impl Bench {
    pub(crate) fn new(geometry: &Geometry) -> Self {
        Self::against(geometry, EngineKind::Brute)
    }

    /// With an engine on the CPU, which all give the same answer, to tell it.
    pub(crate) fn against(geometry: &Geometry, kind: EngineKind) -> Self {
        let bounds = geometry.bounds();
        let size = if bounds.is_empty() { Vec3::ZERO } else { bounds.max - bounds.min };
        Self {
            geometry: geometry.clone(),
            definition: commit_to(kind, geometry),
            oracle: Oracle::new(geometry),
            size: f64::from(size.length()),
        }
    }

    pub(crate) fn commit_to(&self, engine: &mut dyn RayEngine, changes: &FrameChanges) {
        let stats = engine.commit(&self.geometry, changes).unwrap();
        assert_eq!(stats.prim_count, self.geometry.prim_count(), "{}", engine.name());
    }

    /// Asks both questions of the engine and compares.
    pub(crate) fn compare(&mut self, engine: &mut dyn RayEngine, batch: &RayBatch<'_>) -> Tally {
        let (mut found, mut expected) = (HitBuffer::new(batch.len()), HitBuffer::new(batch.len()));
        let stats = engine.closest_hit(batch, &mut found.as_hits());
        let expected_stats = self.definition.closest_hit(batch, &mut expected.as_hits());
        assert_eq!(stats.invalid_rays, expected_stats.invalid_rays, "{}", engine.name());
        let mut occluded: Vec<bool> = (0..batch.len()).map(|idx| idx % 2 == 0).collect();
        engine.occluded(batch, &mut occluded);
        assert_eq!(engine.notice(), None, "{}: the device answers, not the CPU", engine.name());
        let mut tally = Tally::default();
        for (idx, &occluded) in occluded.iter().enumerate() {
            let (ray, name) = (batch.ray(idx), engine.name());
            self.check(&ray, found.get(idx), expected.get(idx), name, &mut tally);
            if occluded == found.get(idx).is_miss() {
                let free = Hit::MISS;
                let hit = if occluded { expected.get(idx) } else { free };
                assert!(self.may_be(&ray, &hit), "{name}: {ray:?} is occluded: {occluded}");
            }
        }
        tally
    }

    fn check(&self, ray: &Ray, found: Hit, expected: Hit, name: &str, tally: &mut Tally) {
        tally.hits += usize::from(!expected.is_miss());
        let ids = |hit: Hit| (hit.object_id, hit.prim_id);
        let is_near = found.is_miss() || self.is_near(ray, found.t, expected.t);
        if ids(found) == ids(expected) && is_near {
            return;
        }
        tally.ties += 1;
        let is_right = self.may_be(ray, &found);
        assert!(is_right, "{name}: {ray:?}: found {found:?}, expected {expected:?}");
    }

    fn is_near(&self, ray: &Ray, a: f32, b: f32) -> bool {
        f64::from((a - b).abs()) <= self.t_tolerance(ray, b)
    }

    fn t_tolerance(&self, ray: &Ray, t: f32) -> f64 {
        let length = ray.direction.as_dvec3().length();
        let middle = self.geometry.bounds().center().as_dvec3();
        let reach = self.size + middle.distance(ray.origin.as_dvec3());
        TOLERANCE * (f64::from(t.abs()) + reach / length)
    }

    /// Whether the oracle allows this answer, give or take the tolerance.
    fn may_be(&self, ray: &Ray, hit: &Hit) -> bool {
        let candidates = self.oracle.candidates(ray);
        let certain = candidates.iter().filter(|found| found.verdict == Verdict::CertainHit);
        let nearest = certain.map(|found| found.t.hi).min_by(f64::total_cmp);
        if hit.is_miss() {
            return nearest.is_none();
        }
        let (t, slack) = (f64::from(hit.t), self.t_tolerance(ray, hit.t));
        let is_there = candidates
            .iter()
            .filter(|found| (found.object_id, found.prim_id) == (hit.object_id, hit.prim_id))
            .any(|found| found.t.lo - slack <= t && t <= found.t.hi + slack);
        is_there && nearest.is_none_or(|nearest| t <= nearest + slack)
    }
}

fn recipe(seed: u64, object_count: usize, prim_count: usize) -> SceneRecipe {
    SceneRecipe { seed, object_count, prim_count, size: 1.0, offset: 0.0 }
}

fn one(mesh: rayflock_geom::Mesh) -> Geometry {
    Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap()
}

/// Rays aimed where intersection is hardest, in every form, over frames that change.
#[test]
fn every_form_of_batch_agrees_on_changing_frames() {
    for mut engine in engines() {
        let mut rng = Rng::new(41);
        for seed in 0..3 {
            let mut previous = Geometry::default();
            for frame in frames(&recipe(seed, 5, 40), 3) {
                let mut bench = Bench::new(&frame);
                bench.commit_to(&mut engine, &FrameChanges::between(&previous, &frame));
                for form in RayForm::ALL {
                    let set = RaySet::random(&mut rng, &frame, form, 130);
                    bench.compare(&mut engine, &set.batch());
                }
                previous = frame;
            }
        }
    }
}

/// Rays at nothing in particular: edges and ties are rare then.
#[test]
fn few_rays_at_nothing_in_particular_differ() {
    for mut engine in engines() {
        let mut rng = Rng::new(42);
        let soup = triangle_soup(&mut rng, SoupKind::Plain, 400, Vec3::ZERO, 1.0);
        let geometry = one(soup.with_spheres(spheres(&mut rng, 40, Vec3::ZERO, 1.0)));
        let mut bench = Bench::new(&geometry);
        bench.commit_to(&mut engine, &FrameChanges::all());
        let origins: Vec<_> = (0..4000).map(|_| 2.0 * rng.in_cube()).collect();
        let directions: Vec<_> = (0..4000).map(|_| 2.0 * rng.on_sphere()).collect();
        let batch = RayBatch::new(&origins, &directions).unwrap();
        let tally = bench.compare(&mut engine, &batch);
        assert!(tally.hits > 1000 && tally.ties <= 4, "{}: {tally:?}", engine.name());
    }
}

#[test]
fn scenes_of_every_scale_agree() {
    for mut engine in engines() {
        for (exponent, offset) in [(-6, 0.0), (-6, 100.0), (0, 1e3), (6, 0.0), (6, 10.0)] {
            let mut rng = Rng::new(43);
            let size = 10.0_f32.powi(exponent);
            let center = offset * size * Vec3::new(0.6, -0.48, 0.64);
            let soup = triangle_soup(&mut rng, SoupKind::Plain, 60, center, size);
            let mut bench =
                Bench::new(&one(soup.with_spheres(spheres(&mut rng, 20, center, size))));
            bench.commit_to(&mut engine, &FrameChanges::all());
            for form in RayForm::ALL {
                let set = RaySet::random(&mut rng, &bench.geometry, form, 200);
                bench.compare(&mut engine, &set.batch());
            }
        }
    }
}

#[test]
fn hints_and_images_change_no_answer() {
    for mut engine in engines() {
        let mut rng = Rng::new(44);
        let geometry = frames(&recipe(7, 6, 60), 1).remove(0);
        let mut bench = Bench::new(&geometry);
        bench.commit_to(&mut engine, &FrameChanges::all());
        let set = RaySet::random(&mut rng, &geometry, RayForm::UniformOrigin, 200);
        for order in every_order(200) {
            bench.compare(&mut engine, &set.batch().with_order(order));
        }
        for (size, tile) in [([40, 24], 0), ([64, 48], 8), ([32, 32], 4)] {
            let set = RaySet::pinhole(&mut rng, &geometry, size, tile);
            bench.compare(&mut engine, &set.batch());
        }
    }
}

/// No ray that starts inside a closed mesh leaves it through vertices and edges.
#[test]
fn closed_meshes_have_no_gaps() {
    for mut engine in engines() {
        let mut rng = Rng::new(45);
        for mesh in [ClosedMesh::cube(), ClosedMesh::icosphere(2)] {
            let surface = mesh.placed(Vec3::new(0.3, 40.0, -2.0), 1.5);
            let geometry = one(surface.mesh());
            engine.commit(&geometry, &FrameChanges::all()).unwrap();
            let middle = geometry.bounds().center();
            let origins: Vec<_> = (0..6000).map(|_| middle + 0.3 * rng.in_cube()).collect();
            let directions: Vec<_> = origins
                .iter()
                .map(|origin| {
                    let face = surface.triangles[rng.below(surface.triangles.len())];
                    let [a, b, _] = face.map(|corner| surface.vertices[corner as usize]);
                    a.lerp(b, rng.pick(&[0.0, 0.5, 0.3])) - *origin
                })
                .collect();
            let batch = RayBatch::new(&origins, &directions).unwrap();
            let mut hits = HitBuffer::new(batch.len());
            engine.closest_hit(&batch.with_order(RayOrder::Unordered), &mut hits.as_hits());
            let escaped = (0..batch.len()).find(|&idx| hits.get(idx).is_miss());
            assert_eq!(escaped.map(|idx| batch.ray(idx)), None, "{}", engine.name());
        }
    }
}
