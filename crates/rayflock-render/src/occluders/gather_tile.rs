//! What all lights of a group send to a tile of points, past spheres: sums instead of pairs.
//!
//! Nothing is written for a pair: sixteen points at a time, a light's share and what spheres let
//! through stay in registers until they are added up. A light that faces away from the whole tile
//! is done with before spheres are looked for.

use glam::Vec3;
use rayflock_geom::simd::{Lanes, Simd, SimdBase, SimdLevel, SimdMask, dispatch, f32x16};

use super::matte_lights::{MatteLight, geometry_terms};
use super::see_tile::{PointTile, TileSight};
use super::sphere_tree::SphereTree;

/// A matte light and its intensity along the normal.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ShiningLight {
    /// Place and surface.
    pub light: MatteLight,
    /// Radiant intensity along the normal, by colour.
    pub intensity: Vec3,
}

/// Irradiance at sixteen points, by colour: what arrives, and what bounding the geometry terms
/// kept away.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct IrradianceBlock {
    /// What arrives.
    pub kept: [Lanes; 3],
    /// What would have, were geometry terms not bounded.
    pub lost: [Lanes; 3],
}

impl TileSight {
    /// Adds to `sums` the irradiance that comes from `lights` past the spheres of `tree`, geometry
    /// terms counting up to `bound`. `sums` has as many entries as the tile has blocks of sixteen
    /// points; lanes of the last one may stand for no point. Lights should be close to each other.
    ///
    /// Where anything arrives, `seen(light_idx, block_idx, through)` is told what comes through.
    pub fn gather(
        &mut self,
        tree: &SphereTree,
        tile: &PointTile,
        lights: &[ShiningLight],
        bound: f32,
        sums: &mut [IrradianceBlock],
        mut seen: impl FnMut(usize, usize, &Lanes),
    ) {
        if tile.is_empty() {
            return;
        }
        dispatch!(SimdLevel::best().level(), simd => {
            self.gather_group(simd, tree, tile, (lights, bound), sums, &mut seen);
        });
    }

    #[inline(always)]
    fn gather_group<S: Simd>(
        &mut self,
        simd: S,
        tree: &SphereTree,
        tile: &PointTile,
        (lights, bound): (&[ShiningLight], f32),
        sums: &mut [IrradianceBlock],
        seen: &mut impl FnMut(usize, usize, &Lanes),
    ) {
        let (zero, bound) = (f32x16::splat(simd, 0.0), f32x16::splat(simd, bound));
        self.find_near(simd, tree, tile, lights.iter().map(|shining| shining.light.position));
        for (light_idx, ShiningLight { light, intensity }) in lights.iter().enumerate() {
            if tile.faces_away(light) {
                continue;
            }
            self.look_at(simd, tile, light.position, light.normal);
            let blocks = tile.blocks().zip(&mut *sums);
            for (block_idx, ((points, ball), sums)) in blocks.enumerate() {
                let terms = geometry_terms(simd, points, light);
                if !terms.simd_gt(zero).any_true() {
                    continue;
                }
                let through = self.through(simd, points, ball, light.position);
                seen(light_idx, block_idx, &through);
                add(simd, terms.min(bound) * through, *intensity, &mut sums.kept);
                if terms.simd_gt(bound).any_true() {
                    add(simd, (terms - bound).max(zero) * through, *intensity, &mut sums.lost);
                }
            }
        }
    }
}

/// Adds shares of an intensity.
#[inline(always)]
fn add<S: Simd>(simd: S, shares: f32x16<S>, intensity: Vec3, sums: &mut [Lanes; 3]) {
    for (sum, intensity) in sums.iter_mut().zip(intensity.to_array()) {
        let added = shares * f32x16::splat(simd, intensity);
        (f32x16::from_slice(simd, sum) + added).store_slice(sum);
    }
}

#[cfg(test)]
mod tests {
    use rayflock_geom::simd::LANES;
    use rayflock_geom::simd::segment_spheres::SoftSphere;

    use super::super::SeenLight;
    use super::*;

    #[test]
    fn sums_are_those_of_pairs() {
        let at = |i: u16| Vec3::new(f32::from(i % 10) * 0.1, 0.0, f32::from(i / 10) * 0.1);
        let positions: Vec<_> = (0..100).map(at).collect();
        let mut tile = PointTile::default();
        tile.assign(&positions, &[Vec3::Y; 100]);
        let spheres: Vec<_> = (0..100)
            .map(|i| SoftSphere {
                center: at(i) + (0.3 + 0.005 * f32::from(i)) * Vec3::Y,
                inner: 0.02,
                outer: 0.05,
                opacity: 1.0,
                flatness: if i % 2 == 0 { 3.0 * Vec3::Y } else { Vec3::ZERO },
            })
            .collect();
        let mut tree = SphereTree::default();
        tree.build(&spheres);
        let light = |i: u16| {
            let is_even = i.is_multiple_of(3);
            let normal = if is_even { Vec3::ZERO } else { Vec3::NEG_Y };
            let evenness = if is_even { 1.0 } else { 0.0 };
            let position = at(7 * i) + Vec3::Y;
            let intensity = Vec3::new(1.0, 2.0, f32::from(i));
            ShiningLight { light: MatteLight { position, normal, evenness }, intensity }
        };
        let lights: Vec<_> = (0..14).map(light).collect();
        let mut sums = vec![IrradianceBlock::default(); 7];
        let mut sight = TileSight::default();
        sight.gather(&tree, &tile, &lights, 100.0, &mut sums, |_, _, _| {});

        let seen: Vec<_> = lights
            .iter()
            .map(|ShiningLight { light, .. }| SeenLight {
                position: light.position,
                normal: light.normal,
            })
            .collect();
        let (mut expected, mut undimmed) = (vec![Vec3::ZERO; 112], vec![Vec3::ZERO; 112]);
        let open = SphereTree::default();
        for (idx, shining) in lights.iter().enumerate() {
            let mut alone = vec![IrradianceBlock::default(); 7];
            sight.gather(&open, &tile, &[*shining], 100.0, &mut alone, |_, _, _| {});
            sight.see(&tree, &tile, &seen[idx..=idx], |_, block_idx, through| {
                for lane in 0..LANES {
                    let of = alone[block_idx].kept.map(|column| column[lane]);
                    expected[16 * block_idx + lane] += through[lane] * Vec3::from(of);
                    undimmed[16 * block_idx + lane] += Vec3::from(of);
                }
            });
        }
        let mut dimmed = 0;
        for (idx, expected) in expected.iter().enumerate().take(100) {
            let found = Vec3::from(sums[idx / 16].kept.map(|column| column[idx % 16]));
            assert!(found.distance(*expected) < 1e-4 * expected.length(), "{found} {expected}");
            dimmed += usize::from(found.y < 0.9 * undimmed[idx].y);
        }
        assert!(dimmed > 50, "only {dimmed}");
    }
}
