//! Shapes are whole, whatever the primitives.

use glam::Vec3A;

use super::*;
use crate::bvh::tree_shape::Child;

fn boxed(slot: u32, min: Vec3A, size: f32) -> Boxed {
    Boxed { bounds: Bounds { min, max: min + size }, slot }
}

/// The shape of a tree over `prims`, and in which order they are then.
fn split(prims: Vec<Boxed>) -> (TreeShape, Vec<u32>) {
    let mut splitter = AreaSplitter { prims, ..AreaSplitter::default() };
    let mut shape = TreeShape::default();
    splitter.split_prims(&mut shape);
    (shape, splitter.prims.iter().map(|prim| prim.slot).collect())
}

/// Checks that each leaf hangs in one place, has up to sixteen primitives, and that all nodes
/// come after what hangs from them.
fn check_shape(shape: &TreeShape, prim_count: usize) {
    let mut has_parent = (vec![false; shape.links.len()], vec![false; shape.leaf_count()]);
    for (idx, links) in shape.links.iter().enumerate() {
        for child in links.children() {
            let had_parent = match child {
                Child::Node(child) => {
                    assert!(child < idx, "node {child} below {idx}");
                    std::mem::replace(&mut has_parent.0[child], true)
                }
                Child::Leaf(leaf) => std::mem::replace(&mut has_parent.1[leaf], true),
            };
            assert!(!had_parent, "{child:?} hangs in two places");
        }
    }
    assert_eq!(has_parent.0.iter().filter(|&&has_parent| !has_parent).count(), 1);
    assert!(has_parent.1.iter().all(|&has_parent| has_parent));
    let lens: Vec<_> = (0..shape.leaf_count()).map(|leaf| shape.leaf(leaf).len()).collect();
    assert!(lens.iter().all(|len| (1..=LANES).contains(len)), "{lens:?}");
    assert_eq!(lens.iter().sum::<usize>(), prim_count);
}

/// Four clusters of sixteen in disorder: each becomes a leaf.
#[test]
fn clusters_become_leaves() {
    let prims = (0..64).map(|idx| {
        let slot = idx * 37 % 64;
        let cluster = slot / 16;
        let corner = Vec3A::new((cluster % 2) as f32, (cluster / 2) as f32, 0.0) * 10.0;
        boxed(slot, corner + (slot % 16) as f32 * 0.01, 1.0)
    });
    let (shape, slots) = split(prims.collect());
    check_shape(&shape, 64);
    for leaf in 0..shape.leaf_count() {
        let slots = &slots[shape.leaf(leaf)];
        assert!(slots.iter().all(|slot| slot / 16 == slots[0] / 16), "{slots:?}");
    }
}

#[test]
fn any_number_of_primitives_has_a_tree() {
    for count in [1_u32, 2, 15, 16, 17, 31, 32, 33, 255, 256, 257, 300, 1000, 20_000] {
        let prims = (0..count).map(|slot| {
            let place = |factor: u32| (slot.wrapping_mul(factor) >> 8) as f32 * 1e-6;
            let min = Vec3A::new(place(2_654_435_761), place(40_503_001), place(97_001));
            boxed(slot, min, 0.1)
        });
        let (shape, mut slots) = split(prims.collect());
        check_shape(&shape, count as usize);
        slots.sort_unstable();
        assert!(slots.into_iter().eq(0..count), "{count} primitives");
    }
}

/// Primitives in one place, at places ever farther apart, and too far for areas to be finite.
#[test]
fn uneven_primitives_have_a_tree() {
    let places: [fn(u32) -> f32; 3] =
        [|_| 1.0, |slot| 1.05_f32.powi(slot as i32 - 1000), |slot| slot as f32 * 3e34];
    for (idx, place) in places.iter().enumerate() {
        let prims = (0..2000).map(|slot| boxed(slot, Vec3A::splat(place(slot)), 0.5));
        let (shape, _) = split(prims.collect());
        check_shape(&shape, 2000);
        assert!(shape.levels().count() < 40, "kind {idx}: {} levels", shape.levels().count());
    }
}
