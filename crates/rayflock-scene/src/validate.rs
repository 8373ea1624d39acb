//! Whether what an importer or a generator hands over hangs together.
//!
//! Evaluating and shading index without asking: these checks, made once for each scene and once
//! for each mesh that an [`AnimatedMesh`](crate::AnimatedMesh) makes, are why they may. Numbers
//! need no checks: what is not finite is ignored by engines.
//!
//! **Cost.** Linear in the lengths of the columns that hold positions of other things.

use crate::{
    Channel, ChannelValues, Clip, MorphTarget, NodeIdx, PrimMaterials, Scene, SceneError,
    SceneObject, Shape, Skin, SurfaceMesh,
};

/// Checks a scene of which `clip` is to be played: that everything named is there, and that
/// columns have the lengths they should.
///
/// # Errors
/// [`SceneError`] for the first thing wrong.
pub(crate) fn check(scene: &Scene, clip: Option<&Clip>) -> Result<(), SceneError> {
    check_nodes(scene)?;
    check_looks(scene)?;
    for object in &scene.objects {
        check_object(scene, object)?;
    }
    clip.map_or(Ok(()), |clip| check_clip(scene, clip))
}

/// Checks that the mesh of the object called `name` has columns of the right lengths and names
/// materials that are there.
pub(crate) fn check_surface(
    surface: &SurfaceMesh,
    name: &str,
    material_count: usize,
) -> Result<(), SceneError> {
    let label = || format!("object \"{name}\"");
    let vertex_count = surface.mesh.vertices().len();
    let attributes = &surface.attributes;
    check_column(label, "normals", surface.normals.len(), vertex_count)?;
    check_column(label, "texture coordinates", attributes.uvs.len(), vertex_count)?;
    check_column(label, "vertex colours", attributes.colors.len(), vertex_count)?;
    let check_material = |idx| check_idx(label, "material", idx, material_count);
    match &attributes.materials {
        PrimMaterials::Uniform(material) => check_material(material.0 as usize),
        PrimMaterials::PerPrim(materials) => {
            let prim_count = surface.mesh.prim_count();
            check_length(label, "materials of primitives", materials.len(), prim_count)?;
            materials.iter().try_for_each(|material| check_material(material.0 as usize))
        }
    }
}

/// Checks what nodes, lights and cameras hang on.
fn check_nodes(scene: &Scene) -> Result<(), SceneError> {
    for node in &scene.nodes {
        check_node_idx(scene, || format!("node \"{}\"", node.name), node.parent)?;
    }
    for light in &scene.lights {
        check_node_idx(scene, || format!("light \"{}\"", light.name), light.node)?;
    }
    for camera in &scene.cameras {
        check_node_idx(scene, || format!("camera \"{}\"", camera.name), camera.node)?;
    }
    Ok(())
}

/// Checks materials and textures.
fn check_looks(scene: &Scene) -> Result<(), SceneError> {
    for material in &scene.materials {
        if let Some(texture) = material.diffuse_texture {
            let label = || format!("material \"{}\"", material.name);
            check_idx(label, "texture", texture.0 as usize, scene.textures.len())?;
        }
    }
    for texture in &scene.textures {
        let label =
            || format!("texture \"{}\" of {} x {}", texture.name, texture.width, texture.height);
        let expected = texture.width.saturating_mul(texture.height);
        check_length(label, "texels", texture.texels.len(), expected)?;
        if expected == 0 {
            return Err(SceneError::Empty { element: label(), what: "texels" });
        }
    }
    Ok(())
}

fn check_object(scene: &Scene, object: &SceneObject) -> Result<(), SceneError> {
    let label = || format!("object \"{}\"", object.name);
    check_node_idx(scene, label, object.node)?;
    match &object.shape {
        Shape::Fixed(surface) => check_surface(surface, &object.name, scene.materials.len()),
        Shape::Deformed { rest, targets, skin } => {
            check_surface(rest, &object.name, scene.materials.len())?;
            let vertex_count = rest.mesh.vertices().len();
            for (target_idx, target) in targets.iter().enumerate() {
                let label = || format!("morph target {target_idx} of {}", label());
                check_target(label, target, vertex_count)?;
            }
            let label = || format!("the skin of {}", label());
            skin.as_ref().map_or(Ok(()), |skin| check_skin(scene, label, skin, vertex_count))
        }
        // Its meshes are checked when they are made.
        Shape::Animated(_) => Ok(()),
    }
}

