// Writes how many workgroups the next stage takes: one invocation for each child of each pair, or
// for each pair.

@group(0) @binding(0) var<storage, read_write> counters: Counters;
@group(0) @binding(1) var<storage, read_write> dispatch: array<u32, 3>;
@group(0) @binding(2) var<uniform> params: Params;

// Which pairs are read: 0 of roots, 1 of nodes, 2 of tiles.
override LEVEL: u32;

// Below the most workgroups that one dimension may have.
const ROW: u32 = 32768u;

@compute @workgroup_size(1)
fn plan_dispatch() {
    var pair_count = atomicLoad(&counters.root_pairs);
    var children = FAN_OUT;
    if (LEVEL == 1u) {
        pair_count = atomicLoad(&counters.node_pairs);
    }
    if (LEVEL == 2u) {
        pair_count = atomicLoad(&counters.tile_pairs);
        children = 1u;
    }
    let groups = (min(pair_count, params.pair_capacity) * children + 63u) / 64u;
    dispatch[0] = min(groups, ROW);
    dispatch[1] = (groups + ROW - 1u) / ROW;
    dispatch[2] = 1u;
}
