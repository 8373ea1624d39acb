//! Arrays of an XML file: text, base64 or raw bytes, as they are or compressed.
//!
//! Bytes begin with a header of whole numbers: their count; or, where the file is compressed, the
//! number of blocks, the sizes of a block and of the last one (0 for a full one), and the size of
//! each block when compressed. Blocks are zlib streams.

use std::io::Read;

use flate2::read::ZlibDecoder;
use roxmltree::Node;

use super::appended::Appended;
use super::encoded::Encoded;
use crate::ImportError;
use crate::gz;
use crate::job::Job;
use crate::vtk::numbers::{ByteOrder, Number, Scalar, unsigned};

/// How arrays are written, and those behind the elements.
#[derive(Debug)]
pub(super) struct Arrays<'a> {
    order: ByteOrder,
    /// Bytes a number of a header.
    header_size: usize,
    are_compressed: bool,
    appended: Option<Appended<'a>>,
}

impl<'a> Arrays<'a> {
    /// As the attributes of the root say.
    pub(super) fn new(
        root: Node<'_, '_>,
        appended: Option<Appended<'a>>,
        job: &Job<'_>,
    ) -> Result<Self, ImportError> {
        let unknown = |name: &str, found: &str, expected: &str| ImportError::Unsupported {
            file: job.file.to_owned(),
            element: "<VTKFile>".to_owned(),
            found: format!("{name} \"{found}\""),
            expected: expected.to_owned(),
        };
        let attribute = |name, default| root.attribute(name).unwrap_or(default);
        let order = match attribute("byte_order", "LittleEndian") {
            "LittleEndian" => ByteOrder::Little,
            "BigEndian" => ByteOrder::Big,
            other => return Err(unknown("byte_order", other, "LittleEndian or BigEndian")),
        };
        let header_size = match attribute("header_type", "UInt32") {
            "UInt32" => 4,
            "UInt64" => 8,
            other => return Err(unknown("header_type", other, "UInt32 or UInt64")),
        };
        let are_compressed = match attribute("compressor", "") {
            "" => false,
            "vtkZLibDataCompressor" => true,
            other => return Err(unknown("compressor", other, "vtkZLibDataCompressor or none")),
        };
        Ok(Self { order, header_size, are_compressed, appended })
    }

    /// The numbers of a `<DataArray>`, `count` of them where that is known; `place` names it.
    pub(super) fn numbers<T: Number>(
        &self,
        node: Node<'_, '_>,
        place: &str,
        count: Option<usize>,
        job: &Job<'_>,
    ) -> Result<Vec<T>, ImportError> {
        let kind = node.attribute("type").unwrap_or_default();
        let scalar = Scalar::xml(kind).ok_or_else(|| {
            job.invalid(place, format!("the type \"{kind}\""), "a type such as Float32")
        })?;
        let numbers = match node.attribute("format").unwrap_or("ascii") {
            "ascii" => words(&text(node), place, job)?,
            "binary" => {
                let mut characters = text(node).into_bytes();
                characters.retain(|byte| !byte.is_ascii_whitespace());
                self.decode(Encoded::Base64(&characters), scalar, place, job)?
            }
            "appended" => {
                let offset = node.attribute("offset").unwrap_or_default();
                let block = offset.trim().parse().ok().zip(self.appended);
                let array = block.and_then(|(offset, block)| block.at(offset));
                let array = array.ok_or_else(|| {
                    let found = format!("the offset \"{offset}\"");
                    job.invalid(place, found, "a place in <AppendedData>")
                })?;
                self.decode(array, scalar, place, job)?
            }
            other => {
                let found = format!("the format \"{other}\"");
                return Err(job.invalid(place, found, "ascii, binary or appended"));
            }
        };
        if let Some(expected) = count.filter(|&count| count != numbers.len()) {
            let found = format!("{} numbers", numbers.len());
            return Err(job.invalid(place, found, expected.to_string()));
        }
        Ok(numbers)
    }

