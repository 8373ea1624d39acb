// The rays of a tile against some chunks that its cone touches.
//
// Each ray asks the spheres around the chunks, 32 at a time, and has a bit for each that it
// touches. Where few rays share a chunk, `meet_alone` tests the pairs of both. Where many do, the
// primitives that the cone touches are brought to workgroup memory, for all rays; each asks the
// spheres around them in the same way.

// Spheres that a ray asks at once: a bit each.
const MASK_BITS: u32 = 32u;
const CHUNKS_AT_ONCE: u32 = TILE_RAYS / CHUNK_PRIMS;
// Pairs are tested alone where less than one ray in so many touches a chunk.
const SPARSE: u32 = 8u;
// Primitives that are kept before they are met, and room for those that come with them.
const PRIMS_AT_ONCE: u32 = 32u;
const PRIM_ROOM: u32 = PRIMS_AT_ONCE + TILE_RAYS;

var<workgroup> near_prims: array<Primitive, PRIM_ROOM>;
var<workgroup> near_spheres: array<vec4f, PRIM_ROOM>;
var<workgroup> near_prim_count: atomic<u32>;
// Chunks that any ray touches, and how many touches there are.
var<workgroup> touched: atomic<u32>;
var<workgroup> touch_count: atomic<u32>;

// All chunks that are kept.
fn meet_chunks(tracer: ptr<function, Tracer>, cone: Cone, chunk_count: u32, lane: u32) {
    for (var first = 0u; first < chunk_count; first += MASK_BITS) {
        let count = min(MASK_BITS, chunk_count - first);
        let own = touched_chunks(tracer, first, count);
        if (lane == 0u) {
            atomicStore(&touched, 0u);
            atomicStore(&touch_count, 0u);
        }
        workgroupBarrier();
        atomicOr(&touched, own);
        atomicAdd(&touch_count, countOneBits(own));
        workgroupBarrier();
        if (lane == 0u) {
            shared_count = atomicLoad(&touch_count);
        }
        if (workgroupUniformLoad(&shared_count) * SPARSE < count * TILE_RAYS) {
            meet_alone(tracer, first, own, lane);
        } else {
            meet_together(tracer, cone, first, count, lane);
        }
    }
}

// A bit for each of some chunks.
fn touched_chunks(tracer: ptr<function, Tracer>, first: u32, count: u32) -> u32 {
    var bits = 0u;
    if ((*tracer).is_active) {
        let end = end_of(tracer);
        for (var idx = 0u; idx < count; idx++) {
            bits |= select(0u, 1u << idx, ray_touches(tracer, end, kept_spheres[first + idx]));
        }
        (*tracer).tests.x += count;
    }
    return bits;
}

// The chunks that any ray touches, for all rays.
fn meet_together(tracer: ptr<function, Tracer>, cone: Cone, first: u32, count: u32, lane: u32) {
    let bits = atomicLoad(&touched);
    for (var begin = 0u; begin < count; begin += CHUNKS_AT_ONCE) {
        let idx = begin + lane / CHUNK_PRIMS;
        if (idx < count && (bits >> idx & 1u) != 0u) {
            keep_if_near(kept_chunks[first + idx] * CHUNK_PRIMS + lane % CHUNK_PRIMS, cone);
        }
        meet_kept(tracer, PRIMS_AT_ONCE, lane);
    }
    meet_kept(tracer, 0u, lane);
    if (lane == 0u) {
        atomicAdd(&counters.cone_tests, countOneBits(bits));
    }
}

fn keep_if_near(prim_idx: u32, cone: Cone) {
    if (prim_idx < arrayLength(&primitives)) {
        let prim = primitives[prim_idx];
        let sphere = bounding_sphere(prim);
        if (cone_touches(cone, sphere)) {
            let place = atomicAdd(&near_prim_count, 1u);
            near_prims[place] = prim;
            near_spheres[place] = sphere;
        }
    }
}

// The primitives that are kept, where they are more than `most`.
fn meet_kept(tracer: ptr<function, Tracer>, most: u32, lane: u32) {
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicLoad(&near_prim_count);
    }
    let prim_count = workgroupUniformLoad(&shared_count);
    if (prim_count > most) {
        for (var first = 0u; first < prim_count; first += MASK_BITS) {
            meet_primitives(tracer, first, min(MASK_BITS, prim_count - first));
        }
        workgroupBarrier();
        if (lane == 0u) {
            atomicStore(&near_prim_count, 0u);
        }
        workgroupBarrier();
    }
}

fn meet_primitives(tracer: ptr<function, Tracer>, first: u32, count: u32) {
    if (!(*tracer).is_active) {
        return;
    }
    let end = end_of(tracer);
    var bits = 0u;
    for (var idx = 0u; idx < count; idx++) {
        bits |= select(0u, 1u << idx, ray_touches(tracer, end, near_spheres[first + idx]));
    }
    (*tracer).tests.x += count;
    while (bits != 0u && (*tracer).is_active) {
        meet_primitive(tracer, near_prims[first + firstTrailingBit(bits)]);
        bits &= bits - 1u;
    }
}
