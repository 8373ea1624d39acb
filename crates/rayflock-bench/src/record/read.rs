//! Reads records that were kept.

use std::fs;
use std::path::Path;

use super::Record;
use crate::BenchError;

impl Record {
    /// Reads a record from a JSON file.
    ///
    /// # Errors
    /// [`BenchError::ReadRecord`], [`BenchError::RecordForm`].
    pub fn read(path: &Path) -> Result<Self, BenchError> {
        let path = path.to_owned();
        let text = match fs::read_to_string(&path) {
            Ok(text) => text,
            Err(source) => return Err(BenchError::ReadRecord { path, source }),
        };
        serde_json::from_str(&text).map_err(|error| {
            let (line, message) = (error.line(), error.to_string());
            // The line is said before the message, so that it is not said again at its end.
            let place = format!(" at line {line} column {}", error.column());
            let message = message.strip_suffix(&place).unwrap_or(&message).to_owned();
            BenchError::RecordForm { path, line, message }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Record, BenchError> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("record.json");
        fs::write(&path, text).unwrap();
        Record::read(&path)
    }

    #[test]
    fn a_record_is_read_as_it_was_written() {
        let record = Record::new("map");
        assert_eq!(read(&serde_json::to_string_pretty(&record).unwrap()).unwrap(), record);
    }

    #[test]
    fn what_is_no_record_is_named_with_its_line() {
        let cases = [
            (
                "{\n  \"benchmark\": map\n}",
                "record.json: line 2: expected value; expected a record",
            ),
            ("{\"benchmark\": \"map\"}", "line 1: missing field `machine`"),
            ("{\n\"benchmark\":\n7}", "line 3: invalid type: integer `7`, expected a string"),
            ("", "line 1: EOF while parsing a value"),
        ];
        for (text, expected) in cases {
            let message = read(text).unwrap_err().to_string();
            assert!(message.contains(expected), "{text}: {message}");
        }
        let message = Record::read(Path::new("nowhere.json")).unwrap_err().to_string();
        assert!(message.contains("nowhere.json: cannot be read"), "{message}");
    }
}
