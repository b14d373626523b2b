//! Names of entities that several files know.

/// What happened in a run.
pub(super) const EVENTS: &str = "events";
/// The nutation extremes among the events, which the layout does not show.
pub(super) const NUTATION_EVENTS: &str = "events/nutation";

/// What a run is, in words.
pub(super) const ABOUT: &str = "about";
/// How a comparison ended, in words.
pub(super) const SUMMARY: &str = "/summary";

/// The scene, or the part of it that two runs share.
pub(super) const STAGE: &str = "/scene";
/// The path of the symmetry axis on a sphere around the peg.
pub(super) const TRAIL_ABOVE: &str = "scene/trail/above";
/// Its projection onto the table.
pub(super) const TRAIL_BELOW: &str = "scene/trail/below";
