// Brings the blocks of each tile together.

@group(0) @binding(0) var<storage, read> pairs: array<Pair>;
@group(0) @binding(1) var<storage, read_write> counters: Counters;
@group(0) @binding(2) var<storage, read_write> ranges: array<TileRange>;
@group(0) @binding(3) var<storage, read_write> list: array<u32>;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(64)
fn fill_lists(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
              @builtin(local_invocation_index) lane: u32) {
    let pair_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (pair_idx < min(atomicLoad(&counters.tile_pairs), params.pair_capacity)) {
        let pair = pairs[pair_idx];
        let range = &ranges[pair.cone_idx];
        list[(*range).first + atomicAdd(&(*range).count, 1u)] = pair.block_idx;
    }
}
