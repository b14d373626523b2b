//! Viewer layouts (Rerun blueprints).
//!
//! Blueprints are built chunk by chunk here, because the SDK's builder supports neither cameras nor visible time
//! ranges, and uses random identifiers.
//!
//! From the outside in: a `BlueprintLayout` collects the messages of a window; its parts, of type `Child`, are containers and
//! views. A `Page` is a container of charts, one tab among others. A `Chart` is a view of curves. A `Plot` is the group
//! of fields of one topic that share the axis of a chart, as the table of channels names it.

pub(super) mod axis;
pub(super) mod builder;
pub(super) mod charts;
mod corner;
pub(super) mod pair;
pub(super) mod run;
pub(super) mod views;
