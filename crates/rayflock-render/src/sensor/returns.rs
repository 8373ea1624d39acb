//! Which echoes of a beam are told.

use std::fmt;
use std::str::FromStr;

use super::SensorError;

/// Which echoes of a beam are told: of those that the sensor notices, in the order of their
/// ranges. Where both of two are the same echo, one is told.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Returns {
    /// The nearest.
    #[default]
    First,
    /// The most intense; the nearest of those.
    Strongest,
    /// The farthest.
    Last,
    /// The nearest and the farthest.
    FirstAndLast,
    /// The nearest and the most intense.
    FirstAndStrongest,
    /// The most intense and the farthest.
    StrongestAndLast,
    /// Every one.
    All,
}

impl Returns {
    /// Every choice.
    pub const ALL: [Self; 7] = [
        Self::First,
        Self::Strongest,
        Self::Last,
        Self::FirstAndLast,
        Self::FirstAndStrongest,
        Self::StrongestAndLast,
        Self::All,
    ];

    /// The name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::First => "first",
            Self::Strongest => "strongest",
            Self::Last => "last",
            Self::FirstAndLast => "first+last",
            Self::FirstAndStrongest => "first+strongest",
            Self::StrongestAndLast => "strongest+last",
            Self::All => "all",
        }
    }

    /// Removes from `echoes`, sorted by range, those that are not told.
    pub(super) fn choose<T>(self, echoes: &mut Vec<T>, intensity: impl Fn(&T) -> f32) {
        let last = echoes.len().saturating_sub(1);
        let brightest = |best: usize, idx: usize| {
            if intensity(&echoes[idx]) > intensity(&echoes[best]) { idx } else { best }
        };
        let strongest = (0..echoes.len()).fold(0, brightest);
        let mut idx = 0;
        echoes.retain(|_| {
            let is_told = match self {
                Self::First => idx == 0,
                Self::Strongest => idx == strongest,
                Self::Last => idx == last,
                Self::FirstAndLast => idx == 0 || idx == last,
                Self::FirstAndStrongest => idx == 0 || idx == strongest,
                Self::StrongestAndLast => idx == strongest || idx == last,
                Self::All => true,
            };
            idx += 1;
            is_told
        });
    }
}

impl fmt::Display for Returns {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Returns {
    type Err = SensorError;

    fn from_str(name: &str) -> Result<Self, SensorError> {
        Self::ALL.into_iter().find(|returns| returns.name() == name).ok_or_else(|| {
            let (found, expected) = (name.to_owned(), Self::ALL.map(Self::name).join(", "));
            SensorError::UnknownReturns { found, expected }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn echoes_are_chosen_in_their_order() {
        let told = |returns: Returns, intensities: &[f32]| {
            let mut echoes: Vec<(usize, f32)> = intensities.iter().copied().enumerate().collect();
            returns.choose(&mut echoes, |echo| echo.1);
            echoes.into_iter().map(|echo| echo.0).collect::<Vec<_>>()
        };
        let found = Returns::ALL.map(|returns| told(returns, &[1.0, 3.0, 3.0, 2.0]));
        let expected = [&[0][..], &[1], &[3], &[0, 3], &[0, 1], &[1, 3], &[0, 1, 2, 3]];
        assert_eq!(found, expected.map(<[usize]>::to_vec));
        for returns in Returns::ALL {
            assert_eq!(told(returns, &[2.0]), [0], "{returns}");
            assert!(told(returns, &[]).is_empty());
            assert_eq!(returns.name().parse(), Ok(returns));
        }
        let message = "dual".parse::<Returns>().unwrap_err().to_string();
        assert!(message.contains("\"dual\"; there are: first, strongest"), "{message}");
    }
}
