//! Who walks in the crowd: looks, routes and paces.

use glam::Vec3;

use super::DURATION;
use super::path::Route;
use crate::Material;
use crate::builtin::{matte, polished};

/// One of the crowd.
#[derive(Clone, Copy, Debug)]
pub(super) struct Figure {
    /// The figure's name.
    pub(super) name: &'static str,
    /// Where it walks; one lap takes the whole clip.
    pub(super) route: Route,
    /// The share of the lap that lies behind it at the start.
    pub(super) start: f32,
    /// How many cycles of two steps it takes for a lap.
    pub(super) cycle_count: u32,
    /// Its height relative to 1.75 scene units.
    pub(super) scale: f32,
    /// What it wears.
    pub(super) outfit: Outfit,
    /// The colours of [`Cloth`], in order.
    pub(super) colors: [[f32; 3]; 5],
}

/// What a figure wears.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outfit {
    /// A jersey and trousers.
    Trousers,
    /// A dress, bare legs and a bun.
    Dress,
    /// A coat over trousers, and a hat.
    Coat,
}

/// What a part of a body shows; the material's place among the figure's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cloth {
    Skin,
    Hair,
    Top,
    Legs,
    Shoes,
}

impl Figure {
    /// The figure's materials, in the order of [`Cloth`].
    pub(super) fn materials(&self) -> [Material; 5] {
        let [skin, hair, top, legs, shoes] = self.colors.map(Vec3::from);
        [
            matte("skin", skin),
            matte("hair", hair),
            matte("top", top),
            matte("legs", legs),
            polished("shoes", shoes, 0.04),
        ]
    }

    /// How many laps lie behind the figure at `time`, in seconds.
    pub(super) fn lap_at(&self, time: f32) -> f32 {
        self.start + time / DURATION
    }
}

/// Around the fountain.
const ROUND: Route =
    Route { center: [0.0, 0.0], radii: [2.75, 2.2], turn: 0.0, against_clock: false };
/// On the left of the fountain, as the camera sees it.
const WEST: Route =
    Route { center: [-4.5, 0.5], radii: [2.4, 2.1], turn: 0.3, against_clock: true };
/// On the right.
const EAST: Route =
    Route { center: [4.5, -0.5], radii: [2.4, 2.1], turn: -0.4, against_clock: false };
/// Behind.
const NORTH: Route =
    Route { center: [0.0, -4.2], radii: [3.5, 1.25], turn: 0.05, against_clock: true };
/// In front.
const SOUTH: Route =
    Route { center: [0.2, 3.3], radii: [3.5, 1.2], turn: -0.06, against_clock: true };

const PALE_SKIN: [f32; 3] = [0.72, 0.47, 0.36];
const TAN_SKIN: [f32; 3] = [0.52, 0.31, 0.20];
const DARK_SKIN: [f32; 3] = [0.20, 0.10, 0.06];
const BLACK_HAIR: [f32; 3] = [0.03, 0.025, 0.02];
const BROWN_HAIR: [f32; 3] = [0.13, 0.06, 0.03];
const RED_HAIR: [f32; 3] = [0.36, 0.11, 0.03];
const FAIR_HAIR: [f32; 3] = [0.55, 0.38, 0.16];
const GREY_HAIR: [f32; 3] = [0.42, 0.42, 0.43];

