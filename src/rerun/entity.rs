//! Names of entities that are written in one file and laid out in another.
//!
//! Those without a leading slash are relative to the run: see [`Look::entity`](super::look::Look::entity).

/// The log of events.
pub(super) const EVENTS: &str = "events";
/// The log of nutation extremes, which no layout shows.
pub(super) const NUTATION_EVENTS: &str = "events/nutation";

/// The description of a run.
pub(super) const ABOUT: &str = "about";
/// The result of a comparison, in words.
pub(super) const SUMMARY: &str = "/summary";

/// The scene; where two runs are compared, what they share of it.
pub(super) const STAGE: &str = "/scene";
/// The path of the symmetry axis on a sphere around the peg.
pub(super) const TRAIL_ABOVE: &str = "scene/trail/above";
/// The projection of that path onto the table.
pub(super) const TRAIL_BELOW: &str = "scene/trail/below";
