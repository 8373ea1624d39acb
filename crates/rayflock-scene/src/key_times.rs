//! The key times of animated meshes.

use crate::SceneError;

/// How far before a key a time may lie and still count as that key's, in seconds: frame times
/// come as `frame / rate` or `frame * (1 / rate)` or from text, and should meet keys all the same.
pub(crate) const TOLERANCE_SECONDS: f64 = 1e-6;

/// Checks that there are times, finite and strictly increasing.
///
/// # Errors
/// [`SceneError::Empty`] and [`SceneError::KeyTime`], which name `element`.
pub(crate) fn check_times(
    element: &str,
    times: impl Iterator<Item = f64>,
) -> Result<(), SceneError> {
    let mut before = None;
    for (key_idx, time) in times.enumerate() {
        let expected = match before {
            _ if !time.is_finite() => "a finite number",
            Some(before) if time <= before => "a later time than before",
            _ => {
                before = Some(time);
                continue;
            }
        };
        let (element, time) = (element.to_owned(), time.to_string());
        return Err(SceneError::KeyTime { element, key_idx, time, expected });
    }
    let empty = || SceneError::Empty { element: element.to_owned(), what: "keys" };
    before.map(|_| ()).ok_or_else(empty)
}

/// The last key at or before `time`, or else the first.
pub(crate) fn key_at(times: &[f64], time: f64) -> usize {
    times.partition_point(|&key| key <= time + TOLERANCE_SECONDS).saturating_sub(1)
}

/// The key at or before `time` and how far the time is from it to the next, from 0 to 1.
/// Before the first and after the last key it is 0.
pub(crate) fn span_at(times: &[f64], time: f64) -> (usize, f32) {
    let before = key_at(times, time);
    let Some(next) = times.get(before + 1) else { return (before, 0.0) };
    let share = ((time - times[before]) / (next - times[before])) as f32;
    // A time that is no number has no share either.
    (before, if share > 0.0 { share } else { 0.0 })
}
