// Takes the mean logarithm of the radii of chunks: one workgroup for all, each for one order.
//
// The logarithm, since rays are where the geometry is: small chunks lie close together, and a ray
// among them meets as many as a ray meets of large ones.

@group(0) @binding(0) var<storage, read> chunks: array<vec4f>;
@group(0) @binding(1) var<storage, read> ordered_chunks: array<vec4f>;
@group(0) @binding(2) var<storage, read_write> sizes: array<f32, 2>;

const SIZERS: u32 = 256u;

// Of logarithms, and of chunks.
var<workgroup> sums: array<vec2f, SIZERS>;

@compute @workgroup_size(SIZERS)
fn size_chunks(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    var own = vec2f(0.0);
    for (var idx = lane; idx < arrayLength(&chunks); idx += SIZERS) {
        var radius = chunks[idx].w;
        if (group.x == 1u) {
            radius = ordered_chunks[idx].w;
        }
        // Chunks of nothing have a negative one.
        if (radius > 0.0) {
            own += vec2f(log(radius), 1.0);
        }
    }
    sums[lane] = own;
    for (var step = SIZERS / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if (lane < step) {
            sums[lane] += sums[lane + step];
        }
    }
    if (lane == 0u) {
        sizes[group.x] = sums[0].x / max(sums[0].y, 1.0);
    }
}
