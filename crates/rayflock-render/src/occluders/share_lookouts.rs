//! Points that see alike share a lookout: a point in their middle that is asked for all of them.
//!
//! ```text
//!   along a curve:   oooo oooo oooo oooo | oo  oo | o  o      sixteen that are close and face alike
//!   lookouts:               X            |   X    | X  X      share one, or four, or each has its own
//! ```
//!
//! Past soft spheres, what is seen of a light changes slowly from point to point: points within
//! some tenths of a sphere's radius see nearly the same. How bright the light is there changes
//! faster, and stays each point's own.
//!
//! **Source.** G. Nichols, J. Shopf, C. Wyman, "Hierarchical Image-Space Radiosity for Interactive
//! Global Illumination", EGSR 2009, for finding indirect light at as many places as it needs.
//!
//! **Departures.** Only visibility is shared, not light; in space, not in the picture, so that points
//! behind mirrors take part.
//!
//! **Invariants.** Every point is in one lookout; none lies farther than the reach from it.
//!
//! **Cost.** A sort; some tens of nanoseconds a point.

use glam::Vec3;
use rayflock_geom::simd::LANES;

use super::along_curve::place_on_curve;
use super::cluster::WeightedPoint;
use super::point_tile::PointTile;
use super::see_tile::SeenLight;

/// How many points share a lookout.
const SIZES: [usize; 5] = [64, 32, 16, 4, 1];

/// Lookouts of a tile, by how many points share one.
const TILE_LOOKOUTS: [usize; 5] = [32, 32, 64, 64, 256];

/// What points have in common that share a lookout.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Alike {
    /// So many share one at most.
    pub(crate) most: usize,
    /// They lie within this distance of their middle.
    pub(crate) reach: f32,
    /// Their unit normals lie within this distance of their mean.
    pub(crate) spread: f32,
    /// Whether points that face one side of a cube are looked at together: neighbours on an edge or
    /// a figure find more in a row that face alike, but tiles of lookouts become wider.
    pub(crate) by_side: bool,
}

/// Stands for no point.
const NO_POINT: u32 = u32::MAX;

/// Which points share lookouts; working memory, one a thread.
#[derive(Debug, Default)]
pub(crate) struct SharedLookouts {
    sorted: Vec<WeightedPoint>,
    /// Places of the points, lookout by lookout, for each size.
    members: [Vec<u32>; SIZES.len()],
    tile: LookoutTile,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
}

/// Lookouts that are close, and who shares them.
#[derive(Debug, Default)]
pub(crate) struct LookoutTile {
    /// The lookouts, as points that are asked about.
    pub(crate) lookouts: PointTile,
    /// Places of points, sixteen a block: lane i of a block is one that shares lookout i of its
    /// sixteen; `per_lookout` blocks follow each other for each sixteen lookouts. The last lanes of
    /// a block may stand for no point, and are `u32::MAX`.
    pub(crate) blocks: Vec<[u32; LANES]>,
    /// How many points share a lookout.
    pub(crate) per_lookout: usize,
    /// How far points lie from their lookout at most, and their normals from its.
    apart: Apart,
}

/// How much points differ from their lookout at most.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Apart {
    pub(super) position: f32,
    pub(super) normal: f32,
}

impl SharedLookouts {
    /// Shares out points with unit normals, as many of each; calls `each` with tiles that hold
    /// every point once. Those that share a lookout are `alike`.
    pub(crate) fn for_each_tile(
        &mut self,
        positions: &[Vec3],
        normals: &[Vec3],
        alike: Alike,
        mut each: impl FnMut(&LookoutTile),
    ) {
        self.share(positions, normals, alike);
        let Self { members, tile, positions: lookouts, normals: facing, .. } = self;
        for ((members, size), lookout_count) in members.iter().zip(SIZES).zip(TILE_LOOKOUTS) {
            for members in members.chunks(size * lookout_count) {
                lookouts.clear();
                facing.clear();
                tile.apart = Apart::default();
                for members in members.chunks(size) {
                    let (position, normal) = mean(positions, normals, members);
                    lookouts.push(position);
                    facing.push(normal);
                    for &member in members {
                        let member = member as usize;
                        tile.apart.include(positions[member] - position, normals[member] - normal);
                    }
                }
                tile.lookouts.assign(lookouts, facing);
                tile.assign_blocks(members, size);
                each(tile);
            }
        }
    }

    /// Finds out who shares with whom, the largest groups first.
    fn share(&mut self, positions: &[Vec3], normals: &[Vec3], alike: Alike) {
        let point = |(idx, &position)| WeightedPoint::at(position, idx);
        self.sorted.clear();
        self.sorted.extend((0_u32..).zip(positions).map(point));
        place_on_curve(&mut self.sorted);
        for point in self.sorted.iter_mut().filter(|_| alike.by_side) {
            point.code = (side(normals[point.idx as usize]) << 29) | (point.code >> 1);
        }
        self.sorted.sort_unstable_by_key(|point| (point.code, point.idx));
        self.members.iter_mut().for_each(Vec::clear);
        let mut rest = &self.sorted[..];
        while !rest.is_empty() {
            let sees_alike = |&size: &usize| {
                let group = rest.get(..size).filter(|_| size <= alike.most);
                size == 1 || group.is_some_and(|group| is_tight(group, normals, alike))
            };
            let choice = SIZES.iter().position(sees_alike).unwrap_or(SIZES.len() - 1);
            let (group, others) = rest.split_at(SIZES[choice]);
            self.members[choice].extend(group.iter().map(|point| point.idx));
            rest = others;
        }
    }
}

