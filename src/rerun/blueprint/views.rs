//! Views and panels used by both layouts.

use nalgebra::Vector3;
use rerun::blueprint::components::{
    BackgroundKind, Corner2D, Eye3DKind, LinkAxis, LoopMode, PanelState, PlayState, TextLogColumn,
    TimelineColumn, VisibleTimeRange, VisualBounds2D,
};
use rerun::blueprint::datatypes as blueprint_data;
use rerun::components::{Color, Name};
use rerun::datatypes::{self, TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::builder::{BlueprintLayout, Child, column, row};
use crate::rerun::entity::{
    EVENTS, HODOGRAPH, HODOGRAPH_PATH, REGIME, STAGE, Shown, WHY, WHY_GHOST, paths,
};
use crate::rerun::identity::{Geometry, Playback};
use crate::rerun::output::message::TIMELINE;
use crate::rerun::role::Role;
use crate::rerun::scene::RADIUS;
use crate::telemetry::arrows::scale::round;
use crate::telemetry::proportions::Proportions;

/// Approximate time in which a viewer plays a complete run, s.
const PLAYING_TIME: f64 = 25.0;

const BACKGROUND: u32 = 0x1215_1BFF;

/// Content of a view of the scene.
pub(in crate::rerun) struct SceneView<'a> {
    /// The title.
    pub(in crate::rerun) name: &'a str,
    /// Entities.
    pub(in crate::rerun) contents: &'a [String],
    /// Runs whose paths are shown up to the time cursor.
    pub(in crate::rerun) runs: &'a [(Role, &'a Geometry)],
    /// The top whose height is the unit of the camera position.
    pub(in crate::rerun) geometry: &'a Geometry,
    /// The entity that the camera is at rest with.
    pub(in crate::rerun) origin: String,
    /// Distance of the camera, relative to the usual distance.
    pub(in crate::rerun) distance: f64,
}

