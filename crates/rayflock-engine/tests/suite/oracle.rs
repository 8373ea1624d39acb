//! The engine that defines the answer, judged by the oracle.
//!
//! The other engines are compared with it in `same_answer`.

use std::sync::Arc;

use glam::Vec3;
use proptest::prelude::*;
use rayflock_geom::{Aabb, Geometry, GeometryObject, HitBuffer, Mesh, ObjectId, RayBatch};
use rayflock_testkit::Rng;
use rayflock_testkit::oracle::{Oracle, Verdict};
use rayflock_testkit::rays::{RayForm, RaySet};
use rayflock_testkit::scenes::{
    ClosedMesh, SceneRecipe, SoupKind, UserBoxes, scene_recipe, spheres, triangle_soup,
};

use crate::engines::{definition, seeded};

/// Judges every hit of a batch.
fn judge(geometry: &Geometry, batch: &RayBatch<'_>) -> Result<(), String> {
    let mut hits = HitBuffer::new(batch.len());
    definition(geometry).closest_hit(batch, &mut hits.as_hits());
    let oracle = Oracle::new(geometry);
    for idx in 0..batch.len() {
        let ray = batch.ray(idx);
        oracle.judge(&ray, &hits.get(idx)).map_err(|fault| {
            let candidates = oracle.candidates(&ray);
            let place = geometry.object(hits.get(idx).object_id).map(|object| {
                (object.world_from_object, object.shape.prim_kind(hits.get(idx).prim_id))
            });
            format!("ray {idx}: {fault}\n{ray:?}\nhit: {place:?}\ncandidates: {candidates:#?}")
        })?;
    }
    Ok(())
}

fn judge_every_form(geometry: &Geometry, rng: &mut Rng, len: usize) -> Result<(), String> {
    for form in RayForm::ALL {
        let set = RaySet::random(rng, geometry, form, len);
        judge(geometry, &set.batch()).map_err(|fault| format!("{form:?}: {fault}"))?;
    }
    Ok(())
}

proptest! {
    #![proptest_config(seeded(300, 1))]

    #[test]
    fn the_definition_agrees_with_the_oracle(recipe in scene_recipe(4, 40)) {
        let geometry = recipe.geometry();
        let mut rng = Rng::new(recipe.seed);
        if let Err(fault) = judge_every_form(&geometry, &mut rng, 100) {
            prop_assert!(false, "{fault}");
        }
    }

    #[test]
    fn frames_of_a_sequence_agree_with_the_oracle(recipe in scene_recipe(4, 20)) {
        let mut rng = Rng::new(recipe.seed);
        for geometry in recipe.frames(4) {
            if let Err(fault) = judge_every_form(&geometry, &mut rng, 30) {
                prop_assert!(false, "{fault}");
            }
        }
    }
}

#[test]
fn soups_of_every_kind_and_scale_agree_with_the_oracle() {
    for kind in SoupKind::ALL {
        for exponent in [-12, -6, 0, 6, 12] {
            let size = 10.0_f32.powi(exponent);
            for offset in [0.0, 100.0, 1e5] {
                let mut rng = Rng::new(11);
                let center = Vec3::splat(offset * size);
                let mesh = triangle_soup(&mut rng, kind, 100, center, size);
                let object = GeometryObject::new(ObjectId(0), mesh);
                let geometry = Geometry::new(vec![object]).unwrap();
                let verdict = judge_every_form(&geometry, &mut rng, 200);
                assert_eq!(verdict, Ok(()), "{kind:?} of size {size:e} at {offset} sizes");
            }
        }
    }
}

#[test]
fn spheres_and_user_primitives_of_every_scale_agree_with_the_oracle() {
    for exponent in [-12, -6, 0, 6, 12] {
        let size = 10.0_f32.powi(exponent);
        for offset in [0.0, 100.0, 1e5] {
            let mut rng = Rng::new(14);
            let center = Vec3::splat(offset * size);
            let boxes = (0..20).map(|_| {
                let (a, b) = (center + size * rng.in_cube(), center + size * rng.in_cube());
                Aabb { min: a.min(b), max: a.max(b) }
            });
            let boxes = UserBoxes(boxes.collect());
            let mesh = Mesh::from_spheres(spheres(&mut rng, 50, center, size));
            let mesh = mesh.with_user(Arc::new(boxes));
            let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap();
            let verdict = judge_every_form(&geometry, &mut rng, 300);
            assert_eq!(verdict, Ok(()), "size {size:e} at {offset} sizes");
        }
    }
}

#[test]
fn needles_of_closed_meshes_agree_with_the_oracle() {
    let mut rng = Rng::new(12);
    for mesh in [ClosedMesh::cube(), ClosedMesh::tetrahedron(), ClosedMesh::icosphere(1)] {
        let mesh = mesh.with_needles(&mut rng, 100).mesh();
        let geometry = Geometry::new(vec![GeometryObject::new(ObjectId(0), mesh)]).unwrap();
        assert_eq!(judge_every_form(&geometry, &mut rng, 1000), Ok(()));
    }
}

/// The oracle may shrug at edges only: on rays that aim at nothing in particular it must be sure.
#[test]
fn the_oracle_is_sure_of_ordinary_rays() {
    let recipe = SceneRecipe { seed: 2, object_count: 6, prim_count: 60, size: 1.0, offset: 0.0 };
    let geometry = recipe.geometry();
    let oracle = Oracle::new(&geometry);
    let mut rng = Rng::new(13);
    let set = RaySet::pinhole(&mut rng, &geometry, [64, 64], 0);
    let batch = set.batch();
    let mut counts = [0; 3];
    for idx in 0..batch.len() {
        for found in oracle.candidates(&batch.ray(idx)) {
            counts[found.verdict as usize] += 1;
        }
    }
    let [_, borderline, certain] = counts;
    assert!(certain > 500, "{certain} certain hits");
    assert!(borderline * 100 < certain, "{borderline} borderline, {certain} certain");
    assert_eq!(Verdict::CertainHit as usize, 2);
}
