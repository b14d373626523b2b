//! Curves of runs over time, and the pages that show them.

use crate::figures::data::RunData;
use crate::figures::plot::frame::{Band, Quantity};
use crate::figures::plot::legend::LegendEntry;
use crate::figures::plot::page::{Page, Panel};
use crate::figures::plot::shape::{Point, Stroke};
use crate::figures::style::{PALE, Style, run_legend};
use crate::telemetry::fields::{NumberField, nutation};

/// Time, as an axis label.
const TIME: Quantity = Quantity::new("*t*", "s");

/// A page of panels over the same time.
pub(super) fn page(legend: Vec<LegendEntry>, panels: Vec<Panel>) -> Page {
    Page {
        x: TIME,
        legend,
        panels,
        shares_x: true,
    }
}

/// Adds a curve of each run to a panel.
pub(super) fn add_curves(
    panel: &mut Panel,
    runs: &[&RunData],
    meaning: &str,
    points: impl Fn(&RunData) -> Vec<Point>,
    stroke: impl Fn(usize) -> Stroke,
) {
    for (index, run) in runs.iter().enumerate() {
        let meaning = format!("{}: {meaning}", run.name);
        panel.curve(meaning, points(run), stroke(index));
    }
}

/// Adds the motion of each run to a panel.
pub(super) fn add_motions(panel: &mut Panel, runs: &[&RunData], field: NumberField) {
    let style = Style::new(runs.len());
    for (index, run) in runs.iter().enumerate() {
        add_motion(panel, run, field, style, index);
    }
}

/// Adds the motion of the run with this index to a panel, and the region in which it nutates if its samples are too few to
/// show that.
pub(super) fn add_motion(
    panel: &mut Panel,
    run: &RunData,
    field: NumberField,
    style: Style,
    index: usize,
) {
    let meaning = format!("{}: {}", run.name, field.path());
    panel.curve(meaning, run.series(field), style.motion(index));
    if run.coarse_samples_per_nutation().is_none() {
        return;
    }
    if let Some([lower, upper]) = run.envelope(field) {
        panel.envelopes.push(Band {
            meaning: format!("{}: {}, range in each nutation", run.name, field.path()),
            lower,
            upper,
            fill: style.envelope(index),
        });
    }
}

/// Adds the recorded averages over nutations of a field of each run to a panel.
pub(super) fn add_averages(
    panel: &mut Panel,
    runs: &[&RunData],
    field: NumberField,
    mean: NumberField,
) {
    let style = Style::new(runs.len());
    add_curves(
        panel,
        runs,
        &format!("average of {}", field.path()),
        |run| run.averages(mean),
        |run| style.average(run),
    );
}

/// Whether these points form a line.
pub(super) fn is_line(points: &[Point]) -> bool {
    let finite = points.iter().filter(|point| point.1.is_finite());
    finite.take(2).count() == 2
}

/// The legend of runs and their averages.
pub(super) fn motion_legend(runs: &[&RunData]) -> Vec<LegendEntry> {
    let style = Style::new(runs.len());
    let has_averages = runs
        .iter()
        .any(|run| is_line(&run.averages(nutation::THETA_MEAN)));
    if runs.len() == 1 {
        let mut legend = vec![LegendEntry::line(style.motion(0), "simulation")];
        if has_averages {
            let average = LegendEntry::line(style.average(0), "average over each nutation");
            legend.push(average);
        }
        return legend;
    }
    let mut legend = run_legend(runs, |run| style.average(run));
    let motion = if has_averages {
        "simulation; lines: averages over nutations"
    } else {
        "simulation"
    };
    legend.push(LegendEntry::area(PALE, motion));
    legend
}
