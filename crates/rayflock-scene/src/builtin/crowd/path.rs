//! Where figures walk: ellipses, walked at constant speed.

use std::f32::consts::TAU;

use glam::{Quat, Vec2, Vec3};

/// An ellipse on the ground.
#[derive(Clone, Copy, Debug)]
pub(super) struct Route {
    /// The middle, along +X and +Z.
    pub(super) center: [f32; 2],
    /// Half the axes.
    pub(super) radii: [f32; 2],
    /// How far the ellipse is turned, in radians.
    pub(super) turn: f32,
    /// Whether it is walked against the clock as seen from above, or with it.
    pub(super) against_clock: bool,
}

/// An ellipse measured along its curve.
#[derive(Clone, Debug)]
pub(super) struct Path {
    route: Route,
    /// Distance along the curve at each of [`STEPS`] equal angles.
    distances: Vec<f32>,
}

const STEPS: usize = 512;

impl Path {
    pub(super) fn new(route: &Route) -> Self {
        let mut distances = vec![0.0];
        let mut distance = 0.0;
        for step in 0..STEPS {
            let [a, b] = [step, step + 1].map(|step| route.point(step as f32 / STEPS as f32));
            distance += a.distance(b);
            distances.push(distance);
        }
        Self { route: *route, distances }
    }

    /// Length of one lap.
    pub(super) fn length(&self) -> f32 {
        self.distances[STEPS]
    }

    /// The share of the full angle at which `lap` laps have been walked.
    fn angle_share(&self, lap: f32) -> f32 {
        let distance = lap.rem_euclid(1.0) * self.length();
        let after = self.distances.partition_point(|&d| d <= distance).clamp(1, STEPS);
        let [low, high] = [self.distances[after - 1], self.distances[after]];
        ((after - 1) as f32 + (distance - low) / (high - low)) / STEPS as f32
    }

    /// The place after `lap` laps.
    pub(super) fn position(&self, lap: f32) -> Vec3 {
        let point = self.route.point(self.angle_share(lap));
        Vec3::new(point.x, 0.0, point.y)
    }

    /// The turn that makes +Z point along the way after `lap` laps.
    pub(super) fn heading(&self, lap: f32) -> Quat {
        let ahead = self.position(lap + 0.002) - self.position(lap - 0.002);
        Quat::from_rotation_y(ahead.x.atan2(ahead.z))
    }
}

impl Route {
    fn point(&self, share: f32) -> Vec2 {
        let direction = if self.against_clock { -1.0 } else { 1.0 };
        let along = Vec2::from_angle(direction * TAU * share) * Vec2::from(self.radii);
        Vec2::from(self.center) + Vec2::from_angle(self.turn).rotate(along)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROUTE: Route =
        Route { center: [1.0, 2.0], radii: [3.0, 1.5], turn: 0.4, against_clock: true };

    #[test]
    fn speed_is_constant_and_the_lap_closes() {
        let path = Path::new(&ROUTE);
        let step = path.length() / 100.0;
        for lap in 0..100 {
            let [a, b] = [lap, lap + 1].map(|lap| path.position(lap as f32 / 100.0));
            assert!((a.distance(b) / step - 1.0).abs() < 0.01);
        }
        assert!(path.position(0.0).distance(path.position(1.0)) < 1e-4);
    }

    #[test]
    fn figures_look_where_they_go() {
        let path = Path::new(&ROUTE);
        let way = path.position(0.31) - path.position(0.30);
        assert!((path.heading(0.305) * Vec3::Z).dot(way.normalize()) > 0.999);
    }
}
