// The ray of an invocation, and the nearest hits of the rays of a tile.
//
// SLICES invocations have a ray in common, each for its share of what there is to test. Hits lie in
// workgroup memory, so that all know how far they have to look.

// Invocations of a workgroup.
const LANES: u32 = TILE_RAYS * SLICES;

struct Tracer {
    ray: PreparedRay,
    // The direction, of unit length.
    unit: vec3f,
    // Units of distance in one of t.
    length: f32,
    // Where the interval begins, as a distance.
    begin: f32,
    // Which ray of the tile it is.
    idx: u32,
    // Which of those who have the ray in common this is.
    slice: u32,
    // Whether the ray is traced at all.
    is_traced: bool,
    // Tests so far: of spheres around chunks and primitives, of triangles, of spheres.
    tests: vec3u,
}

// Distances beyond this are not told apart.
const FARTHEST: f32 = 1e30;

// Of each ray the nearest hit so far: t as bits in its order, rank, u and v.
var<workgroup> hit_bits: array<atomic<u32>, TILE_RAYS>;
var<workgroup> hit_ranks: array<atomic<u32>, TILE_RAYS>;
var<workgroup> hit_places: array<vec2f, TILE_RAYS>;
// The bits that the ranks belong to.
var<workgroup> settled_bits: array<u32, TILE_RAYS>;
var<workgroup> found_count: atomic<u32>;

fn start_ray(ray: Ray, lane: u32) -> Tracer {
    let size = abs(ray.direction);
    let largest = max(max(size.x, size.y), size.z);
    let prepared = prepare_ray(ray.origin, ray.direction, ray.t_min, ray.mask);
    let length = largest * length(prepared.direction);
    if (lane < TILE_RAYS && is_active(ray)) {
        let hit = hits[ray.slot];
        settled_bits[lane] = ordered_bits(hit.t);
        atomicStore(&hit_bits[lane], settled_bits[lane]);
        atomicStore(&hit_ranks[lane], hit.rank);
        hit_places[lane] = vec2f(hit.u, hit.v);
    }
    return Tracer(prepared, unit_direction(ray.direction), length, reach_of(ray.t_min, length),
                  lane % TILE_RAYS, lane / TILE_RAYS, is_active(ray), vec3u(0u));
}

// The distance at t, between those that are told apart.
fn reach_of(t: f32, length: f32) -> f32 {
    return clamp(clamp(t, -1e20, 1e20) * length, -FARTHEST, FARTHEST);
}

// How far hits of a ray of the tile are of interest, as t.
fn bound_of(ray_idx: u32) -> f32 {
    return from_ordered_bits(atomicLoad(&hit_bits[ray_idx]));
}

// Whether a nearer hit of a ray of the tile, which is traced, is of interest.
fn is_sought(ray_idx: u32) -> bool {
    return params.question != QUESTION_OCCLUDED || atomicLoad(&hit_ranks[ray_idx]) == NO_RANK;
}

// Whether a nearer hit is of interest.
fn is_open(tracer: ptr<function, Tracer>) -> bool {
    return (*tracer).is_traced && is_sought((*tracer).idx);
}

// How far hits of the ray are of interest.
fn end_of(tracer: ptr<function, Tracer>) -> f32 {
    let t = bound_of((*tracer).idx);
    return select(reach_of(t, (*tracer).length), FARTHEST, t > 1e20);
}

// Whether the ray may meet the sphere in its interval; never false when it does.
fn ray_touches(tracer: ptr<function, Tracer>, end: f32, sphere: vec4f) -> bool {
    let v = sphere.xyz - (*tracer).ray.origin;
    let along = dot(v, (*tracer).unit);
    let across = v - along * (*tracer).unit;
    let reach = sphere.w + CONE_SLACK * (abs(v.x) + abs(v.y) + abs(v.z) + sphere.w);
    return dot(across, across) <= reach * reach && along >= (*tracer).begin - reach
        && along <= end + reach;
}

fn count_test(tracer: ptr<function, Tracer>, prim: Primitive) {
    let is_sphere = prim.kind == SPHERE;
    (*tracer).tests += vec3u(0u, select(1u, 0u, is_sphere), select(0u, 1u, is_sphere));
}

// Makes what invocations have found the hits of these rays, where it is nearer: each at most one
// hit, of rank NO_RANK for none, and no two the same.
fn settle(ray_idx: u32, found: Hit, lane: u32) {
    let is_found = found.rank != NO_RANK;
    note_found(is_found);
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicExchange(&found_count, 0u);
    }
    if (workgroupUniformLoad(&shared_count) == 0u) {
        return;
    }
    let bits = ordered_bits(found.t);
    if (is_found) {
        atomicMin(&hit_bits[ray_idx], bits);
    }
    workgroupBarrier();
    // Where there is a nearer one, the rank of the hit before no longer counts.
    if (lane < TILE_RAYS && atomicLoad(&hit_bits[lane]) != settled_bits[lane]) {
        settled_bits[lane] = atomicLoad(&hit_bits[lane]);
        atomicStore(&hit_ranks[lane], NO_RANK);
    }
    workgroupBarrier();
    let is_nearest = is_found && bits == atomicLoad(&hit_bits[ray_idx]);
    if (is_nearest) {
        atomicMin(&hit_ranks[ray_idx], found.rank);
    }
    workgroupBarrier();
    if (is_nearest && atomicLoad(&hit_ranks[ray_idx]) == found.rank) {
        hit_places[ray_idx] = vec2f(found.u, found.v);
    }
}
