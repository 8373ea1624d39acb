// What the stages of a picture share; `layout` mirrors it.
//
// A wave is the rays of one bounce, one a slot. It lies in the first half of a buffer; what it leaves
// for the next one is appended to the second.

// Stands for a slot whose ray found nothing that lights may light.
const NO_PIXEL: u32 = 0xffffffffu;

struct FrameParams {
    // A place in the world for each position on the film, in pixels; for a pinhole, relative to it.
    top_left: vec3f,
    width: u32,
    right: vec3f,
    row_count: u32,
    down: vec3f,
    // Of the picture's rows, where those of the band begin.
    first_row: u32,
    // The pinhole, or the direction of all rays.
    eye: vec3f,
    is_parallel: u32,
    // The background from above, from the horizon and from below.
    zenith: vec3f,
    // The share of the background that lights surfaces.
    sky_share: f32,
    horizon: vec3f,
    // Slots of a wave.
    slot_count: u32,
    ground: vec3f,
    // Where the scene's textures begin.
    first_texture: u32,
    // Light from everywhere, as irradiance over pi.
    ambient: vec3f,
    // Whether rays go on after this bounce.
    goes_on: u32,
    // Where in its pixel a ray goes through.
    subpixel: vec2f,
    // Whether surfaces that would send back more light than arrives are scaled down.
    conserves: u32,
    unused: u32,
}

// What a ray carries besides its geometry.
struct Path {
    // Multiplies what the ray finds.
    weight: vec3f,
    // Of the band, by rows.
    pixel: u32,
    // Of what the ray passes through, for each unit of length.
    absorption: vec3f,
    // Chooses the points on emitters.
    seed: u32,
}

// A point that lights may light, with all that its radiance depends on.
struct LitPoint {
    // Where shadow rays end.
    shadow_position: vec3f,
    // NO_PIXEL where there is no point, or nothing that it would send back.
    pixel: u32,
    normal: vec3f,
    shininess: f32,
    // Towards where the ray came from, of unit length.
    to_viewer: vec3f,
    seed: u32,
    // Shares times the path's weight.
    diffuse: vec3f,
    unused_a: u32,
    specular: vec3f,
    unused_b: u32,
    // What arrives at the pixel without any light, and which pixel that is.
    emitted: vec3f,
    emitted_pixel: u32,
}

// Rays of the next wave, those included for which there is no room: mirrored and all; and shadow
// rays of this wave towards one light.
const MIRRORED: u32 = 0u;
const FOLLOWED: u32 = 1u;
const SHADOW: u32 = 2u;

// A ray that is not traced.
fn idle_ray(slot: u32) -> Ray {
    return Ray(vec3f(0.0), 1.0, vec3f(0.0, 0.0, 1.0), 0.0, 0u, slot, 0u, 0u);
}

fn traced_ray(origin: vec3f, direction: vec3f, t_min: f32, t_max: f32, slot: u32) -> Ray {
    return Ray(origin, t_min, direction, t_max, 0xffffffffu, slot, 0u, 0u);
}

// Spreads every bit over all others.
fn hash(x: u32) -> u32 {
    let y = (x ^ (x >> 16u)) * 0x7feb352du;
    let z = (y ^ (y >> 15u)) * 0x846ca68bu;
    return z ^ (z >> 16u);
}
