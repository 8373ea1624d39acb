//! Options of `sun`.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use jiff::civil::Date;
use jiff::tz::Offset;
use rayflock::render::sun::Axis;

use super::{EngineChoice, MotionArguments, TraceArguments, thread_count};
use crate::frames::FrameRange;
use crate::size::Size;

const EXAMPLES: &str = "\
What is computed:
  The day is cut into equal steps, and the sun stands where it does in the middle of each. A face
  is lit while the middle of the sun is above the horizon, the face looks towards it, and nothing
  stands between its centroid and the sun. Refraction by the air, clouds and light from the sky are
  left out. Files: hours at faces or vertices of the scene as it is in its first frame.

Axes:
  With y up, north is -z and east +x; with z up, north is +y and east +x; with x up, north is +z
  and east +y. --north turns the map clockwise as seen from above: with y up, --north 90 makes +x
  north.

A scene that moves:
  It is taken as it is in frame 0. With --frames A..B it moves while the sun does: the hours of
  each day are shared out evenly among the frames, so that frame A is shown first and B last.

Examples:
  rayflock sun house.glb --latitude 52.5 --longitude 13.4 --date 2024-06-21 --utc-offset +2
  rayflock sun house.glb --latitude 52.5 --longitude 13.4 --date 2024-12-21 --picture sun.png
  rayflock sun city.ply --up z --latitude 48.2 --longitude 16.4 --date 2024-01-01 \\
      --until 2024-12-31 --average -o year.ply -o year.npz
  rayflock sun roof.obj --latitude -33.9 --longitude 151.2 --date 2024-06-21 \\
      --from 09:00 --to 15:00 --utc-offset +10 --step 5 --per vertex -o roof.csv
  rayflock sun louvres.glb --latitude 25 --longitude 55 --date 2024-03-20 --frames 0..23

Exit codes: 0 done; 1 the output failed; 2 arguments or input are wrong; 130 stopped by Ctrl-C.";

/// Options of `sun`.
#[derive(Debug, Args)]
#[command(after_help = EXAMPLES)]
pub(crate) struct SunArguments {
    /// A file (.gltf .glb .obj .ply .stl, each also .gz) or builtin:NAME.
    #[arg(value_name = "INPUT")]
    pub(crate) name: String,

    /// Which axis of the scene points up: x, y as in glTF, or z as in most CAD and map data.
    #[arg(long, value_name = "AXIS", default_value_t = Axis::Y)]
    pub(crate) up: Axis,

    /// How far north is turned, in degrees clockwise as seen from above; see Axes below.
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, allow_negative_numbers = true,
          value_parser = parse_north)]
    pub(crate) north: f64,

    /// Where on Earth: degrees north of the equator, negative in the south.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true,
          value_parser = parse_latitude)]
    pub(crate) latitude: f64,

    /// Where on Earth: degrees east of Greenwich, negative in the west.
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true,
          value_parser = parse_longitude)]
    pub(crate) longitude: f64,

    /// The day, or the first one with --until.
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = parse_date)]
    pub(crate) date: Date,

    /// The last day, included.
    #[arg(long, value_name = "YYYY-MM-DD", value_parser = parse_date)]
    pub(crate) until: Option<Date>,

    /// Look at one day of so many; it stands for those left out after it [default: the fewest that
    /// leave no more than 31 days to look at].
    #[arg(long, value_name = "DAYS", value_parser = clap::value_parser!(u16).range(1..=366))]
    pub(crate) every: Option<u16>,

    /// The longest that a step may be, in minutes; steps are equal.
    #[arg(long, value_name = "MINUTES", default_value_t = 10,
          value_parser = clap::value_parser!(u16).range(1..=1440))]
    pub(crate) step: u16,

    /// The time of the day from which on the sun counts.
    #[arg(long, value_name = "HH:MM", default_value = "00:00", value_parser = parse_minute)]
    pub(crate) from: u32,

    /// The time of the day from which on it counts no more.
    #[arg(long, value_name = "HH:MM", default_value = "24:00", value_parser = parse_minute)]
    pub(crate) to: u32,

    /// What the clock is ahead of UTC, in hours: +2, -3:30. It decides when a day begins, and
    /// what --from and --to mean.
    #[arg(long, value_name = "[+-]HH[:MM]", default_value = "+0", allow_hyphen_values = true,
          value_parser = parse_utc_offset)]
    pub(crate) utc_offset: Offset,

    /// Where hours are told: at the centroid of each face, or at each vertex.
    #[arg(long, value_name = "WHAT", default_value = "face")]
    pub(crate) per: Per,

    /// Which sides of a face count: both, whichever the sun is on; or the front alone, from which
    /// its corners run counter-clockwise. For closed bodies this makes no difference.
    #[arg(long, value_name = "WHICH", default_value = "both")]
    pub(crate) sides: SidesArgument,

    /// Tell hours a day, averaged over the days, instead of the sum over all of them.
    #[arg(long)]
    pub(crate) average: bool,

    /// Frames to share out over each day, both ends included, counted from 0: `A..B`, or `A` for
    /// a scene at rest [default: 0].
    #[arg(long, value_name = "A..B")]
    pub(crate) frames: Option<FrameRange>,

    /// How the scene moves.
    #[command(flatten)]
    pub(crate) motion: MotionArguments,

    /// What traces the rays.
    #[command(flatten)]
    pub(crate) engine: EngineChoice,

    /// Threads to work with; they never change the hours [default: one a core].
    #[arg(long, value_name = "N", value_parser = thread_count())]
    pub(crate) threads: Option<u16>,

    /// Where the hours go, by extension: .ply, a mesh with the property sun_hours and colours;
    /// .npz, arrays for NumPy; .csv, a table of points and hours. May be given several times.
    #[arg(short, long, value_name = "PATH")]
    pub(crate) output: Vec<PathBuf>,

    /// Draw the hours in false colours, with a colour bar, to a .png file.
    #[arg(long, value_name = "FILE.png")]
    pub(crate) picture: Option<PathBuf>,

    /// Size of the picture in pixels, colour bar included.
    #[arg(long, value_name = "WxH", default_value = "640x360")]
    pub(crate) size: Size,

    /// The camera of the picture, by name [default: the scene's first, else one that frames the
    /// whole motion].
    #[arg(long, value_name = "NAME")]
    pub(crate) camera: Option<String>,

    /// Where the profile goes.
    #[command(flatten)]
    pub(crate) trace: TraceArguments,
}

