// What the stages of scan conversion share; `layout::ScanParams` and `layout::ScanCounters` mirror
// it.
//
// A texel of the target is a pixel of the band. What lies at `offset` from the origin is seen, by a
// pinhole, at column dot(column, offset) / depth and row dot(row, offset) / depth, where the depth
// is dot(depth, offset); by a parallel lens it is not divided by it.

struct ScanParams {
    column: vec3f,
    width: u32,
    row: vec3f,
    row_count: u32,
    depth: vec3f,
    is_parallel: u32,
    // The pinhole, or the corner of the film.
    origin: vec3f,
    unused: u32,
    // Takes places on the film to texels of the band, so that rays go through their middles.
    shift: vec2f,
    end: vec2u,
}

struct ScanCounters {
    triangle_tests: atomic<u32>,
    sphere_tests: atomic<u32>,
}
