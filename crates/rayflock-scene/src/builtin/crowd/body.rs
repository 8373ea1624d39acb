//! A figure's body: tubes for torso, head, arms and legs, in one mesh with one skin.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::Mesh;

use super::figure::{Cloth, Figure, Outfit};
use super::skeleton::{
    ARM, CHEST, FOOT, FOREARM, HEAD, NECK, PELVIS, SHIN, SPINE, THIGH, skin_joints,
};
use super::tube::{Ring, Tube, Weights, influences, mix, only, ring};
use crate::{
    MaterialIdx, NodeIdx, PrimMaterials, Skin, SurfaceAttributes, SurfaceMesh, VertexInfluences,
};

/// Axes of limbs that run upward, and of feet, which run backward.
const UPRIGHT: [Vec3; 2] = [Vec3::X, Vec3::Z];
const LYING: [Vec3; 2] = [Vec3::X, Vec3::Y];

/// The mesh at rest and the skin of a figure whose nodes begin at `root` and whose materials at
/// `first_material`.
pub(super) fn build(figure: &Figure, root: NodeIdx, first_material: u32) -> (SurfaceMesh, Skin) {
    let mut body = Body { first_material, ..Body::default() };
    body.torso();
    body.head(figure.outfit);
    for side in [0, 1] {
        body.arm(side);
        body.leg(side, figure.outfit);
    }
    if figure.outfit != Outfit::Trousers {
        body.skirt(figure.outfit);
    }
    body.finish(root)
}

#[derive(Debug, Default)]
struct Body {
    first_material: u32,
    vertices: Vec<Vec3>,
    influences: Vec<VertexInfluences>,
    triangles: Vec<[u32; 3]>,
    materials: Vec<MaterialIdx>,
}

impl Body {
    fn torso(&mut self) {
        let (pelvis, spine, chest) = (only(PELVIS), only(SPINE), only(CHEST));
        let rings = [
            ring([0.0, 0.84, 0.0], [0.07, 0.06], pelvis),
            ring([0.0, 0.90, -0.005], [0.165, 0.118], pelvis),
            ring([0.0, 1.00, 0.0], [0.163, 0.115], pelvis),
            ring([0.0, 1.10, 0.0], [0.147, 0.102], mix(pelvis, spine, 0.7)),
            ring([0.0, 1.22, 0.005], [0.163, 0.114], mix(spine, chest, 0.5)),
            ring([0.0, 1.34, 0.005], [0.185, 0.120], chest),
            ring([0.0, 1.42, -0.005], [0.172, 0.098], chest),
            ring([0.0, 1.47, -0.01], [0.085, 0.070], mix(chest, only(NECK), 0.3)),
        ];
        // Below the belt the trousers go on.
        self.tube(&rings, UPRIGHT, 18, 2, |row| if row < 4 { Cloth::Legs } else { Cloth::Top });
    }

    fn head(&mut self, outfit: Outfit) {
        let (neck, head) = (only(NECK), only(HEAD));
        let rings = [
            ring([0.0, 1.42, -0.005], [0.060, 0.058], neck),
            ring([0.0, 1.50, 0.0], [0.052, 0.054], neck),
            ring([0.0, 1.57, 0.01], [0.052, 0.058], head),
        ];
        self.tube(&rings, UPRIGHT, 10, 2, |_| Cloth::Skin);
        let face = ovoid([0.0, 1.645, 0.022], [0.078, 0.118, 0.096], head);
        self.tube(&face, UPRIGHT, 14, 1, |_| Cloth::Skin);
        let hair = ovoid([0.0, 1.678, -0.004], [0.088, 0.102, 0.102], head);
        self.tube(&hair, UPRIGHT, 14, 1, |_| Cloth::Hair);
        match outfit {
            Outfit::Dress => {
                let bun = ovoid([0.0, 1.655, -0.105], [0.058, 0.068, 0.05], head);
                self.tube(&bun, UPRIGHT, 10, 1, |_| Cloth::Hair);
            }
            Outfit::Coat => self.hat(),
            Outfit::Trousers => {}
        }
    }

