//! Figures for print: the figures of the paper, and others.
//!
//! A [`Figure`] lists the fields it needs, [`RunData`] collects them from a recording or a simulation, and
//! [`Figure::draw`] produces a [`Drawing`] (SVG or PNG). The output is reproducible: the font is embedded, and no
//! platform `libm`, clock or hash order is used.
//!
//! ```
//! use toprise::figures::{Figure, RunData};
//! use toprise::run::scenario::{Preset, Scenario};
//!
//! let mut values = Preset::find("paper")?.values()?;
//! values.set("stop.duration", "0.2")?;
//! let figure = Figure::find("figure-2").ok_or("no such figure")?;
//! let scenario = Scenario::new(values)?;
//! let run = RunData::read(&scenario, "paper", &[figure], &|_| {});
//! let svg = figure.draw(&[&run], 85.0).svg();
//! assert!(svg.contains("aria-label=\"θ (rad)\""));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod channel;
mod data;
mod error;
#[cfg(feature = "fit")]
pub mod fit;
mod laws;
mod locus;
mod map;
mod plot;
mod report;
mod sampling;
mod style;
mod symbol;
mod time;
mod track;

pub use self::data::{MissingData, RunData};
pub use self::error::FigureError;
pub use self::laws::{LawCurve, draw_laws};
#[cfg(feature = "sweep")]
pub use self::map::CONTEXT_COLUMNS;
pub use self::map::{Map, MapAxis, MapRun};
pub use self::plot::drawing::Drawing;
pub use self::plot::png::PngError;
pub use self::report::{FigureFile, FiguresReport, Lacking, LeftOut, RunLoss};

use crate::analysis::subject::Subject;
use crate::telemetry::fields::{
    NUTATION, NumberField, acceleration, contact, energy, free_peg, nutation, pose, precession,
    state, torque,
};

/// A figure of one or several runs.
#[derive(Debug)]
pub struct Figure {
    /// The name, which is also the name of the files.
    pub name: &'static str,
    /// Content of the figure.
    pub title: &'static str,
    /// Minimum number of runs.
    pub min_runs: usize,
    /// Required fields.
    needs: &'static [NumberField],
    /// Whether means of the fields over nutations are drawn.
    has_means: bool,
    /// Whether the figure applies to free pegs only.
    needs_free_peg: bool,
    /// Reason why the figure does not apply to a run, if any.
    exclusion: fn(&RunData) -> Option<&'static str>,
    draw: fn(&[&RunData], f64) -> Drawing,
}

/// The defaults of the table below.
const DEFAULTS: Figure = Figure {
    name: "",
    title: "",
    min_runs: 1,
    needs: &[],
    has_means: false,
    needs_free_peg: false,
    exclusion: |_| None,
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
        min_runs: 2,
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
        exclusion: |run| {
            run.has_free_peg
                .then_some("its equations hold for a fixed peg only")
        },
        draw: time::acceleration,
        ..DEFAULTS
    },
    Figure {
        name: "precession",
        title: "φ̇ and the rates of regular precession (θ̈ < 0 between them)",
        needs: &[state::PHI_DOT, precession::SLOW_ROOT, precession::FAST_ROOT],
        exclusion: |run| {
            run.has_free_peg
                .then_some("the rates of regular precession hold for a fixed peg only")
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
        needs_free_peg: true,
        draw: track::track,
        ..DEFAULTS
    },
    Figure {
        name: "hops",
        title: "The normal force on a free peg, and its height above the table",
        needs: &[contact::NORMAL_FORCE, free_peg::GAP],
        has_means: true,
        needs_free_peg: true,
        exclusion: |run| stays_on_table(run).then_some("the peg does not leave the table"),
        draw: time::hops,
        ..DEFAULTS
    },
];

/// Whether a free peg is recorded to stay on the table. Without a record of the gap, the figure lacks data instead.
fn stays_on_table(run: &RunData) -> bool {
    run.series(free_peg::GAP)
        .into_iter()
        .map(|point| point.1)
        .reduce(f64::max)
        .is_some_and(|max_gap| max_gap <= 0.0)
}

impl RunData {
    /// Reads the data that some figures need from a recording or a simulation.
    ///
    /// `progress` receives the number of further bytes that have been read.
    pub fn read<'a>(
        subject: impl Into<Subject<'a>>,
        name: &str,
        figures: &[&Figure],
        progress: &dyn Fn(u64),
    ) -> Self {
        // All figures need the nutation cycles, to note where samples are too few for them.
        let mut fields: Vec<NumberField> = NUTATION.numbers().collect();
        let mut averaged = Vec::new();
        for figure in figures {
            fields.extend(figure.needs);
            if figure.has_means {
                averaged.extend(
                    figure
                        .needs
                        .iter()
                        .filter(|field| field.topic() != NUTATION),
                );
            }
        }
        Self::collect(subject.into(), name, fields, &averaged, progress)
    }
}

