// Writes the triangles of deformed objects, and the normals of their corners, from where their
// vertices are.

@group(0) @binding(0) var<storage, read> objects: array<DeformedObject>;
@group(0) @binding(1) var<storage, read> sources: array<u32>;
@group(0) @binding(2) var<storage, read> vertices: array<DeformedVertex>;
@group(0) @binding(3) var<storage, read_write> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read_write> attributes: array<Attributes>;

@compute @workgroup_size(64)
fn write_triangles(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                   @builtin(local_invocation_index) lane: u32) {
    let idx = (group.y * groups.x + group.x) * 64u + lane;
    let object = objects[object_of(idx)];
    let triangle = idx - object.first_triangle;
    if (triangle >= object.triangle_count) {
        return;
    }
    let place = object.corners + 3u * triangle;
    let a = vertices[object.first_vertex + sources[place]];
    let b = vertices[object.first_vertex + sources[place + 1u]];
    let c = vertices[object.first_vertex + sources[place + 2u]];
    let rank = object.first_rank + triangle;
    // One without an area, or not of numbers, is such that no ray sees it.
    let normal = triangle_normal(b.position - a.position, c.position - a.position);
    let is_seen = is_finite(a.position) && is_finite(b.position) && is_finite(c.position)
        && any(normal != vec3f(0.0));
    let zero = vec3f(0.0);
    var prim = Primitive(zero, 0u, zero, TRIANGLE, zero, rank);
    if (is_seen) {
        prim = Primitive(a.position, object.mask, b.position, TRIANGLE, c.position, rank);
    }
    primitives[rank] = prim;
    if (object.normals != NOWHERE) {
        attributes[rank].normal_a = a.normal;
        attributes[rank].normal_b = b.normal;
        attributes[rank].normal_c = c.normal;
    }
}

// The last object whose triangles do not begin behind one.
fn object_of(triangle_idx: u32) -> u32 {
    var low = 0u;
    var high = arrayLength(&objects);
    while (low + 1u < high) {
        let middle = (low + high) / 2u;
        if (objects[middle].first_triangle <= triangle_idx) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}
