//! Kinds of rays and what is asked about them.

use std::fmt;
use std::str::FromStr;

use crate::BenchError;

/// Where rays come from and where they go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum RayKind {
    /// From the camera, one a pixel.
    Primary,
    /// From a point light to what the camera sees.
    PointShadow,
    /// From what the camera sees toward the sun.
    DirShadow,
    /// From what the camera sees, mirrored there.
    Mirror,
    /// From what the camera sees, anywhere away from the surface, by the cosine.
    Diffuse,
    /// Straight down from a level square above everything, as a height map needs them.
    Orthographic,
    /// From what the camera sees toward each of sixteen suns.
    Suns,
    /// From one point all around, as a laser scanner does.
    Lidar,
    /// From what the camera sees, eight a place by the cosine, up to a distance.
    Ao,
}

/// What is asked about a ray.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Question {
    /// What it hits first.
    ClosestHit,
    /// Whether it hits anything.
    Occluded,
}

impl RayKind {
    /// Every kind.
    pub const ALL: [Self; 9] = [
        Self::Primary,
        Self::PointShadow,
        Self::DirShadow,
        Self::Mirror,
        Self::Diffuse,
        Self::Orthographic,
        Self::Suns,
        Self::Lidar,
        Self::Ao,
    ];

    /// The kinds of the map.
    pub const DEFAULT: [Self; 5] =
        [Self::Primary, Self::PointShadow, Self::DirShadow, Self::Mirror, Self::Diffuse];

    /// The name on the command line and in records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::PointShadow => "pointshadow",
            Self::DirShadow => "dirshadow",
            Self::Mirror => "mirror",
            Self::Diffuse => "diffuse",
            Self::Orthographic => "orthographic",
            Self::Suns => "suns",
            Self::Lidar => "lidar",
            Self::Ao => "ao",
        }
    }

    /// What is asked about rays of this kind.
    pub const fn question(self) -> Question {
        match self {
            Self::Primary | Self::Mirror | Self::Diffuse | Self::Orthographic | Self::Lidar => {
                Question::ClosestHit
            }
            Self::PointShadow | Self::DirShadow | Self::Suns | Self::Ao => Question::Occluded,
        }
    }
}

impl fmt::Display for RayKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

impl FromStr for RayKind {
    type Err = BenchError;

    fn from_str(name: &str) -> Result<Self, BenchError> {
        let found = Self::ALL.into_iter().find(|kind| kind.name() == name);
        found.ok_or_else(|| BenchError::UnknownKind(name.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_name_is_read_back() {
        for kind in RayKind::ALL {
            assert_eq!(kind.to_string().parse::<RayKind>().unwrap(), kind);
        }
    }

    #[test]
    fn an_unknown_kind_is_told_the_known_ones() {
        let message = "shadow".parse::<RayKind>().unwrap_err().to_string();
        assert!(message.contains("\"shadow\"") && message.contains("pointshadow, dirshadow"));
    }
}
