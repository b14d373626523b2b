//! The locus of the symmetry axis: the paper's figure 3.

mod sphere;
mod trace;

use self::sphere::Sphere;
use self::trace::{Direction, Trace};
use super::looks::{self, Looks};
use super::run::Run;
use crate::analysis::plot::drawing::Drawing;
use crate::analysis::plot::frame::{self, Frame, Quantity, extremes};
use crate::analysis::plot::legend::{self, Entry};
use crate::analysis::plot::shape::{Bounds, Point};
use crate::analysis::plot::style::{LINE, MARGIN, TWO_COLUMNS};

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
    let looks = Looks { runs: runs.len() };
    let traces = runs.iter().enumerate();
    let traces: Vec<_> = traces
        .map(|(index, run)| Trace::of(run, looks.locus(index)))
        .collect();
    let ends: Vec<_> = traces.iter().map(Trace::end).collect();
    let mut drawing = Drawing::new(width);
    let mut legend = looks::legend(runs, Looks::run_in_legend);
    legend.extend([Entry::dot(false, "start"), Entry::dot(true, "end")]);
    let top = legend::draw_at_top(&mut drawing, &legend) + LINE + 0.6;
    let usable = width - 2.0 * MARGIN;
    let sphere = Sphere::around(&traces);
    let squares = [traces.as_slice(), ends.as_slice()];
    let (bounds, below) = if width < TWO_COLUMNS {
        let bounds = boxed(
            (MARGIN, top),
            usable,
            sphere.height(usable).min(TALLEST * usable),
        );
        let share = (usable - GAP) / 2.0;
        let top = bounds.bottom + LINE + GAP;
        let places = [MARGIN, MARGIN + share + GAP].map(|left| (left, top));
        (bounds, draw_squares(&mut drawing, squares, places, share))
    } else {
        let share = (usable - 2.0 * GAP) / 3.0;
        let places = [1.0, 2.0].map(|column| (MARGIN + column * (share + GAP), top));
        let below = draw_squares(&mut drawing, squares, places, share);
        (boxed((MARGIN, top), share, below - top), below)
    };
    sphere.draw(&mut drawing, &traces, bounds);
    frame::draw_letter(&mut drawing, 'a', (MARGIN, top - frame::ABOVE));
    drawing.height = below + MARGIN;
    drawing
}

fn boxed((left, top): Point, width: f64, height: f64) -> Bounds {
    Bounds {
        left,
        top,
        right: left + width,
        bottom: top + height,
    }
}

/// Draws the projections, and returns where the room below them begins, mm.
fn draw_squares(
    drawing: &mut Drawing,
    traces: [&[Trace]; 2],
    places: [Point; 2],
    width: f64,
) -> f64 {
    let ranges = [around_origin(traces[0]), ranges(traces[1])];
    // The room that the numbers need hardly depends on the size of the frame.
    let room = |range| {
        let frame = Frame::square(boxed((0.0, 0.0), 0.7 * width, 0.7 * width), range);
        frame::room_left(&frame.y, Y)
    };
    let room = ranges.map(room).into_iter().fold(0.0, f64::max);
    let side = width - room - frame::ROOM_RIGHT;
    for (index, (left, top)) in places.into_iter().enumerate() {
        let bounds = boxed((left + room, top), side, side);
        let frame = Frame::square(bounds, ranges[index]);
        draw_square(drawing, &frame, traces[index]);
        let place = (bounds.left, top - frame::ABOVE);
        frame::draw_letter(drawing, ['b', 'c'][index], place);
    }
    places[0].1 + side + frame::ROOM_BELOW
}

fn draw_square(drawing: &mut Drawing, frame: &Frame, traces: &[Trace]) {
    for trace in traces {
        let meaning = format!("{}: projection of the locus", trace.name);
        drawing.group(&meaning, frame.path(&trace.projected(), trace.stroke));
    }
    let place = |axis: &Direction| frame.place((axis[0], axis[1]));
    let dots = traces.iter().flat_map(|trace| trace.dots(place));
    drawing.group("start and end", dots.collect());
    frame.draw(drawing);
    frame.name_x(drawing, X);
    frame.name_y(drawing, Y, frame::ticks_width(&frame.y));
}

/// The ranges of x and of y.
fn ranges(traces: &[Trace]) -> [(f64, f64); 2] {
    [0, 1].map(|component| {
        let axes = traces.iter().flat_map(|trace| &trace.axes);
        extremes(axes.map(|axis| axis[component]))
    })
}

/// The ranges of x and of y, made equal and even about the vertical.
fn around_origin(traces: &[Trace]) -> [(f64, f64); 2] {
    let ends = ranges(traces).map(|(low, high)| high.max(-low));
    let end = ends[0].max(ends[1]);
    [(-end, end); 2]
}
