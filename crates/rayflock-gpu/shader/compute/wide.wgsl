// How the work on a tile is shared out on a card, whose units are many and wait for memory: four
// invocations have a ray in common.

const SLICES: u32 = 4u;
// Chunks that an invocation asks at once: a bit each.
const CHUNKS_EACH: u32 = 16u;
