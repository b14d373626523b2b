//! Maps: colours over two keys.

use super::axis_values::AxisValues;
use super::bar::Bar;
use super::chart::{self, dot, padded};
use super::grid::Grid;
use super::runs::{Map, MapAxis, MapRun};
use crate::figures::error::FigureError;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::Colour;
use crate::figures::plot::style::{self, LINE_HEIGHT, MEDIUM};

/// Draws the runs of a map as grid cells, or as dots if they don't form a grid.
pub(super) fn draw(map: &Map, y: &MapAxis, width: f64) -> Result<Drawing, FigureError> {
    let across = AxisValues::new(&map.x, map.values(|run| run.x));
    let upward = AxisValues::new(y, map.values(|run| run.y));
    let axes = [&across, &upward];
    let grid = Grid::new(map, y, axes)?;
    let borders = grid.as_ref().map_or_else(Vec::new, Grid::borders);
    let bar = Bar::new(map, width);

    let mut drawing = Drawing::new(width);
    let mut legend = Vec::new();
    for outcome in map.outcomes() {
        let words = outcome.words(&map.color.name);
        legend.push(LegendEntry::area(outcome.colour(), &words));
    }
    if !borders.is_empty() {
        let stroke = style::line(style::BLACK, MEDIUM);
        let meaning = "boundary of looping runs (ticks point inside)";
        legend.push(LegendEntry::line(stroke, meaning));
    }
    // The label of the bar stands between legend and frame.
    let bar_label = if bar.is_empty() { 0.0 } else { LINE_HEIGHT };
    let top = legend::draw_at_top(&mut drawing, &legend) + bar_label + 0.6;

    let ranges = axes.map(|axis| match &grid {
        Some(_) => extremes(axis.edges().into_iter()),
        None => padded(axis.range()),
    });
    let frame = chart::frame(width, (top, bar.room()), axes, ranges);
    let runs = if let Some(grid) = &grid {
        grid.areas(&frame, |run| colour(run, &bar))
    } else {
        map.runs
            .iter()
            .map(|run| {
                let point = (across.position(run.x), upward.position(run.y));
                dot(frame.place(point), colour(run, &bar))
            })
            .collect()
    };
    drawing.group("runs", runs);
    if !borders.is_empty() {
        let lines = borders.iter().flat_map(|border| border.shapes(&frame));
        drawing.group("where looping begins", lines.collect());
    }
    frame.finish(&mut drawing, axes.map(|axis| &axis.quantity));
    if !bar.is_empty() {
        bar.draw(&mut drawing, frame.bounds);
    }
    Ok(drawing)
}

/// The colour of a run: that of its value, or of its outcome if it has none.
fn colour(run: &MapRun, bar: &Bar) -> Colour {
    if run.color.is_finite() {
        bar.colour(run.color)
    } else {
        run.outcome().colour()
    }
}
