//! The locus of the symmetry axis: the paper's figure 3.

mod sphere;
mod trace;

use self::sphere::Sphere;
use self::trace::{Direction, Trace};
use super::looks::{self, Looks};
use super::run::Run;
use crate::analysis::plot::drawing::Drawing;
use crate::analysis::plot::frame::{self, Frame, Quantity};
use crate::analysis::plot::legend::{self, Entry};
use crate::analysis::plot::range::extremes;
use crate::analysis::plot::shape::{Bounds, Stroke};
use crate::analysis::plot::style::{LINE, MARGIN, TWO_COLUMNS};
use crate::analysis::plot::text::Text;

/// The greatest height of the sphere, as a part of its width.
const TALLEST: f64 = 0.8;

/// The distance between the parts of the figure, mm.
const GAP: f64 = 3.0;

/// The horizontal components of the axis, as on axes.
const X: Quantity = Quantity {
    symbol: "*n*_{*x*}",
    unit: "",
};
const Y: Quantity = Quantity {
    symbol: "*n*_{*y*}",
    unit: "",
};

/// Draws the locus on the sphere, from above, and its end magnified.
pub(super) fn locus(runs: &[&Run], width: f64) -> Drawing {
    let traces = traces(runs);
    let mut drawn: Vec<_> = traces.iter().collect();
    drawn.sort_by_key(|trace| trace.order);
    let mut drawing = Drawing::new(width);
    let mut legend = looks::legend(runs, |_, run| Looks::run_in_legend(run));
    legend.extend([Entry::dot(false, "start"), Entry::dot(true, "end")]);
    legend.extend(looks::note(runs));
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE + 0.6;
    let usable = width - 2.0 * MARGIN;
    let sphere = Sphere::around(&drawn);
    let squares = squares(&drawn, &traces);
    let sphere_height = sphere.height(usable).min(TALLEST * usable);
    let (bounds, below) = if width < TWO_COLUMNS {
        let bounds = Bounds::new((MARGIN, top), usable, sphere_height);
        let grid = Grid {
            columns: 2,
            width: (usable - GAP) / 2.0,
            skipped: 0,
            top: bounds.bottom + LINE + GAP,
        };
        (bounds, grid.draw(&mut drawing, &squares))
    } else {
        let grid = Grid {
            columns: 3,
            width: (usable - 2.0 * GAP) / 3.0,
            skipped: 1,
            top,
        };
        let below = grid.draw(&mut drawing, &squares);
        let height = grid.row_height(&squares);
        (Bounds::new((MARGIN, top), grid.width, height), below)
    };
    sphere.draw(&mut drawing, &drawn, bounds);
    frame::draw_letter(&mut drawing, 'a', (MARGIN, top - frame::ABOVE));
    drawing.height = below + MARGIN;
    drawing
}

/// A view of some paths from above.
struct Square<'a> {
    traces: Vec<&'a Trace>,
    /// The range of x and of y.
    ranges: [(f64, f64); 2],
    /// From when on the paths are drawn.
    from: fn(&Trace) -> usize,
    /// The run that is alone in it, of several.
    only: Option<Stroke>,
}

/// The projections of the whole paths in the order of drawing, and their ends magnified: together if that magnifies each,
/// else one by one.
fn squares<'a>(drawn: &[&'a Trace], traces: &'a [Trace]) -> Vec<Square<'a>> {
    let size = |traces: &[&Trace]| {
        let [x, y] = ranges(traces, Trace::end).map(|(low, high)| high - low);
        x.max(y)
    };
    let whole = Square {
        traces: drawn.to_vec(),
        ranges: around_origin(drawn),
        from: |_| 0,
        only: None,
    };
    let magnified = |traces: &[&'a Trace]| Square {
        traces: traces.to_vec(),
        ranges: ranges(traces, Trace::end),
        from: Trace::end,
        only: None,
    };
    let smallest = traces.iter().map(|trace| size(&[trace]));
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    if traces.len() == 1 || size(drawn) <= MAGNIFIED_TOGETHER * smallest {
        return vec![whole, magnified(drawn)];
    }
    let alone = traces.iter().map(|trace| Square {
        only: Some(trace.stroke),
        ..magnified(&[trace])
    });
    std::iter::once(whole).chain(alone).collect()
}

