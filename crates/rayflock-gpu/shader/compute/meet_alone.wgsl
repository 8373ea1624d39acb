// Pairs of a ray and a chunk that few other rays touch: sixteen invocations a pair, one for each
// primitive. So all are at work, however unevenly the pairs are spread over the rays.

// As many as `meet_chunks` leaves to it.
const PAIR_ROOM: u32 = CHUNKS_ASKED * TILE_RAYS / SPARSE;
const PAIRS_AT_ONCE: u32 = LANES / CHUNK_PRIMS;

var<workgroup> tile_rays: array<PreparedRay, TILE_RAYS>;
// Which ray, and which of the kept chunks, in the low digits.
var<workgroup> pairs: array<u32, PAIR_ROOM>;
var<workgroup> pair_count: atomic<u32>;

// The chunks of which `own` has a bit, from the kept chunk `first` on.
fn meet_alone(tracer: ptr<function, Tracer>, first: u32, own: u32, lane: u32) {
    var bits = own;
    while (bits != 0u) {
        let pair = (*tracer).idx * CHUNK_ROOM + first + firstTrailingBit(bits);
        pairs[atomicAdd(&pair_count, 1u)] = pair;
        bits &= bits - 1u;
    }
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicExchange(&pair_count, 0u);
    }
    let count = workgroupUniformLoad(&shared_count);
    for (var begin = 0u; begin < count; begin += PAIRS_AT_ONCE) {
        let idx = begin + lane / CHUNK_PRIMS;
        var ray_idx = 0u;
        var found = Hit(0.0, 0.0, 0.0, NO_RANK);
        if (idx < count) {
            ray_idx = pairs[idx] / CHUNK_ROOM;
            found = test_pair(tracer, ray_idx, pairs[idx] % CHUNK_ROOM, lane);
        }
        settle(ray_idx, found, lane);
    }
}

// One primitive of the chunk, which depends on the invocation, against a ray of the tile.
fn test_pair(tracer: ptr<function, Tracer>, ray_idx: u32, kept_idx: u32, lane: u32) -> Hit {
    let prim_idx = kept_chunks[kept_idx] * CHUNK_PRIMS + lane % CHUNK_PRIMS;
    if (prim_idx < arrayLength(&primitives) && is_sought(ray_idx)) {
        let prim = primitives[prim_idx];
        count_test(tracer, prim);
        let found = intersect(tile_rays[ray_idx], prim, bound_of(ray_idx));
        if (found.accepted) {
            return Hit(found.t, found.u, found.v, prim.rank);
        }
    }
    return Hit(0.0, 0.0, 0.0, NO_RANK);
}
