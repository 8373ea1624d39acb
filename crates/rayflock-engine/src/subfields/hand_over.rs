//! Hands something that may be out of date to many threads: the first that asks brings it up to
//! date, others that ask for it wait.
//!
//! This is the lock that the paper puts on a subfield.
//!
//! **Invariants.** Whoever reads finds what is current, and it is brought up to date once. Checked
//! for all orders of three threads in `tests/hand_over.rs`, which compiles this file against the
//! model checker's locks instead of those of the standard library.

use std::sync::PoisonError;

use super::lock::RwLock;

/// Something that many threads want.
#[derive(Debug)]
pub(super) struct HandOver<T>(RwLock<T>);

impl<T> HandOver<T> {
    pub(super) fn new(value: T) -> Self {
        Self(RwLock::new(value))
    }

    /// Calls `read` with the value, after `update` where it is not current.
    pub(super) fn with<R>(
        &self,
        is_current: impl Fn(&T) -> bool,
        update: impl FnOnce(&mut T),
        read: impl FnOnce(&T) -> R,
    ) -> R {
        // A thread that panics while it updates takes the frame with it, so poison tells nothing.
        let value = self.0.read().unwrap_or_else(PoisonError::into_inner);
        if is_current(&value) {
            return read(&value);
        }
        drop(value);
        let mut value = self.0.write().unwrap_or_else(PoisonError::into_inner);
        if !is_current(&value) {
            update(&mut value);
        }
        drop(value);
        read(&self.0.read().unwrap_or_else(PoisonError::into_inner))
    }
}
