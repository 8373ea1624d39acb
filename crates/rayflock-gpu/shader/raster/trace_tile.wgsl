// The hierarchical ray engine: each primitive is drawn over the tiles whose cone touches its
// sphere. A draw is one tile with all primitives as instances; three vertices a tile, so the
// number of the first vertex tells which.

@group(0) @binding(3) var cone_origins: texture_2d<f32>;
@group(0) @binding(4) var cone_directions: texture_2d<f32>;
@group(0) @binding(5) var<storage, read_write> drawn_texels: array<atomic<u32>, 2>;

@vertex
fn draw_tile(@builtin(vertex_index) vertex: u32, prim: DrawnPrimitive,
             @location(6) sphere: vec4f) -> Drawn {
    let tiles_per_row = EDGE / TILE_EDGE;
    let tile = vec2u(vertex / 3u % tiles_per_row, vertex / 3u / tiles_per_row);
    let origin = textureLoad(cone_origins, tile, 0);
    let direction = textureLoad(cone_directions, tile, 0);
    let cone = Cone(origin.xyz, origin.w, direction.xyz, direction.w);
    if (!cone_touches(cone, sphere)) {
        // Outside the clip volume.
        return drawn_at(vec2f(-3.0), prim);
    }
    // A triangle that covers the tile; the scissor cuts off the rest.
    let corner = vertex % 3u;
    let size = 2.0 / f32(tiles_per_row);
    let offset = vec2f(f32(corner & 1u), f32(corner >> 1u)) * 2.0 * size;
    let low = vec2f(f32(tile.x) * size - 1.0, 1.0 - f32(tile.y) * size);
    return drawn_at(vec2f(low.x + offset.x, low.y - offset.y), prim);
}

@fragment
fn trace_tile(drawn: Drawn) -> Written {
    let texel = vec2u(drawn.position.xy);
    if (all(texel % TILE_EDGE == vec2u(0u))) {
        // One fragment counts for all of its tile.
        let count = TILE_EDGE * TILE_EDGE;
        if (atomicAdd(&drawn_texels[0], count) + count < count) {
            atomicAdd(&drawn_texels[1], 1u);
        }
    }
    return write_hit(ray_at(texel), primitive_of(drawn));
}
