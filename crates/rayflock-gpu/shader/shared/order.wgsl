// Floats as whole numbers that grow with them, for atomic operations and depths.

fn ordered_bits(t: f32) -> u32 {
    let bits = bitcast<u32>(t);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn from_ordered_bits(ordered: u32) -> f32 {
    return bitcast<f32>(select(~ordered, ordered & 0x7fffffffu, (ordered & 0x80000000u) != 0u));
}
