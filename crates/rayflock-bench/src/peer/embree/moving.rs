//! Which objects move: what Embree's own users know of their scenes, told from its frames.
//!
//! An object is static until it changes for the first time; an object that comes later moves.
//! When nothing is left of the frame before, a new scene begins and all is static again; twice in
//! a row is no new scene, but one that changes wholly each frame. A frame that comes after an
//! empty one begins a scene whatever came before.

use std::collections::BTreeSet;

use rayflock::geom::{FrameChanges, ObjectChange, ObjectId};

/// The objects that move.
#[derive(Debug, Default)]
pub(super) struct Moving {
    ids: BTreeSet<ObjectId>,
    /// Whether the last frame began a scene.
    is_new_scene: bool,
}

impl Moving {
    /// Takes note of a frame; `changes` since the frame before, `None` for the first.
    pub(super) fn note(&mut self, changes: Option<&FrameChanges>) {
        let left = |changes: &FrameChanges| changes.iter().any(|(_, change)| is_left(change));
        let was_empty = |changes: &FrameChanges| {
            changes.iter().all(|(_, change)| change == ObjectChange::Added)
        };
        self.is_new_scene = match changes {
            Some(changes) => was_empty(changes) || (!self.is_new_scene && !left(changes)),
            None => true,
        };
        let Some(changes) = changes.filter(|_| !self.is_new_scene) else {
            return self.ids.clear();
        };
        for (id, change) in changes.iter() {
            match change {
                ObjectChange::Unchanged => {}
                ObjectChange::Removed => _ = self.ids.remove(&id),
                _ => _ = self.ids.insert(id),
            }
        }
    }

    /// Whether the object moves.
    pub(super) fn contains(&self, id: ObjectId) -> bool {
        self.ids.contains(&id)
    }
}

/// Whether the object is still what it was, wherever it is now.
fn is_left(change: ObjectChange) -> bool {
    matches!(change, ObjectChange::Unchanged | ObjectChange::Transformed | ObjectChange::Deformed)
}

#[cfg(test)]
mod tests {
    use ObjectChange::{Added, Deformed, Removed, Retopologised, Unchanged};

    use super::*;

    /// Which of the objects 0 to 9 move after these frames.
    fn moving(frames: &[&[(u32, ObjectChange)]]) -> Vec<u32> {
        let mut moving = Moving::default();
        moving.note(None);
        for frame in frames {
            let mut changes = FrameChanges::none();
            for &(id, change) in *frame {
                changes.set(ObjectId(id), change);
            }
            moving.note(Some(&changes));
        }
        (0..10).filter(|&id| moving.contains(ObjectId(id))).collect()
    }

    #[test]
    fn what_changes_once_moves_until_it_is_gone() {
        assert_eq!(moving(&[&[(0, Unchanged), (1, Deformed)]]), [1]);
        let later: &[_] = &[(0, Unchanged), (1, Unchanged), (2, Added)];
        assert_eq!(moving(&[&[(0, Unchanged), (1, Deformed)], later]), [1, 2]);
        let gone: &[_] = &[(0, Unchanged), (1, Removed)];
        assert!(moving(&[&[(0, Unchanged), (1, Deformed)], gone]).is_empty());
    }

    #[test]
    fn another_scene_is_static_again() {
        let first: &[_] = &[(0, Unchanged), (1, Deformed)];
        let other: &[_] = &[(0, Retopologised), (1, Retopologised)];
        assert!(moving(&[first, other]).is_empty());
        assert_eq!(moving(&[first, other, first]), [1]);
    }

    #[test]
    fn what_comes_after_an_empty_frame_is_static_until_it_changes() {
        let filled: &[_] = &[(0, Added), (1, Added)];
        assert!(moving(&[filled]).is_empty());
        assert_eq!(moving(&[filled, &[(0, Unchanged), (1, Deformed)]]), [1]);
        let emptied: &[_] = &[(0, Removed), (1, Removed)];
        assert!(moving(&[&[(0, Deformed), (1, Deformed)], emptied, filled]).is_empty());
    }

    #[test]
    fn a_scene_that_changes_wholly_each_frame_moves() {
        let frame: &[_] = &[(0, Retopologised)];
        assert_eq!(moving(&[frame]), [0]);
        assert_eq!(moving(&[&[(1, Deformed)], frame, frame]), [0]);
    }
}
