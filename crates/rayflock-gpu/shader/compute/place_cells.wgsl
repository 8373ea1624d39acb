// Gives each cell the place of its first primitive in the order: sums of the counts before it.

@group(0) @binding(0) var<storage, read_write> counts: array<u32>;
@group(0) @binding(1) var<storage, read> group_sums: array<u32>;
@group(0) @binding(2) var<uniform> params: CellParams;

// Of the workgroups before.
var<workgroup> sum_before: atomic<u32>;
var<workgroup> sums: array<u32, PLACERS>;

@compute @workgroup_size(PLACERS)
fn place_cells(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    for (var idx = lane; idx < group.x; idx += PLACERS) {
        atomicAdd(&sum_before, group_sums[idx]);
    }
    let first = (group.x * PLACERS + lane) * CELLS_EACH;
    let end = min(first + CELLS_EACH, params.cell_count);
    var own = 0u;
    for (var cell = first; cell < end; cell++) {
        own += counts[cell];
    }
    sums[lane] = own;
    for (var step = 1u; step < PLACERS; step *= 2u) {
        workgroupBarrier();
        let before = select(0u, sums[max(lane, step) - step], lane >= step);
        workgroupBarrier();
        sums[lane] += before;
    }
    var place = atomicLoad(&sum_before) + sums[lane] - own;
    for (var cell = first; cell < end; cell++) {
        let count = counts[cell];
        counts[cell] = place;
        place += count;
    }
}