/// The crowd. The starts were searched for, so that all keep their distance at all times.
pub(super) const FIGURES: &[Figure] = &[
    Figure {
        name: "Ada",
        route: ROUND,
        start: 0.7583,
        cycle_count: 14,
        scale: 0.96,
        outfit: Outfit::Dress,
        colors: [PALE_SKIN, BLACK_HAIR, [0.62, 0.05, 0.07], [0.62, 0.05, 0.07], [0.30, 0.04, 0.05]],
    },
    Figure {
        name: "Bram",
        route: ROUND,
        start: 0.8500,
        cycle_count: 14,
        scale: 1.06,
        outfit: Outfit::Trousers,
        colors: [TAN_SKIN, BROWN_HAIR, [0.06, 0.17, 0.38], [0.10, 0.10, 0.12], [0.12, 0.06, 0.03]],
    },
    Figure {
        name: "Chidi",
        route: ROUND,
        start: 0.0417,
        cycle_count: 14,
        scale: 1.03,
        outfit: Outfit::Coat,
        colors: [DARK_SKIN, BLACK_HAIR, [0.30, 0.20, 0.10], [0.06, 0.06, 0.07], [0.03, 0.03, 0.03]],
    },
    Figure {
        name: "Dara",
        route: WEST,
        start: 0.9167,
        cycle_count: 14,
        scale: 0.95,
        outfit: Outfit::Trousers,
        colors: [TAN_SKIN, BLACK_HAIR, [0.75, 0.52, 0.08], [0.07, 0.10, 0.20], [0.55, 0.53, 0.50]],
    },
    Figure {
        name: "Emil",
        route: WEST,
        start: 0.7917,
        cycle_count: 13,
        scale: 1.02,
        outfit: Outfit::Trousers,
        colors: [PALE_SKIN, FAIR_HAIR, [0.10, 0.30, 0.18], [0.28, 0.23, 0.16], [0.14, 0.07, 0.03]],
    },
    Figure {
        name: "Fatou",
        route: EAST,
        start: 0.8750,
        cycle_count: 13,
        scale: 0.98,
        outfit: Outfit::Dress,
        colors: [DARK_SKIN, BLACK_HAIR, [0.85, 0.35, 0.05], [0.85, 0.35, 0.05], [0.40, 0.12, 0.02]],
    },
    Figure {
        name: "Goro",
        route: EAST,
        start: 0.9917,
        cycle_count: 13,
        scale: 0.99,
        outfit: Outfit::Coat,
        colors: [TAN_SKIN, GREY_HAIR, [0.10, 0.11, 0.14], [0.05, 0.05, 0.06], [0.02, 0.02, 0.02]],
    },
    Figure {
        name: "Hana",
        route: NORTH,
        start: 0.3167,
        cycle_count: 15,
        scale: 0.94,
        outfit: Outfit::Trousers,
        colors: [PALE_SKIN, BLACK_HAIR, [0.70, 0.68, 0.64], [0.12, 0.22, 0.42], [0.70, 0.70, 0.70]],
    },
    Figure {
        name: "Ines",
        route: NORTH,
        start: 0.5583,
        cycle_count: 15,
        scale: 0.97,
        outfit: Outfit::Dress,
        colors: [TAN_SKIN, BROWN_HAIR, [0.08, 0.35, 0.40], [0.08, 0.35, 0.40], [0.10, 0.05, 0.03]],
    },
    Figure {
        name: "Jack",
        route: SOUTH,
        start: 0.1500,
        cycle_count: 13,
        scale: 1.08,
        outfit: Outfit::Trousers,
        colors: [PALE_SKIN, RED_HAIR, [0.45, 0.10, 0.08], [0.09, 0.10, 0.13], [0.45, 0.43, 0.40]],
    },
    Figure {
        name: "Kim",
        route: SOUTH,
        start: 0.9667,
        cycle_count: 14,
        scale: 0.99,
        outfit: Outfit::Trousers,
        colors: [TAN_SKIN, BLACK_HAIR, [0.28, 0.12, 0.38], [0.05, 0.05, 0.06], [0.65, 0.63, 0.60]],
    },
    Figure {
        name: "Lena",
        route: SOUTH,
        start: 0.6083,
        cycle_count: 14,
        scale: 0.96,
        outfit: Outfit::Coat,
        colors: [PALE_SKIN, FAIR_HAIR, [0.50, 0.08, 0.20], [0.16, 0.13, 0.12], [0.08, 0.03, 0.03]],
    },
];

#[cfg(test)]
mod tests {
    use super::super::path::Path;
    use super::*;

    #[test]
    fn no_two_figures_meet() {
        let paths: Vec<Path> = FIGURES.iter().map(|figure| Path::new(&figure.route)).collect();
        for tick in 0..200 {
            let time = DURATION * tick as f32 / 200.0;
            let walkers = FIGURES.iter().zip(&paths);
            let places: Vec<Vec3> =
                walkers.map(|(figure, path)| path.position(figure.lap_at(time))).collect();
            for (idx, a) in places.iter().enumerate() {
                for b in &places[..idx] {
                    assert!(a.distance(*b) > 0.7, "{a} and {b} at {time} s");
                }
            }
        }
    }

    #[test]
    fn figures_walk_at_a_human_pace() {
        for figure in FIGURES {
            let stride = Path::new(&figure.route).length() / figure.cycle_count as f32;
            let stride = stride / figure.scale;
            assert!((0.95..1.22).contains(&stride), "{}: {stride}", figure.name);
        }
    }
}
