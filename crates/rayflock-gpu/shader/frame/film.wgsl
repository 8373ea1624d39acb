// Sums of light by pixel. A pixel may have several rays in a wave, and WGSL adds whole numbers only,
// so a sum is tried until no other invocation has come between.

fn add_to_film(pixel: u32, radiance: vec3f) {
    if (pixel == NO_PIXEL || !is_finite(radiance)) {
        return;
    }
    for (var channel = 0u; channel < 3u; channel++) {
        add_to_sum(3u * pixel + channel, radiance[channel]);
    }
}

fn add_to_sum(place: u32, value: f32) {
    if (value == 0.0) {
        return;
    }
    var before = atomicLoad(&film[place]);
    loop {
        let after = bitcast<u32>(bitcast<f32>(before) + value);
        let outcome = atomicCompareExchangeWeak(&film[place], before, after);
        if (outcome.exchanged) {
            break;
        }
        before = outcome.old_value;
    }
}
