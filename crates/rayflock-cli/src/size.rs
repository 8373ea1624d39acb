//! The size of a picture.

use std::fmt;
use std::str::FromStr;

use serde::Serialize;

/// Width and height in pixels, each from 1 to [`Size::MAX_EDGE`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    /// Pixels a row.
    pub(crate) width: u32,
    /// Rows.
    pub(crate) height: u32,
}

impl Size {
    /// The longest edge: what every format but WebP (16383) and every machine should bear.
    pub(crate) const MAX_EDGE: u32 = 16_384;

    /// Width over height.
    pub(crate) fn aspect(self) -> f32 {
        self.width as f32 / self.height as f32
    }
}

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let edge = |text: &str| {
            let edge = text.parse::<u32>().ok()?;
            (1..=Self::MAX_EDGE).contains(&edge).then_some(edge)
        };
        text.split_once(['x', 'X'])
            .and_then(|(width, height)| Some(Self { width: edge(width)?, height: edge(height)? }))
            .ok_or_else(|| {
                format!("expected WIDTHxHEIGHT, each from 1 to {}, as in 640x360", Self::MAX_EDGE)
            })
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

impl Serialize for Size {
    /// As `[width, height]`.
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        [self.width, self.height].serialize(serializer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_two_positive_numbers_of_sane_size() {
        assert_eq!("64x48".parse(), Ok(Size { width: 64, height: 48 }));
        for text in ["", "64", "0x48", "64x", "x", "-1x5", "64x48x2", "16385x1", "1e3x5"] {
            assert!(text.parse::<Size>().is_err(), "{text}");
        }
    }
}
