//! What makes two cells comparable.

use crate::record::{Cell, Record};

use super::distinct;

/// The kind that stands for all rays of a picture.
pub(crate) const PICTURE: &str = "picture";

/// The work of a cell, whichever engine does it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Work<'a> {
    /// The scene: `map`, a file or `builtin:NAME`.
    pub scene: &'a str,
    /// The kind of the rays.
    pub kind: &'a str,
    /// Triangles, as in [`Cell::triangles`].
    pub triangles: usize,
    /// Rays a frame; 0 for pictures, where a hit that differs may add or save some.
    pub rays: u64,
    /// Threads worked with.
    pub threads: usize,
}

impl Cell {
    /// What this cell is the cost of.
    pub fn work(&self) -> Work<'_> {
        Work {
            scene: &self.scene,
            kind: &self.kind,
            triangles: self.triangles,
            rays: if self.kind == PICTURE { 0 } else { self.rays },
            threads: self.threads,
        }
    }
}

impl Record {
    /// All different work, in the order of its first cells.
    pub fn works(&self) -> Vec<Work<'_>> {
        distinct(self.cells.iter().map(Cell::work))
    }

    /// All engines, in the order of their first cells.
    pub fn engines(&self) -> Vec<&str> {
        distinct(self.cells.iter().map(|cell| cell.engine.as_str()))
    }

    /// All kinds of rays, in the order of their first cells.
    pub fn kinds(&self) -> Vec<&str> {
        distinct(self.cells.iter().map(|cell| cell.kind.as_str()))
    }

    /// The cell of `engine` for `work`.
    pub fn cell(&self, engine: &str, work: &Work<'_>) -> Option<&Cell> {
        self.cells.iter().find(|cell| cell.engine == engine && cell.work() == *work)
    }
}
