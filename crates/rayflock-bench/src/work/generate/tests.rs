use rayflock::engine::{self, EngineKind};
use rayflock::geom::{FrameChanges, HitBuffer, ObjectId, RayState};

use super::super::{Definition, MovingScene, Question};
use super::*;

/// A committed frame, and everything that rays are made from.
struct Fixture {
    surroundings: Surroundings,
    geometry: Geometry,
    engine: Box<dyn RayEngine>,
}

const SIZE: [usize; 2] = [64, 64];

impl Fixture {
    fn new(geometry: Geometry, surroundings: Surroundings) -> Self {
        let mut engine = engine::create(EngineKind::Hierarchy);
        engine.commit(&geometry, &FrameChanges::all()).unwrap();
        Self { surroundings, geometry, engine }
    }

    fn at(time: f64) -> Self {
        let definition = Definition::default_map();
        let geometry = MovingScene::new(&definition, 1 << 10).geometry(time);
        Self::new(geometry, definition.surroundings())
    }

    /// The room without what moves in it.
    fn empty_room() -> Self {
        let Self { geometry, surroundings, .. } = Self::at(0.0);
        Self::new(geometry.subset(|object| object.id == MovingScene::ROOM), surroundings)
    }

    fn rays(&mut self, kind: RayKind) -> RaySet {
        let Self { surroundings, geometry, engine } = self;
        generate(kind, SIZE, surroundings, geometry, engine.as_mut(), 7)
    }

    fn points(&mut self) -> Vec<SurfacePoint> {
        surface_points(&self.surroundings, SIZE, &self.geometry, self.engine.as_mut())
    }

    fn hits(&mut self, rays: &RaySet) -> HitBuffer {
        let batch = rays.batches().next().unwrap();
        let mut hits = HitBuffer::new(batch.len());
        self.engine.closest_hit(&batch, &mut hits.as_hits());
        hits
    }

    fn occluded(&mut self, rays: &RaySet) -> Vec<bool> {
        let batch = rays.batches().next().unwrap();
        let mut occluded = vec![false; batch.len()];
        self.engine.occluded(&batch, &mut occluded);
        occluded
    }
}

fn per_ray<T>(rays: &RaySet, f: impl Fn(Vec3, Vec3) -> T) -> Vec<T> {
    let batch = rays.batches().next().unwrap();
    let ray = |idx| batch.ray(idx);
    (0..batch.len()).map(|idx| f(ray(idx).origin, ray(idx).direction)).collect()
}

#[test]
fn images_are_as_square_as_they_get() {
    for (count, size) in
        [(4096, [64, 64]), (512, [32, 16]), (1000, [40, 25]), (1009, [32, 32]), (0, [1, 1])]
    {
        assert_eq!(image_size(count), size, "{count}");
    }
}

#[test]
fn every_kind_has_as_many_rays_as_asked_for_all_of_them_valid() {
    let mut fixture = Fixture::at(128.0);
    for kind in RayKind::ALL {
        let rays = fixture.rays(kind);
        assert_eq!((rays.kind(), rays.len()), (kind, 64 * 64));
        assert_eq!(rays.batches().count(), if kind == RayKind::Suns { 16 } else { 1 });
        for batch in rays.batches() {
            assert!((0..batch.len()).all(|idx| batch.ray(idx).state() == RayState::Active));
            if let RayOrder::Image { width, height, .. } = batch.order() {
                assert_eq!(width * height, batch.len());
            }
        }
    }
}

#[test]
fn shared_origins_and_directions_are_uniform_columns() {
    let mut fixture = Fixture::at(128.0);
    let mut uniform = |kind: RayKind| {
        let rays = fixture.rays(kind);
        let batch = rays.batches().next().unwrap();
        (batch.origin().uniform().is_some(), batch.direction().uniform().is_some())
    };
    for kind in [RayKind::Primary, RayKind::PointShadow, RayKind::Lidar] {
        assert_eq!(uniform(kind), (true, false), "{kind}");
    }
    for kind in [RayKind::DirShadow, RayKind::Suns, RayKind::Orthographic] {
        assert_eq!(uniform(kind), (false, true), "{kind}");
    }
    for kind in [RayKind::Mirror, RayKind::Diffuse, RayKind::Ao] {
        assert_eq!(uniform(kind), (false, false), "{kind}");
    }
}

#[test]
fn the_camera_sees_closed_surfaces_only_and_the_moving_triangles_in_every_phase() {
    let mut empty = Fixture::empty_room();
    let primary = empty.rays(RayKind::Primary);
    assert!(empty.hits(&primary).t.iter().all(|t| t.is_finite()));
    for time in [128.0, 128.25, 64.0, 64.25] {
        let mut fixture = Fixture::at(time);
        let hits = fixture.hits(&primary);
        assert!(hits.t.iter().all(|t| t.is_finite()), "at {time}");
        let moving = hits.object_id.iter().filter(|&&id| ObjectId(id) == MovingScene::MOVING);
        let share = moving.count() as f32 / hits.len() as f32;
        assert!((0.1..0.95).contains(&share), "{share} at {time}");
    }
}

