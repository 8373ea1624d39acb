//! The answer: what each ray hit, as columns that the caller owns.

use crate::{NO_ID, ObjectId, PrimId};

/// What one ray hit.
///
/// On triangle `v0, v1, v2` the point is `(1 - u - v) v0 + u v1 + v v2`; spheres have
/// `u = v = 0`; user primitives define their own.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Distance in multiples of the direction's length; infinite for a miss.
    pub t: f32,
    /// Barycentric coordinate of vertex 1.
    pub u: f32,
    /// Barycentric coordinate of vertex 2.
    pub v: f32,
    /// The object, or [`ObjectId::NONE`].
    pub object_id: ObjectId,
    /// The primitive within the object's mesh, or [`PrimId::NONE`].
    pub prim_id: PrimId,
}

impl Hit {
    /// Nothing was hit.
    pub const MISS: Self =
        Self { t: f32::INFINITY, u: 0.0, v: 0.0, object_id: ObjectId::NONE, prim_id: PrimId::NONE };

    /// Whether nothing was hit.
    pub fn is_miss(&self) -> bool {
        self.object_id == ObjectId::NONE
    }

    /// Whether this hit wins over `other`: smaller `t`, then the lower object, then the lower
    /// primitive.
    pub fn is_nearer_than(&self, other: &Self) -> bool {
        let order = |hit: &Self| (hit.object_id, hit.prim_id);
        self.t < other.t || (self.t == other.t && order(self) < order(other))
    }
}

/// Columns that receive hits, each optional but `t`; every column has the length of the batch.
///
/// Engines *replace* entry `i` when they find a nearer hit of ray `i`, so that several engines
/// can answer one batch together. Start from [`Hit::MISS`].
#[derive(Debug)]
pub struct Hits<'a> {
    /// Distances.
    pub t: &'a mut [f32],
    /// Barycentric coordinates.
    pub uv: Option<&'a mut [[f32; 2]]>,
    /// Objects; [`NO_ID`] for none.
    pub object_id: Option<&'a mut [u32]>,
    /// Primitives; [`NO_ID`] for none.
    pub prim_id: Option<&'a mut [u32]>,
}

impl<'a> Hits<'a> {
    /// A receiver of distances only.
    pub const fn distances(t: &'a mut [f32]) -> Self {
        Self { t, uv: None, object_id: None, prim_id: None }
    }

    /// Number of rays.
    pub const fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no ray.
    pub const fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// Whether every column that is there has `len` entries.
    pub fn has_len(&self, len: usize) -> bool {
        let ids = [&self.object_id, &self.prim_id];
        self.t.len() == len
            && self.uv.as_ref().is_none_or(|uv| uv.len() == len)
            && ids.into_iter().flatten().all(|ids| ids.len() == len)
    }

    /// What is known of ray `ray_idx`; columns that are absent read as in a miss.
    #[inline]
    pub fn get(&self, ray_idx: usize) -> Hit {
        let [u, v] = self.uv.as_ref().map_or([0.0; 2], |uv| uv[ray_idx]);
        let id = |column: &Option<&mut [u32]>| column.as_ref().map_or(NO_ID, |ids| ids[ray_idx]);
        Hit {
            t: self.t[ray_idx],
            u,
            v,
            object_id: ObjectId(id(&self.object_id)),
            prim_id: PrimId(id(&self.prim_id)),
        }
    }

    /// The same columns, for as long as they are lent.
    pub fn reborrow(&mut self) -> Hits<'_> {
        Hits {
            t: self.t,
            uv: self.uv.as_deref_mut(),
            object_id: self.object_id.as_deref_mut(),
            prim_id: self.prim_id.as_deref_mut(),
        }
    }

    /// The first `middle` rays and the others, to be written by different threads.
    ///
    /// # Panics
    /// When a column has fewer than `middle` rays.
    pub fn split_at(self, middle: usize) -> (Self, Self) {
        let (t_left, t_right) = self.t.split_at_mut(middle);
        let (uv_left, uv_right) = split_column(self.uv, middle);
        let (object_left, object_right) = split_column(self.object_id, middle);
        let (prim_left, prim_right) = split_column(self.prim_id, middle);
        (
            Self { t: t_left, uv: uv_left, object_id: object_left, prim_id: prim_left },
            Self { t: t_right, uv: uv_right, object_id: object_right, prim_id: prim_right },
        )
    }

    /// Writes `hit` for ray `ray_idx` if it is nearer than what is there. Where the id columns
    /// that would decide are absent, an equal `t` changes nothing.
    #[inline]
    pub fn offer(&mut self, ray_idx: usize, hit: &Hit) {
        // Most often the distance decides, and the other columns are not read.
        let is_nearer = hit.t < self.t[ray_idx];
        if is_nearer || (hit.t == self.t[ray_idx] && self.wins_tie(ray_idx, hit)) {
            self.write(ray_idx, hit);
        }
    }

    /// Whether the ids decide for `hit`, which is as near as what is there.
    fn wins_tie(&self, ray_idx: usize, hit: &Hit) -> bool {
        let here = self.get(ray_idx);
        let same_object = self.prim_id.is_none() && hit.object_id == here.object_id;
        let is_unknown = self.object_id.is_none() || same_object;
        !is_unknown && hit.is_nearer_than(&here)
    }

    #[inline]
    fn write(&mut self, ray_idx: usize, hit: &Hit) {
        self.t[ray_idx] = hit.t;
        if let Some(uv) = &mut self.uv {
            uv[ray_idx] = [hit.u, hit.v];
        }
        if let Some(object_id) = &mut self.object_id {
            object_id[ray_idx] = hit.object_id.0;
        }
        if let Some(prim_id) = &mut self.prim_id {
            prim_id[ray_idx] = hit.prim_id.0;
        }
    }
}

