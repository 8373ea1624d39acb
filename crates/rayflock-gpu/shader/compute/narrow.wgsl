// How the work on a tile is shared out on a processor, which runs the invocations of a workgroup
// one after the other: each has a ray of its own.

const SLICES: u32 = 1u;
// Chunks that an invocation asks at once: a bit each.
const CHUNKS_EACH: u32 = 32u;
