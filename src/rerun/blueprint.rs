//! The layouts that a viewer opens with.
//!
//! The chunks of the blueprint's store are written here one by one: the SDK's builder has no
//! camera, no axis ranges and no visible time ranges, and draws its identifiers by lot.

mod builder;
pub(super) mod pair;
pub(super) mod quantities;
pub(super) mod run;
mod views;
