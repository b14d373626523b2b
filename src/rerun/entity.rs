//! Entity names shared by writing and layout code.
//!
//! Those without a leading slash are relative to the run: see [`Role::entity`](super::role::Role::entity).

/// The log of events with repetitions merged into one line.
pub(super) const EVENTS: &str = "events";
/// The log of all events except nutation extremes.
pub(super) const EACH_EVENT: &str = "events/each";

/// What a free peg does.
pub(super) const REGIME: &str = "/regime";

/// The description of a run.
pub(super) const ABOUT: &str = "about";
/// The arrows of the scene and their scales.
pub(super) const LEGEND: &str = "legend";
/// The result of a comparison, in words.
pub(super) const SUMMARY: &str = "/summary";

/// The report on the fit of a run.
pub(super) const FIT_REPORT: &str = "/fit/report";

/// The argument for the rise at the time cursor, and the arrow that only its view shows.
pub(super) const WHY: &str = "/why";
pub(super) const WHY_GHOST: &str = "/why/momentum_later";

/// The scene; in a comparison, the part shared by both runs.
pub(super) const STAGE: &str = "/scene";
/// The top with the measured angles.
pub(super) const MEASURED_TOP: &str = "/scene/measured";
/// The place on the table below a free peg.
pub(super) const FOCUS: &str = "scene/focus";
/// The picture of the horizontal part of the angular momentum from above.
pub(super) const HODOGRAPH: &str = "/hodograph";
/// The path of its tip.
pub(super) const HODOGRAPH_PATH: &str = "/hodograph/path";
/// The latest part of the path of the symmetry axis on a sphere around the peg, and the part before it.
pub(super) const TRAIL_ABOVE: [&str; 2] = ["scene/trail/above", "scene/trail/above/past"];
/// The projection of that path onto the table, below a fixed peg.
pub(super) const TRAIL_BELOW: &str = "scene/trail/below";
/// The path of the contact point of a free peg on the table: where it slides, where it rolls or sticks, and below the peg
/// where it flies.
pub(super) const CONTACT_PATHS: [&str; 3] = [
    "scene/contact_path/slides",
    "scene/contact_path/rolls",
    "scene/contact_path/flies",
];

/// The part of a path that a view shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Shown {
    /// All of it up to the time cursor.
    Past,
    /// Only the latest part, as many times as long as the path of the symmetry axis stays bright.
    Latest(f64),
}

/// The paths in the scene of a run. The path of the symmetry axis fades, because it would hide the top.
pub(super) fn paths(is_free: bool) -> Vec<(&'static str, Shown)> {
    let [latest, past] = TRAIL_ABOVE;
    let mut paths = vec![(latest, Shown::Latest(1.0)), (past, Shown::Latest(3.0))];
    if is_free {
        paths.extend(CONTACT_PATHS.map(|path| (path, Shown::Past)));
    } else {
        // Most of a rise, but of a long run not so much that it fills the table.
        paths.push((TRAIL_BELOW, Shown::Latest(6.0)));
    }
    paths
}
