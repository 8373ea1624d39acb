//! WGSL by name: each program is a stage's file after those it shares with others.
//!
//! Declarations in WGSL may stand in any order, so putting files together is all the including
//! that is needed.

/// A program for the device.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shader {
    /// Its file in `shader/`, without the extension: `compute/trace_tile`.
    pub(crate) name: &'static str,
    /// The whole text.
    pub(crate) source: &'static str,
}

macro_rules! shader {
    ($name:literal $(, $shared:literal)*) => {
        Shader {
            name: $name,
            source: concat!(
                $(include_str!(concat!("../shader/", $shared, ".wgsl")),)*
                include_str!(concat!("../shader/", $name, ".wgsl"))
            ),
        }
    };
}

pub(crate) const BRUTE_CROSS: Shader = shader!(
    "brute/cross",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/order",
    "shared/depth",
    "shared/write_hit",
    "shared/ray_textures",
    "shared/draw"
);

pub(crate) const BOUND_PRIMITIVES: Shader = shader!("raster/bound_primitives", "shared/primitive");
pub(crate) const RASTER_BOUND_TILES: Shader = shader!(
    "raster/bound_tiles",
    "shared/ray",
    "shared/limits",
    "shared/cone",
    "shared/tiles",
    "shared/ray_textures"
);
pub(crate) const RASTER_TRACE_TILE: Shader = shader!(
    "raster/trace_tile",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/cone",
    "shared/order",
    "shared/depth",
    "shared/write_hit",
    "shared/tiles",
    "shared/ray_textures",
    "shared/draw"
);
pub(crate) const BOUND_CHUNKS: Shader = shader!(
    "compute/bound_chunks",
    "shared/primitive",
    "shared/limits",
    "compute/params",
    "compute/sphere_around"
);
pub(crate) const BOUND_BLOCKS: Shader =
    shader!("compute/bound_blocks", "shared/limits", "compute/params", "compute/sphere_around");
pub(crate) const BOUND_TILES: Shader =
    shader!("compute/bound_tiles", "shared/ray", "shared/limits", "shared/cone", "compute/params");
pub(crate) const BOUND_NODES: Shader =
    shader!("compute/bound_nodes", "shared/limits", "shared/cone", "compute/params");
pub(crate) const SEED_PAIRS: Shader =
    shader!("compute/seed_pairs", "shared/cone", "compute/params", "compute/append");
pub(crate) const PLAN_DISPATCH: Shader = shader!("compute/plan_dispatch", "compute/params");
pub(crate) const REFINE: Shader =
    shader!("compute/refine", "shared/cone", "compute/params", "compute/append");
pub(crate) const PLAN_LISTS: Shader = shader!("compute/plan_lists", "compute/params");
pub(crate) const FILL_LISTS: Shader = shader!("compute/fill_lists", "compute/params");
/// A stage of which there are forms for processors and for cards.
macro_rules! both_forms {
    ($name:literal $(, $shared:literal)*) => {
        [
            shader!($name $(, $shared)*, "compute/narrow"),
            shader!($name $(, $shared)*, "compute/wide")
        ]
    };
}

/// By [`Form`](crate::compute::Form).
pub(crate) const TRACE_TILE: [Shader; 2] = both_forms!(
    "compute/trace_tile",
    "shared/primitive",
    "shared/ray",
    "shared/order",
    "shared/question",
    "shared/limits",
    "shared/intersect",
    "shared/cone",
    "compute/params",
    "compute/tracer",
    "compute/meet_chunks",
    "compute/meet_alone",
    "compute/reduce"
);
pub(crate) const BOUND_SCENE: Shader =
    shader!("shared/bound_scene", "shared/primitive", "shared/order");
pub(crate) const COUNT_CELLS: Shader =
    shader!("compute/count_cells", "shared/primitive", "shared/order", "compute/cells");
pub(crate) const SUM_CELLS: Shader =
    shader!("compute/sum_cells", "shared/primitive", "compute/cells");
pub(crate) const PLACE_CELLS: Shader =
    shader!("compute/place_cells", "shared/primitive", "compute/cells");
pub(crate) const ORDER_PRIMITIVES: Shader = shader!("compute/order_primitives", "shared/primitive");
pub(crate) const SIZE_CHUNKS: Shader = shader!("compute/size_chunks");
pub(crate) const TAKE_ORDER: Shader = shader!("compute/take_order", "shared/primitive");
pub(crate) const MARK_DIRECTIONS: Shader =
    shader!("subfields/mark_directions", "shared/ray", "subfields/params");
pub(crate) const OPEN_SUBFIELDS: Shader =
    shader!("subfields/open_subfields", "shared/order", "subfields/params");
pub(crate) const WRITE_TILES: Shader =
    shader!("subfields/write_tiles", "shared/primitive", "subfields/params");
