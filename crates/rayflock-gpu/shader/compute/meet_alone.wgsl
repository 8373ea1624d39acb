// Pairs of a ray and a chunk that few other rays touch: sixteen invocations a pair, one for each
// primitive. So all are at work, however unevenly the pairs are spread over the rays.

// As many as `meet_chunks` leaves to it.
const PAIR_ROOM: u32 = MASK_BITS * TILE_RAYS / SPARSE;

// The rays of the tile, and how far hits of each are of interest, as t.
var<workgroup> tile_rays: array<PreparedRay, TILE_RAYS>;
var<workgroup> tile_bounds: array<f32, TILE_RAYS>;
// Which ray, and which of the kept chunks, in the low bits.
var<workgroup> pairs: array<u32, PAIR_ROOM>;
var<workgroup> pair_count: atomic<u32>;
// What was hit since rays last looked, and by which of them.
var<workgroup> found_hits: array<Hit, TILE_RAYS>;
var<workgroup> found_rays: array<u32, TILE_RAYS>;
var<workgroup> found_count: atomic<u32>;

// The chunks of which `own` has a bit, from the kept chunk `first` on.
fn meet_alone(tracer: ptr<function, Tracer>, first: u32, own: u32, lane: u32) {
    tile_bounds[lane] = (*tracer).hit.t;
    var bits = own;
    while (bits != 0u) {
        pairs[atomicAdd(&pair_count, 1u)] = lane * CHUNK_ROOM + first + firstTrailingBit(bits);
        bits &= bits - 1u;
    }
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicExchange(&pair_count, 0u);
    }
    let count = workgroupUniformLoad(&shared_count);
    for (var begin = 0u; begin < count; begin += CHUNKS_AT_ONCE) {
        let idx = begin + lane / CHUNK_PRIMS;
        if (idx < count) {
            test_pair(tracer, pairs[idx], lane);
        }
        take_found(tracer, lane);
    }
}

// One primitive of the chunk, which depends on the invocation, against the ray of the pair.
fn test_pair(tracer: ptr<function, Tracer>, pair: u32, lane: u32) {
    let prim_idx = kept_chunks[pair % CHUNK_ROOM] * CHUNK_PRIMS + lane % CHUNK_PRIMS;
    if (prim_idx < arrayLength(&primitives)) {
        let prim = primitives[prim_idx];
        let ray_idx = pair / CHUNK_ROOM;
        count_test(tracer, prim);
        let found = intersect(tile_rays[ray_idx], prim, tile_bounds[ray_idx]);
        if (found.accepted) {
            let place = atomicAdd(&found_count, 1u);
            found_hits[place] = Hit(found.t, found.u, found.v, prim.rank);
            found_rays[place] = ray_idx;
        }
    }
}

// Each ray takes what was found for it.
fn take_found(tracer: ptr<function, Tracer>, lane: u32) {
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicExchange(&found_count, 0u);
    }
    let count = workgroupUniformLoad(&shared_count);
    for (var idx = 0u; idx < count; idx++) {
        if (found_rays[idx] == lane) {
            take_hit(tracer, found_hits[idx]);
            tile_bounds[lane] = select(-FARTHEST, (*tracer).hit.t, (*tracer).is_active);
        }
    }
    if (count > 0u) {
        workgroupBarrier();
    }
}
