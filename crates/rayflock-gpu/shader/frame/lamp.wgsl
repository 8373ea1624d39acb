// Lights of the scene, as `layout::DeviceLight` writes them.

const POINT: u32 = 0u;
const DIRECTIONAL: u32 = 1u;
const SPOT: u32 = 2u;
const EMITTERS: u32 = 3u;

struct Light {
    position: vec3f,
    kind: u32,
    // Where it travels, or the axis of its cone; of unit length.
    direction: vec3f,
    // Whether it does not fall with the square of the distance.
    is_constant: u32,
    // Or the irradiance of a directional light.
    intensity: vec3f,
    cos_inner: f32,
    cos_outer: f32,
    // Of the samples on emitters that share the light.
    sample_idx: u32,
    sample_count: u32,
    emitter_count: u32,
}

// The share of a spot light's intensity at an angle with this cosine from its axis.
fn cone_share(light: Light, cos: f32) -> f32 {
    let width = max(light.cos_inner - light.cos_outer, 1e-4);
    let share = clamp((cos - light.cos_outer) / width, 0.0, 1.0);
    return share * share;
}
