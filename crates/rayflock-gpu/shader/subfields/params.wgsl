// What the stages of subfields share; `layout` mirrors the structures.

// Cells of directions at most: one for each invocation of `open_subfields`.
const MOST_CELLS: u32 = 256u;
// Slabs of depth that entries are told apart by.
const SLABS: u32 = 32u;
// Bits of an entry that are the place of a primitive in its part; then the first and the last slab.
const PRIM_BITS: u32 = 21u;
const SLAB_BITS: u32 = 5u;
// More than all rounding on either side, relative to the distances at work: 2^-16.
const PLACE_SLACK: f32 = 1.5258789e-5;

// What the rays of a cell want.
const WANTED: u32 = 1u;
const TRACED: u32 = 2u;
const DONE: u32 = 3u;

struct SubfieldParams {
    // The direction of all rays, of unit length, if there is one.
    shared_direction: vec3f,
    is_shared: u32,
    // Cells of directions, and tiles of a subfield, along each side.
    direction_edge: u32,
    tile_edge: u32,
    // Subfields and entries that there is room for.
    subfield_capacity: u32,
    entry_capacity: u32,
    prim_count: u32,
    // 0 for the closest hit, QUESTION_OCCLUDED for any.
    question: u32,
    unused_a: u32,
    unused_b: u32,
}

struct SubfieldCounters {
    // Entries of all tiles, those included for which there was no room: two words.
    entries: atomic<u32>,
    entries_high: atomic<u32>,
    // Subfields that are open, and the first that this round has opened.
    subfield_count: u32,
    first_new: u32,
    // 0 while entries are counted, 1 while they are filled in.
    is_placed: atomic<u32>,
    // Cells that this round has no room for.
    left_count: atomic<u32>,
    // Two words each.
    triangle_tests: atomic<u32>,
    triangle_tests_high: atomic<u32>,
    sphere_tests: atomic<u32>,
    sphere_tests_high: atomic<u32>,
}

// How the scene is seen along a direction. A place has a column and a row, in tiles, and a depth, in
// slabs; each is linear in what a point is off the centre.
struct Subfield {
    column: vec3f,
    // What a column may be off for points of the scene.
    column_pad: f32,
    row: vec3f,
    row_pad: f32,
    depth: vec3f,
    depth_pad: f32,
    center: vec3f,
    // Around the centre, of a sphere that holds the scene.
    radius: f32,
}

// Where the entries of a tile lie.
struct SubfieldTile {
    first: u32,
    count: atomic<u32>,
}

// What is in the way of a vector, in columns, rows and slabs.
fn pace_of(v: vec3f, subfield: Subfield) -> vec3f {
    return vec3f(dot(v, subfield.column), dot(v, subfield.row), dot(v, subfield.depth));
}

fn place_of(p: vec3f, subfield: Subfield, tile_edge: u32) -> vec3f {
    let middle = 0.5 * vec3f(f32(tile_edge), f32(tile_edge), f32(SLABS));
    return pace_of(p - subfield.center, subfield) + middle;
}

fn pad_of(subfield: Subfield) -> vec3f {
    return vec3f(subfield.column_pad, subfield.row_pad, subfield.depth_pad);
}

// The one of `count` tiles or slabs that holds a place, or is nearest to it.
fn nearest_of(place: f32, count: u32) -> u32 {
    return u32(clamp(place, 0.0, f32(count - 1u)));
}

// Whether all entries have their place: none is filled in or read otherwise.
fn has_room(entries: u32, entries_high: u32, capacity: u32) -> bool {
    return entries_high == 0u && entries <= capacity;
}
