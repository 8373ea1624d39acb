// Gives buckets their places among the sorted photons: sums within a workgroup, and one atomic
// operation for it. Buckets may lie in any order.

@group(0) @binding(0) var<storage, read_write> store: PhotonStore;
@group(0) @binding(1) var<storage, read_write> buckets: array<Bucket>;
@group(0) @binding(2) var<uniform> params: PhotonParams;

var<workgroup> sums: array<u32, 64>;
var<workgroup> first_place: u32;

@compute @workgroup_size(64)
fn place_photons(@builtin(global_invocation_id) id: vec3u,
                 @builtin(local_invocation_index) lane: u32) {
    var count = 0u;
    if (id.x < params.bucket_count) {
        count = atomicLoad(&buckets[id.x].count);
    }
    sums[lane] = count;
    for (var step = 1u; step < 64u; step *= 2u) {
        workgroupBarrier();
        let before = select(0u, sums[max(lane, step) - step], lane >= step);
        workgroupBarrier();
        sums[lane] += before;
    }
    workgroupBarrier();
    if (lane == 0u) {
        first_place = atomicAdd(&store.placed, sums[63]);
    }
    let first = workgroupUniformLoad(&first_place);
    if (id.x < params.bucket_count) {
        buckets[id.x].first = first + sums[lane] - count;
    }
}
