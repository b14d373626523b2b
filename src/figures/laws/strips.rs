//! Strips below a frame: the time that runs spent at each slip speed.

use crate::analysis::slip::VisitedSpeeds;
use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::frame::Frame;
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{FONT_SIZE, THIN, line};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::Scale;
use crate::figures::style::on_white;
use crate::telemetry::side::Side;

/// The height of a strip, and the distance between two, mm.
const HEIGHT: f64 = 8.0;
const GAP: f64 = 1.2;

/// The distance from a strip to its name, mm.
const BEFORE: f64 = 1.0;

/// Number of steps of a histogram.
const STEPS: usize = 100;

/// The opacity of the area of a histogram.
const AREA: f64 = 0.3;

/// A run with the time that it spent at each slip speed.
pub(super) struct Strip<'a> {
    pub(super) side: Side,
    pub(super) visited: &'a VisitedSpeeds,
    pub(super) colour: Colour,
}

/// Draws strips below a frame, along its horizontal axis. Returns the lowest of all frames.
pub(super) fn draw(drawing: &mut Drawing, above: &Frame, strips: &[Strip<'_>]) -> Frame {
    let mut lowest = above.clone();
    for strip in strips {
        lowest = strip.frame(&lowest);
        strip.draw(drawing, &lowest);
    }
    lowest
}

impl Strip<'_> {
    /// The frame of the strip below another. Its vertical axis has no numbers: the area is the whole time.
    fn frame(&self, above: &Frame) -> Frame {
        let Bounds {
            left,
            right,
            bottom,
            ..
        } = above.bounds;
        let top = bottom + GAP;
        let highest = self.steps(&above.x).into_iter().fold(0.0, f64::max);
        let mut y = Scale::new(0.0, 1.1 * highest, 3);
        y.ticks.clear();
        y.minor.clear();
        Frame {
            bounds: Bounds::between((left, top), (right, top + HEIGHT)),
            x: above.x.clone(),
            y,
        }
    }

    fn draw(&self, drawing: &mut Drawing, frame: &Frame) {
        let outline = self.outline(frame);
        let meaning = format!("{}: time spent at each slip speed", self.side.name());
        let area = Shape::Area {
            points: outline.clone(),
            fill: on_white(self.colour, AREA),
        };
        let stroke = line(self.colour, THIN);
        let edge = Shape::Line {
            points: outline,
            stroke,
        };
        drawing.group(&meaning, vec![area, edge]);
        frame.draw(drawing);
        let Bounds {
            left, top, bottom, ..
        } = frame.bounds;
        let baseline = f64::midpoint(top, bottom) + 0.33 * FONT_SIZE;
        drawing.label(
            Text::plain(self.side.name()),
            (left - BEFORE, baseline),
            Anchor::End,
        );
    }

    /// The outline of the histogram in the drawing.
    fn outline(&self, frame: &Frame) -> Vec<Point> {
        let mut points: Vec<Point> = vec![(0.0, 0.0)];
        for (step, time) in self.steps(&frame.x).into_iter().enumerate() {
            let [from, to] = ends(&frame.x, step);
            points.extend([(from, time), (to, time)]);
        }
        points.push((frame.x.high, 0.0));
        points.into_iter().map(|point| frame.place(point)).collect()
    }

    /// The time in each step along an axis, s. The time of a bin is spread evenly over it.
    fn steps(&self, axis: &Scale) -> Vec<f64> {
        let mut times = vec![0.0; STEPS];
        for (step, time) in times.iter_mut().enumerate() {
            let [from, to] = ends(axis, step);
            for bin in self.visited.bins() {
                let common = bin.to.min(to) - bin.from.max(from);
                *time += bin.time * common.max(0.0) / (bin.to - bin.from);
            }
        }
        times
    }
}

/// The ends of a step along an axis. The first begins without slip.
fn ends(axis: &Scale, step: usize) -> [f64; 2] {
    let width = axis.high / STEPS as f64;
    [step, step + 1].map(|end| end as f64 * width)
}
