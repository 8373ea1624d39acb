// The ray of an invocation, and what it meets.

struct Tracer {
    ray: PreparedRay,
    // The direction, of unit length.
    unit: vec3f,
    // Units of distance in one of t.
    length: f32,
    // Where the interval begins, as a distance.
    begin: f32,
    // Whether a nearer hit is of interest.
    is_active: bool,
    hit: Hit,
    // Tests so far: of spheres around chunks and primitives, of triangles, of spheres.
    tests: vec3u,
}

// Distances beyond this are not told apart.
const FARTHEST: f32 = 1e30;

fn start_ray(ray: Ray) -> Tracer {
    let size = abs(ray.direction);
    let largest = max(max(size.x, size.y), size.z);
    let prepared = prepare_ray(ray.origin, ray.direction, ray.t_min, ray.mask);
    let hit = hits[ray.slot];
    let is_answered = params.question == QUESTION_OCCLUDED && hit.rank != NO_RANK;
    let counts = is_active(ray) && !is_answered;
    let length = largest * length(prepared.direction);
    return Tracer(prepared, unit_direction(ray.direction), length, reach_of(ray.t_min, length),
                  counts, hit, vec3u(0u));
}

// The distance at t, between those that are told apart.
fn reach_of(t: f32, length: f32) -> f32 {
    return clamp(clamp(t, -1e20, 1e20) * length, -FARTHEST, FARTHEST);
}

// How far hits of the ray are of interest.
fn end_of(tracer: ptr<function, Tracer>) -> f32 {
    let t = (*tracer).hit.t;
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

fn meet_primitive(tracer: ptr<function, Tracer>, prim: Primitive) {
    count_test(tracer, prim);
    let found = intersect((*tracer).ray, prim, (*tracer).hit.t);
    if (found.accepted) {
        take_hit(tracer, Hit(found.t, found.u, found.v, prim.rank));
    }
}

// The hit takes the place of the nearest one so far if it is nearer.
fn take_hit(tracer: ptr<function, Tracer>, hit: Hit) {
    if ((*tracer).is_active && is_nearer(hit, (*tracer).hit)) {
        (*tracer).hit = hit;
        (*tracer).is_active = params.question != QUESTION_OCCLUDED;
    }
}

fn count_test(tracer: ptr<function, Tracer>, prim: Primitive) {
    let is_sphere = prim.kind == SPHERE;
    (*tracer).tests += vec3u(0u, select(1u, 0u, is_sphere), select(0u, 1u, is_sphere));
}
