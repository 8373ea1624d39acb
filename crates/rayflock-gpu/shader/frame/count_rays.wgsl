// Finds the key of each ray that the wave before left, and its place among those of the same key:
// rays that start and go alike have keys that are close.
//
// Origins lie among 8 x 8 x 8 cells of the scene's box, directions among 8 x 8 of an octahedral map;
// the bits of all five numbers, interleaved, are the key. Slots without a ray have the last one.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
// As `bound_scene` writes them.
@group(0) @binding(1) var<storage, read> bounds: array<u32, 6>;
@group(0) @binding(2) var<storage, read> wave_counts: array<u32, 4>;
@group(0) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;
// The key, and the place among its rays.
@group(0) @binding(4) var<storage, read_write> places: array<vec2u>;
@group(0) @binding(5) var<uniform> frame: FrameParams;

// Bits of each of the five numbers.
const KEY_BITS: u32 = 3u;
const IDLE_KEY: u32 = 1u << (5u * KEY_BITS);

@compute @workgroup_size(64)
fn count_rays(@builtin(global_invocation_id) id: vec3u) {
    let slot = id.x;
    var key = IDLE_KEY;
    if (slot < wave_counts[FOLLOWED]) {
        key = key_of(rays[frame.slot_count + slot]);
    }
    places[slot] = vec2u(key, atomicAdd(&counts[key], 1u));
}

fn key_of(ray: Ray) -> u32 {
    let high = from_ordered_vector(vec3u(bounds[0], bounds[1], bounds[2]));
    let low = -from_ordered_vector(vec3u(bounds[3], bounds[4], bounds[5]));
    let extent = high - low;
    let edge = max(max(max(extent.x, extent.y), extent.z), 1e-30);
    let origin = cells_of((ray.origin - low) / edge);
    let direction = cells_of(vec3f(0.5 * octahedral(ray.direction) + 0.5, 0.0));
    var key = 0u;
    for (var bit = KEY_BITS; bit > 0u; bit--) {
        let at = bit - 1u;
        let of_origin = (origin.x >> at & 1u) | (origin.y >> at & 1u) << 1u
            | (origin.z >> at & 1u) << 2u;
        let of_direction = (direction.x >> at & 1u) | (direction.y >> at & 1u) << 1u;
        key = key << 5u | of_origin << 2u | of_direction;
    }
    return key;
}

// The cells of places between 0 and 1.
fn cells_of(place: vec3f) -> vec3u {
    let cells = f32(1u << KEY_BITS);
    return vec3u(clamp(place * cells, vec3f(0.0), vec3f(cells - 1.0)));
}

// The place of a direction on a square from -1 to 1.
fn octahedral(direction: vec3f) -> vec2f {
    let size = abs(direction);
    let scaled = direction / max(max(size.x, size.y), size.z);
    let flat = scaled / (abs(scaled.x) + abs(scaled.y) + abs(scaled.z));
    let signs = select(vec2f(-1.0), vec2f(1.0), flat.xy >= vec2f(0.0));
    return select((1.0 - abs(flat.yx)) * signs, flat.xy, flat.z >= 0.0);
}
