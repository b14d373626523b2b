//! Figures of runs for print: those of the paper, and more.
//!
//! A [`Figure`] lists the numbers it needs, a [`Run`] collects them from a recording or a simulation, and
//! [`Figure::draw`] makes a [`Drawing`] of them, which becomes SVG or PNG. The bytes depend on the numbers alone: the
//! font is part of the program, and neither the platform's `libm` nor a clock nor the order of a hash map matters.
//!
//! ```
//! use toprise::analysis::figures::{Figure, Run};
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "0.2")?;
//! let figure = Figure::find("figure-2").ok_or("no such figure")?;
//! let scenario = Scenario::new(values)?;
//! let run = Run::read(&scenario, "paper", &[figure], &|_| {});
//! let svg = figure.draw(&[&run], 85.0).svg();
//! assert!(svg.contains("aria-label=\"θ (rad)\""));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#[cfg(test)]
mod layout_tests;
mod locus;
mod looks;
#[cfg(feature = "sweep")]
mod map;
mod means;
mod need;
mod report;
mod run;
mod sampling;
mod time;
mod track;

#[cfg(feature = "sweep")]
pub use self::map::{Map, MapAxis, MapRun};
pub use self::report::{FigureFile, FiguresReport, Lacking, LeftOut, RunLoss};
pub use self::run::Run;
pub use crate::analysis::plot::drawing::Drawing;

use self::need::Need;
use crate::analysis::subject::Subject;
use crate::telemetry::fields::{
    NumberField, acceleration, contact, energy, free_peg, nutation, pose, precession, state, torque,
};

/// A figure that can be drawn of runs.
#[derive(Debug)]
pub struct Figure {
    /// The name, which is also that of its files.
    pub name: &'static str,
    /// Content of the figure.
    pub title: &'static str,
    /// The least number of runs that the figure can be drawn of.
    pub least_runs: usize,
    /// The numbers without which the figure can't be drawn.
    needs: &'static [Need],
    /// The numbers without which parts of the figure are left out.
    uses: &'static [Need],
    /// The pegs that the figure applies to.
    pegs: Pegs,
    /// The reason why the figure does not apply to this run; none if it does.
    does_not_apply: fn(&Run) -> Option<&'static str>,
    draw: fn(&[&Run], f64) -> Drawing,
}

/// Pegs that a figure applies to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Pegs {
    /// All.
    All,
    /// Those that are held: what it shows would be something else for a free one.
    Held {
        /// The reason why it does not apply to a free one.
        because: &'static str,
    },
    /// Those that are free: a held one stays where it is.
    Free,
}

/// The need for means over each nutation of some fields.
const fn means(fields: &'static [NumberField]) -> Need {
    Need {
        fields,
        are_means: true,
    }
}

/// The need for samples of some fields.
const fn samples(fields: &'static [NumberField]) -> Need {
    Need {
        fields,
        are_means: false,
    }
}

const ANGLES: Need = samples(&[
    state::THETA,
    state::THETA_DOT,
    state::PHI_DOT,
    state::PSI_DOT,
]);

const CYCLES: Need = samples(&[nutation::START, nutation::PERIOD]);

const NUTATIONS: Need = samples(&[
    nutation::START,
    nutation::PERIOD,
    nutation::THETA_MEAN,
    nutation::THETA_DOT_MEAN,
    nutation::PHI_DOT_MEAN,
    nutation::PSI_DOT_MEAN,
]);

const ENVELOPE: Need = samples(&[
    nutation::THETA_MIN,
    nutation::THETA_MAX,
    nutation::THETA_DOT_MIN,
    nutation::THETA_DOT_MAX,
    nutation::PHI_DOT_MIN,
    nutation::PHI_DOT_MAX,
    nutation::PSI_DOT_MIN,
    nutation::PSI_DOT_MAX,
]);

const THETA: Need = samples(&[state::THETA]);
const PRECESSION_RATE: Need = samples(&[state::PHI_DOT]);
const ROOTS: Need = samples(&[precession::SLOW_ROOT, precession::FAST_ROOT]);
const AXIS: Need = samples(&pose::AXIS.components());

const ACCELERATIONS: Need = means(&[
    acceleration::THETA_DDOT_GYROSCOPIC,
    acceleration::THETA_DDOT_CENTRIFUGAL,
    acceleration::THETA_DDOT_GRAVITATIONAL,
    acceleration::THETA_DDOT_FRICTIONAL,
    acceleration::PHI_DDOT_GYROSCOPIC,
    acceleration::PHI_DDOT_CORIOLIS,
    acceleration::PHI_DDOT_FRICTIONAL,
]);

const TORQUE_FIELDS: &[NumberField] = &[
    torque::GRAVITY_NODE.x(),
    torque::FRICTION_NODE.x(),
    torque::FRICTION_NODE.y(),
    torque::FRICTION_NODE.z(),
];
const SLIP_FIELDS: &[NumberField] = &[contact::SLIP_SPEED, contact::SLIP_PATH];
const NORMAL_FORCE_FIELDS: &[NumberField] = &[contact::NORMAL_FORCE];
const GAP_FIELDS: &[NumberField] = &[free_peg::GAP];
const ENERGY_FIELDS: &[NumberField] = &[
    energy::KINETIC,
    energy::POTENTIAL,
    energy::TOTAL,
    energy::FRICTION_WORK,
    energy::FRICTION_POWER,
];

const TRACK: Need = samples(&[contact::CONTACT_POINT.x(), contact::CONTACT_POINT.y()]);
const REGIME: Need = samples(&[contact::REGIME]);