/// The side of a cube that a normal goes through, below 6.
fn side(normal: Vec3) -> u32 {
    let axis = normal.abs().max_position();
    2 * axis as u32 + u32::from(normal[axis] < 0.0)
}

/// Whether points lie close to their middle and face about the same way.
fn is_tight(group: &[WeightedPoint], normals: &[Vec3], alike: Alike) -> bool {
    let Alike { reach, spread, .. } = alike;
    let normal = |point: &WeightedPoint| normals[point.idx as usize];
    // Most that are not tight show that at their ends.
    if let [first, .., last] = group
        && first.position.distance_squared(last.position) > 4.0 * reach * reach
    {
        return false;
    }
    let scale = 1.0 / group.len() as f32;
    let middle = group.iter().map(|point| point.position).sum::<Vec3>() * scale;
    let axis = group.iter().map(normal).sum::<Vec3>() * scale;
    group.iter().all(|point| {
        point.position.distance_squared(middle) <= reach * reach
            && normal(point).distance_squared(axis) <= spread * spread
    })
}

/// The middle of points and their mean normal.
fn mean(positions: &[Vec3], normals: &[Vec3], members: &[u32]) -> (Vec3, Vec3) {
    if let &[alone] = members {
        return (positions[alone as usize], normals[alone as usize]);
    }
    let sum = |column: &[Vec3]| members.iter().map(|&idx| column[idx as usize]).sum::<Vec3>();
    (sum(positions) / members.len() as f32, sum(normals).normalize_or(Vec3::Y))
}

impl Apart {
    fn include(&mut self, position: Vec3, normal: Vec3) {
        self.position = self.position.max(position.length());
        self.normal = self.normal.max(normal.length());
    }
}

impl LookoutTile {
    /// Whether a light sends nothing to any point, since it lies behind their planes or they behind
    /// its own. `evenness` is added to the cosine at the light.
    pub(crate) fn faces_away(&self, light: &SeenLight, evenness: f32) -> bool {
        self.lookouts.faces_away(light, evenness, self.apart)
    }

    fn assign_blocks(&mut self, members: &[u32], size: usize) {
        self.per_lookout = size;
        self.blocks.clear();
        for members in members.chunks(LANES * size) {
            let first = self.blocks.len();
            self.blocks.resize(first + size, [NO_POINT; LANES]);
            for (lane, members) in members.chunks(size).enumerate() {
                for (block, &member) in self.blocks[first..].iter_mut().zip(members) {
                    block[lane] = member;
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn every_point_has_one_lookout_within_reach(
            cells in prop::collection::vec((0..60_i16, 0..60_i16, any::<bool>()), 0..700),
            most in prop::sample::select(&SIZES[..]),
        ) {
            const REACH: f32 = 0.1;
            let at = |&(x, y, is_up): &(i16, i16, bool)| {
                let height = if is_up { 0.02 } else { 0.0 };
                Vec3::new(0.03 * f32::from(x), height, 0.03 * f32::from(y))
            };
            let positions: Vec<_> = cells.iter().map(at).collect();
            let normals: Vec<_> =
                cells.iter().map(|cell| if cell.2 { Vec3::X } else { Vec3::Y }).collect();
            let mut found = vec![0; cells.len()];
            let mut sizes = Vec::new();
            let alike = Alike { most, reach: REACH, spread: 0.3, by_side: most > 16 };
            SharedLookouts::default().for_each_tile(&positions, &normals, alike, |tile| {
                assert!(tile.per_lookout <= most);
                sizes.push(tile.per_lookout);
                let per_cell = tile.blocks.chunks(tile.per_lookout);
                for (blocks, (lookouts, _)) in per_cell.zip(tile.lookouts.blocks()) {
                    for (lane, &point) in blocks.iter().flat_map(|block| block.iter().enumerate()) {
                        let Some(count) = found.get_mut(point as usize) else { continue };
                        *count += 1;
                        let of = |axes: &[[f32; LANES]; 3]| Vec3::from(axes.map(|axis| axis[lane]));
                        let apart = of(&lookouts.position).distance(positions[point as usize]);
                        assert!(apart <= 1.001 * REACH, "{apart}");
                        assert!(of(&lookouts.normal).dot(normals[point as usize]) > 0.9);
                    }
                }
            });
            prop_assert!(found.iter().all(|count| *count == 1));
            prop_assert!(sizes.is_sorted_by(|a, b| a >= b));
        }
    }

    #[test]
    fn sides_that_take_turns_do_not_keep_points_from_sharing() {
        let at = |i: u16| Vec3::new(f32::from(i), 0.0, 0.0) / 1024.0;
        let positions: Vec<_> = (0..1024).map(at).collect();
        let normals: Vec<_> = [Vec3::Y, Vec3::Z].into_iter().cycle().take(1024).collect();
        let alike = Alike { most: 64, reach: 0.1, spread: 0.3, by_side: true };
        let mut lookouts = 0;
        SharedLookouts::default().for_each_tile(&positions, &normals, alike, |tile| {
            lookouts += tile.lookouts.len();
        });
        assert_eq!(lookouts, 1024 / 64);
    }

    #[test]
    fn a_dense_floor_needs_few_lookouts() {
        let at = |i: u16| Vec3::new(f32::from(i % 64), 0.0, f32::from(i / 64)) / 64.0;
        let positions: Vec<_> = (0..4096).map(at).collect();
        let mut lookouts = 0;
        let normals = vec![Vec3::Y; positions.len()];
        let alike = Alike { most: 16, reach: 0.06, spread: 0.3, by_side: false };
        SharedLookouts::default().for_each_tile(&positions, &normals, alike, |tile| {
            lookouts += tile.lookouts.len();
        });
        assert!(lookouts < 300, "{lookouts} lookouts");
    }
}
