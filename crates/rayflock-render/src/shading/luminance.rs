//! How bright a colour looks.

use glam::Vec3;

/// Luminance of linear sRGB (ITU-R BT.709).
pub(crate) fn luminance(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}
