// What primitives look like; `layout` mirrors it.

const HAS_NORMALS: u32 = 1u;
const HAS_UVS: u32 = 2u;
// The transform turns the winding of triangles around.
const IS_MIRRORED: u32 = 4u;

// Of a primitive, by rank.
struct Attributes {
    // Of the corners, in world space; of spheres the axes of object space.
    normal_a: vec3f,
    material: u32,
    normal_b: vec3f,
    flags: u32,
    normal_c: vec3f,
    unused_a: u32,
    color_a: vec3f,
    unused_b: u32,
    color_b: vec3f,
    unused_c: u32,
    color_c: vec3f,
    unused_d: u32,
    uv_a: vec2f,
    uv_b: vec2f,
    uv_c: vec2f,
    unused_e: vec2u,
}