/// The paths of the runs. What covers most is drawn first and with the broadest line, so that the others show.
fn traces(runs: &[&Run]) -> Vec<Trace> {
    let looks = Looks { runs: runs.len() };
    let mut traces: Vec<_> = runs.iter().map(|run| Trace::of(run)).collect();
    let mut longest: Vec<usize> = (0..runs.len()).collect();
    longest.sort_by(|one, other| traces[*other].length().total_cmp(&traces[*one].length()));
    for (order, run) in longest.into_iter().enumerate() {
        traces[run].order = order;
        traces[run].stroke = looks.locus(run, order);
    }
    traces
}

/// The ends of several paths are magnified together if they take at most this multiple of the room of the smallest.
const MAGNIFIED_TOGETHER: f64 = 4.0;

/// The places of squares in the drawing: in rows, from left to right.
struct Grid {
    columns: usize,
    /// The width of a column, mm.
    width: f64,
    /// The places of the first row that are taken.
    skipped: usize,
    top: f64,
}

impl Grid {
    /// Draws squares, and returns where the room below them begins, mm.
    fn draw(&self, drawing: &mut Drawing, squares: &[Square<'_>]) -> f64 {
        let (room, side) = (self.room_left(squares), self.side(squares));
        let row = self.row_height(squares) + LINE + GAP;
        for (index, square) in squares.iter().enumerate() {
            let place = index + self.skipped;
            let (column, line) = (place % self.columns, place / self.columns);
            let left = MARGIN + column as f64 * (self.width + GAP) + room;
            let top = self.top + line as f64 * row;
            let frame = Frame::square(Bounds::new((left, top), side, side), square.ranges);
            square.draw(drawing, &frame);
            let baseline = top - frame::ABOVE;
            let letter = ('b'..='z').nth(index).unwrap_or('z');
            frame::draw_letter(drawing, letter, (left, baseline));
            let key: Vec<_> = square
                .only
                .map(|stroke| Entry::of(stroke, Text::plain("")))
                .into_iter()
                .collect();
            legend::draw(drawing, &key, (left + KEY, left + side), baseline);
        }
        let lines = (squares.len() + self.skipped).div_ceil(self.columns);
        self.top + lines as f64 * row - LINE - GAP
    }

    /// The room that the numbers to the left of a square take, mm.
    fn room_left(&self, squares: &[Square<'_>]) -> f64 {
        // The room that the numbers need hardly depends on the size of the frame.
        let bounds = Bounds::new((0.0, 0.0), 0.7 * self.width, 0.7 * self.width);
        let frames = squares
            .iter()
            .map(|square| Frame::square(bounds, square.ranges));
        frames.map(|frame| frame.room_left(Y)).fold(0.0, f64::max)
    }

    fn side(&self, squares: &[Square<'_>]) -> f64 {
        self.width - self.room_left(squares) - frame::ROOM_RIGHT
    }

    fn row_height(&self, squares: &[Square<'_>]) -> f64 {
        self.side(squares) + frame::ROOM_BELOW
    }
}

/// The distance from the letter of a square to the key of its run, mm.
const KEY: f64 = 6.5;

impl Square<'_> {
    fn draw(&self, drawing: &mut Drawing, frame: &Frame) {
        for trace in &self.traces {
            let meaning = format!("{}: projection of the locus", trace.name);
            let points = trace.projected((self.from)(trace));
            drawing.group(&meaning, frame.path(&points, trace.stroke));
        }
        let place = |axis: &Direction| frame.place((axis[0], axis[1]));
        let dots = self
            .traces
            .iter()
            .flat_map(|trace| trace.dots((self.from)(trace), place));
        drawing.group("start and end", dots.collect());
        frame.draw_with_names(drawing, [X, Y]);
    }
}

/// The ranges of x and of y, from some point of each path on.
fn ranges(traces: &[&Trace], from: fn(&Trace) -> usize) -> [(f64, f64); 2] {
    [0, 1].map(|component| {
        let axes = traces.iter().flat_map(|trace| &trace.axes[from(trace)..]);
        extremes(axes.map(|axis| axis[component]))
    })
}

/// The ranges of x and of y, made equal and even about the vertical.
fn around_origin(traces: &[&Trace]) -> [(f64, f64); 2] {
    let ends = ranges(traces, |_| 0).map(|(low, high)| high.max(-low));
    let end = ends[0].max(ends[1]);
    [(-end, end); 2]
}
