//! The order of a tree's triangles, from frame to frame.
//!
//! A tree over the same triangles as the frame before may keep their order: then nothing is sorted
//! and only boxes are written anew. That is worth it where neighbours stay neighbours, as on a
//! character that walks, and ruinous where they do not. So the order is judged by what it gives:
//!
//! ```text
//!   spread = surfaces of the leaves' boxes / surfaces of the boxes around each triangle
//! ```
//!
//! An order along a curve whose spread has grown by half is given up, and the tree is built again;
//! after that, no order is kept for a frame, then for two, four ... One that has held for some
//! frames, or for one with many rays, is worth a better one: it is made anew by `split_greedily`,
//! and kept for as long as its spread is less than that of the curve was.
//!
//! **Source.** T. Larsson, T. Akenine-Moller, "Strategies for Bounding Volume Hierarchy Updates for
//! Ray Tracing of Deformable Models", 2003; C. Lauterbach et al., "RT-DEFORM", IEEE Symposium on
//! Interactive Ray Tracing 2006 (refitting, and rebuilding where the tree has got worse).
//! **Departures.** What is kept is an order, not a tree.

use crate::wanted::WantedLanes;

/// An order along a curve is given up when its spread is this many times what it was.
const WORST: f32 = 1.5;

/// Frames for which an order must have held to be worth a better one.
const PATIENCE: u32 = 4;

/// Rays for each triangle that make up for a better order: it takes some 320 ns a triangle, and
/// spares a ray of a picture 17 ns (museum7, two AVX-512 server cores).
const RAYS_A_TRIANGLE: usize = 20;

/// The most triangles that are ordered greedily, in one frame.
const MOST_GREEDY: usize = 1 << 17;

/// The longest time for which no order is kept, in frames.
const LONGEST_PAUSE: u32 = 64;

/// Slots in the order of the leaves, and how it has served. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct LeafOrder {
    pub(super) slots: Vec<u32>,
    /// What the order was made for.
    wanted: Vec<WantedLanes>,
    /// The spread when triangles were last ordered along a curve; `None` when that is this frame.
    curve_spread: Option<f32>,
    held_for: u32,
    /// Rays since triangles were last ordered along a curve.
    ray_count: usize,
    is_greedy: bool,
    /// Frames until an order is kept again.
    pause: u32,
    next_pause: u32,
}

/// How a tree is to be ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ordering {
    /// As it is.
    Keep,
    /// Greedily.
    Improve,
    /// Along a curve.
    Sort,
}

impl LeafOrder {
    /// What to do for the `wanted` triangles.
    pub(super) fn choose(&mut self, wanted: &[WantedLanes]) -> Ordering {
        if self.pause > 0 || self.wanted != wanted {
            self.pause = self.pause.saturating_sub(1);
            return Ordering::Sort;
        }
        self.held_for = self.held_for.saturating_add(1);
        if self.is_worth_improving() { Ordering::Improve } else { Ordering::Keep }
    }

    /// Takes note of a frame in which nothing was to be built. Returns whether it is time to build
    /// all the same, for a better order.
    pub(super) fn holds(&mut self) -> bool {
        self.held_for = self.held_for.saturating_add(1);
        self.is_worth_improving()
    }

    /// Takes note of rays that are sent through the tree.
    pub(super) const fn serve(&mut self, ray_count: usize) {
        self.ray_count = self.ray_count.saturating_add(ray_count);
    }

    fn is_worth_improving(&self) -> bool {
        let triangle_count = self.slots.len();
        let has_served = self.ray_count / RAYS_A_TRIANGLE >= triangle_count;
        let patience = if has_served { 1 } else { PATIENCE };
        let can_be = (1..=MOST_GREEDY).contains(&triangle_count);
        self.held_for >= patience && !self.is_greedy && can_be
    }

    /// Takes slots in a new order.
    pub(super) fn replace(
        &mut self,
        wanted: &[WantedLanes],
        slots: impl Iterator<Item = u32>,
        is_greedy: bool,
    ) {
        self.slots.clear();
        self.slots.extend(slots);
        self.wanted.clear();
        self.wanted.extend_from_slice(wanted);
        self.is_greedy = is_greedy;
        if !is_greedy {
            self.curve_spread = None;
            self.held_for = 0;
            self.ray_count = 0;
        }
    }

