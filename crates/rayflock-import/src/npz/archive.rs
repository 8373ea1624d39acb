//! The zip file around arrays, and arrays as numbers.

use std::io::{Cursor, Read};
use std::ops::Range;

use ndarray::ArrayViewD;
use ndarray_npy::{ViewElement, ViewNpyError, ViewNpyExt};
use zip::ZipArchive;

use crate::ImportError;
use crate::gz;
use crate::job::Job;

/// The bytes before the text that describes an array: a mark, a version, the length of the text.
const MAGIC: &[u8] = b"\x93NUMPY";
/// Bytes of that text; those of plain arrays have about a hundred.
const TEXT_LIMIT: usize = 4096;
/// Brackets in it, and how deep they may stand in each other: the parser descends into each, more
/// than once a level where what follows is broken. Those of records stand three deep.
const BRACKET_LIMIT: usize = 32;
const NESTING_LIMIT: usize = 3;

/// A `.npz` file.
#[derive(Debug)]
pub(super) struct Archive<'a> {
    zip: ZipArchive<Cursor<&'a [u8]>>,
    /// Bytes that arrays may still unfold to.
    bytes_left: u64,
}

/// An array of a file, as its bytes.
#[derive(Debug)]
pub(super) struct Array {
    name: String,
    /// The content of the `.npy` file, so placed that its numbers are aligned for all types.
    words: Vec<u64>,
    /// Where in these words, in bytes.
    content: Range<usize>,
}

/// Numbers in rows: the last index varies fastest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Numbers<T> {
    pub(super) values: Vec<T>,
    pub(super) shape: Vec<usize>,
}

impl<'a> Archive<'a> {
    /// The file of this content.
    pub(super) fn open(bytes: &'a [u8], job: &Job<'_>) -> Result<Self, ImportError> {
        let bytes_left = gz::output_limit(bytes.len());
        let zip = ZipArchive::new(Cursor::new(bytes))
            .map_err(|error| job.invalid("zip", error.to_string(), "a whole .npz file"))?;
        Ok(Self { zip, bytes_left })
    }

    /// The names of all arrays, in order.
    pub(super) fn names(&self) -> Vec<String> {
        let name = |name: &str| name.strip_suffix(".npy").unwrap_or(name).to_owned();
        let mut names: Vec<String> = self.zip.file_names().map(name).collect();
        names.sort();
        names
    }

    /// The array of this name, if there is one.
    pub(super) fn get(&mut self, name: &str, job: &Job<'_>) -> Result<Option<Array>, ImportError> {
        let damaged =
            |found: String| job.invalid(format!("array \"{name}\""), found, "a whole .npy file");
        let file_name = format!("{name}.npy");
        let Some(idx) = self.zip.index_for_name(&file_name) else { return Ok(None) };
        let entry = self.zip.by_index(idx).map_err(|error| damaged(error.to_string()))?;
        let mut bytes = Vec::new();
        entry
            .take(self.bytes_left + 1)
            .read_to_end(&mut bytes)
            .map_err(|error| damaged(error.to_string()))?;
        let Some(bytes_left) = self.bytes_left.checked_sub(bytes.len() as u64) else {
            return Err(ImportError::TooLarge {
                file: job.file.to_owned(),
                element: format!("array \"{name}\""),
                found: format!("more than {} bytes", self.bytes_left),
                limit: "what a file of this size may unfold to".to_owned(),
            });
        };
        self.bytes_left = bytes_left;
        let text_end = check_text(&bytes).map_err(damaged)?;
        Ok(Some(Array::new(name, &bytes, text_end)))
    }
}

/// Checks the text that describes an array as far as its parser relies on it; tells where it ends.
fn check_text(bytes: &[u8]) -> Result<usize, String> {
    let version = bytes.strip_prefix(MAGIC).ok_or("no NumPy array")?;
    let length = match version {
        [1, _, low, high, ..] => usize::from(u16::from_le_bytes([*low, *high])),
        [2 | 3, _, a, b, c, d, ..] => u32::from_le_bytes([*a, *b, *c, *d]) as usize,
        _ => return Err("an unknown version".to_owned()),
    };
    if length > TEXT_LIMIT {
        return Err(format!("a description of {length} bytes"));
    }
    // Behind the version and the length itself.
    let start = if version[0] == 1 { 4 } else { 6 };
    let text = version.get(start..start + length).ok_or("the end of the array")?;
    check_brackets(text)?;
    check_shape(&String::from_utf8_lossy(text))?;
    Ok(MAGIC.len() + start + length)
}

/// Checks that brackets are few, and do not stand deep in each other.
fn check_brackets(text: &[u8]) -> Result<(), String> {
    let (mut count, mut open, mut deepest) = (0, 0_usize, 0);
    for byte in text {
        match byte {
            b'(' | b'[' | b'{' => (count, open) = (count + 1, open + 1),
            b')' | b']' | b'}' => open = open.saturating_sub(1),
            _ => {}
        }
        deepest = deepest.max(open);
    }
    match (count, deepest) {
        (..=BRACKET_LIMIT, ..=NESTING_LIMIT) => Ok(()),
        (..=BRACKET_LIMIT, _) => Err(format!("a description with brackets {deepest} deep")),
        _ => Err(format!("a description with {count} brackets")),
    }
}

