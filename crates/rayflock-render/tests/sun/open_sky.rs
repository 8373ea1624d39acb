//! Single surfaces, on which nothing throws a shadow.

use glam::Vec3;
use jiff::civil::{Date, date};
use rayflock_geom::{Geometry, GeometryObject, Mesh, ObjectId};
use rayflock_render::sun::{Axis, Bearings, Days, Place, Sampling, Sides, SunError};

use crate::common::{STEP, geometry, ground, hours, square, steps, total};

const MARCH: Date = date(2024, 3, 20);
const JUNE: Date = date(2024, 6, 20);
const DECEMBER: Date = date(2024, 12, 21);
/// The sun's declination at midsummer, in degrees.
const TILT: f64 = 23.44;

/// Hours between sunrise and sunset: the hour angle at which the elevation is 0, twice.
fn day_length(latitude: f64, declination: f64) -> f64 {
    let cos = -latitude.to_radians().tan() * declination.to_radians().tan();
    2.0 * cos.clamp(-1.0, 1.0).acos().to_degrees() / 15.0
}

#[test]
fn a_plate_under_open_sky_is_lit_all_day() {
    let plate = geometry(vec![ground(Vec3::ZERO, 1.0)]);
    for (day, declination) in [(MARCH, 0.0), (JUNE, TILT), (DECEMBER, -TILT)] {
        for latitude in [-75.0, -45.0, 0.0, 35.0, 52.0, 60.0, 80.0] {
            let steps = steps(latitude, day);
            let expected = day_length(latitude, declination);
            for found in hours(&plate, &steps, Sampling::Faces, Sides::Front) {
                assert_eq!(found, total(&steps), "{latitude} on {day}");
                assert!((found - expected).abs() <= STEP, "{latitude}, {day}: {found}, {expected}");
            }
        }
    }
}

#[test]
fn a_wall_is_lit_while_the_sun_is_before_it() {
    // The front looks south, which is +z.
    let wall = geometry(vec![square(Vec3::ZERO, Vec3::X, Vec3::Y, 1.0)]);
    let front = |steps: &[_]| hours(&wall, steps, Sampling::Faces, Sides::Front)[0];

    // At the equinox the sun rises in the east and sets in the west.
    let equinox = steps(50.0, MARCH);
    assert!((front(&equinox) - 12.0).abs() <= STEP, "{}", front(&equinox));

    // At midsummer it passes the line from east to west where cos H = tan(declination) / tan(latitude).
    let midsummer = steps(50.0, JUNE);
    let cos = TILT.to_radians().tan() / 50.0_f64.to_radians().tan();
    let expected = 2.0 * cos.acos().to_degrees() / 15.0;
    assert!((front(&midsummer) - expected).abs() <= STEP, "{}, {expected}", front(&midsummer));

    // Both sides of a sheet together see the sun all day.
    let both = hours(&wall, &midsummer, Sampling::Faces, Sides::Both);
    assert!((both[0] - total(&midsummer)).abs() < 1e-9);
    let back = geometry(vec![square(Vec3::ZERO, -Vec3::X, Vec3::Y, 1.0)]);
    let back = hours(&back, &midsummer, Sampling::Faces, Sides::Front)[0];
    assert!((front(&midsummer) + back - both[0]).abs() < 1e-9);
}

#[test]
fn a_mirrored_wall_keeps_its_front() {
    let wall = square(Vec3::ZERO, Vec3::X, Vec3::Y, 1.0);
    let mirror = glam::Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    let object = GeometryObject::new(ObjectId(0), wall.clone()).with_transform(mirror);
    let mirrored = Geometry::new(vec![object]).unwrap();
    let steps = steps(50.0, DECEMBER);
    let front = |geometry: &_| hours(geometry, &steps, Sampling::Faces, Sides::Front)[0];
    assert!(front(&mirrored) > 5.0);
    assert_eq!(front(&mirrored), front(&geometry(vec![wall])));
}

