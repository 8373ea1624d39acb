// Finds the cell of each primitive, and its place among those of the same cell.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
// As `bound_scene` writes them.
@group(0) @binding(1) var<storage, read> bounds: array<u32, 6>;
@group(0) @binding(2) var<storage, read_write> counts: array<atomic<u32>>;
// The cell, and the place in it.
@group(0) @binding(3) var<storage, read_write> places: array<vec2u>;
@group(0) @binding(4) var<uniform> params: CellParams;

@compute @workgroup_size(64)
fn count_cells(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
               @builtin(local_invocation_index) lane: u32) {
    let prim_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (prim_idx < arrayLength(&primitives)) {
        let high = from_ordered_vector(vec3u(bounds[0], bounds[1], bounds[2]));
        let low = -from_ordered_vector(vec3u(bounds[3], bounds[4], bounds[5]));
        let cell = cell_of(primitives[prim_idx], low, high, params);
        places[prim_idx] = vec2u(cell, atomicAdd(&counts[cell], 1u));
    }
}
