// How rays go on from a surface: mirrored and refracted ones are appended to the next wave, those
// of a workgroup together.

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

const NOT_TURNED = Turned(vec3f(0.0), vec3f(0.0), Path(vec3f(0.0), 0u, vec3f(0.0), 0u));

// Appends what is worth following; `carried` goes along with both.
fn follow_turns(mirror: Turned, refraction: Turned, carried: u32, lane: u32) {
    // Mirrored rays of the workgroup first, then refracted ones.
    let goes_on = frame.goes_on != 0u;
    let is_mirrored = goes_on && largest_of(mirror.path.weight) >= MIN_WEIGHT;
    let is_refracted = goes_on && largest_of(refraction.path.weight) >= MIN_WEIGHT;
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
        follow(mirror, first + mirror_place, carried);
    }
    if (is_refracted) {
        follow(refraction, first + refraction_place, carried);
    }
}

fn follow(turned: Turned, place: u32, carried: u32) {
    if (place < frame.slot_count) {
        let slot = frame.slot_count + place;
        rays[slot] = traced_ray(turned.origin, turned.direction, 0.0, LARGEST, place);
        rays[slot].carried = carried;
        paths[slot] = turned.path;
    }
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
