//! From a document to a scene: movers become nodes with channels, parts become objects.
//!
//! Second 0 of the scene is the start of the interval, and frame `f` of `n` is `f / (n - 1)` of the
//! way to its end, as the format has it. Without an interval, second 0 is time 0 of the file and
//! motion repeats.

use std::collections::BTreeSet;
use std::sync::Arc;

use glam::{Affine3A, DVec3};
use rayflock_geom::{Mesh, Sphere, similarity_scale};
use rayflock_scene::{
    Background, Camera, Channel, Clip, Light, LocalTransform, Node, NodeIdx, Projection, Scene,
    SceneError, SceneObject, Shape, SurfaceAttributes, SurfaceMesh, VertexFrames,
};

use super::curved;
use super::document::{Document, Interval, LightSource, Mover, Place};
use super::kochanek_bartels;
use super::looks::light_kind;
use super::part::{AnimatedSurface, Part, Surface};
use crate::ImportError;
use crate::job::Job;
use crate::mesh_parts::prim_materials;

/// The name of the keys that move the view.
const CAMERA: &str = "camera";
/// Keys of all movers together: movers of one name share those that the file holds.
const KEY_LIMIT: usize = 1 << 22;

/// The scene that a document describes.
pub(super) fn assemble(mut document: Document, job: &mut Job<'_>) -> Result<Scene, ImportError> {
    if document.parts.is_empty() {
        job.warn("shapes", "there are none");
    }
    if document.interval.is_none() && document.motions.values().any(|motion| motion.key_count() > 0)
    {
        job.warn("a", "there is none: motion repeats, at 24 frames a second");
    }
    let camera_mover = add_camera_mover(&mut document);
    let start = document.interval.map_or(0.0, |interval| interval.start);
    let (nodes, node_of) = nodes(&document.movers);
    let channels = channels(&document, &node_of, start, job)?;
    flatten_spheres(&mut document, job)?;
    let mut scene = Scene {
        name: job.name(),
        nodes,
        lights: lights(&document, &node_of),
        cameras: cameras(&document, camera_mover.map(|mover| node_of[mover])),
        clips: Vec::from_iter(
            (!channels.is_empty()).then(|| Clip { name: "animation".into(), channels }),
        ),
        ambient: document.ambient,
        background: Some(Background::Uniform(document.background)),
        frame_rate: document.interval.and_then(|interval| interval.frame_rate()),
        frame_count: document.interval.map(|interval| interval.frame_count),
        ..Scene::default()
    };
    for part in document.parts {
        add_objects(part, &node_of, start, &mut scene, job)?;
    }
    scene.materials = document.materials;
    scene.textures = document.textures.textures;
    Ok(scene)
}

impl Interval {
    /// Frames a second; `None` for a single frame.
    fn frame_rate(&self) -> Option<f64> {
        let steps = (self.frame_count - 1) as f64;
        (steps > 0.0).then(|| steps / (self.end - self.start))
    }
}

/// Adds what carries the view, if keys move it.
fn add_camera_mover(document: &mut Document) -> Option<usize> {
    let view = document.view.filter(|_| document.motions.contains_key(CAMERA))?;
    let (name, rest) = (CAMERA.to_owned(), view.to_parts());
    document.movers.push(Mover { name, place: Place::WORLD, rest });
    Some(document.movers.len() - 1)
}

/// The nodes, and for each mover the one that keys move.
fn nodes(movers: &[Mover]) -> (Vec<Node>, Vec<NodeIdx>) {
    let (mut nodes, mut node_of): (Vec<Node>, Vec<NodeIdx>) = Default::default();
    for mover in movers {
        let mut parent = mover.place.mover.map(|outer: usize| node_of[outer]);
        let mut add = |name: String, rest| {
            nodes.push(Node { name, parent, rest, rest_weights: Vec::new() });
            parent = Some(NodeIdx(nodes.len() as u32 - 1));
        };
        // A static transform around the mover needs a node of its own.
        if mover.place.mover_from_here != Affine3A::IDENTITY {
            let place = LocalTransform::Matrix(mover.place.mover_from_here);
            add(format!("place of {}", mover.name), place);
        }
        add(mover.name.clone(), mover.rest);
        node_of.extend(parent);
    }
    (nodes, node_of)
}

/// What moves the nodes, with warnings for keys without a mover and movers without keys.
fn channels(
    document: &Document,
    node_of: &[NodeIdx],
    start: f64,
    job: &mut Job<'_>,
) -> Result<Vec<Channel>, ImportError> {
    let mut channels = Vec::new();
    let mut key_count = 0;
    let mut idle: BTreeSet<&str> = document.motions.keys().map(String::as_str).collect();
    let mut resting = BTreeSet::new();
    for (mover, &node) in document.movers.iter().zip(node_of) {
        let Some(motion) = document.motions.get(&mover.name) else {
            resting.insert(mover.name.as_str());
            continue;
        };
        idle.remove(mover.name.as_str());
        key_count += motion.key_count();
        if key_count > KEY_LIMIT {
            let (file, element) = (job.file.to_owned(), format!("k \"{}\"", mover.name));
            let (found, limit) = (format!("{key_count} keys"), format!("{KEY_LIMIT} keys"));
            return Err(ImportError::TooLarge { file, element, found, limit });
        }
        channels.extend(kochanek_bartels::channels(motion, node, start));
    }
    let quoted = |names: BTreeSet<&str>| Vec::from_iter(names).join(", ");
    if !idle.is_empty() {
        job.warn("k", format!("the keys for {} move nothing", quoted(idle)));
    }
    if !resting.is_empty() {
        job.warn("x", format!("there are no keys for {}; they rest", quoted(resting)));
    }
    Ok(channels)
}