pub(crate) const PLACE_TILES: Shader = shader!("subfields/place_tiles", "subfields/params");
pub(crate) const TRACE_RAYS: Shader = shader!(
    "subfields/trace_rays",
    "shared/primitive",
    "shared/ray",
    "shared/question",
    "shared/intersect",
    "subfields/params"
);
pub(crate) const CAMERA_RAYS: Shader = shader!(
    "frame/camera_rays",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/vector",
    "frame/frame"
);
pub(crate) const SCAN_PRIMITIVES: Shader = shader!(
    "frame/scan_primitives",
    "shared/primitive",
    "shared/ray",
    "shared/intersect",
    "shared/order",
    "shared/depth",
    "shared/write_hit",
    "frame/scan",
    "frame/outline"
);
pub(crate) const TAKE_SCANNED: Shader = shader!(
    "frame/take_scanned",
    "shared/primitive",
    "shared/ray",
    "shared/intersect",
    "frame/scan"
);
pub(crate) const COUNT_RAYS: Shader = shader!(
    "frame/count_rays",
    "shared/primitive",
    "shared/ray",
    "shared/order",
    "shared/intersect",
    "frame/frame"
);
pub(crate) const ORDER_WAVE: Shader = shader!(
    "frame/order_wave",
    "shared/primitive",
    "shared/ray",
    "shared/intersect",
    "frame/frame"
);
pub(crate) const SHADE_SURFACE: Shader = shader!(
    "frame/shade_surface",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/vector",
    "frame/frame",
    "frame/attributes",
    "frame/surface_point",
    "frame/scatter",
    "frame/material",
    "frame/turns"
);
pub(crate) const ADD_EMITTED: Shader =
    shader!("frame/add_emitted", "shared/ray", "shared/vector", "frame/frame", "frame/film");
pub(crate) const SHADOW_RAYS: Shader = shader!(
    "frame/shadow_rays",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/vector",
    "frame/frame",
    "frame/lamp",
    "frame/light"
);
pub(crate) const ADD_LIT: Shader = shader!(
    "frame/add_lit",
    "shared/primitive",
    "shared/ray",
    "shared/limits",
    "shared/intersect",
    "shared/vector",
    "frame/frame",
    "frame/film",
    "frame/lamp",
    "frame/light"
);
pub(crate) const GATHER_LIGHTS: Shader = shader!(
    "frame/gather_lights",
    "shared/ray",
    "shared/limits",
    "shared/cone",
    "shared/vector",
    "frame/frame",
    "frame/film",
    "frame/virtual_light",
    "frame/point_tile",
    "frame/light_shaft",
    "frame/past_spheres"
);

pub(crate) const DEFORM_VERTICES: Shader =
    shader!("frame/deform_vertices", "shared/vector", "frame/deformed_object");
pub(crate) const WRITE_TRIANGLES: Shader = shader!(
    "frame/write_triangles",
    "shared/primitive",
    "shared/vector",
    "frame/attributes",
    "frame/deformed_object"
);

pub(crate) const LEAVE_PHOTONS: Shader = shader!(
    "frame/leave_photons",
    "shared/primitive",
    "shared/ray",
    "shared/vector",
    "shared/limits",
    "shared/intersect",
    "frame/frame",
    "frame/attributes",
    "frame/surface_point",
    "frame/scatter",
    "frame/material",
    "frame/turns",
    "frame/lamp",
    "frame/photon"
);
pub(crate) const SORT_PHOTONS: Shader =
    shader!("frame/sort_photons", "frame/photon", "frame/photon_cells");
pub(crate) const PLACE_PHOTONS: Shader =
    shader!("frame/place_photons", "frame/photon", "frame/photon_cells");
pub(crate) const GATHER_PHOTONS: Shader = shader!(
    "frame/gather_photons",
    "shared/ray",
    "shared/vector",
    "frame/frame",
    "frame/film",
    "frame/photon",
    "frame/photon_cells"
);

/// Every program.
#[cfg(test)]
pub(crate) const ALL: &[Shader] = &[
    BRUTE_CROSS,
    BOUND_PRIMITIVES,
    RASTER_BOUND_TILES,
    RASTER_TRACE_TILE,
    BOUND_SCENE,
    COUNT_CELLS,
    SUM_CELLS,
    PLACE_CELLS,
    ORDER_PRIMITIVES,
    SIZE_CHUNKS,
    TAKE_ORDER,
    BOUND_CHUNKS,
    BOUND_BLOCKS,
    BOUND_TILES,
    BOUND_NODES,
    SEED_PAIRS,
    PLAN_DISPATCH,
    REFINE,
    PLAN_LISTS,
    FILL_LISTS,
    TRACE_TILE[0],
    TRACE_TILE[1],
    MARK_DIRECTIONS,
    OPEN_SUBFIELDS,
    WRITE_TILES,
    PLACE_TILES,
    TRACE_RAYS,
    CAMERA_RAYS,
    SCAN_PRIMITIVES,
    TAKE_SCANNED,
    COUNT_RAYS,
    ORDER_WAVE,
    SHADE_SURFACE,
    ADD_EMITTED,
    SHADOW_RAYS,
    ADD_LIT,
    DEFORM_VERTICES,
    WRITE_TRIANGLES,
    GATHER_LIGHTS,
    LEAVE_PHOTONS,
    SORT_PHOTONS,
    PLACE_PHOTONS,
    GATHER_PHOTONS,
];

#[cfg(test)]
mod tests;
