//! Maps: colours over two keys.

use super::along::Along;
use super::bar::Bar;
use super::chart::{self, aired, dot};
use super::grid::{Grid, border_shapes};
use super::runs::{Map, MapAxis, MapRun, outcome_colour};
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::legend::{self, Entry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::style::{self, LINE, MEDIUM};

/// Draws the runs of a map as grid cells, or as dots if they don't form a grid.
pub(super) fn draw(map: &Map, y: &MapAxis, width: f64) -> Result<Drawing, String> {
    let across = Along::new(&map.x, map.values(|run| run.x));
    let upward = Along::new(y, map.values(|run| run.y));
    let axes = [&across, &upward];
    let grid = Grid::of(map, y, axes)?;
    let bar = Bar::new(map, width);
    let colour = |run: &MapRun| {
        if run.color.is_finite() {
            bar.colour(run.color)
        } else {
            outcome_colour(run.outcome())
        }
    };

    let mut drawing = Drawing::new(width);
    let outcomes = map.outcomes().into_iter();
    let mut key: Vec<_> = outcomes
        .map(|(words, colour)| Entry::area(colour, &words))
        .collect();
    let borders = grid.as_ref().map_or_else(Vec::new, Grid::borders);
    if !borders.is_empty() {
        let stroke = style::line(style::BLACK, MEDIUM);
        let words = "boundary of looping runs (ticks point inside)";
        key.push(Entry::line(stroke, words));
    }
    let bar_label = if bar.is_empty() { 0.0 } else { LINE };
    let top = legend::draw_at_top(&mut drawing, &key) + bar_label + 0.6;

    let ranges = axes.map(|axis| match &grid {
        Some(_) => extremes(axis.edges().into_iter()),
        None => aired(axis.range()),
    });
    let frame = chart::frame(width, (top, bar.room()), axes, ranges);
    if let Some(grid) = &grid {
        drawing.group("runs", grid.areas(&frame, colour));
    } else {
        let place = |run: &MapRun| frame.place((across.place(run.x), upward.place(run.y)));
        let dots = map.runs.iter().map(|run| dot(place(run), colour(run)));
        drawing.group("runs", dots.collect());
    }
    if !borders.is_empty() {
        let lines = borders
            .iter()
            .flat_map(|border| border_shapes(border, &frame));
        drawing.group("where looping begins", lines.collect());
    }
    frame.finish(&mut drawing, axes.map(|axis| &axis.quantity));
    if !bar.is_empty() {
        bar.draw(&mut drawing, frame.bounds);
    }
    Ok(drawing)
}
