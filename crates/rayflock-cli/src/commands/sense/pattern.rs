//! From a preset and options to where beams go.

use anyhow::{Result, bail, ensure};
use rayflock::render::sensor::{
    DepthCamera, OrthographicScanner, Pattern, Raster, Rosette, Shutter, Spinning, evenly,
};

use crate::args::{Elevations, Field, Measures, Numbers, SensorOptions, ShutterArgument};

/// The most rows that are spread evenly: the beams that a pattern may have.
const MAX_ROWS: u32 = 1 << 24;

/// What the scene says where neither preset nor options do.
#[derive(Clone, Copy, Debug)]
pub(super) struct Surroundings {
    /// The angle of view of the camera that the sensor is on, up, in radians.
    pub(super) vertical_fov: Option<f32>,
    /// The diagonal of everything over the whole motion; 0 where there is nothing.
    pub(super) diagonal: f32,
}

/// The preset called `name`, changed as `options` say.
pub(super) fn pattern(
    name: &str,
    options: &SensorOptions,
    surroundings: &Surroundings,
) -> Result<Pattern> {
    let mut pattern: Pattern = name.parse()?;
    refuse_unsuitable(name, &pattern, options)?;
    match &mut pattern {
        Pattern::Spinning(spinning) => change_spinning(spinning, options)?,
        Pattern::Raster(raster) => change_raster(raster, options)?,
        Pattern::Rosette(rosette) => change_rosette(rosette, options)?,
        Pattern::Depth(depth) => change_depth(depth, options, surroundings.vertical_fov)?,
        Pattern::Orthographic(ortho) => change_ortho(ortho, options, surroundings.diagonal),
    }
    set_time(&mut pattern, options);
    Ok(pattern)
}

fn change_spinning(spinning: &mut Spinning, options: &SensorOptions) -> Result<()> {
    let ends = |elevations: &[f64]| {
        elevations.first().copied().zip(elevations.last().copied()).unwrap_or_default()
    };
    spinning.columns = options.columns.unwrap_or(spinning.columns);
    let preset_rows = u32::try_from(spinning.elevations.len())?;
    let rows = options.rows.unwrap_or(preset_rows);
    ensure!(rows <= MAX_ROWS, "--rows is {rows}, expected {MAX_ROWS} at most");
    let (first, last) = match &options.elevations {
        Some(Elevations::Each(degrees)) => {
            let found = degrees.len();
            ensure!(
                options.rows.is_none_or(|rows| rows as usize == found),
                "--rows is {rows}, but --elevations are those of {found} rows"
            );
            spinning.elevations = degrees.iter().map(|degrees| degrees.to_radians()).collect();
            return Ok(());
        }
        Some(Elevations::Between(first, last)) => (first.to_radians(), last.to_radians()),
        None => ends(&spinning.elevations),
    };
    spinning.elevations = evenly(first, last, rows);
    Ok(())
}

fn change_raster(raster: &mut Raster, options: &SensorOptions) -> Result<()> {
    if let Some(size) = options.size {
        (raster.columns, raster.rows) = (size.width, size.height);
    }
    raster.field = match options.fov {
        Some(Field { across: Some(across), up }) => [across, up].map(f64::to_radians),
        Some(Field { up, .. }) => bail!("--fov is {up}, expected two angles, as in 120x{up}"),
        None => raster.field,
    };
    Ok(())
}

fn change_rosette(rosette: &mut Rosette, options: &SensorOptions) -> Result<()> {
    rosette.beams = options.beams.unwrap_or(rosette.beams);
    if let Some(Numbers(turns)) = options.turns {
        rosette.turns = turns;
    }
    if let Some(field) = options.fov {
        rosette.bends = [0.25 * one_angle(field)?; 2];
    }
    Ok(())
}

fn change_depth(
    depth: &mut DepthCamera,
    options: &SensorOptions,
    vertical_fov: Option<f32>,
) -> Result<()> {
    if let Some(size) = options.size {
        (depth.width, depth.height) = (size.width, size.height);
    }
    depth.vertical_field = match (options.fov, vertical_fov) {
        (Some(field), _) => one_angle(field)?,
        (None, Some(vertical_fov)) => f64::from(vertical_fov),
        (None, None) => depth.vertical_field,
    };
    Ok(())
}

fn change_ortho(ortho: &mut OrthographicScanner, options: &SensorOptions, diagonal: f32) {
    if let Some(size) = options.size {
        (ortho.width, ortho.height) = (size.width, size.height);
    }
    let aspect = ortho.width as f32 / ortho.height as f32;
    ortho.extent = match options.extent {
        Some(Measures(extent)) => extent.map(|edge| edge as f32),
        None if diagonal > 0.0 => [diagonal * aspect.max(1.0), diagonal / aspect.min(1.0)],
        None => ortho.extent,
    };
}

/// The angle, in radians, where there may be but one.
fn one_angle(field: Field) -> Result<f64> {
    match field {
        Field { across: None, up } => Ok(up.to_radians()),
        Field { across: Some(across), up } => {
            bail!("--fov is {across}x{up}, expected one angle, as in {up}")
        }
    }
}

/// Sets how often the pattern is swept, and when its beams are fired.
fn set_time(pattern: &mut Pattern, options: &SensorOptions) {
    let rate = options.rate.unwrap_or(pattern.rate());
    let choose = |shutter: Shutter| match options.shutter {
        Some(ShutterArgument::Global) => Shutter::Global,
        Some(ShutterArgument::Rolling) => Shutter::Rolling,
        None => shutter,
    };
    match pattern {
        Pattern::Spinning(spinning) => spinning.revolutions_per_second = rate,
        Pattern::Raster(raster) => raster.rate = rate,
        Pattern::Rosette(rosette) => rosette.rate = rate,
        Pattern::Depth(depth) => (depth.rate, depth.shutter) = (rate, choose(depth.shutter)),
        Pattern::Orthographic(ortho) => {
            (ortho.rate, ortho.shutter) = (rate, choose(ortho.shutter));
        }
    }
}

/// Fails where an option is given that the sensor has no use for.
fn refuse_unsuitable(name: &str, pattern: &Pattern, options: &SensorOptions) -> Result<()> {
    let suitable: &[&str] = match pattern {
        Pattern::Spinning(_) => &["--rows", "--elevations", "--columns"],
        Pattern::Raster(_) => &["--size", "--fov"],
        Pattern::Rosette(_) => &["--beams", "--fov", "--turns"],
        Pattern::Depth(_) => &["--size", "--fov", "--shutter"],
        Pattern::Orthographic(_) => &["--size", "--extent", "--shutter"],
    };
    for (option, is_given) in [
        ("--rows", options.rows.is_some()),
        ("--elevations", options.elevations.is_some()),
        ("--columns", options.columns.is_some()),
        ("--size", options.size.is_some()),
        ("--fov", options.fov.is_some()),
        ("--extent", options.extent.is_some()),
        ("--beams", options.beams.is_some()),
        ("--turns", options.turns.is_some()),
        ("--shutter", options.shutter.is_some()),
    ] {
        ensure!(
            !is_given || suitable.contains(&option),
            "{option} says nothing about the sensor {name}, which has {}",
            suitable.join(", ")
        );
    }
    Ok(())
}
