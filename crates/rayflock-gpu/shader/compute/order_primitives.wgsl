// Brings primitives into the order of their cells; each keeps its rank.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
@group(0) @binding(1) var<storage, read> places: array<vec2u>;
// Where the primitives of each cell begin.
@group(0) @binding(2) var<storage, read> firsts: array<u32>;
@group(0) @binding(3) var<storage, read_write> ordered: array<Primitive>;

@compute @workgroup_size(64)
fn order_primitives(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
                    @builtin(local_invocation_index) lane: u32) {
    let prim_idx = (group.y * groups.x + group.x) * 64u + lane;
    if (prim_idx < arrayLength(&primitives)) {
        let place = places[prim_idx];
        ordered[firsts[place.x] + place.y] = primitives[prim_idx];
    }
}
