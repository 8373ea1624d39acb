// Objects whose primitives the device makes from what it holds; `layout` mirrors it.
//
// Numbers of the sources and the pose are words: vectors take three, whole numbers and bits of
// floats one.

// Stands for what an object does not have.
const NOWHERE: u32 = 0xffffffffu;

struct DeformedObject {
    // From the space of the object to the world.
    x_axis: vec3f,
    // Of all vertices that are deformed in this frame.
    first_vertex: u32,
    y_axis: vec3f,
    vertex_count: u32,
    z_axis: vec3f,
    // Of all triangles that are written in this frame.
    first_triangle: u32,
    translation: vec3f,
    triangle_count: u32,
    first_rank: u32,
    mask: u32,
    // Where things begin among the sources: three corners a triangle, a vector a vertex.
    corners: u32,
    positions: u32,
    normals: u32,
    // The same at the next key.
    next_positions: u32,
    next_normals: u32,
    // How much of the way to it is done.
    share: f32,
    // Eight joints, two a word, and eight weights a vertex.
    influences: u32,
    // In the pose: twelve numbers a joint.
    joints: u32,
    // In the pose, for each morph target that counts: where its positions and its normals begin
    // among the sources, and its weight.
    targets: u32,
    target_count: u32,
}

// A vertex in world space; its normal has no particular length.
struct DeformedVertex {
    position: vec3f,
    unused_a: u32,
    normal: vec3f,
    unused_b: u32,
}
