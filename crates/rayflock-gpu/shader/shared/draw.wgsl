// What the vertex stage hands to the fragment stage: the primitive, the same for all fragments.

struct DrawnPrimitive {
    @location(0) a: vec3f,
    @location(1) mask: u32,
    @location(2) b: vec3f,
    @location(3) kind: u32,
    @location(4) c: vec3f,
    @location(5) rank: u32,
}

struct Drawn {
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) a: vec3f,
    @location(1) @interpolate(flat) mask: u32,
    @location(2) @interpolate(flat) b: vec3f,
    @location(3) @interpolate(flat) kind: u32,
    @location(4) @interpolate(flat) c: vec3f,
    @location(5) @interpolate(flat) rank: u32,
}

fn drawn_at(position: vec2f, prim: DrawnPrimitive) -> Drawn {
    return Drawn(vec4f(position, 0.0, 1.0), prim.a, prim.mask, prim.b, prim.kind, prim.c,
                 prim.rank);
}

// The primitive that was handed on.
fn primitive_of(drawn: Drawn) -> Primitive {
    return Primitive(drawn.a, drawn.mask, drawn.b, drawn.kind, drawn.c, drawn.rank);
}
