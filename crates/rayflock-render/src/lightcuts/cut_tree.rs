//! Cuts through the tree of lights, one a point, found in rounds.
//!
//! ```text
//!   round:  open     each cluster whose bound exceeds the share of the sum: its halves     in parallel
//!           ask      what is seen of lights that did not speak before                      one batch
//!           add up   estimates times what is seen                                          in parallel
//! ```
//!
//! Of the halves, one has the light that spoke for both: what is seen of it is known.

use glam::Vec3;
use rayon::prelude::*;
use tracing::debug_span;

use super::bound::{CutPoint, GeometryBound, bound, estimate};
use super::cut_visibility::{CutPair, CutVisibility};
use super::light_tree::LightTree;
use crate::occluders::SeenLight;
use crate::shading::luminance::luminance;
use crate::vpl::{VirtualLights, VisibilityStats};

/// Points whose cuts are in memory at once: some tens of kilobytes each at most.
const POINTS_AT_ONCE: usize = 4096;

/// When a cut is good enough.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutSettings {
    /// No cluster may be wrong by more than this share of the sum, in luminance.
    pub error_bound: f32,
    /// Cuts have no more clusters than this.
    pub most_clusters: usize,
    /// Geometry terms (both cosines over the squared distance) above this count as this, so that no
    /// light is too bright; infinity bounds nothing.
    pub geometry_bound: f32,
}

impl Default for CutSettings {
    /// Two percent, a thousand clusters, as in the paper; no bound on geometry terms.
    fn default() -> Self {
        Self { error_bound: 0.02, most_clusters: 1000, geometry_bound: f32::INFINITY }
    }
}

/// What cuts took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct CutStats {
    /// Points.
    pub points: u64,
    /// Clusters in all cuts.
    pub clusters: u64,
    /// Clusters that were looked at.
    pub visited: u64,
    /// What visibility took.
    pub visibility: VisibilityStats,
    /// Cuts that were allowed no more clusters.
    pub stopped: u64,
}

impl std::ops::AddAssign for CutStats {
    fn add_assign(&mut self, other: Self) {
        self.points += other.points;
        self.clusters += other.clusters;
        self.visited += other.visited;
        self.visibility += other.visibility;
        self.stopped += other.stopped;
    }
}

/// Gathers light by cuts; keeps the tree and its memory.
#[derive(Debug, Default)]
pub struct Lightcuts {
    settings: CutSettings,
    tree: LightTree,
    cuts: Vec<Cut>,
    pairs: Vec<CutPair>,
    shares: Vec<f32>,
}

/// The cut of one point.
#[derive(Debug, Default)]
struct Cut {
    members: Vec<Member>,
    sum: Vec3,
    stats: CutStats,
}

/// A cluster of a cut.
#[derive(Clone, Copy, Debug)]
struct Member {
    /// Of the tree.
    node_idx: u32,
    light_idx: u32,
    /// Radiance, were all seen.
    estimate: Vec3,
    /// Of the luminance of all lights; 0 for one light.
    bound: f32,
    /// What is seen of the light that speaks; negative until that is known.
    share: f32,
}

const UNKNOWN: f32 = -1.0;

/// What does not change from point to point.
struct Rules<'a> {
    settings: CutSettings,
    lights: &'a VirtualLights,
    tree: &'a LightTree,
}

impl Lightcuts {
    /// No lights yet.
    pub fn new(settings: CutSettings) -> Self {
        Self { settings, ..Self::default() }
    }

    /// Changes the settings.
    pub const fn set(&mut self, settings: CutSettings) {
        self.settings = settings;
    }

    /// Makes the tree of `lights`.
    pub fn commit(&mut self, lights: &VirtualLights) {
        let _span = debug_span!("build_light_tree").entered();
        self.tree.build(lights);
    }

    /// Sets `radiances[i]` to what the lights of the tree, `lights`, send to the viewer by way of
    /// point i. `radiances.len() == points.len()`.
    pub fn gather(
        &mut self,
        lights: &VirtualLights,
        points: &[CutPoint],
        visibility: &mut dyn CutVisibility,
        radiances: &mut [Vec3],
    ) -> CutStats {
        let _span = debug_span!("cut_light_tree").entered();
        let mut stats = CutStats::default();
        let chunks = points.chunks(POINTS_AT_ONCE).zip(radiances.chunks_mut(POINTS_AT_ONCE));
        for (points, radiances) in chunks {
            stats.visibility += self.cut(lights, points, visibility);
            for (cut, radiance) in self.cuts.iter().zip(radiances) {
                *radiance = cut.sum;
                stats += cut.stats;
            }
        }
        stats
    }

