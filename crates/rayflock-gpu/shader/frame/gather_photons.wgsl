// Adds what photons bring to the points of a wave, one invocation a point: the diffuse share of the
// irradiance by all within the radius, by Epanechnikov's kernel.

@group(0) @binding(0) var<storage, read> points: array<LitPoint>;
@group(0) @binding(1) var<storage, read_write> buckets: array<Bucket>;
@group(0) @binding(2) var<storage, read> sorted: array<Photon>;
@group(0) @binding(3) var<storage, read_write> film: array<atomic<u32>>;
@group(0) @binding(4) var<uniform> params: PhotonParams;

// Photons on surfaces that are turned by more than this cosine says belong to another one.
const SAME_SURFACE_COS: f32 = 0.7;

@compute @workgroup_size(64)
fn gather_photons(@builtin(global_invocation_id) id: vec3u) {
    let point = points[id.x];
    if (point.pixel == NO_PIXEL || all(point.diffuse == vec3f(0.0))) {
        return;
    }
    let first = cell_of(point.shadow_position - params.radius);
    let last = cell_of(point.shadow_position + params.radius);
    var sum = vec3f(0.0);
    for (var z = first.z; z <= last.z; z++) {
        for (var y = first.y; y <= last.y; y++) {
            for (var x = first.x; x <= last.x; x++) {
                sum += in_cell(vec3i(x, y, z), point);
            }
        }
    }
    // Over pi for what is sent back, and over the volume below the kernel.
    let share = 2.0 * 0.31830987 * 0.31830987 / (params.radius * params.radius);
    add_to_film(point.pixel, point.diffuse * sum * share);
}

// What the photons of one cell bring, each times the height of the kernel.
fn in_cell(cell: vec3i, point: LitPoint) -> vec3f {
    let bucket_idx = bucket_of(cell);
    let first = buckets[bucket_idx].first;
    let end = first + atomicLoad(&buckets[bucket_idx].count);
    var sum = vec3f(0.0);
    for (var idx = first; idx < end; idx++) {
        let photon = sorted[idx];
        let offset = photon.position - point.shadow_position;
        let height = 1.0 - dot(offset, offset) / (params.radius * params.radius);
        let is_same_surface = dot(photon.normal, point.normal) > SAME_SURFACE_COS
            && dot(photon.direction, point.normal) < 0.0;
        // Cells that share a bucket are told apart, so that no photon counts twice.
        if (height > 0.0 && is_same_surface && all(cell_of(photon.position) == cell)) {
            sum += height * photon.flux;
        }
    }
    return sum;
}
