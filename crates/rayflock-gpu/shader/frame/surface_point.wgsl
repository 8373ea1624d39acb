// What a hit means in the world: position, normals, texture coordinates, material.

// The offset relative to the largest coordinate: 32 units in the last place.
const SLACK: f32 = 3.8146973e-6;
// Cosine of the angle up to which vertex normals count as those of a smooth surface.
const SMOOTH_COS: f32 = 0.7;

// A point of a surface, as a ray sees it.
struct SurfacePoint {
    position: vec3f,
    // How far off the surface rays start.
    slack: f32,
    // Where shadow rays end: off the surface, and lifted toward the smooth one it stands for.
    shadow_position: vec3f,
    material: u32,
    // Geometric normal, on the side of the ray's origin.
    facet_normal: vec3f,
    from_outside: bool,
    // Normal to shade with, in the hemisphere of the facet's.
    normal: vec3f,
    has_uv: bool,
    tint: vec3f,
    uv: vec2f,
}

fn surface_point(prim: Primitive, attributes: Attributes, ray: Ray, hit: Hit) -> SurfacePoint {
    if (prim.kind == SPHERE) {
        return on_sphere(prim, attributes, ray, hit);
    }
    return on_triangle(prim, attributes, ray, hit);
}

fn on_triangle(prim: Primitive, attributes: Attributes, ray: Ray, hit: Hit) -> SurfacePoint {
    let shares = vec3f(1.0 - hit.u - hit.v, hit.u, hit.v);
    let position = prim.a * shares.x + prim.b * shares.y + prim.c * shares.z;
    let sizes = max(max(abs(prim.a), abs(prim.b)), abs(prim.c));
    var outward = triangle_normal(prim.b - prim.a, prim.c - prim.a);
    outward *= select(1.0, -1.0, (attributes.flags & IS_MIRRORED) != 0u);
    var point = facing(position, outward, largest_of(sizes), ray);
    point.material = attributes.material;
    point.has_uv = (attributes.flags & HAS_UVS) != 0u;
    point.uv = attributes.uv_a * shares.x + attributes.uv_b * shares.y
        + attributes.uv_c * shares.z;
    point.tint = attributes.color_a * shares.x + attributes.color_b * shares.y
        + attributes.color_c * shares.z;
    if ((attributes.flags & HAS_NORMALS) != 0u) {
        smooth_point(&point, prim, attributes, shares);
    }
    return point;
}

fn on_sphere(prim: Primitive, attributes: Attributes, ray: Ray, hit: Hit) -> SurfacePoint {
    let radius = prim.b.x;
    let outward = normalize_or(ray.origin + hit.t * ray.direction - prim.a, -ray.direction);
    let largest = largest_of(abs(prim.a)) + radius;
    var point = facing(prim.a + radius * outward, outward, largest, ray);
    point.material = attributes.material;
    let axis = normalize_or(vec3f(dot(attributes.normal_a, outward),
                                  dot(attributes.normal_b, outward),
                                  dot(attributes.normal_c, outward)), outward);
    let longitude = atan2(axis.x, axis.z) / 6.2831853;
    point.has_uv = true;
    point.uv = vec2f(0.5 + longitude, acos(clamp(axis.y, -1.0, 1.0)) / 3.1415927);
    return point;
}

// A point without attributes, its normal turned to the viewer.
fn facing(position: vec3f, outward: vec3f, largest: f32, ray: Ray) -> SurfacePoint {
    let from_outside = dot(outward, ray.direction) <= 0.0;
    let normal = select(-outward, outward, from_outside);
    let slack = SLACK * largest;
    return SurfacePoint(position, slack, position + slack * normal, 0u, normal, from_outside,
                        normal, false, vec3f(1.0), vec2f(0.0));
}

// Takes the shading normal from those of the vertices, which need not be of unit length.
fn smooth_point(point: ptr<function, SurfacePoint>, prim: Primitive, attributes: Attributes,
                shares: vec3f) {
    let a = normalize_or(attributes.normal_a, vec3f(0.0));
    let b = normalize_or(attributes.normal_b, vec3f(0.0));
    let c = normalize_or(attributes.normal_c, vec3f(0.0));
    let normal = normalize_or(a * shares.x + b * shares.y + c * shares.z, vec3f(0.0));
    if (!is_finite(normal) || all(normal == vec3f(0.0))) {
        return;
    }
    let facet = (*point).facet_normal;
    let side = select(1.0, -1.0, dot(normal, facet) < 0.0);
    (*point).normal = side * normal;
    let along = side * vec3f(dot(a, facet), dot(b, facet), dot(c, facet));
    if (all(along > vec3f(SMOOTH_COS))) {
        let position = (*point).position;
        let lifted = lift(prim.a - position, side * a) * shares.x
            + lift(prim.b - position, side * b) * shares.y
            + lift(prim.c - position, side * c) * shares.z;
        (*point).shadow_position += lifted;
    }
}

fn lift(to_corner: vec3f, normal: vec3f) -> vec3f {
    return max(dot(to_corner, normal), 0.0) * normal;
}
