//! Virtual lights, as columns.
//!
//! A light sends radiant intensity (power a solid angle) into directions:
//!
//! ```text
//! plain:    intensity * max(0, normal . direction + evenness)
//! lobed:    that, times what varnish lets out, + highlight of the Lobe
//! distant:  irradiance `intensity` from unit direction `position`, everywhere
//! ```
//!
//! A diffuse surface has `evenness` 0 and, lit with a flux, `intensity = reflectance * flux / pi`.
//! A light that shines evenly has the normal 0 and `evenness` 1: a point light, or part of one.
//! A sample of an emitting surface is a diffuse one whose intensity is radiance times area.
//!
//! **Invariants**: the lights lie in the order plain, lobed, distant; so most loops have no
//! branches. All numbers are finite, and normals of unit length or zero.

use std::ops::Range;

use glam::Vec3;

/// One light, as it is added and as it is looked at; columns hold the same.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VirtualLight {
    /// In world space, off the surface that it lies on; of a distant light the unit direction to
    /// it.
    pub position: Vec3,
    /// Of unit length, on the lit side of the surface; zero where light leaves evenly.
    pub normal: Vec3,
    /// 0 for a surface, 1 for a point that shines evenly.
    pub evenness: f32,
    /// Radiant intensity along the normal, lobe not included; irradiance if distant.
    pub intensity: Vec3,
}

/// What a light sends besides the even light of a matte surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lobe {
    /// Toward where the light comes from that the highlight mirrors, of unit length.
    pub to_source: Vec3,
    /// Intensity along the normal times `(normal . halfway) ^ shininess` is that of the highlight.
    pub highlight: Vec3,
    /// Exponent of the highlight.
    pub shininess: f32,
    /// The share of the diffuse light that varnish keeps back from those who look along the
    /// surface: `1 - varnish (1 - cos)^5` comes through.
    pub varnish: f32,
}

/// Lights left by random walks, and others in the same terms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct VirtualLights {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    evenness: Vec<f32>,
    intensities: Vec<Vec3>,
    /// Those of the lights `plain_count..near_count`, in their order.
    lobes: Vec<Lobe>,
    plain_count: usize,
    near_count: usize,
    reach: f32,
}

impl VirtualLights {
    /// No lights. `reach` is the longest distance between two points of the scene, which ends
    /// the way to distant lights.
    pub fn new(reach: f32) -> Self {
        Self { reach, ..Self::default() }
    }

    /// Makes these no lights, keeping their memory.
    pub fn clear(&mut self, reach: f32) {
        self.positions.clear();
        self.normals.clear();
        self.evenness.clear();
        self.intensities.clear();
        self.lobes.clear();
        (self.plain_count, self.near_count, self.reach) = (0, 0, reach);
    }

    /// Replaces all by `plain`, `lobed` and `distant` lights. Lights that are not finite are left
    /// out; the others keep their order.
    pub fn assign(
        &mut self,
        reach: f32,
        plain: &[VirtualLight],
        lobed: &[(VirtualLight, Lobe)],
        distant: &[VirtualLight],
    ) {
        self.clear(reach);
        plain.iter().for_each(|light| self.push(light));
        self.plain_count = self.positions.len();
        for (light, lobe) in lobed {
            if light.is_finite() && lobe.is_finite() {
                self.push(light);
                self.lobes.push(*lobe);
            }
        }
        self.near_count = self.positions.len();
        distant.iter().for_each(|light| self.push(light));
    }

    fn push(&mut self, light: &VirtualLight) {
        if light.is_finite() {
            self.positions.push(light.position);
            self.normals.push(light.normal);
            self.evenness.push(light.evenness);
            self.intensities.push(light.intensity);
        }
    }

    /// Number of lights.
    pub const fn len(&self) -> usize {
        self.positions.len()
    }

    /// Whether there is no light.
    pub const fn is_empty(&self) -> bool {
        self.positions.is_empty()
    }

    /// The lights without a lobe at a place in the scene: most, as a rule.
    pub const fn plain(&self) -> Range<usize> {
        0..self.plain_count
    }

    /// The lights with a lobe.
    pub const fn lobed(&self) -> Range<usize> {
        self.plain_count..self.near_count
    }

    /// The lights that are infinitely far away.
    pub const fn distant(&self) -> Range<usize> {
        self.near_count..self.len()
    }

    /// Whether light `light_idx` is infinitely far away.
    pub const fn is_distant(&self, light_idx: usize) -> bool {
        light_idx >= self.near_count
    }

    /// Positions; unit directions to distant lights.
    pub fn positions(&self) -> &[Vec3] {
        &self.positions
    }

    /// Normals; zero for lights that shine evenly, and distant ones.
    pub fn normals(&self) -> &[Vec3] {
        &self.normals
    }

    /// Intensities along the normal; irradiances of distant lights.
    pub fn intensities(&self) -> &[Vec3] {
        &self.intensities
    }

    /// The longest distance between two points of the scene.
    pub const fn reach(&self) -> f32 {
        self.reach
    }

    /// Light `light_idx`, its lobe left out.
    pub fn get(&self, light_idx: usize) -> VirtualLight {
        VirtualLight {
            position: self.positions[light_idx],
            normal: self.normals[light_idx],
            evenness: self.evenness[light_idx],
            intensity: self.intensities[light_idx],
        }
    }

    /// The lobe of light `light_idx`, if it has one.
    pub fn lobe(&self, light_idx: usize) -> Option<&Lobe> {
        self.lobes.get(light_idx.checked_sub(self.plain_count)?)
    }

