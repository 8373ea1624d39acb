use glam::{Quat, Vec3};
use rayflock_geom::{Geometry, GeometryObject, Hit, Mesh, ObjectId, PrimId, Ray, Sphere};

use super::*;

const ID: ObjectId = ObjectId(3);

fn facing() -> Mesh {
    let vertices =
        vec![Vec3::new(0.0, 0.0, 2.0), Vec3::new(4.0, 0.0, 2.0), Vec3::new(0.0, 4.0, 2.0)];
    Mesh::from_triangles(vertices, vec![[0, 1, 2]]).unwrap()
}

fn oracle(mesh: Mesh) -> Oracle {
    Oracle::new(&Geometry::new(vec![GeometryObject::new(ID, mesh)]).unwrap())
}

fn hit(t: f32, u: f32, v: f32) -> Hit {
    Hit { t, u, v, object_id: ID, prim_id: PrimId(0) }
}

fn ray_at(x: f32, y: f32) -> Ray {
    Ray::new(Vec3::new(x, y, 0.0), Vec3::Z)
}

#[test]
fn a_hit_inside_is_certain_and_exact() {
    let oracle = oracle(facing());
    let ray = ray_at(1.0, 1.0);
    let found = oracle.candidates(&ray)[0];
    assert_eq!(found.verdict, Verdict::CertainHit);
    assert!(found.t.holds(2.0) && found.t.hi - found.t.lo < 5e-5, "{found:?}");
    assert_eq!(oracle.judge(&ray, &hit(2.0, 0.25, 0.25)), Ok(()));
    assert!(matches!(oracle.judge(&ray, &Hit::MISS), Err(Fault::Beaten { .. })));
    assert!(matches!(oracle.judge(&ray, &hit(1.9999, 0.25, 0.25)), Err(Fault::WrongT { .. })));
    assert!(matches!(oracle.judge(&ray, &hit(2.0001, 0.25, 0.25)), Err(Fault::Beaten { .. })));
    for (u, v) in [(0.2501, 0.25), (0.25, 0.2499), (0.5, 0.25), (-0.1, 0.3), (f32::NAN, 0.0)] {
        let verdict = oracle.judge(&ray, &hit(2.0, u, v));
        assert!(matches!(verdict, Err(Fault::WrongPoint { .. })), "{u} {v} {verdict:?}");
    }
}

#[test]
fn just_the_surroundings_of_an_edge_are_borderline() {
    let oracle = oracle(facing());
    for (offset, expected) in [(1e-5, Some(Verdict::CertainHit)), (-1e-5, None)] {
        let found = oracle.candidates(&ray_at(offset, 1.0));
        assert_eq!(found.first().map(|found| found.verdict), expected, "beside {offset}");
        let found = oracle.candidates(&ray_at(0.1 * offset, 1.0));
        assert_eq!(found[0].verdict, Verdict::Borderline, "beside {}", 0.1 * offset);
        assert_eq!(oracle.judge(&ray_at(0.1 * offset, 1.0), &Hit::MISS), Ok(()));
        assert_eq!(oracle.judge(&ray_at(0.1 * offset, 1.0), &hit(2.0, 0.0, 0.25)), Ok(()));
    }
    let beside = ray_at(-1e-5, 1.0);
    assert!(matches!(oracle.judge(&beside, &hit(2.0, 0.0, 0.25)), Err(Fault::NotAHit { .. })));
}

#[test]
fn the_line_of_an_edge_beyond_its_end_is_no_edge() {
    let oracle = oracle(facing());
    for (x, y) in [(5.0, 0.0), (0.0, -1.0), (5.0, -1.0), (-1.0, 5.0), (2.0, 2.001)] {
        assert_eq!(oracle.candidates(&ray_at(x, y)), [], "{x} {y}");
    }
}

#[test]
fn a_triangle_seen_edge_on_is_missed_beside_and_borderline_along() {
    let oracle = oracle(facing());
    let along = |y: f32| Ray::new(Vec3::new(-3.0, y, 2.0), Vec3::X);
    assert_eq!(oracle.candidates(&along(-1.0)), []);
    assert_eq!(oracle.candidates(&along(1.0))[0].verdict, Verdict::Borderline);
    assert_eq!(oracle.judge(&along(1.0), &Hit::MISS), Ok(()));
    let away = Ray { origin: Vec3::new(-3.0, 1.0, 2.1), ..along(1.0) };
    assert_eq!(oracle.candidates(&away), []);
}

#[test]
fn the_ends_of_the_interval_are_borderline_and_closed() {
    let oracle = oracle(facing());
    let ray = ray_at(1.0, 1.0);
    let verdict = |t_min: f32, t_max: f32| {
        let found = oracle.candidates(&Ray { t_min, t_max, ..ray });
        found.first().map(|found| found.verdict)
    };
    assert_eq!(verdict(1.9999, 2.0001), Some(Verdict::CertainHit));
    assert_eq!(verdict(2.0, 2.0), Some(Verdict::Borderline));
    assert_eq!((verdict(2.0001, 9.0), verdict(0.0, 1.9999)), (None, None));
    let short = Ray { t_max: 1.999_999_9, ..ray };
    let outside = oracle.judge(&short, &hit(2.0, 0.25, 0.25));
    assert!(matches!(outside, Err(Fault::OutsideInterval { .. })));
}

