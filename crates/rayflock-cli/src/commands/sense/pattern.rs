//! What the command line says about where beams go, as the library takes it.

use rayflock::render::sensor::{self, FieldOfView, PatternOptions};

use crate::args::{Elevations, Field, Measures, Numbers, SensorOptions};

/// What changes a preset.
pub(super) fn pattern_options(options: &SensorOptions) -> PatternOptions {
    PatternOptions {
        rows: options.rows,
        elevations: options.elevations.as_ref().map(elevations),
        columns: options.columns,
        size: options.size.map(|size| [size.width, size.height]),
        fov: options.fov.map(field_of_view),
        extent: options.extent.map(|Measures(extent)| extent.map(|edge| edge as f32)),
        beams: options.beams,
        turns: options.turns.map(|Numbers(turns)| turns),
        rate: options.rate,
        shutter: options.shutter,
    }
}

fn elevations(degrees: &Elevations) -> sensor::Elevations {
    match degrees {
        Elevations::Each(each) => {
            sensor::Elevations::Each(each.iter().map(|degrees| degrees.to_radians()).collect())
        }
        Elevations::Between(first, last) => {
            sensor::Elevations::Between([*first, *last].map(f64::to_radians))
        }
    }
}

fn field_of_view(degrees: Field) -> FieldOfView {
    match degrees {
        Field { across: Some(across), up } => FieldOfView::Two([across, up].map(f64::to_radians)),
        Field { across: None, up } => FieldOfView::One(up.to_radians()),
    }
}
