// First stage: one ray through each pixel of a band of rows, in tiles of 8 x 8 pixels.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> paths: array<Path>;
@group(0) @binding(2) var<storage, read_write> hits: array<Hit>;
@group(0) @binding(3) var<uniform> frame: FrameParams;

@compute @workgroup_size(64)
fn camera_rays(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.x * 64u + lane;
    let columns = (frame.width + 7u) / 8u;
    let pixel = 8u * vec2u(group.x % columns, group.x / columns) + vec2u(lane % 8u, lane / 8u);
    if (slot >= frame.slot_count) {
        return;
    }
    var ray = idle_ray(slot);
    if (pixel.x < frame.width && pixel.y < frame.row_count) {
        let row = frame.first_row + pixel.y;
        let place = vec2f(f32(pixel.x), f32(row)) + frame.subpixel;
        let point = frame.top_left + frame.right * place.x + frame.down * place.y;
        ray = traced_ray(frame.eye, normalize_or(point, vec3f(0.0, 0.0, -1.0)), 0.0, LARGEST, slot);
        if (frame.is_parallel != 0u) {
            ray = traced_ray(point, frame.eye, 0.0, LARGEST, slot);
        }
        paths[slot] = Path(vec3f(1.0), pixel.y * frame.width + pixel.x, vec3f(0.0),
                           hash(pixel.x ^ hash(row)));
    }
    rays[slot] = ray;
    hits[slot] = Hit(ray.t_max, 0.0, 0.0, NO_RANK);
}
