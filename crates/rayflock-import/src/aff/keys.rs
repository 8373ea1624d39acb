//! Keys of `k` blocks: how a mover moves, turns, grows and vanishes.
//!
//! ```text
//! k NAME {
//!   transl N       N x  time  x y z          tension continuity bias
//!   rot N          N x  time  x y z degrees  tension continuity bias
//!   scale N        N x  time  x y z          tension continuity bias
//!   visibility N   N x  time  0 or 1
//! }
//! ```
//!
//! All but visibility are splines of at least four keys, the first and the last of which only
//! shape the curve. Keys that go back in time, as BART's first robot has them, are left out: BART's
//! code does not get to them either.

use glam::{DQuat, DVec3};

use super::reader::Reader;
use crate::ImportError;

/// Fewest keys of a spline.
const LEAST_KEYS: usize = 4;

/// How something moves; empty lists leave it as it is.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Motion {
    pub(super) translation: Vec<SplineKey<DVec3>>,
    pub(super) rotation: Vec<SplineKey<DQuat>>,
    pub(super) scale: Vec<SplineKey<DVec3>>,
    /// From each time on, whether it is there.
    pub(super) visibility: Vec<(f64, bool)>,
    /// Keys that went back in time.
    pub(super) left_out: usize,
}

impl Motion {
    /// Number of keys of all kinds.
    pub(super) fn key_count(&self) -> usize {
        let (translation, rotation) = (self.translation.len(), self.rotation.len());
        translation + rotation + self.scale.len() + self.visibility.len()
    }

    /// Leaves out keys that go back in time.
    fn drop_disorder(&mut self) {
        let count = self.key_count();
        drop_earlier(&mut self.translation, |key| key.time);
        drop_earlier(&mut self.rotation, |key| key.time);
        drop_earlier(&mut self.scale, |key| key.time);
        drop_earlier(&mut self.visibility, |key| key.0);
        self.left_out = count - self.key_count();
    }
}

/// A value at a time and how a Kochanek-Bartels spline passes it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct SplineKey<T> {
    pub(super) time: f64,
    pub(super) value: T,
    pub(super) tension: f64,
    pub(super) continuity: f64,
    pub(super) bias: f64,
}

/// Reads a `k` block behind its name.
pub(super) fn read_motion(reader: &mut Reader<'_>) -> Result<Motion, ImportError> {
    const EXPECTED: &str = "\"transl\", \"rot\", \"scale\", \"visibility\" or \"}\"";
    reader.expect("{")?;
    let mut motion = Motion::default();
    loop {
        let kind = reader.word(EXPECTED)?;
        match kind.bytes {
            b"transl" => motion.translation = read_spline(reader, DVec3::from)?,
            b"rot" => motion.rotation = read_spline(reader, rotation)?,
            b"scale" => motion.scale = read_spline(reader, DVec3::from)?,
            b"visibility" => motion.visibility = read_visibility(reader)?,
            b"}" => {
                motion.drop_disorder();
                return Ok(motion);
            }
            _ => return Err(reader.wrong(Some(kind), EXPECTED)),
        }
    }
}

/// Reads keys with values of `N` numbers.
fn read_spline<T, const N: usize>(
    reader: &mut Reader<'_>,
    value: impl Fn([f64; N]) -> T,
) -> Result<Vec<SplineKey<T>>, ImportError> {
    let count = reader.count("keys", 4 + N)?;
    if count < LEAST_KEYS {
        let found = format!("a spline of {count} keys");
        let expected =
            format!("at least {LEAST_KEYS}, the first and the last of which shape the curve only");
        return Err(reader.invalid(found, expected));
    }
    let mut keys: Vec<SplineKey<T>> = Vec::with_capacity(count);
    for _ in 0..count {
        let time = reader.number()?;
        let value = value(reader.numbers()?);
        let [tension, continuity, bias] = reader.numbers()?;
        keys.push(SplineKey { time, value, tension, continuity, bias });
    }
    Ok(keys)
}

fn read_visibility(reader: &mut Reader<'_>) -> Result<Vec<(f64, bool)>, ImportError> {
    let count = reader.count("keys", 2)?;
    let mut keys: Vec<(f64, bool)> = Vec::with_capacity(count);
    for _ in 0..count {
        keys.push((reader.number()?, reader.number()? != 0.0));
    }
    Ok(keys)
}

/// Leaves out keys that are earlier than one before them.
fn drop_earlier<T>(keys: &mut Vec<T>, time_of: impl Fn(&T) -> f64) {
    let mut latest = f64::NEG_INFINITY;
    keys.retain(|key| {
        let is_kept = time_of(key) >= latest;
        latest = latest.max(time_of(key));
        is_kept
    });
}

/// The turn by some degrees about an axis; none about an axis without length.
fn rotation([x, y, z, degrees]: [f64; 4]) -> DQuat {
    let axis = DVec3::new(x, y, z).try_normalize();
    axis.map_or(DQuat::IDENTITY, |axis| DQuat::from_axis_angle(axis, degrees.to_radians()))
}
