// Rays in textures, one a texel of the target.

@group(0) @binding(0) var origins: texture_2d<f32>;
@group(0) @binding(1) var directions: texture_2d<f32>;
@group(0) @binding(2) var masks: texture_2d<u32>;

fn ray_at(texel: vec2u) -> Ray {
    let origin = textureLoad(origins, texel, 0);
    let direction = textureLoad(directions, texel, 0);
    let mask = textureLoad(masks, texel, 0).x;
    return Ray(origin.xyz, origin.w, direction.xyz, direction.w, mask, 0u, 0u, 0u);
}
