// Computes the box around the primitives that rays may see.

@group(0) @binding(0) var<storage, read> primitives: array<Primitive>;
// Largest coordinates, then largest negated ones, by `ordered_bits`; 0 where there is nothing.
@group(0) @binding(1) var<storage, read_write> bounds: array<atomic<u32>, 6>;

const BOUNDERS: u32 = 256u;

var<workgroup> largest: array<atomic<u32>, 6>;

@compute @workgroup_size(BOUNDERS)
fn bound_scene(@builtin(workgroup_id) group: vec3u, @builtin(num_workgroups) groups: vec3u,
               @builtin(local_invocation_index) lane: u32) {
    let prim_idx = (group.y * groups.x + group.x) * BOUNDERS + lane;
    if (prim_idx < arrayLength(&primitives)) {
        let prim = primitives[prim_idx];
        if (prim.mask != 0u) {
            var low = min(min(prim.a, prim.b), prim.c);
            var high = max(max(prim.a, prim.b), prim.c);
            if (prim.kind == SPHERE) {
                low = prim.a - prim.b.x;
                high = prim.a + prim.b.x;
            }
            for (var axis = 0u; axis < 3u; axis++) {
                atomicMax(&largest[axis], ordered_bits(high[axis]));
                atomicMax(&largest[3u + axis], ordered_bits(-low[axis]));
            }
        }
    }
    workgroupBarrier();
    if (lane < 6u) {
        atomicMax(&bounds[lane], atomicLoad(&largest[lane]));
    }
}
