// Keeps primitives in the order in which they came where their chunks are smaller so.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read> chunks: array<vec4f>;
// Of the chunks as they came, then of those in the order of cells.
@group(0) @binding(2) var<storage, read> sizes: array<f32, 2>;
@group(0) @binding(3) var<storage, read_write> ordered: array<Primitive>;
@group(0) @binding(4) var<storage, read_write> ordered_chunks: array<vec4f>;

@compute @workgroup_size(64)
fn take_order(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
              @builtin(local_invocation_index) lane: u32) {
    let idx = (group.y * groups.x + group.x) * 64u + lane;
    if (idx >= arrayLength(&primitives) || sizes[1] < sizes[0]) {
        return;
    }
    ordered[idx] = primitives[idx];
    if (idx < arrayLength(&chunks)) {
        ordered_chunks[idx] = chunks[idx];
    }
}
