//! The sun's directions of some days, step by step.

use glam::Vec3;
use jiff::civil::Date;
use jiff::tz::Offset;
use jiff::{SignedDuration, Timestamp, ToSpan};

use super::{Bearings, Place, SunError, sun_position};

/// Minutes of a day.
const DAY_MINUTES: u32 = 24 * 60;
/// Minutes of a step where none are given.
const DEFAULT_STEP_MINUTES: u32 = 10;
const NANOSECONDS_PER_MINUTE: i64 = 60_000_000_000;
const HOURS_PER_DAY: i64 = 24;

/// Which days, which hours of them, and how finely they are cut.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Days {
    /// The first day.
    pub first: Date,
    /// The last day, which is included.
    pub last: Date,
    /// Days from one that is looked at to the next; 0 counts as 1. A day stands for itself and
    /// for those that are left out after it.
    pub every: u16,
    /// The minute of the day from which on the sun counts.
    pub from_minute: u32,
    /// The minute of the day from which on it counts no more; 1440 is the end of the day.
    pub to_minute: u32,
    /// The longest that a step may be, in minutes; 0 counts as 1. A day has as few equal steps as
    /// that allows.
    pub step_minutes: u32,
    /// What the clock is ahead of UTC.
    pub utc_offset: Offset,
}

/// Some minutes of a day in which the sun is above the horizon.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SunStep {
    /// The middle of the step.
    pub time: Timestamp,
    /// Which step of its day, counted from 0; less than [`Days::steps_per_day`].
    pub step_idx: u32,
    /// Direction towards the sun, of unit length, in world space.
    pub to_sun: Vec3,
    /// How long the step is, times the days that its day stands for.
    pub seconds: f64,
}

impl Days {
    /// One whole day by UTC, in steps of ten minutes.
    pub const fn one(date: Date) -> Self {
        Self {
            first: date,
            last: date,
            every: 1,
            from_minute: 0,
            to_minute: DAY_MINUTES,
            step_minutes: DEFAULT_STEP_MINUTES,
            utc_offset: Offset::UTC,
        }
    }

    /// Number of days from the first to the last, those left out included; 0 where the last lies
    /// before the first.
    pub fn day_count(&self) -> u32 {
        let hours = self.last.duration_since(self.first).as_hours();
        u32::try_from(hours / HOURS_PER_DAY + 1).unwrap_or(0)
    }

    /// Number of days that are looked at.
    pub fn sampled_day_count(&self) -> u32 {
        self.day_count().div_ceil(u32::from(self.every.max(1)))
    }

    /// Number of steps of each day; 0 where its hours are none.
    pub fn steps_per_day(&self) -> u32 {
        self.to_minute.saturating_sub(self.from_minute).div_ceil(self.step_minutes.max(1))
    }

    /// The steps in which the middle of the sun is above the horizon, in the order of time.
    ///
    /// # Errors
    /// [`SunError::Dates`] and [`SunError::Hours`] where there is no day or no hour, and
    /// [`SunError::Position`] for years that cannot be computed.
    pub fn sunlit_steps(
        &self,
        place: &Place,
        bearings: &Bearings,
    ) -> Result<Vec<SunStep>, SunError> {
        self.check()?;
        let every = self.every.max(1);
        let dates = self.first.series(i32::from(every).days());
        let mut steps = Vec::new();
        let mut days_left = self.day_count();
        for date in dates.take_while(|date| *date <= self.last) {
            let stands_for = days_left.min(u32::from(every));
            days_left -= stands_for;
            self.add_steps(date, stands_for, place, bearings, &mut steps)?;
        }
        Ok(steps)
    }

    fn check(&self) -> Result<(), SunError> {
        if self.last < self.first {
            return Err(SunError::Dates { first: self.first, last: self.last });
        }
        if self.from_minute >= self.to_minute || self.to_minute > DAY_MINUTES {
            return Err(SunError::Hours { from: self.from_minute, to: self.to_minute });
        }
        Ok(())
    }

    /// Appends the steps of one day.
    fn add_steps(
        &self,
        date: Date,
        stands_for: u32,
        place: &Place,
        bearings: &Bearings,
        steps: &mut Vec<SunStep>,
    ) -> Result<(), SunError> {
        let window_minutes = self.to_minute - self.from_minute;
        let step_count = self.steps_per_day();
        let step_seconds = f64::from(window_minutes) * 60.0 / f64::from(step_count);
        for step_idx in 0..step_count {
            let time = self.middle(date, step_idx)?;
            let position = sun_position(place, time)?;
            if position.elevation > 0.0 {
                let to_sun = bearings.to_sun(&position);
                let seconds = step_seconds * f64::from(stands_for);
                steps.push(SunStep { time, step_idx, to_sun, seconds });
            }
        }
        Ok(())
    }

    /// The middle of a step.
    fn middle(&self, date: Date, step_idx: u32) -> Result<Timestamp, SunError> {
        let window = i64::from(self.to_minute - self.from_minute) * NANOSECONDS_PER_MINUTE;
        let halves = 2 * i64::from(self.steps_per_day());
        // At most 8.64e13 ns times 2880 halves of minutes: far from the end of the type.
        let into_window = window * (2 * i64::from(step_idx) + 1) / halves;
        let into_day = i64::from(self.from_minute) * NANOSECONDS_PER_MINUTE + into_window;
        let midnight = self.utc_offset.to_timestamp(date.at(0, 0, 0, 0));
        let time = midnight.and_then(|time| time.checked_add(SignedDuration::from_nanos(into_day)));
        time.map_err(|error| SunError::Position {
            when: date.to_string(),
            reason: error.to_string(),
        })
    }
}
