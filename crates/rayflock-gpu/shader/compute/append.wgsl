// Appends what the invocations of a workgroup keep: one atomic operation on the counter for all. The
// first invocation adds `kept` to it, and tells the others by `first_place`.

var<workgroup> kept: atomic<u32>;
var<workgroup> first_place: u32;

// The place within the workgroup of what this invocation keeps. Every invocation calls it; then
// `kept` is complete.
fn place_in_group(is_kept: bool) -> u32 {
    var place = 0u;
    if (is_kept) {
        place = atomicAdd(&kept, 1u);
    }
    workgroupBarrier();
    return place;
}
