// Where tiles of rays lie in textures; `ray_textures` has the same number.

// Texels along the side of a texture.
const EDGE: u32 = 512u;
// Texels along the side of a tile.
override TILE_EDGE: u32;
