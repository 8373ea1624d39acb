//! What a sweep found, for everything that tells it.

use glam::{Affine3A, Mat4};
use rayflock::import::export::points::{PointColumns, PointImages};
use rayflock::render::sensor::{Pattern, Sweep};

use crate::false_color::ColorScale;

/// What a sweep found.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scan<'a> {
    /// The points.
    pub(super) sweep: &'a Sweep,
    /// The pattern of its beams.
    pub(super) pattern: &'a Pattern,
}

impl<'a> Scan<'a> {
    /// What was found as files have it, coloured by range.
    pub(super) fn points(&self) -> PointColumns<'a> {
        let sweep = self.sweep;
        let scale = Self::color_scale(sweep.range.iter().copied());
        // Row by row, as files have it.
        let matrix = |place: Affine3A| Mat4::from(place).transpose().to_cols_array();
        PointColumns {
            position: &sweep.position,
            position_in_sensor: &sweep.position_in_sensor,
            normal: &sweep.normal,
            range: &sweep.range,
            intensity: &sweep.intensity,
            time: &sweep.time,
            object_id: &sweep.object_id,
            prim_id: &sweep.prim_id,
            beam_idx: &sweep.beam_idx,
            row: &sweep.row,
            column: &sweep.column,
            return_number: &sweep.return_number,
            return_count: &sweep.return_count,
            color: sweep.range.iter().map(|range| scale.srgb8(f64::from(*range))).collect(),
            step_time: sweep.steps.iter().map(|step| step.time).collect(),
            world_from_sensor: sweep.steps.iter().map(|at| matrix(at.world_from_sensor)).collect(),
            images: self.pattern.is_picture().then(|| self.images()),
        }
    }

    fn images(&self) -> PointImages {
        let (sweep, shape) = (self.sweep, self.pattern.shape());
        PointImages {
            shape,
            range: sweep.picture(shape, f32::INFINITY, |idx| sweep.range[idx]),
            depth: sweep.picture(shape, f32::INFINITY, |idx| sweep.depth(idx)),
            intensity: sweep.picture(shape, 0.0, |idx| sweep.intensity[idx]),
        }
    }

    /// The colours of numbers, from the least to the most.
    pub(super) fn color_scale(values: impl Iterator<Item = f32>) -> ColorScale {
        let (least, most) = values
            .fold((f32::INFINITY, f32::NEG_INFINITY), |(least, most), value| {
                (least.min(value), most.max(value))
            });
        match least <= most {
            true => ColorScale::new(f64::from(least), f64::from(most)),
            false => ColorScale::new(0.0, 0.0),
        }
    }
}
