//! Where the sun stands.
//!
//! Computed by the crate `solar-positioning`, an implementation of NREL's Solar Position
//! Algorithm, good to 0.0003 degrees. Positions are topocentric, at sea level, of the middle of
//! the disc, and without refraction: a sun that the air lifts over the horizon, by half a degree,
//! is not up yet.

use jiff::Timestamp;
use jiff::tz::Offset;
use solar_positioning::spa::solar_position_from_julian;
use solar_positioning::time::{DeltaT, JulianDate};

use super::SunError;

/// A place on Earth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    latitude_degrees: f64,
    longitude_degrees: f64,
}

impl Place {
    /// A place by its latitude in degrees, north positive, and its longitude in degrees, east
    /// positive.
    ///
    /// # Errors
    /// [`SunError::Place`] beyond 90 degrees of latitude or 180 degrees of longitude.
    pub fn from_degrees(latitude: f64, longitude: f64) -> Result<Self, SunError> {
        check("latitude", latitude, 90.0, "-90 to 90")?;
        check("longitude", longitude, 180.0, "-180 to 180")?;
        Ok(Self { latitude_degrees: latitude, longitude_degrees: longitude })
    }
}

fn check(
    angle: &'static str,
    found: f64,
    limit: f64,
    expected: &'static str,
) -> Result<(), SunError> {
    // Not a number is not within any limit.
    if found.abs() <= limit { Ok(()) } else { Err(SunError::Place { angle, found, expected }) }
}

/// Where the sun stands, as seen from a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunPosition {
    /// Radians from north over east, 0 to a whole turn.
    pub azimuth: f64,
    /// Radians above the horizon, negative below.
    pub elevation: f64,
}

/// Where the sun stands at `time`, as seen from `place`.
///
/// # Errors
/// [`SunError::Position`] for years that cannot be computed: the length of a day is not known
/// well enough.
pub fn sun_position(place: &Place, time: Timestamp) -> Result<SunPosition, SunError> {
    let utc = Offset::UTC.to_datetime(time);
    let year = i32::from(utc.year());
    let [month, day, hour, minute] = [utc.month(), utc.day(), utc.hour(), utc.minute()]
        .map(|part| u32::from(part.unsigned_abs()));
    let second = f64::from(utc.second()) + f64::from(utc.subsec_nanosecond()) * 1e-9;
    let Place { latitude_degrees, longitude_degrees } = *place;
    let position = || {
        let delta_t = DeltaT::estimate_from_date(year, month)?;
        let julian = JulianDate::from_utc(year, month, day, hour, minute, second, delta_t)?;
        solar_position_from_julian(julian, latitude_degrees, longitude_degrees, 0.0, None)
    };
    let position = position().map_err(|error: solar_positioning::Error| SunError::Position {
        when: time.to_string(),
        reason: error.to_string(),
    })?;
    Ok(SunPosition {
        azimuth: position.azimuth().to_radians(),
        elevation: position.elevation_angle().to_radians(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_stands_where_the_report_on_the_algorithm_has_it() {
        // The example of NREL/TP-560-34302, in Golden, Colorado; its elevation before refraction.
        let golden = Place::from_degrees(39.742476, -105.1786).unwrap();
        let time = "2003-10-17T12:30:30-07:00".parse().unwrap();
        let position = sun_position(&golden, time).unwrap();
        let [azimuth, elevation] = [position.azimuth, position.elevation].map(f64::to_degrees);
        assert!((azimuth - 194.340_24).abs() < 1e-3, "{azimuth}");
        assert!((elevation - 39.872_05).abs() < 1e-3, "{elevation}");
    }
}
