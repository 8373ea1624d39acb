//! A surface whose every triangle flies off on its own.

use std::f32::consts::TAU;
use std::sync::Arc;

use glam::{Quat, Vec3};
use rayflock_geom::Mesh;

use super::flight::Flight;
use super::{DURATION, IMPACT, IMPACT_TIME, ball};
use crate::builtin::random::Random;
use crate::{AnimatedMesh, SurfaceAttributes, SurfaceMesh};

/// How fast the crack runs from the point of impact, in scene units per second.
const CRACK_SPEED: f32 = 1.5;

/// The triangles and their flights.
#[derive(Debug)]
pub(super) struct Fragments {
    flights: Vec<Flight>,
    /// The surface before the impact: three vertices a triangle, in order.
    whole: SurfaceMesh,
    /// The surface when all lies still.
    rubble: SurfaceMesh,
    /// When that is, in seconds.
    end: f32,
}

impl Fragments {
    /// The fragments of a surface with three vertices a triangle, in order, and normals.
    pub(super) fn new(whole: SurfaceMesh) -> Self {
        let mut random = Random::new(3);
        let triangles = whole.mesh.vertices().chunks_exact(3);
        let flights: Vec<Flight> =
            triangles.map(|c| flight([c[0], c[1], c[2]], &mut random)).collect();
        let end = flights.iter().map(Flight::end).fold(IMPACT_TIME, f32::max).min(DURATION);
        let mut fragments = Self { flights, rubble: whole.clone(), whole, end };
        fragments.rubble = fragments.flying(end);
        fragments
    }

    /// The surface at `time`.
    fn flying(&self, time: f32) -> SurfaceMesh {
        let count = self.whole.mesh.vertices().len();
        let mut vertices = Vec::with_capacity(count);
        let mut normals = Vec::with_capacity(count);
        let corners = self.whole.mesh.vertices().chunks_exact(3);
        let corner_normals = self.whole.normals.chunks_exact(3);
        for ((flight, corners), corner_normals) in
            self.flights.iter().zip(corners).zip(corner_normals)
        {
            if time <= flight.launch {
                vertices.extend_from_slice(corners);
                normals.extend_from_slice(corner_normals);
                continue;
            }
            let rotation = flight.rotation(time);
            let turned = [0, 1, 2].map(|corner| rotation * (corners[corner] - flight.start));
            // However it is turned, its lowest corner stays above the floor.
            let lowest = turned.iter().fold(f32::INFINITY, |lowest, corner| lowest.min(corner.y));
            let mut center = flight.position(time);
            center.y = center.y.max(FLOOR_GAP - lowest);
            vertices.extend(turned.map(|corner| center + corner));
            normals.extend(corner_normals.iter().map(|&normal| rotation * normal));
        }
        let Ok(mesh) = self.whole.mesh.with_vertices(vertices) else {
            unreachable!("three vertices a triangle")
        };
        let attributes = Arc::clone(&self.whole.attributes);
        SurfaceMesh { mesh: Arc::new(mesh), normals: normals.into(), attributes }
    }
}

/// The least height of a flying corner: enough not to be hidden by the floor.
const FLOOR_GAP: f32 = 1e-3;

impl AnimatedMesh for Fragments {
    fn time_range(&self) -> (f64, f64) {
        (f64::from(IMPACT_TIME), f64::from(self.end))
    }

    fn at(&self, time: f64) -> Result<SurfaceMesh, String> {
        let time = time as f32;
        Ok(if time >= self.end {
            self.rubble.clone()
        } else if time > IMPACT_TIME {
            self.flying(time)
        } else {
            self.whole.clone()
        })
    }
}

/// The flight of one triangle: away from the impact and along with the ball, the faster the
/// nearer, until it lies nearly flat on the floor.
fn flight(corners: [Vec3; 3], random: &mut Random) -> Flight {
    let start = (corners[0] + corners[1] + corners[2]) / 3.0;
    let away = start - IMPACT;
    let distance = away.length();
    let force = (-distance / 0.8).exp();
    let velocity = (0.16 + 1.3 * force) * away.normalize_or(Vec3::Y)
        + force * 0.3 * ball::VELOCITY
        + (0.15 + 0.35 * force) * random.direction()
        + Vec3::Y * random.between(0.0, 0.3);

    // The turn that lays the triangle down, with some whole turns on top.
    let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]).normalize_or(Vec3::Y);
    let upward = (Vec3::Y + random.between(0.0, 0.35) * random.direction()).normalize_or(Vec3::Y);
    let laid = Quat::from_axis_angle(Vec3::Y, random.between(0.0, 6.0))
        * Quat::from_rotation_arc(normal, upward);
    let (axis, angle) = laid.to_axis_angle();
    let whole_turns = (1.0 + 4.0 * force + 1.5 * random.unit()).floor();
    Flight {
        launch: IMPACT_TIME + distance / CRACK_SPEED,
        start,
        velocity,
        axis,
        turn: angle + TAU * whole_turns,
    }
}

/// A mesh with three vertices of its own for each triangle of `surface`, and its normals.
pub(super) fn unshared(surface: &SurfaceMesh) -> SurfaceMesh {
    let pick = |column: &[Vec3]| -> Vec<Vec3> {
        surface.mesh.triangles().iter().flatten().map(|&idx| column[idx as usize]).collect()
    };
    let count = surface.mesh.triangles().len() as u32;
    let triangles: Vec<[u32; 3]> = (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let Ok(mesh) = Mesh::from_triangles(pick(surface.mesh.vertices()), triangles) else {
        unreachable!("three vertices a triangle")
    };
    let normals = pick(&surface.normals).into();
    let uvs = Vec::new();
    let attributes = SurfaceAttributes { uvs, ..(*surface.attributes).clone() };
    SurfaceMesh { mesh: Arc::new(mesh), normals, attributes: Arc::new(attributes) }
}
