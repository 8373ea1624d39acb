//! Looking up images.

use glam::{Vec2, Vec3};
use rayflock_scene::Texture;

/// The colour of `texture` at `uv`: between the four nearest texels, repeating in both
/// directions. Coordinate (0, 0) is the top left corner of the image; texel centres lie at
/// halves.
#[inline]
pub(crate) fn bilinear(texture: &Texture, uv: Vec2) -> Vec3 {
    let (x0, x1, fx) = neighbours(uv.x, texture.width);
    let (y0, y1, fy) = neighbours(uv.y, texture.height);
    let texel = |x: usize, y: usize| Vec3::from(texture.texels[y * texture.width + x]);
    let top = texel(x0, y0).lerp(texel(x1, y0), fx);
    let bottom = texel(x0, y1).lerp(texel(x1, y1), fx);
    top.lerp(bottom, fy)
}

/// The texels on both sides of `coordinate` along an axis of `count` texels, and how far it lies
/// from the first toward the second. Coordinates that are not finite count as 0.
fn neighbours(coordinate: f32, count: usize) -> (usize, usize, f32) {
    let wrapped = coordinate - coordinate.floor();
    let wrapped = if wrapped.is_finite() { wrapped } else { 0.0 };
    let position = wrapped * count as f32 - 0.5;
    let floor = position.floor();
    let first = if floor < 0.0 { count - 1 } else { (floor as usize).min(count - 1) };
    (first, if first + 1 == count { 0 } else { first + 1 }, position - floor)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn checker() -> Texture {
        let texels = vec![[0.0; 3], [1.0; 3], [2.0; 3], [3.0; 3]];
        Texture { name: String::new(), width: 2, height: 2, texels: texels.into() }
    }

    #[test]
    fn texel_centres_and_the_points_between() {
        let at = |u, v| bilinear(&checker(), Vec2::new(u, v)).x;
        assert_eq!((at(0.25, 0.25), at(0.75, 0.25)), (0.0, 1.0));
        assert_eq!((at(0.25, 0.75), at(0.75, 0.75)), (2.0, 3.0));
        assert_eq!(at(0.5, 0.5), 1.5);
    }

    #[test]
    fn the_image_repeats() {
        let at = |u, v| bilinear(&checker(), Vec2::new(u, v)).x;
        assert_eq!(at(-0.75, 2.25), at(0.25, 0.25));
        assert_eq!(at(0.0, 0.25), 0.5);
        assert_eq!(at(1.0, 0.25), 0.5);
    }

    #[test]
    fn coordinates_that_are_no_numbers_are_harmless() {
        for bad in [f32::NAN, f32::INFINITY, -1e-30, 1e30, f32::MIN] {
            assert!(bilinear(&checker(), Vec2::splat(bad)).is_finite());
        }
    }
}
