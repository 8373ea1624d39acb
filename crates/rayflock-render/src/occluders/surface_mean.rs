//! What points of a surface have in common: where they are, and along which line they face.
//!
//! A normal and its opposite count alike, since both sides of a thin wall are best stood for by one
//! sphere. So directions are averaged as products of a normal with itself, whose distance from each
//! other is 0 along one line, and largest across it.

use glam::{DMat3, DVec3, Mat3, Vec3};

use super::cluster::WeightedPoint;

/// The means of positions and of products of normals with themselves, by weight.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SurfaceMean {
    pub(super) position: Vec3,
    pub(super) facing: Mat3,
}

impl SurfaceMean {
    /// Of points; all count alike where no weight is above 0.
    pub(super) fn of(points: &[WeightedPoint]) -> Self {
        let has_weight = points.iter().any(|point| point.weight > 0.0);
        let (mut position, mut facing, mut total) = (DVec3::ZERO, DMat3::ZERO, 0.0);
        for point in points {
            let weight = if has_weight { f64::from(point.weight) } else { 1.0 };
            position += weight * point.position.as_dvec3();
            facing += weight * along(point.normal).as_dmat3();
            total += weight;
        }
        let share = 1.0 / f64::max(total, f64::MIN_POSITIVE);
        Self { position: (share * position).as_vec3(), facing: (share * facing).as_mat3() }
    }

    /// How far a point is from the mean, squared; `turn` is what it counts to face across.
    #[inline]
    pub(super) fn distance_squared(&self, point: &WeightedPoint, turn: f32) -> f32 {
        let normal = point.normal;
        let length_squared = normal.length_squared();
        let common = normal.dot(self.facing * normal);
        let across = length_squared * length_squared - 2.0 * common + size_squared(&self.facing);
        self.position.distance_squared(point.position) + 0.5 * turn * across
    }
}

/// A normal as a line.
pub(super) fn along(normal: Vec3) -> Mat3 {
    Mat3::from_cols(normal.x * normal, normal.y * normal, normal.z * normal)
}

/// The sum of all squares.
fn size_squared(facing: &Mat3) -> f32 {
    facing.to_cols_array().iter().map(|value| value * value).sum()
}

/// The line that most of a surface faces along, and the mean of the squared cosines to it; zero
/// where nothing faces anywhere.
pub(super) fn main_line(facing: &Mat3) -> (Vec3, f32) {
    let mut power = *facing;
    for _ in 0..6 {
        // The largest eigenvalue outgrows the others.
        let scale = size_squared(&power).sqrt().max(f32::MIN_POSITIVE);
        power *= 1.0 / scale;
        power = power * power;
    }
    let columns = [power.x_axis, power.y_axis, power.z_axis];
    let longest = columns.into_iter().max_by(|a, b| a.length().total_cmp(&b.length()));
    let line = longest.unwrap_or_default().normalize_or_zero();
    (line, line.dot(*facing * line))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn facing(normals: &[Vec3]) -> SurfaceMean {
        let point = |(idx, &normal)| WeightedPoint { normal, ..WeightedPoint::at(Vec3::ZERO, idx) };
        SurfaceMean::of(&(0..).zip(normals).map(point).collect::<Vec<_>>())
    }

    #[test]
    fn both_sides_of_a_wall_face_along_one_line() {
        let slanted = Vec3::new(0.6, 0.0, 0.8);
        let (line, share) = main_line(&facing(&[slanted, -slanted]).facing);
        assert!((line.dot(slanted).abs() - 1.0).abs() < 1e-5, "{line}");
        assert!((share - 1.0).abs() < 1e-5, "{share}");
    }

    #[test]
    fn a_cube_faces_along_no_line_more_than_another() {
        let (_, share) = main_line(&facing(&[Vec3::X, Vec3::Y, Vec3::Z]).facing);
        assert!((share - 1.0 / 3.0).abs() < 1e-5, "{share}");
        assert_eq!(main_line(&facing(&[Vec3::ZERO]).facing), (Vec3::ZERO, 0.0));
    }

    #[test]
    fn to_face_across_counts_as_much_as_asked() {
        let mean = facing(&[Vec3::Y]);
        let squared = |normal| {
            let point = WeightedPoint { normal, ..WeightedPoint::at(Vec3::X, 0) };
            mean.distance_squared(&point, 4.0)
        };
        assert_eq!([Vec3::Y, Vec3::NEG_Y, Vec3::X].map(squared), [1.0, 1.0, 5.0]);
    }
}
