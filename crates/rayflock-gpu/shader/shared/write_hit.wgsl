// What a fragment stage writes for the ray of its texel, for the depth test to keep the nearest.

struct Written {
    // Bits of t, u and v, and the rank.
    @location(0) hit: vec4u,
    @builtin(frag_depth) depth: f32,
}

// The exact test of a ray; discards where it is not accepted.
fn write_hit(ray: Ray, prim: Primitive) -> Written {
    if (!is_active(ray)) {
        discard;
    }
    let prepared = prepare_ray(ray.origin, ray.direction, ray.t_min, ray.mask);
    let outcome = intersect(prepared, prim, ray.t_max);
    if (!outcome.accepted) {
        discard;
    }
    let bits = vec3u(bitcast<u32>(outcome.t), bitcast<u32>(outcome.u), bitcast<u32>(outcome.v));
    return Written(vec4u(bits, prim.rank), depth_of(outcome.t));
}
