// Turns hits into light, lit points and the rays of the next bounce.
//
// What needs no shadow ray is ready here: emission, ambient light, and the background where a ray
// hit nothing. Mirrored and refracted rays are appended to the next wave, those of a workgroup
// together.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> paths: array<Path>;
@group(0) @binding(2) var<storage, read> hits: array<Hit>;
@group(0) @binding(3) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read> attributes: array<Attributes>;
// Materials, seven entries each; then two entries a texture, then texels.
@group(0) @binding(5) var<storage, read> scene: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> points: array<LitPoint>;
@group(0) @binding(7) var<storage, read_write> counts: array<atomic<u32>, 4>;
@group(0) @binding(8) var<uniform> frame: FrameParams;

// What is left of a ray: light and points are written by the stage, turns are handed on.
struct Shaded {
    point: LitPoint,
    mirror: Turned,
    refraction: Turned,
}

@compute @workgroup_size(64)
fn shade_surface(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.x * 64u + lane;
    let ray = rays[slot];
    var shaded = Shaded(nothing_lit(), NOT_TURNED, NOT_TURNED);
    if (is_active(ray)) {
        shaded = shade_ray(ray, paths[slot], hits[slot]);
    }
    points[slot] = shaded.point;
    follow_turns(shaded.mirror, shaded.refraction, 0u, lane);
}

fn nothing_lit() -> LitPoint {
    let zero = vec3f(0.0);
    return LitPoint(zero, NO_PIXEL, zero, 0.0, zero, 0u, zero, 0u, zero, 0u, zero, NO_PIXEL);
}

fn shade_ray(ray: Ray, arriving: Path, hit: Hit) -> Shaded {
    var path = arriving;
    var lit = nothing_lit();
    lit.emitted_pixel = path.pixel;
    if (hit.rank == NO_RANK) {
        lit.emitted = path.weight * background(ray.direction);
        return Shaded(lit, NOT_TURNED, NOT_TURNED);
    }
    let point = surface_point(primitives[hit.rank], attributes[hit.rank], ray, hit);
    path.weight *= exp(-path.absorption * hit.t);
    let material = material_at(point.material);
    var scattered = scatter(material, point, base_color(material, point), ray.direction);
    var highlight = material.specular;
    if (frame.conserves != 0u) {
        let kept = conserved(scattered, highlight, material.shininess);
        scattered = kept_of(scattered, kept);
        highlight *= kept;
    }
    let ambient = frame.ambient + frame.sky_share * sky_over_pi(point.normal);
    lit.emitted = path.weight * (material.emission + scattered.ambient * ambient);
    lit.diffuse = path.weight * scattered.diffuse;
    lit.specular = path.weight * highlight;
    if (any(lit.diffuse != vec3f(0.0)) || any(lit.specular != vec3f(0.0))) {
        lit.pixel = path.pixel;
    }
    lit.shadow_position = point.shadow_position;
    lit.normal = point.normal;
    lit.shininess = material.shininess;
    lit.to_viewer = -ray.direction;
    lit.seed = path.seed;
    return Shaded(lit, mirror_ray(point, material, scattered, path),
                  refraction_ray(point, material, scattered, path));
}

// The radiance from along a direction of unit length.
fn background(direction: vec3f) -> vec3f {
    let vertical = select(frame.ground, frame.zenith, direction.y > 0.0);
    return mix(frame.horizon, vertical, abs(direction.y));
}

// The irradiance, divided by pi, of a surface under the whole background.
fn sky_over_pi(normal: vec3f) -> vec3f {
    let up = mix(frame.horizon, frame.zenith, 2.0 / 3.0);
    let down = mix(frame.horizon, frame.ground, 2.0 / 3.0);
    return mix(down, up, 0.5 + 0.5 * normal.y);
}
