// Cones that start from a sphere, around the rays of a tile or around cones.

// More than all rounding on both sides, relative to the distances at work.
const CONE_SLACK: f32 = 3e-5;
// Directions that deviate by more than this cosine says are not bounded at all.
const SMALLEST_COS: f32 = 0.05;
// More than the rounding of a sine between unit vectors.
const ANGLE_ROUNDING: f32 = 2e-6;
// Sines that stand for cones around all directions and around no ray.
const EVERYWHERE: f32 = 2.0;
const NOWHERE: f32 = -1.0;
// The radius around rays that reach behind their origins.
const UNBOUNDED: f32 = 1e30;

struct Cone {
    // Of a sphere that holds all origins.
    center: vec3f,
    radius: f32,
    // The middle direction, of unit length.
    axis: vec3f,
    // Sine of the half angle, EVERYWHERE or NOWHERE.
    sin: f32,
}

const EMPTY_CONE = Cone(vec3f(0.0), 0.0, vec3f(0.0, 0.0, 1.0), NOWHERE);

// Whether the cone bounds nothing.
fn is_everywhere(cone: Cone) -> bool {
    return cone.sin > 1.0;
}

// Whether a ray of the cone may meet the sphere; never false when one does.
fn cone_touches(cone: Cone, sphere: vec4f) -> bool {
    if (cone.sin < 0.0 || sphere.w < 0.0) {
        return false;
    }
    if (is_everywhere(cone)) {
        return true;
    }
    let v = sphere.xyz - cone.center;
    let along = dot(v, cone.axis);
    let across = length(v - along * cone.axis);
    let radii = cone.radius + sphere.w;
    let reach = radii + CONE_SLACK * (abs(v.x) + abs(v.y) + abs(v.z) + radii);
    let cos = sqrt(1.0 - cone.sin * cone.sin);
    return across * cos - along * cone.sin <= reach && along >= -reach;
}

// A lower bound of the distance from any origin of the cone to the sphere.
fn near_distance(cone: Cone, sphere: vec4f) -> f32 {
    let apart = distance(sphere.xyz, cone.center);
    let radii = cone.radius + sphere.w;
    return max(0.0, apart - radii - CONE_SLACK * (apart + radii));
}

// A cone with these extremes, enlarged for rounding.
fn bounded_cone(center: vec3f, radius: f32, axis: vec3f, cos: f32, sin: f32) -> Cone {
    let enlarged = sin + ANGLE_ROUNDING;
    let largest = sqrt(1.0 - SMALLEST_COS * SMALLEST_COS);
    let is_bounded = cos >= SMALLEST_COS && enlarged < largest;
    let grown = radius * (1.0 + 1e-5);
    return Cone(center, grown, axis, select(EVERYWHERE, enlarged, is_bounded));
}

fn unit_or_z(v: vec3f) -> vec3f {
    let size = length(v);
    return select(vec3f(0.0, 0.0, 1.0), v / size, size > 0.0);
}

// A direction of any length that is not zero, as a unit vector.
fn unit_direction(direction: vec3f) -> vec3f {
    let size = abs(direction);
    let scaled = direction / max(max(size.x, size.y), size.z);
    return scaled / length(scaled);
}
