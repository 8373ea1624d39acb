//! What a sweep brought back, as columns.

use glam::{Affine3A, Vec3};

/// What a sweep brought back: one entry a return, in the order of beams and then of ranges
/// before noise. All
/// columns but `steps` have one length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sweep {
    /// The beam, counted in the order in which they are fired.
    pub beam_idx: Vec<u32>,
    /// Row of the beam in the picture of the pattern, from the top: the ring of a spinning sensor.
    pub row: Vec<u32>,
    /// Column of the beam, from the left.
    pub column: Vec<u32>,
    /// When the return came, in seconds of the scene.
    pub time: Vec<f64>,
    /// Distance along the beam, with noise, in scene units.
    pub range: Vec<f32>,
    /// The point in world space, with noise.
    pub position: Vec<Vec3>,
    /// The same in the frame of the sensor at that time.
    pub position_in_sensor: Vec<Vec3>,
    /// Unit normal of the facet in world space, on the sensor's side.
    pub normal: Vec<Vec3>,
    /// How much light came back: 1 from a white surface that faces the sensor at one scene unit.
    pub intensity: Vec<f32>,
    /// The object.
    pub object_id: Vec<u32>,
    /// The primitive within the object's mesh.
    pub prim_id: Vec<u32>,
    /// Which of the beam's told returns it is, from 1 on.
    pub return_number: Vec<u8>,
    /// How many of the beam's returns are told.
    pub return_count: Vec<u8>,
    /// Where the sensor was, time step by time step.
    pub steps: Vec<StepPose>,
}

/// Where a sensor was in a time step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StepPose {
    /// In seconds of the scene.
    pub time: f64,
    /// The sensor's place and attitude.
    pub world_from_sensor: Affine3A,
}

/// One return.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SweepPoint {
    pub(crate) beam_idx: u32,
    pub(crate) place: (u32, u32),
    pub(crate) time: f64,
    pub(crate) range: f32,
    pub(crate) position: Vec3,
    pub(crate) position_in_sensor: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) intensity: f32,
    pub(crate) object_id: u32,
    pub(crate) prim_id: u32,
    pub(crate) return_number: u8,
    pub(crate) return_count: u8,
}

impl Sweep {
    /// Number of returns.
    pub const fn len(&self) -> usize {
        self.range.len()
    }

    /// Whether nothing came back.
    pub const fn is_empty(&self) -> bool {
        self.range.is_empty()
    }

    /// Distance of return `idx` from the sensor's plane, along the axis in which it looks: what
    /// depth cameras tell.
    ///
    /// # Panics
    /// When `idx >= len()`.
    pub fn depth(&self, idx: usize) -> f32 {
        -self.position_in_sensor[idx].z
    }

    /// A picture of `rows` times `columns` pixels, rows from the top, of what `value` says of each
    /// beam's first told return; `nothing` where there is none. See
    /// [`Pattern::shape`](super::Pattern::shape).
    pub fn picture<T: Copy>(
        &self,
        (rows, columns): (usize, usize),
        nothing: T,
        value: impl Fn(usize) -> T,
    ) -> Vec<T> {
        let mut pixels = vec![nothing; rows * columns];
        for idx in (0..self.len()).filter(|idx| self.return_number[*idx] == 1) {
            let (row, column) = (self.row[idx] as usize, self.column[idx] as usize);
            if column < columns
                && let Some(pixel) = pixels.get_mut(row * columns + column)
            {
                *pixel = value(idx);
            }
        }
        pixels
    }

    /// Makes this a sweep without returns, keeping its memory.
    pub fn clear(&mut self) {
        self.beam_idx.clear();
        self.row.clear();
        self.column.clear();
        self.time.clear();
        self.range.clear();
        self.position.clear();
        self.position_in_sensor.clear();
        self.normal.clear();
        self.intensity.clear();
        self.object_id.clear();
        self.prim_id.clear();
        self.return_number.clear();
        self.return_count.clear();
        self.steps.clear();
    }

    pub(crate) fn push(&mut self, point: &SweepPoint) {
        self.beam_idx.push(point.beam_idx);
        self.row.push(point.place.0);
        self.column.push(point.place.1);
        self.time.push(point.time);
        self.range.push(point.range);
        self.position.push(point.position);
        self.position_in_sensor.push(point.position_in_sensor);
        self.normal.push(point.normal);
        self.intensity.push(point.intensity);
        self.object_id.push(point.object_id);
        self.prim_id.push(point.prim_id);
        self.return_number.push(point.return_number);
        self.return_count.push(point.return_count);
    }
}
