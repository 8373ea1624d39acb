//! The museum's pictures: each a formula for the colour at a place of the canvas.
//!
//! `x` runs from 0 on the left to 1 on the right, `y` from 0 at the top to 1 at the bottom.

use glam::{FloatExt, Vec2, Vec3};

use crate::Texture;

/// Texels a row and rows; the canvas has the same shape.
const SIZE: [usize; 2] = [136, 170];
const SHAPE: Vec2 = Vec2::new(0.8, 1.0);

type Painting = (&'static str, fn(Vec2) -> Vec3);

const PAINTINGS: [Painting; 8] = [
    ("Triangles within triangles", triangles),
    ("Evening at sea", evening),
    ("Primary colours", primary_colors),
    ("Seven discs", discs),
    ("Moon over hills", moon),
    ("Interference", interference),
    ("Two fields", fields),
    ("A Julia set", julia),
];

/// Number of pictures, and of textures.
pub(super) const PAINTING_COUNT: u32 = PAINTINGS.len() as u32;

/// The pictures as textures.
pub(super) fn textures() -> Vec<Texture> {
    let [width, height] = SIZE;
    let paint = |(name, color_at): Painting| {
        let place = |texel: usize| {
            let texel = Vec2::new((texel % width) as f32 + 0.5, (texel / width) as f32 + 0.5);
            texel / Vec2::new(width as f32, height as f32)
        };
        let color = |texel| color_at(place(texel)).clamp(Vec3::ZERO, Vec3::ONE).to_array();
        let texels = (0..width * height).map(color).collect();
        Texture { name: name.to_owned(), width, height, texels }
    };
    PAINTINGS.map(paint).to_vec()
}

/// Sierpinski's triangle in warm colours on blue.
fn triangles(at: Vec2) -> Vec3 {
    let (across, down) = ((at.x - 0.5) * 1.1, at.y * 1.15 - 0.12);
    let inside = down > 0.0 && down < 0.9 && across.abs() < down / 1.8;
    if !inside {
        return Vec3::new(0.05, 0.09, 0.22).lerp(Vec3::new(0.10, 0.22, 0.35), at.y);
    }
    let scale = 64.0 / 0.9;
    let row = (down * scale) as u32;
    let column = ((across + down / 1.8) / (2.0 / 1.8) * scale) as u32;
    let hole = column & row.saturating_sub(column) != 0;
    let warm = Vec3::new(0.95, 0.62, 0.12).lerp(Vec3::new(0.75, 0.12, 0.10), at.y);
    if hole { 0.25 * warm } else { warm }
}

/// A sun that sets over water.
fn evening(at: Vec2) -> Vec3 {
    let glow = Vec3::new(0.98, 0.55, 0.16);
    let sky = |y: f32| Vec3::new(0.18, 0.16, 0.40).lerp(glow, (y / 0.6).clamp(0.0, 1.0));
    let sun = ((at - Vec2::new(0.5, 0.52)) * SHAPE).length();
    if at.y < 0.6 {
        let disc = if sun < 0.1 { 1.0 } else { (-(sun - 0.1) * 12.0).exp() * 0.5 };
        return sky(at.y).lerp(Vec3::new(1.0, 0.9, 0.55), disc);
    }
    let depth = at.y - 0.6;
    let ripple = ((depth * 40.0).sqrt() * 14.0 + 3.0 * (at.x * 9.0).sin()).sin();
    let glitter = ripple.max(0.0) * (-((at.x - 0.5) / (0.06 + 0.5 * depth)).powi(2)).exp();
    (sky(0.6 - depth) * 0.45).lerp(Vec3::new(1.0, 0.75, 0.35), 0.8 * glitter)
}

/// Blocks of colour between black bars.
fn primary_colors(at: Vec2) -> Vec3 {
    const BLOCKS: [([f32; 4], (f32, f32, f32)); 5] = [
        ([0.30, 0.0, 1.0, 0.62], (0.72, 0.04, 0.03)),
        ([0.0, 0.62, 0.30, 1.0], (0.02, 0.09, 0.42)),
        ([0.82, 0.82, 1.0, 1.0], (0.90, 0.66, 0.05)),
        ([0.0, 0.0, 0.30, 0.34], (0.86, 0.84, 0.78)),
        ([0.30, 0.62, 0.82, 1.0], (0.88, 0.86, 0.80)),
    ];
    const VERTICAL: [(f32, f32, f32); 2] = [(0.30, 0.0, 1.0), (0.82, 0.62, 1.0)];
    const HORIZONTAL: [(f32, f32, f32); 3] =
        [(0.62, 0.0, 1.0), (0.34, 0.0, 0.3), (0.82, 0.82, 1.0)];
    let on_bar = |bar: &(f32, f32, f32), across: f32, along: f32, half: f32| {
        (across - bar.0).abs() < half && along >= bar.1 && along <= bar.2
    };
    if VERTICAL.iter().any(|bar| on_bar(bar, at.x, at.y, 0.018))
        || HORIZONTAL.iter().any(|bar| on_bar(bar, at.y, at.x, 0.015))
    {
        return Vec3::splat(0.02);
    }
    let holds = |[left, top, right, bottom]: [f32; 4]| {
        at.x >= left && at.x < right && at.y >= top && at.y < bottom
    };
    let block = BLOCKS.iter().find(|(extent, _)| holds(*extent));
    block.map_or(Vec3::new(0.85, 0.83, 0.76), |&(_, color)| Vec3::from(color))
}

/// Rings around seven centres.
fn discs(at: Vec2) -> Vec3 {
    const DISCS: [(f32, f32, f32, f32); 7] = [
        (0.28, 0.24, 0.17, 0.0),
        (0.60, 0.40, 0.21, 2.1),
        (0.22, 0.62, 0.13, 4.2),
        (0.56, 0.78, 0.16, 1.0),
        (0.68, 0.12, 0.08, 3.0),
        (0.10, 0.88, 0.07, 5.0),
        (0.36, 0.46, 0.07, 0.6),
    ];
    let mut color = Vec3::new(0.80, 0.74, 0.60) * (0.9 + 0.1 * (at.x * 3.0 + at.y * 5.0).sin());
    for (x, y, radius, hue) in DISCS {
        let distance = (at * SHAPE).distance(Vec2::new(x, y));
        if distance < radius {
            color = rainbow(hue + (distance / radius * 4.0).floor() * 1.3);
        }
    }
    color
}

/// A moon over dark hills.
fn moon(at: Vec2) -> Vec3 {
    let ridge = |base: f32, height: f32, rate: f32| {
        base + height * ((at.x * rate).sin() + 0.5 * (at.x * rate * 2.3 + 1.0).sin())
    };
    let layers = [
        (ridge(0.86, 0.03, 7.0), Vec3::new(0.01, 0.02, 0.03)),
        (ridge(0.74, 0.05, 4.0), Vec3::new(0.03, 0.06, 0.09)),
        (ridge(0.62, 0.06, 5.5), Vec3::new(0.07, 0.12, 0.18)),
    ];
    if let Some((_, color)) = layers.iter().find(|(height, _)| at.y > *height) {
        return *color;
    }
    let distance = ((at - Vec2::new(0.66, 0.26)) * SHAPE).length();
    let disc = if distance < 0.09 { 1.0 } else { 0.5 * (-(distance - 0.09) * 9.0).exp() };
    let night = Vec3::new(0.02, 0.04, 0.13).lerp(Vec3::new(0.14, 0.24, 0.36), at.y);
    night.lerp(Vec3::new(0.95, 0.93, 0.82), disc)
}

/// Circular waves from two places.
fn interference(at: Vec2) -> Vec3 {
    let from = |x: f32, y: f32| (70.0 * (at * SHAPE).distance(Vec2::new(x, y))).sin();
    let height = 0.25 * (from(0.2, 0.3) + from(0.62, 0.75)) + 0.5;
    Vec3::new(0.02, 0.16, 0.22).lerp(Vec3::new(0.88, 0.92, 0.80), height)
}

/// Two soft fields of colour, one above the other.
fn fields(at: Vec2) -> Vec3 {
    let field = |top: f32, bottom: f32| {
        let edge = |distance: f32| (distance / 0.03).clamp(0.0, 1.0);
        edge(at.x - 0.08) * edge(0.92 - at.x) * edge(at.y - top) * edge(bottom - at.y)
    };
    let ground = Vec3::new(0.42, 0.05, 0.03);
    let weave = 1.0 + 0.05 * (at.x * 90.0).sin() * (at.y * 110.0).sin();
    let upper = ground.lerp(Vec3::new(0.93, 0.42, 0.04), field(0.06, 0.56));
    weave * upper.lerp(Vec3::new(0.10, 0.02, 0.06), field(0.61, 0.94))
}

/// How fast points flee under `z^2 + c`.
fn julia(at: Vec2) -> Vec3 {
    const C: Vec2 = Vec2::new(-0.79, 0.15);
    const STEPS: u32 = 60;
    let mut z = (at - 0.5) * Vec2::new(2.0, 2.6);
    z = Vec2::new(z.y, z.x);
    for step in 0..STEPS {
        if z.length_squared() > 16.0 {
            let fade = (step as f32 / STEPS as f32).sqrt();
            return rainbow(3.6 + 3.5 * fade) * 0.15_f32.lerp(1.0, fade);
        }
        z = Vec2::new(z.x * z.x - z.y * z.y, 2.0 * z.x * z.y) + C;
    }
    Vec3::new(0.95, 0.85, 0.60)
}

/// A colour of the given hue, in radians.
fn rainbow(hue: f32) -> Vec3 {
    let wave = |offset: f32| 0.5 + 0.45 * (hue + offset).cos();
    Vec3::new(wave(0.0), 0.85 * wave(-2.1), 0.9 * wave(2.1)).powf(1.5)
}
