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
    chunks[chunk_idx] = sphere_around(first, end);
}

fn sphere_at(idx: u32) -> vec4f {
    return bounding_sphere(primitives[idx]);
}
