// Distances as depths: 0 to 1, in the order of t, for the depth test to keep the nearest.

// The bits of t in its order, without the two lowest; saturates beyond 4e37.
fn depth_of(t: f32) -> f32 {
    return bitcast<f32>(min(ordered_bits(t) >> 2u, 0x3f7fffffu));
}
