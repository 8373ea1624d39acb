//! Where the reading of a legacy file stands.

use crate::ImportError;
use crate::job::Job;
use crate::vtk::numbers::{ByteOrder, Number, Scalar};

/// How arrays are written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    /// With the first byte in front.
    Binary,
}

/// The rest of a file.
#[derive(Clone, Debug)]
pub(super) struct Cursor<'a> {
    bytes: &'a [u8],
    at: usize,
    pub(super) encoding: Encoding,
}

impl<'a> Cursor<'a> {
    /// The whole file.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0, encoding: Encoding::Ascii }
    }

    /// What is left.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at..]
    }

    /// The place for a message about `element`.
    pub(super) fn place(&self, element: &str) -> String {
        format!("{element}, byte {}", self.at)
    }

    /// The next line with the space around it taken away; empty at the end.
    pub(super) fn line(&mut self) -> String {
        let rest = self.rest();
        let end = rest.iter().position(|&byte| byte == b'\n');
        self.at += end.map_or(rest.len(), |end| end + 1);
        let line = &rest[..end.unwrap_or(rest.len())];
        String::from_utf8_lossy(line.trim_ascii()).into_owned()
    }

    /// The next line that is not blank; `None` at the end.
    pub(super) fn statement(&mut self) -> Option<String> {
        self.skip_space();
        (!self.rest().is_empty()).then(|| self.line())
    }

    /// Whether the next word is this one, in any case.
    pub(super) fn is_next(&self, word: &str) -> bool {
        let rest = self.rest().trim_ascii_start();
        rest.get(..word.len()).is_some_and(|start| start.eq_ignore_ascii_case(word.as_bytes()))
    }

    /// The next `count` numbers of an array that `element` names.
    pub(super) fn numbers<T: Number>(
        &mut self,
        element: &str,
        count: usize,
        scalar: Scalar,
        job: &Job<'_>,
    ) -> Result<Vec<T>, ImportError> {
        self.check_room(element, count, scalar, job)?;
        if self.encoding == Encoding::Ascii {
            return (0..count).map(|_| self.number(element, job)).collect();
        }
        let size = scalar.size();
        let payload = &self.rest()[..count * size];
        let number = |bytes| T::from_bytes(bytes, scalar, ByteOrder::Big);
        let numbers = payload.chunks_exact(size).map(number).collect::<Option<Vec<T>>>();
        let numbers = numbers
            .ok_or_else(|| job.invalid(self.place(element), "a number of another type", T::NAME))?;
        self.at += payload.len();
        Ok(numbers)
    }

    /// Passes over an array.
    pub(super) fn skip(
        &mut self,
        element: &str,
        count: usize,
        scalar: Scalar,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        self.check_room(element, count, scalar, job)?;
        if self.encoding == Encoding::Binary {
            self.at += count * scalar.size();
            return Ok(());
        }
        (0..count).try_for_each(|_| self.number::<f32>(element, job).map(|_| ()))
    }

    /// Refuses a count that the rest of the file is too short for.
    fn check_room(
        &self,
        element: &str,
        count: usize,
        scalar: Scalar,
        job: &Job<'_>,
    ) -> Result<(), ImportError> {
        let left = self.rest().len();
        let held = match self.encoding {
            // A digit and a space; the last may lack its space.
            Encoding::Ascii => left.div_ceil(2),
            Encoding::Binary => left / scalar.size(),
        };
        if count <= held {
            return Ok(());
        }
        let found = format!("a count of {count} numbers");
        let expected = format!("what fits in the {left} bytes that are left");
        Err(job.invalid(self.place(element), found, expected))
    }

    /// The next word as a number.
    fn number<T: Number>(&mut self, element: &str, job: &Job<'_>) -> Result<T, ImportError> {
        self.skip_space();
        let rest = self.rest();
        let end = rest.iter().position(u8::is_ascii_whitespace).unwrap_or(rest.len());
        let word = std::str::from_utf8(&rest[..end]).unwrap_or_default();
        let number = word.parse::<T>().map_err(|_| {
            let word = String::from_utf8_lossy(&rest[..end.min(40)]);
            job.invalid(self.place(element), format!("\"{word}\""), T::NAME)
        })?;
        self.at += end;
        Ok(number)
    }

    fn skip_space(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_ascii_start().len();
    }
}
