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

use super::bound::{CutPoint, GeometryBound, bound, estimate, from_distant};
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
    /// Cuts have no more clusters than this, distant lights not counted.
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
    /// Clusters in all cuts, distant lights included.
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

/// A cluster of a cut, or a distant light.
#[derive(Clone, Copy, Debug)]
struct Member {
    /// Of the tree; `None` for a distant light.
    node_idx: Option<u32>,
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
        let has_lobes = self.lights.lobe(cluster.light_idx as usize).is_some();
        let most = bound(cluster, has_lobes, point, limit);
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
        Some(Member { node_idx: Some(node_idx), light_idx, estimate, bound, share })
    }

    fn distant(&self, point: &CutPoint, light_idx: usize) -> Option<Member> {
        let estimate = from_distant(self.lights, light_idx, point);
        let light_idx = light_idx as u32;
        let member = Member { node_idx: None, light_idx, estimate, bound: 0.0, share: UNKNOWN };
        (estimate != Vec3::ZERO).then_some(member)
    }

    fn pair(&self, point: &CutPoint, member: &Member) -> CutPair {
        let light_idx = member.light_idx as usize;
        let position = self.lights.end_of_way(light_idx, point.position);
        let light = SeenLight { position, normal: self.lights.normals()[light_idx] };
        CutPair { point: point.position, normal: point.normal, light }
    }
}

