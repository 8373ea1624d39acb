//! The locks that [`hand_over`](super::hand_over) is made of.

pub(super) use std::sync::RwLock;
