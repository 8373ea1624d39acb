//! One frame of a scene, checked and made ready for shading.
//!
//! Everything that shading indexes is validated here, once a frame, so that the stages can trust
//! it: materials, textures, and the lengths of all columns.
//!
//! Cost: time linear in the number of objects, and in the number of primitives of objects whose
//! materials differ from primitive to primitive. Meshes and images are shared, not copied.

use glam::{Affine3A, Mat3, Vec3};
use rayflock_geom::{Aabb, Geometry, GeometryObject, ObjectId};
use rayflock_scene::{
    Background, Fresnel, Material, MaterialIdx, PrimMaterials, Scene, SceneFrame, SurfaceMesh,
    Texture,
};

use crate::lights::Lights;
use crate::shading::background::DEFAULT_SKY;
use crate::shading::surface_point::SurfacePoint;
use crate::shading::texture::bilinear;
use crate::{RenderError, RenderSettings};

/// What stages need to know about a frame besides the geometry, which the engine has.
#[derive(Debug)]
pub(crate) struct FrameShading {
    /// By object id; `None` where the frame has no such object.
    objects: Vec<Option<ShadedObject>>,
    materials: Vec<Material>,
    textures: Vec<Texture>,
    /// What lights the frame.
    pub(crate) lights: Lights,
    /// What the scene states.
    pub(crate) background: Option<Background>,
    /// The objects, for what their bounds are asked for; none where only surfaces matter.
    geometry: Geometry,
}

/// An object with what its surface looks like.
#[derive(Clone, Debug)]
pub(crate) struct ShadedObject {
    /// Mesh and attributes, in object space.
    pub(crate) surface: SurfaceMesh,
    /// `world_from_object`; `None` for world space.
    pub(crate) transform: Option<Affine3A>,
    /// Takes normals to world space, up to their length: the inverse transpose.
    pub(crate) normal_from_object: Mat3,
    /// -1 where the transform mirrors, which turns the winding of triangles around; else 1.
    pub(crate) handedness: f32,
}

impl FrameShading {
    /// Checks and gathers what shading needs.
    pub(crate) fn new(scene: &Scene, frame: &SceneFrame) -> Result<Self, RenderError> {
        let mut shading = Self::unlit(scene, frame)?;
        shading.geometry = frame.geometry.clone();
        shading.lights = Lights::new(&shading, &frame.geometry, &frame.lights, scene.ambient);
        Ok(shading)
    }

    /// The same without lights, for those who only ask what surfaces are made of.
    pub(crate) fn unlit(scene: &Scene, frame: &SceneFrame) -> Result<Self, RenderError> {
        check_textures(scene)?;
        let mut objects = vec![None; frame.surfaces.len()];
        for object in frame.geometry.objects() {
            let idx = object.id.0 as usize;
            let Some(surface) = frame.surfaces.get(idx) else {
                let surface_count = frame.surfaces.len();
                return Err(RenderError::MissingSurface { object_id: object.id.0, surface_count });
            };
            check_surface(object, surface, scene.materials.len())?;
            objects[idx] = Some(ShadedObject::new(object, surface));
        }
        Ok(Self {
            objects,
            materials: scene.materials.clone(),
            textures: scene.textures.clone(),
            lights: Lights::default(),
            background: scene.background,
            geometry: Geometry::default(),
        })
    }

    /// The object with this id; `None` for [`ObjectId::NONE`].
    #[inline]
    pub(crate) fn object(&self, id: ObjectId) -> Option<&ShadedObject> {
        self.objects.get(id.0 as usize)?.as_ref()
    }

    /// The material at `idx`.
    #[inline]
    pub(crate) fn material(&self, idx: MaterialIdx) -> &Material {
        &self.materials[idx.0 as usize]
    }

    /// What rays of a picture see that hit nothing.
    pub(crate) fn background_of(&self, settings: &RenderSettings) -> Background {
        settings.background.or(self.background).unwrap_or(DEFAULT_SKY)
    }

    /// Whether any material sends out light.
    pub(crate) fn has_emission(&self) -> bool {
        self.materials.iter().any(|material| material.emission.max_element() > 0.0)
    }

    /// The box around all objects that mirror or let light through, if only somewhere.
    pub(crate) fn turning_bounds(&self) -> Aabb {
        let turns = |idx: &MaterialIdx| turns_rays(self.material(*idx));
        let objects = self.geometry.objects().iter().filter(|object| {
            let materials = |shaded: &ShadedObject| match &shaded.surface.attributes.materials {
                PrimMaterials::Uniform(idx) => turns(idx),
                PrimMaterials::PerPrim(idxs) => idxs.iter().any(turns),
            };
            self.object(object.id).is_some_and(materials)
        });
        objects.fold(Aabb::EMPTY, |bounds, object| bounds.union(&object.bounds()))
    }

