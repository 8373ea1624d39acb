//! Colours for ratios: blue where the engine is ahead, orange where it is behind, the colour of
//! the page at 1; both ends stand for a factor of sixteen.
//!
//! Blue and orange can be told apart by people who see few colours. Ink is black or white,
//! whichever is read more easily.
//!
//! **Source** for contrast: *Web Content Accessibility Guidelines 2.2*, "contrast ratio".

/// Red, green and blue.
type Rgb = [u8; 3];

const BLACK: Rgb = [0x00, 0x00, 0x00];
const WHITE: Rgb = [0xff, 0xff, 0xff];

/// Binary logarithm of the ratio at which a colour is full.
const FULL: f64 = 4.0;

/// What surrounds the cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct Theme {
    even: Rgb,
    ahead: Rgb,
    behind: Rgb,
}

/// On a light page.
pub(super) const LIGHT: Theme =
    Theme { even: [0xf3, 0xf1, 0xec], ahead: [0x14, 0x62, 0xa3], behind: [0xc2, 0x51, 0x0c] };

/// On a dark page.
pub(super) const DARK: Theme =
    Theme { even: [0x26, 0x2a, 0x30], ahead: [0x5a, 0xb0, 0xf2], behind: [0xee, 0x8b, 0x3d] };

/// Background and ink of a cell.
pub(super) fn shade(ratio: f64, theme: &Theme) -> [Rgb; 2] {
    let strength = ratio.log2() / FULL;
    let end = if strength > 0.0 { theme.ahead } else { theme.behind };
    // The root makes small differences visible.
    let share = strength.abs().min(1.0).sqrt();
    let mix = |idx: usize| {
        let (even, end) = (f64::from(theme.even[idx]), f64::from(end[idx]));
        (even + (end - even) * share).round() as u8
    };
    let background = [mix(0), mix(1), mix(2)];
    let ink =
        if contrast(background, BLACK) >= contrast(background, WHITE) { BLACK } else { WHITE };
    [background, ink]
}

/// A cell's colours in both themes, as values of the properties that the style sheet uses.
pub(super) fn style(ratio: f64) -> String {
    let ([light, light_ink], [dark, dark_ink]) = (shade(ratio, &LIGHT), shade(ratio, &DARK));
    let hex = |[red, green, blue]: Rgb| format!("#{red:02x}{green:02x}{blue:02x}");
    let [light, light_ink, dark, dark_ink] = [light, light_ink, dark, dark_ink].map(hex);
    format!("--light:{light};--light-ink:{light_ink};--dark:{dark};--dark-ink:{dark_ink}")
}

/// From 1, the same colour, to 21, black on white.
fn contrast(a: Rgb, b: Rgb) -> f64 {
    let (a, b) = (luminance(a), luminance(b));
    (a.max(b) + 0.05) / (a.min(b) + 0.05)
}

fn luminance(color: Rgb) -> f64 {
    let [red, green, blue] = color.map(|channel| {
        let value = f64::from(channel) / 255.0;
        if value <= 0.04045 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
    });
    0.2126 * red + 0.7152 * green + 0.0722 * blue
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_number_can_be_read_in_both_themes() {
        for theme in [LIGHT, DARK] {
            for step in -60..=60 {
                let [background, ink] = shade(f64::from(step).mul_add(0.1, 0.0).exp2(), &theme);
                assert!(contrast(background, ink) >= 4.5, "{theme:?} {step}: {background:?}");
            }
        }
    }

    #[test]
    fn ahead_is_blue_behind_is_orange_and_even_is_neither() {
        for theme in [LIGHT, DARK] {
            let background = |ratio| shade(ratio, &theme)[0];
            let [red, _, blue] = background(4.0);
            assert!(blue > red);
            let [red, _, blue] = background(0.25);
            assert!(red > blue);
            assert_eq!(background(1.0), theme.even);
            assert_eq!((background(99.0), background(0.001)), (theme.ahead, theme.behind));
        }
    }

    #[test]
    fn black_on_white_has_the_greatest_contrast() {
        assert!((contrast([0; 3], [255; 3]) - 21.0).abs() < 1e-9);
    }
}
