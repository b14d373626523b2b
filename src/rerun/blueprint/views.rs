//! Views and panels used by both layouts.

use nalgebra::Vector3;
use rerun::blueprint::components::{
    BackgroundKind, Corner2D, Eye3DKind, LinkAxis, LoopMode, PanelState, PlayState, TextLogColumn,
    TimelineColumn, VisibleTimeRange,
};
use rerun::blueprint::datatypes as blueprint_data;
use rerun::components::Color;
use rerun::datatypes::{self, TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::builder::{BlueprintLayout, Child, row};
use crate::rerun::entity::{CAMERA_TARGET, EVENTS, STAGE, Shown, paths};
use crate::rerun::identity::scale::round;
use crate::rerun::identity::{Geometry, Playback};
use crate::rerun::output::message::TIMELINE;
use crate::rerun::role::Role;
use crate::telemetry::proportions::Proportions;

/// Approximate time in which a viewer plays a complete run, s.
const PLAYING_TIME: f64 = 25.0;

/// Content of a view of the scene.
pub(super) struct SceneView<'a> {
    /// The title.
    pub(super) name: &'a str,
    /// Entities.
    pub(super) contents: &'a [String],
    /// Runs whose paths are shown up to the time cursor.
    pub(super) runs: &'a [(Role, &'a Geometry)],
    /// The top whose height is the unit of the camera position.
    pub(super) geometry: &'a Geometry,
    /// The entity that the camera follows.
    pub(super) target: Option<String>,
    /// Distance of the camera, relative to the usual distance.
    pub(super) distance: f64,
}

/// The entity that the camera follows: the place below a free peg.
pub(super) fn target(role: &Role, geometry: &Geometry) -> Option<String> {
    geometry.is_free.then(|| role.entity(CAMERA_TARGET))
}

/// A view of the scene.
pub(super) fn scene(layout: &mut BlueprintLayout, stage: &SceneView<'_>) -> Child {
    let view = layout.view("3D", stage.name, STAGE, stage.contents);
    let proportions = Proportions::new(&stage.geometry.top);
    // In heights of the top: the middle of the scene, and the place of the camera as seen from there.
    let middle = Vector3::new(0.0, 0.0, 0.55);
    let place = middle + stage.distance * Vector3::new(2.4, 3.05, 0.85);
    let [target, position]: [[f32; 3]; 2] =
        [middle, place].map(|point| (proportions.size() * point).cast().into());
    let camera = parts::EyeControls3D::new()
        .with_kind(Eye3DKind::Orbital)
        .with_position(position)
        .with_look_target(target)
        .with_spin_speed(0.0)
        .with_eye_up([0.0, 0.0, 1.0]);
    let camera = match &stage.target {
        Some(target) => camera.with_tracking_entity(target.as_str()),
        None => camera,
    };
    let background =
        parts::Background::new(BackgroundKind::SolidColor).with_color(Color::from_u32(0x1215_1BFF));
    let grid = parts::LineGrid3D::new().with_visible(false);
    let surroundings = parts::SpatialInformation::update_fields()
        .with_show_axes(false)
        .with_show_bounding_box(false);
    layout.property(&view, "EyeControls3D", &camera);
    layout.property(&view, "Background", &background);
    layout.property(&view, "LineGrid3D", &grid);
    layout.property(&view, "SpatialInformation", &surroundings);
    for (role, geometry) in stage.runs {
        // A path is made of short pieces at their times. A view shows only the piece at the cursor unless it is told to
        // go back.
        for (path, shown) in paths(geometry.is_free) {
            let property = format!("ViewContents/overrides{}/visualizers", role.entity(path));
            let start = match shown {
                Shown::Past => TimeRangeBoundary::Infinite,
                Shown::Latest(times) => {
                    let span = (times * geometry.trail_time * 1e9) as i64;
                    TimeRangeBoundary::CursorRelative(TimeInt(-span))
                }
            };
            let now = TimeRangeBoundary::CursorRelative(TimeInt(0));
            layout.property(&view, &property, &time_range(start, now));
        }
    }
    view
}

