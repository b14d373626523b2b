//! Runs with other values than those of A and B: which change did what, what would look the same, and what a percent of a
//! measured number changes.

pub(super) mod by_key;
pub(super) mod matching;
pub(super) mod sensitivity;
