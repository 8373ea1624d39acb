//! Divides the objects of a frame: those that rest are kept in one tree from frame to frame, those
//! that change get a fresh one each frame.
//!
//! An object may move to the kept tree once it has rested for a frame. The kept tree is built
//! anew when the primitives that rested outside of it, summed over the frames since it was built,
//! are as many as it would hold: by then, fresh trees have cost about as much as building it, so
//! together both cost at most about twice what the best choice would have (a better order is paid
//! for by rays, see `bvh`'s `leaf_order`). When one of its
//! objects changes, all objects are fresh again.

use rayflock_geom::{Geometry, GeometryObject};

use crate::primitives::ObjectSpan;

/// What is to be done about the kept tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum KeptChange {
    /// It stays as it is.
    None,
    /// It is to be built over the kept objects, perhaps none.
    Build,
}

/// Which objects are in which tree.
#[derive(Debug, Default)]
pub(crate) struct Parts {
    /// All objects of the frame before, in the order of their ids.
    before: Vec<Placed>,
    /// One for each object of this frame.
    places: Vec<Place>,
    kept_object_count: usize,
    /// Primitives that rested outside of the kept tree, summed over the frames since it was built.
    rested_count: usize,
}

/// An object, where its primitives lay in the table, and in which tree.
#[derive(Clone, Debug)]
struct Placed {
    object: GeometryObject,
    span: ObjectSpan,
    place: Place,
}

/// Where an object's primitives are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Place {
    /// In the kept tree.
    Kept,
    /// In the fresh tree: it rests, but is not worth a new kept tree yet.
    Resting,
    /// In the fresh tree: it changed.
    Changed,
}

impl Parts {
    /// Divides the objects of a frame; `spans` tells where their primitives lie.
    pub(crate) fn divide(&mut self, geometry: &Geometry, spans: &[ObjectSpan]) -> KeptChange {
        self.find_places(geometry, spans);
        let kept_count = self.prim_count(spans, Place::Kept);
        let resting_count = self.prim_count(spans, Place::Resting);
        let still_kept = self.places.iter().filter(|&&place| place == Place::Kept).count();

        let mut change = KeptChange::None;
        self.rested_count += resting_count;
        if still_kept < self.kept_object_count {
            self.replace(Place::Kept, Place::Resting);
            self.rested_count = 0;
            change = KeptChange::Build;
        } else if resting_count > 0 && self.rested_count >= kept_count + resting_count {
            self.replace(Place::Resting, Place::Kept);
            self.rested_count = 0;
            change = KeptChange::Build;
        }
        self.remember(geometry, spans);
        change
    }

    /// Where the primitives of each object are.
    pub(crate) fn places(&self) -> &[Place] {
        &self.places
    }

    /// What each object was in the frame before, or `Changed`.
    fn find_places(&mut self, geometry: &Geometry, spans: &[ObjectSpan]) {
        self.places.clear();
        let mut before = self.before.iter().peekable();
        for (object, span) in geometry.objects().iter().zip(spans) {
            while before.next_if(|before| before.object.id < object.id).is_some() {}
            let rested = before.peek().filter(|before| {
                before.object.id == object.id
                    && before.span == *span
                    && object.is_same(&before.object)
            });
            self.places.push(match rested.map(|before| before.place) {
                Some(Place::Kept) => Place::Kept,
                Some(Place::Resting | Place::Changed) => Place::Resting,
                None => Place::Changed,
            });
        }
    }

    fn replace(&mut self, from: Place, to: Place) {
        for place in self.places.iter_mut().filter(|place| **place == from) {
            *place = to;
        }
    }

    fn prim_count(&self, spans: &[ObjectSpan], wanted: Place) -> usize {
        let chosen = self.places.iter().zip(spans).filter(|&(&place, _)| place == wanted);
        chosen.map(|(_, span)| span.prim_count()).sum()
    }

    fn remember(&mut self, geometry: &Geometry, spans: &[ObjectSpan]) {
        self.before.clear();
        let objects = geometry.objects().iter().zip(spans).zip(&self.places);
        self.before.extend(objects.map(|((object, &span), &place)| Placed {
            object: object.clone(),
            span,
            place,
        }));
        self.kept_object_count = self.places.iter().filter(|&&place| place == Place::Kept).count();
    }

    /// Bytes held.
    pub(crate) fn memory_usage(&self) -> usize {
        self.before.capacity() * size_of::<Placed>() + self.places.capacity() * size_of::<Place>()
    }
}
