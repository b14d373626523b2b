//! The layout for one run: the scene at the left with the events below, the charts that tell the story at the right.

use rerun::blueprint::components::{ContainerKind, Corner2D, LinkAxis};
use rerun::blueprint::datatypes::TextLogColumnKind;
use rerun::components::Name;
use rerun::external::re_log_types::LogMsg;
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::builder::{Child, Layout, column, row, tabs};
use super::views::{Stage, events, panels, scene, time_series, titled};
use crate::rerun::entity::{ABOUT, CAMERA_TARGET};
use crate::rerun::error::RerunError;
use crate::rerun::identity::Identity;
use crate::rerun::look::Look;
use crate::telemetry::fields::{
    EVENTS, FREE_PEG, POSE, Plot, acceleration, center_of_mass, contact, energy, free_peg,
    momentum, nutation, precession, state, torque,
};

/// A view of some plots, with its title and the corner where the legend is out of the curves' way.
struct Chart {
    name: &'static str,
    contents: &'static [Plot],
    legend: Corner2D,
}

const fn chart(name: &'static str, contents: &'static [Plot], legend: Corner2D) -> Chart {
    Chart {
        name,
        contents,
        legend,
    }
}

/// Charts of the first page: how the top rises.
#[rustfmt::skip]
const RISE: [Chart; 8] = [
    chart("θ, inclination", &[state::THETA.plot(), nutation::THETA_MEAN.plot()], Corner2D::RightTop),
    chart("dθ/dt", &[state::THETA_DOT.plot(), nutation::THETA_DOT_MEAN.plot()], Corner2D::LeftTop),
    chart(
        "dφ/dt and the slow root of regular precession",
        &[state::PHI_DOT.plot(), nutation::PHI_DOT_MEAN.plot(), precession::SLOW_ROOT.plot()],
        Corner2D::LeftTop,
    ),
    chart("dψ/dt, spin", &[state::PSI_DOT.plot(), nutation::PSI_DOT_MEAN.plot()], Corner2D::RightTop),
    chart("Friction torque, node frame", &[torque::FRICTION_NODE.plot()], Corner2D::LeftBottom),
    chart(
        "d²θ/dt² term by term",
        &[acceleration::THETA_DDOT_FRICTIONAL.plot(), state::THETA_DDOT.plot()],
        Corner2D::RightTop,
    ),
    chart(
        "Slip velocity at the contact, world axes",
        &[contact::SLIP_SPEED.plot(), contact::SLIP_WORLD.plot()],
        Corner2D::RightBottom,
    ),
    chart("Total and kinetic energy", &[energy::TOTAL.plot()], Corner2D::LeftBottom),
];

/// Charts of the second page, for a free peg: what it does on the table and above it.
#[rustfmt::skip]
const TABLE: [Chart; 8] = [
    chart("Normal force", &[contact::NORMAL_FORCE.plot()], Corner2D::RightTop),
    chart("Height of the peg above the table", &[free_peg::GAP.plot()], Corner2D::RightTop),
    chart("Regime: 1 slides, 0 rolls or sticks, 2 flies", &[contact::REGIME.plot()], Corner2D::RightTop),
    chart("Energy lost since the start", &[free_peg::LOST_SLIDING.plot()], Corner2D::LeftTop),
    chart("Centre of mass", &[center_of_mass::POSITION.plot()], Corner2D::LeftTop),
    chart("Velocity of the peg's centre", &[free_peg::VELOCITY.plot()], Corner2D::RightTop),
    chart("Jellett's integral", &[free_peg::JELLETT.plot()], Corner2D::RightTop),
    chart("Routh's integral", &[free_peg::ROUTH.plot()], Corner2D::RightTop),
];

