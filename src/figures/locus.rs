//! The locus of the symmetry axis: the paper's figure 3.

mod sphere;
mod trace;

use self::sphere::Sphere;
use self::trace::{Direction, Trace};
use super::looks::{self, Looks};
use super::run::Run;
use crate::figures::plot::drawing::Drawing;
use crate::figures::plot::frame::{self, Frame, Quantity};
use crate::figures::plot::legend::{self, Entry};
use crate::figures::plot::range::extremes;
use crate::figures::plot::shape::{Bounds, Stroke};
use crate::figures::plot::style::{LINE, MARGIN, TWO_COLUMNS};
use crate::figures::plot::text::Text;

/// The maximum height of the sphere, relative to its width.
const TALLEST: f64 = 0.8;

/// The distance between the parts of the figure, mm.
const GAP: f64 = 3.0;

/// The horizontal components of the axis, as axis labels.
const X: Quantity = Quantity::new("*n*_{*x*}", "");
const Y: Quantity = Quantity::new("*n*_{*y*}", "");

/// Draws the locus on the sphere, from above, and its end magnified.
pub(super) fn locus(runs: &[&Run], width: f64) -> Drawing {
    let looks = Looks { runs: runs.len() };
    let mut traces: Vec<_> = runs.iter().map(|run| Trace::of(run)).collect();
    // The longest path is drawn first with the widest line, so that others stay visible.
    let mut longest: Vec<usize> = (0..runs.len()).collect();
    longest.sort_by(|one, other| traces[*other].length().total_cmp(&traces[*one].length()));
    for (order, run) in longest.iter().enumerate() {
        traces[*run].stroke = looks.locus(*run, order);
    }
    let drawn: Vec<_> = longest.into_iter().map(|run| &traces[run]).collect();
    let mut drawing = Drawing::new(width);
    let mut legend = looks::legend(runs, Looks::run_in_legend);
    legend.extend(Entry::ends());
    legend.extend(looks::note(runs));
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE + 0.6;
    let usable = width - 2.0 * MARGIN;
    let sphere = Sphere::around(&drawn);
    let squares = squares(&drawn, &traces);
    let (columns, skipped) = if width < TWO_COLUMNS { (2, 0) } else { (3, 1) };
    let column = (usable - (columns - 1) as f64 * GAP) / columns as f64;
    // The space for the numbers to the left of a square hardly depends on its size.
    let bounds = Bounds::new((0.0, 0.0), 0.7 * column, 0.7 * column);
    let frames = squares.iter().map(|square| square.frame(bounds));
    let rooms = frames.map(|frame| frame::room_left(&frame.y, &Y));
    let room = rooms.fold(0.0, f64::max);
    let side = column - room - frame::ROOM_RIGHT;
    let height = side + frame::ROOM_BELOW;
    // The sphere has a row of its own, or the first place of the first row.
    let (bounds, first_row) = if skipped == 0 {
        let height = sphere.height(usable).min(TALLEST * usable);
        let bounds = Bounds::new((MARGIN, top), usable, height);
        (bounds, bounds.bottom + LINE + GAP)
    } else {
        (Bounds::new((MARGIN, top), column, height), top)
    };
    for (index, square) in squares.iter().enumerate() {
        let place = index + skipped;
        let left = MARGIN + (place % columns) as f64 * (column + GAP) + room;
        let top = first_row + (place / columns) as f64 * (height + LINE + GAP);
        let frame = square.frame(Bounds::new((left, top), side, side));
        square.draw(&mut drawing, &frame);
        let baseline = top - frame::ABOVE;
        let letter = ('b'..='z').nth(index).unwrap_or('z');
        frame::draw_letter(&mut drawing, letter, (left, baseline));
        let key = square.only.map(|stroke| Entry::of(stroke, Text::plain("")));
        let key: Vec<_> = key.into_iter().collect();
        legend::draw(&mut drawing, &key, (left + KEY, left + side), baseline);
    }
    sphere.draw(&mut drawing, &drawn, bounds);
    frame::draw_letter(&mut drawing, 'a', (MARGIN, top - frame::ABOVE));
    let rows = (squares.len() + skipped).div_ceil(columns) as f64;
    drawing.height = first_row + rows * (height + LINE + GAP) - LINE - GAP + MARGIN;
    drawing
}

/// A view of some paths from above.
struct Square<'a> {
    traces: Vec<&'a Trace>,
    /// The range of x and of y.
    ranges: [(f64, f64); 2],
    /// Time from which the paths are drawn.
    from: fn(&Trace) -> usize,
    /// The only run shown, if there are several runs.
    only: Option<Stroke>,
}

/// The projected paths in drawing order, and their magnified ends (together if possible, otherwise separately).
fn squares<'a>(drawn: &[&'a Trace], traces: &'a [Trace]) -> Vec<Square<'a>> {
    let size = |traces: &[&Trace]| {
        let [x, y] = ranges(traces, |trace| trace.end).map(|(low, high)| high - low);
        x.max(y)
    };
    let square = |traces: &[&'a Trace], from: fn(&Trace) -> usize| Square {
        traces: traces.to_vec(),
        ranges: ranges(traces, from),
        from,
        only: None,
    };
    let mut whole = square(drawn, |_| 0);
    // About the vertical.
    let ends = whole.ranges.map(|(low, high)| high.max(-low));
    let end = ends[0].max(ends[1]);
    whole.ranges = [(-end, end); 2];
    let smallest = traces.iter().map(|trace| size(&[trace]));
    let smallest = smallest.fold(f64::INFINITY, f64::min);
    if traces.len() == 1 || size(drawn) <= MAGNIFIED_TOGETHER * smallest {
        return vec![whole, square(drawn, |trace| trace.end)];
    }
    let alone = traces.iter().map(|trace| Square {
        only: Some(trace.stroke),
        ..square(&[trace], |trace| trace.end)
    });
    std::iter::once(whole).chain(alone).collect()
}

/// The ends of several paths are magnified together if they need at most this multiple of the space of the smallest.
const MAGNIFIED_TOGETHER: f64 = 4.0;

/// The distance from the letter of a square to the key of its run, mm.
const KEY: f64 = 6.5;

impl Square<'_> {
    fn frame(&self, bounds: Bounds) -> Frame {
        Frame::square(bounds, self.ranges)
    }

    fn draw(&self, drawing: &mut Drawing, frame: &Frame) {
        for trace in &self.traces {
            let meaning = format!("{}: projection of the locus", trace.name);
            let axes = trace.axes[(self.from)(trace)..].iter();
            let points: Vec<_> = axes.map(|axis| (axis.x, axis.y)).collect();
            drawing.group(&meaning, frame.path(&points, trace.stroke));
        }
        let place = |axis: &Direction| frame.place((axis.x, axis.y));
        let traces = self.traces.iter();
        let dots = traces.flat_map(|trace| trace.dots((self.from)(trace), place));
        drawing.group("start and end", dots.collect());
        frame.finish(drawing, [&X, &Y]);
    }
}

/// The ranges of x and of y, from some point of each path on.
fn ranges(traces: &[&Trace], from: fn(&Trace) -> usize) -> [(f64, f64); 2] {
    [0, 1].map(|component| {
        let axes = traces.iter().flat_map(|trace| &trace.axes[from(trace)..]);
        extremes(axes.map(|axis| axis[component]))
    })
}
