// What the stages of a batch share; `layout::Params` and `layout::Counters` mirror it.

// Rays in a tile, and invocations in a workgroup.
const TILE_RAYS: u32 = 64u;
// Consecutive primitives in a chunk.
const CHUNK_PRIMS: u32 = 16u;
// Consecutive chunks in a block.
const BLOCK_CHUNKS: u32 = 16u;
// Children of a node of the ray tree.
const FAN_OUT: u32 = 16u;
// Where the cones of each level begin: tiles, nodes over tiles, roots over nodes.
const FIRST_NODE: u32 = 4096u;
const FIRST_ROOT: u32 = 4352u;

struct Params {
    tile_count: u32,
    block_count: u32,
    // Pairs that a buffer holds.
    pair_capacity: u32,
    // 0 for the closest hit, QUESTION_OCCLUDED for any.
    question: u32,
}

struct Counters {
    // Pairs of a level, those included for which there was no room.
    root_pairs: atomic<u32>,
    node_pairs: atomic<u32>,
    tile_pairs: atomic<u32>,
    // Tests of chunks and primitives against the cones of tiles in `trace_tile`, in units of 16.
    cone_tests: atomic<u32>,
    // Tests in units of all rays of a tile: of spheres around chunks and primitives, of triangles
    // and of primitives that are spheres.
    ray_tests: atomic<u32>,
    triangle_tests: atomic<u32>,
    sphere_tests: atomic<u32>,
}

// A group of rays that may hit something of a block.
struct Pair {
    cone_idx: u32,
    block_idx: u32,
}

// Where the blocks of a tile lie in the list. A tile whose cone bounds nothing has none there: it
// is traced past all of them.
struct TileRange {
    first: u32,
    count: atomic<u32>,
}

fn count_at(level_begin: u32, params: Params) -> u32 {
    let node_count = (params.tile_count + FAN_OUT - 1u) / FAN_OUT;
    let root_count = (node_count + FAN_OUT - 1u) / FAN_OUT;
    return select(select(params.tile_count, node_count, level_begin == FIRST_NODE), root_count,
                  level_begin == FIRST_ROOT);
}
