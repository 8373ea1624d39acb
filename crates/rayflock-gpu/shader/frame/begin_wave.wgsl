// Makes the rays that were appended a wave: slots behind them hold rays that are not traced, and
// nothing is hit yet.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(2) var<storage, read> counts: array<u32, 4>;
@group(0) @binding(3) var<uniform> frame: FrameParams;

@compute @workgroup_size(64)
fn begin_wave(@builtin(global_invocation_id) id: vec3u) {
    let slot = id.x;
    if (slot >= counts[FOLLOWED]) {
        rays[frame.first_slot + slot] = idle_ray(slot);
    }
    hits[slot] = Hit(rays[frame.first_slot + slot].t_max, 0.0, 0.0, NO_RANK);
}
