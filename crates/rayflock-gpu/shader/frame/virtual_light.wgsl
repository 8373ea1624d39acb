// Virtual lights: what one sends to a point, were nothing in the way, and what the point sends
// back.

const PLAIN: u32 = 0u;
// With a highlight, or under varnish.
const LOBED: u32 = 1u;
// Infinitely far away.
const DISTANT: u32 = 2u;

// Keeps divisors above 0.
const TINY: f32 = 1e-37;

struct VirtualLight {
    // Of a distant light the unit direction to it.
    position: vec3f,
    kind: u32,
    // Of unit length; zero where it has no surface.
    normal: vec3f,
    // Added to the cosine: 0 for a surface, 1 for a point that shines evenly.
    evenness: f32,
    // Radiant intensity along the normal, lobe not included; irradiance if distant.
    intensity: vec3f,
    // Exponent of the lobe's highlight.
    shininess: f32,
    // Toward what the highlight mirrors, of unit length.
    to_source: vec3f,
    // The share of the light that varnish keeps back from those who look along the surface.
    varnish: f32,
    highlight: vec3f,
    unused: u32,
}

// The way from a point to a light.
struct LightWay {
    offset: vec3f,
    squared: f32,
    distance: f32,
    // Cosines at both ends times the distance.
    rise: f32,
    facing: f32,
    // The same, not below 0 and with the light's evenness, over the distance.
    at_point: f32,
    at_light: f32,
}

// What a light adds to the radiance of a point, and the sum of the colours that the bound keeps
// away.
struct Arriving {
    radiance: vec3f,
    lost: f32,
}

// The same light at a place in the scene: a distant one goes `distance` away from `center`, where
// it sends about what it does from afar.
fn placed(light: VirtualLight, center: vec3f, distance: f32) -> VirtualLight {
    var near = light;
    if (light.kind == DISTANT) {
        near.position = center + distance * light.position;
        near.intensity = light.intensity * (distance * distance);
    }
    return near;
}

fn way_to(light: VirtualLight, point: LitPoint) -> LightWay {
    let offset = light.position - point.shadow_position;
    let squared = dot(offset, offset);
    let distance = sqrt(squared);
    let inverse = 1.0 / max(squared, TINY);
    let rise = dot(offset, point.normal);
    let facing = -dot(offset, light.normal);
    let evenly = facing + distance * light.evenness;
    return LightWay(offset, squared, distance, rise, facing, max(rise, 0.0) * inverse,
                    max(evenly, 0.0) * inverse);
}

// Whether both face each other.
fn is_faced(way: LightWay) -> bool {
    return way.at_point * way.at_light > 0.0;
}

// Geometry terms count up to `bound`, but for distant lights.
fn arriving(light: VirtualLight, way: LightWay, point: LitPoint, bound: f32) -> Arriving {
    let terms = way.at_point * way.at_light;
    let sent = sent_along(light, way) * 0.31830987;
    var all = point.diffuse * terms;
    if (any(point.specular != vec3f(0.0)) && way.rise > 0.0) {
        let along = dot(way.offset, point.to_viewer);
        let halfway = dot(point.normal, point.to_viewer) * way.distance + way.rise;
        let strength = halfway_power(halfway, way.squared + way.distance * along, point.shininess);
        all += point.specular * (strength * way.at_light / max(way.distance, TINY));
    }
    let is_bounded = light.kind != DISTANT && terms > bound;
    let kept = select(1.0, bound / terms, is_bounded);
    let radiance = all * sent;
    return Arriving(radiance * kept, dot(radiance, vec3f(1.0 - kept)));
}

// The intensity toward the point over the cosine there.
fn sent_along(light: VirtualLight, way: LightWay) -> vec3f {
    if (light.kind != LOBED) {
        return light.intensity;
    }
    let sideways = max(1.0 - way.facing / max(way.distance, TINY), 0.0);
    let squared = sideways * sideways;
    let let_out = 1.0 - light.varnish * (squared * squared * sideways);
    // Halfway between the ways to the source and to the point.
    let along = dot(way.offset, light.to_source);
    let halfway = dot(light.normal, light.to_source) * way.distance + way.facing;
    let strength = halfway_power(halfway, way.squared - way.distance * along, light.shininess);
    return light.intensity * let_out + light.highlight * strength;
}

// The power of a cosine: that of the vector halfway between two ways. `product` is that of the
// normal and the sum of both, one of them of unit length and the other as long as the distance,
// times the distance; `half_squared` half the squared length of that sum.
fn halfway_power(product: f32, half_squared: f32, shininess: f32) -> f32 {
    if (shininess <= 0.0) {
        return 1.0;
    }
    let cos = product / sqrt(max(2.0 * half_squared, TINY));
    return select(0.0, pow(min(max(cos, TINY), 1.0), shininess), cos > 0.0);
}
