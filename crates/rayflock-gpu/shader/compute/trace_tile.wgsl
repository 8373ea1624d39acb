// Traces the rays of each tile against the primitives of its chunks: one workgroup a tile, one
// invocation a ray, the nearest hit in registers.
//
// Chunks are taken in rounds from near to far; what lies beyond the farthest hit of the tile is
// skipped. Primitives whose sphere the cone of the tile touches are brought to workgroup memory,
// where each ray meets all of them.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(2) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(3) var<storage, read> chunks: array<vec4f>;
@group(0) @binding(4) var<storage, read> cones: array<Cone>;
@group(0) @binding(5) var<storage, read_write> ranges: array<TileRange>;
@group(0) @binding(6) var<storage, read> list: array<u32>;
@group(0) @binding(7) var<storage, read_write> counters: Counters;
@group(0) @binding(8) var<uniform> params: Params;

// Rounds from near to far, where a tile has more chunks than invocations.
const ROUNDS: u32 = 4u;
const CHUNKS_AT_ONCE: u32 = TILE_RAYS / CHUNK_PRIMS;
// Distances beyond this are not told apart.
const FARTHEST: f32 = 1e30;

// Bits of distances, which are never negative, grow with them.
var<workgroup> nearest_chunk: atomic<u32>;
var<workgroup> farthest_chunk: atomic<u32>;
var<workgroup> farthest_hit: atomic<u32>;
var<workgroup> round_chunks: array<u32, TILE_RAYS>;
var<workgroup> round_chunk_count: atomic<u32>;
var<workgroup> near_prims: array<Primitive, TILE_RAYS>;
var<workgroup> near_prim_count: atomic<u32>;
// What all invocations read after a barrier.
var<workgroup> shared_count: u32;
var<workgroup> shared_bounds: vec3f;

// The ray of an invocation.
struct Tracer {
    ray: PreparedRay,
    // Units of distance in one of t.
    length: f32,
    // Whether a nearer hit is of interest.
    is_active: bool,
    hit: Hit,
}

@compute @workgroup_size(TILE_RAYS)
fn trace_tile(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile_idx = group.x;
    let ray = rays[tile_idx * TILE_RAYS + lane];
    var tracer = start_ray(ray);
    let cone = cones[tile_idx];
    let first = ranges[tile_idx].first;
    if (lane == 0u) {
        shared_count = atomicLoad(&ranges[tile_idx].count);
    }
    let count = workgroupUniformLoad(&shared_count);

    // Between which distances chunks lie, and how far rays reach.
    atomicStore(&nearest_chunk, 0xffffffffu);
    workgroupBarrier();
    for (var idx = lane; idx < count; idx += TILE_RAYS) {
        let bits = bitcast<u32>(near_distance(cone, chunks[list[first + idx]]));
        atomicMin(&nearest_chunk, bits);
        atomicMax(&farthest_chunk, bits);
    }
    let round_count = select(1u, ROUNDS, count > TILE_RAYS);
    for (var round = 0u; round < round_count; round++) {
        for (var begin = 0u; begin < count; begin += TILE_RAYS) {
            let bounds = bounds_of_round(&tracer, round, round_count, lane);
            if (begin + lane < count) {
                let chunk_idx = list[first + begin + lane];
                let near = near_distance(cone, chunks[chunk_idx]);
                if (near >= bounds.x && near < bounds.y && near <= bounds.z) {
                    round_chunks[atomicAdd(&round_chunk_count, 1u)] = chunk_idx;
                }
            }
            meet_chunks(&tracer, cone, lane);
        }
    }
    if (is_active(ray)) {
        hits[ray.slot] = tracer.hit;
    }
}

fn start_ray(ray: Ray) -> Tracer {
    let size = abs(ray.direction);
    let largest = max(max(size.x, size.y), size.z);
    let prepared = prepare_ray(ray.origin, ray.direction, ray.t_min, ray.mask);
    let hit = hits[ray.slot];
    let is_answered = params.question == QUESTION_OCCLUDED && hit.rank != NO_RANK;
    let counts = is_active(ray) && !is_answered;
    return Tracer(prepared, largest * length(prepared.direction), counts, hit);
}

