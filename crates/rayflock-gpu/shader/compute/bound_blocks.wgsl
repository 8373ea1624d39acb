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
    blocks[block_idx] = sphere_around(first, end);
}

fn sphere_at(idx: u32) -> vec4f {
    return chunks[idx];
}
