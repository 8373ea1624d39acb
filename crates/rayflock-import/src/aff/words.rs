//! The words of an AFF file: what whitespace and comments leave.
//!
//! A brace is a word of its own. `#` and `%` begin comments that end with the line.

use std::borrow::Cow;

/// A word and the line it stands on, counted from 1.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Word<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) line: usize,
}

impl<'a> Word<'a> {
    /// The word, with marks in place of what is not UTF-8.
    pub(super) fn text(&self) -> Cow<'a, str> {
        String::from_utf8_lossy(self.bytes)
    }

    /// The word, for messages.
    pub(super) fn quote(&self) -> String {
        format!("\"{}\"", self.text())
    }

    /// The number that the word is; `None` where it is none, or not finite as an `f32`.
    pub(super) fn number(&self) -> Option<f64> {
        let number: f64 = std::str::from_utf8(self.bytes).ok()?.parse().ok()?;
        (number as f32).is_finite().then_some(number)
    }
}

/// The words that are left of a file.
#[derive(Clone, Debug)]
pub(super) struct Words<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Words<'a> {
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes, line: 1 }
    }

    /// Bytes that are left.
    pub(super) fn rest_size(&self) -> usize {
        self.rest.len()
    }

    /// The line that has been reached.
    pub(super) fn line(&self) -> usize {
        self.line
    }

    /// The next word, which stays.
    pub(super) fn peek(&self) -> Option<Word<'a>> {
        self.clone().next()
    }

    /// Leaves out what is left of the line.
    pub(super) fn skip_line(&mut self) {
        let end = self.rest.iter().position(|&byte| byte == b'\n').unwrap_or(self.rest.len());
        self.rest = &self.rest[end..];
    }

    fn skip_blank(&mut self) {
        while let [first, behind @ ..] = self.rest {
            match first {
                b'#' | b'%' => {
                    self.skip_line();
                    continue;
                }
                b'\n' => self.line += 1,
                _ if first.is_ascii_whitespace() => {}
                _ => return,
            }
            self.rest = behind;
        }
    }
}

impl<'a> Iterator for Words<'a> {
    type Item = Word<'a>;

    fn next(&mut self) -> Option<Word<'a>> {
        self.skip_blank();
        let ends = |byte: &u8| byte.is_ascii_whitespace() || b"{}#%".contains(byte);
        let length = match self.rest.first()? {
            b'{' | b'}' => 1,
            _ => self.rest.iter().position(ends).unwrap_or(self.rest.len()),
        };
        let (bytes, rest) = self.rest.split_at(length);
        self.rest = rest;
        Some(Word { bytes, line: self.line })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_go_and_braces_stand_alone() {
        let text = b"# a\n s 1 2%b\r\n\n x car{m}} # c\n} last";
        let all: Vec<_> = Words::new(text).map(|w| (w.line, w.text().into_owned())).collect();
        let expected = [
            (2, "s"),
            (2, "1"),
            (2, "2"),
            (4, "x"),
            (4, "car"),
            (4, "{"),
            (4, "m"),
            (4, "}"),
            (4, "}"),
            (5, "}"),
            (5, "last"),
        ];
        assert_eq!(all, expected.map(|(line, word)| (line, word.to_owned())));
    }

    #[test]
    fn only_finite_numbers_are_numbers() {
        let numbers = Words::new(b"1 -.5e1 3. +2 nan inf 1e39 1x {").map(|word| word.number());
        let expected = [Some(1.0), Some(-5.0), Some(3.0), Some(2.0), None, None, None, None, None];
        assert_eq!(numbers.collect::<Vec<_>>(), expected);
    }
}