#[test]
fn rays_from_the_light_end_just_before_what_the_camera_sees() {
    // The room is convex and the light is in it, so nothing stands between them.
    let mut fixture = Fixture::empty_room();
    let rays = fixture.rays(RayKind::PointShadow);
    assert!(fixture.occluded(&rays).iter().all(|&occluded| !occluded));
    // A little farther and every ray meets the place it is for.
    fixture.surroundings.shadow_end = 1.0001;
    let longer = fixture.rays(RayKind::PointShadow);
    assert!(fixture.occluded(&longer).iter().all(|&occluded| occluded));
    let primary = fixture.rays(RayKind::Primary);
    let seen = fixture.hits(&primary);
    let lit = fixture.hits(&longer);
    assert!(lit.t.iter().all(|t| (t - 1.0).abs() < 1e-4));
    let same = |idx: &usize| seen.prim_id[*idx] == lit.prim_id[*idx];
    assert!((0..seen.len()).filter(same).count() > seen.len() * 99 / 100);
}

#[test]
fn the_sun_shines_through_the_skylight_and_nowhere_else() {
    let mut fixture = Fixture::empty_room();
    let rays = fixture.rays(RayKind::DirShadow);
    let sun = Definition::default_map().surroundings().to_sun;
    let (ceiling, half_hole) = (7.5, 12.0 * 0.5 * 10.0 / 32.0);
    let enters = per_ray(&rays, |origin, direction| {
        assert_eq!(direction, sun);
        let at = origin + sun * ((ceiling - origin.y) / sun.y);
        at.x.abs() < half_hole && at.z.abs() < half_hole
    });
    let occluded = fixture.occluded(&rays);
    let agree = occluded.iter().zip(&enters).filter(|&(occluded, enters)| occluded != enters);
    assert_eq!(agree.count(), 64 * 64);
    assert!(enters.iter().any(|&enters| enters), "some of the picture is in the sun");
}

#[test]
fn mirrored_rays_leave_at_the_angle_they_came_at() {
    let mut fixture = Fixture::at(64.0);
    let (points, rays) = (fixture.points(), fixture.rays(RayKind::Mirror));
    let mirrored = per_ray(&rays, |origin, direction| (origin, direction));
    for (point, (origin, direction)) in points.iter().zip(mirrored) {
        let (in_cosine, out_cosine) =
            (-point.incoming.dot(point.normal), direction.dot(point.normal));
        assert!(in_cosine >= 0.0 && (in_cosine - out_cosine).abs() < 1e-5);
        assert!((direction - point.incoming).cross(point.normal).length() < 1e-5);
        let offset = (origin - point.position).dot(point.normal);
        assert!((offset / fixture.surroundings.offset - 1.0).abs() < 0.01, "{offset}");
    }
}

#[test]
fn no_ray_meets_the_place_that_it_leaves() {
    // Any hit near the start is that of a flat wall with itself.
    let mut fixture = Fixture::empty_room();
    for kind in [RayKind::Mirror, RayKind::Diffuse] {
        let rays = fixture.rays(kind);
        let (hits, points) = (fixture.hits(&rays), fixture.points());
        let directions = per_ray(&rays, |_, direction| direction);
        for (idx, point) in points.iter().enumerate().filter(|&(idx, _)| hits.t[idx].is_finite()) {
            let end = point.start + hits.t[idx] * directions[idx];
            assert!((end - point.position).dot(point.normal) > 0.0, "{kind}: {point:?}");
        }
    }
}

#[test]
fn diffuse_rays_follow_the_cosine_on_the_side_that_is_seen() {
    let mut fixture = Fixture::at(128.0);
    let (points, rays) = (fixture.points(), fixture.rays(RayKind::Diffuse));
    let directions = per_ray(&rays, |_, direction| direction);
    let cosines = points.iter().zip(&directions).map(|(point, d)| {
        assert!(point.normal.dot(point.incoming) <= 0.0);
        d.dot(point.normal)
    });
    let cosines: Vec<f32> = cosines.collect();
    assert!(cosines.iter().all(|&cosine| cosine > -1e-6));
    let mean = cosines.iter().sum::<f32>() / cosines.len() as f32;
    assert!((mean - 2.0 / 3.0).abs() < 0.02, "{mean}");
    let again = fixture.rays(RayKind::Diffuse);
    assert_eq!(per_ray(&again, |_, direction| direction), directions);
}

#[test]
fn ambient_rays_come_in_groups_that_share_a_place() {
    let mut fixture = Fixture::at(64.0);
    let rays = fixture.rays(RayKind::Ao);
    let (origins, directions) = (per_ray(&rays, |o, _| o), per_ray(&rays, |_, d| d));
    for (origins, directions) in origins.chunks(8).zip(directions.chunks(8)) {
        assert!(origins.iter().all(|origin| origin == &origins[0]));
        assert!(directions[1..].iter().all(|direction| direction != &directions[0]));
    }
    let batch = rays.batches().next().unwrap();
    assert_eq!((batch.order(), batch.ray(9).t_max), (RayOrder::Groups(8), 1.0));
}

