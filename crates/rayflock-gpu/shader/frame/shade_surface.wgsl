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

// A path whose weight is below this in every colour is not followed.
const MIN_WEIGHT: f32 = 0.00048828125;
// What a turn adds to a seed.
const TURN: u32 = 0x9e3779b9u;

var<workgroup> kept: atomic<u32>;
var<workgroup> mirrored: atomic<u32>;
var<workgroup> first_place: u32;

// A ray of the next bounce; not worth following where its weight says so.
struct Turned {
    origin: vec3f,
    direction: vec3f,
    path: Path,
}

// What is left of a ray: light and points are written by the stage, turns are handed on.
struct Shaded {
    point: LitPoint,
    mirror: Turned,
    refraction: Turned,
}

const NOT_TURNED = Turned(vec3f(0.0), vec3f(0.0), Path(vec3f(0.0), 0u, vec3f(0.0), 0u));

@compute @workgroup_size(64)
fn shade_surface(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.x * 64u + lane;
    let ray = rays[frame.first_slot + slot];
    var shaded = Shaded(nothing_lit(), NOT_TURNED, NOT_TURNED);
    if (is_active(ray)) {
        shaded = shade_ray(ray, paths[frame.first_slot + slot], hits[slot]);
    }
    points[slot] = shaded.point;

    // Mirrored rays of the workgroup first, then refracted ones.
    let goes_on = frame.goes_on != 0u;
    let is_mirrored = goes_on && largest_of(shaded.mirror.path.weight) >= MIN_WEIGHT;
    let is_refracted = goes_on && largest_of(shaded.refraction.path.weight) >= MIN_WEIGHT;
    var mirror_place = 0u;
    if (is_mirrored) {
        mirror_place = atomicAdd(&kept, 1u);
        atomicAdd(&mirrored, 1u);
    }
    workgroupBarrier();
    var refraction_place = 0u;
    if (is_refracted) {
        refraction_place = atomicAdd(&kept, 1u);
    }
    workgroupBarrier();
    if (lane == 0u) {
        atomicAdd(&counts[MIRRORED], atomicLoad(&mirrored));
        first_place = atomicAdd(&counts[FOLLOWED], atomicLoad(&kept));
    }
    let first = workgroupUniformLoad(&first_place);
    if (is_mirrored) {
        follow(shaded.mirror, first + mirror_place);
    }
    if (is_refracted) {
        follow(shaded.refraction, first + refraction_place);
    }
}

fn follow(turned: Turned, place: u32) {
    if (place < frame.slot_count) {
        let slot = frame.next_first_slot + place;
        rays[slot] = traced_ray(turned.origin, turned.direction, 0.0, LARGEST, place);
        paths[slot] = turned.path;
    }
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
        scattered.diffuse *= kept;
        scattered.mirror *= kept;
        scattered.transmission *= kept;
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

fn mirror_ray(point: SurfacePoint, material: Material, scattered: Scatter, path: Path) -> Turned {
    // On the inside of a transmitting solid the path stays in that solid.
    let is_inside = !point.from_outside && any(material.transmission != vec3f(0.0));
    let absorption = select(path.absorption, material.absorption, is_inside);
    let turned = Path(path.weight * scattered.mirror, path.pixel, absorption,
                      hash(path.seed ^ TURN));
    return Turned(point.position + point.slack * point.facet_normal, scattered.mirror_direction,
                  turned);
}

fn refraction_ray(point: SurfacePoint, material: Material, scattered: Scatter,
                  path: Path) -> Turned {
    let absorption = select(vec3f(0.0), material.absorption, point.from_outside);
    let turned = Path(path.weight * scattered.transmission, path.pixel, absorption,
                      hash(path.seed ^ (TURN + 1u)));
    return Turned(point.position - point.slack * point.facet_normal,
                  scattered.refraction_direction, turned);
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

fn material_at(idx: u32) -> Material {
    let a = scene[7u * idx];
    let b = scene[7u * idx + 1u];
    let c = scene[7u * idx + 2u];
    let d = scene[7u * idx + 3u];
    let e = scene[7u * idx + 4u];
    let f = scene[7u * idx + 5u];
    let g = scene[7u * idx + 6u];
    return Material(a.xyz, a.w, b.xyz, b.w, c.xyz, u32(c.w), d.xyz, u32(d.w), e.xyz, 0u, f.xyz, 0u,
                    g.xyz, 0u);
}

// What multiplies the diffuse and ambient share: texture and vertex colour.
fn base_color(material: Material, point: SurfacePoint) -> vec3f {
    if (material.texture == 0u || !point.has_uv) {
        return point.tint;
    }
    return point.tint * bilinear(scene[frame.first_texture + material.texture - 1u], point.uv);
}

// The colour of a texture, of which first texel and size are given, between its four nearest texels,
// repeating in both directions.
fn bilinear(texture: vec4f, uv: vec2f) -> vec3f {
    let first = u32(texture.x);
    let size = vec2u(texture.yz);
    let wrapped = uv - floor(uv);
    let is_number = (wrapped >= vec2f(0.0)) & (wrapped <= vec2f(1.0));
    let place = select(vec2f(0.0), wrapped, is_number) * vec2f(size) - vec2f(0.5);
    let share = place - floor(place);
    let low = select(min(vec2u(max(place, vec2f(0.0))), size - vec2u(1u)), size - vec2u(1u),
                     floor(place) < vec2f(0.0));
    let high = select(low + vec2u(1u), vec2u(0u), low + vec2u(1u) == size);
    let top = mix(texel(first, size, low), texel(first, size, vec2u(high.x, low.y)), share.x);
    let bottom = mix(texel(first, size, vec2u(low.x, high.y)), texel(first, size, high), share.x);
    return mix(top, bottom, share.y);
}

fn texel(first: u32, size: vec2u, place: vec2u) -> vec3f {
    return scene[first + place.y * size.x + place.x].xyz;
}
