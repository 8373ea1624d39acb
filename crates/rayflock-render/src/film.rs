//! The picture while it is still light: linear, unbounded.

/// An image of radiance: linear sRGB, rows from the top.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Film {
    width: usize,
    height: usize,
    pixels: Vec<[f32; 3]>,
}

impl Film {
    /// A black film. Either side may be 0.
    pub fn new(width: usize, height: usize) -> Self {
        let count = width.checked_mul(height).unwrap_or_default();
        let (width, height) = if count == 0 { (0, 0) } else { (width, height) };
        Self { width, height, pixels: vec![[0.0; 3]; count] }
    }

    /// Pixels a row.
    pub const fn width(&self) -> usize {
        self.width
    }

    /// Rows.
    pub const fn height(&self) -> usize {
        self.height
    }

    /// Linear red, green and blue of each pixel, rows from the top.
    pub fn pixels(&self) -> &[[f32; 3]] {
        &self.pixels
    }

    /// The pixels, to be written.
    pub fn pixels_mut(&mut self) -> &mut [[f32; 3]] {
        &mut self.pixels
    }

    /// The pixel in column `x` of row `y`, counted from the top left.
    ///
    /// # Panics
    /// When the film has no such pixel.
    pub fn pixel(&self, x: usize, y: usize) -> [f32; 3] {
        assert!(x < self.width, "column {x} of a film that is {} wide", self.width);
        self.pixels[y * self.width + x]
    }
}
