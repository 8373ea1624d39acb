//! Lines of OBJ and MTL files as statements: a keyword and its arguments.

use std::borrow::Cow;

/// A statement and the line on which it begins, counted from 1.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Statement<'a> {
    pub(super) line: usize,
    text: Cow<'a, str>,
}

impl Statement<'_> {
    /// The first word.
    pub(super) fn keyword(&self) -> &str {
        self.text.split_whitespace().next().unwrap_or_default()
    }

    /// The words after the first.
    pub(super) fn arguments(&self) -> impl Iterator<Item = &str> {
        self.text.split_whitespace().skip(1)
    }

    /// Everything after the first word: names may hold spaces.
    pub(super) fn rest(&self) -> &str {
        self.text.trim_start()[self.keyword().len()..].trim()
    }

    /// The statement, for messages.
    pub(super) fn quote(&self) -> String {
        format!("\"{}\"", self.text)
    }

    /// The arguments as numbers; an argument that is none as an error.
    pub(super) fn numbers(&self) -> Result<Vec<f32>, String> {
        let number = |word: &str| word.parse::<f32>().map_err(|_| self.quote());
        self.arguments().map(number).collect()
    }
}

/// The statements of a file: comments and empty lines left out, lines that end in a backslash
/// joined with the next.
pub(super) fn statements(bytes: &[u8]) -> impl Iterator<Item = Statement<'_>> {
    let mut lines = bytes.split(|&byte| byte == b'\n').enumerate();
    std::iter::from_fn(move || {
        loop {
            let (line_idx, first) = lines.next()?;
            let line = line_idx + 1;
            let mut text = clean(first);
            while text.ends_with('\\') {
                let joined = text.to_mut();
                joined.pop();
                joined.push(' ');
                joined.push_str(&lines.next().map(|(_, next)| clean(next)).unwrap_or_default());
            }
            if !text.is_empty() {
                return Some(Statement { line, text });
            }
        }
    })
}

/// The line without its comment and the space around it.
fn clean(line: &[u8]) -> Cow<'_, str> {
    let code = line.split(|&byte| byte == b'#').next().unwrap_or_default();
    String::from_utf8_lossy(code.trim_ascii())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_go_and_continued_lines_join() {
        let text = b"# a\n v 1 2\\\r\n 3 # b\r\n\nusemtl  two words \nf \\";
        let all: Vec<_> = statements(text).map(|s| (s.line, s.rest().to_owned())).collect();
        assert_eq!(all, [(2, "1 2 3".into()), (5, "two words".into()), (6, String::new())]);
        assert_eq!(statements(text).next().unwrap().numbers(), Ok(vec![1.0, 2.0, 3.0]));
    }

    #[test]
    fn very_many_lines_join_at_once() {
        // Copied at each line, this would be a hundred gigabytes.
        let text = "\\\n".repeat(1 << 19);
        let all: Vec<_> = statements(text.as_bytes()).map(|s| s.line).collect();
        assert_eq!(all, [1]);
    }

    #[test]
    fn space_before_the_keyword_is_no_part_of_the_rest() {
        let text = "\u{a0}g a b\n\\\nusemtl two words\n".as_bytes();
        let all: Vec<_> = statements(text).map(|s| s.rest().to_owned()).collect();
        assert_eq!(all, ["a b", "two words"]);
    }
}
