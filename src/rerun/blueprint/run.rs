//! The layout for one run: the scene at the left with the events below, the main charts at the right.

use rerun::StoreId;
use rerun::blueprint::components::{ContainerKind, Corner2D, LinkAxis};
use rerun::blueprint::datatypes::TextLogColumnKind;
use rerun::components::Name;
use rerun::external::re_log_types::LogMsg;
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::builder::{Child, Layout, column, row, tabs};
use super::views::{Stage, bound, events, panels, scene, speed, time_panel, time_series, titled};
use crate::rerun::entity::{self, ABOUT, CAMERA_TARGET, EACH_EVENT};
use crate::rerun::error::RerunError;
use crate::rerun::identity::{Identity, Playback};
use crate::rerun::look::Look;
use crate::telemetry::fields::{
    EVENTS, POSE, Plot, acceleration, center_of_mass, contact, energy, free_peg, momentum,
    nutation, precession, state, torque,
};
use crate::telemetry::proportions::Proportions;

/// A view of some plots, with its title and the corner where the legend is out of the curves' way.
struct Chart {
    name: &'static str,
    contents: &'static [Plot],
    legend: Corner2D,
}

impl Chart {
    const fn legend(self, legend: Corner2D) -> Self {
        Self { legend, ..self }
    }

    /// The largest magnitude that is not a peak of singular angles, of rates and accelerations of φ and ψ.
    fn bound(&self, identity: &Identity) -> Option<f64> {
        let spin = identity.geometry.spin;
        match self.contents.first()?.unit() {
            "rad/s" => Some(2.0 * spin),
            "rad/s²" => Some(spin * spin),
            _ => None,
        }
    }
}

const fn chart(name: &'static str, contents: &'static [Plot]) -> Chart {
    Chart {
        name,
        contents,
        legend: Corner2D::RightTop,
    }
}

const THETA: Chart = chart(
    "θ, inclination",
    &[state::THETA.plot(), nutation::THETA_MEAN.plot()],
);
const THETA_DOT: Chart = chart(
    "dθ/dt",
    &[state::THETA_DOT.plot(), nutation::THETA_DOT_MEAN.plot()],
)
.legend(Corner2D::LeftTop);
const PHI_DOT: Chart = chart(
    "dφ/dt and the slow root of regular precession",
    &[
        state::PHI_DOT.plot(),
        nutation::PHI_DOT_MEAN.plot(),
        precession::SLOW_ROOT.plot(),
    ],
)
.legend(Corner2D::LeftTop);
const PSI_DOT: Chart = chart(
    "dψ/dt, spin",
    &[state::PSI_DOT.plot(), nutation::PSI_DOT_MEAN.plot()],
);
const TORQUE: Chart = chart(
    "Friction torque, node frame",
    &[torque::FRICTION_NODE.plot()],
)
.legend(Corner2D::LeftBottom);
const THETA_DDOT: Chart = chart(
    "d²θ/dt² term by term",
    &[
        acceleration::THETA_DDOT_FRICTIONAL.plot(),
        state::THETA_DDOT.plot(),
    ],
)
.legend(Corner2D::RightBottom);
const SLIP: Chart = chart(
    "Slip velocity at the contact, world axes",
    &[contact::SLIP_SPEED.plot(), contact::SLIP_WORLD.plot()],
);
const ENERGY: Chart =
    chart("Total and kinetic energy", &[energy::TOTAL.plot()]).legend(Corner2D::LeftBottom);
const MOMENTUM: Chart = chart(
    "Angular momentum, vertical and axial",
    &[momentum::VERTICAL.plot()],
);
const CENTER: Chart =
    chart("Centre of mass", &[center_of_mass::POSITION.plot()]).legend(Corner2D::LeftTop);

/// The rise of a top with a fixed peg.
const RISE: [Chart; 8] = [
    THETA, THETA_DOT, PHI_DOT, PSI_DOT, TORQUE, THETA_DDOT, SLIP, ENERGY,
];

/// The travel of a top with a free peg, or the inversion of a tippe top. Euler rates, which are infinite at upright, stand on a page of
/// their own.
const TRAVEL: [Chart; 8] = [
    THETA,
    MOMENTUM,
    SLIP,
    CENTER,
    chart(
        "Regime: 1 slides, 0 rolls or sticks, 2 flies",
        &[contact::REGIME.plot()],
    ),
    chart("Height of the peg above the table", &[free_peg::GAP.plot()]),
    TORQUE,
    ENERGY,
];

