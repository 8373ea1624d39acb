//! Brings sixteen points that lie side by side in memory into columns.
//!
//! ```text
//!   x0 y0 z0 .  x1 y1 z1 .  ...  four numbers from where each point begins, four points a vector
//!   x0 z0 x1 z1 ...  y0 . y1 .   what stands at even places, what stands at odd ones
//!   x0 x1 ...  z0 z1 ...  y0 ...  once more
//! ```
//!
//! **Cost.** Sixteen loads, twelve that join them and seven shuffles; scalar code takes 48 loads and
//! stores, and loads of what was just stored in parts have to wait.

use super::axes::Axes;
use super::{LANES, Simd, SimdBase, SimdCombine, f32x4, f32x16};

/// Sixteen points that begin `stride` scalars apart; `None` where there are fewer, or where nothing
/// follows the last.
#[inline(always)]
pub fn point_columns<S: Simd>(simd: S, scalars: &[f32], stride: usize) -> Option<Axes<S>> {
    let scalars = scalars.get(..(LANES - 1) * stride + 4)?;
    let (first, second) = (four(simd, scalars, stride, 0), four(simd, scalars, stride, 4));
    let (third, fourth) = (four(simd, scalars, stride, 8), four(simd, scalars, stride, 12));
    let ((even_0, odd_0), (even_1, odd_1)) =
        (first.deinterleave(second), third.deinterleave(fourth));
    let ((x, z), (y, _)) = (even_0.deinterleave(even_1), odd_0.deinterleave(odd_1));
    Some([x, y, z])
}

/// Four points from `first` on, a quarter of the vector each.
#[inline(always)]
fn four<S: Simd>(simd: S, scalars: &[f32], stride: usize, first: usize) -> f32x16<S> {
    let point = |idx: usize| (first + idx) * stride;
    let load = |start: usize| f32x4::from_slice(simd, &scalars[start..start + 4]);
    let (low, high) =
        (load(point(0)).combine(load(point(1))), load(point(2)).combine(load(point(3))));
    low.combine(high)
}

#[cfg(test)]
mod tests {
    use super::super::{SimdLevel, dispatch};
    use super::*;

    #[test]
    fn points_of_any_stride_come_into_columns() {
        let scalars: Vec<f32> = (0..120_u8).map(f32::from).collect();
        for level in SimdLevel::available() {
            for stride in [3, 4, 7] {
                let needed = (LANES - 1) * stride + 4;
                dispatch!(level.level(), simd => {
                    assert!(point_columns(simd, &scalars[..needed - 1], stride).is_none());
                    let columns = point_columns(simd, &scalars[..needed], stride).unwrap();
                    for (axis, column) in columns.iter().enumerate() {
                        for lane in 0..LANES {
                            assert_eq!(column[lane], scalars[lane * stride + axis], "{level}");
                        }
                    }
                });
            }
        }
    }
}