fn check_target(
    label: impl Fn() -> String,
    target: &MorphTarget,
    vertex_count: usize,
) -> Result<(), SceneError> {
    check_column(&label, "position offsets", target.positions.len(), vertex_count)?;
    check_column(&label, "normal offsets", target.normals.len(), vertex_count)
}

fn check_skin(
    scene: &Scene,
    label: impl Fn() -> String,
    skin: &Skin,
    vertex_count: usize,
) -> Result<(), SceneError> {
    for &(joint, _) in &skin.joints {
        check_node_idx(scene, &label, Some(joint))?;
    }
    check_length(&label, "influences of vertices", skin.influences.len(), vertex_count)?;
    for influences in &skin.influences {
        for (&joint, &weight) in influences.joints.iter().zip(&influences.weights) {
            if weight != 0.0 {
                check_idx(&label, "joint", usize::from(joint), skin.joints.len())?;
            }
        }
    }
    Ok(())
}

fn check_clip(scene: &Scene, clip: &Clip) -> Result<(), SceneError> {
    for (channel_idx, channel) in clip.channels.iter().enumerate() {
        let label = || format!("channel {channel_idx} of clip \"{}\"", clip.name);
        check_node_idx(scene, label, Some(channel.node))?;
        check_times(label, &channel.times)?;
        check_values(label, channel)?;
        if let ChannelValues::Weights { weights_per_key, .. } = channel.values {
            check_weights(scene, label, channel.node, weights_per_key)?;
        }
    }
    Ok(())
}

/// Checks that there are key times, finite and never decreasing.
fn check_times(label: impl Fn() -> String, times: &[f32]) -> Result<(), SceneError> {
    if times.is_empty() {
        return Err(SceneError::Empty { element: label(), what: "keys" });
    }
    let wrong = |key_idx: usize, expected| {
        let (element, time) = (label(), times[key_idx].to_string());
        Err(SceneError::KeyTime { element, key_idx, time, expected })
    };
    if let Some(key_idx) = times.iter().position(|time| !time.is_finite()) {
        return wrong(key_idx, "a finite number");
    }
    if let Some(key_idx) = times.windows(2).position(|pair| pair[1] < pair[0]) {
        return wrong(key_idx + 1, "a time not before that of the key before");
    }
    Ok(())
}

/// Checks that there is a value, or with tangents or controls three, for each key time.
fn check_values(label: impl Fn() -> String, channel: &Channel) -> Result<(), SceneError> {
    let value_count = channel.times.len() * channel.interpolation.values_per_key();
    let (found, expected) = match &channel.values {
        ChannelValues::Translation(values) | ChannelValues::Scale(values) => {
            (values.len(), value_count)
        }
        ChannelValues::Rotation(values) => (values.len(), value_count),
        ChannelValues::Visibility(values) => (values.len(), channel.times.len()),
        ChannelValues::Weights { weights_per_key, values } => {
            (values.len(), value_count.saturating_mul(*weights_per_key))
        }
    };
    check_length(label, "values", found, expected)
}

/// Checks that each key has as many weights as each object on the node has morph targets.
fn check_weights(
    scene: &Scene,
    label: impl Fn() -> String,
    node: NodeIdx,
    weights_per_key: usize,
) -> Result<(), SceneError> {
    for object in scene.objects.iter().filter(|object| object.node == Some(node)) {
        if let Shape::Deformed { targets, .. } = &object.shape
            && !targets.is_empty()
        {
            let label = || format!("{} for object \"{}\"", label(), object.name);
            check_length(label, "weights a key", weights_per_key, targets.len())?;
        }
    }
    Ok(())
}

fn check_node_idx(
    scene: &Scene,
    label: impl Fn() -> String,
    node: Option<NodeIdx>,
) -> Result<(), SceneError> {
    node.map_or(Ok(()), |node| check_idx(label, "node", node.0 as usize, scene.nodes.len()))
}

fn check_idx(
    label: impl Fn() -> String,
    what: &'static str,
    idx: usize,
    count: usize,
) -> Result<(), SceneError> {
    if idx < count {
        return Ok(());
    }
    Err(SceneError::Index { element: label(), what, idx, count })
}

/// Checks a column that may be empty.
fn check_column(
    label: impl Fn() -> String,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SceneError> {
    if found == 0 { Ok(()) } else { check_length(label, what, found, expected) }
}

fn check_length(
    label: impl Fn() -> String,
    what: &'static str,
    found: usize,
    expected: usize,
) -> Result<(), SceneError> {
    if found == expected {
        return Ok(());
    }
    Err(SceneError::Length { element: label(), what, found, expected })
}
