//! A few numbers that belong together, as text on the command line and in TOML.

use std::fmt::{self, Display};
use std::str::FromStr;

use serde::Deserialize;
use serde::de::{Deserializer, Error};

/// So many finite numbers, with commas between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Numbers<const N: usize>(pub(crate) [f64; N]);

/// Width and height, as in `4.5x3`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Measures(pub(crate) [f64; 2]);

/// Angles of view in degrees: across and up, as in `120x25`, or up alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Field {
    /// From the left to the right edge.
    pub(crate) across: Option<f64>,
    /// From the bottom to the top edge.
    pub(crate) up: f64,
}

/// Elevations in degrees.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Elevations {
    /// As many as there are rows, from the first to the last, both included.
    Between(f64, f64),
    /// One a row.
    Each(Vec<f64>),
}

/// A finite number.
fn number(text: &str) -> Option<f64> {
    text.trim().parse::<f64>().ok().filter(|number| number.is_finite())
}

impl<const N: usize> FromStr for Numbers<N> {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let numbers: Option<Vec<f64>> = text.split(',').map(number).collect();
        let numbers = numbers.and_then(|numbers| numbers.try_into().ok());
        let example = &["1.5", "97", "-4"][..N.min(3)].join(",");
        let expected = || format!("expected {N} numbers with commas between them, as in {example}");
        numbers.map(Self).ok_or_else(expected)
    }
}

impl FromStr for Measures {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let measures = || {
            let (width, height) = text.split_once(['x', 'X'])?;
            Some(Self([number(width)?, number(height)?]))
        };
        measures().ok_or_else(|| "expected WIDTHxHEIGHT, as in 4.5x3".to_owned())
    }
}

impl FromStr for Field {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let field = match text.parse::<Measures>() {
            Ok(Measures([across, up])) => Some(Self { across: Some(across), up }),
            Err(_) => number(text).map(|up| Self { across: None, up }),
        };
        let expected = "expected degrees across and up, as in 120x25, or up alone, as in 45";
        field.ok_or_else(|| expected.to_owned())
    }
}

impl FromStr for Elevations {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let elevations = match text.split_once("..") {
            Some((first, last)) => {
                number(first).zip(number(last)).map(|(first, last)| Self::Between(first, last))
            }
            None => text.split(',').map(number).collect::<Option<Vec<_>>>().map(Self::Each),
        };
        let expected = "expected degrees from the top row to the bottom row, as in 15..-25, or of \
                        each row, as in 10,2,-2,-10";
        elevations.ok_or_else(|| expected.to_owned())
    }
}

/// Reads what stands on the command line as one word from a TOML string, number or array.
pub(crate) fn word<'de, D, T>(deserializer: D) -> Result<T, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err: Display>,
{
    let text = Word::deserialize(deserializer)?.to_string();
    text.parse().map_err(|error| D::Error::custom(format!("found \"{text}\": {error}")))
}

/// The same of what may be missing.
pub(crate) fn perhaps_word<'de, D, T>(deserializer: D) -> Result<Option<T>, D::Error>
where
    D: Deserializer<'de>,
    T: FromStr<Err: Display>,
{
    word(deserializer).map(Some)
}

/// What TOML has for a word.
#[derive(Deserialize)]
#[serde(untagged, expecting = "expected a string, a number or an array of numbers")]
enum Word {
    Text(String),
    Number(f64),
    Numbers(Vec<f64>),
}

impl Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Text(text) => f.write_str(text),
            Self::Number(number) => number.fmt(f),
            Self::Numbers(numbers) => {
                let words: Vec<String> = numbers.iter().map(f64::to_string).collect();
                f.write_str(&words.join(","))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_finite_and_as_many_as_there_should_be() {
        assert_eq!("1, -2.5,3e2".parse(), Ok(Numbers([1.0, -2.5, 300.0])));
        for text in ["1,2", "1,2,3,4", "1,2,x", "1,2,inf", "", ",,"] {
            let message = text.parse::<Numbers<3>>().unwrap_err();
            assert!(message.contains("3 numbers") && message.contains("1.5,97,-4"), "{message}");
        }
        assert!("1".parse::<Numbers<2>>().unwrap_err().ends_with("as in 1.5,97"));
    }

    #[test]
    fn fields_and_measures_have_a_cross() {
        assert_eq!("4.5x3".parse(), Ok(Measures([4.5, 3.0])));
        assert_eq!("120X25".parse(), Ok(Field { across: Some(120.0), up: 25.0 }));
        assert_eq!("45".parse(), Ok(Field { across: None, up: 45.0 }));
        for text in ["", "x", "4x", "4xnan", "4x5x6"] {
            assert!(text.parse::<Measures>().unwrap_err().contains("4.5x3"), "{text}");
            assert!(text.parse::<Field>().unwrap_err().contains("120x25"), "{text}");
        }
    }

    #[test]
    fn elevations_are_a_range_or_a_list() {
        assert_eq!("15..-25".parse(), Ok(Elevations::Between(15.0, -25.0)));
        assert_eq!("1.5,0,-3".parse(), Ok(Elevations::Each(vec![1.5, 0.0, -3.0])));
        for text in ["", "..", "1..", "a,b", "1,,2", "nan"] {
            assert!(text.parse::<Elevations>().unwrap_err().contains("15..-25"), "{text}");
        }
    }
}
