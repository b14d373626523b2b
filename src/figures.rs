//! Figures for print: those of the paper and others.
//!
//! A [`Figure`] lists the fields it needs, a [`Run`] collects them from a recording or a simulation, and
//! [`Figure::draw`] produces a [`Drawing`] (SVG or PNG). The output is reproducible: the font is embedded, and no
//! platform `libm`, clock or hash order is used.
//!
//! ```
//! use toprise::figures::{Figure, Run};
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

mod channel;
mod locus;
mod looks;
#[cfg(feature = "sweep")]
mod map;
mod plot;
mod report;
mod run;
mod sampling;
mod time;
mod track;

#[cfg(feature = "sweep")]
pub use self::map::{Map, MapAxis, MapRun};
pub use self::plot::drawing::Drawing;
pub use self::report::{FigureFile, FiguresReport, Lacking, LeftOut, RunLoss};
pub use self::run::Run;

use crate::analysis::subject::Subject;
use crate::telemetry::fields::{
    NUTATION, NumberField, acceleration, contact, energy, free_peg, nutation, pose, precession,
    state, torque,
};

/// A figure of one or several runs.
#[derive(Debug)]
pub struct Figure {
    /// The name, which is also that of its files.
    pub name: &'static str,
    /// Content of the figure.
    pub title: &'static str,
    /// Minimum number of runs.
    pub least_runs: usize,
    /// Required fields.
    needs: &'static [NumberField],
    /// Whether means of its fields over nutations are drawn.
    has_means: bool,
    /// Whether the figure applies to free pegs only.
    is_of_free_pegs: bool,
    /// Reason why the figure does not apply to a run, if any.
    does_not_apply: fn(&Run) -> Option<&'static str>,
    draw: fn(&[&Run], f64) -> Drawing,
}

/// The defaults of the table below.
const DEFAULTS: Figure = Figure {
    name: "",
    title: "",
    least_runs: 1,
    needs: &[],
    has_means: false,
    is_of_free_pegs: false,
    does_not_apply: |_| None,
    draw: |_, width| Drawing::new(width),
};

