//! What the commands do with the Rerun viewer. Without the feature `rerun`, `without_rerun.rs` stands here.

pub(super) mod diff;
#[cfg(feature = "fit")]
pub(super) mod fit;
pub(super) mod run;
pub(super) mod view;
mod viewer;

pub(super) use view::{ViewArguments, ViewReport, view};
