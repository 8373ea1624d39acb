// Asks the cone of each root about each block, and writes down the pairs that touch.

@group(0) @binding(0) var<storage, read> cones: array<Cone>;
@group(0) @binding(1) var<storage, read> blocks: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> pairs: array<Pair>;
@group(0) @binding(3) var<storage, read_write> counters: Counters;
@group(0) @binding(4) var<uniform> params: Params;

@compute @workgroup_size(64)
fn seed_pairs(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
              @builtin(local_invocation_index) lane: u32) {
    let asked = (group.y * groups.x + group.x) * 64u + lane;
    let root_idx = asked / params.block_count;
    let pair = Pair(FIRST_ROOT + root_idx, asked % params.block_count);
    var touches = false;
    if (root_idx < count_at(FIRST_ROOT, params)) {
        touches = cone_touches(cones[pair.cone_idx], blocks[pair.block_idx]);
    }
    let place_here = place_in_group(touches);
    if (lane == 0u) {
        first_place = atomicAdd(&counters.root_pairs, atomicLoad(&kept));
    }
    let place = workgroupUniformLoad(&first_place) + place_here;
    if (touches && place < params.pair_capacity) {
        pairs[place] = pair;
    }
}