#[test]
fn the_same_scene_gets_the_same_hours_whatever_axis_points_up() {
    let place = Place::from_degrees(52.5, 13.4).unwrap();
    let north = 0.3;
    let mut found = Vec::new();
    for up in [Axis::X, Axis::Y, Axis::Z] {
        let turn = up.from_y_up();
        let object = |id, mesh: Mesh| GeometryObject::new(ObjectId(id), mesh).with_transform(turn);
        let wall = square(Vec3::new(0.0, 1.0, 1.0), Vec3::X, Vec3::Y, 1.0);
        let scene = vec![object(0, ground(Vec3::ZERO, 1.0)), object(1, wall)];
        let days = Days { step_minutes: 5, ..Days::one(MARCH) };
        let steps = days.sunlit_steps(&place, &Bearings::new(up, north)).unwrap();
        let scene = Geometry::new(scene).unwrap();
        found.push(hours(&scene, &steps, Sampling::Faces, Sides::Front));
    }
    assert!(found[0].iter().all(|hours| *hours > 1.0), "{found:?}");
    assert_eq!(found[0], found[1]);
    assert_eq!(found[1], found[2]);
}

#[test]
fn days_left_out_are_stood_for() {
    let place = Place::from_degrees(48.0, 16.0).unwrap();
    let bearings = Bearings::new(Axis::Y, 0.0);
    let year = Days { last: date(2024, 12, 31), ..Days::one(date(2024, 1, 1)) };
    let sum = |days: Days| total(&days.sunlit_steps(&place, &bearings).unwrap());
    let (all, some) = (sum(year), sum(Days { every: 7, ..year }));
    // Over a year, day and night are of nearly equal length; the northern summer is longer than
    // the winter, by a week.
    assert!((all / 366.0 - 12.05).abs() < 0.02, "{all}");
    assert!((some / all - 1.0).abs() < 0.01, "{some} of {all}");
    assert_eq!((year.day_count(), Days { every: 7, ..year }.sampled_day_count()), (366, 53));
}

#[test]
fn a_part_of_the_day_is_cut_into_equal_steps() {
    let place = Place::from_degrees(0.0, 0.0).unwrap();
    let bearings = Bearings::new(Axis::Y, 0.0);
    // From 9:00 to 9:45 in steps of 10 minutes at most: five of 9 minutes.
    let days = Days { from_minute: 540, to_minute: 585, ..Days::one(MARCH) };
    let steps = days.sunlit_steps(&place, &bearings).unwrap();
    assert_eq!((steps.len(), days.steps_per_day()), (5, 5));
    assert!(steps.iter().zip(0..).all(|(step, idx)| step.seconds == 540.0 && step.step_idx == idx));
    assert_eq!(steps[0].time.to_string(), "2024-03-20T09:04:30Z");
    let offset = jiff::tz::Offset::constant(2);
    let earlier = Days { utc_offset: offset, ..days }.sunlit_steps(&place, &bearings).unwrap();
    assert_eq!(earlier[0].time.to_string(), "2024-03-20T07:04:30Z");
}

#[test]
fn what_is_no_place_and_no_time_is_an_error() {
    let message = |error: SunError| error.to_string();
    let place = |latitude, longitude| Place::from_degrees(latitude, longitude).unwrap_err();
    let expected = "the latitude is 91 degrees, expected -90 to 90";
    assert_eq!(message(place(91.0, 0.0)), expected);
    let expected = "the longitude is NaN degrees, expected -180 to 180";
    assert_eq!(message(place(0.0, f64::NAN)), expected);

    let greenwich = Place::from_degrees(51.5, 0.0).unwrap();
    let bearings = Bearings::new(Axis::Y, 0.0);
    let error = |days: Days| message(days.sunlit_steps(&greenwich, &bearings).unwrap_err());
    let backward = error(Days { last: date(2024, 3, 19), ..Days::one(MARCH) });
    assert_eq!(backward, "the last day, 2024-03-19, lies before the first, 2024-03-20");
    for (from_minute, to_minute) in [(600, 600), (0, 1441)] {
        let message = error(Days { from_minute, to_minute, ..Days::one(MARCH) });
        assert!(message.contains(&format!("minute {from_minute} to minute {to_minute}")));
    }
    assert!(error(Days::one(date(9000, 1, 1))).contains("9000-01-01"));
}
