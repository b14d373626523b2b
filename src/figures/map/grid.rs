//! Runs on a grid of values, and the boundary of those that loop.

use super::axis_values::AxisValues;
use super::bar::OVERLAP;
use super::runs::{Map, MapAxis, MapRun};
use crate::figures::error::FigureError;
use crate::figures::plot::frame::Frame;
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{self, MEDIUM};

/// Length of the ticks on the boundary of looping runs, mm.
const BORDER_TICK: f64 = 0.9;

/// The runs in the cells of a grid.
pub(super) struct Grid<'a> {
    /// The run in each cell, row by row upward.
    cells: Vec<Option<&'a MapRun>>,
    columns: usize,
    /// The positions of the ends of the columns and of the rows.
    edges: [Vec<f64>; 2],
}

/// A border between two cells of which exactly one loops.
pub(super) struct Border {
    /// The positions of its ends.
    ends: [Point; 2],
    /// The direction of the cell that loops, to the right and upward.
    inward: (f64, f64),
}

impl<'a> Grid<'a> {
    /// The grid of the runs of a map; `None` if they don't form a grid.
    pub(super) fn new(
        map: &'a Map,
        y: &MapAxis,
        axes: [&AxisValues; 2],
    ) -> Result<Option<Self>, FigureError> {
        let [columns, rows] = axes.map(|axis| axis.values.len());
        // A grid may have holes; a sample has about as many distinct values as runs.
        if columns * rows > 2 * map.runs.len() {
            return Ok(None);
        }
        let mut cells = vec![None; columns * rows];
        for run in &map.runs {
            // Runs without a value along an axis are left out before.
            let [Some(column), Some(row)] = [axes[0].index(run.x), axes[1].index(run.y)] else {
                continue;
            };
            if cells[row * columns + column].replace(run).is_some() {
                return Err(FigureError::SameCell {
                    x: map.x.name.clone(),
                    x_value: run.x,
                    y: y.name.clone(),
                    y_value: run.y,
                });
            }
        }
        Ok(Some(Self {
            cells,
            columns,
            edges: axes.map(AxisValues::edges),
        }))
    }

    /// The areas of the cells: neighbours of one colour are one area, which makes smaller files.
    pub(super) fn areas(&self, frame: &Frame, colour: impl Fn(&MapRun) -> Colour) -> Vec<Shape> {
        let [xs, ys] = &self.edges;
        let mut areas = Vec::new();
        for (row, cells) in self.cells.chunks(self.columns).enumerate() {
            let colours: Vec<_> = cells.iter().map(|run| run.map(&colour)).collect();
            let mut start = 0;
            for part in colours.chunk_by(|one, other| one == other) {
                let end = start + part.len();
                if let Some(fill) = part[0] {
                    let (left, bottom) = frame.place((xs[start], ys[row]));
                    let (right, top) = frame.place((xs[end], ys[row + 1]));
                    let upper_left = (left, (top - OVERLAP).max(frame.bounds.top));
                    let lower_right = ((right + OVERLAP).min(frame.bounds.right), bottom);
                    areas.push(Bounds::between(upper_left, lower_right).area(fill));
                }
                start = end;
            }
        }
        areas
    }

    /// The borders between cells, only one of which loops, where both are known.
    pub(super) fn borders(&self) -> Vec<Border> {
        let [xs, ys] = &self.edges;
        let mut borders = Vec::new();
        for cell in 0..self.cells.len() {
            let (column, row) = (cell % self.columns, cell / self.columns);
            let Some(loops) = self.loops(column, row) else {
                continue;
            };
            let corner = (xs[column + 1], ys[row + 1]);
            let right = (self.loops(column + 1, row), (corner.0, ys[row]), (1.0, 0.0));
            let above = (
                self.loops(column, row + 1),
                (xs[column], corner.1),
                (0.0, 1.0),
            );
            for (neighbour_loops, from, (x, y)) in [right, above] {
                if neighbour_loops.is_none_or(|neighbour| neighbour == loops) {
                    continue;
                }
                // Towards this cell if it is the one that loops, else towards the neighbour.
                let sign = if loops { -1.0 } else { 1.0 };
                borders.push(Border {
                    ends: [from, corner],
                    inward: (sign * x, sign * y),
                });
            }
        }
        borders
    }

    /// Whether the run in a cell loops; `None` if that is not known, or outside the grid.
    fn loops(&self, column: usize, row: usize) -> Option<bool> {
        if column >= self.columns {
            return None;
        }
        let run = self.cells.get(row * self.columns + column)?.as_ref()?;
        run.loops
    }
}

impl Border {
    /// The line, with a tick in its middle toward the cell that loops.
    pub(super) fn shapes(&self, frame: &Frame) -> Vec<Shape> {
        let [from, to] = self.ends.map(|end| frame.place(end));
        let (x, y) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
        let (right, up) = self.inward;
        let tip = (x + right * BORDER_TICK, y - up * BORDER_TICK);
        let stroke = style::line(style::BLACK, MEDIUM);
        Shape::lines([vec![from, to], vec![(x, y), tip]], stroke)
    }
}
