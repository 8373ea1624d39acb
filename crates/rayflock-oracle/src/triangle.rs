//! Whether a ray passes through a triangle whose vertices may be moved a little.
//!
//! Seen along the ray a triangle is three points in a plane, and the ray is the origin of that
//! plane. An engine may act as if vertex `i` were moved by `slack[i]`. Such a move carries no
//! edge over the origin if each point of each edge lies farther from the origin than it can be
//! moved; then the answer is certain. The weights of the vertices are the cross products of the
//! other two; what the moves and the rounding of those products do to them bounds `t`.
//!
//! **Invariants**: `f64` rounds by `2^-52` of a coordinate, the slack is `2^-20` of it, so the
//! oracle's own rounding is far inside its slack and needs no exact arithmetic.

use glam::{DVec2, DVec3};

use super::candidate::{Crossing, TRange, Verdict};
use super::ray::{OracleRay, Seen};
use super::{ABSOLUTE_SLACK, OVERFLOW, RELATIVE_SLACK};

/// The part of a product of two lengths that an engine's `f32` may lose, `2^-21`.
const PRODUCT_SLACK: f64 = 1.0 / (1_u64 << 21) as f64;

/// The part of a product of two lengths below which `f64` cannot be sure of a sign, `2^-46`.
const SIGN_NOISE: f64 = 1.0 / (1_u64 << 46) as f64;

/// A triangle in world space.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) corners: [DVec3; 3],
    /// How far rounding of the object's transform may have moved each corner.
    pub(super) slack: [f64; 3],
}

/// The point that barycentric coordinates name, relative to a ray.
#[derive(Clone, Copy, Debug)]
pub(super) struct NamedPoint {
    /// Distance from the ray, and how large it may be.
    pub(super) beside: f64,
    pub(super) beside_tolerance: f64,
    /// The `t` of the point, and what rounding of the coordinates alone may do to it.
    pub(super) depth: f64,
    pub(super) depth_tolerance: f64,
}

/// A triangle as a ray sees it.
struct View {
    seen: [Seen; 3],
    /// How far each vertex may be moved.
    slack: [f64; 3],
    /// The part of it that does not shrink as the vertex comes near the ray's origin.
    moved: f64,
    weights: [f64; 3],
    /// How far each weight may be off.
    weight_slack: [f64; 3],
    /// What `f64` itself does to each weight.
    noise: [f64; 3],
}

impl Triangle {
    /// Whether the triangle has no area and is ignored, if no transform rounded it. Differences and products of
    /// neighbouring `f32` values are exact in `f64`.
    pub(super) fn is_flat(&self) -> bool {
        let [a, b, c] = self.corners;
        (b - a).cross(c - a) == DVec3::ZERO
    }

    pub(super) fn meet(&self, ray: &OracleRay) -> Option<Crossing> {
        let view = self.view(ray);
        let verdict = view.verdict();
        if verdict == Verdict::CertainMiss {
            return None;
        }
        let t = view.t_range(ray);
        match verdict.min(t.verdict_within(ray)) {
            Verdict::CertainMiss => None,
            verdict => Some(Crossing { verdict, t }),
        }
    }

    /// Where the point with these barycentric coordinates lies relative to the ray.
    pub(super) fn named_point(&self, ray: &OracleRay, u: f32, v: f32) -> NamedPoint {
        let view = self.view(ray);
        let (u, v) = (f64::from(u), f64::from(v));
        let shares = [1.0 - u - v, u, v];
        let mix = |value: &dyn Fn(&Seen) -> f64| {
            view.seen.iter().zip(shares).map(|(seen, share)| share * value(seen)).sum::<f64>()
        };
        let beside = DVec2::new(mix(&|seen| seen.beside.x), mix(&|seen| seen.beside.y));
        // The share of vertex 0 is a difference of rounded ones, so its error counts in full.
        let size = view.seen.iter().map(|seen| seen.depth.abs()).fold(0.0, f64::max);
        NamedPoint {
            beside: beside.length(),
            beside_tolerance: view.beside_tolerance(),
            depth: mix(&|seen| seen.depth),
            depth_tolerance: PRODUCT_SLACK * size,
        }
    }

    fn view(&self, ray: &OracleRay) -> View {
        let seen = self.corners.map(|corner| ray.see(corner));
        let slack =
            [0, 1, 2].map(|i| RELATIVE_SLACK * seen[i].reach + self.slack[i] + ABSOLUTE_SLACK);
        let moved = self.slack.into_iter().fold(ABSOLUTE_SLACK, f64::max);
        let none = [0.0; 3];
        let mut view = View { seen, slack, moved, weights: none, weight_slack: none, noise: none };
        for i in 0..3 {
            let (j, k) = ((i + 1) % 3, (i + 2) % 3);
            let (a, b) = (seen[j].beside, seen[k].beside);
            let (a_len, b_len) = (a.length(), b.length());
            view.weights[i] = a.perp_dot(b);
            view.weight_slack[i] = slack[j] * b_len
                + slack[k] * a_len
                + slack[j] * slack[k]
                + PRODUCT_SLACK * a_len * b_len;
            view.noise[i] =
                SIGN_NOISE * (seen[j].reach * b_len + seen[k].reach * a_len + a_len * b_len);
        }
        view
    }
}

