// Sorts photons into buckets by counting, one invocation a photon: counts them, or brings them to
// where `place_photons` has made room.

@group(0) @binding(0) var<storage, read_write> store: PhotonStore;
@group(0) @binding(1) var<storage, read_write> buckets: array<Bucket>;
@group(0) @binding(2) var<storage, read_write> sorted: array<Photon>;
@group(0) @binding(3) var<uniform> params: PhotonParams;

override FILL: bool;

@compute @workgroup_size(64)
fn sort_photons(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= params.photon_count) {
        return;
    }
    let photon = store.photons[id.x];
    let bucket_idx = bucket_of(cell_of(photon.position));
    if (FILL) {
        let place = atomicAdd(&buckets[bucket_idx].filled, 1u);
        sorted[buckets[bucket_idx].first + place] = photon;
    } else {
        atomicAdd(&buckets[bucket_idx].count, 1u);
    }
}
