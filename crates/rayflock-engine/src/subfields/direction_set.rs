//! Directions spread evenly over a hemisphere, and which of them is nearest to any direction.
//!
//! A ray and its reverse share a direction, so half of the sphere is enough. Two ways to spread
//! them: the centers of the faces of a subdivided icosahedron, or the Fibonacci lattice.
//!
//! The nearest one is found in constant time: the hemisphere is unfolded to a square (the upper
//! half of an octahedron seen from above) of some cells a direction, and each cell lists the
//! directions that are nearest to anything in it.
//!
//! **Source.** E. Camahort, A. Lerios, D. Fussell, "Uniformly Sampled Light Fields", EGWR 1998
//! (subdivision); R. Swinbank, R. J. Purser, "Fibonacci grids", 2006; Q. Meyer et al., "On
//! Floating-Point Normal Vectors", EGSR 2010 (the octahedron).
//!
//! **Invariants.** [`DirectionSet::nearest`] is the exact answer: within a cell the unfolding is a
//! projection, so no direction of the cell is farther from the one at its middle than the farthest
//! corner is, by the angle `r`; if the nearest to the middle is `d` away, the nearest to anything
//! in the cell is no more than `d + 2 r` away from the middle.
//!
//! **Cost.** Some four scalar products for each look-up. Making a set takes time in proportion to
//! the square of its size: eight cells a direction, a scalar product for each cell and direction.

use std::f64::consts::{FRAC_PI_2, PI};

use glam::{DVec3, Vec3};

/// How directions are spread.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum DirectionLayout {
    /// The Fibonacci lattice: any number of directions.
    #[default]
    Fibonacci,
    /// Faces of a subdivided icosahedron: 10, 40, 160, 640 ... directions.
    Icosahedron,
}

/// Cells for each direction.
const CELLS_PER_DIRECTION: usize = 8;

/// More than what rounding adds to an angle, in radians.
const ANGLE_SLACK: f64 = 1e-6;

/// Directions spread over a hemisphere; a ray and its reverse share one.
#[derive(Clone, Debug)]
pub struct DirectionSet {
    directions: Vec<Vec3>,
    /// Cells along a side of the square; even, so that its axes lie between cells.
    side: usize,
    /// For each cell, where its candidates begin; after the last, their number.
    begins: Vec<u32>,
    candidates: Vec<u16>,
}

impl DirectionSet {
    /// About `count` directions: the layout's largest number that is not larger, at least one or
    /// ten.
    ///
    /// # Panics
    /// When `count` is larger than 65,536.
    pub fn new(layout: DirectionLayout, count: usize) -> Self {
        assert!(count <= 1 << 16, "there are at most 65536 directions");
        let directions = match layout {
            DirectionLayout::Fibonacci => fibonacci(count.max(1)),
            DirectionLayout::Icosahedron => icosahedron(count),
        };
        let cells = (CELLS_PER_DIRECTION * directions.len()) as f64;
        let side = (cells.sqrt() as usize).next_multiple_of(2);
        let mut set = Self { directions, side, begins: vec![0], candidates: Vec::new() };
        let lines: Vec<DVec3> =
            set.directions.iter().map(|direction| direction.as_dvec3().normalize()).collect();
        let mut alike = Vec::new();
        for cell_idx in 0..side * side {
            set.list_candidates(cell_idx, &lines, &mut alike);
            set.begins.push(set.candidates.len() as u32);
        }
        set
    }

    /// The directions, of unit length.
    pub fn directions(&self) -> &[Vec3] {
        &self.directions
    }

    /// The position of the direction that has the smallest angle with the line along `direction`;
    /// the first of those where several have. `direction` is not zero; numbers whose squares are out
    /// of range may get a direction that is not the nearest.
    #[inline(always)]
    pub fn nearest(&self, direction: Vec3) -> usize {
        let cell_idx = self.cell_idx(direction);
        let begin = self.begins[cell_idx] as usize;
        let end = self.begins[cell_idx + 1] as usize;
        let (mut best, mut most) = (0, f32::NEG_INFINITY);
        for &candidate in &self.candidates[begin..end] {
            let alike = self.directions[candidate as usize].dot(direction).abs();
            if alike > most {
                (best, most) = (candidate as usize, alike);
            }
        }
        best
    }

    #[inline(always)]
    fn cell_idx(&self, direction: Vec3) -> usize {
        let sum = direction.x.abs() + direction.y.abs() + direction.z.abs();
        let scale = 0.5 * self.side as f32 / if direction.z < 0.0 { -sum } else { sum };
        let half = 0.5 * self.side as f32;
        let cell = |along: f32| ((along * scale + half) as usize).min(self.side - 1);
        cell(direction.y) * self.side + cell(direction.x)
    }

    /// Lists the directions that are nearest to anything in a cell, given all of them at unit length.
    fn list_candidates(&mut self, cell_idx: usize, lines: &[DVec3], alike: &mut Vec<f64>) {
        let (row, column) = ((cell_idx / self.side) as f64, (cell_idx % self.side) as f64);
        let middle = self.unfold(column + 0.5, row + 0.5);
        // Cells overlap by what rounding may move a direction.
        let (low, high) = (-1e-4, 1.0 + 1e-4);
        let corners = [[low, low], [low, high], [high, low], [high, high]];
        let corners = corners.map(|[x, y]| self.unfold(column + x, row + y));
        let radius =
            corners.map(|corner| corner.angle_between(middle)).into_iter().fold(0.0, f64::max);
        alike.clear();
        alike.extend(lines.iter().map(|line| line.dot(middle).abs()));
        let nearest = alike.iter().copied().fold(0.0, f64::max).min(1.0).acos();
        let farthest = nearest + 2.0 * radius + ANGLE_SLACK;
        let least = farthest.min(FRAC_PI_2).cos();
        let near = alike.iter().enumerate().filter(|&(_, &alike)| alike >= least);
        self.candidates.extend(near.map(|(idx, _)| idx as u16));
    }

