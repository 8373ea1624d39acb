// Brings rays into the order of their keys; each keeps its slot.

@group(0) @binding(0) var<storage, read> rays: array<Ray>;
@group(0) @binding(1) var<storage, read> places: array<vec2u>;
// Where the rays of each key begin.
@group(0) @binding(2) var<storage, read> firsts: array<u32>;
@group(0) @binding(3) var<storage, read_write> ordered: array<Ray>;

@compute @workgroup_size(64)
fn order_rays(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
              @builtin(local_invocation_index) lane: u32) {
    let ray_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (ray_idx < arrayLength(&rays)) {
        let place = places[ray_idx];
        ordered[firsts[place.x] + place.y] = rays[ray_idx];
    }
}
