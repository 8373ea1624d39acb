// Scan conversion: each primitive is drawn where rays from the camera may hit it; the exact test of
// the texel's ray decides, and the depth test keeps the nearest.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read> rays: array<Ray>;
// Of each slot: tests of triangles and of spheres.
@group(0) @binding(2) var<storage, read_write> tests: array<atomic<u32>>;
@group(0) @binding(3) var<uniform> scan: ScanParams;

struct Scanned {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) prim_idx: u32,
}

// Two triangles a primitive.
const CORNERS = array<u32, 6>(0u, 1u, 2u, 0u, 2u, 3u);

@vertex
fn place_primitive(@builtin(vertex_index) vertex: u32) -> Scanned {
    let prim_idx = vertex / 6u;
    var corners = CORNERS;
    var places = outline_of(primitives[prim_idx]);
    let size = vec2f(f32(scan.width), f32(scan.row_count));
    let place = 2.0 * places[corners[vertex % 6u]] / size - vec2f(1.0);
    return Scanned(vec4f(place.x, -place.y, 0.0, 1.0), prim_idx);
}

@fragment
fn scan_primitives(scanned: Scanned) -> Written {
    let slot = slot_of(vec2u(scanned.position.xy));
    let prim = primitives[scanned.prim_idx];
    atomicAdd(&tests[2u * slot + select(0u, 1u, prim.kind == SPHERE)], 1u);
    return write_hit(rays[slot], prim);
}

// The slot of a texel: rays from the camera come in tiles of 8 x 8 pixels.
fn slot_of(texel: vec2u) -> u32 {
    let columns = (scan.width + 7u) / 8u;
    let tile = texel / 8u;
    let place = texel % 8u;
    return 64u * (tile.y * columns + tile.x) + 8u * place.y + place.x;
}
