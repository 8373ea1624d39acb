//! Bytes as they are or in base64, read from the front.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Bytes of an array.
#[derive(Clone, Copy, Debug)]
pub(super) enum Encoded<'a> {
    Raw(&'a [u8]),
    /// Four characters for three bytes.
    Base64(&'a [u8]),
}

impl Encoded<'_> {
    /// The first `count` bytes; `None` if there are not as many. What was read in one go was
    /// written so: base64 is padded at the end of each part.
    pub(super) fn read(&mut self, count: usize) -> Option<Vec<u8>> {
        match self {
            Self::Raw(rest) => {
                let (bytes, behind) = rest.split_at_checked(count)?;
                *rest = behind;
                Some(bytes.to_vec())
            }
            Self::Base64(rest) => {
                let length = count.div_ceil(3).checked_mul(4)?;
                let (characters, behind) = rest.split_at_checked(length)?;
                let mut bytes = STANDARD.decode(characters).ok()?;
                if bytes.len() < count {
                    return None;
                }
                bytes.truncate(count);
                *rest = behind;
                Some(bytes)
            }
        }
    }

    /// The first `count` bytes, which stay.
    pub(super) fn peek(&self, count: usize) -> Option<Vec<u8>> {
        self.clone().read(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_are_read_as_they_were_written() {
        let text = format!("{}{}", STANDARD.encode(b"head"), STANDARD.encode(b"and body"));
        let mut encoded = Encoded::Base64(text.as_bytes());
        assert_eq!(encoded.peek(2).unwrap(), b"he");
        assert_eq!(encoded.read(4).unwrap(), b"head");
        assert_eq!(encoded.read(8).unwrap(), b"and body");
        assert!(encoded.read(1).is_none() && encoded.read(usize::MAX).is_none());
        let mut raw = Encoded::Raw(b"abc");
        assert_eq!((raw.read(2).unwrap(), raw.read(2)), (b"ab".to_vec(), None));
        assert!(Encoded::Base64(b"!!!!").read(1).is_none());
    }
}
