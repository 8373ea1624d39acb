//! Many lights at the cost of few: clusters of lights stand for their members where that cannot be
//! told from all of them.
//!
//! ```text
//!   VirtualLights -- LightTree::build --> a binary tree; each cluster knows what its lights may
//!                                         send at most, and one that speaks for all
//!   point ---------- cut_tree ----------> from the root down, wherever a cluster may be wrong by
//!                                         more than a share of the sum so far
//!                    CutVisibility: rays or spheres, asked about all points' new clusters at once
//! ```
//!
//! **Source.** B. Walter, S. Fernandez, A. Arbree, K. Bala, M. Donikian, D. Greenberg, "Lightcuts: A
//! Scalable Approach to Illumination", SIGGRAPH 2005. The tree is made from the top, after B.
//! Walter, A. Arbree, K. Bala, D. Greenberg, "Multidimensional Lightcuts", SIGGRAPH 2006.
//!
//! **Departures.** Points go down the tree in rounds, so that visibility is asked in batches: in a
//! round all clusters that are too uncertain are opened, not only the worst, which opens a few more
//! than need be. Lights with highlights have a tree of their own, whose bounds do not know where
//! their lights shine; distant lights are in every cut. Reconstruction cuts are left out.
//!
//! **Invariants.** A cluster's lights never send more than its bound, seen through anything; every
//! cluster of a finished cut is one light, or its bound is below the share of the sum, or the cut
//! has as many clusters as allowed. (property tests)
//!
//! **Cost.** n log n for the tree of n lights; a cut has some tens to hundreds of clusters, which
//! grows more slowly than the logarithm of the number of lights.

mod bound;
mod cut_tree;
mod cut_visibility;
mod light_tree;

pub use bound::CutPoint;
pub use cut_tree::{CutSettings, CutStats, Lightcuts};
pub use cut_visibility::{CutPair, CutVisibility, Exact, Open, PastSpheres};
