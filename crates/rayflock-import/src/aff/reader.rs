//! What commands are made of: words as numbers, names and counts, with errors that name the line.

use std::path::Path;

use glam::{Vec2, Vec3};

use super::words::{Word, Words};
use crate::ImportError;

/// One file, read word by word.
#[derive(Clone, Debug)]
pub(super) struct Reader<'a> {
    /// The file that was asked for.
    file: &'a Path,
    /// The file that is read, if another one includes it.
    included: Option<&'a str>,
    words: Words<'a>,
    /// The command that is being read.
    command: Word<'a>,
}

impl<'a> Reader<'a> {
    pub(super) fn new(file: &'a Path, included: Option<&'a str>, bytes: &'a [u8]) -> Self {
        Self { file, included, words: Words::new(bytes), command: Word::default() }
    }

    /// The next command.
    pub(super) fn next_command(&mut self) -> Option<Word<'a>> {
        self.command = self.words.next()?;
        Some(self.command)
    }

    /// Leaves out what is left of the line.
    pub(super) fn skip_line(&mut self) {
        self.words.skip_line();
    }

    /// Where the command stands, for messages.
    pub(super) fn element(&self) -> String {
        self.element_at(self.command.line)
    }

    /// The line of the command.
    pub(super) fn line(&self) -> usize {
        self.command.line
    }

    /// What breaks the rules on the line of the command.
    pub(super) fn invalid(
        &self,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ImportError {
        self.invalid_at(self.command.line, found, expected)
    }

    /// What breaks the rules on a line.
    pub(super) fn invalid_at(
        &self,
        line: usize,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> ImportError {
        ImportError::invalid(self.file, self.element_at(line), found, expected)
    }

    /// Whether the next word is a number.
    pub(super) fn has_number(&self) -> bool {
        self.words.peek().is_some_and(|word| word.number().is_some())
    }

    /// The next word, whatever it is.
    pub(super) fn word(&mut self, expected: &str) -> Result<Word<'a>, ImportError> {
        self.words.next().ok_or_else(|| self.wrong(None, expected))
    }

    /// A name: any word but a brace.
    pub(super) fn name(&mut self, expected: &str) -> Result<String, ImportError> {
        let word = self.word(expected)?;
        match word.bytes {
            b"{" | b"}" => Err(self.wrong(Some(word), expected)),
            _ => Ok(word.text().into_owned()),
        }
    }

    /// A word that has to be there.
    pub(super) fn expect(&mut self, text: &str) -> Result<(), ImportError> {
        let expected = format!("\"{text}\"");
        let word = self.word(&expected)?;
        if word.bytes == text.as_bytes() { Ok(()) } else { Err(self.wrong(Some(word), &expected)) }
    }

    /// A finite number.
    pub(super) fn number(&mut self) -> Result<f64, ImportError> {
        const EXPECTED: &str = "a finite number";
        let word = self.word(EXPECTED)?;
        word.number().ok_or_else(|| self.wrong(Some(word), EXPECTED))
    }

    pub(super) fn numbers<const N: usize>(&mut self) -> Result<[f64; N], ImportError> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Ok(numbers)
    }

    pub(super) fn vector(&mut self) -> Result<Vec3, ImportError> {
        Ok(Vec3::from(self.numbers()?.map(|number| number as f32)))
    }

    pub(super) fn uv(&mut self) -> Result<Vec2, ImportError> {
        Ok(Vec2::from(self.numbers()?.map(|number| number as f32)))
    }

    /// A whole number.
    pub(super) fn integer(&mut self) -> Result<i64, ImportError> {
        const EXPECTED: &str = "a whole number";
        let word = self.word(EXPECTED)?;
        word.text().parse().map_err(|_| self.wrong(Some(word), EXPECTED))
    }

    /// How many of something follow, each of them at least `numbers_each` numbers. The file has
    /// room for that many.
    pub(super) fn count(&mut self, what: &str, numbers_each: usize) -> Result<usize, ImportError> {
        let expected = format!("a number of {what}");
        let word = self.word(&expected)?;
        let Ok(count) = word.text().parse::<usize>() else {
            return Err(self.wrong(Some(word), &expected));
        };
        // A number takes a digit and the space before it.
        let most = self.words.rest_size() / (2 * numbers_each);
        if count > most {
            let expected = format!("at most {most}, for which there is room in the file");
            return Err(self.invalid_at(word.line, format!("{count} {what}"), expected));
        }
        Ok(count)
    }

    /// A position in a list of `count` entries.
    pub(super) fn index(&mut self, what: &str, count: usize) -> Result<u32, ImportError> {
        let expected = format!("the number of one of {count} {what}, counted from 0");
        let word = self.word(&expected)?;
        let idx = word.text().parse::<u32>().ok().filter(|&idx| (idx as usize) < count);
        idx.ok_or_else(|| self.wrong(Some(word), &expected))
    }

    /// A word, or the end of the file, that the command cannot go on with.
    pub(super) fn wrong(&self, word: Option<Word<'_>>, expected: &str) -> ImportError {
        let found = word.map_or_else(|| "the end of the file".to_owned(), |word| word.quote());
        let line = word.map_or(self.words.line(), |word| word.line);
        let command = self.command.quote();
        let expected = format!("{expected} for {command} of line {}", self.command.line);
        self.invalid_at(line, found, expected)
    }

    fn element_at(&self, line: usize) -> String {
        match self.included {
            Some(name) => format!("{name} line {line}"),
            None => format!("line {line}"),
        }
    }
}
