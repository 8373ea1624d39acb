// Rays in the order of their slots, as `layout::DeviceRay` writes them.

struct Ray {
    origin: vec3f,
    t_min: f32,
    direction: vec3f,
    // Below t_min for a ray that is not traced.
    t_max: f32,
    // Which objects the ray sees.
    mask: u32,
    // Where its hit goes.
    slot: u32,
    // Its direction among those of the engine of subfields, which writes it.
    cell: u32,
    // What a stage has the ray carry along: in waves from lights, the distance to the first hit.
    carried: u32,
}

fn is_active(ray: Ray) -> bool {
    return ray.t_min <= ray.t_max;
}