/// The time range between these times.
fn time_range(start: TimeRangeBoundary, end: TimeRangeBoundary) -> parts::VisibleTimeRanges {
    parts::VisibleTimeRanges::new([VisibleTimeRange(datatypes::VisibleTimeRange {
        timeline: TIMELINE.into(),
        range: TimeRange { start, end },
    })])
}

/// A list of the events of these entities. Each text begins with its run, if there are two, and with the time of its event,
/// more precisely than the viewer's column of times. All other columns are left out: narrow views cut long texts.
pub(super) fn events(layout: &mut BlueprintLayout, name: &str, contents: &[String]) -> Child {
    let view = layout.view("TextLog", name, EVENTS, contents);
    let times = TimelineColumn(blueprint_data::TimelineColumn {
        visible: false.into(),
        timeline: TIMELINE.into(),
    });
    let body = TextLogColumn(blueprint_data::TextLogColumn {
        visible: true.into(),
        kind: blueprint_data::TextLogColumnKind::Body,
    });
    let columns = parts::TextLogColumns::new()
        .with_timeline_columns([times])
        .with_text_log_columns([body]);
    layout.property(&view, "TextLogColumns", &columns);
    view
}

/// The title of a chart: its quantity, with the unit if there is one.
pub(super) fn titled(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    }
}

/// A chart of these entities over the whole time, with a legend in a corner or without one. Linked charts move their time
/// axes together.
pub(super) fn time_series(
    layout: &mut BlueprintLayout,
    name: &str,
    contents: &[impl AsRef<str>],
    legend: Option<Corner2D>,
    link: LinkAxis,
) -> Child {
    let view = layout.view("TimeSeries", name, "/", contents);
    let mut shown = parts::PlotLegend::new().with_visible(legend.is_some());
    if let Some(corner) = legend {
        shown = shown.with_corner(corner);
    }
    layout.property(&view, "PlotLegend", &shown);
    layout.property(&view, "TimeAxis", &parts::TimeAxis::new().with_link(link));
    layout.property(
        &view,
        "VisibleTimeRanges",
        &time_range(TimeRangeBoundary::Infinite, TimeRangeBoundary::Infinite),
    );
    view
}

/// Sets the initial value range of a chart.
pub(super) fn set_value_range(layout: &mut BlueprintLayout, view: &Child, range: [f64; 2]) {
    let axis = parts::ScalarAxis::new().with_range(range);
    layout.property(view, "ScalarAxis", &axis);
}

/// Fills the window with two sides, which have these shares of its width, and sets the panels around them.
pub(super) fn window(
    layout: &mut BlueprintLayout,
    left: Child,
    right: Option<Child>,
    shares: [f32; 2],
    time_panel: &parts::TimePanelBlueprint,
) {
    let root = match right {
        Some(right) => layout.contain(row(&shares), &[left, right]),
        None => left,
    };
    layout.fill(&root);
    // The list of recordings is open: the layout can't depend on whether another recording is open too.
    layout.log(
        "blueprint_panel",
        &parts::PanelBlueprint::new().with_state(PanelState::Expanded),
    );
    layout.log(
        "selection_panel",
        &parts::PanelBlueprint::new().with_state(PanelState::Hidden),
    );
    layout.log("time_panel", time_panel);
}

/// The time panel, with the playback speed.
pub(super) fn time_panel(playback: Playback, speed: f64) -> parts::TimePanelBlueprint {
    parts::TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(TIMELINE)
        .with_playback_speed(speed)
        .with_loop_mode(LoopMode::Off)
        .with_play_state(match playback {
            Playback::FromStart => PlayState::Playing,
            Playback::Following => PlayState::Following,
        })
}

/// The speed at which a run of this duration, in s, plays in about [`PLAYING_TIME`]; 1 if it has none.
pub(super) fn playback_speed(duration: f64) -> f64 {
    let speed = round(duration / PLAYING_TIME);
    if speed > 0.0 { speed } else { 1.0 }
}
