// How much of a light comes to a point past soft spheres and walls that stand for geometry, as
// `rayflock_geom::simd::{segment_spheres, segment_walls}` define it.

// A sphere counts in full where its centre lies this share of the outer radius above the plane of
// an end point, and less below.
const RISE: f32 = 0.25;
// The share of what a sphere would dim at an end point that does not count.
const AT_END: f32 = 0.75;
// Less light than this share is none.
const DARK: f32 = 0.001953125;

// A sphere that stands for geometry, made ready for segments.
struct SoftSphere {
    center: vec3f,
    // From here on a segment is not dimmed.
    outer: f32,
    // Along this direction lengths count sqrt(1 + l^2) times, where l is its length; zero for a
    // round sphere.
    flatness: vec3f,
    opacity: f32,
    // The dimming that a distance of zero would have, were it not bounded, and how fast it falls
    // with the squared distance.
    peak: f32,
    slope: f32,
    unused_a: u32,
    unused_b: u32,
}

// What a sphere is to one light.
struct Blocker {
    sphere_idx: u32,
    // What of its dimming at the light does not count.
    at_light: f32,
    // How much of it counts at the light; nothing of it where that is 0.
    share: f32,
    // From the centre to the light, along the flatness.
    light_across: f32,
}

// A parallelogram that dims what goes through it.
struct Wall {
    corner: vec3f,
    // The share of light that it takes away.
    opacity: f32,
    // Of unit length.
    normal: vec3f,
    unused_a: u32,
    // Products of these and an offset from the corner are its coordinates: from 0 to 1 within.
    axis_a: vec3f,
    unused_b: u32,
    axis_b: vec3f,
    unused_c: u32,
}

fn dimming(sphere: SoftSphere, distance_squared: f32) -> f32 {
    return clamp(sphere.peak - distance_squared * sphere.slope, 0.0, sphere.opacity);
}

// The share of a sphere that counts at an end that its centre lies so high above.
fn share_at(sphere: SoftSphere, height: f32) -> f32 {
    return clamp(height / (RISE * sphere.outer), 0.0, 1.0);
}

// A sphere as seen from a light with a surface normal, or zero for a light without.
fn blocker_toward(sphere: SoftSphere, sphere_idx: u32, light: vec3f, normal: vec3f) -> Blocker {
    let to_light = light - sphere.center;
    let across = dot(sphere.flatness, to_light);
    let at_light = AT_END * dimming(sphere, dot(to_light, to_light) + across * across);
    let share = share_at(sphere, -dot(normal, to_light));
    return Blocker(sphere_idx, at_light, select(share, 1.0, all(normal == vec3f(0.0))), across);
}

// The share of a light that one sphere takes away from a point with a unit normal.
fn taken_by(sphere: SoftSphere, blocker: Blocker, point: vec3f, normal: vec3f,
            light: vec3f) -> f32 {
    // Squared lengths, as the sphere counts them: from the point to the centre and to the light,
    // and the product of both ways.
    let offset = sphere.center - point;
    let way = light - point;
    let across = dot(offset, sphere.flatness);
    let all_across = across + blocker.light_across;
    let at_point = dot(offset, offset) + across * across;
    let along = dot(offset, way) + across * all_across;
    let squared = max(dot(way, way) + all_across * all_across, TINY);

    let nearest = clamp(along, 0.0, squared);
    let distance = at_point - nearest * (2.0 * along - nearest) / squared;
    let at_ends = AT_END * dimming(sphere, at_point) + blocker.at_light;
    let counted = max(dimming(sphere, distance) - at_ends, 0.0);
    return counted * share_at(sphere, dot(offset, normal)) * blocker.share;
}

// How far a point lies above a wall, on the side of its normal.
fn height_above(wall: Wall, point: vec3f) -> f32 {
    return dot(wall.normal, point - wall.corner);
}

// The share of light that comes past a wall.
fn past_wall(wall: Wall, point: vec3f, light: vec3f) -> f32 {
    let height = height_above(wall, point);
    let light_height = height_above(wall, light);
    if (!(height * light_height < 0.0)) {
        return 1.0;
    }
    // Where on its way the segment meets the plane.
    let met = mix(point, light, height / (height - light_height)) - wall.corner;
    let place = vec2f(dot(wall.axis_a, met), dot(wall.axis_b, met));
    let is_hit = all(place >= vec2f(0.0)) && all(place <= vec2f(1.0));
    return select(1.0, 1.0 - wall.opacity, is_hit);
}