#[test]
fn a_scanner_looks_all_around_between_its_angles() {
    let mut fixture = Fixture::at(64.0);
    let rays = fixture.rays(RayKind::Lidar);
    let directions = per_ray(&rays, |_, direction| direction);
    let [low, high] = fixture.surroundings.lidar_elevation;
    for (row, directions) in directions.chunks(64).enumerate() {
        let expected = low + (high - low) * row as f32 / 63.0;
        assert!(directions.iter().all(|direction| (direction.y - expected.sin()).abs() < 1e-5));
        assert!(directions.iter().sum::<Vec3>().with_y(0.0).length() < 1e-3);
    }
}

#[test]
fn rays_from_above_cover_the_room() {
    let mut fixture = Fixture::empty_room();
    let rays = fixture.rays(RayKind::Orthographic);
    assert!(
        per_ray(&rays, |_, direction| direction.abs_diff_eq(-Vec3::Y, 1e-6)).iter().all(|&d| d)
    );
    assert!(fixture.hits(&rays).t.iter().all(|t| (t - 7.4).abs() < 1e-3));
    let origins = per_ray(&rays, |origin, _| origin);
    let first = Vec3::new(-4.95 + 9.9 / 128.0, 7.4, -4.95 + 9.9 / 128.0);
    assert!(origins[0].abs_diff_eq(first, 1e-4), "{}", origins[0]);
}

#[test]
fn suns_stand_apart_above_the_horizon() {
    let suns = suns();
    for (idx, sun) in suns.iter().enumerate() {
        assert!((sun.length() - 1.0).abs() < 1e-5 && sun.y >= LOWEST_SUN);
        assert!(suns[..idx].iter().all(|other| sun.angle_between(*other) > 0.2));
    }
}

#[test]
fn rays_of_pixels_that_see_nothing_are_switched_off() {
    // Through the floor, outward: triangles are seen from both sides, but not all around.
    let mut fixture = Fixture::at(64.0);
    fixture.surroundings.view.world_from_camera.translation.y = 20.0;
    let points = fixture.points();
    let missing = points.iter().filter(|point| !point.is_there).count();
    assert!((100..4000).contains(&missing), "{missing}");
    for kind in [RayKind::PointShadow, RayKind::DirShadow, RayKind::Mirror, RayKind::Diffuse] {
        let rays = fixture.rays(kind);
        let batch = rays.batches().next().unwrap();
        for (idx, point) in points.iter().enumerate() {
            let expected = if point.is_there { RayState::Active } else { RayState::Inactive };
            assert_eq!(batch.ray(idx).state(), expected);
        }
        if kind.question() == Question::Occluded {
            let occluded = fixture.occluded(&rays);
            assert!(
                points.iter().zip(occluded).all(|(point, occluded)| point.is_there || !occluded)
            );
        }
    }
}

#[test]
fn normals_of_spheres_and_of_moved_triangles_point_to_the_viewer() {
    use rayflock::prelude::*;
    use rayflock::scene::Projection;

    let ball = Mesh::from_spheres(vec![Sphere::new(Vec3::new(0.0, 1.0, 0.0), 1.0)]);
    let quad = Mesh::from_triangles(
        vec![Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y],
        vec![[0, 1, 2], [0, 2, 3]],
    );
    let turned = Affine3A::from_translation(Vec3::new(-50.0, 0.0, 50.0))
        * Affine3A::from_rotation_x(-std::f32::consts::FRAC_PI_2)
        * Affine3A::from_scale(Vec3::splat(100.0));
    let geometry = Geometry::new(vec![
        GeometryObject::new(ObjectId(3), ball),
        GeometryObject::new(ObjectId(4), quad.unwrap()).with_transform(turned),
    ])
    .unwrap();
    let eye = Affine3A::from_translation(Vec3::new(0.0, 1.0, 5.0));
    let view = View::new(eye, Projection::Perspective { vertical_fov: 1.0 });
    let surroundings = Surroundings::of_scene(&geometry.bounds(), view, &[]);
    let mut fixture = Fixture::new(geometry, surroundings);
    let points = fixture.points();
    let on_ball = points.iter().filter(|p| p.is_there && p.position.y > 0.01);
    let center = Vec3::Y;
    assert!(on_ball.clone().count() > 100);
    for point in on_ball {
        assert!((point.position - center).abs_diff_eq(point.normal, 1e-4));
    }
    let on_floor = points.iter().filter(|p| p.is_there && p.position.y.abs() < 1e-4);
    assert!(on_floor.clone().count() > 100);
    assert!(on_floor.into_iter().all(|point| point.normal.abs_diff_eq(Vec3::Y, 1e-5)));
}
