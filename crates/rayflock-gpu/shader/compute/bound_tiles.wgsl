// Computes the cone around the rays of each tile, one workgroup a tile and one invocation a ray.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> cones: array<Cone>;

var<workgroup> lows: array<vec3f, TILE_RAYS>;
var<workgroup> highs: array<vec3f, TILE_RAYS>;
var<workgroup> sums: array<vec3f, TILE_RAYS>;
// Farthest origin, least cosine and largest sine; and whether a ray reaches behind its origin.
var<workgroup> extremes: array<vec4f, TILE_RAYS>;

@compute @workgroup_size(TILE_RAYS)
fn bound_tiles(@builtin(workgroup_id) group: vec3u,
               @builtin(local_invocation_index) lane: u32) {
    let tile_idx = group.x;
    let ray = rays[tile_idx * TILE_RAYS + lane];
    let counts = is_active(ray);
    let unit = select(vec3f(0.0), unit_direction(ray.direction), counts);
    lows[lane] = select(vec3f(LARGEST), ray.origin, counts);
    highs[lane] = select(vec3f(-LARGEST), ray.origin, counts);
    sums[lane] = unit;
    for (var step = TILE_RAYS / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if (lane < step) {
            lows[lane] = min(lows[lane], lows[lane + step]);
            highs[lane] = max(highs[lane], highs[lane + step]);
            sums[lane] += sums[lane + step];
        }
    }
    workgroupBarrier();
    let low = lows[0];
    let high = highs[0];
    let center = 0.5 * low + 0.5 * high;
    let axis = unit_or_z(sums[0]);

    let along = dot(unit, axis);
    let own = vec4f(distance(ray.origin, center), along, length(unit - along * axis),
                    select(0.0, 1.0, ray.t_min < 0.0));
    extremes[lane] = select(vec4f(0.0, 1.0, 0.0, 0.0), own, counts);
    for (var step = TILE_RAYS / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if (lane < step) {
            let other = extremes[lane + step];
            let most = max(extremes[lane], other);
            extremes[lane] = vec4f(most.x, min(extremes[lane].y, other.y), most.zw);
        }
    }
    workgroupBarrier();
    if (lane == 0u) {
        let found = extremes[0];
        var cone = bounded_cone(center, found.x, axis, found.y, found.z);
        if (found.w > 0.0) {
            cone = Cone(center, UNBOUNDED, axis, EVERYWHERE);
        }
        if (low.x > high.x) {
            cone = EMPTY_CONE;
        }
        cones[tile_idx] = cone;
    }
}
