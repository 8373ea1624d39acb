//! Why a frame cannot be rendered.

use rayflock_engine::EngineError;
use thiserror::Error;

/// Why a frame cannot be rendered: its parts do not fit together.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum RenderError {
    /// The engine cannot hold the geometry.
    #[error(transparent)]
    Engine(#[from] EngineError),
    /// An object of the geometry has no surface.
    #[error("object {object_id} has no surface: the frame has {surface_count}")]
    MissingSurface {
        /// The object's id.
        object_id: u32,
        /// Surfaces in the frame.
        surface_count: usize,
    },
    /// A column of a surface has the wrong length.
    #[error("object {object_id}: {found} {column}, expected {expected}")]
    Column {
        /// The object's id.
        object_id: u32,
        /// Which column.
        column: &'static str,
        /// Its length.
        found: usize,
        /// The length it must have.
        expected: usize,
    },
    /// A primitive is made of a material that is not there.
    #[error("object {object_id} names material {found}, but the scene has {material_count}")]
    Material {
        /// The object's id.
        object_id: u32,
        /// The material it names.
        found: u32,
        /// Materials in the scene.
        material_count: usize,
    },
    /// A material refers to a texture that is not there.
    #[error("material \"{material}\" names texture {found}, but the scene has {texture_count}")]
    Texture {
        /// The material's name.
        material: String,
        /// The texture it names.
        found: u32,
        /// Textures in the scene.
        texture_count: usize,
    },
    /// A texture does not hold what its size says.
    #[error("texture \"{texture}\" holds {found} texels, expected {width} x {height} and not 0")]
    Texels {
        /// The texture's name.
        texture: String,
        /// Texels it holds.
        found: usize,
        /// Its width.
        width: usize,
        /// Its height.
        height: usize,
    },
}
