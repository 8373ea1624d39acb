//! The node hierarchy: places that carry objects, lights and cameras, and that clips move.

use glam::{Affine3A, Mat4, Quat, Vec3};

/// Position of a node in [`Scene::nodes`](crate::Scene::nodes).
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeIdx(pub u32);

/// A place relative to its parent.
#[derive(Clone, Debug, PartialEq)]
pub struct Node {
    /// Name in the file, for messages.
    pub name: String,
    /// The node this one hangs on; parents may come before or after their children.
    pub parent: Option<NodeIdx>,
    /// The place at rest, where no clip moves it.
    pub rest: LocalTransform,
    /// Weights of the morph targets of the objects on this node, at rest.
    pub rest_weights: Vec<f32>,
}

/// A transform relative to the parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LocalTransform {
    /// In parts, which clips can replace: `translation * rotation * scale`.
    Parts {
        /// Translation.
        translation: Vec3,
        /// Rotation, of unit length.
        rotation: Quat,
        /// Scale along each axis.
        scale: Vec3,
    },
    /// Any affine transform. A clip that moves the node takes the matrix apart first, and loses
    /// its shear.
    Matrix(Affine3A),
}

impl LocalTransform {
    /// No transform.
    pub const IDENTITY: Self =
        Self::Parts { translation: Vec3::ZERO, rotation: Quat::IDENTITY, scale: Vec3::ONE };

    /// The transform as a matrix.
    pub fn to_affine(&self) -> Affine3A {
        match *self {
            Self::Parts { translation, rotation, scale } => {
                Affine3A::from_scale_rotation_translation(scale, rotation, translation)
            }
            Self::Matrix(affine) => affine,
        }
    }

    /// The transform in parts: without shear, and only the translation of a singular matrix.
    pub(crate) fn in_parts(&self) -> Self {
        let Self::Matrix(affine) = self else { return *self };
        let (scale, rotation, translation) = affine.to_scale_rotation_translation();
        if scale.is_finite() && rotation.is_finite() && rotation.length_squared().is_normal() {
            Self::Parts { translation, rotation: rotation.normalize(), scale }
        } else {
            Self::Parts { translation, rotation: Quat::IDENTITY, scale: Vec3::ONE }
        }
    }
}

impl From<Mat4> for LocalTransform {
    fn from(matrix: Mat4) -> Self {
        Self::Matrix(Affine3A::from_mat4(matrix))
    }
}
