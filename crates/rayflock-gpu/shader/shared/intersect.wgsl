// The tests that decide, as `rayflock_geom::simd::{ray_triangle, ray_sphere}` define them.
//
// Departures: a device may fuse, reorder and approximate, and has no f64. What is not surely
// outside an edge is inside, so that triangles overlap by rounding and leave no gap; the box around
// a triangle ends it where a needle points at the ray. The depth is kept between those of the
// corners.

const NO_RANK: u32 = 0xffffffffu;

// Below this part of its terms, the sign of an edge value says nothing: a few rounding units.
const EDGE_ROUNDING: f32 = 4.8e-7;

// What a corner may have been moved by, relative to its depth.
const CORNER_ROUNDING: f32 = 2.4e-7;

struct Hit {
    t: f32,
    u: f32,
    v: f32,
    // NO_RANK where nothing is hit.
    rank: u32,
}

// What the tests need to know about a ray.
struct PreparedRay {
    origin: vec3f,
    // The axis of the largest coordinate of the direction.
    major: u32,
    // sx, sy and the largest coordinate.
    shear: vec3f,
    mask: u32,
    // The direction divided by the length of its largest coordinate.
    direction: vec3f,
    t_min: f32,
}

// The outcome of one test; t, u and v hold anything where it is not accepted.
struct Outcome {
    accepted: bool,
    t: f32,
    u: f32,
    v: f32,
}

const MISSED = Outcome(false, 0.0, 0.0, 0.0);

fn permute(v: vec3f, major: u32) -> vec3f {
    return select(select(v.xyz, v.zxy, major == 1u), v.yzx, major == 0u);
}

fn prepare_ray(origin: vec3f, direction: vec3f, t_min: f32, mask: u32) -> PreparedRay {
    let size = abs(direction);
    var major = select(0u, 1u, size.y > size.x);
    major = select(major, 2u, size.z > max(size.x, size.y));
    let d = permute(direction, major);
    let shear = vec3f(d.x / d.z, d.y / d.z, d.z);
    return PreparedRay(origin, major, shear, mask, direction / abs(d.z), t_min);
}

// How far the origin lies to the left of the line from p to q; 0 where rounding hides it.
fn edge(p: vec2f, q: vec2f) -> f32 {
    let left = p.x * q.y;
    let right = p.y * q.x;
    let value = left - right;
    return select(value, 0.0, abs(value) <= EDGE_ROUNDING * (abs(left) + abs(right)));
}

fn shear_corner(corner: vec3f, ray: PreparedRay) -> vec3f {
    let p = permute(corner - ray.origin, ray.major);
    return vec3f(p.xy - ray.shear.xy * p.z, p.z);
}

fn intersect_triangle(ray: PreparedRay, prim: Primitive, t_max: f32) -> Outcome {
    let a = shear_corner(prim.a, ray);
    let b = shear_corner(prim.b, ray);
    let c = shear_corner(prim.c, ray);
    let weights = vec3f(edge(c.xy, b.xy), edge(a.xy, c.xy), edge(b.xy, a.xy));
    let is_outside = any(weights > vec3f(0.0)) && any(weights < vec3f(0.0));
    let det = weights.x + weights.y + weights.z;
    let low = min(min(a, b), c);
    let high = max(max(a, b), c);
    let slack = CORNER_ROUNDING * max(abs(low.z), abs(high.z));
    let is_beside = any(low.xy > vec2f(slack)) || any(high.xy < vec2f(-slack));
    if (is_outside || is_beside || det == 0.0) {
        return MISSED;
    }
    let depths = vec3f(a.z, b.z, c.z);
    let z = clamp(dot(weights / det, depths), low.z, high.z);
    let t = z / ray.shear.z;
    let accepted = t >= ray.t_min && t <= t_max;
    return Outcome(accepted, t, weights.y / det, weights.z / det);
}

fn intersect_sphere(ray: PreparedRay, prim: Primitive, t_max: f32) -> Outcome {
    let d = ray.direction;
    let f = ray.origin - prim.a;
    let radius_squared = prim.b.x * prim.b.x;
    let a = dot(d, d);
    let b = -dot(f, d);
    let l = f + (b / a) * d;
    let discriminant = radius_squared - dot(l, l);
    if (discriminant < 0.0) {
        return MISSED;
    }
    let root = sqrt(a * discriminant);
    let q = b + select(root, -root, b < 0.0);
    let size = abs(ray.shear.z);
    let second = q / a / size;
    let first = select((dot(f, f) - radius_squared) / q / size, second, q == 0.0);
    let lower = min(first, second);
    let upper = max(first, second);
    if (lower >= ray.t_min && lower <= t_max) {
        return Outcome(true, lower, 0.0, 0.0);
    }
    return Outcome(upper >= ray.t_min && upper <= t_max, upper, 0.0, 0.0);
}

// Tests what the ray sees.
fn intersect(ray: PreparedRay, prim: Primitive, t_max: f32) -> Outcome {
    if ((ray.mask & prim.mask) == 0u) {
        return MISSED;
    }
    if (prim.kind == SPHERE) {
        return intersect_sphere(ray, prim, t_max);
    }
    return intersect_triangle(ray, prim, t_max);
}

// Whether a hit takes the place of the nearest one so far.
fn is_nearer(hit: Hit, nearest: Hit) -> bool {
    return hit.t < nearest.t || (hit.t == nearest.t && hit.rank < nearest.rank);
}
