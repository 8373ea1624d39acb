// Materials and textures of the scene.

fn material_at(idx: u32) -> Material {
    let a = scene[7u * idx];
    let b = scene[7u * idx + 1u];
    let c = scene[7u * idx + 2u];
    let d = scene[7u * idx + 3u];
    let e = scene[7u * idx + 4u];
    let f = scene[7u * idx + 5u];
    let g = scene[7u * idx + 6u];
    return Material(a.xyz, a.w, b.xyz, b.w, c.xyz, u32(c.w), d.xyz, u32(d.w), e.xyz, 0u, f.xyz, 0u,
                    g.xyz, 0u);
}

// What multiplies the diffuse and ambient share: texture and vertex colour.
fn base_color(material: Material, point: SurfacePoint) -> vec3f {
    if (material.texture == 0u || !point.has_uv) {
        return point.tint;
    }
    return point.tint * bilinear(scene[frame.first_texture + material.texture - 1u], point.uv);
}

// The colour of a texture, of which first texel and size are given, between its four nearest
// texels, repeating in both directions.
fn bilinear(texture: vec4f, uv: vec2f) -> vec3f {
    let first = u32(texture.x);
    let size = vec2u(texture.yz);
    let wrapped = uv - floor(uv);
    let is_number = (wrapped >= vec2f(0.0)) & (wrapped <= vec2f(1.0));
    let place = select(vec2f(0.0), wrapped, is_number) * vec2f(size) - vec2f(0.5);
    let share = place - floor(place);
    let low = select(min(vec2u(max(place, vec2f(0.0))), size - vec2u(1u)), size - vec2u(1u),
                     floor(place) < vec2f(0.0));
    let high = select(low + vec2u(1u), vec2u(0u), low + vec2u(1u) == size);
    let top = mix(texel(first, size, low), texel(first, size, vec2u(high.x, low.y)), share.x);
    let bottom = mix(texel(first, size, vec2u(low.x, high.y)), texel(first, size, high), share.x);
    return mix(top, bottom, share.y);
}

fn texel(first: u32, size: vec2u, place: vec2u) -> vec3f {
    return scene[first + place.y * size.x + place.x].xyz;
}