    /// The direction at a place of the square.
    fn unfold(&self, column: f64, row: f64) -> DVec3 {
        let along = |place: f64| 2.0 * place / self.side as f64 - 1.0;
        let (x, y) = (along(column), along(row));
        DVec3::new(x, y, 1.0 - x.abs() - y.abs()).normalize()
    }
}

fn fibonacci(count: usize) -> Vec<Vec3> {
    let turn = PI * (3.0 - 5.0_f64.sqrt());
    let place = |idx: usize| {
        let z = (idx as f64 + 0.5) / count as f64;
        let (sin, cos) = (turn * idx as f64).sin_cos();
        let radius = (1.0 - z * z).sqrt();
        DVec3::new(radius * cos, radius * sin, z).as_vec3()
    };
    (0..count).map(place).collect()
}

fn icosahedron(count: usize) -> Vec<Vec3> {
    let mut faces = icosahedron_faces();
    // Half of the faces look up; each becomes four.
    while 2 * faces.len() <= count {
        faces = faces.into_iter().flat_map(quarters).collect();
    }
    let center = |[a, b, c]: [DVec3; 3]| (a + b + c).normalize();
    let looks_up = |center: &DVec3| (center.z, center.y, center.x) > (0.0, 0.0, 0.0);
    faces.into_iter().map(center).filter(looks_up).map(DVec3::as_vec3).collect()
}

fn icosahedron_faces() -> Vec<[DVec3; 3]> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut corners = Vec::new();
    for (one, long) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        let [x, y, z] = [0.0, one, long];
        corners.extend([DVec3::new(x, y, z), DVec3::new(y, z, x), DVec3::new(z, x, y)]);
    }
    let mut faces = Vec::new();
    for (i, &a) in corners.iter().enumerate() {
        for (j, &b) in corners.iter().enumerate().skip(i + 1) {
            for &c in &corners[j + 1..] {
                let is_edge = |a: DVec3, b: DVec3| (a.distance(b) - 2.0).abs() < 1e-9;
                if is_edge(a, b) && is_edge(b, c) && is_edge(c, a) {
                    faces.push([a, b, c].map(DVec3::normalize));
                }
            }
        }
    }
    faces
}

/// The four faces between a face's corners and the middles of its edges.
fn quarters([a, b, c]: [DVec3; 3]) -> [[DVec3; 3]; 4] {
    let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
    [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
}

#[cfg(test)]
mod tests {
    use std::sync::LazyLock;

    use proptest::prelude::*;

    use super::*;

    /// The angle between two lines.
    fn line_angle(a: Vec3, b: DVec3) -> f64 {
        let a = a.as_dvec3();
        a.cross(b).length().atan2(a.dot(b).abs())
    }

    fn sets() -> Vec<DirectionSet> {
        let fibonacci = [1, 2, 7, 100, 1000].map(|count| (DirectionLayout::Fibonacci, count));
        let icosahedron = [10, 40, 650].map(|count| (DirectionLayout::Icosahedron, count));
        let all = fibonacci.into_iter().chain(icosahedron);
        all.map(|(layout, count)| DirectionSet::new(layout, count)).collect()
    }

    fn by_definition(set: &DirectionSet, direction: Vec3) -> usize {
        let (mut best, mut most) = (0, f32::NEG_INFINITY);
        for (idx, one) in set.directions().iter().enumerate() {
            let alike = one.dot(direction).abs();
            if alike > most {
                (best, most) = (idx, alike);
            }
        }
        best
    }

    #[test]
    fn sizes_are_what_was_asked_for() {
        let sizes: Vec<usize> = sets().iter().map(|set| set.directions().len()).collect();
        assert_eq!(sizes, [1, 2, 7, 100, 1000, 10, 40, 640]);
    }

    #[test]
    fn directions_are_spread_evenly() {
        for set in sets() {
            let count = set.directions().len();
            if count < 10 {
                continue;
            }
            // Were each in the middle of a disk of its share of the hemisphere, it would be this wide.
            let wide = 2.0 * (2.0 / count as f64).sqrt();
            for &one in set.directions() {
                assert!((one.length() - 1.0).abs() < 1e-6 && one.z > -1e-6, "{one}");
                let others = set.directions().iter().filter(|&&other| other != one);
                let nearest =
                    others.map(|&other| line_angle(other, one.as_dvec3())).fold(PI, f64::min);
                assert!(nearest > 0.4 * wide && nearest < 1.5 * wide, "{count}: {nearest}, {wide}");
            }
        }
    }

    #[test]
    fn a_look_up_asks_few_directions() {
        let set = DirectionSet::new(DirectionLayout::Fibonacci, 1000);
        let mean = set.candidates.len() as f64 / (set.side * set.side) as f64;
        assert!(mean < 10.0, "{mean} candidates a cell");
    }

    proptest! {
        #[test]
        fn the_nearest_direction_is_found(
            directions in prop::collection::vec(
                prop::array::uniform3(prop_oneof![3 => -1.0..1.0_f32, 1 => Just(0.0_f32),
                    1 => (-1.0..1.0_f32, -30..30_i32).prop_map(|(x, e)| x * 2.0_f32.powi(e))]),
                50),
        ) {
            static SETS: LazyLock<Vec<DirectionSet>> = LazyLock::new(sets);
            for set in SETS.iter() {
                for direction in directions.iter().map(|&direction| Vec3::from(direction)) {
                    prop_assume!(direction != Vec3::ZERO);
                    prop_assert_eq!(set.nearest(direction), by_definition(set, direction));
                }
            }
        }
    }
}
