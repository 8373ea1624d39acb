// All ways from a light to the points in a ball: a cone from the light, which ends behind the ball.

struct LightShaft {
    cone: Cone,
    // How far from the light the farthest point lies at most.
    far: f32,
}

fn shaft_between(light: vec3f, ball: vec4f) -> LightShaft {
    let offset = ball.xyz - light;
    let apart = length(offset);
    let sin = ball.w / max(apart, TINY);
    let cos = sqrt(max(1.0 - sin * sin, 0.0));
    return LightShaft(bounded_cone(light, 0.0, unit_or_z(offset), cos, sin), apart + ball.w);
}

// Whether a way may meet the sphere; never false when one does.
fn shaft_touches(shaft: LightShaft, sphere: vec4f) -> bool {
    let is_near = near_distance(shaft.cone, sphere) <= shaft.far;
    return is_near && cone_touches(shaft.cone, sphere);
}
