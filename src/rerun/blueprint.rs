//! Viewer layouts (Rerun blueprints).
//!
//! Blueprints are built chunk by chunk here, because the SDK's builder supports neither cameras nor visible time
//! ranges, and uses random identifiers.

mod axis;
mod builder;
pub(super) mod charts;
pub(super) mod pair;
pub(super) mod run;
pub(crate) mod views;
