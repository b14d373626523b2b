//! Entity names shared by writing and layout code.
//!
//! Those without a leading slash are relative to the run: see [`Look::entity`](super::look::Look::entity).

/// The log of events with repetitions merged into one line.
pub(super) const EVENTS: &str = "events";
/// The log of all events except nutation extremes.
pub(super) const EACH_EVENT: &str = "events/each";

/// The description of a run.
pub(super) const ABOUT: &str = "about";
/// The result of a comparison, in words.
pub(super) const SUMMARY: &str = "/summary";

/// The scene; in a comparison, the part shared by both runs.
pub(super) const STAGE: &str = "/scene";
/// Target of the camera in the scene.
pub(super) const CAMERA_TARGET: &str = "/scene/focus/camera_target";
/// The path of the symmetry axis on a sphere around the peg.
pub(super) const TRAIL_ABOVE: &str = "scene/trail/above";
/// The projection of that path onto the table, below a fixed peg.
pub(super) const TRAIL_BELOW: &str = "scene/trail/below";
/// The path of the contact point of a free peg on the table: where it slides, where it rolls or sticks, and below the peg
/// where it flies.
pub(super) const CONTACT_PATHS: [&str; 3] = [
    "scene/contact_path/slides",
    "scene/contact_path/rolls",
    "scene/contact_path/flies",
];

/// The paths in the scene of a run; a view shows the part before the time cursor.
pub(super) fn paths(is_free: bool) -> Vec<&'static str> {
    if is_free {
        [TRAIL_ABOVE].into_iter().chain(CONTACT_PATHS).collect()
    } else {
        vec![TRAIL_ABOVE, TRAIL_BELOW]
    }
}