    fn decode<T: Number>(
        &self,
        encoded: Encoded<'_>,
        scalar: Scalar,
        place: &str,
        job: &Job<'_>,
    ) -> Result<Vec<T>, ImportError> {
        let bytes = match self.are_compressed {
            true => self.compressed(encoded, place, job)?,
            false => self.uncompressed(encoded),
        };
        let bytes = bytes.ok_or_else(|| {
            job.invalid(place, "the end of the data or damaged data", "a whole array")
        })?;
        let numbers = bytes.chunks_exact(scalar.size());
        let numbers = numbers.map(|number| T::from_bytes(number, scalar, self.order));
        let numbers = numbers.collect::<Option<Vec<T>>>();
        numbers.ok_or_else(|| job.invalid(place, "a number of another type", T::NAME))
    }

    /// Header and content were encoded as one.
    fn uncompressed(&self, mut encoded: Encoded<'_>) -> Option<Vec<u8>> {
        let count = self.header(&encoded.peek(self.header_size)?, 0)?;
        let mut bytes = encoded.read(self.header_size.checked_add(count)?)?;
        bytes.drain(..self.header_size);
        Some(bytes)
    }

    /// Header and blocks were encoded one after the other. `None` for damage.
    fn compressed(
        &self,
        mut encoded: Encoded<'_>,
        place: &str,
        job: &Job<'_>,
    ) -> Result<Option<Vec<u8>>, ImportError> {
        let Some(blocks) = self.blocks(&mut encoded) else { return Ok(None) };
        let whole_size = blocks.iter().fold(0, |sum: usize, (_, size)| sum.saturating_add(*size));
        let packed_size = blocks.iter().map(|(block, _)| block.len()).sum();
        let limit = gz::output_limit(packed_size);
        if whole_size as u64 > limit {
            return Err(ImportError::TooLarge {
                file: job.file.to_owned(),
                element: place.to_owned(),
                found: format!("{whole_size} bytes in {packed_size} compressed ones"),
                limit: format!("{limit} bytes"),
            });
        }
        let mut bytes = Vec::new();
        for (block, size) in blocks {
            let before = bytes.len();
            let mut decoder = ZlibDecoder::new(block.as_slice()).take(size as u64 + 1);
            if decoder.read_to_end(&mut bytes).is_err() || bytes.len() != before + size {
                return Ok(None);
            }
        }
        Ok(Some(bytes))
    }

    /// Each block with the size it has when it is unpacked.
    fn blocks(&self, encoded: &mut Encoded<'_>) -> Option<Vec<(Vec<u8>, usize)>> {
        let count = self.header(&encoded.peek(self.header_size)?, 0)?;
        let header = encoded.read(count.checked_add(3)?.checked_mul(self.header_size)?)?;
        let (full, last) = (self.header(&header, 1)?, self.header(&header, 2)?);
        let sizes = (0..count).map(|idx| self.header(&header, 3 + idx));
        let sizes = sizes.collect::<Option<Vec<usize>>>()?;
        let total = sizes.iter().try_fold(0_usize, |sum, size| sum.checked_add(*size))?;
        let packed = encoded.read(total)?;
        let mut rest = packed.as_slice();
        let block = |(idx, size): (usize, &usize)| {
            let (block, behind) = rest.split_at_checked(*size)?;
            rest = behind;
            let is_last = idx + 1 == count && last > 0;
            Some((block.to_vec(), if is_last { last } else { full }))
        };
        sizes.iter().enumerate().map(block).collect()
    }

    /// Number `idx` of a header.
    fn header(&self, bytes: &[u8], idx: usize) -> Option<usize> {
        let number = bytes.chunks_exact(self.header_size).nth(idx)?;
        usize::try_from(unsigned(number, self.order)).ok()
    }
}

/// The text of an element without that of others in it.
fn text(node: Node<'_, '_>) -> String {
    let parts = node.children().filter(Node::is_text);
    parts.filter_map(|part| part.text()).collect()
}

fn words<T: Number>(text: &str, place: &str, job: &Job<'_>) -> Result<Vec<T>, ImportError> {
    let number = |word: &str| {
        let invalid = |_| job.invalid(place, format!("\"{word}\""), T::NAME);
        word.parse::<T>().map_err(invalid)
    };
    text.split_ascii_whitespace().map(number).collect()
}
