//! The layout for one run: the scene at the left with the events below, the main charts at the right.

use rerun::StoreId;
use rerun::blueprint::components::{ContainerKind, LinkAxis};
use rerun::blueprint::datatypes::TextLogColumnKind;
use rerun::components::Name;
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::builder::{Child, Layout, Messages, column, tabs};
use super::charts::{Chart, MORE, RATES, RISE, TABLE, TRAVEL};
use super::views::{Stage, bound, events, scene, speed, time_panel, time_series, titled, window};
use crate::rerun::entity::{self, ABOUT, EACH_EVENT};
use crate::rerun::identity::{Identity, Playback};
use crate::rerun::look::Look;
use crate::telemetry::fields::{EVENTS, POSE, Plot};
use crate::telemetry::proportions::Proportions;

/// The messages of the layout.
pub(crate) fn messages(identity: &Identity, playback: Playback) -> Messages {
    let mut layout = Layout::new(&identity.store());
    let left = left_side(&mut layout, identity);
    let right = right_side(&mut layout, identity);
    // Without a scene the left side has only text.
    let shares = if identity.has(POSE) {
        [42.0, 58.0]
    } else {
        [25.0, 75.0]
    };
    let panel = time_panel(playback, 1.0);
    window(layout, left, right, shares, identity.is_alone, &panel)
}

/// The messages that change the layout of a recording, to play the run from the start (`duration` in s).
pub(crate) fn messages_at_end(recording: &StoreId, duration: f64) -> Messages {
    let mut layout = Layout::changes(recording);
    let panel = time_panel(Playback::FromStart, speed(duration));
    layout.log("time_panel", &panel);
    layout.finish()
}

/// The scene, if there is one, and below it the events and the description.
fn left_side(layout: &mut Layout, identity: &Identity) -> Child {
    let about = layout.view("TextDocument", "About this run", ABOUT, &["$origin"]);
    let mut pages = vec![about];
    if identity.has(EVENTS) {
        for (name, entity) in [("Each event", EACH_EVENT), ("Events", entity::EVENTS)] {
            let contents = [Look::Alone.entity(entity)];
            let log = events(layout, name, &contents, &[TextLogColumnKind::Body]);
            pages.insert(0, log);
        }
    }
    let words = layout.contain(tabs(), &pages);
    if !identity.has(POSE) {
        return words;
    }
    let whole = ["$origin/**".to_owned()];
    // Next to the recordings panel the scene is narrower and must still show all arrow labels.
    let distance = if identity.is_alone { 1.0 } else { 1.2 };
    let stage = Stage {
        name: &identity.title,
        contents: &whole,
        runs: &[(Look::Alone, &identity.geometry)],
        geometry: &identity.geometry,
        distance,
    };
    let scene = scene(layout, &stage);
    layout.contain(column(&[76.0, 24.0]), &[scene, words])
}

/// Pages of charts. Those without data are left out.
fn right_side(layout: &mut Layout, identity: &Identity) -> Option<Child> {
    let is_tippe_top = Proportions::new(&identity.geometry.top).is_ball;
    let mut pages: Vec<(&str, &[Chart])> = vec![match (identity.geometry.is_free, is_tippe_top) {
        (false, _) => ("Rise", &RISE),
        (true, false) => ("How it travels", &TRAVEL),
        (true, true) => ("How it inverts", &TRAVEL),
    }];
    if identity.geometry.is_free {
        pages.extend([("On the table", &TABLE[..]), ("Rates", &RATES)]);
    }
    pages.push(("More", &MORE));
    let mut grids = Vec::new();
    for (name, charts) in pages {
        let is_there = |chart: &&Chart| chart.plots.iter().any(|plot| identity.has(plot.topic()));
        let mut views = Vec::new();
        for chart in charts.iter().filter(is_there) {
            let unit = chart.plots[0].unit();
            let contents: Vec<_> = chart.plots.iter().map(Plot::to_string).collect();
            let name = titled(chart.name, unit);
            let link = LinkAxis::Independent;
            let view = time_series(layout, &name, &contents, chart.legend, link);
            // A tippe top passes through upright, where its Euler rates are infinite: the largest magnitude outside the
            // peaks caused by this singularity.
            let spin = identity.geometry.spin;
            let greatest = match unit {
                "rad/s" if is_tippe_top => Some(2.0 * spin),
                "rad/s²" if is_tippe_top => Some(spin * spin),
                _ => None,
            };
            if let Some(greatest) = greatest {
                bound(layout, &view, [-greatest, greatest]);
            }
            views.push(view);
        }
        let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
            .with_grid_columns(2)
            .with_display_name(Name(name.into()));
        grids.extend(layout.contain_any(grid, &views));
    }
    layout.contain_any(tabs(), &grids)
}