    /// Takes note of the spread of this frame. Returns whether the order is to be given up.
    pub(super) fn judge(&mut self, spread: f32) -> bool {
        if !spread.is_finite() {
            // All triangles are ignored, so nothing is known of the order when they appear.
            self.wanted.clear();
            return false;
        }
        let Some(curve_spread) = self.curve_spread else {
            self.curve_spread = Some(spread);
            return false;
        };
        if self.held_for >= PATIENCE {
            self.next_pause = 0;
        }
        let worst = if self.is_greedy { 1.0 } else { WORST };
        let is_bad = spread > worst * curve_spread;
        if is_bad {
            self.next_pause = (2 * self.next_pause).clamp(1, LONGEST_PAUSE);
            self.pause = self.next_pause;
        }
        is_bad
    }

    /// Bytes held.
    pub(super) fn memory_usage(&self) -> usize {
        4 * self.slots.capacity() + self.wanted.capacity() * size_of::<WantedLanes>()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lanes(count: u32) -> Vec<WantedLanes> {
        (0..count).map(|block_idx| WantedLanes { block_idx, lanes: 0xffff }).collect()
    }

    /// What is chosen frame by frame when kept orders have this spread, and new ones 1.
    fn choices(frame_count: usize, kept_spread: f32) -> Vec<Ordering> {
        let wanted = lanes(2);
        let mut order = LeafOrder::default();
        let mut choices = Vec::new();
        for _ in 0..frame_count {
            let choice = order.choose(&wanted);
            if choice != Ordering::Keep {
                order.replace(&wanted, 0..32, choice == Ordering::Improve);
            }
            if order.judge(if choice == Ordering::Keep { kept_spread } else { 1.0 }) {
                order.replace(&wanted, 0..32, false);
                order.judge(1.0);
            }
            choices.push(choice);
        }
        choices
    }

    #[test]
    fn an_order_that_holds_is_kept_and_improved_once() {
        let choices = choices(20, 0.9);
        assert_eq!(choices[0], Ordering::Sort);
        assert_eq!(choices[PATIENCE as usize], Ordering::Improve);
        let kept = choices.iter().filter(|&&choice| choice == Ordering::Keep);
        assert_eq!(kept.count(), 18);
    }

    #[test]
    fn an_order_that_many_rays_need_is_improved_at_once() {
        for (ray_count, expected) in [(639, Ordering::Keep), (640, Ordering::Improve)] {
            let mut order = LeafOrder::default();
            order.replace(&lanes(2), 0..32, false);
            order.serve(ray_count);
            assert_eq!(order.choose(&lanes(2)), expected, "{ray_count} rays");
        }
    }

    #[test]
    fn an_order_that_does_not_hold_is_tried_ever_less_often() {
        let choices = choices(100, 9.0);
        let tries: Vec<_> = (0..100).filter(|&frame| choices[frame] == Ordering::Keep).collect();
        assert_eq!(tries, [1, 3, 6, 11, 20, 37, 70]);
    }

    #[test]
    fn an_order_made_while_nothing_could_be_hit_is_not_kept() {
        let mut order = LeafOrder::default();
        order.replace(&lanes(2), 0..32, false);
        assert!(!order.judge(f32::NAN));
        assert_eq!(order.choose(&lanes(2)), Ordering::Sort);
        order.replace(&lanes(2), 0..32, false);
        assert!(!order.judge(1.0));
        assert_eq!(order.choose(&lanes(2)), Ordering::Keep);
    }

    #[test]
    fn an_order_for_other_triangles_is_not_kept() {
        let mut order = LeafOrder::default();
        order.replace(&lanes(2), 0..32, false);
        assert_eq!(order.choose(&lanes(3)), Ordering::Sort);
        assert_eq!(order.choose(&lanes(2)), Ordering::Keep);
    }
}