/// Events of a free peg on the table and above it.
const TABLE: [Chart; 6] = [
    chart("Normal force", &[contact::NORMAL_FORCE.plot()]),
    chart(
        "Energy lost since the start",
        &[free_peg::LOST_SLIDING.plot()],
    )
    .legend(Corner2D::LeftTop),
    chart("Velocity of the peg's centre", &[free_peg::VELOCITY.plot()]),
    chart(
        "Velocity of the centre of mass",
        &[center_of_mass::VELOCITY.plot()],
    ),
    chart("Jellett's integral", &[free_peg::JELLETT.plot()]),
    chart("Routh's integral", &[free_peg::ROUTH.plot()]),
];

/// The Euler rates of a top with a free peg.
const RATES: [Chart; 4] = [THETA_DOT, PHI_DOT, PSI_DOT, THETA_DDOT];

/// Further quantities.
const MORE: [Chart; 8] = [
    chart(
        "d²φ/dt² term by term",
        &[
            acceleration::PHI_DDOT_FRICTIONAL.plot(),
            state::PHI_DDOT.plot(),
        ],
    )
    .legend(Corner2D::LeftTop),
    chart(
        "d²ψ/dt² term by term",
        &[
            acceleration::PSI_DDOT_FRICTIONAL.plot(),
            state::PSI_DDOT.plot(),
        ],
    )
    .legend(Corner2D::LeftTop),
    chart("dφ/dt − slow root", &[precession::EXCESS.plot()]).legend(Corner2D::LeftTop),
    chart("Nutation period", &[nutation::PERIOD.plot()]).legend(Corner2D::LeftTop),
    chart("Gravity torque, node frame", &[torque::GRAVITY_NODE.plot()]),
    MOMENTUM,
    chart("Work of friction", &[energy::FRICTION_WORK.plot()]),
    chart("Power of friction", &[energy::FRICTION_POWER.plot()]).legend(Corner2D::RightBottom),
];

/// The messages of the layout.
pub(crate) fn messages(identity: &Identity) -> Vec<Result<LogMsg, RerunError>> {
    let mut layout = Layout::new(&identity.store());
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
    panels(&mut layout, identity.is_alone, identity.playback, 1.0);
    layout.finish()
}

/// The messages that change the layout of a recording, so that a viewer plays the run, of this duration in s, from its start.
pub(crate) fn messages_at_end(
    recording: &StoreId,
    duration: f64,
) -> Vec<Result<LogMsg, RerunError>> {
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
            pages.insert(
                0,
                events(layout, name, &contents, &[TextLogColumnKind::Body]),
            );
        }
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
        name: &identity.title,
        contents: &whole,
        runs: &[(Look::Alone, geometry)],
        geometry,
        distance,
        followed: geometry.is_free.then(|| CAMERA_TARGET.to_owned()),
    };
    let scene = scene(layout, &stage);
    layout.contain(column(&[76.0, 24.0]), &[scene, words])
}

/// Pages of charts. Those without data are left out.
fn right_side(layout: &mut Layout, identity: &Identity) -> Option<Child> {
    let mut pages = Vec::new();
    let is_tippe_top = Proportions::new(&identity.geometry.top).is_ball;
    let first = match (identity.geometry.is_free, is_tippe_top) {
        (false, _) => ("How it rises", &RISE),
        (true, false) => ("How it travels", &TRAVEL),
        (true, true) => ("How it inverts", &TRAVEL),
    };
    let mut all: Vec<(&str, &[Chart])> = vec![(first.0, first.1)];
    if identity.geometry.is_free {
        all.extend([("On the table", &TABLE[..]), ("Rates", &RATES[..])]);
    }
    all.push(("More", &MORE));
    for (name, charts) in all {
        let mut views = Vec::new();
        for chart in charts {
            if !chart.contents.iter().any(|plot| identity.has(plot.topic())) {
                continue;
            }
            let name = titled(chart.name, chart.contents[0].unit());
            let contents: Vec<_> = chart.contents.iter().map(Plot::to_string).collect();
            let legend = Some(chart.legend);
            let link = LinkAxis::Independent;
            let view = time_series(layout, &name, &contents, legend, link);
            // A tippe top passes through upright, where its Euler rates are infinite.
            if let Some(greatest) = chart.bound(identity).filter(|_| is_tippe_top) {
                bound(layout, &view, [-greatest, greatest]);
            }
            views.push(view);
        }
        let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
            .with_grid_columns(2)
            .with_display_name(Name(name.into()));
        pages.extend(layout.contain_any(grid, &views));
    }
    layout.contain_any(tabs(), &pages)
}