impl Cut {
    /// Starts with the whole tree and the distant lights.
    fn begin(&mut self, rules: &Rules<'_>, point: &CutPoint) {
        self.stats = CutStats { points: 1, ..CutStats::default() };
        self.members.clear();
        self.members.extend(rules.lights.distant().filter_map(|idx| rules.distant(point, idx)));
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
            let halves = match member.node_idx {
                Some(node_idx) if member.bound > most => rules.tree.children(node_idx),
                _ => None,
            };
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
mod tests {
    use proptest::prelude::*;

    use super::super::cut_visibility::Open;
    use super::*;
    use crate::vpl::{Lobe, VirtualLight};

    fn vector() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(-1.0..1.0_f32).prop_map(Vec3::from)
    }

    fn color() -> impl Strategy<Value = Vec3> {
        prop::array::uniform3(0.0..1.0_f32).prop_map(Vec3::from)
    }

    fn light() -> impl Strategy<Value = VirtualLight> {
        (vector(), vector(), color(), prop::bool::weighted(0.2)).prop_map(
            |(position, normal, intensity, is_even)| {
                // Half of the lights lie on a floor and face up.
                match position.x < 0.0 {
                    _ if is_even => VirtualLight::even(position, intensity),
                    true => VirtualLight::matte(
                        position - (position.y + 1.0) * Vec3::Y,
                        Vec3::Y,
                        intensity,
                    ),
                    false => VirtualLight::matte(position, normal.normalize_or(Vec3::Y), intensity),
                }
            },
        )
    }

    fn lobed() -> impl Strategy<Value = (VirtualLight, Lobe)> {
        (light(), vector(), color(), 0.0..1.0_f32).prop_map(
            |(light, to_source, highlight, varnish)| {
                let to_source = to_source.normalize_or(Vec3::Y);
                (light, Lobe { to_source, highlight, shininess: 20.0, varnish })
            },
        )
    }

    fn point() -> impl Strategy<Value = CutPoint> {
        (vector(), vector(), color(), color()).prop_map(|(position, normal, diffuse, specular)| {
            let normal = normal.normalize_or(Vec3::Y);
            let to_viewer = (normal + 0.5 * Vec3::X).normalize_or(Vec3::Y);
            CutPoint { position, normal, to_viewer, diffuse, specular, shininess: 10.0 }
        })
    }

    /// The lights of a cluster, one by one.
    fn leaves(tree: &LightTree, node_idx: u32) -> Vec<u32> {
        match tree.children(node_idx) {
            None => vec![node_idx],
            Some(halves) => halves.into_iter().flat_map(|half| leaves(tree, half)).collect(),
        }
    }

    /// Every second light is half hidden.
    #[derive(Debug)]
    struct Striped;

    impl CutVisibility for Striped {
        fn shares(&mut self, pairs: &[CutPair], shares: &mut [f32]) -> VisibilityStats {
            for (pair, share) in pairs.iter().zip(shares) {
                *share = if pair.light.position.x.to_bits() % 2 == 0 { 0.5 } else { 1.0 };
            }
            VisibilityStats::default()
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn no_cluster_of_a_cut_is_wrong_by_more_than_its_share(
            plain in prop::collection::vec(light(), 0..200),
            lobed in prop::collection::vec(lobed(), 0..60),
            distant in prop::collection::vec((vector(), color()), 0..3),
            points in prop::collection::vec(point(), 1..6),
            error_bound in prop_oneof![Just(0.02_f32), Just(0.1)],
        ) {
            let distant: Vec<_> = distant
                .into_iter()
                .map(|(v, color)| VirtualLight::distant(v.normalize_or(Vec3::Y), color))
                .collect();
            let mut lights = VirtualLights::new(4.0);
            lights.assign(4.0, &plain, &lobed, &distant);
            let settings = CutSettings { error_bound, geometry_bound: 400.0, ..CutSettings::default() };
            let mut cuts = Lightcuts::new(settings);
            cuts.commit(&lights);
            let mut radiances = vec![Vec3::ZERO; points.len()];
            let stats = cuts.gather(&lights, &points, &mut Striped, &mut radiances);
            prop_assert_eq!((stats.points, stats.stopped), (points.len() as u64, 0));

            let rules = Rules { settings, lights: &lights, tree: &cuts.tree };
            let limit = GeometryBound(settings.geometry_bound);
            for ((cut, point), radiance) in cuts.cuts.iter().zip(&points).zip(&radiances) {
                let mut light_count = lights.distant().len();
                for member in &cut.members {
                    let Some(node_idx) = member.node_idx else { continue };
                    let (mut sum, mut seen) = (Vec3::ZERO, Vec3::ZERO);
                    for leaf in leaves(rules.tree, node_idx) {
                        let one = estimate(&lights, rules.tree.cluster(leaf), point, limit);
                        let mut share = [0.0];
                        let leaf = rules.member(point, leaf, None);
                        leaf.iter().for_each(|leaf| {
                            Striped.shares(&[rules.pair(point, leaf)], &mut share);
                        });
                        sum += one;
                        seen += one * share[0];
                        light_count += 1;
                    }
                    // The bound holds, seen or not, and it is small enough.
                    if member.bound > 0.0 {
                        prop_assert!(luminance(sum) <= member.bound);
                        prop_assert!(luminance(member.estimate) <= member.bound);
                        let error = luminance(member.share * member.estimate - seen).abs();
                        prop_assert!(error <= error_bound * luminance(*radiance) * 1.001);
                    } else {
                        prop_assert!((member.share * member.estimate).distance(seen) <= 1e-4 * sum.length());
                    }
                }
                prop_assert!(light_count <= lights.len());
            }
        }
    }

    #[test]
    fn a_cut_through_many_more_lights_is_little_larger() {
        let lights = |count: u32| {
            let light = |idx: u32| {
                // On the floor and two walls of a box, evenly.
                let at = |base: u32| (idx as f32 * (1.0 / (base as f32).sqrt())).fract();
                let (u, v) = (at(2), at(3));
                let (position, normal) = match idx % 3 {
                    0 => (Vec3::new(u, 0.0, v), Vec3::Y),
                    1 => (Vec3::new(0.0, u, v), Vec3::X),
                    _ => (Vec3::new(u, v, 0.0), Vec3::Z),
                };
                VirtualLight::matte(position, normal, Vec3::ONE / count as f32)
            };
            let mut lights = VirtualLights::default();
            lights.assign(2.0, &(0..count).map(light).collect::<Vec<_>>(), &[], &[]);
            lights
        };
        let points: Vec<_> = (0..64_u8)
            .map(|idx| CutPoint {
                position: Vec3::new(0.8, 0.3 + f32::from(idx) / 100.0, 0.5),
                normal: Vec3::new(-0.8, 0.0, 0.6),
                to_viewer: Vec3::Z,
                diffuse: Vec3::splat(0.7),
                specular: Vec3::ZERO,
                shininess: 1.0,
            })
            .collect();
        let cut = |count: u32| {
            let settings = CutSettings { geometry_bound: 400.0, ..CutSettings::default() };
            let (lights, mut cuts) = (lights(count), Lightcuts::new(settings));
            cuts.commit(&lights);
            let mut radiances = vec![Vec3::ZERO; points.len()];
            let stats = cuts.gather(&lights, &points, &mut Open, &mut radiances);
            (stats, radiances)
        };
        let ((few, few_sums), (many, many_sums)) = (cut(1 << 10), cut(1 << 16));
        assert!(many.visibility.pairs <= 8 * few.visibility.pairs, "{few:?} {many:?}");
        assert!(many.visited <= 8 * few.visited, "{few:?} {many:?}");
        for (few, many) in few_sums.iter().zip(&many_sums) {
            assert!(few.distance(*many) < 0.1 * many.length(), "{few} {many}");
        }
    }

    #[test]
    fn cuts_end_without_lights_and_in_the_dark() {
        let mut cuts = Lightcuts::new(CutSettings { most_clusters: 20, ..CutSettings::default() });
        let mut lights = VirtualLights::new(1.0);
        cuts.commit(&lights);
        let point = CutPoint {
            position: Vec3::ZERO,
            normal: Vec3::Y,
            to_viewer: Vec3::Y,
            diffuse: Vec3::ONE,
            specular: Vec3::ZERO,
            shininess: 1.0,
        };
        let mut radiances = [Vec3::ONE];
        let stats = cuts.gather(&lights, &[point], &mut Open, &mut radiances);
        assert_eq!((radiances, stats.clusters), ([Vec3::ZERO], 0));

        // All lights are hidden: no cluster is ever good enough.
        #[derive(Debug)]
        struct Dark;
        impl CutVisibility for Dark {
            fn shares(&mut self, _: &[CutPair], shares: &mut [f32]) -> VisibilityStats {
                shares.fill(0.0);
                VisibilityStats::default()
            }
        }
        let light = |idx: u8| {
            VirtualLight::matte(Vec3::new(f32::from(idx), 9.0, 0.0), Vec3::NEG_Y, Vec3::ONE)
        };
        lights.assign(20.0, &(0..100).map(light).collect::<Vec<_>>(), &[], &[]);
        cuts.commit(&lights);
        let stats = cuts.gather(&lights, &[point], &mut Dark, &mut radiances);
        assert_eq!((radiances, stats.clusters, stats.stopped), ([Vec3::ZERO], 20, 1));
    }
}
