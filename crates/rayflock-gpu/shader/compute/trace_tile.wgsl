// Traces the rays of each tile against the primitives of its blocks: one workgroup a tile, some
// invocations a ray.
//
// The chunks of the blocks are taken in rounds from near to far. Those that the cone of the tile
// touches, and that do not lie beyond the farthest hit of its rays, are kept until there are enough
// of them for `meet_chunks`.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(2) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(3) var<storage, read> chunks: array<vec4f>;
@group(0) @binding(4) var<storage, read> cones: array<Cone>;
@group(0) @binding(5) var<storage, read_write> ranges: array<TileRange>;
@group(0) @binding(6) var<storage, read> list: array<u32>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;
@group(0) @binding(8) var<uniform> params: Params;

// Rounds from near to far, where a tile has more blocks than are asked at once.
const ROUNDS: u32 = 4u;
const BLOCKS_AT_ONCE: u32 = LANES / BLOCK_CHUNKS;
// Chunks are met when more than this are kept; those that come with them must find room.
const CHUNKS_KEPT: u32 = TILE_RAYS;
const CHUNK_ROOM: u32 = CHUNKS_KEPT + LANES;

// Bits of distances, which are never negative, grow with them.
var<workgroup> nearest_chunk: atomic<u32>;
var<workgroup> farthest_chunk: atomic<u32>;
var<workgroup> farthest_hit: atomic<u32>;
var<workgroup> kept_chunks: array<u32, CHUNK_ROOM>;
var<workgroup> kept_count: atomic<u32>;
var<workgroup> test_sums: array<atomic<u32>, 3>;
// What all invocations read after a barrier.
var<workgroup> shared_count: u32;
var<workgroup> shared_bounds: vec3f;

@compute @workgroup_size(LANES)
fn trace_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile_idx = group.x;
    let ray = rays[tile_idx * TILE_RAYS + lane % TILE_RAYS];
    var tracer = start_ray(ray, lane);
    let cone = cones[tile_idx];
    if (lane < TILE_RAYS) {
        tile_rays[lane] = tracer.ray;
    }
    if (lane == 0u) {
        let listed = atomicLoad(&ranges[tile_idx].count);
        shared_count = select(listed, params.block_count, is_everywhere(cone));
        atomicStore(&nearest_chunk, 0xffffffffu);
    }
    let block_count = workgroupUniformLoad(&shared_count);
    let blocks = Blocks(ranges[tile_idx].first, block_count, is_everywhere(cone));
    find_distances(blocks, cone, lane);
    let round_count = select(1u, ROUNDS, block_count > BLOCKS_AT_ONCE);
    for (var round = 0u; round < round_count; round++) {
        var bounds = bounds_of_round(&tracer, round, round_count, lane);
        for (var begin = 0u; begin < block_count; begin += BLOCKS_AT_ONCE) {
            if (bounds.z < 0.0) {
                break;
            }
            keep_chunk(blocks, begin, cone, bounds, lane);
            if (meet_kept_chunks(&tracer, cone, CHUNKS_KEPT, lane)) {
                bounds = bounds_of_round(&tracer, round, round_count, lane);
            }
        }
        meet_kept_chunks(&tracer, cone, 0u, lane);
    }
    workgroupBarrier();
    if (lane < TILE_RAYS && tracer.is_traced) {
        hits[ray.slot] = Hit(bound_of(lane), hit_places[lane].x, hit_places[lane].y,
                             atomicLoad(&hit_ranks[lane]));
    }
    count_tests(tracer.tests, round_count * block_count, lane);
}

// The blocks of a tile.
struct Blocks {
    // Where they begin in the list.
    first: u32,
    count: u32,
    // Whether they are all there are, and not in the list.
    are_all: bool,
}

fn chunk_of(blocks: Blocks, idx: u32, lane: u32) -> u32 {
    var block_idx = idx;
    if (!blocks.are_all) {
        block_idx = list[blocks.first + idx];
    }
    return block_idx * BLOCK_CHUNKS + lane % BLOCK_CHUNKS;
}