/// All figures: first those of the paper, with its numbers.
pub const FIGURES: &[Figure] = &[
    Figure {
        name: "figure-2",
        title: "θ, θ̇, φ̇ and ψ̇ over time",
        needs: &[
            state::THETA,
            state::THETA_DOT,
            state::PHI_DOT,
            state::PSI_DOT,
        ],
        draw: time::motion,
        ..DEFAULTS
    },
    Figure {
        name: "figure-3",
        title: "The locus of the symmetry axis, its projection, and its end magnified",
        needs: &pose::AXIS.components(),
        draw: locus::locus,
        ..DEFAULTS
    },
    Figure {
        name: "figure-4",
        title: "θ of each further run, with the averages of the first",
        least_runs: 2,
        needs: &[state::THETA, nutation::THETA_MEAN],
        draw: time::compared,
        ..DEFAULTS
    },
    Figure {
        name: "acceleration",
        title: "Terms of θ̈ and φ̈, averaged over nutations",
        needs: &[
            acceleration::THETA_DDOT_GYROSCOPIC,
            acceleration::THETA_DDOT_CENTRIFUGAL,
            acceleration::THETA_DDOT_GRAVITATIONAL,
            acceleration::THETA_DDOT_FRICTIONAL,
            acceleration::PHI_DDOT_GYROSCOPIC,
            acceleration::PHI_DDOT_CORIOLIS,
            acceleration::PHI_DDOT_FRICTIONAL,
            nutation::START,
        ],
        has_means: true,
        does_not_apply: |run| {
            let because = "its equations hold for a fixed peg only";
            run.has_free_peg.then_some(because)
        },
        draw: time::acceleration,
        ..DEFAULTS
    },
    Figure {
        name: "precession",
        title: "φ̇ and the rates of regular precession (θ̈ < 0 between them)",
        needs: &[state::PHI_DOT, precession::SLOW_ROOT, precession::FAST_ROOT],
        does_not_apply: |run| {
            let because = "the rates of regular precession hold for a fixed peg only";
            run.has_free_peg.then_some(because)
        },
        draw: time::precession,
        ..DEFAULTS
    },
    Figure {
        name: "torque",
        title: "Torques along the line of nodes (x), its perpendicular (y) and the symmetry axis (z)",
        needs: &[
            torque::GRAVITY_NODE.x(),
            torque::FRICTION_NODE.x(),
            torque::FRICTION_NODE.y(),
            torque::FRICTION_NODE.z(),
        ],
        has_means: true,
        draw: time::torque,
        ..DEFAULTS
    },
    Figure {
        name: "slip",
        title: "Slip speed and slip path",
        needs: &[contact::SLIP_SPEED, contact::SLIP_PATH],
        has_means: true,
        draw: time::slip,
        ..DEFAULTS
    },
    Figure {
        name: "energy",
        title: "Kinetic, potential and total energy, and work of friction",
        needs: &[
            energy::KINETIC,
            energy::POTENTIAL,
            energy::TOTAL,
            energy::FRICTION_WORK,
            energy::FRICTION_POWER,
        ],
        has_means: true,
        draw: time::energy,
        ..DEFAULTS
    },
    Figure {
        name: "track",
        title: "The track of the contact point of a free peg on the table, from above",
        needs: &[
            contact::CONTACT_POINT.x(),
            contact::CONTACT_POINT.y(),
            contact::REGIME,
        ],
        is_of_free_pegs: true,
        draw: track::track,
        ..DEFAULTS
    },
    Figure {
        name: "hops",
        title: "The normal force on a free peg, and its height above the table",
        needs: &[contact::NORMAL_FORCE, free_peg::GAP],
        has_means: true,
        is_of_free_pegs: true,
        does_not_apply: |run| {
            let gaps = run.series(free_peg::GAP).into_iter().map(|point| point.1);
            let highest = gaps.reduce(f64::max);
            let stays = highest.is_some_and(|gap| gap <= 0.0);
            stays.then_some("the peg does not leave the table")
        },
        draw: time::hops,
        ..DEFAULTS
    },
];

impl Run {
    /// Reads the data that some figures need from a recording or a simulation.
    ///
    /// `progress` receives the number of further bytes that have been read.
    pub fn read<'a>(
        subject: impl Into<Subject<'a>>,
        name: &str,
        figures: &[&Figure],
        progress: &dyn Fn(u64),
    ) -> Self {
        let fields = figures.iter().flat_map(|figure| figure.needs).copied();
        let fields = fields.chain(NUTATION.numbers()).collect();
        let with_means = figures.iter().filter(|figure| figure.has_means);
        let means = with_means.flat_map(|figure| figure.needs).copied();
        let means: Vec<_> = means.filter(|field| field.topic() != NUTATION).collect();
        Self::collect(subject.into(), name, fields, &means, progress)
    }
}

impl Figure {
    /// The figure with this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// The first missing requirement of a run: a channel, its messages, or a field.
    pub fn missing(&self, run: &Run) -> Option<String> {
        self.needs.iter().find_map(|field| run.missing(*field))
    }

    /// The reason why the figure does not apply to a run, whatever the run has recorded.
    pub fn does_not_apply(&self, run: &Run) -> Option<&'static str> {
        if self.is_expected_of(run) {
            (self.does_not_apply)(run)
        } else {
            Some("the peg is fixed")
        }
    }

    /// Whether the figure is expected for a run.
    pub fn is_expected_of(&self, run: &Run) -> bool {
        run.has_free_peg || !self.is_of_free_pegs
    }

    /// Draws the figure with a width in mm. Several runs are overlaid; missing data is omitted.
    pub fn draw(&self, runs: &[&Run], width: f64) -> Drawing {
        let mut drawing = (self.draw)(runs, width);
        let names: Vec<_> = runs.iter().map(|run| run.name.as_str()).collect();
        drawing.title = format!("{} — {}", self.title, names.join(", "));
        drawing
    }
}