/// Where hours are told.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Per {
    /// At centroids.
    Face,
    /// At vertices.
    Vertex,
}

/// Which sides of a face count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SidesArgument {
    /// Whichever the sun is on.
    Both,
    /// Where the normal points.
    Front,
}

fn parse_latitude(text: &str) -> Result<f64, String> {
    parse_degrees(text, 90.0, "52.5")
}

fn parse_longitude(text: &str) -> Result<f64, String> {
    parse_degrees(text, 180.0, "13.4")
}

fn parse_north(text: &str) -> Result<f64, String> {
    parse_degrees(text, 360.0, "15")
}

fn parse_degrees(text: &str, limit: f64, example: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(degrees) if degrees.abs() <= limit => Ok(degrees),
        _ => Err(format!("expected degrees from -{limit} to {limit}, such as {example}")),
    }
}

fn parse_date(text: &str) -> Result<Date, String> {
    text.parse().map_err(|_| "expected a date, such as 2024-06-21".to_owned())
}

/// The minute of the day of a time from 00:00 to 24:00.
fn parse_minute(text: &str) -> Result<u32, String> {
    parse_clock(text)
        .filter(|minute| *minute <= 24 * 60)
        .ok_or_else(|| "expected a time from 00:00 to 24:00, such as 09:30".to_owned())
}

/// The minutes of `H:MM` or `HH:MM`.
fn parse_clock(text: &str) -> Option<u32> {
    let (hours, minutes) = text.split_once(':')?;
    let number = |digits: &str| {
        let is_number =
            (1..=2).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_digit());
        digits.parse::<u32>().ok().filter(|_| is_number)
    };
    let minutes = number(minutes).filter(|found| *found < 60 && minutes.len() == 2)?;
    Some(number(hours)? * 60 + minutes)
}

fn parse_utc_offset(text: &str) -> Result<Offset, String> {
    let parse = || {
        let (sign, clock) = match text.strip_prefix('-') {
            Some(clock) => (-1, clock),
            None => (1, text.strip_prefix('+').unwrap_or(text)),
        };
        let minutes = match clock.contains(':') {
            true => parse_clock(clock)?,
            false => parse_clock(&format!("{clock}:00"))?,
        };
        let seconds = sign * i32::try_from(minutes).ok()? * 60;
        Offset::from_seconds(seconds).ok().filter(|_| minutes <= 14 * 60)
    };
    parse().ok_or_else(|| "expected hours from -14 to +14, such as +2 or -3:30".to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_of_the_day_run_to_its_end() {
        assert_eq!(parse_minute("00:00"), Ok(0));
        assert_eq!(parse_minute("9:30"), Ok(570));
        assert_eq!(parse_minute("24:00"), Ok(1440));
        for text in ["24:01", "12:60", "12", "12:5", ":30", "-1:00", "+1:00", "1:00:00", "x"] {
            let message = parse_minute(text).unwrap_err();
            assert!(message.contains("09:30"), "{text}: {message}");
        }
    }

    #[test]
    fn offsets_have_a_sign_and_perhaps_minutes() {
        let offset = |hours: i32, minutes: i32| Offset::from_seconds((hours * 60 + minutes) * 60);
        assert_eq!(parse_utc_offset("+2"), Ok(offset(2, 0).unwrap()));
        assert_eq!(parse_utc_offset("2"), Ok(offset(2, 0).unwrap()));
        assert_eq!(parse_utc_offset("-3:30"), Ok(offset(-3, -30).unwrap()));
        assert_eq!(parse_utc_offset("+05:45"), Ok(offset(5, 45).unwrap()));
        for text in ["", "+", "--2", "+15", "-14:01", "UTC", "2.5", "+1:7"] {
            let message = parse_utc_offset(text).unwrap_err();
            assert!(message.contains("+2 or -3:30"), "{text}: {message}");
        }
    }

    #[test]
    fn angles_stay_on_earth() {
        assert_eq!(parse_latitude("-90"), Ok(-90.0));
        assert_eq!(parse_longitude("180"), Ok(180.0));
        for text in ["90.001", "nan", "inf", "52N", ""] {
            assert!(parse_latitude(text).unwrap_err().contains("from -90 to 90"), "{text}");
        }
        assert!(parse_longitude("-181").unwrap_err().contains("from -180 to 180"));
    }

    #[test]
    fn dates_are_of_the_calendar() {
        assert_eq!(parse_date("2024-02-29"), Ok(jiff::civil::date(2024, 2, 29)));
        for text in ["2023-02-29", "21.6.2024", "2024-6-21", "midsummer"] {
            assert!(parse_date(text).unwrap_err().contains("2024-06-21"), "{text}");
        }
    }
}
