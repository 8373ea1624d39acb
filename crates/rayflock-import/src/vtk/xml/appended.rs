//! The block behind the elements of a file, which need not be XML.

use std::borrow::Cow;

use super::encoded::Encoded;
use crate::ImportError;
use crate::job::Job;

/// Where the block begins and ends.
const TAG: &[u8] = b"<AppendedData";
const END: &[u8] = b"</AppendedData>";

/// What arrays refer to by an offset.
#[derive(Clone, Copy, Debug)]
pub(super) struct Appended<'a> {
    content: &'a [u8],
    is_raw: bool,
}

impl<'a> Appended<'a> {
    /// Cuts a file before the block: the elements as whole XML, and the block if there is one.
    pub(super) fn split(
        bytes: &'a [u8],
        job: &Job<'_>,
    ) -> Result<(Cow<'a, [u8]>, Option<Self>), ImportError> {
        let Some(at) = bytes.windows(TAG.len()).position(|window| window == TAG) else {
            return Ok((Cow::Borrowed(bytes), None));
        };
        let (head, block) = bytes.split_at(at);
        let invalid = |found: &str, expected| job.invalid("<AppendedData>", found, expected);
        let end = block.iter().position(|&byte| byte == b'>');
        let (tag, content) = end
            .and_then(|end| block.split_at_checked(end + 1))
            .ok_or_else(|| invalid("the end of the file", "the whole tag"))?;
        let is_raw = match String::from_utf8_lossy(tag) {
            tag if tag.contains("\"raw\"") => true,
            tag if tag.contains("\"base64\"") => false,
            tag => return Err(invalid(&tag, "the encoding \"raw\" or \"base64\"")),
        };
        let content = content
            .trim_ascii_start()
            .strip_prefix(b"_")
            .ok_or_else(|| invalid("another start", "an underscore before the data"))?;
        let end = content.windows(END.len()).rposition(|window| window == END);
        let end = end.ok_or_else(|| invalid("the end of the file", "the end of the block"))?;
        let content = &content[..end];
        let head = [head, b"</VTKFile>"].concat();
        Ok((Cow::Owned(head), Some(Self { content, is_raw })))
    }

    /// What begins at `offset`.
    pub(super) fn at(&self, offset: usize) -> Option<Encoded<'a>> {
        let content = self.content.get(offset..)?;
        Some(if self.is_raw { Encoded::Raw(content) } else { Encoded::Base64(content) })
    }
}
