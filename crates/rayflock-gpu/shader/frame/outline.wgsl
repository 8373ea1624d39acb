// Where in the picture a primitive may be hit: four corners in texels, around every texel whose ray
// hits it. It may be too large, never too small, since the exact test decides.
//
// Source: J. Hasselgren, T. Akenine-Moeller, L. Ohlsson, "Conservative Rasterization", GPU Gems 2,
// 2005, chapter 42.
// Departures: edges move out by what rounding may have moved them, not by half a texel, since rays
// go through the middles of texels; what has corners at or behind the pinhole is drawn over the
// whole picture, unless it lies beside.

// What a coordinate may be off by, relative to the terms that it is a sum of.
const PLACE_ROUNDING: f32 = 1e-6;
// Texels by which hardware may move a corner, which has at least four bits below them, and more.
const SNAPPING: f32 = 0.125;
// Texels around the picture that count as seen.
const MARGIN: f32 = 1.0;
// Corners that lie farther out, in pictures, are not drawn to: hardware has few bits for them.
const FAR_OUT: f32 = 4.0;

// A point as the camera sees it.
struct Seen {
    // Column and row, times the weight.
    place: vec2f,
    // The depth before a pinhole, else 1.
    weight: f32,
    depth: f32,
    // What places and depth may be off by.
    place_rounding: f32,
    depth_rounding: f32,
}

alias Outline = array<vec2f, 4>;

fn outline_of(prim: Primitive) -> Outline {
    if (prim.mask == 0u) {
        return nowhere();
    }
    if (prim.kind == SPHERE) {
        return outline_of_sphere(see(prim.a), prim.b.x);
    }
    return outline_of_triangle(see(prim.a), see(prim.b), see(prim.c));
}

fn see(point: vec3f) -> Seen {
    let offset = point - scan.origin;
    let depth = dot(scan.depth, offset);
    let is_parallel = scan.is_parallel != 0u;
    let weight = select(depth, 1.0, is_parallel);
    let place = vec2f(dot(scan.column, offset), dot(scan.row, offset)) + scan.shift * weight;
    // Rays of a pinhole start at the origin, those of a parallel lens elsewhere.
    let reach = select(abs(offset), abs(point) + abs(scan.origin), is_parallel);
    let terms = max(dot(abs(scan.column), reach), dot(abs(scan.row), reach));
    let moved = max(abs(scan.shift.x), abs(scan.shift.y)) * abs(weight);
    return Seen(place, weight, depth, PLACE_ROUNDING * (terms + moved),
                PLACE_ROUNDING * dot(abs(scan.depth), reach));
}

fn outline_of_triangle(a: Seen, b: Seen, c: Seen) -> Outline {
    let rounding = max(max(a.place_rounding, b.place_rounding), c.place_rounding);
    let depth_rounding = max(max(a.depth_rounding, b.depth_rounding), c.depth_rounding);
    let farthest = max(max(a.depth, b.depth), c.depth);
    // No ray goes beyond the sides of the picture; neither does the triangle between its corners.
    let inside = max(max(inside_of(a), inside_of(b)), inside_of(c));
    if (farthest < -depth_rounding || any(inside < vec4f(-rounding))) {
        return nowhere();
    }
    if (min(min(a.weight, b.weight), c.weight) <= 4.0 * depth_rounding) {
        return everywhere();
    }
    let places = array<vec2f, 3>(a.place / a.weight, b.place / b.weight, c.place / c.weight);
    let slack = SNAPPING + max(max(slack_of(a), slack_of(b)), slack_of(c));
    return around_triangle(places, slack);
}

// How far within the left, upper, right and lower side of the picture, times the weight.
fn inside_of(seen: Seen) -> vec4f {
    let margin = MARGIN * seen.weight;
    return vec4f(seen.place + margin, picture_size() * seen.weight + margin - seen.place);
}

