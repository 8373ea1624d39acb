//! Scenes as renderers and sensors take them: objects of the file with their materials, those that
//! were added in grey.

use rayflock::geom::{Geometry, GeometryObject, ObjectId};
use rayflock::scene::{Material, MaterialIdx, Scene, SceneFrame, SurfaceMesh};

use crate::errors::Failure;
use crate::world::World;

/// What surfaces look like, and the objects that were added.
pub(crate) struct Stage {
    /// Materials, textures and light around; neither objects nor what moves them.
    pub(crate) scene: Scene,
    /// What objects that were added are made of.
    grey: MaterialIdx,
    added: Vec<GeometryObject>,
    /// Ids from 0 on that are of objects of the file.
    file_ids: u32,
}

impl Stage {
    /// The stage of a world as it is now.
    pub(crate) fn of(world: &World) -> Self {
        let source = world.source();
        let mut scene = source.map(|source| looks_of(source.scene())).unwrap_or_default();
        let file_ids = source.map_or(0, |source| source.scene().objects.len());
        let grey = MaterialIdx(u32::try_from(scene.materials.len()).unwrap_or(u32::MAX));
        scene.materials.push(Material::default());
        let file_ids = u32::try_from(file_ids).unwrap_or(u32::MAX);
        Self { scene, grey, added: world.objects_of_callers().cloned().collect(), file_ids }
    }

    /// A frame of the file, or an empty one, with what was added. Surfaces are looked up by id, so
    /// ids have no gaps: those of objects that were added follow those of the file.
    pub(crate) fn dress(&self, mut frame: SceneFrame) -> Result<SceneFrame, Failure> {
        if self.added.is_empty() {
            return Ok(frame);
        }
        let mut objects = frame.geometry.objects().to_vec();
        for (id, object) in (self.file_ids..).map(ObjectId).zip(&self.added) {
            frame.surfaces.push(SurfaceMesh::new(object.shape.clone(), self.grey));
            objects.push(GeometryObject { id, ..object.clone() });
        }
        frame.geometry = Geometry::new(objects)?;
        Ok(frame)
    }

    /// The id in the world of an object that has this id on stage.
    pub(crate) fn world_id(&self, id: u32) -> u32 {
        let place = id.checked_sub(self.file_ids).and_then(|place| usize::try_from(place).ok());
        place.and_then(|place| self.added.get(place)).map_or(id, |object| object.id.0)
    }
}

/// What a renderer wants to know of a scene besides its frame.
fn looks_of(scene: &Scene) -> Scene {
    Scene {
        materials: scene.materials.clone(),
        textures: scene.textures.clone(),
        ambient: scene.ambient,
        background: scene.background,
        ..Scene::default()
    }
}
