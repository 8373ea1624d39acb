//! Morph targets, then a skin: where the vertices of a bent mesh are.
//!
//! A morphed vertex is the vertex at rest plus each target's offset times its weight. A skinned
//! vertex is moved by one matrix: the sum of its joints' matrices in the proportion of its weights
//! (linear blend skinning). Normals follow the inverse transpose of that same matrix, which stays
//! right where joints scale unevenly; it is formed from the cross products of the columns, so that
//! it exists where the matrix is singular.
//!
//! **Source.** glTF 2.0 specification, sections 3.7.2.2 (morph targets) and 3.7.3 (skins).
//!
//! **Departures.** Joint matrices lead to world space, not to the space of the scene root.
//!
//! **Cost.** Linear in vertices times (targets with a weight other than 0, plus joints a vertex).

use glam::{Affine3A, Mat3A, Vec3};

use crate::VertexInfluences;

/// Sets `column` to `rest` plus the `offsets` times their weights. Offset columns are empty or as
/// long as `rest`, as `column` is.
pub(crate) fn morph<'a>(
    rest: &[Vec3],
    offsets: impl Iterator<Item = (&'a [Vec3], f32)>,
    column: &mut [Vec3],
) {
    column.copy_from_slice(rest);
    for (offsets, weight) in offsets.filter(|&(_, weight)| weight != 0.0) {
        for (value, offset) in column.iter_mut().zip(offsets) {
            *value += weight * *offset;
        }
    }
}

/// Moves `positions` and turns `normals` by the joints they follow. `normals` is empty or as long
/// as `positions`; the lengths of normals become arbitrary.
pub(crate) fn skin(
    world_from_rest: &[Affine3A],
    influences: &[VertexInfluences],
    positions: &mut [Vec3],
    normals: &mut [Vec3],
) {
    let mut normals = normals.iter_mut();
    for (position, influences) in positions.iter_mut().zip(influences) {
        let blended = blend(world_from_rest, influences);
        *position = blended.transform_point3(*position);
        if let Some(normal) = normals.next() {
            *normal = normal_matrix(&blended.matrix3) * *normal;
        }
    }
}

/// Gives `normals` unit length; one without a direction becomes that at rest.
pub(crate) fn normalize(rest: &[Vec3], normals: &mut [Vec3]) {
    for (normal, rest) in normals.iter_mut().zip(rest) {
        *normal = normal.normalize_or(*rest);
    }
}

/// The sum of the joints' matrices in the proportion of the weights.
fn blend(world_from_rest: &[Affine3A], influences: &VertexInfluences) -> Affine3A {
    let mut sum = Affine3A::ZERO;
    for (&joint, &weight) in influences.joints.iter().zip(&influences.weights) {
        if weight != 0.0 {
            let joint = &world_from_rest[usize::from(joint)];
            sum.matrix3 += joint.matrix3 * weight;
            sum.translation += joint.translation * weight;
        }
    }
    sum
}

/// The inverse transpose, up to a positive factor.
fn normal_matrix(m: &Mat3A) -> Mat3A {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let cofactors = Mat3A::from_cols(y.cross(z), z.cross(x), x.cross(y));
    if x.dot(cofactors.x_axis) < 0.0 { -cofactors } else { cofactors }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use glam::Quat;
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn morphs_add_up_in_proportion() {
        let rest = [Vec3::ZERO, Vec3::ONE];
        let targets: [&[Vec3]; 3] = [&[Vec3::X, Vec3::Y], &[Vec3::Z, Vec3::Z], &[]];
        let mut column = [Vec3::ZERO; 2];
        morph(&rest, targets.into_iter().zip([0.5, 2.0, 1.0]), &mut column);
        assert_eq!(column, [Vec3::new(0.5, 0.0, 2.0), Vec3::new(1.0, 1.5, 3.0)]);
    }

    #[test]
    fn a_vertex_between_two_joints_goes_halfway() {
        let joints = [Affine3A::IDENTITY, Affine3A::from_translation(Vec3::new(0.0, 2.0, 0.0))];
        let half = VertexInfluences::new([(0, 0.5), (1, 0.5)]);
        let second = VertexInfluences::new([(1, 1.0)]);
        let mut positions = [Vec3::X, Vec3::X];
        skin(&joints, &[half, second], &mut positions, &mut []);
        assert_eq!(positions, [Vec3::new(1.0, 1.0, 0.0), Vec3::new(1.0, 2.0, 0.0)]);
    }

    #[test]
    fn a_quarter_turn_turns_position_and_normal() {
        let joints = [Affine3A::from_rotation_z(FRAC_PI_2)];
        let influences = [VertexInfluences::new([(0, 1.0)])];
        let (mut positions, mut normals) = ([Vec3::X], [Vec3::Y]);
        skin(&joints, &influences, &mut positions, &mut normals);
        assert!(positions[0].distance(Vec3::Y) < 1e-6);
        assert!(normals[0].distance(-Vec3::X) < 1e-6);
    }

    #[test]
    fn a_normal_without_direction_is_that_at_rest() {
        let mut normals = [Vec3::ZERO, Vec3::new(0.0, 3.0, 4.0), Vec3::NAN];
        normalize(&[Vec3::X; 3], &mut normals);
        assert_eq!(normals, [Vec3::X, Vec3::new(0.0, 0.6, 0.8), Vec3::X]);
    }

    proptest! {
        /// A normal stays at right angles to what it was at right angles to, and on its side.
        #[test]
        fn normals_stay_square_to_their_surface(
            scale in prop::array::uniform3(0.2..3.0_f32), mirrored: bool,
            turn in prop::array::uniform3(-3.0..3.0_f32), normal in prop::array::uniform3(-1.0..1.0_f32),
        ) {
            let normal = Vec3::from(normal).normalize_or(Vec3::Y);
            let mut scale = Vec3::from(scale);
            scale.x = if mirrored { -scale.x } else { scale.x };
            let turn = Quat::from_scaled_axis(Vec3::from(turn));
            let m = Affine3A::from_scale_rotation_translation(scale, turn, Vec3::ONE).matrix3;
            let turned = (normal_matrix(&m) * normal).normalize();
            let (tangent, bitangent) = normal.any_orthonormal_pair();
            prop_assert!(turned.dot(m * tangent).abs() < 1e-4);
            prop_assert!(turned.dot(m * bitangent).abs() < 1e-4);
            prop_assert!(turned.dot(m * normal) > 0.0);
        }
    }
}