// Texels by which rounding may have moved a place.
fn slack_of(seen: Seen) -> f32 {
    let place = abs(seen.place / seen.weight);
    let by_weight = select(max(place.x, place.y) * seen.depth_rounding, 0.0,
                           scan.is_parallel != 0u);
    return (seen.place_rounding + by_weight) / seen.weight;
}

// The triangle with its edges moved out, or the rectangle around it where that is smaller.
fn around_triangle(places: array<vec2f, 3>, slack: f32) -> Outline {
    let a = places[0];
    let b = places[1];
    let c = places[2];
    let low = min(min(a, b), c) - slack;
    let high = max(max(a, b), c) + slack;
    let ab = b - a;
    let bc = c - b;
    let ca = a - c;
    let doubled = ab.x * bc.y - ab.y * bc.x;
    let beyond = max(-low, high - picture_size());
    if (abs(doubled) < 0.5 || any(beyond > FAR_OUT * picture_size())) {
        return rectangle(low, high);
    }
    let side = slack * sign(doubled);
    let from_ab = side * vec2f(ab.y, -ab.x) / length(ab);
    let from_bc = side * vec2f(bc.y, -bc.x) / length(bc);
    let from_ca = side * vec2f(ca.y, -ca.x) / length(ca);
    let opening = vec3f(dot(from_ca, from_ab), dot(from_ab, from_bc), dot(from_bc, from_ca))
        / (slack * slack) + vec3f(1.0);
    // Where corners are sharp, edges that move out meet far away.
    if (any(opening < vec3f(0.01))) {
        return rectangle(low, high);
    }
    let moved_a = a + (from_ca + from_ab) / opening.x;
    let moved_b = b + (from_ab + from_bc) / opening.y;
    let moved_c = c + (from_bc + from_ca) / opening.z;
    let to_b = moved_b - moved_a;
    let to_c = moved_c - moved_a;
    let area = 0.5 * abs(to_b.x * to_c.y - to_b.y * to_c.x);
    if (area >= (high.x - low.x) * (high.y - low.y)) {
        return rectangle(low, high);
    }
    return Outline(moved_a, moved_b, moved_c, moved_c);
}

// The rectangle around the box that a sphere fills in columns, rows and depths, each times the
// weight.
fn outline_of_sphere(center: Seen, radius: f32) -> Outline {
    let is_parallel = scan.is_parallel != 0u;
    let moved = select(scan.shift, vec2f(0.0), is_parallel);
    let reach = radius * vec2f(length(scan.column + moved.x * scan.depth),
                               length(scan.row + moved.y * scan.depth)) + center.place_rounding;
    let depth_reach = radius * length(scan.depth) + center.depth_rounding;
    let weight_reach = select(depth_reach, 0.0, is_parallel);
    let inside = inside_of(center)
        + vec4f(reach + MARGIN * weight_reach, reach + (picture_size() + MARGIN) * weight_reach);
    if (center.depth + depth_reach < 0.0 || any(inside < vec4f(0.0))) {
        return nowhere();
    }
    let nearest = center.weight - weight_reach;
    let farthest = center.weight + weight_reach;
    if (nearest < 1e-3 * farthest) {
        return everywhere();
    }
    let low = center.place - reach;
    let high = center.place + reach;
    return rectangle(min(low / nearest, low / farthest) - SNAPPING,
                     max(high / nearest, high / farthest) + SNAPPING);
}

fn picture_size() -> vec2f {
    return vec2f(f32(scan.width), f32(scan.row_count));
}

fn nowhere() -> Outline {
    let place = vec2f(-MARGIN);
    return Outline(place, place, place, place);
}

fn everywhere() -> Outline {
    return rectangle(vec2f(0.0), picture_size());
}

fn rectangle(low: vec2f, high: vec2f) -> Outline {
    let first = max(low, vec2f(-MARGIN));
    let last = min(high, picture_size() + MARGIN);
    return Outline(first, vec2f(last.x, first.y), last, vec2f(first.x, last.y));
}
