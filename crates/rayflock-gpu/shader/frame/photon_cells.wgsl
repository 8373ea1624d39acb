// Cells of space that photons are sorted into: twice as wide as the radius, so that those around a
// point are eight at most. Cells share buckets, by the hash of M. Teschner et al., VMV 2003.

struct PhotonParams {
    // Where cells are counted from.
    low: vec3f,
    radius: f32,
    photon_count: u32,
    // A power of two.
    bucket_count: u32,
    unused: vec2u,
}

// Where the photons of some cells lie among those that are sorted.
struct Bucket {
    first: u32,
    count: atomic<u32>,
    // How many have been brought there.
    filled: atomic<u32>,
}

fn cell_of(position: vec3f) -> vec3i {
    return vec3i(floor((position - params.low) / (2.0 * params.radius)));
}

fn bucket_of(cell: vec3i) -> u32 {
    let scattered = vec3u(cell) * vec3u(73856093u, 19349663u, 83492791u);
    return (scattered.x ^ scattered.y ^ scattered.z) & (params.bucket_count - 1u);
}
