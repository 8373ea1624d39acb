// Where tiles of rays lie in textures; `ray_textures` has the same numbers.

const TILE_EDGE: u32 = 8u;
const TILES_PER_ROW: u32 = 64u;
