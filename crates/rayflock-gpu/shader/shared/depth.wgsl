// Distances as depths: 0 to 1, in the order of t, for the depth test to keep the nearest.

// Bits of a float that grow with it, without the two lowest; saturates beyond 4e37.
fn depth_of(t: f32) -> f32 {
    let bits = bitcast<u32>(t);
    let ordered = select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
    return bitcast<f32>(min(ordered >> 2u, 0x3f7fffffu));
}
