// Gives the tiles of new subfields their places among the entries, and lets them count anew: a
// workgroup adds up the counts of its tiles, and takes room for all of them by one atomic operation.
//
// Where the tiles of other workgroups lie is of no interest, so no sums over all tiles are needed.

@group(0) @binding(0) var<storage, read_write> tiles: array<SubfieldTile>;
@group(0) @binding(1) var<storage, read_write> counters: SubfieldCounters;
@group(0) @binding(2) var<uniform> params: SubfieldParams;

const TILE_PLACERS: u32 = 256u;

var<workgroup> sums: array<u32, TILE_PLACERS>;
var<workgroup> first_entry: u32;

@compute @workgroup_size(TILE_PLACERS)
fn place_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let tile_count = params.tile_edge * params.tile_edge;
    let place = group.x * TILE_PLACERS + lane;
    let tile_idx = (counters.first_new + group.y) * tile_count + place;
    var own = 0u;
    if (place < tile_count) {
        own = atomicExchange(&tiles[tile_idx].count, 0u);
    }
    sums[lane] = own;
    for (var step = 1u; step < TILE_PLACERS; step *= 2u) {
        workgroupBarrier();
        let before = select(0u, sums[max(lane, step) - step], lane >= step);
        workgroupBarrier();
        sums[lane] += before;
    }
    if (lane == TILE_PLACERS - 1u) {
        let before = atomicAdd(&counters.entries, sums[lane]);
        if (before + sums[lane] < before) {
            atomicAdd(&counters.entries_high, 1u);
        }
        atomicStore(&counters.is_placed, 1u);
        first_entry = before;
    }
    let first = workgroupUniformLoad(&first_entry);
    if (place < tile_count) {
        tiles[tile_idx].first = first + sums[lane] - own;
    }
}
