//! How Embree is used: everything its experts would choose between.
//!
//! As text, words joined by `+` in any order; what is left out is `low`, `kept`, `single`.
//!
//! | Words | What they choose |
//! |---|---|
//! | `low`, `medium`, `refit` | how moving geometry is made ready each frame |
//! | `kept`, `instances`, `merged` | how static and moving geometry share the work |
//! | `single`, `packets` | how many rays are handed over at a time |
//! | `coherent` | whether Embree is told that the rays of a packet go similar ways |
//! | `robust` | whether it answers watertight, at some cost |

use std::fmt;
use std::str::FromStr;

use crate::peer::PeerError;

/// How moving geometry is made ready each frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Quality {
    /// A tree along a Morton curve: the quickest to build.
    #[default]
    Low,
    /// A tree by the surface area heuristic: slower to build, faster to trace.
    Medium,
    /// The tree of the frame before with its boxes moved: no build at all, slower to trace the
    /// further things have moved.
    Refit,
}

/// How static and moving geometry share the work.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Layout {
    /// One scene with a geometry an object. Embree builds a tree a geometry and one over them, and
    /// keeps those of geometries that did not change.
    #[default]
    Kept,
    /// A scene for what is static and one for what moves, as two instances in a third.
    Instances,
    /// All in one geometry, built anew each frame.
    Merged,
}

/// How Embree makes a frame's geometry the current one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Build {
    /// How moving geometry is made ready.
    pub quality: Quality,
    /// How static and moving geometry share the work.
    pub layout: Layout,
}

/// How many rays are handed to Embree at a time.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Width {
    /// One.
    #[default]
    Single,
    /// Sixteen.
    Packets,
}

/// How rays are handed to Embree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Traversal {
    /// How many at a time.
    pub width: Width,
    /// Whether Embree is told that the rays of a packet go similar ways.
    pub coherent: bool,
}

/// How Embree is used.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Setting {
    /// How a frame's geometry becomes the current one.
    pub build: Build,
    /// How rays are handed over.
    pub traversal: Traversal,
    /// Whether Embree answers watertight.
    pub robust: bool,
}

impl Setting {
    /// Every build that makes sense; a merged geometry is not refitted, because what is static in
    /// it would be refitted, too.
    pub fn builds() -> Vec<Build> {
        let all =
            [Layout::Kept, Layout::Instances, Layout::Merged].into_iter().flat_map(|layout| {
                [Quality::Low, Quality::Medium, Quality::Refit]
                    .map(|quality| Build { quality, layout })
            });
        all.filter(Build::makes_sense).collect()
    }

    /// Every traversal that differs: single rays take no notice of `coherent`.
    pub fn traversals() -> Vec<Traversal> {
        vec![
            Traversal { width: Width::Single, coherent: false },
            Traversal { width: Width::Packets, coherent: false },
            Traversal { width: Width::Packets, coherent: true },
        ]
    }

    /// Every build with every traversal, not robust and robust.
    pub fn all() -> Vec<Self> {
        let mut all = Vec::new();
        for robust in [false, true] {
            for build in Self::builds() {
                let traversals = Self::traversals().into_iter();
                all.extend(traversals.map(|traversal| Self { build, traversal, robust }));
            }
        }
        all
    }
}

impl Build {
    fn makes_sense(&self) -> bool {
        (self.quality, self.layout) != (Quality::Refit, Layout::Merged)
    }
}

impl Quality {
    const fn word(self) -> &'static str {
        match self {
            Self::Low => "low",
            Self::Medium => "medium",
            Self::Refit => "refit",
        }
    }
}

impl Layout {
    const fn word(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::Instances => "instances",
            Self::Merged => "merged",
        }
    }
}

impl Width {
    const fn word(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Packets => "packets",
        }
    }
}

impl fmt::Display for Build {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}+{}", self.quality.word(), self.layout.word())
    }
}

impl fmt::Display for Traversal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.width.word())?;
        if self.coherent { f.write_str("+coherent") } else { Ok(()) }
    }
}

impl fmt::Display for Setting {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}+{}", self.build, self.traversal)?;
        if self.robust { f.write_str("+robust") } else { Ok(()) }
    }
}

impl FromStr for Setting {
    type Err = PeerError;

    fn from_str(text: &str) -> Result<Self, PeerError> {
        let (mut quality, mut layout, mut width) = (None, None, None);
        let mut setting = Self::default();
        for word in text.split('+') {
            match word {
                "low" => choose(text, &mut quality, Quality::Low, Quality::word)?,
                "medium" => choose(text, &mut quality, Quality::Medium, Quality::word)?,
                "refit" => choose(text, &mut quality, Quality::Refit, Quality::word)?,
                "kept" => choose(text, &mut layout, Layout::Kept, Layout::word)?,
                "instances" => choose(text, &mut layout, Layout::Instances, Layout::word)?,
                "merged" => choose(text, &mut layout, Layout::Merged, Layout::word)?,
                "single" => choose(text, &mut width, Width::Single, Width::word)?,
                "packets" => choose(text, &mut width, Width::Packets, Width::word)?,
                "coherent" => setting.traversal.coherent = true,
                "robust" => setting.robust = true,
                _ => {
                    let (word, setting) = (word.to_owned(), text.to_owned());
                    return Err(PeerError::SettingWord { word, setting });
                }
            }
        }
        setting.build.quality = quality.unwrap_or_default();
        setting.build.layout = layout.unwrap_or_default();
        setting.traversal.width = width.unwrap_or_default();
        if setting.build.makes_sense() {
            Ok(setting)
        } else {
            Err(conflict(text, Quality::Refit.word(), Layout::Merged.word()))
        }
    }
}

/// Takes a choice, unless another one was taken before.
fn choose<T: Copy + PartialEq>(
    text: &str,
    chosen: &mut Option<T>,
    choice: T,
    word: impl Fn(T) -> &'static str,
) -> Result<(), PeerError> {
    match chosen.replace(choice) {
        Some(before) if before != choice => Err(conflict(text, word(before), word(choice))),
        _ => Ok(()),
    }
}

fn conflict(text: &str, first: &'static str, second: &'static str) -> PeerError {
    PeerError::SettingConflict { setting: text.to_owned(), first, second }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Setting, PeerError> {
        text.parse()
    }

    #[test]
    fn settings_are_parsed_as_they_are_printed() {
        let all = Setting::all();
        assert_eq!(all.len(), 8 * 3 * 2);
        for setting in all {
            assert_eq!(parse(&setting.to_string()), Ok(setting));
        }
    }

    #[test]
    fn words_come_in_any_order_and_have_defaults() {
        let setting = parse("robust+packets+medium").unwrap();
        assert_eq!(setting.to_string(), "medium+kept+packets+robust");
        assert_eq!(parse("coherent+packets").unwrap().to_string(), "low+kept+packets+coherent");
    }

    #[test]
    fn wrong_words_are_named() {
        let message = |text| parse(text).unwrap_err().to_string();
        assert!(message("low+fast").contains("\"fast\" in the setting \"low+fast\""));
        assert!(message("").contains("expected words joined by +"));
        assert!(message("low+refit").contains("both \"low\" and \"refit\""));
        assert!(message("merged+refit").contains("both \"refit\" and \"merged\""));
        assert!(message("single+packets+low").contains("both \"single\" and \"packets\""));
    }
}
