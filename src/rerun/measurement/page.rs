//! The page of a fit: for each signal, values over the fitted curve, and residuals below.

use rerun::blueprint::components::{ContainerKind, Corner2D};
use rerun::components::Name;
use rerun::external::re_sdk_types::blueprint::archetypes as parts;

use super::plots::Series;
use super::{MeasuredSignal, Measurement};
use crate::rerun::blueprint::axis::value_range;
use crate::rerun::blueprint::builder::{BlueprintLayout, Child, column};
use crate::rerun::blueprint::views::{time_series, titled};
use crate::rerun::plots::Plots;
use crate::rerun::plots::curves::Curves;

/// Heights of a chart of values and of one of residuals.
const HEIGHTS: [f32; 2] = [62.0, 38.0];

/// Maximum number of signals below each other.
const MAX_IN_COLUMN: usize = 2;

/// The page of a measurement. Its axes fit the run, too, if that is known.
pub(in crate::rerun) fn page(
    layout: &mut BlueprintLayout,
    measurement: &Measurement,
    plots: Option<&Plots>,
) -> Child {
    let mut signals = Vec::new();
    for (signal, path) in measurement.signals.iter().zip(measurement.paths()) {
        let name = signal.name(measurement);
        let values = values(layout, signal, &name, &path, plots);
        let residuals = residuals(layout, signal, &name, &path);
        signals.push(layout.contain(column(&HEIGHTS), &[values, residuals]));
    }
    let columns = if signals.len() > MAX_IN_COLUMN { 2 } else { 1 };
    let grid = parts::ContainerBlueprint::new(ContainerKind::Grid)
        .with_grid_columns(columns)
        .with_display_name(Name("Fit".into()));
    layout.contain(grid, &signals)
}

fn values(
    layout: &mut BlueprintLayout,
    signal: &MeasuredSignal,
    name: &str,
    path: &str,
    plots: Option<&Plots>,
) -> Child {
    let title = titled(&format!("{name}, measured and fitted"), signal.field.unit());
    // Where the curve isn't.
    let corner = if signal.is_rising() {
        Corner2D::LeftTop
    } else {
        Corner2D::RightTop
    };
    let contents = Series::VALUES.map(|series| series.entity(path));
    // Without the run the axis would cut off the curve between the values.
    let range = plots.and_then(|plots| value_range(with_run(signal, plots)));
    time_series(layout, &title, &contents, Some(corner), range)
}

/// The range of the values of a signal that are no outliers, and of the run.
fn with_run(signal: &MeasuredSignal, plots: &Plots) -> [f64; 2] {
    let mut range = signal.range(signal.residual_limit());
    let plot = signal.field.plot();
    for (field, (_, of_run)) in plot.numbers().zip(plots.ranges(Curves::Field(plot))) {
        if field == signal.field {
            range = [range[0].min(of_run[0]), range[1].max(of_run[1])];
        }
    }
    range
}

fn residuals(
    layout: &mut BlueprintLayout,
    signal: &MeasuredSignal,
    name: &str,
    path: &str,
) -> Child {
    let limit = signal.residual_limit();
    let mut title = format!("{name}, residual in σ (lines: 0 and ±2)");
    let beyond = signal.count_beyond(limit);
    if beyond > 0 {
        title += &format!(", {beyond} beyond ±{limit:.0}");
    }
    let contents = Series::RESIDUALS.map(|series| series.entity(path));
    // Colours are those of the chart above.
    time_series(layout, &title, &contents, None, Some([-limit, limit]))
}
