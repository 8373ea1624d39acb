//! The bytes behind buffers and images: the binary chunk, data URIs, and files in the same folder.

use base64::Engine;
use base64::engine::DecodePaddingMode;
use base64::engine::general_purpose::{GeneralPurpose, GeneralPurposeConfig};
use gltf::json::{Root, buffer::View, root::Index};

use super::label;
use crate::ImportError;
use crate::job::Job;

/// Standard base64 whose padding may be missing.
const BASE64: GeneralPurpose = GeneralPurpose::new(
    &base64::alphabet::STANDARD,
    GeneralPurposeConfig::new().with_decode_padding_mode(DecodePaddingMode::Indifferent),
);

/// The content of each buffer, at least as long as the file says.
pub(super) fn load(
    root: &Root,
    mut blob: Option<Vec<u8>>,
    job: &Job<'_>,
) -> Result<Vec<Vec<u8>>, ImportError> {
    let mut buffers = Vec::new();
    for (idx, buffer) in root.buffers.iter().enumerate() {
        let element = label("buffer", idx, buffer.name.as_ref());
        let content = match &buffer.uri {
            Some(uri) => fetch(uri, job).map_err(|reason| {
                job.invalid(&element, reason, "a data URI or a readable file in the same folder")
            })?,
            None => blob.take().ok_or_else(|| {
                job.invalid(&element, "neither a URI nor a binary chunk", "one of the two")
            })?,
        };
        if (content.len() as u64) < buffer.byte_length.0 {
            let found = format!("{} bytes", content.len());
            let expected = format!("the {} bytes that byteLength states", buffer.byte_length.0);
            return Err(job.invalid(element, found, expected));
        }
        buffers.push(content);
    }
    Ok(buffers)
}

/// The bytes that a URI stands for, or why they cannot be had.
pub(super) fn fetch(uri: &str, job: &Job<'_>) -> Result<Vec<u8>, String> {
    let Some(data) = uri.strip_prefix("data:") else {
        let path = urlencoding::decode(uri).map_err(|error| error.to_string())?;
        return job.read_neighbour(&path);
    };
    let (head, encoded) = data.split_once(',').ok_or("a data URI without a comma")?;
    if !head.ends_with(";base64") {
        return Err(format!("a data URI of \"{}\"", crate::error::shorten(head)));
    }
    BASE64.decode(encoded).map_err(|error| format!("a data URI with {error}"))
}

/// The bytes of a buffer view, or what is wrong with it.
pub(super) fn view<'a>(
    root: &Root,
    buffers: &'a [Vec<u8>],
    view: Index<View>,
) -> Result<&'a [u8], String> {
    let idx = view.value();
    let json = root.buffer_views.get(idx).ok_or(format!("buffer view {idx}, which is missing"))?;
    let buffer_idx = json.buffer.value();
    let buffer = buffers.get(buffer_idx).ok_or(format!("buffer {buffer_idx}, which is missing"))?;
    let start = json.byte_offset.unwrap_or_default().0;
    let range = start
        .checked_add(json.byte_length.0)
        .and_then(|end| buffer.get(usize::try_from(start).ok()?..usize::try_from(end).ok()?));
    range.ok_or_else(|| {
        let (length, held) = (json.byte_length.0, buffer.len());
        format!(
            "buffer view {idx} at offset {start} with {length} bytes in buffer {buffer_idx} \
                 of {held} bytes"
        )
    })
}
