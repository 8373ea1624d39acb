use rayflock_geom::simd::{LANES, SimdLevel, dispatch};
use rayflock_testkit::Rng;

use super::*;

/// Boxes of all sizes: one with a point in it is always kept, most others are not.
#[test]
fn a_box_with_a_point_in_it_is_kept() {
    let mut rng = Rng::new(41);
    for simd in SimdLevel::available() {
        let mut occupancy = Occupancy::default();
        occupancy.clear([-1.0, 3.0, 0.5, 2.0], 64);
        let points: Vec<[f32; 2]> =
            (0..64).map(|_| [rng.between(-1.5, 3.5), rng.between(0.0, 2.5)]).collect();
        let (mut empty_count, mut rejected_count) = (0, 0);
        dispatch!(simd.level(), simd => {
            for sixteen in points.chunks_exact(LANES) {
                let column = |axis: usize| f32x16::from_fn(simd, |lane| sixteen[lane][axis]);
                let all = mask32x16::splat(simd, true);
                occupancy.note(simd, column(0), column(1), all);
            }
            occupancy.finish();
            for _ in 0..4000 {
                let size = 4.0 * 0.5_f32.powi(rng.below(14) as i32);
                let (x, y) = (rng.between(-1.5, 3.5), rng.between(0.0, 2.5));
                let bounds = [x, x + size * rng.unit(), y, y + size * rng.unit()];
                let lanes = bounds.map(|bound| f32x16::splat(simd, bound));
                let all = mask32x16::splat(simd, true);
                let kept = occupancy.keep(simd, &lanes, all);
                let closely = occupancy.keep_closely(simd, &lanes, all);
                let cells = occupancy.box_cells(simd, &lanes).map(|cells| cells[0]);
                let [left, right, low, high] = cells;
                let is_large = [[left, right], [low, high]]
                    .iter()
                    .any(|[from, to]| to / SQUARE as u32 - from / SQUARE as u32 > 1);
                let is_in_cells = |&[x, y]: &[f32; 2]| {
                    let splat = |value: f32| f32x16::splat(simd, value);
                    let column = occupancy.cells(simd, splat(x), 0)[0];
                    let row = occupancy.cells(simd, splat(y), 1)[0];
                    left <= column && column <= right && low <= row && row <= high
                };
                let expected = is_large || points.iter().any(is_in_cells);
                assert_eq!(closely.any_true(), expected, "{bounds:?}: cells {cells:?}");
                let is_inside = |[x, y]: &[f32; 2]| {
                    bounds[0] <= *x && *x <= bounds[1] && bounds[2] <= *y && *y <= bounds[3]
                };
                if points.iter().any(is_inside) {
                    assert!(kept.all_true() && closely.all_true(), "{bounds:?}");
                } else {
                    empty_count += 1;
                    rejected_count += usize::from(!kept.any_true());
                }
            }
        });
        assert!(rejected_count * 2 > empty_count, "{rejected_count} of {empty_count}");
    }
}
