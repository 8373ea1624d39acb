// Computes the cone around the rays of each tile, one texel a tile.

struct BoundedTile {
    // Centre and radius of the sphere that holds the origins.
    @location(0) origin: vec4f,
    // Axis and sine of the half angle.
    @location(1) direction: vec4f,
}

@vertex
fn draw_tiles(@builtin(vertex_index) corner: u32) -> @builtin(position) vec4f {
    return vec4f(f32(corner & 1u) * 4.0 - 1.0, f32(corner >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn bound_tiles(@builtin(position) position: vec4f) -> BoundedTile {
    let first = vec2u(position.xy) * TILE_EDGE;
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    var sum = vec3f(0.0);
    var reaches_behind = false;
    for (var idx = 0u; idx < TILE_EDGE * TILE_EDGE; idx++) {
        let ray = ray_at(first + vec2u(idx % TILE_EDGE, idx / TILE_EDGE));
        if (is_active(ray)) {
            low = min(low, ray.origin);
            high = max(high, ray.origin);
            sum += unit_direction(ray.direction);
            reaches_behind |= ray.t_min < 0.0;
        }
    }
    if (low.x > high.x) {
        return tile_of(EMPTY_CONE);
    }
    let center = 0.5 * low + 0.5 * high;
    let axis = unit_or_z(sum);
    var radius = 0.0;
    var cos = 1.0;
    var sin = 0.0;
    for (var idx = 0u; idx < TILE_EDGE * TILE_EDGE; idx++) {
        let ray = ray_at(first + vec2u(idx % TILE_EDGE, idx / TILE_EDGE));
        if (is_active(ray)) {
            let unit = unit_direction(ray.direction);
            let along = dot(unit, axis);
            radius = max(radius, distance(ray.origin, center));
            cos = min(cos, along);
            sin = max(sin, length(unit - along * axis));
        }
    }
    if (reaches_behind) {
        return tile_of(Cone(center, UNBOUNDED, axis, EVERYWHERE));
    }
    return tile_of(bounded_cone(center, radius, axis, cos, sin));
}

fn tile_of(cone: Cone) -> BoundedTile {
    return BoundedTile(vec4f(cone.center, cone.radius), vec4f(cone.axis, cone.sin));
}