/// The defaults of the table below.
const DEFAULTS: Figure = Figure {
    name: "",
    title: "",
    least_runs: 1,
    needs: &[],
    uses: &[],
    pegs: Pegs::All,
    does_not_apply: |_| None,
    draw: |_, width| Drawing::new(width),
};

/// All figures: first those of the paper, with its numbers.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "figure-2",
        title: "θ, θ̇, φ̇ and ψ̇ over time",
        needs: &[ANGLES],
        uses: &[NUTATIONS, ENVELOPE],
        draw: time::motion,
        ..DEFAULTS
    },
    Figure {
        name: "figure-3",
        title: "The locus of the symmetry axis, its projection, and its end magnified",
        needs: &[AXIS],
        uses: &[CYCLES],
        draw: locus::locus,
        ..DEFAULTS
    },
    Figure {
        name: "figure-4",
        title: "θ of each further run, with the averages of the first",
        least_runs: 2,
        needs: &[THETA, NUTATIONS],
        uses: &[ENVELOPE],
        draw: time::compared,
        ..DEFAULTS
    },
    Figure {
        name: "acceleration",
        title: "Why it rises: the terms of θ̈ and φ̈, averaged over nutations",
        needs: &[ACCELERATIONS, NUTATIONS],
        pegs: Pegs::Held {
            because: "the terms are those of a peg that stays in place; a free one adds that of its own acceleration",
        },
        draw: time::acceleration,
        ..DEFAULTS
    },
    Figure {
        name: "precession",
        title: "φ̇ and the rates of regular precession, between which the top is driven upright",
        needs: &[PRECESSION_RATE, ROOTS],
        uses: &[NUTATIONS, ENVELOPE],
        pegs: Pegs::Held {
            because: "the rates are those of a peg that stays in place, and a free one also rolls",
        },
        draw: time::precession,
        ..DEFAULTS
    },
    Figure {
        name: "torque",
        title: "Torques along the line of nodes (x), its perpendicular (y) and the symmetry axis (z)",
        needs: &[samples(TORQUE_FIELDS)],
        uses: &[CYCLES, means(TORQUE_FIELDS)],
        draw: time::torque,
        ..DEFAULTS
    },
    Figure {
        name: "slip",
        title: "Slip speed and path slipped",
        needs: &[samples(SLIP_FIELDS)],
        uses: &[CYCLES, means(SLIP_FIELDS)],
        draw: time::slip,
        ..DEFAULTS
    },
    Figure {
        name: "energy",
        title: "Kinetic, potential and total energy, and what friction takes",
        needs: &[samples(ENERGY_FIELDS)],
        uses: &[CYCLES, means(ENERGY_FIELDS)],
        draw: time::energy,
        ..DEFAULTS
    },
    Figure {
        name: "track",
        title: "The track of the contact point of a free peg on the table, from above",
        needs: &[TRACK],
        uses: &[REGIME],
        pegs: Pegs::Free,
        draw: track::track,
        ..DEFAULTS
    },
    Figure {
        name: "hops",
        title: "The normal force on a free peg, and its height above the table",
        needs: &[samples(NORMAL_FORCE_FIELDS), samples(GAP_FIELDS)],
        uses: &[CYCLES, means(NORMAL_FORCE_FIELDS), means(GAP_FIELDS)],
        pegs: Pegs::Free,
        does_not_apply: |run| {
            let gaps = run.series(free_peg::GAP).into_iter().map(|point| point.1);
            let highest = gaps.reduce(f64::max);
            let stays = highest.is_some_and(|gap| gap <= 0.0);
            stays.then_some("the peg never leaves the table")
        },
        draw: time::hops,
        ..DEFAULTS
    },
];

impl Run {
    /// Reads what some figures need of a recording or a simulation.
    ///
    /// `progress` receives the number of further bytes that have been read.
    #[must_use]
    pub fn read<'a>(
        subject: impl Into<Subject<'a>>,
        name: &str,
        figures: &[&Figure],
        progress: &dyn Fn(u64),
    ) -> Self {
        let needs = figures.iter().flat_map(|figure| figure.all_needs());
        Self::collect(subject.into(), name, needs, progress)
    }
}

impl Figure {
    /// The figure with this name.
    #[must_use]
    pub fn find(name: &str) -> Option<&'static Self> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// The first need of the figure that a run lacks: a channel, its messages, or a field.
    #[must_use]
    pub fn missing(&self, run: &Run) -> Option<String> {
        self.needs.iter().find_map(|need| run.missing(need))
    }

    /// The reason why the figure does not apply to a run, whatever the run has recorded.
    #[must_use]
    pub fn does_not_apply(&self, run: &Run) -> Option<&'static str> {
        match self.pegs {
            Pegs::Held { because } if run.has_free_peg => Some(because),
            Pegs::Free if !run.has_free_peg => Some("the peg is held: it stays where it is"),
            Pegs::All | Pegs::Held { .. } | Pegs::Free => (self.does_not_apply)(run),
        }
    }

    /// Whether the figure is expected of a run: one of free pegs is not expected of a held one.
    #[must_use]
    pub fn is_expected_of(&self, run: &Run) -> bool {
        self.pegs != Pegs::Free || run.has_free_peg
    }

    /// Draws the figure with a width in mm. Several runs are drawn over one another; what a run lacks is left out.
    #[must_use]
    pub fn draw(&self, runs: &[&Run], width: f64) -> Drawing {
        let mut drawing = (self.draw)(runs, width);
        let names: Vec<_> = runs.iter().map(|run| run.name.as_str()).collect();
        drawing.title = format!("{} — {}", self.title, names.join(", "));
        drawing
    }

    fn all_needs(&self) -> impl Iterator<Item = &'static Need> {
        self.needs.iter().chain(self.uses)
    }
}
