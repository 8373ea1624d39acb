//! A piece of work that all engines do: one cell of a table.

use rayflock::geom::Geometry;

use crate::work::{Question, RayKind, RaySet};

/// Rays of one kind through a few phases of motion.
#[derive(Clone, Debug)]
pub struct Piece {
    /// The scene, as records name it.
    pub scene: String,
    /// Primitives, as records count them: the moving ones of the map, all of another scene.
    pub triangles: usize,
    /// The kind of all rays.
    pub kind: RayKind,
    /// What is measured and averaged.
    pub phases: Vec<PiecePhase>,
}

/// Frames that look alike, and the one that comes before them.
#[derive(Clone, Debug)]
pub struct PiecePhase {
    /// Its name in records.
    pub name: String,
    /// The frame, where phases are frames of an animation.
    pub frame: Option<u32>,
    /// What engines hold before the phase; with a single frame, before each turn.
    pub before: Geometry,
    /// Measured in turn; with two or more, each commit follows that of the frame before in this
    /// list, so that all that moves has moved.
    pub frames: Vec<PieceFrame>,
}

/// One measured frame.
#[derive(Clone, Debug)]
pub struct PieceFrame {
    /// What is committed.
    pub geometry: Geometry,
    /// What is then traced.
    pub rays: RaySet,
}

impl Piece {
    /// What is asked about the rays.
    pub const fn question(&self) -> Question {
        self.kind.question()
    }
}
