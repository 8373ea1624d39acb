//! NumPy frame sets.

use std::io::{self, Seek, Write};

use glam::Vec3;
use ndarray::{ArrayView1, ArrayView2, ArrayView3, ShapeError, arr0};
use ndarray_npy::{NpzWriter, WriteNpzError};

use super::FrameMesh;

/// Frames that are to be one `.npz` file, in the arrays that this crate reads: float32 positions,
/// uint32 triangles, int64 offsets. Triangles that all frames share are held and written once.
#[derive(Clone, Debug)]
pub struct FrameSet {
    vertices: Vec<[f32; 3]>,
    vertex_offsets: Vec<i64>,
    /// Of the first frame while all have the same, then of all frames.
    triangles: Vec<[u32; 3]>,
    /// Empty while all frames have the same.
    triangle_offsets: Vec<i64>,
    centers: Vec<[f32; 3]>,
    radii: Vec<f32>,
    center_offsets: Vec<i64>,
}

impl Default for FrameSet {
    fn default() -> Self {
        Self::new()
    }
}

impl FrameSet {
    /// A set without frames.
    pub fn new() -> Self {
        Self {
            vertices: Vec::new(),
            vertex_offsets: vec![0],
            triangles: Vec::new(),
            triangle_offsets: Vec::new(),
            centers: Vec::new(),
            radii: Vec::new(),
            center_offsets: vec![0],
        }
    }

    /// Number of frames.
    pub fn frame_count(&self) -> usize {
        self.vertex_offsets.len() - 1
    }

    /// Adds a frame.
    pub fn push(&mut self, frame: &FrameMesh) {
        self.push_triangles(frame);
        self.vertices.extend(frame.vertices.iter().map(Vec3::to_array));
        self.vertex_offsets.push(self.vertices.len() as i64);
        self.centers.extend(frame.spheres.iter().map(|sphere| sphere.center.to_array()));
        self.radii.extend(frame.spheres.iter().map(|sphere| sphere.radius));
        self.center_offsets.push(self.centers.len() as i64);
    }

    fn push_triangles(&mut self, frame: &FrameMesh) {
        let frames_before = self.frame_count();
        if frames_before == 0 {
            self.triangles.clone_from(&frame.triangles);
            return;
        }
        if self.triangle_offsets.is_empty() {
            if self.triangles == frame.triangles {
                return;
            }
            // From now on, each frame has its own.
            let shared = self.triangles.len();
            self.triangles = self.triangles.repeat(frames_before);
            self.triangle_offsets = (0..=frames_before).map(|i| (i * shared) as i64).collect();
        }
        self.triangles.extend_from_slice(&frame.triangles);
        self.triangle_offsets.push(self.triangles.len() as i64);
    }

    /// Writes the file, with the rate of the frames a second.
    ///
    /// # Errors
    /// When `out` cannot be written to.
    pub fn write<W: Write + Seek>(&self, frame_rate: f64, out: W) -> io::Result<()> {
        self.write_arrays(frame_rate, out).map_err(|error| io::Error::other(error.to_string()))
    }

    fn write_arrays<W: Write + Seek>(&self, frame_rate: f64, out: W) -> Result<(), WriteNpzError> {
        let mut file = NpzWriter::new(out);
        file.add_array("frame_rate", &arr0(frame_rate))?;
        if !self.vertices.is_empty() || self.centers.is_empty() {
            let (points, offsets) = (self.vertices.as_flattened(), &self.vertex_offsets);
            add_frames(&mut file, "vertices", points, ("vertex_offsets", offsets))?;
            file.add_array("triangles", &rows(self.triangles.as_flattened()))?;
            if !self.triangle_offsets.is_empty() {
                file.add_array("triangle_offsets", &ArrayView1::from(&self.triangle_offsets))?;
            }
        }
        if !self.centers.is_empty() {
            let (points, offsets) = (self.centers.as_flattened(), &self.center_offsets);
            add_frames(&mut file, "centers", points, ("center_offsets", offsets))?;
            match even_length(offsets) {
                Some(length) => {
                    let shape = (self.frame_count(), length);
                    file.add_array("radii", &shaped(ArrayView2::from_shape(shape, &self.radii)))?;
                }
                None => file.add_array("radii", &ArrayView1::from(&self.radii))?,
            }
        }
        file.finish()?;
        Ok(())
    }
}

/// Adds points as (frames, points, 3) where all frames have as many, or else with offsets.
fn add_frames<W: Write + Seek>(
    file: &mut NpzWriter<W>,
    name: &str,
    numbers: &[f32],
    (offsets_name, offsets): (&str, &[i64]),
) -> Result<(), WriteNpzError> {
    if let Some(length) = even_length(offsets) {
        let shape = (offsets.len() - 1, length, 3);
        return file.add_array(name, &shaped(ArrayView3::from_shape(shape, numbers)));
    }
    file.add_array(name, &rows(numbers))?;
    file.add_array(offsets_name, &ArrayView1::from(offsets))
}

/// The length of every frame, if there are frames and all have the same.
fn even_length(offsets: &[i64]) -> Option<usize> {
    let lengths = || offsets.windows(2).map(|pair| pair[1] - pair[0]);
    let shortest = lengths().min()?;
    (lengths().max() == Some(shortest)).then_some(shortest as usize)
}

/// Numbers as rows of three.
fn rows<T>(numbers: &[T]) -> ArrayView2<'_, T> {
    shaped(ArrayView2::from_shape((numbers.len() / 3, 3), numbers))
}

/// An array whose shape has as many numbers as there are.
fn shaped<A>(array: Result<A, ShapeError>) -> A {
    array.unwrap_or_else(|error| unreachable!("a frame set is whole: {error}"))
}