    /// Where the way from `point` to light `light_idx` ends: at the light, or outside the scene.
    #[inline]
    pub fn end_of_way(&self, light_idx: usize, point: Vec3) -> Vec3 {
        let position = self.positions[light_idx];
        if self.is_distant(light_idx) { point + self.reach * position } else { position }
    }

    /// What light `light_idx`, which is not distant, sends into unit `direction`: radiant
    /// intensity.
    #[inline]
    pub fn intensity_toward(&self, light_idx: usize, direction: Vec3) -> Vec3 {
        let cos = self.normals[light_idx].dot(direction);
        let plain = self.intensities[light_idx] * (cos + self.evenness[light_idx]).max(0.0);
        match self.lobe(light_idx) {
            Some(lobe) if cos > 0.0 => {
                plain * lobe.let_out(cos) + lobe.sent(self.normals[light_idx], direction, cos)
            }
            _ => plain,
        }
    }

    /// Bytes held.
    pub fn memory_usage(&self) -> usize {
        (self.positions.capacity() + self.normals.capacity() + self.intensities.capacity())
            * size_of::<Vec3>()
            + self.evenness.capacity() * size_of::<f32>()
            + self.lobes.capacity() * size_of::<Lobe>()
    }
}

impl VirtualLight {
    /// A matte point of a surface, whose `intensity` is reflectance times flux over pi.
    pub const fn matte(position: Vec3, normal: Vec3, intensity: Vec3) -> Self {
        Self { position, normal, evenness: 0.0, intensity }
    }

    /// A point that shines evenly.
    pub const fn even(position: Vec3, intensity: Vec3) -> Self {
        Self { position, normal: Vec3::ZERO, evenness: 1.0, intensity }
    }

    /// A light that is infinitely far away along unit `to_light`.
    pub const fn distant(to_light: Vec3, irradiance: Vec3) -> Self {
        Self::even(to_light, irradiance)
    }

    fn is_finite(&self) -> bool {
        self.position.is_finite() && self.normal.is_finite() && self.intensity.is_finite()
    }
}

impl Lobe {
    /// The share of the diffuse light that varnish lets out at an angle with cosine `cos`.
    #[inline]
    fn let_out(&self, cos: f32) -> f32 {
        let sideways = (1.0 - cos).max(0.0);
        let squared = sideways * sideways;
        1.0 - self.varnish * squared * squared * sideways
    }

    /// The highlight toward unit `direction`, at an angle with cosine `cos` from `normal`.
    #[inline]
    fn sent(&self, normal: Vec3, direction: Vec3, cos: f32) -> Vec3 {
        let halfway = (self.to_source + direction).normalize_or_zero();
        self.highlight * (cos * normal.dot(halfway).max(0.0).powf(self.shininess))
    }

    fn is_finite(&self) -> bool {
        self.to_source.is_finite()
            && self.highlight.is_finite()
            && self.shininess.is_finite()
            && self.varnish.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_are_sorted_by_kind_and_those_that_are_not_finite_left_out() {
        let lobe = Lobe { to_source: Vec3::Y, highlight: Vec3::ONE, shininess: 8.0, varnish: 0.0 };
        let matte = |x: f32| VirtualLight::matte(Vec3::X * x, Vec3::Y, Vec3::ONE);
        let mut lights = VirtualLights::new(10.0);
        lights.assign(
            10.0,
            &[matte(1.0), matte(f32::NAN), VirtualLight::even(Vec3::Z, Vec3::ONE)],
            &[(matte(2.0), lobe), (matte(3.0), Lobe { shininess: f32::INFINITY, ..lobe })],
            &[VirtualLight::distant(Vec3::Z, Vec3::ONE)],
        );
        assert_eq!((lights.plain(), lights.lobed(), lights.distant()), (0..2, 2..3, 3..4));
        assert_eq!((lights.lobe(1), lights.lobe(2), lights.lobe(3)), (None, Some(&lobe), None));
        assert_eq!(lights.end_of_way(0, Vec3::Y), Vec3::X);
        assert_eq!(lights.end_of_way(3, Vec3::Y), Vec3::new(0.0, 1.0, 10.0));
    }

    #[test]
    fn surfaces_shine_by_the_cosine_and_points_evenly() {
        let mut lights = VirtualLights::new(1.0);
        let surface = VirtualLight::matte(Vec3::ZERO, Vec3::Y, Vec3::splat(2.0));
        let point = VirtualLight::even(Vec3::ZERO, Vec3::splat(2.0));
        lights.assign(1.0, &[surface, point], &[], &[]);
        let slanted = Vec3::new(0.8, 0.6, 0.0);
        assert_eq!(lights.intensity_toward(0, slanted), Vec3::splat(1.2));
        assert_eq!(lights.intensity_toward(0, -slanted), Vec3::ZERO);
        assert_eq!(lights.intensity_toward(1, -slanted), Vec3::splat(2.0));
    }

    #[test]
    fn a_highlight_is_brightest_where_the_source_is_mirrored() {
        let to_source = Vec3::new(0.6, 0.8, 0.0);
        let lobe = Lobe { to_source, highlight: Vec3::ONE, shininess: 50.0, varnish: 0.0 };
        let black = VirtualLight::matte(Vec3::ZERO, Vec3::Y, Vec3::ZERO);
        let mut lights = VirtualLights::new(1.0);
        lights.assign(1.0, &[], &[(black, lobe)], &[]);
        let mirrored = lights.intensity_toward(0, Vec3::new(-0.6, 0.8, 0.0)).x;
        assert!((mirrored - 0.8).abs() < 1e-6);
        assert!(lights.intensity_toward(0, to_source).x < 0.1 * mirrored);
        assert_eq!(lights.intensity_toward(0, Vec3::NEG_Y), Vec3::ZERO);
    }
}
