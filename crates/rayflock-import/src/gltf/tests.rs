//! Tests on tiny documents.
