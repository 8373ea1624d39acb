//! Primitives: triangles with their attributes and morph targets.

use std::collections::HashMap;
use std::collections::hash_map::Entry;
use std::sync::Arc;

use glam::{Affine2, Vec2, Vec3};
use gltf::json::mesh::{Mesh as JsonMesh, Mode, Primitive as JsonPrimitive, Semantic};
use gltf::json::validation::Checked;
use gltf::json::{accessor::Accessor, root::Index, texture::Info};
use rayflock_scene::{MorphTarget, PrimMaterials, SurfaceMesh, VertexInfluences};

use super::accessor::{Accessors, FLOAT, INDEX, Purpose, UNIT};
use super::{label, material};
use crate::ImportError;
use crate::job::Job;
use crate::mesh_parts::MeshParts;

/// A primitive as all nodes with its mesh share it.
#[derive(Debug)]
pub(super) struct Primitive {
    /// How messages call it.
    pub(super) element: String,
    pub(super) surface: SurfaceMesh,
    pub(super) targets: Arc<[MorphTarget]>,
    /// One entry a vertex; `None` where the primitive has no joints.
    pub(super) influences: Option<Vec<VertexInfluences>>,
}

/// Meshes as they are asked for, each loaded once.
#[derive(Debug, Default)]
pub(super) struct MeshLibrary {
    meshes: HashMap<usize, Vec<(usize, Primitive)>>,
}

impl MeshLibrary {
    /// The drawable primitives of a mesh with their positions in it.
    pub(super) fn primitives(
        &mut self,
        mesh: Index<JsonMesh>,
        accessors: &Accessors<'_>,
        job: &mut Job<'_>,
    ) -> Result<&[(usize, Primitive)], ImportError> {
        let entry = match self.meshes.entry(mesh.value()) {
            Entry::Occupied(entry) => return Ok(entry.into_mut()),
            Entry::Vacant(entry) => entry,
        };
        let json = &accessors.root.meshes[mesh.value()];
        let mesh_label = label("mesh", mesh.value(), json.name.as_ref());
        check_target_counts(json, &mesh_label, job)?;
        let mut loaded = Vec::new();
        for (idx, primitive) in json.primitives.iter().enumerate() {
            let element = format!("{mesh_label} primitive {idx}");
            let source = Source { json: primitive, element, accessors };
            if let Some(primitive) = source.load(job)? {
                loaded.push((idx, primitive));
            }
        }
        Ok(entry.insert(loaded))
    }
}

/// Checks that weights mean the same for every primitive.
fn check_target_counts(json: &JsonMesh, element: &str, job: &Job<'_>) -> Result<(), ImportError> {
    let count = |primitive: &JsonPrimitive| primitive.targets.as_ref().map_or(0, Vec::len);
    let expected = json.primitives.first().map_or(0, count);
    match json.primitives.iter().map(count).find(|&count| count != expected) {
        None => Ok(()),
        Some(found) => {
            let found = format!("primitives with {expected} and with {found} morph targets");
            Err(job.invalid(element, found, "as many in each primitive"))
        }
    }
}

/// A primitive being read.
pub(super) struct Source<'a> {
    json: &'a JsonPrimitive,
    /// How messages call it.
    pub(super) element: String,
    pub(super) accessors: &'a Accessors<'a>,
}

