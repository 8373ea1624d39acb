// Writes the sphere around each block of consecutive chunks.

@group(0) @binding(0) var<storage, read> chunks: array<vec4f>;
@group(0) @binding(1) var<storage, read_write> blocks: array<vec4f>;

@compute @workgroup_size(64)
fn bound_blocks(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                @builtin(local_invocation_index) lane: u32) {
    let block_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (block_idx >= arrayLength(&blocks)) {
        return;
    }
    let first = block_idx * BLOCK_CHUNKS;
    let end = min(first + BLOCK_CHUNKS, arrayLength(&chunks));
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    for (var chunk_idx = first; chunk_idx < end; chunk_idx++) {
        let sphere = chunks[chunk_idx];
        if (sphere.w >= 0.0) {
            low = min(low, sphere.xyz);
            high = max(high, sphere.xyz);
        }
    }
    let center = 0.5 * low + 0.5 * high;
    var radius = -1.0;
    for (var chunk_idx = first; chunk_idx < end; chunk_idx++) {
        let sphere = chunks[chunk_idx];
        if (sphere.w >= 0.0) {
            radius = max(radius, distance(sphere.xyz, center) + sphere.w);
        }
    }
    blocks[block_idx] = vec4f(center, radius);
}
