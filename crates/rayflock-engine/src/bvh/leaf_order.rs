//! The order of a tree's triangles, from frame to frame.
//!
//! A tree over the same triangles as the frame before may keep their order and its shape: then
//! nothing is sorted and only boxes are written anew. That is worth it where neighbours stay
//! neighbours, as on a character that walks, and ruinous where they do not. So the order is judged
//! by what it gives:
//!
//! ```text
//!   spread = surfaces of the leaves' boxes / surfaces of the boxes around each triangle
//! ```
//!
//! An order whose spread has grown by half is given up, and the tree is built again; after that, no
//! order is kept for a frame, then for two, four ...
//!
//! How much time an order is worth is told by the rays. What they lose to one along a curve is
//! counted, and less of it where the spread of a better one has grown; once that is as much as a
//! better one takes, `split_by_area` makes one. A batch is counted before it is traced, so one of
//! many rays gets a good tree at once. Of a tree that rests, at most about twice as much is lost as
//! by whoever knows what comes; where triangles are written in each frame, the first eight rays a
//! triangle do not count, for they only make up for more leaves.
//!
//! **Source.** T. Larsson, T. Akenine-Moller, "Strategies for Bounding Volume Hierarchy Updates for
//! Ray Tracing of Deformable Models", 2003; C. Lauterbach et al., "RT-DEFORM", IEEE Symposium on
//! Interactive Ray Tracing 2006 (refitting, and rebuilding where the tree has got worse); R. Karp,
//! "On-line Algorithms Versus Off-line Algorithms", 1992 (to rent until one could have bought).

use crate::wanted::WantedLanes;

/// An order is given up when its spread is this many times what it was.
const WORST: f32 = 1.5;

/// Frames for which an order must have held so that it did not come too late.
const PATIENCE: u32 = 4;

/// Rays for each triangle that lose as much to an order along a curve as a better one takes: 130 ns
/// a triangle, and 3 to 19 ns a ray (two AVX-512 server cores).
const RAYS_A_TRIANGLE: f32 = 16.0;

/// Rays for each triangle that only make up for what a tree by area takes longer to write in each
/// frame, as it has more leaves: 5 ns a triangle (pigman, the same cores).
const RAYS_A_WRITTEN_TRIANGLE: f32 = 8.0;

/// The share of it that is lost by a spread that is twice what it was; orders by area have about
/// two thirds of the spread of a curve.
const LOST_BY_SPREAD: f32 = 2.0;

/// The longest time for which no order is kept, in frames.
const LONGEST_PAUSE: u32 = 64;

/// Slots in the order of the leaves, and how it has served. See the [module](self).
#[derive(Debug, Default)]
pub(super) struct LeafOrder {
    pub(super) slots: Vec<u32>,
    /// What the order was made for.
    wanted: Vec<WantedLanes>,
    /// The spread when triangles were last ordered; `None` when that is this frame.
    first_spread: Option<f32>,
    held_for: u32,
    is_split: bool,
    /// What each ray loses to the order, as a share of what it loses to one along a curve.
    loss: f32,
    /// What all rays have lost to it.
    lost: f32,
    /// Frames until an order is kept again.
    pause: u32,
    next_pause: u32,
}

/// How a tree is to be ordered.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ordering {
    /// As it is.
    Keep,
    /// By area.
    Split,
    /// Along a curve.
    Sort,
}

impl LeafOrder {
    /// What to do for the `wanted` triangles, with so many rays to come.
    pub(super) fn choose(&mut self, wanted: &[WantedLanes], ray_count: usize) -> Ordering {
        if self.pause > 0 || wanted.is_empty() || self.wanted != wanted {
            self.pause = self.pause.saturating_sub(1);
            let lanes = wanted.iter().map(|wanted| wanted.lanes.count_ones() as usize);
            return Self::make_for(lanes.sum(), ray_count);
        }
        self.held_for = self.held_for.saturating_add(1);
        if !self.is_split {
            let paid = RAYS_A_WRITTEN_TRIANGLE * self.slots.len() as f32;
            self.lost = (self.lost - paid).max(0.0);
        }
        if self.is_worth_splitting(ray_count) { Ordering::Split } else { Ordering::Keep }
    }

    /// How to make an order that was not there before.
    pub(super) fn make_for(triangle_count: usize, ray_count: usize) -> Ordering {
        let is_worth_it = ray_count as f32 >= RAYS_A_TRIANGLE * triangle_count as f32;
        if is_worth_it && triangle_count > 0 { Ordering::Split } else { Ordering::Sort }
    }

    /// Whether a better order has become worth its time, with so many rays to come.
    pub(super) fn is_worth_splitting(&self, ray_count: usize) -> bool {
        let lost = self.lost + self.loss * ray_count as f32;
        !self.slots.is_empty() && lost > RAYS_A_TRIANGLE * self.slots.len() as f32
    }

    /// Takes note of rays that are sent through the tree.
    pub(super) fn serve(&mut self, ray_count: usize) {
        self.lost += self.loss * ray_count as f32;
    }