    fn hat(&mut self) {
        let head = only(HEAD);
        let rings = [
            ring([0.0, 1.715, -0.004], [0.155, 0.170], head),
            ring([0.0, 1.727, -0.004], [0.150, 0.165], head),
            ring([0.0, 1.733, -0.004], [0.097, 0.112], head),
            ring([0.0, 1.79, -0.004], [0.092, 0.107], head),
            ring([0.0, 1.82, -0.004], [0.080, 0.095], head),
        ];
        self.tube(&rings, UPRIGHT, 16, 1, |_| Cloth::Top);
    }

    fn arm(&mut self, side: usize) {
        let sign = 1.0 - 2.0 * side as f32;
        let (chest, arm, forearm) = (only(CHEST), only(ARM[side]), only(FOREARM[side]));
        let at = |x: f32, y: f32| [sign * x, y, 0.0];
        let sleeve = [
            ring(at(0.250, 0.885), [0.034, 0.036], forearm),
            ring(at(0.247, 1.00), [0.040, 0.042], forearm),
            ring(at(0.238, 1.09), [0.043, 0.045], mix(forearm, arm, 0.2)),
            ring(at(0.232, 1.14), [0.045, 0.047], mix(forearm, arm, 0.5)),
            ring(at(0.226, 1.20), [0.047, 0.050], mix(forearm, arm, 0.85)),
            ring(at(0.208, 1.32), [0.053, 0.057], arm),
            ring(at(0.190, 1.40), [0.058, 0.062], mix(arm, chest, 0.25)),
            ring(at(0.165, 1.445), [0.045, 0.050], mix(arm, chest, 0.6)),
        ];
        self.tube(&sleeve, UPRIGHT, 10, 2, |_| Cloth::Top);
        let hand = ovoid([sign * 0.252, 0.845, 0.006], [0.026, 0.088, 0.042], forearm);
        self.tube(&hand, UPRIGHT, 8, 1, |_| Cloth::Skin);
    }

    fn leg(&mut self, side: usize, outfit: Outfit) {
        let sign = 1.0 - 2.0 * side as f32;
        let (pelvis, thigh) = (only(PELVIS), only(THIGH[side]));
        let (shin, foot) = (only(SHIN[side]), only(FOOT[side]));
        let at = |x: f32, y: f32, z: f32| [sign * x, y, z];
        let leg = [
            ring(at(0.095, 0.075, -0.005), [0.038, 0.042], mix(shin, foot, 0.4)),
            ring(at(0.095, 0.13, -0.005), [0.046, 0.052], shin),
            ring(at(0.095, 0.33, -0.012), [0.055, 0.062], shin),
            ring(at(0.095, 0.45, 0.0), [0.057, 0.061], mix(shin, thigh, 0.15)),
            ring(at(0.095, 0.50, 0.003), [0.060, 0.063], mix(shin, thigh, 0.5)),
            ring(at(0.095, 0.55, 0.003), [0.064, 0.068], mix(shin, thigh, 0.85)),
            ring(at(0.093, 0.72, 0.0), [0.078, 0.085], thigh),
            ring(at(0.090, 0.86, -0.003), [0.086, 0.098], mix(thigh, pelvis, 0.2)),
            ring(at(0.085, 0.95, 0.0), [0.066, 0.080], mix(thigh, pelvis, 0.7)),
        ];
        let bare = outfit == Outfit::Dress;
        let cloth = |row: u32| if bare && row < 12 { Cloth::Skin } else { Cloth::Legs };
        self.tube(&leg, UPRIGHT, 12, 2, cloth);

        let shoe = [
            ring(at(0.097, 0.036, 0.185), [0.016, 0.016], foot),
            ring(at(0.098, 0.036, 0.165), [0.036, 0.032], foot),
            ring(at(0.099, 0.038, 0.10), [0.047, 0.040], foot),
            ring(at(0.096, 0.050, 0.03), [0.042, 0.054], foot),
            ring(at(0.095, 0.055, -0.03), [0.040, 0.058], foot),
            ring(at(0.095, 0.050, -0.065), [0.028, 0.044], foot),
        ];
        self.tube(&shoe, LYING, 10, 2, |_| Cloth::Shoes);
    }