// Between which distances chunks lie, from one of each block: rounds need not be even.
fn find_distances(blocks: Blocks, cone: Cone, lane: u32) {
    for (var idx = lane; idx < blocks.count; idx += LANES) {
        let chunk_idx = min(chunk_of(blocks, idx, lane), arrayLength(&chunks) - 1u);
        let bits = bitcast<u32>(near_distance(cone, chunks[chunk_idx]));
        atomicMin(&nearest_chunk, bits);
        atomicMax(&farthest_chunk, bits);
    }
}

// The distances at which the chunks of a round begin and end, and beyond which nothing is of
// interest; less than 0 where all rays are done.
fn bounds_of_round(tracer: ptr<function, Tracer>, round: u32, round_count: u32,
                   lane: u32) -> vec3f {
    workgroupBarrier();
    if (lane == 0u) {
        atomicStore(&farthest_hit, 0u);
    }
    workgroupBarrier();
    // 0 stands for no active ray.
    var reach = 0u;
    if (lane < TILE_RAYS && is_open(tracer)) {
        reach = bitcast<u32>(max(end_of(tracer), 0.0) * (1.0 + CONE_SLACK)) + 1u;
    }
    note_reach(reach);
    workgroupBarrier();
    if (lane == 0u) {
        let low = bitcast<f32>(atomicLoad(&nearest_chunk));
        let high = bitcast<f32>(atomicLoad(&farthest_chunk));
        let step = (high - low) / f32(round_count);
        let begin = select(low + step * f32(round), 0.0, round == 0u);
        let is_last = round + 1u == round_count;
        let end = select(low + step * f32(round + 1u), 2.0 * FARTHEST, is_last);
        let farthest = atomicLoad(&farthest_hit);
        shared_bounds = vec3f(begin, end, select(bitcast<f32>(farthest), -1.0, farthest == 0u));
    }
    return workgroupUniformLoad(&shared_bounds);
}

// Keeps a chunk of the next blocks if the tile may hit something of it in this round.
fn keep_chunk(blocks: Blocks, begin: u32, cone: Cone, bounds: vec3f, lane: u32) {
    let idx = begin + lane / BLOCK_CHUNKS;
    if (idx < blocks.count) {
        let chunk_idx = chunk_of(blocks, idx, lane);
        if (chunk_idx < arrayLength(&chunks)) {
            let sphere = chunks[chunk_idx];
            let near = near_distance(cone, sphere);
            let is_now = near >= bounds.x && near < bounds.y && near <= bounds.z;
            if (is_now && cone_touches(cone, sphere)) {
                let place = atomicAdd(&kept_count, 1u);
                kept_chunks[place] = chunk_idx;
            }
        }
    }
}

// Meets the chunks that are kept, where they are more than `most`; tells if they were.
fn meet_kept_chunks(tracer: ptr<function, Tracer>, cone: Cone, most: u32, lane: u32) -> bool {
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicLoad(&kept_count);
    }
    let chunk_count = workgroupUniformLoad(&shared_count);
    if (chunk_count > most) {
        meet_chunks(tracer, cone, chunk_count, lane);
        workgroupBarrier();
        if (lane == 0u) {
            atomicStore(&kept_count, 0u);
        }
        workgroupBarrier();
    }
    return chunk_count > most;
}

// Adds the tests of the tile to those of all.
fn count_tests(tests: vec3u, asked_blocks: u32, lane: u32) {
    note_tests(tests);
    workgroupBarrier();
    if (lane == 0u) {
        atomicAdd(&counters.cone_tests, asked_blocks);
        atomicAdd(&counters.ray_tests, in_tiles(atomicLoad(&test_sums[0])));
        atomicAdd(&counters.triangle_tests, in_tiles(atomicLoad(&test_sums[1])));
        atomicAdd(&counters.sphere_tests, in_tiles(atomicLoad(&test_sums[2])));
    }
}

fn in_tiles(tests: u32) -> u32 {
    return (tests + TILE_RAYS - 1u) / TILE_RAYS;
}
