// Writes the sphere around each primitive.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read_write> spheres: array<vec4f>;

@compute @workgroup_size(64)
fn bound_primitives(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                    @builtin(local_invocation_index) lane: u32) {
    let prim_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (prim_idx < arrayLength(&primitives)) {
        spheres[prim_idx] = bounding_sphere(primitives[prim_idx]);
    }
}
