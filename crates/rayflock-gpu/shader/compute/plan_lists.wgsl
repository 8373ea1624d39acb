// Gives each tile its place in the list of blocks: sums of the counts of the tiles before it. One
// workgroup for all tiles; counts begin anew, for `fill_lists` to count by.

@group(0) @binding(0) var<storage, read_write> ranges: array<TileRange>;

const PLANNERS: u32 = 256u;
const TILES_EACH: u32 = FIRST_NODE / PLANNERS;

var<workgroup> sums: array<u32, PLANNERS>;

@compute @workgroup_size(PLANNERS)
fn plan_lists(@builtin(local_invocation_index) lane: u32) {
    let first = lane * TILES_EACH;
    var own = 0u;
    for (var idx = first; idx < first + TILES_EACH; idx++) {
        own += atomicLoad(&ranges[idx].count);
    }
    sums[lane] = own;
    for (var step = 1u; step < PLANNERS; step *= 2u) {
        workgroupBarrier();
        let before = select(0u, sums[max(lane, step) - step], lane >= step);
        workgroupBarrier();
        sums[lane] += before;
    }
    var place = sums[lane] - own;
    for (var idx = first; idx < first + TILES_EACH; idx++) {
        ranges[idx].first = place;
        place += atomicExchange(&ranges[idx].count, 0u);
    }
}
