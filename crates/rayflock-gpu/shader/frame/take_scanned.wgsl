// Brings what was drawn to the hits of the rays from the camera, and adds up what it took.

@group(0) @binding(0) var drawn: texture_2d<u32>;
@group(0) @binding(1) var<storage, read> tests: array<u32>;
@group(0) @binding(2) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(3) var<storage, read_write> counters: ScanCounters;
@group(0) @binding(4) var<uniform> scan: ScanParams;

var<workgroup> test_sums: array<atomic<u32>, 2>;

@compute @workgroup_size(64)
fn take_scanned(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let columns = (scan.width + 7u) / 8u;
    let texel = 8u * vec2u(group.x % columns, group.x / columns) + vec2u(lane % 8u, lane / 8u);
    if (texel.x < scan.width && texel.y < scan.row_count) {
        let slot = 64u * group.x + lane;
        let found = textureLoad(drawn, texel, 0);
        if (found.w != NO_RANK) {
            let numbers = bitcast<vec3f>(found.xyz);
            hits[slot] = Hit(numbers.x, numbers.y, numbers.z, found.w);
        }
        atomicAdd(&test_sums[0], tests[2u * slot]);
        atomicAdd(&test_sums[1], tests[2u * slot + 1u]);
    }
    workgroupBarrier();
    if (lane == 0u) {
        atomicAdd(&counters.triangle_tests, atomicLoad(&test_sums[0]));
        atomicAdd(&counters.sphere_tests, atomicLoad(&test_sums[1]));
    }
}
