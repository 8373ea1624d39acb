// Brings primitives to the tiles of new subfields that they touch: one workgroup for 64 primitives
// and a subfield. It runs twice, first counting what each tile will hold, then filling it in.
//
// One program does both, because two might round differently, and then a primitive might have been
// counted for one tile and be filled in to another. What touches many tiles, all invocations share.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read> subfields: array<Subfield>;
@group(0) @binding(2) var<storage, read_write> tiles: array<SubfieldTile>;
@group(0) @binding(3) var<storage, read_write> entries: array<u32>;
@group(0) @binding(4) var<storage, read_write> counters: SubfieldCounters;
@group(0) @binding(5) var<uniform> params: SubfieldParams;

const WRITERS: u32 = 64u;
// Tiles that one invocation looks at alone.
const FEW_TILES: u32 = 16u;

// A primitive as a subfield sees it: places in tiles.
struct Footprint {
    // Corners, or the centre and the half axes of an ellipse.
    a: vec2f,
    b: vec2f,
    c: vec2f,
    // What columns and rows may be off.
    pad: vec2f,
    // The first tile that may be touched, and how many there are from there on.
    first: vec2u,
    size: vec2u,
    kind: u32,
    entry: u32,
}

var<workgroup> wide: array<Footprint, WRITERS>;
var<workgroup> wide_count: atomic<u32>;
var<workgroup> shared_count: u32;

@compute @workgroup_size(WRITERS)
fn write_tiles(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let subfield_idx = counters.first_new + group.y;
    let first_tile = subfield_idx * params.tile_edge * params.tile_edge;
    let prim_idx = group.x * WRITERS + lane;
    if (prim_idx < params.prim_count && may_write()) {
        let prim = primitives[prim_idx];
        if (prim.mask != 0u) {
            let footprint = footprint_of(prim, prim_idx, subfields[subfield_idx]);
            let tile_count = footprint.size.x * footprint.size.y;
            if (tile_count > FEW_TILES) {
                wide[atomicAdd(&wide_count, 1u)] = footprint;
            } else {
                for (var idx = 0u; idx < tile_count; idx++) {
                    write_if_touched(footprint, idx, first_tile);
                }
            }
        }
    }
    workgroupBarrier();
    if (lane == 0u) {
        shared_count = atomicLoad(&wide_count);
    }
    let count = workgroupUniformLoad(&shared_count);
    for (var wide_idx = 0u; wide_idx < count; wide_idx++) {
        let footprint = wide[wide_idx];
        let tile_count = footprint.size.x * footprint.size.y;
        for (var idx = lane; idx < tile_count; idx += WRITERS) {
            write_if_touched(footprint, idx, first_tile);
        }
    }
}

// Entries are counted, or there is room for all that were.
fn may_write() -> bool {
    return atomicLoad(&counters.is_placed) == 0u
        || has_room(atomicLoad(&counters.entries), atomicLoad(&counters.entries_high),
                    params.entry_capacity);
}

fn footprint_of(prim: Primitive, prim_idx: u32, subfield: Subfield) -> Footprint {
    let pad = pad_of(subfield);
    let a = place_of(prim.a, subfield, params.tile_edge);
    var b = place_of(prim.b, subfield, params.tile_edge);
    var c = place_of(prim.c, subfield, params.tile_edge);
    var low = min(min(a, b), c) - pad;
    var high = max(max(a, b), c) + pad;
    if (prim.kind == SPHERE) {
        b = prim.b.x * vec3f(length(subfield.column), length(subfield.row), length(subfield.depth));
        low = a - b - pad;
        high = a + b + pad;
    }
    let edge = params.tile_edge;
    let first = vec2u(nearest_of(low.x, edge), nearest_of(low.y, edge));
    let last = vec2u(nearest_of(high.x, edge), nearest_of(high.y, edge));
    let slabs = nearest_of(low.z, SLABS) | (nearest_of(high.z, SLABS) << SLAB_BITS);
    return Footprint(a.xy, b.xy, c.xy, pad.xy, first, last - first + 1u, prim.kind,
                     prim_idx | (slabs << PRIM_BITS));
}

// Looks at one of the tiles that the footprint may touch.
fn write_if_touched(footprint: Footprint, idx: u32, first_tile: u32) {
    let tile = footprint.first + vec2u(idx % footprint.size.x, idx / footprint.size.x);
    if (!touches(footprint, tile)) {
        return;
    }
    let tile_idx = first_tile + tile.y * params.tile_edge + tile.x;
    let place = atomicAdd(&tiles[tile_idx].count, 1u);
    if (atomicLoad(&counters.is_placed) != 0u) {
        entries[tiles[tile_idx].first + place] = footprint.entry;
    }
}

// Whether something of the footprint may lie in a tile; never false when it does.
fn touches(footprint: Footprint, tile: vec2u) -> bool {
    let middle = vec2f(tile) + 0.5;
    let half = 0.5 + footprint.pad;
    let a = footprint.a - middle;
    if (footprint.kind == SPHERE) {
        let apart = max(abs(a) - half, vec2f(0.0)) / footprint.b;
        return dot(apart, apart) <= 1.0;
    }
    let b = footprint.b - middle;
    let c = footprint.c - middle;
    return !(parts(a, b, c, half) || parts(b, c, a, half) || parts(c, a, b, half));
}

// Whether the triangle lies on one side of a line along its edge from p to q, and a tile around 0 on
// the other.
fn parts(p: vec2f, q: vec2f, r: vec2f, half: vec2f) -> bool {
    let across = vec2f(q.y - p.y, p.x - q.x);
    let reach = dot(abs(across), half);
    let edge = dot(across, p);
    let corner = dot(across, r);
    return min(edge, corner) > reach || max(edge, corner) < -reach;
}
