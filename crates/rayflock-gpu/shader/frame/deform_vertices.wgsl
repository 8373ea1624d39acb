// Brings the vertices of deformed objects to where they are in this frame: between two keys, by
// morph targets, by a skin, and by the place of the object.
//
// What each does is said by `Deformation` of the scene.

@group(0) @binding(0) var<storage, read> objects: array<DeformedObject>;
@group(0) @binding(1) var<storage, read> sources: array<u32>;
@group(0) @binding(2) var<storage, read> pose: array<u32>;
@group(0) @binding(3) var<storage, read_write> vertices: array<DeformedVertex>;

const JOINT_WORDS: u32 = 12u;
const INFLUENCE_WORDS: u32 = 12u;
const TARGET_WORDS: u32 = 3u;

@compute @workgroup_size(64)
fn deform_vertices(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                   @builtin(local_invocation_index) lane: u32) {
    let idx = (group.y * groups.x + group.x) * 64u + lane;
    if (idx >= arrayLength(&vertices)) {
        return;
    }
    let object = objects[object_of(idx)];
    let vertex = idx - object.first_vertex;
    let has_normals = object.normals != NOWHERE;
    let rest = DeformedVertex(source_vector(object.positions, vertex), 0u,
                              source_vector(object.normals, vertex), 0u);
    var deformed = rest;
    approach(&deformed, object, vertex);
    morph(&deformed, object, vertex);
    if (object.influences != NOWHERE) {
        let joint = blended_joint(object, vertex);
        deformed.position = joint * vec4f(deformed.position, 1.0);
        deformed.normal = turned(joint, deformed.normal, true);
    }
    let world = mat4x3f(object.x_axis, object.y_axis, object.z_axis, object.translation);
    vertices[idx].position = world * vec4f(deformed.position, 1.0);
    if (has_normals) {
        let normal = normalize_or(deformed.normal, rest.normal);
        vertices[idx].normal = turned(world, normal, false);
    }
}

// The last object whose vertices do not begin behind one.
fn object_of(vertex_idx: u32) -> u32 {
    var low = 0u;
    var high = arrayLength(&objects);
    while (low + 1u < high) {
        let middle = (low + high) / 2u;
        if (objects[middle].first_vertex <= vertex_idx) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// Goes some of the way to the next key.
fn approach(vertex: ptr<function, DeformedVertex>, object: DeformedObject, idx: u32) {
    if (object.next_positions != NOWHERE) {
        let next = source_vector(object.next_positions, idx);
        (*vertex).position += (next - (*vertex).position) * object.share;
    }
    if (object.next_normals != NOWHERE) {
        let next = source_vector(object.next_normals, idx);
        (*vertex).normal += (next - (*vertex).normal) * object.share;
    }
}

// Adds the offsets of targets.
fn morph(vertex: ptr<function, DeformedVertex>, object: DeformedObject, idx: u32) {
    for (var target_idx = 0u; target_idx < object.target_count; target_idx++) {
        let place = object.targets + target_idx * TARGET_WORDS;
        let weight = bitcast<f32>(pose[place + 2u]);
        (*vertex).position += weight * source_vector(pose[place], idx);
        (*vertex).normal += weight * source_vector(pose[place + 1u], idx);
    }
}

// The sum of the transforms of the joints that a vertex follows.
fn blended_joint(object: DeformedObject, idx: u32) -> mat4x3f {
    let place = object.influences + idx * INFLUENCE_WORDS;
    var sum = mat4x3f();
    for (var slot = 0u; slot < 8u; slot++) {
        let weight = bitcast<f32>(sources[place + 4u + slot]);
        if (weight != 0.0) {
            let joint = (sources[place + slot / 2u] >> (16u * (slot % 2u))) & 0xffffu;
            sum += weight * joint_at(object.joints + joint * JOINT_WORDS);
        }
    }
    return sum;
}

fn joint_at(place: u32) -> mat4x3f {
    return mat4x3f(pose_vector(place), pose_vector(place + 3u), pose_vector(place + 6u),
                   pose_vector(place + 9u));
}

// A normal after a transform, by the cross products of its columns; `is_kept` leaves it on its
// side where the transform mirrors.
fn turned(transform: mat4x3f, normal: vec3f, is_kept: bool) -> vec3f {
    let x = cross(transform[1], transform[2]);
    let sum = x * normal.x + cross(transform[2], transform[0]) * normal.y
        + cross(transform[0], transform[1]) * normal.z;
    return select(sum, -sum, is_kept && dot(transform[0], x) < 0.0);
}

// Zero where there are none.
fn source_vector(first: u32, idx: u32) -> vec3f {
    if (first == NOWHERE) {
        return vec3f(0.0);
    }
    let place = first + 3u * idx;
    return bitcast<vec3f>(vec3u(sources[place], sources[place + 1u], sources[place + 2u]));
}

fn pose_vector(place: u32) -> vec3f {
    return bitcast<vec3f>(vec3u(pose[place], pose[place + 1u], pose[place + 2u]));
}
