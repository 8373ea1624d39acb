// The rays of a tile against some chunks that its cone touches.
//
// Each ray asks the spheres around the chunks, some at a time, shared out among the invocations
// that have it in common; each of those has a bit for each that the ray touches. Where few rays
// share a chunk, `meet_alone` tests the pairs of both. Where many do, the primitives that the cone
// touches are listed for all rays; each asks the spheres around them in the same way.

// Chunks that all who have a ray in common ask at once.
const CHUNKS_ASKED: u32 = CHUNKS_EACH * SLICES;
// Pairs are tested alone where less than one ray in so many touches a chunk.
const SPARSE: u32 = 8u;
// Chunks whose primitives are listed at once, and primitives that are listed before they are met.
const CHUNKS_AT_ONCE: u32 = LANES / CHUNK_PRIMS;
const PRIMS_AT_ONCE: u32 = 32u;
// Room for those that come with them.
const PRIM_ROOM: u32 = PRIMS_AT_ONCE + LANES;
// Primitives that an invocation asks at once: a bit each.
const PRIMS_EACH: u32 = 32u;

var<workgroup> near_prims: array<u32, PRIM_ROOM>;
var<workgroup> near_spheres: array<vec4f, PRIM_ROOM>;
var<workgroup> near_prim_count: atomic<u32>;
// For each slice the chunks that any ray touches, and how many touches there are in all.
var<workgroup> touched: array<atomic<u32>, SLICES>;
var<workgroup> touch_count: atomic<u32>;

// All chunks that are kept.
fn meet_chunks(tracer: ptr<function, Tracer>, cone: Cone, chunk_count: u32, lane: u32) {
    for (var first = 0u; first < chunk_count; first += CHUNKS_ASKED) {
        let first_own = min(first + (*tracer).slice * CHUNKS_EACH, chunk_count);
        let own = touched_chunks(tracer, first_own, min(CHUNKS_EACH, chunk_count - first_own));
        if (lane < SLICES) {
            atomicStore(&touched[lane], 0u);
        }
        if (lane == 0u) {
            atomicStore(&touch_count, 0u);
        }
        workgroupBarrier();
        note_touches((*tracer).slice, own);
        workgroupBarrier();
        if (lane == 0u) {
            shared_count = atomicLoad(&touch_count);
        }
        let count = min(CHUNKS_ASKED, chunk_count - first);
        if (workgroupUniformLoad(&shared_count) * SPARSE < count * TILE_RAYS) {
            meet_alone(tracer, first_own, own, lane);
        } else {
            meet_together(tracer, cone, first, count, lane);
        }
    }
}

// A bit for each of some chunks.
fn touched_chunks(tracer: ptr<function, Tracer>, first: u32, count: u32) -> u32 {
    var bits = 0u;
    if (is_open(tracer)) {
        let end = end_of(tracer);
        for (var idx = 0u; idx < count; idx++) {
            let sphere = chunks[kept_chunks[first + idx]];
            bits |= select(0u, 1u << idx, ray_touches(tracer, end, sphere));
        }
        (*tracer).tests.x += count;
    }
    return bits;
}

// The chunks that any ray touches, for all rays.
fn meet_together(tracer: ptr<function, Tracer>, cone: Cone, first: u32, count: u32, lane: u32) {
    for (var begin = 0u; begin < count; begin += CHUNKS_AT_ONCE) {
        let idx = begin + lane / CHUNK_PRIMS;
        if (idx < count) {
            let bits = atomicLoad(&touched[idx / CHUNKS_EACH]);
            if ((bits >> (idx % CHUNKS_EACH) & 1u) != 0u) {
                list_if_near(kept_chunks[first + idx] * CHUNK_PRIMS + lane % CHUNK_PRIMS, cone);
            }
        }
        meet_listed(tracer, PRIMS_AT_ONCE, lane);
    }
    meet_listed(tracer, 0u, lane);
    if (lane < SLICES) {
        atomicAdd(&counters.cone_tests, countOneBits(atomicLoad(&touched[lane])));
    }
}

fn list_if_near(prim_idx: u32, cone: Cone) {
    if (prim_idx < arrayLength(&primitives)) {
        let sphere = bounding_sphere(primitives[prim_idx]);
        if (cone_touches(cone, sphere)) {
            let place = atomicAdd(&near_prim_count, 1u);
            near_prims[place] = prim_idx;
            near_spheres[place] = sphere;
        }
    }
}

// The primitives that are listed, where they are more than `most`.
fn meet_listed(tracer: ptr<function, Tracer>, most: u32, lane: u32) {
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicLoad(&near_prim_count);
    }
    let prim_count = workgroupUniformLoad(&shared_count);
    if (prim_count > most) {
        for (var first = 0u; first < prim_count; first += PRIMS_EACH * SLICES) {
            let first_own = min(first + (*tracer).slice * PRIMS_EACH, prim_count);
            let found = meet_primitives(tracer, first_own, min(PRIMS_EACH, prim_count - first_own));
            settle((*tracer).idx, found, lane);
        }
        workgroupBarrier();
        if (lane == 0u) {
            atomicStore(&near_prim_count, 0u);
        }
        workgroupBarrier();
    }
}

// The nearest hit of some of the primitives that are listed.
fn meet_primitives(tracer: ptr<function, Tracer>, first: u32, count: u32) -> Hit {
    var nearest = Hit(bound_of((*tracer).idx), 0.0, 0.0, NO_RANK);
    if (!is_open(tracer)) {
        return nearest;
    }
    let end = end_of(tracer);
    var bits = 0u;
    for (var idx = 0u; idx < count; idx++) {
        bits |= select(0u, 1u << idx, ray_touches(tracer, end, near_spheres[first + idx]));
    }
    (*tracer).tests.x += count;
    while (bits != 0u) {
        let prim = primitives[near_prims[first + firstTrailingBit(bits)]];
        count_test(tracer, prim);
        let found = intersect((*tracer).ray, prim, nearest.t);
        let hit = Hit(found.t, found.u, found.v, prim.rank);
        if (found.accepted && is_nearer(hit, nearest)) {
            nearest = hit;
        }
        bits &= bits - 1u;
    }
    return nearest;
}
