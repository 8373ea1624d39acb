//! What deformed objects are made from, on the device: meshes at rest, keys, morph targets, skins.
//!
//! What an object is made from is sent when it is first wanted, and stays until the object is made
//! from something else. Of the keys of a span, one that belonged to the span before is not sent
//! again.
//!
//! **Cost.** See [`source`](super::source).

use rayflock_engine::Budget;
use rayflock_scene::VertexInfluences;
use wgpu::Buffer;

use super::source::{Columns, INFLUENCE_WORDS, Key, Placed, Source};
use crate::GpuContext;
use crate::buffer::GrowingBuffer;

/// Words that a binding may hold: 128 MiB.
const MOST_WORDS: usize = (128 << 20) / WORD;

/// Bytes of a word.
const WORD: usize = size_of::<u32>();

/// All that objects are made from.
#[derive(Debug)]
pub(super) struct SourceStore {
    buffer: GrowingBuffer,
    /// One an object.
    residents: Vec<Option<Resident>>,
    /// Where nothing has been placed yet, in words.
    end: usize,
    /// For the frame that was placed last.
    sent_bytes: u64,
}

/// A source that is on the device.
#[derive(Debug)]
struct Resident {
    source: Source,
    placed: Placed,
    /// What lies in the places of both keys.
    keys: [Option<Key>; 2],
}

impl Default for SourceStore {
    fn default() -> Self {
        let buffer = GrowingBuffer::storage("sources");
        Self { buffer, residents: Vec::new(), end: 0, sent_bytes: 0 }
    }
}

impl SourceStore {
    /// Places what the objects of a frame are made from, and sends what is not there yet. What
    /// there is no room for is nowhere.
    pub(super) fn place(
        &mut self,
        context: &GpuContext,
        mut sources: Vec<Option<Source>>,
    ) -> Vec<Option<Placed>> {
        self.sent_bytes = 0;
        self.make_room(context, &mut sources);
        let placed = sources.iter().enumerate().map(|(object_idx, source)| {
            source.as_ref().map(|source| self.place_one(context, object_idx, source))
        });
        placed.collect()
    }

    /// The words.
    pub(super) fn buffer(&self) -> &Buffer {
        self.buffer.buffer()
    }

    /// Tells what is held and was sent.
    pub(super) fn hold(&self, budget: &mut Budget) {
        self.buffer.hold(budget);
        budget.sent_bytes += self.sent_bytes;
    }

    /// Begins anew where what is missing does not fit; leaves out what would never do so.
    fn make_room(&mut self, context: &GpuContext, sources: &mut [Option<Source>]) {
        self.residents.resize_with(sources.len(), || None);
        let mut missing = 0;
        let mut all = 0;
        for (source, resident) in sources.iter_mut().zip(&self.residents) {
            let words = source.as_ref().map_or(0, Source::words);
            if all + words > MOST_WORDS {
                *source = None;
                continue;
            }
            all += words;
            missing += if is_there(resident.as_ref(), source.as_ref()) { 0 } else { words };
        }
        if self.buffer.size() < (WORD * (self.end + missing)) as u64 {
            self.residents.fill_with(|| None);
            self.end = 0;
            self.buffer.reserve(context, WORD * all);
        }
    }

    fn place_one(&mut self, context: &GpuContext, object_idx: usize, source: &Source) -> Placed {
        let before = self.residents[object_idx].take();
        let is_there = is_there(before.as_ref(), Some(source));
        let mut resident = before.filter(|_| is_there).unwrap_or_else(|| {
            let placed = source.place(self.end);
            self.end = placed.end;
            self.send_topology(context, source, &placed);
            Resident { source: source.clone(), placed, keys: [None, None] }
        });
        let placed = self.place_keys(context, &mut resident, source);
        self.residents[object_idx] = Some(resident);
        placed
    }

    /// Sends the keys that are not there; they may lie the other way round than the span before.
    fn place_keys(
        &mut self,
        context: &GpuContext,
        resident: &mut Resident,
        source: &Source,
    ) -> Placed {
        let Resident { placed, keys, .. } = resident;
        let mut placed = placed.clone();
        let holds = |slot: usize, key: &Key| keys[slot].as_ref().is_some_and(|k| k.is_same(key));
        let is_turned = match &source.next {
            Some(next) => holds(1, &source.base) || (holds(0, next) && !holds(0, &source.base)),
            None => false,
        };
        if is_turned {
            std::mem::swap(&mut placed.base, &mut placed.next);
        }
        let slots = if is_turned { [1, 0] } else { [0, 1] };
        let wanted = [(Some(&source.base), placed.base), (source.next.as_ref(), placed.next)];
        for (slot, (key, columns)) in slots.into_iter().zip(wanted) {
            let Some(key) = key else { continue };
            if !keys[slot].as_ref().is_some_and(|held| held.is_same(key)) {
                self.send_key(context, key, columns);
                keys[slot] = Some(key.clone());
            }
        }
        placed
    }

    fn send_key(&mut self, context: &GpuContext, key: &Key, columns: Columns) {
        self.send(context, columns.positions, key.mesh.vertices());
        self.send(context, columns.normals, &key.normals);
    }

    /// Sends what does not change from key to key.
    fn send_topology(&mut self, context: &GpuContext, source: &Source, placed: &Placed) {
        self.send(context, placed.corners, source.base.mesh.triangles());
        for (target, columns) in source.targets().iter().zip(&placed.targets) {
            self.send(context, columns.positions, &target.positions);
            self.send(context, columns.normals, &target.normals);
        }
        if let Some(skin) = &source.skin {
            let influences: Vec<_> = skin.influences.iter().map(influence_words).collect();
            self.send(context, placed.influences, &influences);
        }
    }

    fn send<T: bytemuck::Pod>(&mut self, context: &GpuContext, first_word: u32, values: &[T]) {
        if !values.is_empty() {
            self.buffer.write_at(context, WORD * first_word as usize, values);
            self.sent_bytes += size_of_val(values) as u64;
        }
    }
}

/// Whether a source can take the place of the resident one, but for its keys.
fn is_there(resident: Option<&Resident>, source: Option<&Source>) -> bool {
    match (resident, source) {
        (Some(resident), Some(source)) => source.is_laid_out_like(&resident.source),
        (_, None) => true,
        (None, Some(_)) => false,
    }
}

/// Two joints a word, then the weights.
fn influence_words(influences: &VertexInfluences) -> [u32; INFLUENCE_WORDS] {
    let VertexInfluences { joints, weights } = influences;
    std::array::from_fn(|word| match word.checked_sub(joints.len() / 2) {
        None => u32::from(joints[2 * word]) | u32::from(joints[2 * word + 1]) << 16,
        Some(slot) => weights[slot].to_bits(),
    })
}
