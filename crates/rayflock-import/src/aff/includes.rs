//! Files that AFF files include: found, read once, and kept from running away.
//!
//! Names are relative to the folder of the file that was asked for, whichever file has them, as in
//! BART's parser. Reading each file once costs no more than the files hold. Including them again
//! and again does, so the bytes that are gone through more than once are limited, and so is how
//! often and how deep files include each other.

use std::collections::HashMap;
use std::path::PathBuf;
use std::sync::Arc;

use super::reader::Reader;
use crate::job::Job;
use crate::{ImportError, gz};

/// Bytes of files that are included again: 256 MiB.
const REPEATED_LIMIT: usize = 256 << 20;
/// How often files may be included.
const COUNT_LIMIT: usize = 1 << 16;
/// How many files may be open inside each other.
const DEPTH_LIMIT: usize = 64;

/// The files that have been included.
#[derive(Debug, Default)]
pub(super) struct Includes {
    contents: HashMap<PathBuf, Arc<[u8]>>,
    /// The files that are being read, each inside the one before.
    open: Vec<PathBuf>,
    count: usize,
    repeated_size: usize,
}

impl Includes {
    /// The first file, which all others are included by.
    pub(super) fn new(job: &Job<'_>) -> Self {
        Self { open: vec![job.file.to_owned()], ..Self::default() }
    }

    /// How many files have been included.
    pub(super) fn count(&self) -> usize {
        self.count
    }

    /// Begins with a file; [`close`](Self::close) has to follow.
    pub(super) fn open(
        &mut self,
        name: &str,
        reader: &Reader<'_>,
        job: &Job<'_>,
    ) -> Result<Arc<[u8]>, ImportError> {
        let expected = "an AFF file in the folder of the one that was asked for";
        let path = job.neighbour(name).map_err(|found| reader.invalid(found, expected))?;
        if self.open.contains(&path) {
            let found = format!("\"{name}\", which is being read");
            return Err(reader.invalid(found, "a file that does not include itself"));
        }
        self.count += 1;
        if self.open.len() > DEPTH_LIMIT || self.count > COUNT_LIMIT {
            let found = format!("inclusion {} at depth {}", self.count, self.open.len());
            return Err(too_large(reader, job, found, limits()));
        }
        let content = match self.contents.get(&path) {
            Some(content) => {
                self.repeated_size += content.len();
                Arc::clone(content)
            }
            None => {
                let bytes = job.read_neighbour(name);
                let bytes = bytes.map_err(|found| reader.invalid(found, expected))?;
                let is_compressed = path.extension().is_some_and(|extension| extension == "gz");
                let bytes = if is_compressed { gz::decompress(&path, &bytes)? } else { bytes };
                let content: Arc<[u8]> = bytes.into();
                self.contents.insert(path.clone(), Arc::clone(&content));
                content
            }
        };
        if self.repeated_size > REPEATED_LIMIT {
            let found = format!("{} bytes of files included again", self.repeated_size);
            return Err(too_large(reader, job, found, format!("{REPEATED_LIMIT} bytes")));
        }
        self.open.push(path);
        Ok(content)
    }

    /// Ends the file that was opened last.
    pub(super) fn close(&mut self) {
        self.open.pop();
    }
}

fn limits() -> String {
    format!("{COUNT_LIMIT} inclusions, {DEPTH_LIMIT} deep")
}

/// What would take more room or time than a file of its size may ask for.
pub(super) fn too_large(
    reader: &Reader<'_>,
    job: &Job<'_>,
    found: String,
    limit: String,
) -> ImportError {
    ImportError::TooLarge { file: job.file.to_owned(), element: reader.element(), found, limit }
}
