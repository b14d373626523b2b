//! Viewer layouts (Rerun blueprints).
//!
//! Blueprints are built chunk by chunk here, because the SDK's builder supports neither cameras nor visible time
//! ranges, and uses random identifiers.
//!
//! The notions, from the outside in: a [`Layout`](builder::Layout) collects the messages of a whole window and its
//! [`Child`](builder::Child)ren, which are containers and views. A page is a container with charts, one tab among
//! others. A [`Chart`](charts::Chart) is a view of curves. A [`Plot`](crate::telemetry::Plot) is the group of fields of
//! one topic that share a chart's axis, as the table of channels names it.

mod axis;
mod builder;
pub(super) mod charts;
pub(super) mod pair;
pub(super) mod run;
pub(crate) mod views;
