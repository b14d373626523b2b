//! The locus of the symmetry axis: the paper's figure 3.

mod sphere;
mod trace;

use self::sphere::Sphere;
use self::trace::Trace;
use super::data::RunData;
use super::style::{Style, run_legend, sampling_note};
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{self, Frame, Quantity};
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Stroke};
use crate::figures::plot::style::{LINE_HEIGHT, MARGIN, TWO_COLUMNS};
use crate::figures::plot::text::Text;

/// The maximum height of the sphere, relative to its width.
const MAX_HEIGHT: f64 = 0.8;

/// The distance between the parts of the figure, mm.
const GAP: f64 = 3.0;

/// The ends of several paths are magnified together if they need at most this multiple of the space of the smallest.
const MAGNIFIED_TOGETHER: f64 = 4.0;

/// The distance from the letter of a square to the legend of its run, mm.
const INDENT: f64 = 6.5;

/// The horizontal components of the axis, as axis labels.
const X: Quantity = Quantity::new("*n*_{*x*}", "");
const Y: Quantity = Quantity::new("*n*_{*y*}", "");

/// Draws the locus on the sphere, from above, and its end magnified.
pub(super) fn locus(runs: &[&RunData], width: f64) -> Drawing {
    let mut traces: Vec<Trace> = runs.iter().map(|run| Trace::new(run)).collect();
    let longest_first = longest_first(&traces);
    for (order, run) in longest_first.iter().enumerate() {
        traces[*run].stroke = Style::new(runs.len()).locus(*run, order);
    }
    let drawn: Vec<&Trace> = longest_first.iter().map(|run| &traces[*run]).collect();
    let mut drawing = Drawing::new(width);
    let mut legend = run_legend(runs, Style::run_in_legend);
    legend.extend(LegendEntry::ends());
    legend.extend(sampling_note(runs));
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE_HEIGHT + 0.6;
    let sphere = Sphere::around(&drawn);
    let squares = squares(&drawn, &traces);
    let grid = PanelGrid::new(&squares, &sphere, top, width);
    for (index, square) in squares.iter().enumerate() {
        let bounds = grid.square(index);
        let frame = Frame::square(bounds, square.ranges);
        square.draw(&mut drawing, &frame);
        let baseline = bounds.top - frame::ABOVE;
        // The sphere is part (a).
        let letter = ('b'..='z').nth(index).unwrap_or('z');
        frame::draw_letter(&mut drawing, letter, (bounds.left, baseline));
        if let Some(stroke) = square.only {
            let entry = LegendEntry::from_text(stroke, Text::plain(""));
            let sides = (bounds.left + INDENT, bounds.right);
            legend::draw(&mut drawing, &[entry], sides, baseline);
        }
    }
    sphere.draw(&mut drawing, &drawn, grid.sphere);
    frame::draw_letter(&mut drawing, 'a', (MARGIN, top - frame::ABOVE));
    drawing.height = grid.bottom(squares.len()) + MARGIN;
    drawing
}

/// The indices of paths in drawing order: the longest first with the widest line, so that others stay visible.
fn longest_first(traces: &[Trace]) -> Vec<usize> {
    let mut order: Vec<usize> = (0..traces.len()).collect();
    order.sort_by(|one, other| traces[*other].length().total_cmp(&traces[*one].length()));
    order
}

/// The places of the sphere and the squares in columns of equal width.
struct PanelGrid {
    columns: usize,
    /// The width of a column, mm.
    column: f64,
    /// The place of the sphere.
    sphere: Bounds,
    /// The places before the squares that the sphere occupies.
    skipped: usize,
    /// The upper edge of the first row of squares, mm.
    first_row: f64,
    /// The space for labels to the left of a square, mm.
    room_left: f64,
    /// The side of a square, mm.
    side: f64,
}

