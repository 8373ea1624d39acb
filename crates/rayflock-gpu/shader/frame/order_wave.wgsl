// Makes the rays that the wave before left a wave, in the order of their keys: slots behind them
// hold rays that are not traced, and nothing is hit yet.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> paths: array<Path>;
@group(0) @binding(2) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(3) var<storage, read> wave_counts: array<u32, 4>;
@group(0) @binding(4) var<storage, read> places: array<vec2u>;
// Where the rays of each key begin.
@group(0) @binding(5) var<storage, read> firsts: array<u32>;
@group(0) @binding(6) var<uniform> frame: FrameParams;

@compute @workgroup_size(64)
fn order_wave(@builtin(global_invocation_id) id: vec3u) {
    let left = frame.slot_count + id.x;
    let slot = firsts[places[id.x].x] + places[id.x].y;
    var ray = idle_ray(slot);
    if (id.x < wave_counts[FOLLOWED]) {
        ray = rays[left];
        ray.slot = slot;
        paths[slot] = paths[left];
    }
    rays[slot] = ray;
    hits[slot] = Hit(ray.t_max, 0.0, 0.0, NO_RANK);
}
