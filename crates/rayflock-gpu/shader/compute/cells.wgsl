// Cells of space, by which primitives are brought into an order; `layout::CellParams` mirrors it.
//
// Levels of cells cut the scene's box in 1, 8, 64 and so on; a primitive belongs to the finest whose
// cells are not smaller than it is. Cells of a level lie along a Morton curve, levels follow each
// other. The last cell is for what rays never see.

// Cells that an invocation places, and invocations of a workgroup.
const CELLS_EACH: u32 = 4u;
const PLACERS: u32 = 256u;

struct CellParams {
    // The finest level.
    finest: u32,
    cell_count: u32,
    unused_a: u32,
    unused_b: u32,
}

// The cell of a primitive in a scene between these corners.
fn cell_of(prim: Primitive, low: vec3f, high: vec3f, params: CellParams) -> u32 {
    if (prim.mask == 0u) {
        return params.cell_count - 1u;
    }
    let sphere = bounding_sphere(prim);
    let extent = high - low;
    let edge = max(max(extent.x, extent.y), extent.z);
    let level = u32(clamp(log2(edge / (2.0 * sphere.w)), 0.0, f32(params.finest)));
    let cells = f32(1u << level);
    let place = clamp((sphere.xyz - low) / edge * cells, vec3f(0.0), vec3f(cells - 1.0));
    return first_of_level(level) + morton_code(vec3u(place));
}

// How many cells the levels before have.
fn first_of_level(level: u32) -> u32 {
    return ((1u << (3u * level)) - 1u) / 7u;
}

fn morton_code(place: vec3u) -> u32 {
    let bits = spread_bits(place.x) | spread_bits(place.y) << 1u | spread_bits(place.z) << 2u;
    return bits;
}

// Two zeros after each of the lowest ten bits.
fn spread_bits(number: u32) -> u32 {
    let a = (number | number << 16u) & 0x030000ffu;
    let b = (a | a << 8u) & 0x0300f00fu;
    let c = (b | b << 4u) & 0x030c30c3u;
    return (c | c << 2u) & 0x09249249u;
}
