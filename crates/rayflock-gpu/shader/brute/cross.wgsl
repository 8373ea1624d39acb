// The ray engine: each primitive is drawn over all rays; the depth test keeps the nearest.

@vertex
fn draw_everywhere(@builtin(vertex_index) corner: u32, prim: DrawnPrimitive) -> Drawn {
    // One triangle that covers the viewport.
    let position = vec2f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0);
    return drawn_at(position, prim);
}

@fragment
fn cross(drawn: Drawn) -> Written {
    return write_hit(ray_at(vec2u(drawn.position.xy)), primitive_of(drawn));
}
