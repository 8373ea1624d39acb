// Adds what needs no shadow ray to the film.

@group(0) @binding(0) var<storage, read> points: array<LitPoint>;
@group(0) @binding(1) var<storage, read_write> film: array<atomic<u32>>;

@compute @workgroup_size(64)
fn add_emitted(@builtin(global_invocation_id) id: vec3u) {
    add_to_film(points[id.x].emitted_pixel, points[id.x].emitted);
}
