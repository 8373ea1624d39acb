//! Whose fault an error is, and the exit code that says so.
//!
//! | Code | Meaning |
//! |---|---|
//! | 0 | done |
//! | 1 | the output, the device or the program itself failed |
//! | 2 | the arguments or the input are wrong |
//! | 130 | stopped by Ctrl-C; `--resume` goes on |

use anyhow::Error;

use crate::terminal;

/// The output, the device or the program itself failed.
const OUTPUT: u8 = 1;
/// The arguments or the input are wrong.
pub(crate) const INPUT: u8 = 2;
/// Stopped by Ctrl-C, as shells expect it.
pub(crate) const INTERRUPTED: u8 = 130;

/// Why a command did not do what it was asked.
#[derive(Debug)]
pub(crate) enum Failure {
    /// The arguments or the input are wrong.
    Input(Error),
    /// The output cannot be written, or something beneath the program failed.
    Output(Error),
    /// Ctrl-C; the text says how to go on.
    Interrupted(String),
}

impl Failure {
    /// Tells the user on standard error and returns the exit code.
    pub(crate) fn report(&self) -> u8 {
        match self {
            Self::Input(error) | Self::Output(error) => {
                terminal::say(format_args!("error: {error:#}"));
            }
            Self::Interrupted(how_to_resume) => terminal::say(format_args!("{how_to_resume}")),
        }
        match self {
            Self::Input(_) => INPUT,
            Self::Output(_) => OUTPUT,
            Self::Interrupted(_) => INTERRUPTED,
        }
    }
}

/// Turns an error into a [`Failure`]; there is no `From`, so every `?` decides whose fault it is.
pub(crate) trait Blame<T> {
    /// The arguments or the input are wrong.
    fn blame_input(self) -> Result<T, Failure>;

    /// The output cannot be written, or something beneath the program failed.
    fn blame_output(self) -> Result<T, Failure>;
}

impl<T, E: Into<Error>> Blame<T> for Result<T, E> {
    fn blame_input(self) -> Result<T, Failure> {
        self.map_err(|error| Failure::Input(error.into()))
    }

    fn blame_output(self) -> Result<T, Failure> {
        self.map_err(|error| Failure::Output(error.into()))
    }
}