    /// The box around all objects.
    pub(crate) fn bounds(&self) -> Aabb {
        self.geometry.bounds()
    }

    /// What multiplies the diffuse and ambient share at `point`: texture and vertex colour.
    #[inline(always)]
    pub(crate) fn base_color(&self, point: &SurfacePoint) -> Vec3 {
        let texture_idx = self.material(point.material).diffuse_texture;
        match (texture_idx, point.uv) {
            (Some(idx), Some(uv)) => point.tint * bilinear(&self.textures[idx.0 as usize], uv),
            _ => point.tint,
        }
    }

    /// Bytes held besides what is shared with the scene.
    pub(crate) fn memory_usage(&self) -> usize {
        size_of_val(&self.objects[..])
            + size_of_val(&self.materials[..])
            + size_of_val(&self.textures[..])
            + self.lights.memory_usage()
    }
}

impl ShadedObject {
    fn new(object: &GeometryObject, surface: &SurfaceMesh) -> Self {
        let linear = object.world_from_object.map_or(Mat3::IDENTITY, |transform| {
            let m = transform.matrix3;
            Mat3::from_cols(m.x_axis.into(), m.y_axis.into(), m.z_axis.into())
        });
        let mirrors = linear.determinant() < 0.0;
        Self {
            surface: surface.clone(),
            transform: object.world_from_object,
            normal_from_object: cofactors(&linear),
            handedness: if mirrors { -1.0 } else { 1.0 },
        }
    }
}

/// Whether rays go on after they hit such a surface.
fn turns_rays(material: &Material) -> bool {
    // With the equations of a dielectric, what is mirrored is not the material's to say.
    let always = material.fresnel == Fresnel::Dielectric;
    always || material.mirror != Vec3::ZERO || material.transmission != Vec3::ZERO
}

/// The inverse transpose times the determinant: unlike the inverse, always finite. Its sign does
/// not matter, because normals are turned to the viewer.
fn cofactors(m: &Mat3) -> Mat3 {
    Mat3::from_cols(m.y_axis.cross(m.z_axis), m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis))
}

fn check_textures(scene: &Scene) -> Result<(), RenderError> {
    for texture in &scene.textures {
        let (width, height, found) = (texture.width, texture.height, texture.texels.len());
        if found == 0 || width.checked_mul(height) != Some(found) {
            let texture = texture.name.clone();
            return Err(RenderError::Texels { texture, found, width, height });
        }
    }
    let texture_count = scene.textures.len();
    for material in &scene.materials {
        if let Some(idx) = material.diffuse_texture
            && idx.0 as usize >= texture_count
        {
            let material = material.name.clone();
            return Err(RenderError::Texture { material, found: idx.0, texture_count });
        }
    }
    Ok(())
}

fn check_surface(
    object: &GeometryObject,
    surface: &SurfaceMesh,
    material_count: usize,
) -> Result<(), RenderError> {
    let (mesh, attributes) = (&surface.mesh, &surface.attributes);
    let object_id = object.id.0;
    let vertex_count = mesh.vertices().len();
    let prim_count = object.shape.prim_count();
    let material_column = match &attributes.materials {
        PrimMaterials::Uniform(_) => None,
        PrimMaterials::PerPrim(materials) => Some(materials.len()),
    };
    let optional = |len: usize| (len > 0).then_some(len);
    let columns = [
        ("primitives in the surface", Some(mesh.prim_count()), prim_count),
        ("triangles in the surface", Some(mesh.triangles().len()), object.shape.triangles().len()),
        ("normals", optional(surface.normals.len()), vertex_count),
        ("texture coordinates", optional(attributes.uvs.len()), vertex_count),
        ("vertex colours", optional(attributes.colors.len()), vertex_count),
        ("materials", material_column, prim_count),
    ];
    for (column, found, expected) in columns {
        if let Some(found) = found
            && found != expected
        {
            return Err(RenderError::Column { object_id, column, found, expected });
        }
    }
    check_materials(object_id, &attributes.materials, material_count)
}

fn check_materials(
    object_id: u32,
    materials: &PrimMaterials,
    material_count: usize,
) -> Result<(), RenderError> {
    let idxs = match materials {
        PrimMaterials::Uniform(idx) => std::slice::from_ref(idx),
        PrimMaterials::PerPrim(idxs) => idxs,
    };
    match idxs.iter().max() {
        Some(idx) if idx.0 as usize >= material_count => {
            Err(RenderError::Material { object_id, found: idx.0, material_count })
        }
        _ => Ok(()),
    }
}

/// The objects of `geometry` with their shading, in the order of their ids.
pub(crate) fn shaded_objects<'a>(
    shading: &'a FrameShading,
    geometry: &'a Geometry,
) -> impl Iterator<Item = &'a ShadedObject> {
    geometry.objects().iter().filter_map(|object| shading.object(object.id))
}
