// Traces rays through the subfields of their cells, one invocation a ray.
//
// Seen along a direction, a ray is a line over the tiles: it visits strips of tiles from near to far,
// each reckoned from the ray's equation and not from the strip before, so that errors do not add up.
// In a tile it meets the entries whose slabs overlap with its own depths there.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(2) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(3) var<storage, read> cells: array<u32, 512>;
@group(0) @binding(4) var<storage, read> subfields: array<Subfield>;
@group(0) @binding(5) var<storage, read_write> tiles: array<SubfieldTile>;
@group(0) @binding(6) var<storage, read> entries: array<u32>;
@group(0) @binding(7) var<storage, read_write> counters: SubfieldCounters;
@group(0) @binding(8) var<uniform> params: SubfieldParams;

const TRACERS: u32 = 64u;
// A way shorter than this part of a tile is not cut: quotients by its pace say little.
const SHORT_WAY: f32 = 0.0625;
// A way that ends before it begins.
const NO_WAY = vec2f(1.0, 0.0);

// Tests of the rays of a workgroup.
var<workgroup> triangle_tests: atomic<u32>;
var<workgroup> sphere_tests: atomic<u32>;

// A ray on its way. Lengths are in units of the scene, from the origin on.
struct Walker {
    ray: PreparedRay,
    hit: Hit,
    // Units of length in one of t.
    length: f32,
    // Column, row and slab at the origin, and for each unit of length.
    start: vec3f,
    pace: vec3f,
    // What places, and lengths, may be off.
    pad: vec3f,
    slack: f32,
    // The length after which nothing is of interest.
    end: f32,
    // Whether a nearer hit is of interest.
    is_active: bool,
    triangle_tests: u32,
    sphere_tests: u32,
}

@compute @workgroup_size(TRACERS)
fn trace_rays(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
              @builtin(local_invocation_index) lane: u32) {
    let ray_idx = (group.y * groups.x + group.x) * TRACERS + lane;
    if (ray_idx < arrayLength(&rays)) {
        trace_ray(rays[ray_idx]);
    }
    workgroupBarrier();
    if (lane == 0u) {
        count_tests();
    }
}

fn count_tests() {
    let triangles = atomicLoad(&triangle_tests);
    let triangles_before = atomicAdd(&counters.triangle_tests, triangles);
    if (triangles_before + triangles < triangles_before) {
        atomicAdd(&counters.triangle_tests_high, 1u);
    }
    let spheres = atomicLoad(&sphere_tests);
    let spheres_before = atomicAdd(&counters.sphere_tests, spheres);
    if (spheres_before + spheres < spheres_before) {
        atomicAdd(&counters.sphere_tests_high, 1u);
    }
}

fn trace_ray(ray: Ray) {
    if (!is_active(ray) || cells[ray.cell] != TRACED
        || !has_room(atomicLoad(&counters.entries), atomicLoad(&counters.entries_high),
                     params.entry_capacity)) {
        return;
    }
    let hit = hits[ray.slot];
    if (params.question == QUESTION_OCCLUDED && hit.rank != NO_RANK) {
        return;
    }
    let subfield_idx = cells[MOST_CELLS + ray.cell] - 1u;
    let subfield = subfields[subfield_idx];
    var walker = start_walk(ray, hit, subfield);
    walk(&walker, way_of(ray, walker, subfield), subfield_idx);
    hits[ray.slot] = walker.hit;
    atomicAdd(&triangle_tests, walker.triangle_tests);
    atomicAdd(&sphere_tests, walker.sphere_tests);
}

fn start_walk(ray: Ray, hit: Hit, subfield: Subfield) -> Walker {
    let prepared = prepare_ray(ray.origin, ray.direction, ray.t_min, ray.mask);
    let size = abs(ray.direction);
    let largest = max(max(size.x, size.y), size.z);
    let scaled_length = length(prepared.direction);
    let distance = distance_of(ray.origin - subfield.center);
    let start = place_of(ray.origin, subfield, params.tile_edge);
    let pace = pace_of(prepared.direction / scaled_length, subfield);
    let pad = pad_of(subfield) * (2.0 + distance / subfield.radius);
    let slack = 2.0 * PLACE_SLACK * (distance + subfield.radius);
    let unit = largest * scaled_length;
    // Ends of intervals may be too large to be brought to lengths.
    let farthest = (distance + 2.0 * subfield.radius) / unit;
    let end = clamp(hit.t, -farthest, farthest) * unit + slack;
    return Walker(prepared, hit, unit, start, pace, pad, slack, end, true, 0u, 0u);
}

// The length of a vector whose square may be out of range.
fn distance_of(v: vec3f) -> f32 {
    let largest = max(max(abs(v.x), abs(v.y)), abs(v.z));
    return select(0.0, largest * length(v / largest), largest > 0.0);
}