// The distances at which the chunks of a round begin and end, and beyond which nothing is of
// interest; less than 0 where all rays are done.
fn bounds_of_round(tracer: ptr<function, Tracer>, round: u32, round_count: u32,
                   lane: u32) -> vec3f {
    workgroupBarrier();
    if (lane == 0u) {
        atomicStore(&farthest_hit, 0u);
        atomicStore(&round_chunk_count, 0u);
    }
    workgroupBarrier();
    if ((*tracer).is_active) {
        let t = max((*tracer).hit.t, 0.0);
        let reach = t * (*tracer).length * (1.0 + CONE_SLACK);
        let bits = bitcast<u32>(select(reach, FARTHEST, t > 1e20 || reach > FARTHEST));
        // More than 0, which stands for no active ray.
        atomicMax(&farthest_hit, bits + 1u);
    }
    workgroupBarrier();
    if (lane == 0u) {
        let low = bitcast<f32>(atomicLoad(&nearest_chunk));
        let high = bitcast<f32>(atomicLoad(&farthest_chunk));
        let step = (high - low) / f32(round_count);
        let begin = select(low + step * f32(round), 0.0, round == 0u);
        let is_last = round + 1u == round_count;
        let end = select(low + step * f32(round + 1u), 2.0 * FARTHEST, is_last);
        let reach = atomicLoad(&farthest_hit);
        shared_bounds = vec3f(begin, end, select(bitcast<f32>(reach), -1.0, reach == 0u));
    }
    return workgroupUniformLoad(&shared_bounds);
}

// Each ray against the primitives of the chunks of this round that the tile may hit.
fn meet_chunks(tracer: ptr<function, Tracer>, cone: Cone, lane: u32) {
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicLoad(&round_chunk_count);
        atomicAdd(&counters.chunk_tests, shared_count);
    }
    let chunk_count = workgroupUniformLoad(&shared_count);
    for (var begin = 0u; begin < chunk_count; begin += CHUNKS_AT_ONCE) {
        if (lane == 0u) {
            atomicStore(&near_prim_count, 0u);
        }
        workgroupBarrier();
        let place = begin + lane / CHUNK_PRIMS;
        if (place < chunk_count) {
            let prim_idx = round_chunks[place] * CHUNK_PRIMS + lane % CHUNK_PRIMS;
            keep_if_near(prim_idx, cone);
        }
        workgroupBarrier();
        if (lane == 0u) {
            shared_count = atomicLoad(&near_prim_count);
        }
        meet_primitives(tracer, workgroupUniformLoad(&shared_count), lane);
        workgroupBarrier();
    }
}

fn keep_if_near(prim_idx: u32, cone: Cone) {
    if (prim_idx < arrayLength(&primitives)) {
        let prim = primitives[prim_idx];
        if (cone_touches(cone, bounding_sphere(prim))) {
            near_prims[atomicAdd(&near_prim_count, 1u)] = prim;
        }
    }
}

fn meet_primitives(tracer: ptr<function, Tracer>, prim_count: u32, lane: u32) {
    var sphere_count = 0u;
    for (var idx = 0u; idx < prim_count; idx++) {
        let prim = near_prims[idx];
        sphere_count += prim.kind;
        if ((*tracer).is_active) {
            meet_primitive(tracer, prim);
        }
    }
    if (lane == 0u && prim_count > 0u) {
        atomicAdd(&counters.triangle_tests, prim_count - sphere_count);
        atomicAdd(&counters.sphere_tests, sphere_count);
    }
}

fn meet_primitive(tracer: ptr<function, Tracer>, prim: Primitive) {
    let found = intersect((*tracer).ray, prim, (*tracer).hit.t);
    if (is_nearer(found, prim.rank, (*tracer).hit)) {
        (*tracer).hit = Hit(found.t, found.u, found.v, prim.rank);
        (*tracer).is_active = params.question != QUESTION_OCCLUDED;
    }
}