/// Makes triangles of spheres that motion stretches.
fn flatten_spheres(document: &mut Document, job: &mut Job<'_>) -> Result<(), ImportError> {
    let mut is_even: Vec<bool> = Vec::with_capacity(document.movers.len());
    for mover in &document.movers {
        let scale = document.motions.get(&mover.name).map(|motion| motion.scale.as_slice());
        let grows_evenly =
            scale.unwrap_or_default().iter().all(|key| key.value == DVec3::splat(key.value.x));
        let is_placed_evenly = similarity_scale(&mover.place.mover_from_here).is_some();
        let outside_is_even = mover.place.mover.is_none_or(|outer| is_even[outer]);
        is_even.push(grows_evenly && is_placed_evenly && outside_is_even);
    }
    let is_stretched = |part: &Part| part.mover.is_some_and(|mover| !is_even[mover]);
    let stretched = document.parts.iter().filter(|part| is_stretched(part));
    let count: usize = stretched.map(|part| part.spheres.len()).sum();
    if count == 0 {
        return Ok(());
    }
    if count > curved::LIMIT / curved::SPHERE_TRIANGLES {
        let found = format!("{} triangles of {count}", count * curved::SPHERE_TRIANGLES);
        let (file, element) = (job.file.to_owned(), "stretched spheres".to_owned());
        let limit = curved::LIMIT.to_string();
        return Err(ImportError::TooLarge { file, element, found, limit });
    }
    job.warn("spheres", format!("{count} are stretched by keys; they become triangles"));
    let stretched = document.parts.iter_mut().filter(|part| is_stretched(part));
    stretched.for_each(Part::flatten_spheres);
    Ok(())
}

fn lights(document: &Document, node_of: &[NodeIdx]) -> Vec<Light> {
    let light = |source: &LightSource| Light {
        name: source.name.clone(),
        node: source.mover.map(|mover| node_of[mover]),
        kind: light_kind(source.position, source.color),
    };
    document.lights.iter().map(light).collect()
}

/// The view; on the node that keys move, if they do.
fn cameras(document: &Document, node: Option<NodeIdx>) -> Vec<Camera> {
    let camera = document.view.map(|view| Camera {
        name: CAMERA.to_owned(),
        node,
        node_from_camera: if node.is_some() { Affine3A::IDENTITY } else { view.to_affine() },
        projection: Projection::Perspective { vertical_fov: view.vertical_fov },
    });
    Vec::from_iter(camera)
}

/// Adds the objects of a part: one for each kind of surface that it has.
fn add_objects(
    part: Part,
    node_of: &[NodeIdx],
    start: f64,
    scene: &mut Scene,
    job: &mut Job<'_>,
) -> Result<(), ImportError> {
    let element = format!("object \"{}\"", part.name);
    let mut shapes = Vec::new();
    for surface in [part.flat, part.smooth] {
        if !surface.materials.is_empty() {
            shapes.push(Shape::Fixed(fixed_surface(surface, &element, job)?));
        }
    }
    if !part.spheres.is_empty() {
        shapes.push(Shape::Fixed(spheres(&part.spheres, &element, job)));
    }
    for surface in part.animated {
        let frames = animated_surface(surface, start)
            .map_err(|error| job.invalid(&element, error.to_string(), "keys that fit"))?;
        shapes.push(Shape::Animated(Arc::new(frames)));
    }
    let node = part.mover.map(|mover| node_of[mover]);
    scene.objects.extend(shapes.into_iter().map(|shape| SceneObject {
        name: part.name.clone(),
        node,
        mask: u32::MAX,
        shape,
    }));
    Ok(())
}

fn fixed_surface(
    surface: Surface,
    element: &str,
    job: &mut Job<'_>,
) -> Result<SurfaceMesh, ImportError> {
    let Surface { mut parts, materials, is_textured } = surface;
    parts.materials = prim_materials(&materials);
    if !is_textured {
        parts.uvs.clear();
    }
    parts.build(element, job)
}

fn spheres(spheres: &[(Sphere, u32)], element: &str, job: &mut Job<'_>) -> SurfaceMesh {
    let (spheres, materials): (Vec<Sphere>, Vec<u32>) = spheres.iter().copied().unzip();
    let invalid_count = spheres.iter().filter(|sphere| !sphere.is_valid()).count();
    if invalid_count > 0 {
        let message = format!("{invalid_count} spheres have no finite, positive radius; ignored");
        job.warn(element, message);
    }
    let materials = prim_materials(&materials);
    SurfaceMesh {
        mesh: Arc::new(Mesh::from_spheres(spheres)),
        normals: Arc::default(),
        attributes: Arc::new(SurfaceAttributes { materials, ..SurfaceAttributes::default() }),
    }
}

fn animated_surface(surface: AnimatedSurface, start: f64) -> Result<VertexFrames, SceneError> {
    let AnimatedSurface { mut keys, materials } = surface;
    let corners: Vec<u32> = (0..3 * materials.len() as u32).collect();
    let rest = keys.first().map(|key| key.positions.clone()).unwrap_or_default();
    let mesh = Mesh::from_triangles(rest, corners.as_chunks::<3>().0)?;
    let materials = prim_materials(&materials);
    let topology = SurfaceMesh {
        mesh: Arc::new(mesh),
        normals: Arc::default(),
        attributes: Arc::new(SurfaceAttributes { materials, ..SurfaceAttributes::default() }),
    };
    keys.iter_mut().for_each(|key| key.time -= start);
    VertexFrames::new(&topology, keys)
}
