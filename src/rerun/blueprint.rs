//! The layout that a viewer opens with: the scene at the left, the plots that tell the story at
//! the right, what happened below.
//!
//! The chunks of the blueprint's store are written here one by one: the SDK's builder has no
//! camera, no axis ranges and no visible time ranges, and draws its identifiers by lot.

pub(super) mod pair;

use rerun::blueprint::components::{
    BackgroundKind, ContainerKind, Corner2D, PanelState, PlayState, TextLogColumn, TimelineColumn,
    VisibleTimeRange,
};
use rerun::blueprint::datatypes as blueprint_data;
use rerun::components::{Color, Name};
use rerun::datatypes::{self, TimeInt, TimeRange, TimeRangeBoundary};
use rerun::external::re_log_types::StoreKind;
use rerun::external::re_log_types::{BlueprintActivationCommand, LogMsg};
use rerun::external::re_sdk_types::blueprint::archetypes as parts;
use rerun::external::re_sdk_types::blueprint::components;
use rerun::{AsComponents, StoreId, TimePoint, Timeline};

use super::destination::{Ids, TIMELINE, opening, single_row};
use super::look::Look;
use super::scene::POSE;
use super::{APPLICATION, Identity, Playback, RerunError, shape};
use crate::telemetry::proportions::Proportions;

/// The scene, or the part of it that two runs share.
pub(super) const STAGE: &str = "/scene";
/// The axis' path on a sphere, and its projection onto the table.
pub(super) const TRAIL_ABOVE: &str = "scene/trail/above";
pub(super) const TRAIL_BELOW: &str = "scene/trail/below";
/// What the run is, in words.
pub(super) const ABOUT: &str = "about";
/// What happened in the run.
pub(super) const EVENTS: &str = "/events";

/// The nutation extremes among them, which the layout does not show.
pub(super) const NUTATION_EVENTS: &str = "/events/nutation";

/// How fast a viewer plays at first: a quarter of real time, for the spin is fast.
const SPEED: f64 = 0.25;

/// A plot: what stands above it, the entities in it, and where its legend is out of the way.
struct Plot {
    name: &'static str,
    contents: &'static [&'static str],
    legend: Corner2D,
}

