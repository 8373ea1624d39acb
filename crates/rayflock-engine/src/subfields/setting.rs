//! Settings as text: `eager+list+160`.

use std::fmt;
use std::str::FromStr;

use super::config::{Config, Nesting, TileOrder, UpdatePolicy};
use super::direction_set::DirectionLayout;
use crate::EngineError;

/// What a word stands for.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Word {
    Policy(UpdatePolicy),
    List,
    Flat,
    Icosahedron,
}

const WORDS: [(&str, Word); 6] = [
    ("on-demand", Word::Policy(UpdatePolicy::OnDemand)),
    ("eager", Word::Policy(UpdatePolicy::Eager)),
    ("locked", Word::Policy(UpdatePolicy::Locked)),
    ("list", Word::List),
    ("flat", Word::Flat),
    ("icosahedron", Word::Icosahedron),
];

/// What follows the number of primitives in a tile.
const PER_TILE: &str = "-a-tile";

impl FromStr for Config {
    type Err = EngineError;

    /// Words joined by `+`: `on-demand`, `eager` or `locked` for the policy, `list` for the paper's
    /// lists, `flat` for no nesting, `icosahedron` for that layout, a number of directions, and
    /// `10-a-tile` for how many primitives are to be left in a tile.
    fn from_str(text: &str) -> Result<Self, EngineError> {
        let mut config = Self::default();
        for part in text.split('+') {
            if let Some(count) = part.parse().ok().filter(|&count| count > 0) {
                config.direction_count = Some(count);
                continue;
            }
            let per_tile = part.strip_suffix(PER_TILE).and_then(|count| count.parse().ok());
            if let Some(fewest) = per_tile.filter(|&fewest| fewest > 0) {
                config.fewest_in_tile = fewest;
                continue;
            }
            let found = WORDS.iter().find(|(word, _)| *word == part);
            match found.map(|&(_, word)| word) {
                Some(Word::Policy(policy)) => config.policy = policy,
                Some(Word::List) => config.moving_order = TileOrder::List,
                Some(Word::Flat) => config.nesting = Nesting::Off,
                Some(Word::Icosahedron) => config.layout = DirectionLayout::Icosahedron,
                None => return Err(unknown(part)),
            }
        }
        Ok(config)
    }
}

fn unknown(part: &str) -> EngineError {
    EngineError::UnknownSetting {
        engine: "subfields",
        found: part.to_owned(),
        expected: format!(
            "{}, a number of directions, or a number of primitives such as 10{PER_TILE}",
            WORDS.map(|(word, _)| word).join(", ")
        ),
    }
}

impl fmt::Display for Config {
    /// The words for what is not the default; nothing where all is.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let has = |word: Word| match word {
            Word::Policy(policy) => policy == self.policy && policy != UpdatePolicy::default(),
            Word::List => self.moving_order == TileOrder::List,
            Word::Flat => self.nesting == Nesting::Off,
            Word::Icosahedron => self.layout == DirectionLayout::Icosahedron,
        };
        let words = WORDS.iter().filter(|&&(_, word)| has(word)).map(|&(word, _)| word.to_owned());
        let count = self.direction_count.map(|count| count.to_string());
        let is_usual = self.fewest_in_tile == Self::default().fewest_in_tile;
        let per_tile = (!is_usual).then(|| format!("{}{PER_TILE}", self.fewest_in_tile));
        f.write_str(&words.chain(count).chain(per_tile).collect::<Vec<_>>().join("+"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_parsed_as_they_are_printed() {
        for text in ["eager", "locked+list+flat+icosahedron+40", "list+7", "flat+40+3-a-tile"] {
            assert_eq!(text.parse::<Config>().unwrap().to_string(), text);
        }
        assert_eq!("on-demand".parse(), Ok(Config::default()));
        assert_eq!(Config::default().to_string(), "");
    }

    #[test]
    fn unknown_words_are_told_which_there_are() {
        for text in ["eagre", "eager+", "0", "list+-3", "0-a-tile", ""] {
            let message = text.parse::<Config>().unwrap_err().to_string();
            assert!(message.contains("on-demand, eager, locked, list, flat"), "{message}");
        }
        let message = "eager+lists".parse::<Config>().unwrap_err().to_string();
        assert!(message.contains("\"lists\""), "{message}");
    }
}
