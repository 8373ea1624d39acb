//! Photons sorted by cells of space.
//!
//! Cells are twice as wide as the radius, so those around a point are eight at most. They share as
//! many buckets as there are photons, by a hash of their coordinates; a photon tells by its place
//! to which of them it belongs.
//!
//! **Source.** M. Teschner et al., "Optimized Spatial Hashing for Collision Detection of Deformable
//! Objects", VMV 2003, for the hash.

use std::f32::consts::PI;

use glam::{IVec3, Vec3};

/// Photons on surfaces that are turned by more than this cosine says belong to another one.
const SMALLEST_COS: f32 = 0.7;

/// Light that arrives at a rough surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Photon {
    /// Off the surface, where points that lights may light are too.
    pub(crate) position: Vec3,
    /// The texel of the light's view that it comes from.
    pub(crate) texel: u32,
    /// What it brings.
    pub(crate) flux: Vec3,
    /// Shading normal of the surface, on the side where it arrives.
    pub(crate) normal: Vec3,
    /// Where it travels, of unit length.
    pub(crate) direction: Vec3,
}

/// Photons by bucket.
#[derive(Debug, Default)]
pub(crate) struct PhotonMap {
    photons: Vec<Photon>,
    /// Where the photons of each bucket begin, and where the last ones end.
    starts: Vec<u32>,
    /// Where photons are while they are sorted.
    unsorted: Vec<Photon>,
    low: Vec3,
    radius: f32,
}

impl PhotonMap {
    /// Makes this a map without photons.
    pub(crate) fn clear(&mut self) {
        self.photons.clear();
        self.starts.clear();
    }

    /// The photons.
    pub(crate) fn photons(&self) -> &[Photon] {
        &self.photons
    }

    /// The photons, to be left; then they are to be sorted.
    pub(crate) const fn photons_mut(&mut self) -> &mut Vec<Photon> {
        &mut self.photons
    }

    /// Sorts photons into buckets, those of one in the order in which they were left. They count
    /// up to `radius`, which is more than 0.
    pub(crate) fn sort(&mut self, radius: f32) {
        self.radius = radius;
        let positions = self.photons.iter().map(|photon| photon.position);
        self.low = positions.fold(Vec3::INFINITY, Vec3::min);
        std::mem::swap(&mut self.photons, &mut self.unsorted);

        // Where every bucket ends, then from the last photon to the first.
        let bucket_count = self.unsorted.len().next_power_of_two();
        self.starts.clear();
        self.starts.resize(bucket_count + 1, 0);
        for photon in &self.unsorted {
            let bucket = self.bucket(self.cell(photon.position));
            self.starts[bucket] += 1;
        }
        let mut end = 0;
        for start in &mut self.starts {
            end += *start;
            *start = end;
        }
        self.photons.clear();
        self.photons.resize(self.unsorted.len(), Photon::default());
        for photon in self.unsorted.iter().rev() {
            let bucket = self.bucket(self.cell(photon.position));
            self.starts[bucket] -= 1;
            self.photons[self.starts[bucket] as usize] = *photon;
        }
    }

    /// The irradiance by photons at a point with this unit shading normal.
    pub(crate) fn irradiance(&self, position: Vec3, normal: Vec3) -> Vec3 {
        if self.photons.is_empty() {
            return Vec3::ZERO;
        }
        let (first, last) = (self.cell(position - self.radius), self.cell(position + self.radius));
        let mut sum = Vec3::ZERO;
        for z in first.z.max(0)..=last.z {
            for y in first.y.max(0)..=last.y {
                for x in first.x.max(0)..=last.x {
                    sum += self.in_cell(IVec3::new(x, y, z), position, normal);
                }
            }
        }
        // The volume below the kernel.
        sum * (2.0 / (PI * self.radius * self.radius))
    }

    /// What the photons of one cell bring, each times the height of the kernel.
    fn in_cell(&self, cell: IVec3, position: Vec3, normal: Vec3) -> Vec3 {
        let bucket = self.bucket(cell);
        let range = self.starts[bucket] as usize..self.starts[bucket + 1] as usize;
        let mut sum = Vec3::ZERO;
        for photon in &self.photons[range] {
            let apart = (photon.position - position).length_squared();
            let height = 1.0 - apart / (self.radius * self.radius);
            let is_same_surface =
                photon.normal.dot(normal) > SMALLEST_COS && photon.direction.dot(normal) < 0.0;
            // Cells that share a bucket are told apart, so that no photon counts twice.
            if height > 0.0 && is_same_surface && self.cell(photon.position) == cell {
                sum += height * photon.flux;
            }
        }
        sum
    }

    fn cell(&self, position: Vec3) -> IVec3 {
        ((position - self.low) / (2.0 * self.radius)).floor().as_ivec3()
    }

    fn bucket(&self, cell: IVec3) -> usize {
        let IVec3 { x, y, z } = cell;
        let hash =
            (x.wrapping_mul(73_856_093)) ^ y.wrapping_mul(19_349_663) ^ z.wrapping_mul(83_492_791);
        hash as u32 as usize & (self.starts.len() - 2)
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        (self.photons.capacity() + self.unsorted.capacity()) * size_of::<Photon>()
            + self.starts.capacity() * size_of::<u32>()
    }
}