    /// Makes the cuts those of `points`; returns what visibility took.
    fn cut(
        &mut self,
        lights: &VirtualLights,
        points: &[CutPoint],
        visibility: &mut dyn CutVisibility,
    ) -> VisibilityStats {
        let mut stats = VisibilityStats::default();
        let rules = Rules { settings: self.settings, lights, tree: &self.tree };
        self.cuts.resize_with(points.len(), Cut::default);
        let cuts = self.cuts.par_iter_mut().zip(points);
        cuts.for_each(|(cut, point)| cut.begin(&rules, point));
        loop {
            self.pairs.clear();
            for (cut, point) in self.cuts.iter().zip(points) {
                self.pairs.extend(cut.unknown().map(|member| rules.pair(point, member)));
            }
            self.shares.clear();
            self.shares.resize(self.pairs.len(), 0.0);
            if !self.pairs.is_empty() {
                stats += visibility.shares(&self.pairs, &mut self.shares);
            }
            let mut shares = &self.shares[..];
            for cut in &mut self.cuts {
                shares = cut.learn(shares);
            }
            let cuts = self.cuts.par_iter_mut().zip(points);
            let opened =
                cuts.map(|(cut, point)| usize::from(cut.open(&rules, point))).sum::<usize>();
            if opened == 0 {
                return stats;
            }
        }
    }

    /// Bytes held.
    pub fn memory_usage(&self) -> usize {
        let cuts = self.cuts.iter().map(|cut| cut.members.capacity() * size_of::<Member>());
        self.tree.memory_usage()
            + cuts.sum::<usize>()
            + self.cuts.capacity() * size_of::<Cut>()
            + self.pairs.capacity() * size_of::<CutPair>()
            + self.shares.capacity() * size_of::<f32>()
    }
}

impl Rules<'_> {
    /// The cluster as a member of a cut, if it can send anything to the point.
    fn member(&self, point: &CutPoint, node_idx: u32, known: Option<&Member>) -> Option<Member> {
        let cluster = self.tree.cluster(node_idx);
        let limit = GeometryBound(self.settings.geometry_bound);
        let most = bound(self.lights, cluster, point, limit);
        if most <= 0.0 {
            return None;
        }
        let estimate = estimate(self.lights, cluster, point, limit);
        // A light that sends the point nothing does so for every cluster that it speaks for.
        let share = match known {
            Some(known) if known.light_idx == cluster.light_idx => known.share,
            _ if estimate == Vec3::ZERO => 0.0,
            _ => UNKNOWN,
        };
        let bound = if cluster.light_count == 1 { 0.0 } else { most };
        let light_idx = cluster.light_idx;
        Some(Member { node_idx, light_idx, estimate, bound, share })
    }

    fn pair(&self, point: &CutPoint, member: &Member) -> CutPair {
        let light_idx = member.light_idx as usize;
        let position = self.lights.end_of_way(light_idx, point.position);
        let light = SeenLight { position, normal: self.lights.normals()[light_idx] };
        CutPair { point: point.position, normal: point.normal, light }
    }
}

impl Cut {
    /// Starts with the whole tree.
    fn begin(&mut self, rules: &Rules<'_>, point: &CutPoint) {
        self.stats = CutStats { points: 1, ..CutStats::default() };
        self.members.clear();
        for root in rules.tree.roots() {
            self.stats.visited += 1;
            self.members.extend(rules.member(point, root, None));
        }
    }

    /// Members whose light has to be asked about.
    fn unknown(&self) -> impl Iterator<Item = &Member> {
        self.members.iter().filter(|member| member.share == UNKNOWN)
    }

    /// Takes the answers from the front of `shares`, adds up, and returns the rest.
    fn learn<'a>(&mut self, mut shares: &'a [f32]) -> &'a [f32] {
        self.sum = Vec3::ZERO;
        for member in &mut self.members {
            if member.share == UNKNOWN
                && let Some((share, rest)) = shares.split_first()
            {
                (member.share, shares) = (*share, rest);
            }
            self.sum += member.share * member.estimate;
        }
        self.stats.clusters = self.members.len() as u64;
        shares
    }

    /// Opens every cluster that may be too wrong; whether there was any.
    fn open(&mut self, rules: &Rules<'_>, point: &CutPoint) -> bool {
        let most = rules.settings.error_bound * luminance(self.sum);
        let count = self.members.len();
        let mut kept = 0;
        let mut opened = false;
        for idx in 0..count {
            let member = self.members[idx];
            let is_wrong = member.bound > most;
            let halves = is_wrong.then(|| rules.tree.children(member.node_idx)).flatten();
            // What is still to be looked at, and the halves of what was opened, are members too.
            let is_full = self.members.len() - (idx - kept) >= rules.settings.most_clusters;
            match halves {
                Some(halves) if !is_full => {
                    opened = true;
                    self.stats.visited += 2;
                    let halves = halves.map(|half| rules.member(point, half, Some(&member)));
                    self.members.extend(halves.into_iter().flatten());
                }
                _ => {
                    self.stats.stopped += u64::from(halves.is_some() && self.stats.stopped == 0);
                    self.members[kept] = member;
                    kept += 1;
                }
            }
        }
        self.members.drain(kept..count);
        opened
    }
}

#[cfg(test)]
mod tests;