    /// A dress from the waist, or the tails of a coat, that the thighs push about.
    fn skirt(&mut self, outfit: Outfit) {
        let hem = if outfit == Outfit::Dress { 0.42 } else { 0.56 };
        let pelvis = only(PELVIS);
        let pushed = |share: f32| [0, 1].map(|side: usize| mix(pelvis, only(THIGH[side]), share));
        let at = |share: f32, radii: [f32; 2], weights: [Weights; 2]| {
            let height = hem + share * (1.04 - hem);
            Ring { weights, ..ring([0.0, height, 0.0], radii, pelvis) }
        };
        let rings = [
            at(0.0, [0.205, 0.205], pushed(0.62)),
            at(0.03, [0.225, 0.225], pushed(0.62)),
            at(0.35, [0.205, 0.190], pushed(0.50)),
            at(0.7, [0.188, 0.148], pushed(0.22)),
            at(0.9, [0.166, 0.119], pushed(0.0)),
            at(1.0, [0.152, 0.107], pushed(0.0)),
        ];
        self.tube(&rings, UPRIGHT, 18, 2, |_| Cloth::Top);
    }

    /// Adds a closed tube; `cloth` tells what each of its rows of quadrangles is made of.
    fn tube(
        &mut self,
        rings: &[Ring],
        axes: [Vec3; 2],
        sides: u32,
        pieces: u32,
        cloth: impl Fn(u32) -> Cloth,
    ) {
        let tube = Tube { rings, axes, sides, pieces };
        let first = self.vertices.len() as u32;
        let last_row = tube.ring_count() - 1;
        for row in 0..=last_row {
            let ring = tube.ring_at(row);
            for side in 0..sides {
                let (position, weights) = tube.vertex(&ring, side);
                self.vertex(position, &weights);
            }
        }
        let row_start = |row: u32| first + row * sides;
        for row in 0..last_row {
            for side in 0..sides {
                let [a, b] = [side, (side + 1) % sides].map(|side| row_start(row) + side);
                self.triangle([a, b + sides, b], cloth(row));
                self.triangle([a, a + sides, b + sides], cloth(row));
            }
        }

        // Close both ends with a fan.
        for (row, flipped) in [(0, false), (last_row, true)] {
            let end = tube.ring_at(row);
            let middle = self.vertex(end.center, &mix(end.weights[0], end.weights[1], 0.5));
            for side in 0..sides {
                let [a, b] = [side, (side + 1) % sides].map(|side| row_start(row) + side);
                let corners = if flipped { [b, a, middle] } else { [a, b, middle] };
                self.triangle(corners, cloth(row.min(last_row - 1)));
            }
        }
    }

    fn vertex(&mut self, position: Vec3, weights: &Weights) -> u32 {
        // Soles are flat.
        self.vertices.push(position.with_y(position.y.max(0.0)));
        self.influences.push(influences(weights));
        (self.vertices.len() - 1) as u32
    }

    fn triangle(&mut self, corners: [u32; 3], cloth: Cloth) {
        self.triangles.push(corners);
        self.materials.push(MaterialIdx(self.first_material + cloth as u32));
    }

    fn finish(self, root: NodeIdx) -> (SurfaceMesh, Skin) {
        let normals = smooth_normals(&self.vertices, &self.triangles).into();
        let Ok(mesh) = Mesh::from_triangles(self.vertices, self.triangles) else {
            unreachable!("the body names only vertices that it has added")
        };
        let materials = PrimMaterials::PerPrim(self.materials);
        let attributes = Arc::new(SurfaceAttributes { materials, ..SurfaceAttributes::default() });
        let skin = Skin { joints: skin_joints(root), influences: self.influences };
        (SurfaceMesh { mesh: Arc::new(mesh), normals, attributes }, skin)
    }
}

/// The rings of an egg: `radii` along +X, +Y and +Z.
fn ovoid(center: [f32; 3], radii: [f32; 3], weights: Weights) -> [Ring; 9] {
    std::array::from_fn(|row| {
        // The end rings are small, not points: the fans that close them need an area.
        let angle = (0.06 + 0.88 * row as f32 / 8.0) * std::f32::consts::PI;
        let (sin, cos) = angle.sin_cos();
        let center = [center[0], center[1] - radii[1] * cos, center[2]];
        ring(center, [radii[0] * sin, radii[2] * sin], weights)
    })
}

/// Normals of unit length: the mean of those of the triangles around, by their area.
fn smooth_normals(vertices: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; vertices.len()];
    for corners in triangles {
        let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
        let normal = (b - a).cross(c - a);
        for &corner in corners {
            normals[corner as usize] += normal;
        }
    }
    normals.into_iter().map(|normal| normal.normalize_or(Vec3::Y)).collect()
}
