//! What the header of a cache says.

use std::fs::File;
use std::io::Read;

use crate::ImportError;
use crate::job::{self, Job};

/// Bytes of a position.
const POSITION_SIZE: u64 = 12;

/// Where the positions of each sample are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Header {
    pub(super) point_count: usize,
    pub(super) sample_count: usize,
    /// Bytes before the first sample.
    pub(super) start: u64,
    pub(super) is_big_endian: bool,
    /// Samples a second, if the file says so.
    pub(super) frame_rate: Option<f64>,
}

impl Header {
    /// Bytes of a sample.
    pub(super) fn sample_size(&self) -> u64 {
        self.point_count as u64 * POSITION_SIZE
    }

    /// The header of a PC2 file.
    pub(super) fn pc2(job: &mut Job<'_>) -> Result<Self, ImportError> {
        let (mut file, size) = open(job)?;
        let mut bytes = [0; 32];
        read(&mut file, &mut bytes, job)?;
        let (magic, numbers) = bytes.split_at(12);
        if magic != b"POINTCACHE2\0" {
            let found = format!("\"{}\"", String::from_utf8_lossy(magic));
            return Err(job.invalid("header", found, "\"POINTCACHE2\""));
        }
        let word = |idx: usize| -> [u8; 4] { numbers.as_chunks().0[idx] };
        let version = i32::from_le_bytes(word(0));
        if version != 1 {
            return Err(job.invalid("header", format!("version {version}"), "version 1"));
        }
        let point_count = count("points", i32::from_le_bytes(word(1)), job)?;
        let sample_count = count("samples", i32::from_le_bytes(word(4)), job)?;
        let frames_a_sample = f32::from_le_bytes(word(3));
        if frames_a_sample != 1.0 {
            let message = format!("{frames_a_sample} frames a sample are stated; one is shown");
            job.warn("header", message);
        }
        let (start, frame_rate) = (bytes.len() as u64, None);
        let header = Self { point_count, sample_count, start, is_big_endian: false, frame_rate };
        header.check_size(size, job)?;
        Ok(header)
    }

    /// The header of an MDD file.
    pub(super) fn mdd(job: &mut Job<'_>) -> Result<Self, ImportError> {
        let (mut file, size) = open(job)?;
        let mut bytes = [0; 8];
        read(&mut file, &mut bytes, job)?;
        let [samples, points]: [[u8; 4]; 2] = [bytes.as_chunks().0[0], bytes.as_chunks().0[1]];
        let point_count = count("points", i32::from_be_bytes(points), job)?;
        let sample_count = count("samples", i32::from_be_bytes(samples), job)?;
        let start = bytes.len() as u64 + 4 * sample_count as u64;
        let mut header =
            Self { point_count, sample_count, start, is_big_endian: true, frame_rate: None };
        header.check_size(size, job)?;
        let mut times = vec![0; 4 * sample_count];
        read(&mut file, &mut times, job)?;
        let times: Vec<f32> = times.as_chunks().0.iter().map(|&t| f32::from_be_bytes(t)).collect();
        header.frame_rate = frame_rate(&times, job);
        Ok(header)
    }

    /// Refuses a file that is too short for what its header says.
    fn check_size(&self, size: u64, job: &mut Job<'_>) -> Result<(), ImportError> {
        let positions = u128::from(self.sample_size()) * self.sample_count as u128;
        let needed = u128::from(self.start) + positions;
        let contents = format!("{} samples of {} points", self.sample_count, self.point_count);
        if u128::from(size) < needed {
            let expected = format!("{needed} bytes for {contents}");
            return Err(job.invalid("header", format!("a file of {size} bytes"), expected));
        }
        if u128::from(size) > needed {
            let message = format!("{} bytes follow the {contents}", u128::from(size) - needed);
            job.warn("end of file", message);
        }
        Ok(())
    }
}

/// The file of a job and its size.
fn open(job: &Job<'_>) -> Result<(File, u64), ImportError> {
    let io = |reason| ImportError::Io { file: job.file.to_owned(), reason };
    job::check_file(job.file).map_err(io)?;
    let opened = File::open(job.file).and_then(|file| file.metadata().map(|data| (file, data)));
    let (file, metadata) = opened.map_err(|error| io(error.to_string()))?;
    Ok((file, metadata.len()))
}

fn read(file: &mut File, bytes: &mut [u8], job: &Job<'_>) -> Result<(), ImportError> {
    let expected = format!("{} bytes more", bytes.len());
    file.read_exact(bytes).map_err(|error| job.invalid("header", error.to_string(), expected))
}

/// A count that is stated as a signed number.
fn count(what: &str, stated: i32, job: &Job<'_>) -> Result<usize, ImportError> {
    let count = usize::try_from(stated).ok().filter(|&count| count > 0);
    count.ok_or_else(|| job.invalid("header", format!("{stated} {what}"), "one at least"))
}

/// Samples a second, where they are evenly apart.
fn frame_rate(times: &[f32], job: &mut Job<'_>) -> Option<f64> {
    let [first, .., last] = times else { return None };
    let step = f64::from(last - first) / (times.len() - 1) as f64;
    let is_near = |(idx, time): (usize, &f32)| {
        let expected = f64::from(*first) + idx as f64 * step;
        (f64::from(*time) - expected).abs() <= 0.01 * step
    };
    let rate = 1.0 / step;
    if rate.is_finite() && rate > 0.0 && times.iter().enumerate().all(is_near) {
        // Times are rounded; rates are mostly whole.
        let whole = rate.round();
        return Some(if (rate - whole).abs() < 1e-3 * rate { whole } else { rate });
    }
    job.warn("times", "they are not evenly apart; samples are shown as frames, one each");
    None
}
