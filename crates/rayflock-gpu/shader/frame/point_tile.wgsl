// What bounds the points of a workgroup, one an invocation.

const TILE_POINTS: u32 = 64u;

struct PointTile {
    // A ball around the points; its radius is below 0 where there are none.
    ball: vec4f,
    // The mean normal.
    axis: vec3f,
    // How far normals deviate from it.
    spread: f32,
    // How far points lie from the plane across it.
    thickness: f32,
}

var<workgroup> lows: array<vec3f, TILE_POINTS>;
var<workgroup> highs: array<vec3f, TILE_POINTS>;
var<workgroup> normals: array<vec3f, TILE_POINTS>;
// Radius, spread and thickness, as bits: floats from 0 on have the order of theirs.
var<workgroup> reaches: array<atomic<u32>, 3>;
var<workgroup> tile: PointTile;

// The tile; a point counts where it is lit.
fn point_tile(lane: u32, position: vec3f, normal: vec3f, is_lit: bool) -> PointTile {
    lows[lane] = select(vec3f(LARGEST), position, is_lit);
    highs[lane] = select(vec3f(-LARGEST), position, is_lit);
    normals[lane] = select(vec3f(0.0), normal, is_lit);
    for (var step = TILE_POINTS / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if (lane < step) {
            lows[lane] = min(lows[lane], lows[lane + step]);
            highs[lane] = max(highs[lane], highs[lane + step]);
            normals[lane] += normals[lane + step];
        }
    }
    workgroupBarrier();
    let is_empty = lows[0].x > highs[0].x;
    let center = 0.5 * lows[0] + 0.5 * highs[0];
    let axis = unit_or_z(normals[0]);
    if (is_lit) {
        atomicMax(&reaches[0], bitcast<u32>(distance(position, center)));
        atomicMax(&reaches[1], bitcast<u32>(distance(normal, axis)));
        atomicMax(&reaches[2], bitcast<u32>(abs(dot(position - center, axis))));
    }
    workgroupBarrier();
    if (lane == 0u) {
        let radius = bitcast<f32>(atomicLoad(&reaches[0])) * (1.0 + 1e-5);
        tile = PointTile(vec4f(center, select(radius, -1.0, is_empty)), axis,
                         bitcast<f32>(atomicLoad(&reaches[1])),
                         bitcast<f32>(atomicLoad(&reaches[2])));
    }
    return workgroupUniformLoad(&tile);
}

// Whether all points have another one behind their planes.
fn lies_above(points: PointTile, other: vec3f) -> bool {
    let offset = other - points.ball.xyz;
    let apart = length(offset);
    let lift = points.spread * (apart + points.ball.w) + 1e-5 * (apart + points.ball.w);
    return dot(offset, points.axis) + points.thickness + lift < 0.0;
}

// Whether a light sends nothing to any point, since it lies behind their planes or they behind its
// own.
fn faces_away(points: PointTile, light: VirtualLight) -> bool {
    let behind = dot(light.normal, light.position - points.ball.xyz);
    let is_behind = light.evenness == 0.0 && behind > points.ball.w + 1e-5 * abs(behind);
    return is_behind || lies_above(points, light.position);
}
