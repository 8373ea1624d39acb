//! MP4 by way of the program ffmpeg, to which raw frames are piped.
//!
//! Time stamps and encoder names are left out of the file, so equal frames give equal files. The
//! common pixel format needs even edges; an odd edge is padded with a black line.

use std::io::{ErrorKind, Read, Write};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;

use anyhow::{Context, Result, anyhow, bail, ensure};

use super::film::Reel;

const MISSING: &str = "writing MP4 needs the program ffmpeg, which was not found; install the \
                       package ffmpeg (apt-get install ffmpeg, brew install ffmpeg) or choose \
                       .webp or .gif";

/// Finds out whether ffmpeg can be run.
pub(super) fn check_available() -> Result<()> {
    let probe =
        Command::new("ffmpeg").arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).status();
    match probe {
        Ok(status) if status.success() => Ok(()),
        Ok(status) => bail!("ffmpeg is installed but does not run ({status})"),
        Err(error) if error.kind() == ErrorKind::NotFound => bail!(MISSING),
        Err(error) => Err(error).context("ffmpeg is installed but does not run"),
    }
}

/// Writes an H.264 film.
pub(super) fn write(path: &Path, reel: &Reel<'_>) -> Result<()> {
    let mut ffmpeg = command(path, reel).spawn().context("cannot start ffmpeg")?;
    let complaint = collect_complaint(&mut ffmpeg);
    let fed = feed(&mut ffmpeg, reel);
    if fed.is_err() {
        // ffmpeg may wait for more frames; whether it is gone already does not matter.
        let _ = ffmpeg.kill();
    }
    let status = ffmpeg.wait()?;
    let complaint = complaint.join().unwrap_or_default();
    match fed {
        // A broken pipe only says that ffmpeg has ended; it has said why.
        Err(error) if complaint.is_empty() => Err(error),
        _ => {
            ensure!(status.success() && fed.is_ok(), "ffmpeg failed: {}", complaint.trim());
            Ok(())
        }
    }
}

fn command(path: &Path, reel: &Reel<'_>) -> Command {
    let mut command = Command::new("ffmpeg");
    command
        .args(["-hide_banner", "-loglevel", "error", "-nostdin", "-y"])
        .args(["-f", "rawvideo", "-pix_fmt", "rgb24"])
        .args(["-video_size", &reel.size.to_string(), "-framerate", &reel.fps.to_string()])
        .args(["-i", "pipe:0"])
        .args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2", "-pix_fmt", "yuv420p"])
        .args(["-c:v", "libx264", "-crf", "18", "-movflags", "+faststart"])
        .args(["-fflags", "+bitexact", "-flags:v", "+bitexact", "-map_metadata", "-1"])
        .args(["-f", "mp4"])
        .arg(path);
    command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
    command
}

/// Pipes all frames and closes the pipe.
fn feed(ffmpeg: &mut Child, reel: &Reel<'_>) -> Result<()> {
    let mut pipe = ffmpeg.stdin.take().ok_or_else(|| anyhow!("ffmpeg has no standard input"))?;
    for frame in &reel.frames {
        pipe.write_all(&reel.load(frame)?).context("ffmpeg ended early")?;
    }
    Ok(())
}

/// Reads what ffmpeg says, beside feeding it, so that neither waits for the other.
fn collect_complaint(ffmpeg: &mut Child) -> thread::JoinHandle<String> {
    let stderr = ffmpeg.stderr.take();
    thread::spawn(move || {
        let mut complaint = Vec::new();
        if let Some(mut stderr) = stderr {
            // What was read before a failure is all there is to tell.
            let _ = stderr.read_to_end(&mut complaint);
        }
        String::from_utf8_lossy(&complaint).into_owned()
    })
}
