//! What one deformed object is made from, and how that lies among words.
//!
//! ```text
//!   corners | positions, normals | those of the next key | those of each target | influences
//! ```
//!
//! **Cost.** Bytes: 12 a triangle; a vertex 12 for each of its positions and normals at rest, at
//! the next key and in a target, and 48 for a skin.

use std::sync::Arc;

use glam::Vec3;
use rayflock_geom::Mesh;
use rayflock_scene::{MorphTarget, Skin, SurfaceMesh};

use crate::layout::NOWHERE;

/// Words of the influences of a vertex, as in `frame/deform_vertices.wgsl`.
pub(crate) const INFLUENCE_WORDS: usize = 12;

/// What an object is made from.
#[derive(Clone, Debug)]
pub(super) struct Source {
    /// The mesh at rest, or at the key before.
    pub(super) base: Key,
    /// The mesh at the next key, with as many normals.
    pub(super) next: Option<Key>,
    pub(super) targets: Option<Arc<[MorphTarget]>>,
    pub(super) skin: Option<Arc<Skin>>,
}

/// What changes from key to key.
#[derive(Clone, Debug)]
pub(super) struct Key {
    pub(super) mesh: Arc<Mesh>,
    pub(super) normals: Arc<[Vec3]>,
}

/// Where the parts of a source begin, in words.
#[derive(Clone, Debug)]
pub(super) struct Placed {
    pub(super) corners: u32,
    pub(super) base: Columns,
    pub(super) next: Columns,
    pub(super) targets: Vec<Columns>,
    pub(super) influences: u32,
    /// Where the source ends.
    pub(super) end: usize,
}

/// Where columns of vectors begin; `NOWHERE` for those that are not there.
#[derive(Clone, Copy, Debug)]
pub(super) struct Columns {
    pub(super) positions: u32,
    pub(super) normals: u32,
}

impl Key {
    pub(super) fn new(surface: &SurfaceMesh) -> Self {
        Self { mesh: Arc::clone(&surface.mesh), normals: Arc::clone(&surface.normals) }
    }

    pub(super) fn is_same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mesh, &other.mesh) && Arc::ptr_eq(&self.normals, &other.normals)
    }
}

impl Source {
    /// Of a mesh that moves as a whole at most.
    pub(super) fn rigid(surface: &SurfaceMesh) -> Self {
        Self { base: Key::new(surface), next: None, targets: None, skin: None }
    }

    /// Whether what is made from this has the triangles and as many vertices as `mesh`, and all
    /// parts fit together: whoever says how a mesh came about may be wrong.
    pub(super) fn makes(&self, mesh: &Mesh) -> bool {
        let count = mesh.vertices().len();
        let fits = |key: &Key| {
            key.mesh.has_topology_of(mesh)
                && key.mesh.vertices().len() == count
                && key.normals.len() == self.base.normals.len()
                && (key.normals.is_empty() || key.normals.len() == count)
        };
        let fills = |column: &[Vec3]| column.is_empty() || column.len() == count;
        fits(&self.base)
            && self.next.as_ref().is_none_or(fits)
            && self.targets().iter().all(|t| fills(&t.positions) && fills(&t.normals))
            && self.skin.as_ref().is_none_or(|skin| skin.influences.len() == count)
    }

    pub(super) fn vertex_count(&self) -> usize {
        self.base.mesh.vertices().len()
    }

    pub(super) fn targets(&self) -> &[MorphTarget] {
        self.targets.as_deref().unwrap_or_default()
    }

    /// Words that the source takes.
    pub(super) fn words(&self) -> usize {
        self.place(0).end
    }

    /// Whether both have the same but for their keys.
    pub(super) fn is_laid_out_like(&self, other: &Self) -> bool {
        let same_targets = match (&self.targets, &other.targets) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let same_skin = match (&self.skin, &other.skin) {
            (Some(a), Some(b)) => Arc::ptr_eq(a, b),
            (a, b) => a.is_none() && b.is_none(),
        };
        let (key, other_key) = (&self.base, &other.base);
        key.mesh.has_topology_of(&other_key.mesh)
            && self.vertex_count() == other.vertex_count()
            && key.normals.len() == other_key.normals.len()
            && self.next.is_some() == other.next.is_some()
            && same_targets
            && same_skin
    }

    /// Where the parts lie if the source begins at this word.
    pub(super) fn place(&self, first_word: usize) -> Placed {
        let vertex_count = self.vertex_count();
        let mut end = first_word;
        // Past what takes so many words; nowhere if that is none.
        let mut take = |words: usize| {
            end += words;
            if words == 0 { NOWHERE } else { (end - words) as u32 }
        };
        let corners = take(3 * self.base.mesh.triangles().len());
        let mut columns = |positions: usize, normals: usize| Columns {
            positions: take(3 * positions),
            normals: take(3 * normals),
        };
        let normal_count = self.base.normals.len();
        let base = columns(vertex_count, normal_count);
        let next = self.next.as_ref().map(|_| columns(vertex_count, normal_count));
        let targets = self.targets().iter();
        let targets =
            targets.map(|target| columns(target.positions.len(), target.normals.len())).collect();
        let influences = take(self.skin.as_ref().map_or(0, |_| INFLUENCE_WORDS * vertex_count));
        let next = next.unwrap_or(Columns { positions: NOWHERE, normals: NOWHERE });
        Placed { corners, base, next, targets, influences, end }
    }
}