impl View {
    fn verdict(&self) -> Verdict {
        if !self.seen.iter().all(|seen| seen.reach < OVERFLOW && seen.beside.is_finite()) {
            return Verdict::Borderline;
        }
        if self.is_separate() {
            return Verdict::CertainMiss;
        }
        let clear = (0..3).all(|i| self.edge_is_clear(i, (i + 1) % 3));
        let above = (0..3).filter(|&i| self.weights[i] > self.noise[i]).count();
        let below = (0..3).filter(|&i| self.weights[i] < -self.noise[i]).count();
        match (clear, above, below) {
            (true, 3, 0) | (true, 0, 3) => Verdict::CertainHit,
            (true, 1.., 1..) => Verdict::CertainMiss,
            _ => Verdict::Borderline,
        }
    }

    /// Whether a line that stands across the way to the nearest edge keeps all three vertices,
    /// moved or not, on its far side.
    fn is_separate(&self) -> bool {
        let nearest = (0..3)
            .map(|i| nearest_to_zero(self.seen[i].beside, self.seen[(i + 1) % 3].beside))
            .min_by(|a, b| a.length_squared().total_cmp(&b.length_squared()));
        let toward = nearest.map(DVec2::normalize_or_zero).unwrap_or_default();
        (0..3).all(|i| self.seen[i].beside.dot(toward) > self.slack[i])
    }

    /// Whether each point of an edge is farther from the ray than its vertices may move it.
    fn edge_is_clear(&self, from: usize, to: usize) -> bool {
        let (a, b) = (self.seen[from].beside, self.seen[to].beside);
        let (slack_a, slack_b) = (self.slack[from], self.slack[to]);
        if nearest_to_zero(a, b).length() > slack_a.max(slack_b) {
            return true;
        }
        // Distance minus slack is convex along the edge: close in on its minimum by thirds.
        let margin = |s: f64| a.lerp(b, s).length() - (slack_a + s * (slack_b - slack_a));
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..100 {
            let (left, right) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
            if margin(left) <= 0.0 || margin(right) <= 0.0 {
                return false;
            }
            if margin(left) < margin(right) { high = right } else { low = left }
        }
        margin(0.0) > 0.0 && margin(1.0) > 0.0
    }

    /// The smallest sum of weights that an engine may see; not positive when the triangle may
    /// look like a line.
    fn least_area(&self) -> f64 {
        self.weights.iter().sum::<f64>().abs() - self.weight_slack.iter().sum::<f64>()
    }

    fn t_range(&self, ray: &OracleRay) -> TRange {
        let depths = self.seen.map(|seen| seen.depth);
        // Engines may shear along another axis, which moves the depth of what lies beside.
        let skew = self.seen.map(|seen| 2.0 * seen.beside.length() / ray.speed());
        let lo = (0..3).map(|i| depths[i] - skew[i]).fold(f64::INFINITY, f64::min);
        let hi = (0..3).map(|i| depths[i] + skew[i]).fold(f64::NEG_INFINITY, f64::max);
        let mut range = TRange { lo, hi };
        let mut size = lo.abs().max(hi.abs());
        let least_area = self.least_area();
        if least_area > 0.0 {
            let area = self.weights.iter().sum::<f64>();
            let t = (0..3).map(|i| self.weights[i] * depths[i]).sum::<f64>() / area;
            let off = |i: usize| self.weight_slack[i] * ((depths[i] - t).abs() + skew[i]);
            let off = (0..3).map(off).sum::<f64>() / least_area;
            range = TRange { lo: lo.max(t - off), hi: hi.min(t + off) };
            let share = |i: usize| self.weights[i].abs() + self.weight_slack[i];
            let mixed = |i: usize| share(i) * (depths[i].abs() + skew[i]);
            size = size.min((0..3).map(mixed).sum::<f64>() / least_area);
        }
        let reach = self.seen.iter().fold(1.0, |reach, seen| seen.reach.max(reach));
        let absolute = self.moved / ray.speed() + ABSOLUTE_SLACK * reach;
        range.widened(RELATIVE_SLACK * size + absolute)
    }

    fn beside_tolerance(&self) -> f64 {
        let lengths = self.seen.map(|seen| seen.beside.length());
        let longest = lengths.into_iter().fold(0.0, f64::max);
        let least_area = self.least_area();
        let slack = self.slack.into_iter().fold(0.0, f64::max) + PRODUCT_SLACK * longest;
        if least_area <= 0.0 {
            return longest + slack;
        }
        let off = (0..3).map(|i| self.weight_slack[i] * lengths[i]).sum::<f64>() / least_area;
        off.min(longest) + slack
    }
}

/// The point of a segment that is nearest to zero.
fn nearest_to_zero(a: DVec2, b: DVec2) -> DVec2 {
    let along = b - a;
    let squared = along.length_squared();
    let s = if squared > 0.0 { (-a.dot(along) / squared).clamp(0.0, 1.0) } else { 0.0 };
    a + s * along
}
