//! The layout for two runs that are compared: both tops on one table, and for each quantity both
//! curves, their difference, and how the difference grows.

use rerun::blueprint::components::{Corner2D, LinkAxis};
use rerun::blueprint::datatypes::TextLogColumnKind;
use rerun::components::Name;
use rerun::external::re_log_types::LogMsg;

use super::builder::{Child, Layout, column, row, tabs};
use super::contrasts::{Contrast, FRICTION, MORE, MOTION, RATES, TABLE, TRAVEL};
use super::views::{Stage, events, panels, scene, time_series, titled};
use crate::rerun::entity::{self, ABOUT, CAMERA_TARGET, STAGE, SUMMARY};
use crate::rerun::error::RerunError;
use crate::rerun::identity::Geometry;
use crate::rerun::look::Look;
use crate::rerun::pair::PairIdentity;
use crate::telemetry::Topic;
use crate::telemetry::fields::{EVENTS, POSE, Plot};
use crate::telemetry::side::Side;

/// Distance of the camera from two tops, one of which travels, in usual distances.
const FAR: f64 = 1.2;

/// The messages of the layout.
pub(crate) fn messages(identity: &PairIdentity) -> Vec<Result<LogMsg, RerunError>> {
    let mut layout = Layout::new(&identity.recording_id);
    let left = left_side(&mut layout, identity);
    let right = right_side(&mut layout, identity);
    let root = match right {
        Some(right) => layout.contain(row(&[38.0, 62.0]), &[left, right]),
        None => left,
    };
    layout.fill(&root);
    panels(&mut layout, true, identity.playback);
    layout.finish()
}

/// The scene, if there is one, and below it the summary and the events.
fn left_side(layout: &mut Layout, identity: &PairIdentity) -> Child {
    let mut rows = Vec::new();
    let mut shares = Vec::new();
    if let Some(geometry) = identity.stage() {
        let name = format!(
            "A: {} (blue, solid) · B: {} (orange, translucent)",
            identity.name_of(Side::A),
            identity.name_of(Side::B),
        );
        let runs = looks(identity, POSE);
        let contents = runs.iter().map(|(look, _)| look.entity("scene/**"));
        let contents: Vec<_> = contents.chain([format!("{STAGE}/**")]).collect();
        let stage = Stage {
            name: &name,
            contents: &contents,
            runs: &runs,
            geometry: &geometry,
            distance: if geometry.is_free { FAR } else { 1.0 },
            followed: geometry.is_free.then(|| CAMERA_TARGET.to_owned()),
        };
        rows.push(scene(layout, &stage));
        shares.push(53.0);
    }
    rows.push(words(layout, identity));
    shares.push(25.0);
    let runs = looks(identity, EVENTS);
    if !runs.is_empty() {
        let contents: Vec<_> = runs
            .iter()
            .map(|(look, _)| look.entity(entity::EVENTS))
            .collect();
        let kinds = [TextLogColumnKind::LogLevel, TextLogColumnKind::Body];
        rows.push(events(layout, "Events", &contents, &kinds));
        shares.push(22.0);
    }
    layout.contain(column(&shares), &rows)
}

/// The looks and geometries of those runs that have a topic.
fn looks(identity: &PairIdentity, topic: Topic) -> Vec<(Look, &Geometry)> {
    let sides = [Side::A, Side::B].into_iter();
    let sides = sides.filter(|side| identity.run(*side).has(topic));
    let of = |side| (identity.look(side), &identity.run(side).geometry);
    sides.map(of).collect()
}

/// The summary, and the descriptions of the runs behind it.
fn words(layout: &mut Layout, identity: &PairIdentity) -> Child {
    let mut pages = vec![layout.view("TextDocument", "Summary", SUMMARY, &["$origin"])];
    for side in [Side::A, Side::B] {
        let about = identity.look(side).entity(ABOUT);
        pages.push(layout.view("TextDocument", identity.name_of(side), &about, &["$origin"]));
    }
    layout.contain(tabs(), &pages)
}

/// Pages of charts. Those without data are left out.
fn right_side(layout: &mut Layout, identity: &PairIdentity) -> Option<Child> {
    let is_free = identity.is_any_free();
    let motion: &[_] = if is_free { &TRAVEL } else { &MOTION };
    let mut motion = rows(layout, identity, motion);
    let mut friction = Vec::new();
    for contrast in &FRICTION {
        friction.extend(overlay(layout, identity, contrast));
    }
    motion.extend(layout.contain_any(row(&[]), &friction));
    let mut all = vec![("How they differ", motion)];
    if is_free {
        all.push(("On the table", rows(layout, identity, &TABLE)));
        all.push(("Rates", rows(layout, identity, &RATES)));
    }
    all.push(("More", rows(layout, identity, &MORE)));
    let mut pages = Vec::new();
    for (name, rows) in all {
        let page = column(&[]).with_display_name(Name(name.into()));
        pages.extend(layout.contain_any(page, &rows));
    }
    layout.contain_any(tabs(), &pages)
}

/// A row of charts per quantity: both curves, their difference, and the magnitude of that.
fn rows(layout: &mut Layout, identity: &PairIdentity, contrasts: &[Contrast]) -> Vec<Child> {
    let mut rows = Vec::new();
    for contrast in contrasts {
        let mut charts: Vec<_> = overlay(layout, identity, contrast).into_iter().collect();
        charts.extend(differences(layout, identity, contrast));
        rows.extend(layout.contain_any(row(&[]), &charts));
    }
    rows
}

/// The curves of both runs.
fn overlay(layout: &mut Layout, identity: &PairIdentity, contrast: &Contrast) -> Option<Child> {
    let mut contents = Vec::new();
    for side in [Side::A, Side::B] {
        let there = contrast.curves.iter();
        let there = there.filter(|plot| identity.run(side).has(plot.topic()));
        contents.extend(there.map(|plot| identity.look(side).entity(&plot.to_string())));
    }
    let name = titled(contrast.name, contrast.curves[0].unit());
    curves(layout, &name, &contents, contrast.legend)
}

/// The difference of the curves and its logarithm, if both runs have them.
fn differences(layout: &mut Layout, identity: &PairIdentity, contrast: &Contrast) -> Vec<Child> {
    let (name, unit) = (contrast.name, contrast.curves[0].unit());
    let there = |has: &dyn Fn(Plot) -> bool, look: Look| -> Vec<String> {
        let plots = contrast.differences.iter().filter(|plot| has(**plot));
        plots.map(|plot| look.entity(&plot.to_string())).collect()
    };
    let plain = there(&|plot| identity.has_difference_of(plot), Look::Difference);
    let magnitude = there(&|plot| identity.has_magnitude_of(plot), Look::Magnitude);
    let plain = curves(
        layout,
        &titled(&format!("{name}: B − A"), unit),
        &plain,
        None,
    );
    let magnitude = curves(layout, &format!("{name}: log₁₀ |B − A|"), &magnitude, None);
    plain.into_iter().chain(magnitude).collect()
}

/// A chart whose time axis moves with those of all others, if it has contents.
fn curves(
    layout: &mut Layout,
    name: &str,
    contents: &[String],
    legend: Option<Corner2D>,
) -> Option<Child> {
    if contents.is_empty() {
        return None;
    }
    let link = LinkAxis::LinkToGlobal;
    Some(time_series(layout, name, contents, legend, link))
}