#[test]
fn t_counts_in_multiples_of_the_direction() {
    let oracle = oracle(facing());
    for scale in [1e-30_f32, 1e-3, 1e3, 1e30] {
        let ray = Ray { direction: Vec3::Z * scale, ..ray_at(1.0, 1.0) };
        assert_eq!(oracle.judge(&ray, &hit(2.0 / scale, 0.25, 0.25)), Ok(()), "{scale}");
        assert!(oracle.judge(&ray, &hit(2.0, 0.25, 0.25)).is_err());
    }
}

#[test]
fn masks_inactive_and_invalid_rays_hit_nothing() {
    let object = GeometryObject::new(ID, facing()).with_mask(0b10);
    let oracle = Oracle::new(&Geometry::new(vec![object]).unwrap());
    let ray = ray_at(1.0, 1.0);
    assert!(oracle.judge(&Ray { mask: 0b110, ..ray }, &Hit::MISS).is_err());
    assert_eq!(oracle.judge(&Ray { mask: 0b101, ..ray }, &Hit::MISS), Ok(()));
    for off in [Ray { t_max: -1.0, ..ray }, Ray { direction: Vec3::ZERO, ..ray }] {
        assert_eq!(oracle.judge(&off, &Hit::MISS), Ok(()));
        let found = oracle.judge(&off, &hit(2.0, 0.25, 0.25));
        assert!(matches!(found, Err(Fault::NotTraced { .. })));
    }
}

#[test]
fn flat_and_broken_triangles_are_never_hit() {
    let vertices = vec![Vec3::ZERO, Vec3::X, Vec3::X * 2.0, Vec3::NAN, Vec3::Y];
    let mesh = Mesh::from_triangles(vertices, vec![[0, 1, 2], [0, 1, 3], [0, 1, 4]]).unwrap();
    let oracle = oracle(mesh);
    let ray = Ray::new(Vec3::new(0.25, 0.25, -1.0), Vec3::Z);
    let ids: Vec<u32> = oracle.candidates(&ray).iter().map(|found| found.prim_id.0).collect();
    assert_eq!(ids, [2]);
    let along = Ray::new(Vec3::new(0.25, 0.0, -1.0), Vec3::Z);
    assert!(oracle.candidates(&along).iter().all(|found| found.prim_id.0 == 2));
}

#[test]
fn transforms_are_followed() {
    let turn = Affine3A::from_scale_rotation_translation(
        Vec3::new(1.0, 2.0, 3.0),
        Quat::from_rotation_y(std::f32::consts::FRAC_PI_2),
        Vec3::new(10.0, 0.0, 0.0),
    );
    // The triangle lies in the plane x = 10 + 6, with y doubled and z = -x.
    let object = GeometryObject::new(ID, facing()).with_transform(turn);
    let oracle = Oracle::new(&Geometry::new(vec![object]).unwrap());
    let ray = Ray::new(Vec3::new(0.0, 2.0, -1.0), Vec3::X);
    assert_eq!(oracle.judge(&ray, &hit(16.0, 0.25, 0.25)), Ok(()));
    assert!(oracle.judge(&ray, &hit(16.001, 0.25, 0.25)).is_err());
}

#[test]
fn spheres_have_two_sides_and_a_silhouette() {
    let oracle = oracle(Mesh::from_spheres(vec![Sphere::new(Vec3::new(0.0, 0.0, 5.0), 1.0)]));
    let at = |x: f32| Ray::new(Vec3::new(x, 0.0, 0.0), Vec3::Z);
    assert_eq!(oracle.judge(&at(0.0), &hit(4.0, 0.0, 0.0)), Ok(()));
    assert!(matches!(oracle.judge(&at(0.0), &hit(6.0, 0.0, 0.0)), Err(Fault::Beaten { .. })));
    let inside = Ray { origin: Vec3::new(0.0, 0.0, 5.0), ..at(0.0) };
    assert_eq!(oracle.judge(&inside, &hit(1.0, 0.0, 0.0)), Ok(()));
    assert!(oracle.judge(&inside, &Hit::MISS).is_err());
    let late = Ray { t_min: 4.5, ..at(0.0) };
    assert_eq!(oracle.judge(&late, &hit(6.0, 0.0, 0.0)), Ok(()));
    assert_eq!(oracle.judge(&Ray { t_max: 5.5, ..late }, &Hit::MISS), Ok(()));
    assert_eq!(oracle.candidates(&at(1.001)), []);
    assert_eq!(oracle.candidates(&at(0.999))[0].verdict, Verdict::CertainHit);
    assert_eq!(oracle.candidates(&at(1.0))[0].verdict, Verdict::Borderline);
}

#[test]
fn the_nearest_certain_hit_wins() {
    let near = GeometryObject::new(ObjectId(9), facing());
    let back = Affine3A::from_translation(Vec3::Z);
    let far = GeometryObject::new(ID, facing()).with_transform(back);
    let oracle = Oracle::new(&Geometry::new(vec![near, far]).unwrap());
    let ray = ray_at(1.0, 1.0);
    let right = Hit { object_id: ObjectId(9), ..hit(2.0, 0.25, 0.25) };
    assert_eq!(oracle.judge(&ray, &right), Ok(()));
    let beaten = oracle.judge(&ray, &hit(3.0, 0.25, 0.25));
    assert!(matches!(beaten, Err(Fault::Beaten { .. })));
    let nobody = Hit { prim_id: PrimId(1), ..right };
    assert!(matches!(oracle.judge(&ray, &nobody), Err(Fault::NotAHit { .. })));
}
