// Opens a subfield for each cell that is wanted and has none: a frame across the cell's direction and
// a window around the scene. One workgroup, an invocation for each cell.
//
// Cells that there is no room for wait for the next round.

@group(0) @binding(0) var<storage, read_write> cells: array<u32, 512>;
@group(0) @binding(1) var<storage, read> bounds: array<u32, 6>;
@group(0) @binding(2) var<storage, read_write> subfields: array<Subfield>;
@group(0) @binding(3) var<storage, read_write> counters: SubfieldCounters;
// Workgroups of `write_tiles` and of `place_tiles`.
@group(0) @binding(4) var<storage, read_write> writers: array<u32, 3>;
@group(0) @binding(5) var<storage, read_write> placers: array<u32, 3>;
@group(0) @binding(6) var<uniform> params: SubfieldParams;

// No side of a window is less than this part of the scene, so that slack stays below a tile.
const NARROWEST: f32 = 0.015625;

var<workgroup> new_count: atomic<u32>;

@compute @workgroup_size(MOST_CELLS)
fn open_subfields(@builtin(local_invocation_index) cell: u32) {
    let held_count = counters.subfield_count;
    var state = cells[cell];
    var number = cells[MOST_CELLS + cell];
    if (state == TRACED) {
        state = DONE;
    }
    let is_wanted = state == WANTED;
    if (is_wanted && number == 0u) {
        let idx = held_count + atomicAdd(&new_count, 1u);
        if (idx < params.subfield_capacity) {
            number = idx + 1u;
            subfields[idx] = subfield_along(direction_of(cell));
        } else {
            atomicAdd(&counters.left_count, 1u);
        }
    }
    cells[cell] = select(state, TRACED, is_wanted && number != 0u);
    cells[MOST_CELLS + cell] = number;
    workgroupBarrier();
    if (cell == 0u) {
        let open_count = min(held_count + atomicLoad(&new_count), params.subfield_capacity);
        counters.first_new = held_count;
        counters.subfield_count = open_count;
        let tile_count = params.tile_edge * params.tile_edge;
        writers = array((params.prim_count + 63u) / 64u, open_count - held_count, 1u);
        placers = array((tile_count + 255u) / 256u, open_count - held_count, 1u);
    }
}

// The middle of a cell, as `mark_directions` lays them out.
fn direction_of(cell: u32) -> vec3f {
    if (params.is_shared != 0u) {
        return params.shared_direction;
    }
    let edge = params.direction_edge;
    let place = (2.0 * vec2f(f32(cell % edge), f32(cell / edge)) + 1.0) / f32(edge) - 1.0;
    let flat = 0.5 * vec2f(place.x + place.y, place.x - place.y);
    return normalize(vec3f(flat, 1.0 - abs(flat.x) - abs(flat.y)));
}

fn subfield_along(direction: vec3f) -> Subfield {
    let high = from_ordered_vector(vec3u(bounds[0], bounds[1], bounds[2]));
    let low = -from_ordered_vector(vec3u(bounds[3], bounds[4], bounds[5]));
    let center = 0.5 * low + 0.5 * high;
    // Below the range of `f32` there is nothing to tell apart.
    let half = max(max(high - center, center - low), vec3f(1e-30));
    let longest = max(max(half.x, half.y), half.z);
    let radius = longest * length(half / longest);
    let helper = select(vec3f(1.0, 0.0, 0.0), vec3f(0.0, 1.0, 0.0), abs(direction.x) > 0.7);
    let right = normalize(cross(direction, helper));
    let up = cross(right, direction);

    let tile_edge = f32(params.tile_edge);
    let scale = vec3f(tile_edge, tile_edge, f32(SLABS))
        / (2.0 * vec3f(reach(right, half, radius), reach(up, half, radius),
                       reach(direction, half, radius)));
    let pad = PLACE_SLACK * radius * scale;
    return Subfield(scale.x * right, pad.x, scale.y * up, pad.y, scale.z * direction, pad.z,
                    center, radius);
}

// How far a box with these half sides reaches along an axis, and a little more.
fn reach(axis: vec3f, half: vec3f, radius: f32) -> f32 {
    return max(dot(abs(axis), half) + 4.0 * PLACE_SLACK * radius, NARROWEST * radius);
}