/// Elements of a figure never overlap and never extend beyond its edges.
#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::plot::drawing::{Drawing, Label};
    use crate::figures::plot::shape::{Bounds, Shape};
    use crate::figures::plot::style::FONT;
    use crate::run::scenario::{Preset, Scenario};

    /// A run that is quick to draw and differs from others.
    fn run(preset: &str, name: &str, duration: &str) -> Run {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        values.set("stop.duration", duration).unwrap();
        let figures: Vec<_> = FIGURES.iter().collect();
        let mut run = Run::read(&Scenario::new(values).unwrap(), preset, &figures, &|_| {});
        run.name = name.to_owned();
        run
    }

    fn runs() -> Vec<Run> {
        vec![
            run("paper", "paper", "30"),
            run("paper-spin-term-only", &"a-very-long-name-".repeat(5), "40"),
            run("full-coulomb", "directory/full_{coulomb}*.mcap", "2"),
            run("frictionless", "frictionless", "2"),
        ]
    }

    /// The bounds of a label.
    fn space(label: &Label) -> Bounds {
        let ((x, y), text) = (label.origin, &label.text);
        let [width, above, below] = [text.width, text.above, text.below].map(|em| em * FONT);
        if label.is_upward {
            Bounds::between((x - above, y - width), (x + below, y))
        } else {
            Bounds::between((x, y - above), (x + width, y + below))
        }
    }

    fn overlap(a: &Bounds, b: &Bounds) -> bool {
        a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
    }

    fn check(drawing: &Drawing, what: &str) {
        let (width, height) = drawing.size();
        for (index, label) in drawing.labels.iter().enumerate() {
            let bounds = space(label);
            let said = &label.text.spoken;
            let is_within = bounds.left >= 0.0
                && bounds.top >= 0.0
                && bounds.right <= width
                && bounds.bottom <= height;
            assert!(is_within, "{what}: {said} sticks out: {bounds:?}");
            for other in &drawing.labels[index + 1..] {
                let other_said = &other.text.spoken;
                let is_apart = !overlap(&bounds, &space(other));
                assert!(is_apart, "{what}: {said} lies on {other_said}");
            }
        }
        for frame in frames(drawing) {
            let inside = |label: &&Label| overlap(&space(label), &frame);
            let label = drawing.labels.iter().find(inside);
            assert!(
                label.is_none(),
                "{what}: {:?} in a frame",
                label.map(|l| &l.text.spoken)
            );
        }
    }

    /// The frames of all plots.
    fn frames(drawing: &Drawing) -> Vec<Bounds> {
        let groups = drawing
            .groups
            .iter()
            .filter(|group| group.meaning == "frame");
        groups
            .filter_map(|group| match group.shapes.first() {
                Some(Shape::Line { points, .. }) => Some(Bounds {
                    left: points[0].0,
                    top: points[0].1,
                    right: points[2].0,
                    bottom: points[2].1,
                }),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn labels_lie_within_figures_and_apart() {
        let runs = runs();
        let alone = |run| vec![run];
        let mut sets: Vec<Vec<&Run>> = runs.iter().map(alone).collect();
        sets.push(runs.iter().collect());
        for figure in FIGURES {
            for runs in sets.iter().filter(|runs| runs.len() >= figure.least_runs) {
                for width in [80.0, 85.0, 129.0, 130.0, 170.0, 400.0] {
                    let what = format!("{} of {} runs, {width} mm", figure.name, runs.len());
                    check(&figure.draw(runs, width), &what);
                }
            }
        }
    }

    #[test]
    fn lines_lie_within_figures() {
        let runs = runs();
        let runs: Vec<_> = runs.iter().collect();
        for figure in FIGURES {
            let drawing = figure.draw(&runs, 85.0);
            for shape in drawing.groups.iter().flat_map(|group| &group.shapes) {
                let (Shape::Line { points, .. } | Shape::Area { points, .. }) = shape else {
                    continue;
                };
                for (x, y) in points {
                    let is_within =
                        (0.0..=drawing.width).contains(x) && (0.0..=drawing.height).contains(y);
                    assert!(is_within, "{}: ({x}, {y})", figure.name);
                }
            }
        }
    }
}
