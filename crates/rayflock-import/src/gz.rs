//! Decompression of `.gz` files, within bounds.
//!
//! A gzip stream can unfold to a thousand times its size, so the output is limited to
//! [`BASE_LIMIT`] plus [`RATIO_LIMIT`] times the input and never more than [`TOP_LIMIT`]. Meshes
//! compress to a third or a tenth; text that repeats itself, to a fiftieth.

use std::io::Read;
use std::path::Path;

use flate2::read::MultiGzDecoder;

use crate::ImportError;

/// Output that any input may have: 8 MiB. What unfolds to more than that and a hundred times itself
/// is no mesh, and reading it would take many times its size.
const BASE_LIMIT: u64 = 8 << 20;
/// Output bytes for each input byte.
const RATIO_LIMIT: u64 = 100;
/// Output that no input may exceed: 4 GiB.
const TOP_LIMIT: u64 = 4 << 30;

/// The content of a gzip file of one or more members.
pub(crate) fn decompress(file: &Path, compressed: &[u8]) -> Result<Vec<u8>, ImportError> {
    decompress_within(file, compressed, output_limit(compressed.len()))
}

/// Bytes that this many compressed ones may unfold to.
pub(crate) fn output_limit(compressed_size: usize) -> u64 {
    (BASE_LIMIT + RATIO_LIMIT * compressed_size as u64).min(TOP_LIMIT)
}

fn decompress_within(file: &Path, compressed: &[u8], limit: u64) -> Result<Vec<u8>, ImportError> {
    let mut content = Vec::new();
    let mut decoder = MultiGzDecoder::new(compressed).take(limit + 1);
    decoder.read_to_end(&mut content).map_err(|error| {
        let found = format!("{error} after {} bytes", content.len());
        ImportError::invalid(file, "gzip stream", found, "a whole gzip file")
    })?;
    if content.len() as u64 > limit {
        return Err(ImportError::TooLarge {
            file: file.to_owned(),
            element: "gzip stream".to_owned(),
            found: format!("the content of {} compressed bytes", compressed.len()),
            limit: format!("{limit} bytes"),
        });
    }
    Ok(content)
}

#[cfg(test)]
mod tests {
    use std::io::Write;

    use flate2::{Compression, write::GzEncoder};

    use super::*;

    fn compress(content: &[u8]) -> Vec<u8> {
        let mut encoder = GzEncoder::new(Vec::new(), Compression::default());
        encoder.write_all(content).unwrap();
        encoder.finish().unwrap()
    }

    #[test]
    fn content_comes_back() {
        let content = decompress(Path::new("a.gz"), &compress(b"hello")).unwrap();
        assert_eq!(content, b"hello");
    }

    #[test]
    fn a_cut_stream_is_an_error() {
        let compressed = compress(b"hello hello hello");
        let error = decompress(Path::new("a.gz"), &compressed[..compressed.len() - 9]);
        assert!(error.unwrap_err().to_string().starts_with("a.gz: gzip stream: found"));
    }

    #[test]
    fn output_is_bounded() {
        let error = decompress_within(Path::new("a.gz"), &compress(&[0; 10_000]), 9_999);
        assert!(matches!(error, Err(ImportError::TooLarge { .. })));
        assert!(decompress_within(Path::new("a.gz"), &compress(&[0; 10_000]), 10_000).is_ok());
    }
}