impl PanelGrid {
    fn new(squares: &[Square<'_>], sphere: &Sphere, top: f64, width: f64) -> Self {
        let usable = width - 2.0 * MARGIN;
        let columns = if width < TWO_COLUMNS { 2 } else { 3 };
        let column = (usable - (columns - 1) as f64 * GAP) / columns as f64;
        // The width of the tick labels to the left of a square hardly depends on its size.
        let tentative = Bounds::new((0.0, 0.0), 0.7 * column, 0.7 * column);
        let room_left = squares
            .iter()
            .map(|square| frame::room_left(&Frame::square(tentative, square.ranges).y, &Y))
            .fold(0.0, f64::max);
        let side = column - room_left - frame::ROOM_RIGHT;
        // In two columns the sphere has a row of its own; otherwise it has the first place of the first row.
        let (skipped, sphere) = if columns == 2 {
            let height = sphere.height(usable).min(MAX_HEIGHT * usable);
            (0, Bounds::new((MARGIN, top), usable, height))
        } else {
            let height = side + frame::ROOM_BELOW;
            (1, Bounds::new((MARGIN, top), column, height))
        };
        let first_row = match skipped {
            0 => sphere.bottom + LINE_HEIGHT + GAP,
            _ => top,
        };
        Self {
            columns,
            column,
            sphere,
            skipped,
            first_row,
            room_left,
            side,
        }
    }

    /// The place of the frame of a square.
    fn square(&self, index: usize) -> Bounds {
        let place = index + self.skipped;
        let column = (place % self.columns) as f64;
        let row = (place / self.columns) as f64;
        let left = MARGIN + column * (self.column + GAP) + self.room_left;
        let top = self.first_row + row * self.row_height();
        Bounds::new((left, top), self.side, self.side)
    }

    /// The distance between rows, mm: frame, labels below and letter above.
    fn row_height(&self) -> f64 {
        self.side + frame::ROOM_BELOW + LINE_HEIGHT + GAP
    }

    /// The lower edge of the last row, mm.
    fn bottom(&self, squares: usize) -> f64 {
        let rows = (squares + self.skipped).div_ceil(self.columns) as f64;
        self.first_row + rows * self.row_height() - LINE_HEIGHT - GAP
    }
}

/// A view of some paths from above.
struct Square<'a> {
    traces: Vec<&'a Trace>,
    extent: PathExtent,
    /// The range of x and of y.
    ranges: [(f64, f64); 2],
    /// The stroke of the only run shown, if there are several runs.
    only: Option<Stroke>,
}

/// The part of a path that a square shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum PathExtent {
    Whole,
    End,
}

impl PathExtent {
    /// Index of the first point of a path.
    fn first(self, trace: &Trace) -> usize {
        match self {
            Self::Whole => 0,
            Self::End => trace.end,
        }
    }
}

/// The whole paths from above in drawing order, and their magnified ends (together if possible, otherwise separately).
fn squares<'a>(drawn: &[&'a Trace], traces: &'a [Trace]) -> Vec<Square<'a>> {
    let mut whole = Square::new(drawn, PathExtent::Whole);
    // Centred on the vertical.
    let [x, y] = whole.ranges.map(|(low, high)| high.max(-low));
    let end = x.max(y);
    whole.ranges = [(-end, end); 2];
    let smallest = traces
        .iter()
        .map(|trace| end_size(&[trace]))
        .fold(f64::INFINITY, f64::min);
    let mut squares = vec![whole];
    if traces.len() == 1 || end_size(drawn) <= MAGNIFIED_TOGETHER * smallest {
        squares.push(Square::new(drawn, PathExtent::End));
    } else {
        for trace in traces {
            squares.push(Square {
                only: Some(trace.stroke),
                ..Square::new(&[trace], PathExtent::End)
            });
        }
    }
    squares
}

impl<'a> Square<'a> {
    fn new(traces: &[&'a Trace], extent: PathExtent) -> Self {
        Self {
            traces: traces.to_vec(),
            extent,
            ranges: ranges(traces, extent),
            only: None,
        }
    }

    fn draw(&self, drawing: &mut Drawing, frame: &Frame) {
        let mut dots = Vec::new();
        for trace in &self.traces {
            let first = self.extent.first(trace);
            let points: Vec<_> = trace.axes[first..]
                .iter()
                .map(|axis| (axis.x, axis.y))
                .collect();
            let meaning = format!("{}: projection of the locus", trace.name);
            drawing.group(&meaning, frame.path(&points, trace.stroke));
            dots.extend(trace.dots(first, |axis| frame.place((axis.x, axis.y))));
        }
        drawing.group("start and end", dots);
        frame.finish(drawing, [&X, &Y]);
    }
}

/// The ranges of x and of y of some paths.
fn ranges(traces: &[&Trace], extent: PathExtent) -> [(f64, f64); 2] {
    [0, 1].map(|component| {
        let axes = traces
            .iter()
            .flat_map(|trace| &trace.axes[extent.first(trace)..]);
        extremes(axes.map(|axis| axis[component]))
    })
}

/// The larger range of the ends of some paths, along x or y.
fn end_size(traces: &[&Trace]) -> f64 {
    let [x, y] = ranges(traces, PathExtent::End).map(|(low, high)| high - low);
    x.max(y)
}
