// Adds what virtual lights send to the points of a wave, past spheres that stand for geometry: one
// workgroup a tile of 64 slots, one invocation a point.
//
// For each light the invocations of a workgroup look for the spheres that may be on its way to any
// of their points, and list them; then each point goes through the list.

@group(0) @binding(0) var<storage, read> points: array<LitPoint>;
@group(0) @binding(1) var<storage, read> lights: array<VirtualLight>;
@group(0) @binding(2) var<storage, read> spheres: array<SoftSphere>;
@group(0) @binding(3) var<storage, read> walls: array<Wall>;
// Behind the sums of pixels, the sums that tell what gathering did.
@group(0) @binding(4) var<storage, read_write> film: array<atomic<u32>>;
@group(0) @binding(5) var<uniform> gather: GatherParams;

// Spheres that are looked at together: all that a list has room for.
const BLOCK_SPHERES: u32 = 512u;
// Places of sums that workgroups share, so that few add to the same one.
const SUM_PLACES: u32 = 64u;

struct GatherParams {
    // Geometry terms count up to this.
    bound: f32,
    // Distant lights are taken to be so far away.
    distance: f32,
    // The lights that are gathered by this dispatch.
    first_light: u32,
    end_light: u32,
    sphere_count: u32,
    wall_count: u32,
    // Where the sums begin in the film.
    first_sum: u32,
    unused: u32,
}

var<workgroup> sums: array<vec4f, TILE_POINTS>;
var<workgroup> near: array<Blocker, BLOCK_SPHERES>;
// They take turns: one is read while the other is made ready.
var<workgroup> near_counts: array<atomic<u32>, 2>;

@compute @workgroup_size(TILE_POINTS)
fn gather_lights(@builtin(workgroup_id) group: vec3u,
                 @builtin(local_invocation_index) lane: u32) {
    let point = points[group.x * TILE_POINTS + lane];
    let is_lit = point.pixel != NO_PIXEL;
    let bounds = point_tile(lane, point.shadow_position, point.normal, is_lit);
    if (bounds.ball.w < 0.0) {
        return;
    }
    var sum = Arriving(vec3f(0.0), 0.0);
    var tests = 0u;
    var turn = 0u;
    for (var light_idx = gather.first_light; light_idx < gather.end_light; light_idx++) {
        let light = placed(lights[light_idx], bounds.ball.xyz, gather.distance);
        let way = way_to(light, point);
        var beyond_walls = 0.0;
        if (is_lit && is_faced(way)) {
            beyond_walls = past_walls(point.shadow_position, light.position, bounds.ball);
        }
        var open = select(0.0, 1.0, beyond_walls > 0.0);
        for (var first = 0u; first < gather.sphere_count; first += BLOCK_SPHERES) {
            tests += find_near(first, light, bounds, lane, turn);
            workgroupBarrier();
            tests += pass_near(&open, point, light.position, turn);
            workgroupBarrier();
            turn = 1u - turn;
        }
        if (open > DARK) {
            let added = arriving(light, way, point, gather.bound);
            sum.radiance += open * beyond_walls * added.radiance;
            sum.lost += open * beyond_walls * added.lost;
        }
    }
    add_to_film(point.pixel, sum.radiance);
    add_to_sums(group.x, lane, is_lit, sum, tests);
}

// Lists those of a block of spheres that may be on the way from a light to some point of the tile;
// tells how many this invocation looked at.
fn find_near(first: u32, light: VirtualLight, bounds: PointTile, lane: u32, turn: u32) -> u32 {
    if (lane == 0u) {
        atomicStore(&near_counts[1u - turn], 0u);
    }
    if (faces_away(bounds, light)) {
        return 0u;
    }
    let shaft = shaft_between(light.position, bounds.ball);
    let end = min(first + BLOCK_SPHERES, gather.sphere_count);
    var looked_at = 0u;
    for (var sphere_idx = first + lane; sphere_idx < end; sphere_idx += TILE_POINTS) {
        looked_at++;
        let sphere = spheres[sphere_idx];
        // One whose centre lies behind the planes of all points counts at none.
        let is_touched = shaft_touches(shaft, vec4f(sphere.center, sphere.outer));
        if (!is_touched || lies_above(bounds, sphere.center)) {
            continue;
        }
        let blocker = blocker_toward(sphere, sphere_idx, light.position, light.normal);
        if (blocker.share > 0.0) {
            near[atomicAdd(&near_counts[turn], 1u)] = blocker;
        }
    }
    return looked_at;
}

// Takes away from what is open what the listed spheres do; tells how many were asked.
fn pass_near(open: ptr<function, f32>, point: LitPoint, light: vec3f, turn: u32) -> u32 {
    let count = atomicLoad(&near_counts[turn]);
    var asked = 0u;
    while (asked < count && *open > DARK) {
        let blocker = near[asked];
        *open -= taken_by(spheres[blocker.sphere_idx], blocker, point.shadow_position,
                          point.normal, light);
        asked++;
    }
    return asked;
}

// The share of light that comes past all walls. Those that the light and all of the tile lie above
// are not asked.
fn past_walls(point: vec3f, light: vec3f, ball: vec4f) -> f32 {
    var share = 1.0;
    for (var wall_idx = 0u; wall_idx < gather.wall_count; wall_idx++) {
        let wall = walls[wall_idx];
        if (min(height_above(wall, light), height_above(wall, ball.xyz) - ball.w) < 0.0) {
            share *= past_wall(wall, point, light);
        }
    }
    return share;
}

// Adds up over the tile what arrived at points, what the bound kept away, pairs and tests.
fn add_to_sums(group: u32, lane: u32, is_lit: bool, sum: Arriving, tests: u32) {
    var own = vec4f(0.0, 0.0, 0.0, f32(tests));
    if (is_lit) {
        own.z = f32(gather.end_light - gather.first_light);
    }
    if (is_lit && is_finite(sum.radiance)) {
        own.x = sum.radiance.x + sum.radiance.y + sum.radiance.z;
        own.y = sum.lost;
    }
    sums[lane] = own;
    for (var step = TILE_POINTS / 2u; step > 0u; step /= 2u) {
        workgroupBarrier();
        if (lane < step) {
            sums[lane] += sums[lane + step];
        }
    }
    if (lane == 0u) {
        let first = gather.first_sum + 4u * (group % SUM_PLACES);
        for (var kind = 0u; kind < 4u; kind++) {
            add_to_sum(first + kind, sums[0][kind]);
        }
    }
}