/// Charts of the last page.
#[rustfmt::skip]
const MORE: [Chart; 8] = [
    chart(
        "d²φ/dt² term by term",
        &[acceleration::PHI_DDOT_FRICTIONAL.plot(), state::PHI_DDOT.plot()],
        Corner2D::LeftTop,
    ),
    chart(
        "d²ψ/dt² term by term",
        &[acceleration::PSI_DDOT_FRICTIONAL.plot(), state::PSI_DDOT.plot()],
        Corner2D::LeftTop,
    ),
    chart("dφ/dt − slow root", &[precession::EXCESS.plot()], Corner2D::LeftTop),
    chart("Nutation period", &[nutation::PERIOD.plot()], Corner2D::LeftTop),
    chart("Gravity torque, node frame", &[torque::GRAVITY_NODE.plot()], Corner2D::RightTop),
    chart("Angular momentum, vertical and axial", &[momentum::VERTICAL.plot()], Corner2D::RightTop),
    chart("Work of friction", &[energy::FRICTION_WORK.plot()], Corner2D::RightTop),
    chart("Power of friction", &[energy::FRICTION_POWER.plot()], Corner2D::RightBottom),
];

/// The messages of the layout.
pub(crate) fn messages(identity: &Identity) -> Vec<Result<LogMsg, RerunError>> {
    let mut layout = Layout::new(&identity.recording_id);
    let left = left_side(&mut layout, identity);
    let right = right_side(&mut layout, identity);
    // Without a scene there are only words at the left.
    let shares = if identity.has(POSE) {
        [42.0, 58.0]
    } else {
        [25.0, 75.0]
    };
    let root = match right {
        Some(right) => layout.contain(row(&shares), &[left, right]),
        None => left,
    };
    layout.fill(&root);
    panels(&mut layout, identity.is_alone, identity.playback);
    layout.finish()
}

/// The scene, if there is one, and below it the events and the description.
fn left_side(layout: &mut Layout, identity: &Identity) -> Child {
    let about = layout.view("TextDocument", "About this run", ABOUT, &["$origin"]);
    let mut pages = vec![about];
    if identity.has(EVENTS) {
        let kinds = [TextLogColumnKind::Body];
        pages.insert(0, events(layout, &["$origin".to_owned()], &kinds));
    }
    let words = layout.contain(tabs(), &pages);
    if !identity.has(POSE) {
        return words;
    }
    let whole = ["$origin/**".to_owned()];
    let geometry = &identity.geometry;
    // Beside the list of recordings the scene is narrower, and must still hold the names of all arrows.
    let distance = if identity.is_alone { 1.0 } else { 1.2 };
    let stage = Stage {
        name: "The top",
        contents: &whole,
        runs: &[(Look::Alone, geometry)],
        geometry,
        distance,
        followed: geometry.is_free.then(|| Look::Alone.entity(CAMERA_TARGET)),
    };
    let scene = scene(layout, &stage);
    layout.contain(column(&[76.0, 24.0]), &[scene, words])
}

/// Pages of charts. Those without data are left out.
fn right_side(layout: &mut Layout, identity: &Identity) -> Option<Child> {
    let mut pages = Vec::new();
    let table = identity.has(FREE_PEG).then_some(("On the table", &TABLE));
    let all = [Some(("How it rises", &RISE)), table, Some(("More", &MORE))];
    for (name, charts) in all.into_iter().flatten() {
        let mut views = Vec::new();
        for chart in charts {
            if !chart.contents.iter().any(|plot| identity.has(plot.topic())) {
                continue;
            }
            let name = titled(chart.name, chart.contents[0].unit());
            let contents: Vec<_> = chart.contents.iter().map(Plot::to_string).collect();
            let legend = Some(chart.legend);
            let link = LinkAxis::Independent;
            views.push(time_series(layout, &name, &contents, legend, link));
        }
        let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
            .with_grid_columns(2)
            .with_display_name(Name(name.into()));
        pages.extend(layout.contain_any(grid, &views));
    }
    layout.contain_any(tabs(), &pages)
}
