// Asks the cones of each node's children about the block of each pair, and writes down the pairs
// that touch. Tiles whose cones bound nothing would touch all blocks, and need no pairs for that.

@group(0) @binding(0) var<storage, read> cones: array<Cone>;
@group(0) @binding(1) var<storage, read> blocks: array<vec4f>;
@group(0) @binding(2) var<storage, read> parents: array<Pair>;
@group(0) @binding(3) var<storage, read_write> pairs: array<Pair>;
@group(0) @binding(4) var<storage, read_write> counters: Counters;
@group(0) @binding(5) var<storage, read_write> ranges: array<TileRange>;
@group(0) @binding(6) var<uniform> params: Params;

// Whether the children are tiles.
override IS_LAST: bool;

@compute @workgroup_size(64)
fn refine(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
          @builtin(local_invocation_index) lane: u32) {
    let asked = (group.y * groups.x + group.x) * 64u + lane;
    let parent_count = select(atomicLoad(&counters.root_pairs), atomicLoad(&counters.node_pairs),
                              IS_LAST);
    var pair = Pair(0u, 0u);
    var touches = false;
    if (asked / FAN_OUT < min(parent_count, params.pair_capacity)) {
        let parent = parents[asked / FAN_OUT];
        let child = asked % FAN_OUT;
        pair.block_idx = parent.block_idx;
        pair.cone_idx = (parent.cone_idx - FIRST_NODE) * FAN_OUT + child;
        var is_there = pair.cone_idx < params.tile_count;
        if (!IS_LAST) {
            let node_idx = (parent.cone_idx - FIRST_ROOT) * FAN_OUT + child;
            pair.cone_idx = FIRST_NODE + node_idx;
            is_there = node_idx < count_at(FIRST_NODE, params);
        }
        if (is_there) {
            let cone = cones[pair.cone_idx];
            let is_listed = !(IS_LAST && is_everywhere(cone));
            touches = is_listed && cone_touches(cone, blocks[pair.block_idx]);
        }
    }
    let place_here = place_in_group(touches);
    if (lane == 0u) {
        if (IS_LAST) {
            first_place = atomicAdd(&counters.tile_pairs, atomicLoad(&kept));
        } else {
            first_place = atomicAdd(&counters.node_pairs, atomicLoad(&kept));
        }
    }
    let place = workgroupUniformLoad(&first_place) + place_here;
    if (touches && place < params.pair_capacity) {
        pairs[place] = pair;
        if (IS_LAST) {
            atomicAdd(&ranges[pair.cone_idx].count, 1u);
        }
    }
}
