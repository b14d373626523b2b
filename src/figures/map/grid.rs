//! Runs on a grid of values, and the edge of those that loop.

use super::along::Along;
use super::bar::OVERLAP;
use super::runs::{Map, MapAxis, MapRun};
use crate::figures::plot::frame::Frame;
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{self, MEDIUM};

/// Length of the ticks on the boundary of looping runs, mm.
const EDGE_TICK: f64 = 0.9;

/// The runs in the cells of a grid.
pub(super) struct Grid<'a> {
    /// The run in each cell, row by row upward.
    cells: Vec<Option<&'a MapRun>>,
    columns: usize,
    /// The ends of the columns and of the rows.
    edges: [Vec<f64>; 2],
}

/// A border between two cells of which exactly one loops: its ends, and the direction of that cell, to the right and
/// upward.
pub(super) type Border = ([Point; 2], Point);

impl<'a> Grid<'a> {
    /// The grid of the runs of a map; `None` if they don't form a grid.
    pub(super) fn of(map: &'a Map, y: &MapAxis, axes: [&Along; 2]) -> Result<Option<Self>, String> {
        let [columns, rows] = axes.map(|axis| axis.values.len());
        // A grid may have holes; a sample has about as many distinct values as runs.
        if columns * rows > 2 * map.runs.len() {
            return Ok(None);
        }
        let mut cells = vec![None; columns * rows];
        for run in &map.runs {
            let [Some(column), Some(row)] = [axes[0].index(run.x), axes[1].index(run.y)] else {
                continue;
            };
            if cells[row * columns + column].replace(run).is_some() {
                return Err(format!(
                    "several runs have {} = {:?} and {} = {:?}: select with --where",
                    map.x.name, run.x, y.name, run.y
                ));
            }
        }
        let edges = axes.map(Along::edges);
        Ok(Some(Self {
            cells,
            columns,
            edges,
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
                let (left, bottom) = frame.place((xs[start], ys[row]));
                let (right, top) = frame.place((xs[end], ys[row + 1]));
                let top = (top - OVERLAP).max(frame.bounds.top);
                let right = (right + OVERLAP).min(frame.bounds.right);
                let bounds = Bounds::between((left, top), (right, bottom));
                areas.extend(part[0].map(|fill| bounds.area(fill)));
                start = end;
            }
        }
        areas
    }

    /// The borders between cells, only one of which loops, where both are known.
    pub(super) fn borders(&self) -> Vec<Border> {
        let [xs, ys] = &self.edges;
        let loops = |column: usize, row: usize| {
            let is_there = column < self.columns;
            let cell = self.cells.get(row * self.columns + column);
            cell.copied().flatten().filter(|_| is_there)?.loops
        };
        let mut borders = Vec::new();
        for cell in 0..self.cells.len() {
            let (column, row) = (cell % self.columns, cell / self.columns);
            let corner = (xs[column + 1], ys[row + 1]);
            let right = (loops(column + 1, row), (corner.0, ys[row]), (1.0, 0.0));
            let above = (loops(column, row + 1), (xs[column], corner.1), (0.0, 1.0));
            for (other, from, (x, y)) in [right, above] {
                if let Some((here, there)) = loops(column, row).zip(other)
                    && here != there
                {
                    let sign = if there { 1.0 } else { -1.0 };
                    borders.push(([from, corner], (sign * x, sign * y)));
                }
            }
        }
        borders
    }
}

/// The line of a border, with a tick in its middle toward the cell that loops.
pub(super) fn border_shapes((ends, (right, up)): &Border, frame: &Frame) -> [Shape; 2] {
    let [from, to] = ends.map(|end| frame.place(end));
    let (x, y) = (f64::midpoint(from.0, to.0), f64::midpoint(from.1, to.1));
    let tip = (x + right * EDGE_TICK, y - up * EDGE_TICK);
    let stroke = style::line(style::BLACK, MEDIUM);
    [vec![from, to], vec![(x, y), tip]].map(|points| Shape::Line { points, stroke })
}