impl Figure {
    /// The figure with this name.
    pub fn find(name: &str) -> Option<&'static Self> {
        FIGURES.iter().find(|figure| figure.name == name)
    }

    /// The first missing requirement of a run, if any.
    pub fn missing(&self, run: &RunData) -> Option<MissingData> {
        self.needs.iter().find_map(|field| run.missing(*field))
    }

    /// The reason why the figure does not apply to a run, whatever the run has recorded.
    pub fn exclusion(&self, run: &RunData) -> Option<&'static str> {
        if self.is_expected_for(run) {
            (self.exclusion)(run)
        } else {
            Some("the peg is fixed")
        }
    }

    /// Whether the figure is expected for a run.
    pub fn is_expected_for(&self, run: &RunData) -> bool {
        run.has_free_peg || !self.needs_free_peg
    }

    /// Draws the figure with a width in mm. Several runs are overlaid; missing data is omitted.
    pub fn draw(&self, runs: &[&RunData], width: f64) -> Drawing {
        let mut drawing = (self.draw)(runs, width);
        let names: Vec<_> = runs.iter().map(|run| run.name.as_str()).collect();
        drawing.title = format!("{} — {}", self.title, names.join(", "));
        drawing
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::slip::{Slip, VisitedSpeeds};
    use crate::figures::plot::drawing::{Drawing, Label, ShapeGroup};
    use crate::figures::plot::shape::{Bounds, Shape};
    use crate::figures::plot::style::FONT_SIZE;
    use crate::run::scenario::{Preset, Scenario};
    use crate::telemetry::side::Side;

    fn run(preset: &str, name: &str, duration: &str) -> RunData {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        values.set("stop.duration", duration).unwrap();
        let figures: Vec<_> = FIGURES.iter().collect();
        let scenario = Scenario::new(values).unwrap();
        RunData::read(&scenario, name, &figures, &|_| {})
    }

    fn runs() -> Vec<RunData> {
        vec![
            run("paper", "paper", "30"),
            run("paper-spin-term-only", &"a-very-long-name-".repeat(5), "40"),
            run("full-coulomb", "directory/full_{coulomb}*.mcap", "2"),
            run("frictionless", "frictionless", "2"),
        ]
    }

    fn bounds_of_label(label: &Label) -> Bounds {
        let ((x, y), text) = (label.origin, &label.text);
        let [width, above, below] = [text.width, text.above, text.below].map(|em| em * FONT_SIZE);
        if label.is_upward {
            Bounds::between((x - above, y - width), (x + below, y))
        } else {
            Bounds::between((x, y - above), (x + width, y + below))
        }
    }

    fn overlap(a: &Bounds, b: &Bounds) -> bool {
        a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom
    }

    fn check_labels(drawing: &Drawing, figure: &str) {
        let (width, height) = drawing.size();
        let frames: Vec<Bounds> = drawing.groups.iter().filter_map(frame).collect();
        for (index, label) in drawing.labels.iter().enumerate() {
            let bounds = bounds_of_label(label);
            let text = &label.text.spoken;
            let is_within = bounds.left >= 0.0
                && bounds.top >= 0.0
                && bounds.right <= width
                && bounds.bottom <= height;
            assert!(is_within, "{figure}: {text} exceeds the page: {bounds:?}");
            for other in &drawing.labels[index + 1..] {
                let overlaps = overlap(&bounds, &bounds_of_label(other));
                assert!(!overlaps, "{figure}: {text} covers {}", other.text.spoken);
            }
            for frame in &frames {
                assert!(!overlap(&bounds, frame), "{figure}: {text} is in a frame");
            }
        }
    }

    /// The bounds of a plot.
    fn frame(group: &ShapeGroup) -> Option<Bounds> {
        match group.shapes.first() {
            Some(Shape::Line { points, .. }) if group.meaning == "frame" => {
                Some(Bounds::between(points[0], points[2]))
            }
            _ => None,
        }
    }

    #[test]
    fn labels_neither_overlap_nor_exceed_the_page() {
        let runs = runs();
        let mut sets: Vec<Vec<&RunData>> = runs.iter().map(|run| vec![run]).collect();
        sets.push(runs.iter().collect());
        for figure in FIGURES {
            for runs in sets.iter().filter(|runs| runs.len() >= figure.min_runs) {
                for width in [80.0, 85.0, 129.0, 130.0, 170.0, 400.0] {
                    let name = format!("{} of {} runs, {width} mm", figure.name, runs.len());
                    check_labels(&figure.draw(runs, width), &name);
                }
            }
        }
    }

    #[test]
    fn labels_of_laws_neither_overlap_nor_exceed_the_page() {
        let mut laws = Vec::new();
        for name in ["paper", "viscous", "stribeck", "contensou", "frictionless"] {
            let values = Preset::find(name).unwrap().values().unwrap();
            laws.push(LawCurve::new(name, &Scenario::new(values).unwrap()));
        }
        for count in 1..=laws.len() {
            check_labels(&draw_laws(&laws[laws.len() - count..], 120.0), "laws");
        }
        let mut visited = VisitedSpeeds::new(1e-3);
        for sample in 1..=500 {
            visited.add(1e-3 * f64::from(sample), 0.03);
        }
        let slip = Slip {
            visited,
            ..Slip::default()
        };
        let mut pair = Vec::new();
        for (law, side) in laws.into_iter().zip(Side::BOTH) {
            pair.push(law.for_side(side, Some(&slip)));
        }
        check_labels(&draw_laws(&pair, 120.0), "laws of two runs");
    }

    #[test]
    fn lines_stay_on_the_page() {
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
