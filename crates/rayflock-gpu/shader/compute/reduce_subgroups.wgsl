// How invocations of a workgroup bring numbers together, on devices that have subgroups: those of a
// subgroup in one step, then one of them for all. Which invocations are a subgroup is not known.

fn note_touches(slice: u32, bits: u32) {
    let count = subgroupAdd(countOneBits(bits));
    for (var of_slice = 0u; of_slice < SLICES; of_slice++) {
        let all = subgroupOr(select(0u, bits, slice == of_slice));
        if (is_first()) {
            atomicOr(&touched[of_slice], all);
        }
    }
    if (is_first()) {
        atomicAdd(&touch_count, count);
    }
}

fn note_reach(reach: u32) {
    let farthest = subgroupMax(reach);
    if (is_first()) {
        atomicMax(&farthest_hit, farthest);
    }
}

fn note_found(is_found: bool) {
    let is_any = subgroupAny(is_found);
    if (is_first() && is_any) {
        atomicAdd(&found_count, 1u);
    }
}

fn note_tests(tests: vec3u) {
    let all = subgroupAdd(tests);
    if (is_first()) {
        for (var kind = 0u; kind < 3u; kind++) {
            atomicAdd(&test_sums[kind], all[kind]);
        }
    }
}

// Whether this invocation speaks for its subgroup.
fn is_first() -> bool {
    return subgroupExclusiveAdd(1u) == 0u;
}
