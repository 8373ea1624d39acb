// Vectors that may be zero, or no numbers at all.

fn is_finite(v: vec3f) -> bool {
    let exponents = bitcast<vec3u>(v) & vec3u(0x7f800000u);
    return all(exponents != vec3u(0x7f800000u));
}

fn normalize_or(v: vec3f, other: vec3f) -> vec3f {
    let size = length(v);
    return select(other, v / size, size > 0.0);
}

fn largest_of(v: vec3f) -> f32 {
    return max(max(v.x, v.y), v.z);
}

// The unit normal of a triangle with these edges, zero where it has none; scaled, so that squares
// stay in range.
fn triangle_normal(ab: vec3f, ac: vec3f) -> vec3f {
    let size = max(largest_of(abs(ab)), largest_of(abs(ac)));
    return normalize_or(cross(ab / size, ac / size), vec3f(0.0));
}
