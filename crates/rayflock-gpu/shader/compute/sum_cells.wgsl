// Adds up the primitives of all cells that a workgroup of `place_cells` places.

@group(0) @binding(0) var<storage, read> counts: array<u32>;
@group(0) @binding(1) var<storage, read_write> group_sums: array<u32>;
@group(0) @binding(2) var<uniform> params: CellParams;

var<workgroup> sum: atomic<u32>;

@compute @workgroup_size(PLACERS)
fn sum_cells(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let first = (group.x * PLACERS + lane) * CELLS_EACH;
    var own = 0u;
    for (var cell = first; cell < min(first + CELLS_EACH, params.cell_count); cell++) {
        own += counts[cell];
    }
    atomicAdd(&sum, own);
    workgroupBarrier();
    if (lane == 0u) {
        group_sums[group.x] = atomicLoad(&sum);
    }
}
