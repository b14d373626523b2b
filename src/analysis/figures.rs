//! Figures of runs for print: those of the paper, and more.
//!
//! A [`Figure`] says which numbers it needs; a [`Run`] has them from a recording or a simulation; what it
//! draws is a [`Drawing`], which becomes SVG or PNG. The bytes depend on the numbers alone: the font is
//! part of the program, and nothing asks for the platform's `libm`, a clock or an order of hashes.
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
mod need;
mod run;
mod time;

pub use self::run::Run;
pub use crate::analysis::plot::drawing::Drawing;

use self::need::{NUTATION, Need};
use crate::analysis::subject::Subject;

/// A kind of figure.
#[derive(Debug)]
pub struct Figure {
    /// Its name, which is also that of its file.
    pub name: &'static str,
    /// What it shows.
    pub title: &'static str,
    /// The least number of runs of which it can be drawn.
    pub least_runs: usize,
    /// Without these it can't be drawn.
    needs: &'static [Need],
    /// Without these it is drawn with less.
    uses: &'static [Need],
    draw: fn(&[&Run], f64) -> Drawing,
}

const ANGLES: Need = Need {
    topic: "/top/state",
    fields: &["theta", "theta_dot", "phi_dot", "psi_dot"],
};

const NUTATIONS: Need = Need {
    topic: NUTATION,
    fields: &[
        "start",
        "period",
        "theta_mean",
        "theta_dot_mean",
        "phi_dot_mean",
        "psi_dot_mean",
    ],
};

/// All figures: first those of the paper, with its numbers.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "figure-2",
        title: "θ, θ̇, φ̇ and ψ̇ over time",
        least_runs: 1,
        needs: &[ANGLES],
        uses: &[NUTATIONS],
        draw: time::motion,
    },
    Figure {
        name: "figure-3",
        title: "The locus of the symmetry axis, its projection, and its end magnified",
        least_runs: 1,
        needs: &[Need {
            topic: "/top/pose",
            fields: &["axis.x", "axis.y", "axis.z"],
        }],
        uses: &[],
        draw: locus::locus,
    },
    Figure {
        name: "figure-4",
        title: "θ of each further run, with the averages of the first",
        least_runs: 2,
        needs: &[
            Need {
                topic: "/top/state",
                fields: &["theta"],
            },
            NUTATIONS,
        ],
        uses: &[],
        draw: time::compared,
    },
    Figure {
        name: "acceleration",
        title: "Why it rises: the terms of θ̈ and φ̈, averaged over nutations",
        least_runs: 1,
        needs: &[
            Need {
                topic: "/top/acceleration",
                fields: &[
                    "theta_ddot.gyroscopic",
                    "theta_ddot.centrifugal",
                    "theta_ddot.gravitational",
                    "theta_ddot.frictional",
                    "phi_ddot.gyroscopic",
                    "phi_ddot.coriolis",
                    "phi_ddot.frictional",
                ],
            },
            NUTATIONS,
        ],
        uses: &[],
        draw: time::acceleration,
    },
    Figure {
        name: "precession",
        title: "φ̇ and the rates of regular precession; the top rises between them",
        least_runs: 1,
        needs: &[
            Need {
                topic: "/top/state",
                fields: &["phi_dot"],
            },
            Need {
                topic: "/top/precession",
                fields: &["slow_root", "fast_root"],
            },
        ],
        uses: &[NUTATIONS],
        draw: time::precession,
    },
    Figure {
        name: "torque",
        title: "Torques along the line of nodes (x), its perpendicular (y) and the symmetry axis (z)",
        least_runs: 1,
        needs: &[Need {
            topic: "/top/torque",
            fields: &[
                "gravity_node.x",
                "friction_node.x",
                "friction_node.y",
                "friction_node.z",
            ],
        }],
        uses: &[],
        draw: time::torque,
    },
    Figure {
        name: "slip",
        title: "Slip speed and path slipped",
        least_runs: 1,
        needs: &[Need {
            topic: "/top/contact",
            fields: &["slip_speed", "slip_path"],
        }],
        uses: &[],
        draw: time::slip,
    },
    Figure {
        name: "energy",
        title: "Kinetic, potential and total energy, and what friction takes",
        least_runs: 1,
        needs: &[Need {
            topic: "/top/energy",
            fields: &[
                "kinetic",
                "potential",
                "total",
                "friction_work",
                "friction_power",
            ],
        }],
        uses: &[],
        draw: time::energy,
    },
];

impl Run {
    /// Reads what some figures need of a recording or a simulation.
    ///
    /// `progress` is told how many more bytes have been read.
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

    /// What a run lacks that the figure can't be drawn without: a channel, its messages, or a field.
    #[must_use]
    pub fn missing(&self, run: &Run) -> Option<String> {
        self.needs.iter().find_map(|need| run.missing(need))
    }

    /// Draws it with a width in mm. With several runs it is an overlay; what a run lacks is left out.
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
