// Tells each ray the cell of its direction, and marks the cells that occur.
//
// The hemisphere is unfolded to a square by a hemi-octahedral map and cut into equal cells; a ray and
// its reverse share one. Any partition is right: rays go about along the direction of their cell, and
// how nearly only decides how many tiles they visit. Cells are kept with the rays, since programs may
// round differently and no two may disagree.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
// What the rays of each cell want, then one more than the subfield of each cell.
@group(0) @binding(1) var<storage, read_write> cells: array<atomic<u32>, 512>;
@group(0) @binding(2) var<uniform> params: SubfieldParams;

@compute @workgroup_size(64)
fn mark_directions(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                   @builtin(local_invocation_index) lane: u32) {
    let ray_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (ray_idx >= arrayLength(&rays)) {
        return;
    }
    let ray = rays[ray_idx];
    if (!is_active(ray)) {
        return;
    }
    let cell = select(cell_of(ray.direction), 0u, params.is_shared != 0u);
    rays[ray_idx].cell = cell;
    if (atomicLoad(&cells[cell]) != WANTED) {
        atomicStore(&cells[cell], WANTED);
    }
}

fn cell_of(direction: vec3f) -> u32 {
    let size = abs(direction);
    let scaled = direction / max(max(size.x, size.y), size.z);
    let upward = select(scaled, -scaled, scaled.z < 0.0);
    let flat = upward.xy / (abs(upward.x) + abs(upward.y) + upward.z);
    let edge = params.direction_edge;
    let place = 0.5 * f32(edge) * (vec2f(flat.x + flat.y, flat.x - flat.y) + 1.0);
    return nearest_of(place.y, edge) * edge + nearest_of(place.x, edge);
}