impl Source<'_> {
    /// `None` for points and lines.
    fn load(self, job: &mut Job<'_>) -> Result<Option<Primitive>, ImportError> {
        let Checked::Valid(mode) = self.json.mode else {
            return Err(job.invalid(&self.element, "an unknown mode", "one that glTF 2.0 lists"));
        };
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            job.warn(&self.element, format!("{mode:?} are not drawn"));
            return Ok(None);
        }
        let Some(positions) = self.attribute(&Semantic::Positions, FLOAT, None)? else {
            return Err(job.invalid(&self.element, "no POSITION", "an accessor of positions"));
        };
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from_array).collect();
        let count = Some(positions.len());
        let normals = self.attribute(&Semantic::Normals, FLOAT, count)?.unwrap_or_default();
        let targets = self.targets(positions.len(), !normals.is_empty(), job)?;
        let influences = self.influences(positions.len(), job)?;
        let parts = MeshParts {
            triangles: triangles(mode, &self.indices(positions.len())?, &self.element, job),
            normals: normals.into_iter().map(Vec3::from_array).collect(),
            uvs: self.uvs(count)?,
            colors: self.colors(count)?,
            materials: PrimMaterials::Uniform(material::material_idx(
                self.accessors.root,
                self.json,
            )),
            positions,
        };
        let surface = parts.build(&self.element, job)?;
        Ok(Some(Primitive { element: self.element, surface, targets: targets.into(), influences }))
    }

    /// The accessor of an attribute.
    pub(super) fn accessor(&self, semantic: &Semantic) -> Option<Index<Accessor>> {
        self.json.attributes.get(&Checked::Valid(semantic.clone())).copied()
    }

    /// The values of an attribute; `None` where the primitive has none.
    pub(super) fn attribute<const N: usize>(
        &self,
        semantic: &Semantic,
        components: &[gltf::json::accessor::ComponentType],
        count: Option<usize>,
    ) -> Result<Option<Vec<[f32; N]>>, ImportError> {
        let Some(accessor) = self.accessor(semantic) else { return Ok(None) };
        let element = format!("{} {}", self.element, semantic.to_string());
        let purpose = Purpose { element: &element, components, count };
        self.accessors.floats(accessor, purpose).map(Some)
    }

    /// Which vertex comes when; all in order where the file does not say.
    fn indices(&self, vertex_count: usize) -> Result<Vec<u32>, ImportError> {
        let Some(accessor) = self.json.indices else {
            return Ok((0..vertex_count as u32).collect());
        };
        let element = format!("{} indices", self.element);
        let purpose = Purpose { element: &element, components: INDEX, count: None };
        let indices = self.accessors.integers(accessor, purpose)?;
        Ok(indices.into_iter().map(|[idx]| idx).collect())
    }

    /// Coordinates of the set that the material's colour texture uses, transformed as it says
    /// (`KHR_texture_transform`).
    fn uvs(&self, count: Option<usize>) -> Result<Vec<Vec2>, ImportError> {
        let materials = &self.accessors.root.materials;
        let material = self.json.material.map(|material| &materials[material.value()]);
        let slot = material.and_then(material::color_slot);
        let set = slot.map_or(0, tex_coord);
        let uvs = self.attribute(&Semantic::TexCoords(set), UNIT, count)?.unwrap_or_default();
        let transform = slot.map_or(Affine2::IDENTITY, uv_transform);
        Ok(uvs.into_iter().map(|uv| transform.transform_point2(Vec2::from(uv))).collect())
    }

    /// Linear colours, of three or four components.
    fn colors(&self, count: Option<usize>) -> Result<Vec<Vec3>, ImportError> {
        let semantic = Semantic::Colors(0);
        let kind =
            self.accessor(&semantic).map(|idx| self.accessors.root.accessors.get(idx.value()));
        let kind = kind.flatten().map(|accessor| accessor.type_);
        if kind == Some(Checked::Valid(gltf::json::accessor::Type::Vec4)) {
            let colors: Option<Vec<[f32; 4]>> = self.attribute(&semantic, UNIT, count)?;
            return Ok(colors.unwrap_or_default().iter().map(|c| Vec3::from_slice(c)).collect());
        }
        let colors = self.attribute(&semantic, UNIT, count)?.unwrap_or_default();
        Ok(colors.into_iter().map(Vec3::from_array).collect())
    }

    /// Offsets of positions, and of normals where the mesh at rest has some.
    fn targets(
        &self,
        vertex_count: usize,
        has_normals: bool,
        job: &Job<'_>,
    ) -> Result<Vec<MorphTarget>, ImportError> {
        let mut targets = Vec::new();
        for (idx, json) in self.json.targets.iter().flatten().enumerate() {
            let column = |accessor: Option<Index<Accessor>>, semantic: &str| {
                let Some(accessor) = accessor else { return Ok(Vec::new()) };
                let element = format!("{} target {idx} {semantic}", self.element);
                let (components, count) = (FLOAT, Some(vertex_count));
                let purpose = Purpose { element: &element, components, count };
                let offsets = self.accessors.floats(accessor, purpose)?;
                let offsets: Vec<Vec3> = offsets.into_iter().map(Vec3::from_array).collect();
                match offsets.iter().position(|offset| !offset.is_finite()) {
                    None => Ok(offsets),
                    Some(at) => {
                        let found = format!("{} at vertex {at}", offsets[at]);
                        Err(job.invalid(element, found, "finite offsets"))
                    }
                }
            };
            let positions = column(json.positions, "POSITION")?;
            let normals = column(json.normals.filter(|_| has_normals), "NORMAL")?;
            targets.push(MorphTarget { positions, normals });
        }
        Ok(targets)
    }
}

/// Triples of vertices; strips turn every other triangle around (glTF 2.0, section 3.7.2.1).
fn triangles(mode: Mode, indices: &[u32], element: &str, job: &mut Job<'_>) -> Vec<[u32; 3]> {
    match mode {
        Mode::TriangleStrip => {
            let triangle = |(idx, w): (usize, &[u32])| match idx % 2 {
                0 => [w[0], w[1], w[2]],
                _ => [w[0], w[2], w[1]],
            };
            indices.windows(3).enumerate().map(triangle).collect()
        }
        Mode::TriangleFan => {
            let Some((&center, rim)) = indices.split_first() else { return Vec::new() };
            rim.windows(2).map(|pair| [pair[0], pair[1], center]).collect()
        }
        _ => {
            let (triples, rest) = indices.as_chunks();
            if !rest.is_empty() {
                let message = format!("{} indices after the last triangle are ignored", rest.len());
                job.warn(element, message);
            }
            triples.to_vec()
        }
    }
}

fn tex_coord(slot: &Info) -> u32 {
    let transform = slot.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
    transform.and_then(|transform| transform.tex_coord).unwrap_or(slot.tex_coord)
}

fn uv_transform(slot: &Info) -> Affine2 {
    let transform = slot.extensions.as_ref().and_then(|all| all.texture_transform.as_ref());
    transform.map_or(Affine2::IDENTITY, |transform| {
        // The extension turns counter-clockwise with v downward, hence the sign.
        Affine2::from_scale_angle_translation(
            Vec2::from(transform.scale.0),
            -transform.rotation.0,
            Vec2::from(transform.offset.0),
        )
    })
}
