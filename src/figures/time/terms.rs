//! Figures of several quantities in each panel: accelerations, torques, slip, energies, hops.

use super::curves::{add_curves, is_line, page};
use crate::figures::data::RunData;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::page::{Curve, Panel};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::Point;
use crate::figures::style::{PALE, Style, run_legend, sampling_note};
use crate::telemetry::fields::{
    NumberField, acceleration as accelerations, contact, energy as energies, free_peg,
    torque as torques,
};

/// Mean accelerations below this fraction of the gravity term are integration errors.
const NEGLIGIBLE: f64 = 1e-6;

/// Relative energy changes below this are integration errors.
const CONSERVED: f64 = 1e-9;

/// A panel that shows several quantities of all runs, with a legend of the quantities.
struct Terms<'a> {
    panel: Panel,
    runs: &'a [&'a RunData],
    count: usize,
    /// Number of bands of rapidly oscillating quantities, drawn below all lines.
    bands: usize,
}

impl<'a> Terms<'a> {
    fn new(runs: &'a [&'a RunData], symbol: &'static str, unit: &'static str) -> Self {
        Self {
            panel: Panel::new(symbol, unit),
            runs,
            count: 0,
            bands: 0,
        }
    }

    /// Adds a number; `name` is markup. If it oscillates too fast to be resolved, it is drawn as a pale band with its
    /// average as a line.
    fn number(mut self, name: &str, field: NumberField) -> Self {
        let style = Style::new(self.runs.len());
        // Bands come before all lines, so that none hides the average of another quantity.
        for (index, run) in self.runs.iter().enumerate() {
            if averages_of_band(run, field).is_some() {
                let band = Curve {
                    meaning: format!("{}: {}", run.name, field.path()),
                    points: run.series(field),
                    stroke: style.ripple(index, self.count),
                };
                self.panel.curves.insert(self.bands, band);
                self.bands += 1;
            }
        }
        self.term(name, |run| {
            averages_of_band(run, field).unwrap_or_else(|| run.series(field))
        })
    }

    /// Adds the mean of a number over each nutation; `name` is markup.
    fn mean(self, name: &str, field: NumberField) -> Self {
        self.term(name, |run| run.means(field))
    }

    /// Adds a quantity; `name` is markup.
    fn term(mut self, name: &str, points: impl Fn(&RunData) -> Vec<Point>) -> Self {
        let style = Style::new(self.runs.len());
        let count = self.count;
        let entry = LegendEntry::line(style.term_in_legend(count), name);
        let first = self.panel.curves.len();
        add_curves(
            &mut self.panel,
            self.runs,
            &entry.text.spoken,
            points,
            |run| style.term(run, count),
        );
        let is_drawn = self.panel.curves[first..]
            .iter()
            .any(|curve| is_line(&curve.points));
        if is_drawn {
            self.panel.legend.push(entry);
        }
        self.count += 1;
        self
    }
}

/// The averages of a quantity whose fast oscillation fills a band.
fn averages_of_band(run: &RunData, field: NumberField) -> Option<Vec<Point>> {
    let (points, averages) = (run.series(field), run.means(field));
    let (low, high) = extremes(points.iter().map(|point| point.1));
    // A line that goes up and down by more than its whole range, beyond its averages, fills a band.
    let is_band = total_variation(&points) - total_variation(&averages) > high - low;
    (is_band && is_line(&averages)).then_some(averages)
}

/// The sum of all changes of a curve, upward and downward.
fn total_variation(points: &[Point]) -> f64 {
    points
        .windows(2)
        .map(|pair| (pair[1].1 - pair[0].1).abs())
        .filter(|change| change.is_finite())
        .sum()
}

/// Draws panels with several quantities each.
fn draw(runs: &[&RunData], width: f64, panels: Vec<Terms<'_>>) -> Drawing {
    let mut legend = run_legend(runs, Style::run_in_legend);
    if panels.iter().any(|terms| terms.bands > 0) {
        legend.push(LegendEntry::area(
            PALE,
            "nutation; the line in it: its average",
        ));
    }
    legend.extend(sampling_note(runs));
    let all = panels.into_iter().map(|terms| terms.panel).collect();
    page(legend, without_zeros(all)).draw(width)
}

