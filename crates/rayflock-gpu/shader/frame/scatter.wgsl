// What a surface does with light: how a material's shares depend on the angle.

const FRESNEL_SCHLICK: u32 = 1u;
const FRESNEL_DIELECTRIC: u32 = 2u;

// A texture is named by its place among those of the scene, counted from 1.
struct Material {
    ambient: vec3f,
    shininess: f32,
    diffuse: vec3f,
    ior: f32,
    specular: vec3f,
    fresnel: u32,
    mirror: vec3f,
    texture: u32,
    transmission: vec3f,
    unused_a: u32,
    absorption: vec3f,
    unused_b: u32,
    emission: vec3f,
    unused_c: u32,
}

// What becomes of the light at a point, seen along one ray.
struct Scatter {
    // Multiplies ambient light.
    ambient: vec3f,
    // Multiplies irradiance over pi.
    diffuse: vec3f,
    // Multiply radiance along their directions, of unit length.
    mirror: vec3f,
    mirror_direction: vec3f,
    transmission: vec3f,
    refraction_direction: vec3f,
}

fn scatter(material: Material, point: SurfacePoint, base: vec3f, direction: vec3f) -> Scatter {
    // A smooth normal may point away from the viewer near a silhouette; the facet never does.
    var normal = point.normal;
    var cos = -dot(direction, normal);
    if (cos <= 0.0) {
        normal = point.facet_normal;
        cos = max(0.0, -dot(direction, normal));
    }
    let has_ior = material.ior > 0.0 && material.ior < LARGEST;
    let ior = select(1.0, material.ior, has_ior);
    let eta = select(ior, 1.0 / ior, point.from_outside);
    var mirror = material.mirror;
    var kept = 1.0;
    if (material.fresnel == FRESNEL_SCHLICK) {
        let added = schlick(mirror, cos);
        mirror += (vec3f(1.0) - mirror) * added;
        kept = 1.0 - added;
    } else if (material.fresnel == FRESNEL_DIELECTRIC) {
        let share = dielectric(cos, eta);
        mirror = vec3f(share);
        kept = 1.0 - share;
    }
    var transmission = material.transmission * kept;
    var refraction_direction = direction;
    if (any(transmission != vec3f(0.0))) {
        let cos_t = refracted_cosine(-dot(direction, normal), eta);
        if (cos_t > 0.0) {
            let bent = eta * direction + (eta * -dot(direction, normal) - cos_t) * normal;
            let refracted = normalize_or(bent, direction);
            refraction_direction = turned_below(refracted, point.facet_normal);
        } else {
            mirror += transmission;
            transmission = vec3f(0.0);
        }
    }
    let mirrored = direction - 2.0 * dot(direction, normal) * normal;
    let mirror_direction = -turned_below(-mirrored, point.facet_normal);
    return Scatter(material.ambient * base * kept, material.diffuse * base * kept, mirror,
                   mirror_direction, transmission, refraction_direction);
}

// What is left of all that a surface sends back, its highlight included, where that is scaled down
// to no more than arrives: light that goes on and on then fades.
fn conserved(scattered: Scatter, highlight: vec3f, shininess: f32) -> f32 {
    let sent = scattered.diffuse + scattered.mirror + scattered.transmission;
    let most = largest_of(sent + highlight * highlight_albedo(shininess));
    return select(1.0, 1.0 / most, most > 1.0);
}

// So much of what a surface makes of light, but for ambient light.
fn kept_of(scattered: Scatter, kept: f32) -> Scatter {
    var scaled = scattered;
    scaled.diffuse *= kept;
    scaled.mirror *= kept;
    scaled.transmission *= kept;
    return scaled;
}

// At most this times its strength a highlight sends back: the integral of the power of the halfway
// cosine, and a whole hemisphere.
fn highlight_albedo(shininess: f32) -> f32 {
    return min(8.0 / (max(shininess, 0.0) + 1.0), 2.0);
}

// What Schlick's approximation adds to a mirrored share at an angle, relative to what it leaves.
fn schlick(mirror: vec3f, cos: f32) -> f32 {
    let sideways = clamp(1.0 - cos, 0.0, 1.0);
    let squared = sideways * sideways;
    return squared * squared * sideways * clamp(largest_of(mirror) / 0.04, 0.0, 1.0);
}

// The mirrored share of light at an interface between dielectrics.
fn dielectric(cos: f32, eta: f32) -> f32 {
    let cos_t = refracted_cosine(cos, eta);
    if (cos_t <= 0.0) {
        return 1.0;
    }
    let parallel = (cos - eta * cos_t) / (cos + eta * cos_t);
    let perpendicular = (eta * cos - cos_t) / (eta * cos + cos_t);
    return min(0.5 * (parallel * parallel + perpendicular * perpendicular), 1.0);
}

// 0 where the interface mirrors totally.
fn refracted_cosine(cos: f32, eta: f32) -> f32 {
    return sqrt(max(1.0 - eta * eta * (1.0 - cos * cos), 0.0));
}

// A direction, bent just below the plane where a smooth normal sent it above.
fn turned_below(direction: vec3f, normal: vec3f) -> vec3f {
    const GRAZING: f32 = 1e-3;
    let height = dot(direction, normal);
    let bent = normalize_or(direction - (height + GRAZING) * normal, -normal);
    return select(bent, direction, height < -GRAZING);
}