const fn plot(name: &'static str, contents: &'static [&'static str], legend: Corner2D) -> Plot {
    Plot {
        name,
        contents,
        legend,
    }
}

/// How it rises.
const RISE: [Plot; 8] = [
    plot(
        "θ, inclination (rad)",
        &["/top/state/theta", "/top/nutation/theta_mean"],
        Corner2D::RightTop,
    ),
    plot(
        "dθ/dt (rad/s)",
        &["/top/state/theta_dot", "/top/nutation/theta_dot_mean"],
        Corner2D::LeftTop,
    ),
    plot(
        "dφ/dt and the slow root of regular precession (rad/s)",
        &[
            "/top/state/phi_dot",
            "/top/nutation/phi_dot_mean",
            "/top/precession/slow_root",
        ],
        Corner2D::LeftTop,
    ),
    plot(
        "dψ/dt, spin (rad/s)",
        &["/top/state/psi_dot", "/top/nutation/psi_dot_mean"],
        Corner2D::RightTop,
    ),
    plot(
        "Friction torque, node frame (N m)",
        &["/top/torque/friction_node"],
        Corner2D::LeftBottom,
    ),
    plot(
        "d²θ/dt² term by term (rad/s²)",
        &["/top/acceleration/theta_ddot", "/top/state/theta_ddot"],
        Corner2D::RightTop,
    ),
    plot(
        "Slip velocity at the contact, world axes (m/s)",
        &["/top/contact/slip_speed", "/top/contact/slip_world"],
        Corner2D::RightBottom,
    ),
    plot(
        "Total and kinetic energy (J)",
        &["/top/energy/mechanical"],
        Corner2D::LeftBottom,
    ),
];

/// What else there is to see.
const MORE: [Plot; 8] = [
    plot(
        "d²φ/dt² term by term (rad/s²)",
        &["/top/acceleration/phi_ddot", "/top/state/phi_ddot"],
        Corner2D::LeftTop,
    ),
    plot(
        "d²ψ/dt² term by term (rad/s²)",
        &["/top/acceleration/psi_ddot", "/top/state/psi_ddot"],
        Corner2D::LeftTop,
    ),
    plot(
        "dφ/dt − slow root (rad/s)",
        &["/top/precession/excess"],
        Corner2D::LeftTop,
    ),
    plot(
        "Nutation period (s)",
        &["/top/nutation/period"],
        Corner2D::LeftTop,
    ),
    plot(
        "Gravity torque, node frame (N m)",
        &["/top/torque/gravity_node"],
        Corner2D::RightTop,
    ),
    plot(
        "Angular momentum, vertical and axial (kg m²/s)",
        &["/top/momentum/components"],
        Corner2D::RightTop,
    ),
    plot(
        "Work of friction (J)",
        &["/top/energy/friction_work"],
        Corner2D::RightTop,
    ),
    plot(
        "Power of friction (W)",
        &["/top/energy/friction_power"],
        Corner2D::RightBottom,
    ),
];

/// All messages of the blueprint, the last of which activates it.
pub(super) fn messages(
    identity: &Identity,
    proportions: &Proportions,
) -> Result<Vec<LogMsg>, RerunError> {
    let mut layout = Layout::new(&identity.recording_id);
    let left = left_side(&mut layout, identity, proportions)?;
    let right = right_side(&mut layout, identity)?;
    // Without a scene there are only words at the left.
    let shares = match identity.has_topic(POSE) {
        true => [42.0, 58.0],
        false => [25.0, 75.0],
    };
    let root = match right {
        Some(right) => layout.container(ContainerKind::Horizontal, &[left, right], &shares)?,
        None => left,
    };
    layout.fill(&root)?;
    panels(&mut layout, identity.is_alone, identity.playback)?;
    Ok(layout.finish())
}

/// The scene if there is one, and below it what happened, in words.
fn left_side(
    layout: &mut Layout,
    identity: &Identity,
    proportions: &Proportions,
) -> Result<Child, RerunError> {
    let about = layout.view("TextDocument", "About this run", ABOUT, &["$origin"])?;
    let mut tabs = vec![about];
    if identity.has_topic(EVENTS) {
        let kinds = [blueprint_data::TextLogColumnKind::Body];
        tabs.insert(0, events(layout, &["$origin".to_owned()], &kinds)?);
    }
    let words = layout.container(ContainerKind::Tabs, &tabs, &[])?;
    if !identity.has_topic(POSE) {
        return Ok(words);
    }
    let whole = ["$origin/**".to_owned()];
    let scene = scene(layout, "The top", &whole, &[Look::Alone], proportions)?;
    layout.container(ContainerKind::Vertical, &[scene, words], &[76.0, 24.0])
}

/// The scene of these entities, with the trails of the runs that look so.
fn scene(
    layout: &mut Layout,
    name: &str,
    contents: &[String],
    runs: &[Look],
    proportions: &Proportions,
) -> Result<Child, RerunError> {
    let view = layout.view("3D", name, STAGE, contents)?;
    let camera = parts::EyeControls3D::new()
        .with_position(shape::camera(proportions))
        .with_look_target(shape::focus(proportions))
        .with_eye_up([0.0, 0.0, 1.0]);
    let background =
        parts::Background::new(BackgroundKind::SolidColor).with_color(Color::from_u32(0x1215_1BFF));
    let grid = parts::LineGrid3D::new().with_visible(false);
    layout.property(&view, "EyeControls3D", &camera)?;
    layout.property(&view, "Background", &background)?;
    layout.property(&view, "LineGrid3D", &grid)?;
    for run in runs {
        for trail in [TRAIL_ABOVE, TRAIL_BELOW] {
            let path = format!("ViewContents/overrides{}/visualizers", run.entity(trail));
            layout.property(&view, &path, &parts::VisibleTimeRanges::new([past()]))?;
        }
    }
    Ok(view)
}

/// From the beginning to the time cursor.
fn past() -> VisibleTimeRange {
    VisibleTimeRange(datatypes::VisibleTimeRange {
        timeline: TIMELINE.into(),
        range: TimeRange {
            start: TimeRangeBoundary::Infinite,
            end: TimeRangeBoundary::CursorRelative(TimeInt(0)),
        },
    })
}

/// The events of these entities, with these columns beside the time.
fn events(
    layout: &mut Layout,
    contents: &[String],
    kinds: &[blueprint_data::TextLogColumnKind],
) -> Result<Child, RerunError> {
    let view = layout.view("TextLog", "Events", EVENTS, contents)?;
    let column = |kind: &blueprint_data::TextLogColumnKind| {
        TextLogColumn(blueprint_data::TextLogColumn {
            visible: true.into(),
            kind: *kind,
        })
    };
    let columns = parts::TextLogColumns::new()
        .with_timeline_columns([TimelineColumn(blueprint_data::TimelineColumn {
            visible: true.into(),
            timeline: TIMELINE.into(),
        })])
        .with_text_log_columns(kinds.iter().map(column));
    layout.property(&view, "TextLogColumns", &columns)?;
    Ok(view)
}

/// Two pages of plots; plots and pages without data are left out.
fn right_side(layout: &mut Layout, identity: &Identity) -> Result<Option<Child>, RerunError> {
    let mut pages = Vec::new();
    for (name, plots) in [("How it rises", &RISE), ("More", &MORE)] {
        let mut views = Vec::new();
        for plot in plots.iter().filter(|plot| identity.has_some(plot.contents)) {
            let legend = parts::PlotLegend::new().with_corner(plot.legend);
            views.push(time_series(layout, plot.name, plot.contents, &legend)?);
        }
        if !views.is_empty() {
            let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
                .with_display_name(Name(name.into()))
                .with_grid_columns(2);
            pages.push(layout.contain(grid, &views)?);
        }
    }
    if pages.is_empty() {
        return Ok(None);
    }
    layout.container(ContainerKind::Tabs, &pages, &[]).map(Some)
}

fn time_series(
    layout: &mut Layout,
    name: &str,
    contents: &[impl AsRef<str>],
    legend: &parts::PlotLegend,
) -> Result<Child, RerunError> {
    let view = layout.view("TimeSeries", name, "/", contents)?;
    layout.property(&view, "PlotLegend", legend)?;
    Ok(view)
}

fn panels(layout: &mut Layout, is_alone: bool, playback: Playback) -> Result<(), RerunError> {
    let hidden = parts::PanelBlueprint::new().with_state(PanelState::Hidden);
    // Between several recordings one chooses in this panel.
    let recordings = if is_alone {
        hidden.clone()
    } else {
        parts::PanelBlueprint::new().with_state(PanelState::Expanded)
    };
    layout.log("blueprint_panel", &recordings)?;
    layout.log("selection_panel", &hidden)?;
    let time = parts::TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(TIMELINE)
        .with_playback_speed(SPEED)
        .with_play_state(match playback {
            Playback::PausedAtStart => PlayState::Paused,
            Playback::Following => PlayState::Following,
        });
    layout.log("time_panel", &time)
}

/// A view or a container, to be put into a container.
struct Child {
    id: datatypes::Uuid,
    path: String,
}

/// A blueprint under construction.
struct Layout {
    store: StoreId,
    ids: Ids,
    children: u64,
    messages: Vec<LogMsg>,
}

impl Layout {
    fn new(recording_id: &str) -> Self {
        let store = StoreId::new(StoreKind::Blueprint, APPLICATION, recording_id);
        let mut ids = Ids::BLUEPRINT;
        let messages = vec![opening(&store, &mut ids)];
        Self {
            store,
            ids,
            children: 0,
            messages,
        }
    }

    fn log(&mut self, path: &str, components: &dyn AsComponents) -> Result<(), RerunError> {
        let time = TimePoint::default().with(Timeline::new_sequence("blueprint"), 0);
        let row = single_row(&self.store, &mut self.ids, path, time, components)?;
        self.messages.push(row);
        Ok(())
    }

    /// Numbers the parts of the layout; the viewer asks only that they differ.
    fn child(&mut self, prefix: &str) -> Child {
        self.children += 1;
        let number = self.children;
        let mut bytes = [0; 16];
        bytes[8..].copy_from_slice(&number.to_be_bytes());
        let (high, low) = (number >> 48, number & 0xFFFF_FFFF_FFFF);
        Child {
            id: datatypes::Uuid { bytes },
            path: format!("{prefix}/00000000-0000-0000-{high:04x}-{low:012x}"),
        }
    }

    fn view(
        &mut self,
        class: &str,
        name: &str,
        origin: &str,
        contents: &[impl AsRef<str>],
    ) -> Result<Child, RerunError> {
        let view = self.child("view");
        let blueprint = parts::ViewBlueprint::new(class)
            .with_display_name(Name(name.into()))
            .with_space_origin(origin);
        let query = contents
            .iter()
            .map(|entity| components::QueryExpression(format!("+ {}", entity.as_ref()).into()));
        self.log(&view.path, &blueprint)?;
        self.property(&view, "ViewContents", &parts::ViewContents::new(query))?;
        Ok(view)
    }

    fn property(
        &mut self,
        view: &Child,
        name: &str,
        components: &dyn AsComponents,
    ) -> Result<(), RerunError> {
        self.log(&format!("{}/{name}", view.path), components)
    }

    fn container(
        &mut self,
        kind: ContainerKind,
        children: &[Child],
        shares: &[f32],
    ) -> Result<Child, RerunError> {
        let container = parts::ContainerBlueprint::new(kind);
        let container = match kind {
            ContainerKind::Horizontal => container.with_col_shares(shares.iter().copied()),
            ContainerKind::Vertical => container.with_row_shares(shares.iter().copied()),
            ContainerKind::Tabs | ContainerKind::Grid => container,
        };
        self.contain(container, children)
    }

    fn contain(
        &mut self,
        container: parts::ContainerBlueprint,
        children: &[Child],
    ) -> Result<Child, RerunError> {
        let child = self.child("container");
        let contents = children
            .iter()
            .map(|child| components::IncludedContent(child.path.as_str().into()));
        let active = children
            .first()
            .map(|first| components::ActiveTab(first.path.as_str().into()));
        let container = container.with_contents(contents);
        let container = match active {
            Some(tab) => container.with_active_tab(tab),
            None => container,
        };
        self.log(&child.path, &container)?;
        Ok(child)
    }

    /// Fills the window.
    fn fill(&mut self, root: &Child) -> Result<(), RerunError> {
        let viewport = parts::ViewportBlueprint::new()
            .with_root_container(components::RootContainer(root.id))
            .with_auto_layout(false)
            .with_auto_views(false);
        self.log("viewport", &viewport)
    }

    fn finish(mut self) -> Vec<LogMsg> {
        self.messages.push(LogMsg::BlueprintActivationCommand(
            BlueprintActivationCommand {
                blueprint_id: self.store,
                make_active: true,
                make_default: true,
            },
        ));
        self.messages
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::channels;

    #[test]
    fn every_plot_shows_entities_that_the_table_has() {
        let entities: Vec<String> = channels()
            .iter()
            .flat_map(|channel| {
                let leaves = channel.numbers.iter();
                leaves.map(|leaf| format!("{}/{}", channel.topic, leaf.plot))
            })
            .collect();
        for plot in RISE.iter().chain(&MORE) {
            for content in plot.contents {
                assert!(
                    entities.iter().any(|entity| entity == content),
                    "{:?} shows {content}, which no leaf of the table belongs to",
                    plot.name
                );
            }
        }
    }
}