    /// Takes note that the slots have a new order, for the `wanted` triangles.
    pub(super) fn replaced(&mut self, wanted: &[WantedLanes], is_split: bool) {
        if self.wanted != wanted {
            self.wanted.clear();
            self.wanted.extend_from_slice(wanted);
        }
        self.remade(is_split);
    }

    /// Takes note that the slots have a better order, for the same triangles.
    pub(super) fn improved(&mut self) {
        self.remade(true);
    }

    fn remade(&mut self, is_split: bool) {
        self.is_split = is_split;
        self.first_spread = None;
        self.held_for = 0;
        (self.loss, self.lost) = (0.0, 0.0);
    }

    /// Takes note of the spread of this frame. Returns whether the order is to be given up.
    pub(super) fn judge(&mut self, spread: f32) -> bool {
        if !spread.is_finite() {
            // All triangles are ignored, or areas have no numbers: nothing is known of the order.
            self.wanted.clear();
            return false;
        }
        let growth = spread / *self.first_spread.get_or_insert(spread);
        self.loss = if self.is_split { LOST_BY_SPREAD * (growth - 1.0).max(0.0) } else { 1.0 };
        if self.held_for >= PATIENCE {
            self.next_pause = 0;
        }
        let is_bad = growth > WORST;
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

    /// The order of 32 triangles.
    fn order_of_two_blocks() -> LeafOrder {
        let mut order = LeafOrder { slots: (0..32).collect(), ..LeafOrder::default() };
        order.replaced(&lanes(2), false);
        order.judge(1.0);
        order
    }

    /// What is chosen frame by frame when kept orders have this spread, and new ones 1.
    fn choices(frame_count: usize, kept_spread: f32, rays_a_frame: usize) -> Vec<Ordering> {
        let wanted = lanes(2);
        let mut order = LeafOrder { slots: (0..32).collect(), ..LeafOrder::default() };
        let mut choices = Vec::new();
        for _ in 0..frame_count {
            let choice = order.choose(&wanted, rays_a_frame);
            if choice != Ordering::Keep {
                order.replaced(&wanted, choice == Ordering::Split);
            }
            if order.judge(if choice == Ordering::Keep { kept_spread } else { 1.0 }) {
                let made = LeafOrder::make_for(32, rays_a_frame);
                order.replaced(&wanted, made == Ordering::Split);
                order.judge(1.0);
            }
            order.serve(rays_a_frame);
            choices.push(choice);
        }
        choices
    }

    #[test]
    fn an_order_that_holds_is_kept_and_improved_once() {
        let choices = choices(20, 0.9, 400);
        let expected = |frame: usize| match frame {
            0 => Ordering::Sort,
            1 => Ordering::Split,
            _ => Ordering::Keep,
        };
        assert!(choices.iter().copied().eq((0..20).map(expected)), "{choices:?}");
    }

    #[test]
    fn an_order_that_many_rays_need_is_a_good_one_at_once() {
        for (ray_count, expected) in [(511, Ordering::Sort), (512, Ordering::Split)] {
            let choice = LeafOrder::default().choose(&lanes(2), ray_count);
            assert_eq!(choice, expected, "{ray_count} rays");
        }
        let mut order = order_of_two_blocks();
        assert!(!order.is_worth_splitting(512));
        assert!(order.is_worth_splitting(513));
        order.serve(500);
        assert!(order.is_worth_splitting(13));
        assert_eq!(order.choose(&[], 1_000_000), Ordering::Sort);
    }

    #[test]
    fn few_rays_in_each_frame_are_not_worth_a_good_order() {
        let choices = choices(100, 0.9, 250);
        assert!(choices[1..].iter().all(|&choice| choice == Ordering::Keep), "{choices:?}");
    }

    #[test]
    fn a_good_order_is_made_anew_as_its_spread_grows() {
        let mut order = order_of_two_blocks();
        order.replaced(&lanes(2), true);
        order.judge(1.0);
        assert!(!order.is_worth_splitting(1_000_000));
        assert!(!order.judge(1.25));
        assert!(order.is_worth_splitting(1025));
        assert!(!order.is_worth_splitting(1023));
    }

    #[test]
    fn an_order_that_does_not_hold_is_tried_ever_less_often() {
        let choices = choices(100, 9.0, 0);
        let tries: Vec<_> = (0..100).filter(|&frame| choices[frame] == Ordering::Keep).collect();
        assert_eq!(tries, [1, 3, 6, 11, 20, 37, 70]);
    }

    #[test]
    fn an_order_made_while_nothing_could_be_hit_is_not_kept() {
        let mut order = LeafOrder::default();
        order.replaced(&lanes(2), false);
        assert!(!order.judge(f32::NAN));
        assert_eq!(order.choose(&[], 0), Ordering::Sort);
        assert_eq!(order.choose(&lanes(2), 0), Ordering::Sort);
        order.replaced(&lanes(2), false);
        assert!(!order.judge(1.0));
        assert_eq!(order.choose(&lanes(2), 0), Ordering::Keep);
    }

    #[test]
    fn an_order_for_other_triangles_is_not_kept() {
        let mut order = order_of_two_blocks();
        assert_eq!(order.choose(&lanes(3), 0), Ordering::Sort);
        assert_eq!(order.choose(&lanes(2), 0), Ordering::Keep);
    }
}
