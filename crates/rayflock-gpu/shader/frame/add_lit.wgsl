// Adds the light of those points to the film whose shadow ray found nothing in its way.

@group(0) @binding(0) var<storage, read> points: array<LitPoint>;
@group(0) @binding(1) var<storage, read> emitters: array<Emitter>;
@group(0) @binding(2) var<storage, read> hits: array<Hit>;
@group(0) @binding(3) var<storage, read_write> film: array<atomic<u32>>;
@group(0) @binding(4) var<uniform> light: Light;

@compute @workgroup_size(64)
fn add_lit(@builtin(global_invocation_id) id: vec3u) {
    let point = points[id.x];
    if (hits[id.x].rank == NO_RANK) {
        add_to_film(point.pixel, lit_by(light, point).radiance);
    }
}
