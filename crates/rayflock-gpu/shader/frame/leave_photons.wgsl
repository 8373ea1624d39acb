// Turns hits of rays from a light into photons and the rays of the next bounce: a ray that has
// turned leaves a photon where it arrives at a rough surface.
//
// The light's view is the picture of a camera, whose pixels are its texels. A ray carries along how
// far it was to its first hit, which also tells that it has turned.

@group(0) @binding(0) var<storage, read_write> rays: array<Ray>;
@group(0) @binding(1) var<storage, read_write> paths: array<Path>;
@group(0) @binding(2) var<storage, read> hits: array<Hit>;
@group(0) @binding(3) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(4) var<storage, read> attributes: array<Attributes>;
@group(0) @binding(5) var<storage, read> scene: array<vec4f>;
@group(0) @binding(6) var<storage, read_write> store: PhotonStore;
@group(0) @binding(7) var<storage, read_write> counts: array<atomic<u32>, 4>;
@group(0) @binding(8) var<uniform> frame: FrameParams;
@group(0) @binding(9) var<uniform> light: Light;

var<workgroup> left: atomic<u32>;
var<workgroup> first_photon: u32;

// What becomes of a ray.
struct Arrived {
    // Without flux where none is left.
    photon: Photon,
    mirror: Turned,
    refraction: Turned,
    // The distance to the first hit, in bits.
    first_distance: u32,
}

@compute @workgroup_size(64)
fn leave_photons(@builtin(workgroup_id) group: vec3u, @builtin(local_invocation_index) lane: u32) {
    let slot = group.x * 64u + lane;
    let ray = rays[slot];
    var arrived = Arrived(no_photon(), NOT_TURNED, NOT_TURNED, 0u);
    if (is_active(ray) && hits[slot].rank != NO_RANK) {
        arrived = arrive(ray, paths[slot], hits[slot]);
    }
    let leaves = any(arrived.photon.flux != vec3f(0.0));
    var place = 0u;
    if (leaves) {
        place = atomicAdd(&left, 1u);
    }
    workgroupBarrier();
    if (lane == 0u) {
        first_photon = atomicAdd(&store.count, atomicLoad(&left));
    }
    place += workgroupUniformLoad(&first_photon);
    if (leaves && place < arrayLength(&store.photons)) {
        store.photons[place] = arrived.photon;
    }
    follow_turns(arrived.mirror, arrived.refraction, arrived.first_distance, lane);
}

fn no_photon() -> Photon {
    let zero = vec3f(0.0);
    return Photon(zero, 0u, zero, 0u, zero, 0u, zero, 0u);
}

fn arrive(ray: Ray, arriving: Path, hit: Hit) -> Arrived {
    let has_turned = ray.carried != 0u;
    let first_distance = select(max(bitcast<u32>(hit.t), 1u), ray.carried, has_turned);
    let flux = flux_through(arriving.pixel, bitcast<f32>(first_distance));
    if (all(flux == vec3f(0.0)) || !is_finite(flux)) {
        return Arrived(no_photon(), NOT_TURNED, NOT_TURNED, 0u);
    }
    var path = arriving;
    let point = surface_point(primitives[hit.rank], attributes[hit.rank], ray, hit);
    path.weight *= exp(-path.absorption * hit.t);
    let material = material_at(point.material);
    var scattered = scatter(material, point, base_color(material, point), ray.direction);
    if (frame.conserves != 0u) {
        scattered = kept_of(scattered, conserved(scattered, material.specular, material.shininess));
    }
    var photon = no_photon();
    if (has_turned && any(scattered.diffuse != vec3f(0.0))) {
        photon = Photon(point.shadow_position, 0u, path.weight * flux, 0u, point.normal, 0u,
                        ray.direction, 0u);
    }
    return Arrived(photon, mirror_ray(point, material, scattered, path),
                   refraction_ray(point, material, scattered, path), first_distance);
}

// The flux of the light through a texel; where the light does not fall with the distance, it grows
// up to the first hit.
fn flux_through(pixel: u32, first_distance: f32) -> vec3f {
    let at = vec2f(f32(pixel % frame.width), f32(frame.first_row + pixel / frame.width))
        + frame.subpixel;
    let point = frame.top_left + frame.right * at.x + frame.down * at.y;
    let texel = cross(frame.right, frame.down);
    if (frame.is_parallel != 0u) {
        return light.intensity * abs(dot(texel, frame.eye));
    }
    let distance = length(point);
    var flux = light.intensity * abs(dot(texel, point)) / (distance * distance * distance);
    if (light.kind == SPOT) {
        flux *= cone_share(light, dot(point, light.direction) / distance);
    }
    return select(flux, flux * first_distance * first_distance, light.is_constant != 0u);
}
