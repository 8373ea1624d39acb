//! Skins: joints and the vertices that follow them.

use std::collections::HashMap;
use std::sync::Arc;

use glam::{Affine3A, Mat4};
use gltf::json::{Skin as JsonSkin, root::Index};
use rayflock_scene::{NodeIdx, Skin, VertexInfluences};

use super::accessor::{Accessors, FLOAT, Purpose};
use super::label;
use super::mesh::Primitive;
use crate::ImportError;

/// The joints of a skin with the transforms from the mesh at rest to each.
type Joints = Vec<(NodeIdx, Affine3A)>;

/// Skins as they are asked for, each bound to a primitive once.
#[derive(Debug, Default)]
pub(super) struct SkinLibrary {
    joints: HashMap<usize, Joints>,
    bound: HashMap<(usize, usize, usize), Arc<Skin>>,
}

impl SkinLibrary {
    /// The skin for the primitive `key` = (mesh, primitive).
    pub(super) fn bind(
        &mut self,
        skin: Index<JsonSkin>,
        key: (usize, usize),
        influences: &[VertexInfluences],
        primitive: &Primitive,
        accessors: &Accessors<'_>,
    ) -> Result<Arc<Skin>, ImportError> {
        let key = (skin.value(), key.0, key.1);
        if let Some(bound) = self.bound.get(&key) {
            return Ok(Arc::clone(bound));
        }
        let joints = match self.joints.get(&skin.value()) {
            Some(joints) => joints.clone(),
            None => {
                let joints = load_joints(skin, accessors)?;
                self.joints.insert(skin.value(), joints.clone());
                joints
            }
        };
        check_influences(skin, influences, joints.len(), primitive, accessors)?;
        accessors.charge::<VertexInfluences>(influences.len()).map_err(|(found, expected)| {
            ImportError::invalid(accessors.file, &primitive.element, found, expected)
        })?;
        let bound = Arc::new(Skin { joints, influences: influences.to_vec() });
        self.bound.insert(key, Arc::clone(&bound));
        Ok(bound)
    }
}

fn load_joints(skin: Index<JsonSkin>, accessors: &Accessors<'_>) -> Result<Joints, ImportError> {
    let json = &accessors.root.skins[skin.value()];
    let skin_label = label("skin", skin.value(), json.name.as_ref());
    let mut matrices = vec![Affine3A::IDENTITY; json.joints.len()];
    if let Some(accessor) = json.inverse_bind_matrices {
        let element = format!("{skin_label} inverseBindMatrices");
        let purpose = Purpose { element: &element, components: FLOAT, count: None };
        let stored: Vec<[f32; 16]> = accessors.floats(accessor, purpose)?;
        if stored.len() < matrices.len() {
            let found = format!("{} matrices", stored.len());
            let expected = format!("one for each of {} joints", matrices.len());
            return Err(ImportError::invalid(accessors.file, element, found, expected));
        }
        for (joint_idx, (matrix, stored)) in matrices.iter_mut().zip(&stored).enumerate() {
            *matrix = Affine3A::from_mat4(Mat4::from_cols_array(stored));
            if !matrix.is_finite() {
                let found = format!("matrix {joint_idx} with numbers that are not finite");
                return Err(ImportError::invalid(accessors.file, element, found, "finite numbers"));
            }
        }
    }
    let nodes = json.joints.iter().map(|joint| NodeIdx(joint.value() as u32));
    Ok(nodes.zip(matrices).collect())
}

fn check_influences(
    skin: Index<JsonSkin>,
    influences: &[VertexInfluences],
    joint_count: usize,
    primitive: &Primitive,
    accessors: &Accessors<'_>,
) -> Result<(), ImportError> {
    for (vertex_idx, influence) in influences.iter().enumerate() {
        for (&joint, &weight) in influence.joints.iter().zip(&influence.weights) {
            if weight > 0.0 && usize::from(joint) >= joint_count {
                let element = format!("{} vertex {vertex_idx}", primitive.element);
                let found = format!("joint {joint}");
                let name = accessors.root.skins[skin.value()].name.as_ref();
                let skin = label("skin", skin.value(), name);
                let expected = format!("one of the {joint_count} joints of {skin}");
                return Err(ImportError::invalid(accessors.file, element, found, expected));
            }
        }
    }
    Ok(())
}
