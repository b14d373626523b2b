//! Layouts: what a viewer shows when it opens a recording. Rerun calls them blueprints.
//!
//! A blueprint is a store of its own, whose chunks are built here one by one, because the SDK's builder has no
//! camera and no visible time ranges, and its identifiers are random.

mod builder;
pub(super) mod charts;
pub(super) mod pair;
pub(super) mod run;
pub(crate) mod views;
