//! Memory of tasks that are not running, to be used again by those that start.

use std::sync::Mutex;

/// A pool of working memory.
#[derive(Debug)]
pub(crate) struct Scratch<T>(Mutex<Vec<T>>);

impl<T> Default for Scratch<T> {
    fn default() -> Self {
        Self(Mutex::default())
    }
}

impl<T: Default> Scratch<T> {
    /// Takes out what some task has used, or something new.
    pub(crate) fn take(&self) -> T {
        let pooled = self.0.lock().ok().and_then(|mut pool| pool.pop());
        pooled.unwrap_or_default()
    }

    /// Hands memory to the next task.
    pub(crate) fn give_back(&self, used: T) {
        if let Ok(mut pool) = self.0.lock() {
            pool.push(used);
        }
    }

    /// The sum over all that is in the pool.
    pub(crate) fn sum(&self, size: impl Fn(&T) -> usize) -> usize {
        self.0.lock().map_or(0, |pool| pool.iter().map(size).sum())
    }
}