// The part of the ray's interval that lies within the scene: where it begins and ends.
fn way_of(ray: Ray, walker: Walker, subfield: Subfield) -> vec2f {
    let reach = distance_of(ray.origin - subfield.center) + 2.0 * subfield.radius;
    let farthest = reach / walker.length;
    let begin = clamp(ray.t_min, -farthest, farthest) * walker.length - walker.slack;
    let edge = f32(params.tile_edge);
    var way = vec2f(begin, walker.end);
    way = cut(way, walker.start.x, walker.pace.x, -walker.pad.x, edge + walker.pad.x);
    way = cut(way, walker.start.y, walker.pace.y, -walker.pad.y, edge + walker.pad.y);
    return cut(way, walker.start.z, walker.pace.z, -walker.pad.z, f32(SLABS) + walker.pad.z);
}

// The part of a way on which a place lies between two others.
fn cut(way: vec2f, start: f32, pace: f32, low: f32, high: f32) -> vec2f {
    if (abs(pace) * (way.y - way.x) <= SHORT_WAY) {
        let place = start + pace * way.x;
        let is_there = place >= low - SHORT_WAY && place <= high + SHORT_WAY;
        return select(NO_WAY, way, is_there);
    }
    let a = (low - start) / pace;
    let b = (high - start) / pace;
    return vec2f(max(way.x, min(a, b)), min(way.y, max(a, b)));
}

// Visits tiles in strips across the axis along which the ray makes more way.
fn walk(walker: ptr<function, Walker>, way: vec2f, subfield_idx: u32) {
    if (!(way.x <= way.y)) {
        return;
    }
    let w = *walker;
    let edge = params.tile_edge;
    let first_tile = subfield_idx * edge * edge;
    let is_upright = abs(w.pace.y) > abs(w.pace.x);
    let start = select(w.start.xy, w.start.yx, is_upright);
    let pace = select(w.pace.xy, w.pace.yx, is_upright);
    let pad = select(w.pad.xy, w.pad.yx, is_upright);
    let strips = tiles_between(start.x, pace.x, pad.x, way);
    for (var step = 0u; step <= strips.y - strips.x; step++) {
        let strip = select(strips.x + step, strips.y - step, pace.x < 0.0);
        let edges = vec2f(f32(strip) - pad.x, f32(strip + 1u) + pad.x);
        let part = select(way, cut(way, start.x, pace.x, edges.x, edges.y), strips.x < strips.y);
        if (part.x > (*walker).end || !(*walker).is_active) {
            return;
        }
        if (part.x > part.y) {
            continue;
        }
        let rows = tiles_between(start.y, pace.y, pad.y, part);
        for (var row = rows.x; row <= rows.y; row++) {
            let tile = select(vec2u(strip, row), vec2u(row, strip), is_upright);
            meet_tile(walker, first_tile + tile.y * edge + tile.x, part);
        }
    }
}

// The first and the last tile that a part of the ray may be in, along an axis.
fn tiles_between(start: f32, pace: f32, pad: f32, part: vec2f) -> vec2u {
    let a = start + pace * part.x;
    let b = start + pace * part.y;
    return vec2u(nearest_of(min(a, b) - pad, params.tile_edge),
                 nearest_of(max(a, b) + pad, params.tile_edge));
}

// The first and the last slab that a part of the ray may be in before its nearest hit.
fn slabs_between(walker: ptr<function, Walker>, part: vec2f) -> vec2u {
    let a = (*walker).start.z + (*walker).pace.z * part.x;
    let b = (*walker).start.z + (*walker).pace.z * min(part.y, (*walker).end);
    return vec2u(nearest_of(min(a, b) - (*walker).pad.z, SLABS),
                 nearest_of(max(a, b) + (*walker).pad.z, SLABS));
}

fn meet_tile(walker: ptr<function, Walker>, tile_idx: u32, part: vec2f) {
    let first = tiles[tile_idx].first;
    let count = atomicLoad(&tiles[tile_idx].count);
    var slabs = slabs_between(walker, part);
    for (var idx = first; idx < first + count; idx++) {
        let entry = entries[idx];
        let nearest_slab = (entry >> PRIM_BITS) & (SLABS - 1u);
        let farthest_slab = entry >> (PRIM_BITS + SLAB_BITS);
        if (nearest_slab <= slabs.y && farthest_slab >= slabs.x && (*walker).is_active) {
            if (meet_primitive(walker, primitives[entry & ((1u << PRIM_BITS) - 1u)])) {
                slabs = slabs_between(walker, part);
            }
        }
    }
}

// Tests a primitive; returns whether it is nearer than what was hit before.
fn meet_primitive(walker: ptr<function, Walker>, prim: Primitive) -> bool {
    (*walker).sphere_tests += prim.kind;
    (*walker).triangle_tests += 1u - prim.kind;
    let found = intersect((*walker).ray, prim, (*walker).hit.t);
    let hit = Hit(found.t, found.u, found.v, prim.rank);
    if (!found.accepted || !is_nearer(hit, (*walker).hit)) {
        return false;
    }
    (*walker).hit = hit;
    (*walker).end = min((*walker).end, found.t * (*walker).length + (*walker).slack);
    (*walker).is_active = params.question != QUESTION_OCCLUDED;
    return true;
}