fn split_column<T>(
    column: Option<&mut [T]>,
    middle: usize,
) -> (Option<&mut [T]>, Option<&mut [T]>) {
    column.map(|column| column.split_at_mut(middle)).unzip()
}

/// Owned hit columns, reused from batch to batch.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct HitBuffer {
    /// Distances.
    pub t: Vec<f32>,
    /// Barycentric coordinates.
    pub uv: Vec<[f32; 2]>,
    /// Objects.
    pub object_id: Vec<u32>,
    /// Primitives.
    pub prim_id: Vec<u32>,
}

impl HitBuffer {
    /// A buffer of `len` misses.
    pub fn new(len: usize) -> Self {
        let mut buffer = Self::default();
        buffer.reset(len);
        buffer
    }

    /// Makes this a buffer of `len` misses, keeping its memory.
    pub fn reset(&mut self, len: usize) {
        reset_column(&mut self.t, len, f32::INFINITY);
        reset_column(&mut self.uv, len, [0.0; 2]);
        reset_column(&mut self.object_id, len, NO_ID);
        reset_column(&mut self.prim_id, len, NO_ID);
    }

    /// Number of rays.
    pub const fn len(&self) -> usize {
        self.t.len()
    }

    /// Whether there is no ray.
    pub const fn is_empty(&self) -> bool {
        self.t.is_empty()
    }

    /// All columns, to be written by an engine.
    pub fn as_hits(&mut self) -> Hits<'_> {
        Hits {
            t: &mut self.t,
            uv: Some(&mut self.uv),
            object_id: Some(&mut self.object_id),
            prim_id: Some(&mut self.prim_id),
        }
    }

    /// What ray `ray_idx` hit.
    #[inline]
    pub fn get(&self, ray_idx: usize) -> Hit {
        let [u, v] = self.uv[ray_idx];
        Hit {
            t: self.t[ray_idx],
            u,
            v,
            object_id: ObjectId(self.object_id[ray_idx]),
            prim_id: PrimId(self.prim_id[ray_idx]),
        }
    }
}

fn reset_column<T: Copy>(column: &mut Vec<T>, len: usize, value: T) {
    column.clear();
    column.resize(len, value);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn hit(t: f32, object: u32, prim: u32) -> Hit {
        Hit { t, u: 0.25, v: 0.5, object_id: ObjectId(object), prim_id: PrimId(prim) }
    }

    #[test]
    fn offer_keeps_the_nearer_hit_and_breaks_ties_by_id() {
        let mut buffer = HitBuffer::new(1);
        for (offered, expected) in [
            (hit(2.0, 5, 5), hit(2.0, 5, 5)),
            (hit(3.0, 0, 0), hit(2.0, 5, 5)),
            (hit(2.0, 5, 4), hit(2.0, 5, 4)),
            (hit(2.0, 6, 0), hit(2.0, 5, 4)),
            (hit(1.0, 9, 9), hit(1.0, 9, 9)),
        ] {
            buffer.as_hits().offer(0, &offered);
            assert_eq!(buffer.get(0), expected);
        }
    }

    #[test]
    fn halves_are_written_apart() {
        let mut buffer = HitBuffer::new(5);
        let (mut left, mut right) = buffer.as_hits().split_at(2);
        assert_eq!((left.len(), right.len()), (2, 3));
        left.offer(1, &hit(1.0, 2, 3));
        right.reborrow().offer(2, &hit(4.0, 5, 6));
        assert_eq!((buffer.get(1), buffer.get(4)), (hit(1.0, 2, 3), hit(4.0, 5, 6)));
        assert!([0, 2, 3].iter().all(|&idx| buffer.get(idx).is_miss()));
        let (left, right) = Hits::distances(&mut buffer.t).split_at(5);
        assert!(left.uv.is_none() && right.object_id.is_none() && right.is_empty());
    }

    #[test]
    fn a_miss_never_replaces_and_absent_columns_are_left_alone() {
        let mut t = [4.0];
        let mut hits = Hits::distances(&mut t);
        hits.offer(0, &Hit::MISS);
        hits.offer(0, &hit(3.0, 1, 1));
        assert_eq!(t, [3.0]);
    }
}
