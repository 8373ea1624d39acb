// Primitives in world space, as `layout::DevicePrimitive` writes them.

const TRIANGLE: u32 = 0u;
const SPHERE: u32 = 1u;

struct Primitive {
    // First corner, or the centre of a sphere.
    a: vec3f,
    // Rays see it iff ray.mask & mask != 0; 0 where it is ignored.
    mask: u32,
    // Second corner, or (radius, 0, 0).
    b: vec3f,
    // TRIANGLE or SPHERE.
    kind: u32,
    // Third corner.
    c: vec3f,
    // Place in the order of (object, primitive).
    rank: u32,
}

// A sphere around a primitive: centre and radius; a negative radius where it is ignored.
fn bounding_sphere(prim: Primitive) -> vec4f {
    if (prim.mask == 0u) {
        return vec4f(prim.a, -1.0);
    }
    if (prim.kind == SPHERE) {
        return vec4f(prim.a, prim.b.x);
    }
    let low = min(min(prim.a, prim.b), prim.c);
    let high = max(max(prim.a, prim.b), prim.c);
    let center = 0.5 * low + 0.5 * high;
    let radius = max(max(distance(prim.a, center), distance(prim.b, center)),
                     distance(prim.c, center));
    return vec4f(center, radius);
}
