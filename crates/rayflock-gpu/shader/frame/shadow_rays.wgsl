// Rays between a light and the points that it may light: from a lamp, so that they share their
// origin; along a directional light; or from the point to one on an emitter. Points that the light
// adds nothing to get no ray.

@group(0) @binding(0) var<storage, read> points: array<LitPoint>;
@group(0) @binding(1) var<storage, read> emitters: array<Emitter>;
@group(0) @binding(2) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(3) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(4) var<storage, read_write> counts: array<atomic<u32>, 4>;
@group(0) @binding(5) var<uniform> light: Light;

var<workgroup> kept: atomic<u32>;

@compute @workgroup_size(64)
fn shadow_rays(@builtin(global_invocation_id) id: vec3u,
               @builtin(local_invocation_index) lane: u32) {
    let slot = id.x;
    let point = points[slot];
    let lit = lit_by(light, point);
    var ray = idle_ray(slot);
    if (any(lit.radiance != vec3f(0.0))) {
        ray = ray_between(point, lit, slot);
        atomicAdd(&kept, 1u);
    }
    rays[slot] = ray;
    hits[slot] = Hit(ray.t_max, 0.0, 0.0, NO_RANK);
    workgroupBarrier();
    if (lane == 0u) {
        atomicAdd(&counts[SHADOW], atomicLoad(&kept));
    }
}

fn ray_between(point: LitPoint, lit: Lit, slot: u32) -> Ray {
    let position = point.shadow_position;
    if (light.kind == DIRECTIONAL) {
        return traced_ray(position, -light.direction, 0.0, LARGEST, slot);
    }
    if (light.kind == EMITTERS) {
        return traced_ray(position, lit.source - position, 0.0, TO_EMITTER, slot);
    }
    return traced_ray(light.position, position - light.position, FROM_LIGHT.x, FROM_LIGHT.y, slot);
}