/// A view of the scene.
pub(in crate::rerun) fn scene(layout: &mut BlueprintLayout, stage: &SceneView<'_>) -> Child {
    let view = layout.view("3D", stage.name, &stage.origin, stage.contents);
    let proportions = Proportions::new(&stage.geometry.top);
    // In heights of the top: the middle of the scene, and the place of the camera as seen from there.
    let middle = Vector3::new(0.0, 0.0, 0.5);
    let place = middle + stage.distance * Vector3::new(1.35, 1.7, 0.8);
    let [target, position]: [[f32; 3]; 2] =
        [middle, place].map(|point| (proportions.size() * point).cast().into());
    let camera = parts::EyeControls3D::new()
        .with_kind(Eye3DKind::Orbital)
        .with_position(position)
        .with_look_target(target)
        .with_spin_speed(0.0)
        .with_eye_up([0.0, 0.0, 1.0]);
    let background =
        parts::Background::new(BackgroundKind::SolidColor).with_color(Color::from_u32(BACKGROUND));
    let grid = parts::LineGrid3D::new().with_visible(false);
    let surroundings = parts::SpatialInformation::update_fields()
        .with_show_axes(false)
        .with_show_bounding_box(false);
    layout.property(&view, "EyeControls3D", &camera);
    layout.property(&view, "Background", &background);
    layout.property(&view, "LineGrid3D", &grid);
    layout.property(&view, "SpatialInformation", &surroundings);
    for (role, geometry) in stage.runs {
        for (path, shown) in paths(geometry.is_free) {
            show_past(layout, &view, &role.entity(path), shown, geometry);
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

/// A list of the events of these entities: time, a click on which moves the time cursor, level and text.
pub(in crate::rerun) fn events(
    layout: &mut BlueprintLayout,
    name: &str,
    contents: &[String],
) -> Child {
    let view = layout.view("TextLog", name, EVENTS, contents);
    let times = TimelineColumn(blueprint_data::TimelineColumn {
        visible: true.into(),
        timeline: TIMELINE.into(),
    });
    let kinds = [
        blueprint_data::TextLogColumnKind::LogLevel,
        blueprint_data::TextLogColumnKind::Body,
    ];
    let columns = parts::TextLogColumns::new()
        .with_timeline_columns([times])
        .with_text_log_columns(kinds.map(|kind| {
            TextLogColumn(blueprint_data::TextLogColumn {
                visible: true.into(),
                kind,
            })
        }));
    layout.property(&view, "TextLogColumns", &columns);
    view
}

/// What a free peg does, as states over time.
pub(in crate::rerun) fn regimes(layout: &mut BlueprintLayout) -> Child {
    let view = layout.view("StateTimeline", "The peg", REGIME, &["$origin"]);
    let axis = parts::TimeAxis::new().with_link(LinkAxis::LinkToGlobal);
    layout.property(&view, "TimeAxis", &axis);
    view
}

/// The title of a chart: its quantity, with the unit if there is one.
pub(in crate::rerun) fn titled(name: &str, unit: &str) -> String {
    match unit {
        "" => name.to_owned(),
        unit => format!("{name} ({unit})"),
    }
}

/// A chart of these entities over the whole time, with a legend in a corner or without one. Its value axis has this range at
/// first, or that of the values. The time axes of all charts move together.
pub(in crate::rerun) fn time_series(
    layout: &mut BlueprintLayout,
    name: &str,
    contents: &[impl AsRef<str>],
    legend: Option<Corner2D>,
    range: Option<[f64; 2]>,
) -> Child {
    let view = layout.view("TimeSeries", name, "/", contents);
    let mut shown = parts::PlotLegend::new().with_visible(legend.is_some());
    if let Some(corner) = legend {
        shown = shown.with_corner(corner);
    }
    layout.property(&view, "PlotLegend", &shown);
    layout.property(
        &view,
        "TimeAxis",
        &parts::TimeAxis::new().with_link(LinkAxis::LinkToGlobal),
    );
    layout.property(
        &view,
        "VisibleTimeRanges",
        &time_range(TimeRangeBoundary::Infinite, TimeRangeBoundary::Infinite),
    );
    if let Some(range) = range {
        let axis = parts::ScalarAxis::new().with_range(range);
        layout.property(&view, "ScalarAxis", &axis);
    }
    view
}

/// The part of a layout in which viewers keep the time range of linked charts: its identifier is a constant of Rerun.
const LINKED_TIME_AXIS: &str = "view/5c0dca6a-e63f-9cf7-f657-2602590474cc/TimeAxis";

/// Shows the whole of a run of this duration, in s, in all charts. Otherwise viewers show about a minute.
pub(in crate::rerun) fn set_time_range(layout: &mut BlueprintLayout, duration: f64) {
    let absolute = |seconds: f64| TimeRangeBoundary::Absolute(TimeInt((1e9 * seconds) as i64));
    let range = TimeRange {
        start: absolute(0.0),
        end: absolute(duration),
    };
    let axis = parts::TimeAxis::new().with_view_range(range);
    layout.log(LINKED_TIME_AXIS, &axis);
}

/// A view from above of the horizontal part of the angular momentum.
pub(in crate::rerun) fn hodograph(layout: &mut BlueprintLayout, geometry: &Geometry) -> Child {
    let contents = ["$origin/**"];
    let view = layout.view("2D", "L from above", HODOGRAPH, &contents);
    let size = 1.15 * RADIUS;
    let bounds = parts::VisualBounds2D::new(VisualBounds2D(datatypes::Range2D {
        x_range: datatypes::Range1D([-size, size]),
        y_range: datatypes::Range1D([-size, size]),
    }));
    layout.property(&view, "VisualBounds2D", &bounds);
    let background =
        parts::Background::new(BackgroundKind::SolidColor).with_color(Color::from_u32(BACKGROUND));
    layout.property(&view, "Background", &background);
    let shown = if Proportions::new(&geometry.top).is_ball {
        // The axis of a tippe top goes around so often that its whole path would fill the picture.
        Shown::Latest(4.0)
    } else {
        Shown::Past
    };
    show_past(layout, &view, HODOGRAPH_PATH, shown, geometry);
    view
}

/// The argument: its text, and a scene with just the arrows that it names.
pub(in crate::rerun) fn why(layout: &mut BlueprintLayout, geometry: &Geometry) -> Child {
    let mut contents = vec![WHY_GHOST.to_owned()];
    for name in [
        "table/**",
        "top/**",
        "focus/vertical",
        "slip_velocity",
        "friction_force",
        "lever",
        "friction_torque",
        "angular_momentum",
    ] {
        contents.push(format!("{STAGE}/{name}"));
    }
    let stage = SceneView {
        name: "From the slip to the axis",
        contents: &contents,
        runs: &[],
        geometry,
        origin: Role::Alone.scene_origin(geometry.is_free),
        distance: 1.0,
    };
    let picture = scene(layout, &stage);
    let text = layout.view("TextDocument", "Step by step", WHY, &["$origin"]);
    let page = column(&[62.0, 38.0]).with_display_name(Name("Why".into()));
    layout.contain(page, &[picture, text])
}

/// Shows the pieces of a path up to the time cursor: they are at their times.
fn show_past(
    layout: &mut BlueprintLayout,
    view: &Child,
    path: &str,
    shown: Shown,
    geometry: &Geometry,
) {
    let start = match shown {
        Shown::Past => TimeRangeBoundary::Infinite,
        Shown::Latest(times) => {
            let span = (times * geometry.trail_time * 1e9) as i64;
            TimeRangeBoundary::CursorRelative(TimeInt(-span))
        }
    };
    let property = format!("ViewContents/overrides{path}/visualizers");
    let now = TimeRangeBoundary::CursorRelative(TimeInt(0));
    layout.property(view, &property, &time_range(start, now));
}

/// Fills the window with two sides, which have these shares of its width, and sets the panels around them.
pub(in crate::rerun) fn window(
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
    // The list of recordings would come with the tree of the layout, and take a sixth of a small window.
    for panel in ["blueprint_panel", "selection_panel"] {
        let hidden = parts::PanelBlueprint::new().with_state(PanelState::Hidden);
        layout.log(panel, &hidden);
    }
    layout.log("time_panel", time_panel);
}

/// The time panel, with the playback speed.
pub(in crate::rerun) fn time_panel(playback: Playback, speed: f64) -> parts::TimePanelBlueprint {
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
pub(in crate::rerun) fn playback_speed(duration: f64) -> f64 {
    let speed = round(duration / PLAYING_TIME);
    if speed > 0.0 { speed } else { 1.0 }
}