/// Checks that the lengths of all axes can be multiplied, even where one is 0: the reader panics
/// otherwise.
fn check_shape(text: &str) -> Result<(), String> {
    let shape = text.split_once("shape").filter(|(_, behind)| !behind.contains("shape"));
    let shape = shape.and_then(|(_, behind)| behind.split_once('(')?.1.split_once(')'));
    let (shape, _) = shape.ok_or_else(|| format!("the description \"{}\"", text.trim()))?;
    let lengths = shape.split(',').map(str::trim).filter(|word| !word.is_empty());
    let product =
        lengths.map(|word| word.parse::<usize>().ok()).try_fold(1_usize, |product, length| {
            product.checked_mul(length?.max(1)).filter(|&product| product <= isize::MAX as usize)
        });
    product.map(|_| ()).ok_or_else(|| format!("the shape ({shape})"))
}

impl Array {
    fn new(name: &str, bytes: &[u8], text_end: usize) -> Self {
        let start = text_end.next_multiple_of(size_of::<u64>()) - text_end;
        let content = start..start + bytes.len();
        let mut words = vec![0_u64; content.end.div_ceil(size_of::<u64>())];
        bytemuck::cast_slice_mut(&mut words)[content.clone()].copy_from_slice(bytes);
        Self { name: name.to_owned(), words, content }
    }

    fn bytes(&self) -> &[u8] {
        &bytemuck::cast_slice(&self.words)[self.content.clone()]
    }

    /// The numbers, whatever their type, rounded to double precision.
    pub(super) fn numbers(&self, job: &Job<'_>) -> Result<Numbers<f64>, ImportError> {
        if let Some(numbers) = self.view(|value: f64| Some(value), job)? {
            return Ok(numbers);
        }
        if let Some(numbers) = self.view(|value: f32| Some(f64::from(value)), job)? {
            return Ok(numbers);
        }
        let whole = self.whole_numbers(job)?;
        let values = whole.values.into_iter().map(|value| value as f64).collect();
        Ok(Numbers { values, shape: whole.shape })
    }

    /// The numbers of an array of float32 or float64.
    pub(super) fn floats(&self, job: &Job<'_>) -> Result<Numbers<f32>, ImportError> {
        if let Some(numbers) = self.view(|value: f32| Some(value), job)? {
            return Ok(numbers);
        }
        let numbers = self.view(|value: f64| Some(value as f32), job)?;
        numbers.ok_or_else(|| self.wrong_type("float32 or float64", job))
    }

    /// The numbers of an array of int32, int64, uint32 or uint64.
    pub(super) fn whole_numbers(&self, job: &Job<'_>) -> Result<Numbers<i64>, ImportError> {
        if let Some(numbers) = self.view(|value: i64| Some(value), job)? {
            return Ok(numbers);
        }
        if let Some(numbers) = self.view(|value: i32| Some(i64::from(value)), job)? {
            return Ok(numbers);
        }
        if let Some(numbers) = self.view(|value: u32| Some(i64::from(value)), job)? {
            return Ok(numbers);
        }
        let numbers = self.view(|value: u64| i64::try_from(value).ok(), job)?;
        numbers.ok_or_else(|| self.wrong_type("int32, int64, uint32 or uint64", job))
    }

    /// The numbers, if they are of type `A`.
    fn view<A: ViewElement + Copy, T>(
        &self,
        convert: impl Fn(A) -> Option<T>,
        job: &Job<'_>,
    ) -> Result<Option<Numbers<T>>, ImportError> {
        let view = match ArrayViewD::<A>::view_npy(self.bytes()) {
            Ok(view) => view,
            Err(ViewNpyError::WrongDescriptor(_)) => return Ok(None),
            Err(error) => return Err(self.invalid(error.to_string(), "a whole array", job)),
        };
        let values = view.iter().map(|&value| convert(value)).collect::<Option<Vec<T>>>();
        let values = values
            .ok_or_else(|| self.invalid("a number out of range".to_owned(), "indices", job))?;
        Ok(Some(Numbers { values, shape: view.shape().to_vec() }))
    }

    fn wrong_type(&self, expected: &str, job: &Job<'_>) -> ImportError {
        let start = self.bytes().iter().take(TEXT_LIMIT);
        let text: String = start.map(|&byte| char::from(byte)).collect();
        let found = text.split('\'').skip_while(|word| *word != "descr").nth(2);
        let found = format!("the type \"{}\"", found.unwrap_or("unknown"));
        self.invalid(found, expected, job)
    }

    /// An array that is not as it should be.
    pub(super) fn invalid(&self, found: String, expected: &str, job: &Job<'_>) -> ImportError {
        job.invalid(format!("array \"{}\"", self.name), found, expected)
    }
}
