//! Clusters are within their bounds, and cuts grow slowly with the lights.

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
                true => {
                    VirtualLight::matte(position - (position.y + 1.0) * Vec3::Y, Vec3::Y, intensity)
                }
                false => VirtualLight::matte(position, normal.normalize_or(Vec3::Y), intensity),
            }
        },
    )
}

fn lobed() -> impl Strategy<Value = (VirtualLight, Lobe)> {
    (light(), vector(), color(), 0.0..1.0_f32).prop_map(|(light, to_source, highlight, varnish)| {
        let to_source = to_source.normalize_or(Vec3::Y);
        (light, Lobe { to_source, highlight, shininess: 20.0, varnish })
    })
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
        distant in prop::collection::vec((vector(), color()), 0..60),
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
            let mut light_count = 0;
            for member in &cut.members {
                let (mut sum, mut seen) = (Vec3::ZERO, Vec3::ZERO);
                for leaf in leaves(rules.tree, member.node_idx) {
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
    let light =
        |idx: u8| VirtualLight::matte(Vec3::new(f32::from(idx), 9.0, 0.0), Vec3::NEG_Y, Vec3::ONE);
    lights.assign(20.0, &(0..100).map(light).collect::<Vec<_>>(), &[], &[]);
    cuts.commit(&lights);
    let stats = cuts.gather(&lights, &[point], &mut Dark, &mut radiances);
    assert_eq!((radiances, stats.clusters, stats.stopped), ([Vec3::ZERO], 20, 1));
}
