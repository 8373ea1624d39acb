//! Settings of the engine of parallel subfields.

use rayflock_geom::simd::SimdLevel;

use super::direction_set::DirectionLayout;

/// Settings of [`SubfieldsEngine`](super::SubfieldsEngine). As text they are words joined by `+`,
/// see [`Config::from_str`](std::str::FromStr).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Config {
    /// Instruction set; the widest of the machine by default.
    pub simd: SimdLevel,
    /// When subfields are brought up to date, and who waits for whom.
    pub policy: UpdatePolicy,
    /// How a tile holds what moves.
    pub moving_order: TileOrder,
    /// Tiles are made smaller as long as so many primitives are left in each, on the average.
    pub fewest_in_tile: u16,
    /// Whether complex objects get subfields of their own.
    pub nesting: Nesting,
    /// How directions are spread over the hemisphere.
    pub layout: DirectionLayout,
    /// How many directions there are for rays that do not share one; `None`, the default, follows
    /// from the numbers of rays and primitives. More than 4096 are taken as 4096.
    pub direction_count: Option<usize>,
    /// Bytes that all grids together may take; those not used for longest are given up first. One
    /// direction is always kept, and one of each nested object. Under the policies that hold a whole
    /// set, `direction_count` comes first.
    pub budget: usize,
}

/// When subfields are brought up to date.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum UpdatePolicy {
    /// When a batch first wants them: it is sorted by direction, what occurs is brought up to date
    /// in parallel, each once, then rays are traced.
    #[default]
    OnDemand,
    /// All that are held, at every commit.
    Eager,
    /// When a ray first wants one: the ray's thread does it, others that want the same one wait.
    /// This is the paper's on-demand update.
    Locked,
}

/// How the primitives of a tile are held.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum TileOrder {
    /// From near to far, with the depths of each sixteen: a 1D BSP without nodes.
    #[default]
    Depth,
    /// As they come, all to be tested: the paper's list.
    List,
}

/// Whether complex objects get subfields of their own.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Nesting {
    /// Where it pays: objects of 4096 triangles or more that move without changing their shape, or
    /// that are small for their triangles.
    #[default]
    Automatic,
    /// Never.
    Off,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            simd: SimdLevel::default(),
            policy: UpdatePolicy::default(),
            moving_order: TileOrder::default(),
            fewest_in_tile: 10,
            nesting: Nesting::default(),
            layout: DirectionLayout::default(),
            direction_count: None,
            budget: 1 << 30,
        }
    }
}
