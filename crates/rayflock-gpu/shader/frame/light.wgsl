// How much light a light sends to a point, were nothing in the way, and what the point sends back.

// Rays from a light start this far along, and end this far before the point, relative to the
// distance: a lamp's own surface does not shade it, nor rounding the point.
const FROM_LIGHT: vec2f = vec2f(1e-4, 0.999996);
// Rays to a sampled point end this far before it.
const TO_EMITTER: f32 = 0.9999;

// A primitive that emits.
struct Emitter {
    a: vec3f,
    // TRIANGLE or SPHERE.
    kind: u32,
    // Second corner, or (radius, 0, 0).
    b: vec3f,
    // How likely it is chosen, relative to the others.
    weight: f32,
    c: vec3f,
    // The weights up to and including it.
    cumulative: f32,
    radiance: vec3f,
    unused: u32,
}

// Light on its way to a point, and what of it goes on to the pixel.
struct Lit {
    // Where the light comes from; for directional lights unused.
    source: vec3f,
    // 0 where nothing arrives.
    radiance: vec3f,
}

const UNLIT = Lit(vec3f(0.0), vec3f(0.0));

fn lit_by(light: Light, point: LitPoint) -> Lit {
    if (point.pixel == NO_PIXEL) {
        return UNLIT;
    }
    if (light.kind == EMITTERS) {
        return lit_by_emitters(light, point);
    }
    let offset = light.position - point.shadow_position;
    var to_light = normalize_or(offset, vec3f(0.0));
    var irradiance = light.intensity;
    if (light.kind == DIRECTIONAL) {
        to_light = -light.direction;
    } else if (light.is_constant == 0u) {
        irradiance /= dot(offset, offset);
    }
    if (light.kind == SPOT) {
        irradiance *= cone_share(light, -dot(to_light, light.direction));
    }
    return sent_back(point, to_light, irradiance, light.position);
}

// Lambert and Blinn-Phong, both over pi.
fn sent_back(point: LitPoint, to_light: vec3f, irradiance: vec3f, source: vec3f) -> Lit {
    let cos = dot(point.normal, to_light);
    if (!is_finite(irradiance) || cos <= 0.0) {
        return UNLIT;
    }
    var share = point.diffuse * cos;
    if (any(point.specular != vec3f(0.0))) {
        let halfway = normalize_or(point.to_viewer + to_light, vec3f(0.0));
        let highlight = max(dot(point.normal, halfway), 0.0);
        if (point.shininess <= 0.0) {
            share += point.specular;
        } else if (highlight > 0.0) {
            share += point.specular * pow(highlight, point.shininess);
        }
    }
    return Lit(source, share * irradiance * 0.31830987);
}

// A point on some emitter and what it sends.
fn lit_by_emitters(light: Light, point: LitPoint) -> Lit {
    let random = vec3f(unit_float(point.seed, 0u, light.sample_idx),
                       unit_float(point.seed, 1u, light.sample_idx),
                       unit_float(point.seed, 2u, light.sample_idx));
    let total = emitters[light.emitter_count - 1u].cumulative;
    let emitter = emitters[chosen_emitter(random.x * total, light.emitter_count)];
    let position = point.shadow_position;
    var sample = on_triangle_emitter(emitter, position, random);
    if (emitter.kind == SPHERE) {
        sample = on_sphere_emitter(emitter, position, random);
    }
    let solid_angle = sample.w * total / emitter.weight;
    if (!(sample.w > 0.0) || solid_angle > LARGEST) {
        return UNLIT;
    }
    let to_light = normalize_or(sample.xyz - position, vec3f(0.0));
    let irradiance = emitter.radiance * solid_angle / f32(light.sample_count);
    return sent_back(point, to_light, irradiance, sample.xyz);
}

// Point `sample_idx` of a path's sequence in the unit cube, along one axis.
fn unit_float(seed: u32, axis: u32, sample_idx: u32) -> f32 {
    let ratio = select(select(0x8cb92ba7u, 0xabc98389u, axis == 1u), 0xd1b54a33u, axis == 0u);
    return f32((hash(seed + axis) + sample_idx * ratio) >> 8u) / 16777216.0;
}

// The first whose sum of weights is larger.
fn chosen_emitter(choice: f32, count: u32) -> u32 {
    var low = 0u;
    var high = count - 1u;
    while (low < high) {
        let middle = (low + high) / 2u;
        if (emitters[middle].cumulative <= choice) {
            low = middle + 1u;
        } else {
            high = middle;
        }
    }
    return low;
}

// A point of a triangle, and the solid angle that stands for all of it; 0 for nothing.
fn on_triangle_emitter(emitter: Emitter, position: vec3f, random: vec3f) -> vec4f {
    let root = sqrt(random.y);
    let shares = vec2f(1.0 - root, root * random.z);
    let source = emitter.a * shares.x + emitter.b * shares.y
        + emitter.c * (1.0 - shares.x - shares.y);
    let doubled_normal = cross(emitter.b - emitter.a, emitter.c - emitter.a);
    let offset = source - position;
    let distance = length(offset);
    let cos_times_area = 0.5 * abs(dot(doubled_normal, offset)) / distance;
    return vec4f(source, cos_times_area / (distance * distance));
}

// A point of the visible part of a sphere, and the solid angle of that part; 0 from inside.
fn on_sphere_emitter(emitter: Emitter, position: vec3f, random: vec3f) -> vec4f {
    let radius = emitter.b.x;
    let offset = emitter.a - position;
    let distance = length(offset);
    let sine = radius / distance;
    if (sine >= 1.0) {
        return vec4f(0.0);
    }
    let depth = sine * sine / (1.0 + sqrt(1.0 - sine * sine));
    let height = 1.0 - random.y * depth;
    let sin_squared = max(1.0 - height * height, 0.0);
    // From the direction in the cone to the near point of the sphere along it.
    let half_chord = max(radius * radius - distance * distance * sin_squared, 0.0);
    let along = distance * height - sqrt(half_chord);
    let axis = offset / distance;
    // Two directions across the axis.
    let side_of_z = select(1.0, -1.0, axis.z < 0.0);
    let shrink = -1.0 / (side_of_z + axis.z);
    let mixed = axis.x * axis.y * shrink;
    let side = vec3f(1.0 + side_of_z * axis.x * axis.x * shrink, side_of_z * mixed,
                     -side_of_z * axis.x);
    let up = vec3f(mixed, side_of_z + axis.y * axis.y * shrink, -axis.y);
    let turn = 6.2831853 * random.z;
    let direction = axis * height + (side * cos(turn) + up * sin(turn)) * sqrt(sin_squared);
    return vec4f(position + along * direction, 6.2831853 * depth);
}
