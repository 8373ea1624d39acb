// Writes the sphere around each chunk of consecutive primitives.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read_write> chunks: array<vec4f>;

@compute @workgroup_size(64)
fn bound_chunks(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                @builtin(local_invocation_index) lane: u32) {
    let chunk_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (chunk_idx >= arrayLength(&chunks)) {
        return;
    }
    let first = chunk_idx * CHUNK_PRIMS;
    let end = min(first + CHUNK_PRIMS, arrayLength(&primitives));
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    for (var prim_idx = first; prim_idx < end; prim_idx++) {
        let sphere = bounding_sphere(primitives[prim_idx]);
        if (sphere.w >= 0.0) {
            low = min(low, sphere.xyz);
            high = max(high, sphere.xyz);
        }
    }
    let center = 0.5 * low + 0.5 * high;
    var radius = -1.0;
    for (var prim_idx = first; prim_idx < end; prim_idx++) {
        let sphere = bounding_sphere(primitives[prim_idx]);
        if (sphere.w >= 0.0) {
            radius = max(radius, distance(sphere.xyz, center) + sphere.w);
        }
    }
    chunks[chunk_idx] = vec4f(center, radius);
}
