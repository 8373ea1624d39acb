//! The pieces of work of the map with a number of triangles.

use rayflock::engine::RayEngine;
use rayflock::engine::hierarchy::HierarchyEngine;
use rayflock::geom::{FrameChanges, Geometry};

use super::SCENE;
use crate::BenchError;
use crate::contest::{Piece, PieceFrame, PiecePhase};
use crate::work::{self, Definition, MovingScene, RayKind, RaySet};

/// The geometry of all frames, and who finds what the camera sees.
#[derive(Debug)]
pub(crate) struct MapWork<'a> {
    definition: &'a Definition,
    triangles: usize,
    phases: Vec<Phase<'a>>,
}

#[derive(Debug)]
struct Phase<'a> {
    name: &'a str,
    before: Geometry,
    frames: Vec<Frame>,
}

#[derive(Debug)]
struct Frame {
    geometry: Geometry,
    /// Has `geometry` committed.
    finder: HierarchyEngine,
}

impl<'a> MapWork<'a> {
    /// The work of `definition` with `triangles` moving triangles.
    pub(crate) fn new(definition: &'a Definition, triangles: usize) -> Result<Self, BenchError> {
        let scene = MovingScene::new(definition, triangles);
        let phases = definition.phases.iter().map(|phase| {
            let frames = phase.frames.iter().map(|&time| Frame::new(scene.geometry(time)));
            Ok(Phase {
                name: &phase.name,
                before: scene.geometry(phase.before),
                frames: frames.collect::<Result<_, BenchError>>()?,
            })
        });
        Ok(Self { definition, triangles, phases: phases.collect::<Result<_, BenchError>>()? })
    }

    /// One piece a kind, with about `rays` rays a frame.
    pub(crate) fn pieces(&mut self, rays: usize, kinds: &[RayKind]) -> Vec<Piece> {
        kinds.iter().map(|&kind| self.piece(rays, kind)).collect()
    }

    fn piece(&mut self, rays: usize, kind: RayKind) -> Piece {
        let Self { definition, triangles, phases } = self;
        let phases = phases.iter_mut().map(|phase| PiecePhase {
            name: phase.name.to_owned(),
            frame: None,
            before: phase.before.clone(),
            frames: phase
                .frames
                .iter_mut()
                .map(|frame| frame.piece(definition, rays, kind))
                .collect(),
        });
        Piece { scene: SCENE.to_owned(), triangles: *triangles, kind, phases: phases.collect() }
    }
}

impl Frame {
    fn new(geometry: Geometry) -> Result<Self, BenchError> {
        let mut finder = HierarchyEngine::default();
        finder.commit(&geometry, &FrameChanges::all())?;
        Ok(Self { geometry, finder })
    }

    fn piece(&mut self, definition: &Definition, rays: usize, kind: RayKind) -> PieceFrame {
        let Self { geometry, finder } = self;
        let (size, surroundings) = (work::image_size(rays), definition.surroundings());
        let rays: RaySet =
            work::generate(kind, size, &surroundings, geometry, finder, definition.seed);
        PieceFrame { geometry: geometry.clone(), rays }
    }
}