/// The panels in which something differs from zero; all of them if nothing does, because then that is what the figure
/// shows.
fn without_zeros(panels: Vec<Panel>) -> Vec<Panel> {
    if panels.iter().all(Panel::is_zero) {
        return panels;
    }
    panels
        .into_iter()
        .filter(|panel| !panel.is_zero())
        .collect()
}

/// The greatest magnitude on some curves.
fn max_magnitude(curves: impl Iterator<Item = Vec<Point>>) -> f64 {
    extremes(curves.flatten().map(|point| point.1.abs())).1
}

/// The terms of θ̈ and φ̈, averaged over nutations.
pub(crate) fn acceleration(runs: &[&RunData], width: f64) -> Drawing {
    let theta = Terms::new(runs, "mean *θ\u{308}*", "rad/s²")
        .mean("gravitational", accelerations::THETA_DDOT_GRAVITATIONAL)
        .mean("gyroscopic", accelerations::THETA_DDOT_GYROSCOPIC)
        .mean("centrifugal", accelerations::THETA_DDOT_CENTRIFUGAL)
        .mean("frictional", accelerations::THETA_DDOT_FRICTIONAL);
    let mut phi = Terms::new(runs, "mean *φ\u{308}*", "rad/s²")
        .mean("frictional", accelerations::PHI_DDOT_FRICTIONAL)
        .mean("gyroscopic", accelerations::PHI_DDOT_GYROSCOPIC)
        .mean("Coriolis", accelerations::PHI_DDOT_CORIOLIS);
    let gravity = runs
        .iter()
        .map(|run| run.means(accelerations::THETA_DDOT_GRAVITATIONAL));
    phi.panel.rounding = NEGLIGIBLE * max_magnitude(gravity);
    // Near the vertical, φ̈ diverges.
    phi.panel.is_singular = true;
    draw(runs, width, vec![theta, phi])
}

/// The torques in the node frame.
pub(crate) fn torque(runs: &[&RunData], width: f64) -> Drawing {
    let gravity =
        Terms::new(runs, "*τ*", "N m").number("gravity, *τ*_{*x*}", torques::GRAVITY_NODE.x());
    let friction = Terms::new(runs, "*τ*", "N m")
        .number("friction, *τ*_{*y*}", torques::FRICTION_NODE.y())
        .number("*τ*_{*z*}", torques::FRICTION_NODE.z())
        .number("*τ*_{*x*}", torques::FRICTION_NODE.x());
    draw(runs, width, vec![gravity, friction])
}

/// The slip speed and the slip path.
pub(crate) fn slip(runs: &[&RunData], width: f64) -> Drawing {
    let speed = Terms::new(runs, "|*v*|", "m/s").number("slip speed", contact::SLIP_SPEED);
    let path = Terms::new(runs, "*s*", "m").number("slip path", contact::SLIP_PATH);
    draw(runs, width, vec![speed, path])
}

/// The normal force and the height of the peg above the table.
pub(crate) fn hops(runs: &[&RunData], width: f64) -> Drawing {
    let force = Terms::new(runs, "*N*", "N").number("normal force", contact::NORMAL_FORCE);
    let gap = Terms::new(runs, "*h*", "m").number("height of the peg", free_peg::GAP);
    draw(runs, width, vec![force, gap])
}

/// The energies, and the work and power of friction.
pub(crate) fn energy(runs: &[&RunData], width: f64) -> Drawing {
    let kinetic = Terms::new(runs, "*E*", "J")
        .number("total", energies::TOTAL)
        .number("kinetic", energies::KINETIC);
    let potential = Terms::new(runs, "*E*", "J").number("potential", energies::POTENTIAL);
    let mut work = Terms::new(runs, "Δ*E*", "J")
        .term("change of the total", change_of_energy)
        .number("work of friction", energies::FRICTION_WORK);
    // A conserved energy would otherwise be magnified until its rounding errors fill the axis.
    let kinetic_energies = runs.iter().map(|run| run.series(energies::KINETIC));
    work.panel.rounding = CONSERVED * max_magnitude(kinetic_energies);
    let power = Terms::new(runs, "*P*", "W").number("power of friction", energies::FRICTION_POWER);
    draw(runs, width, vec![kinetic, potential, work, power])
}

/// The total energy relative to its initial value, J.
fn change_of_energy(run: &RunData) -> Vec<Point> {
    let mut total = run.series(energies::TOTAL);
    let start = total.first().map_or(0.0, |point| point.1);
    for point in &mut total {
        point.1 -= start;
    }
    total
}
