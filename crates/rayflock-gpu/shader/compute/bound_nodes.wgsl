// Computes the cone around the cones of each node's children, level by level.

@group(0) @binding(0) var<storage, read_write> cones: array<Cone>;
@group(0) @binding(1) var<uniform> params: Params;

// Where the children's cones begin, and those of the nodes.
override FIRST_CHILD: u32;
override FIRST_PARENT: u32;

@compute @workgroup_size(64)
fn bound_nodes(@builtin(global_invocation_id) id: vec3u) {
    let node_idx = id.x;
    if (node_idx >= count_at(FIRST_PARENT, params)) {
        return;
    }
    let first = FIRST_CHILD + node_idx * FAN_OUT;
    let end = min(first + FAN_OUT, FIRST_CHILD + count_at(FIRST_CHILD, params));
    cones[FIRST_PARENT + node_idx] = cone_around(first, end);
}

fn cone_around(first: u32, end: u32) -> Cone {
    var low = vec3f(LARGEST);
    var high = vec3f(-LARGEST);
    var sum = vec3f(0.0);
    var is_bounded = true;
    for (var idx = first; idx < end; idx++) {
        let cone = cones[idx];
        if (cone.sin >= 0.0) {
            low = min(low, cone.center);
            high = max(high, cone.center);
            sum += cone.axis;
            is_bounded &= cone.sin < 1.0;
        }
    }
    if (low.x > high.x) {
        return EMPTY_CONE;
    }
    let center = 0.5 * low + 0.5 * high;
    let axis = unit_or_z(sum);
    var radius = 0.0;
    var cos = 1.0;
    var sin = 0.0;
    for (var idx = first; idx < end; idx++) {
        let cone = cones[idx];
        if (cone.sin >= 0.0) {
            radius = max(radius, distance(cone.center, center) + cone.radius);
            // The angle to the child's axis, plus the child's own half angle.
            let along = dot(cone.axis, axis);
            let across = length(cone.axis - along * axis);
            let child_sin = min(cone.sin, 1.0);
            let child_cos = sqrt(1.0 - child_sin * child_sin);
            cos = min(cos, min(along, along * child_cos - across * child_sin));
            sin = max(sin, across * child_cos + along * child_sin);
        }
    }
    return bounded_cone(center, radius, axis, select(0.0, cos, is_bounded), sin);
}
