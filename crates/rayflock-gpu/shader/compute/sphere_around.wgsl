// A sphere around spheres, which the stage that uses it tells by `sphere_at`.

// Around those from `first` on that stand for something; a negative radius where none does.
fn sphere_around(first: u32, end: u32) -> vec4f {
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    for (var idx = first; idx < end; idx++) {
        let sphere = sphere_at(idx);
        if (sphere.w >= 0.0) {
            low = min(low, sphere.xyz);
            high = max(high, sphere.xyz);
        }
    }
    let center = 0.5 * low + 0.5 * high;
    var radius = -1.0;
    for (var idx = first; idx < end; idx++) {
        let sphere = sphere_at(idx);
        if (sphere.w >= 0.0) {
            radius = max(radius, distance(sphere.xyz, center) + sphere.w);
        }
    }
    return vec4f(center, radius);
}
