//! Frames: plots with axes, ticks and the curves within them.

use super::decimate;
use super::drawing::{Anchor, Drawing};
use super::legend;
use super::shape::{Bounds, Colour, Point, Shape, Stroke};
use super::style::{self, FONT, LINE, RESOLUTION};
use super::text::Text;
use super::ticks::Scale;

/// The lengths of ticks with and without numbers, mm.
const TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;

/// The distance from a frame to the numbers at its ticks, and from these to the label of the axis, mm.
const GAP: f64 = 1.0;

/// The room that a number at a tick needs along its axis, mm.
const TICK_ROOM_ACROSS: f64 = 11.0;
const TICK_ROOM_UP: f64 = 6.5;

/// Quantity of an axis, with its unit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Quantity {
    /// The symbol, as markup (see [`Text::markup`]).
    pub(crate) symbol: &'static str,
    /// The unit, empty for pure numbers.
    pub(crate) unit: &'static str,
}

impl Quantity {
    /// The label of an axis whose numbers are to be multiplied by a power of ten.
    pub(crate) fn text(self, exponent: i32) -> Text {
        let Self { symbol, unit } = self;
        match in_brackets(exponent, unit) {
            empty if empty.is_empty() => Text::markup(symbol),
            in_brackets => Text::markup(&format!("{symbol} ({in_brackets})")),
        }
    }
}

/// A power of ten and a unit, as markup; one is left out.
pub(crate) fn in_brackets(exponent: i32, unit: &str) -> String {
    let power = match exponent {
        0 => return unit.to_owned(),
        _ => format!("10^{{{}}}", exponent.to_string().replace('-', "−")),
    };
    if unit.is_empty() {
        power
    } else {
        format!("{power} {unit}")
    }
}

/// A shaded region between two curves over the same x.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Band {
    pub(crate) meaning: String,
    pub(crate) lower: Vec<Point>,
    pub(crate) upper: Vec<Point>,
    pub(crate) fill: Colour,
}

/// A frame with two axes.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Frame {
    pub(crate) bounds: Bounds,
    pub(crate) x: Scale,
    pub(crate) y: Scale,
}

impl Frame {
    /// The place at which a point of the data is drawn.
    pub(crate) fn place(&self, (x, y): Point) -> Point {
        let Bounds { left, bottom, .. } = self.bounds;
        (
            left + self.x.place(x) * self.bounds.width(),
            bottom - self.y.place(y) * self.bounds.height(),
        )
    }

    /// The shapes of a curve whose points are in the order of x.
    pub(crate) fn line(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places = points.iter().map(|point| self.place(*point));
        decimate::by_column(places, 1.0 / RESOLUTION)
            .iter()
            .flat_map(|line| self.bounds.clip_line(line))
            .map(|points| Shape::Line { points, stroke })
            .collect()
    }

    /// The shapes of a curve that may go anywhere.
    pub(crate) fn path(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places: Vec<_> = points.iter().map(|point| self.place(*point)).collect();
        let places = decimate::by_distance(&places, 0.5 / RESOLUTION);
        let parts = self.bounds.clip_line(&places).into_iter();
        parts.map(|points| Shape::Line { points, stroke }).collect()
    }

    /// The shapes of a shaded region: one for each part whose ends are numbers.
    pub(crate) fn areas(&self, band: &Band) -> Vec<Shape> {
        let Bounds { top, bottom, .. } = self.bounds;
        let places = |ends: Vec<Point>| {
            let places = ends.into_iter().map(|point| {
                let (x, y) = self.place(point);
                (x, y.clamp(top, bottom))
            });
            decimate::by_column(places, 1.0 / RESOLUTION).concat()
        };
        let ends: Vec<_> = band
            .lower
            .iter()
            .copied()
            .zip(band.upper.iter().copied())
            .collect();
        let is_sound = |(lower, upper): &(Point, Point)| lower.1.is_finite() && upper.1.is_finite();
        let parts = ends.chunk_by(|one, other| is_sound(one) == is_sound(other));
        let parts = parts.filter(|part| part.first().is_some_and(is_sound));
        let shape = |part: &[(Point, Point)]| {
            let (lower, upper) = part.iter().copied().unzip();
            let mut points = places(lower);
            points.extend(places(upper).into_iter().rev());
            Shape::Area {
                points,
                fill: band.fill,
            }
        };
        parts.map(shape).collect()
    }

    /// A frame of equal sides whose axes have the same scale, around the middle of two ranges.
    pub(crate) fn square(bounds: Bounds, [across, upward]: [(f64, f64); 2]) -> Self {
        let values = [across.0, across.1, upward.0, upward.1].into_iter();
        let magnitude = values.map(f64::abs).fold(1e-6, f64::max);
        let half = (across.1 - across.0).max(upward.1 - upward.0) / 2.0;
        // Numbers at ticks of a shorter range would have too many digits.
        let half = half.max(1e-6 * magnitude);
        let scale = |(low, high): (f64, f64)| {
            let middle = f64::midpoint(low, high);
            let most = ticks_across(bounds.width()).min(ticks_up(bounds.height()));
            Scale::new(middle - 1.08 * half, middle + 1.08 * half, most)
        };
        Self {
            x: scale(across),
            y: scale(upward),
            bounds,
        }
    }

    /// Draws the frame and its ticks, which point inwards on all sides.
    pub(crate) fn draw(&self, drawing: &mut Drawing) {
        let mut border = self.bounds.corners();
        border.extend_from_within(..2);
        let mut lines = vec![border];
        let bounds = self.bounds;
        let mut across = |value: f64, length: f64| {
            let x = self.place((value, self.y.low)).0;
            lines.push(vec![(x, bounds.bottom), (x, bounds.bottom - length)]);
            lines.push(vec![(x, bounds.top), (x, bounds.top + length)]);
        };
        self.x.minor().iter().for_each(|v| across(*v, MINOR_TICK));
        self.x.ticks().iter().for_each(|t| across(t.value, TICK));
        let mut upward = |value: f64, length: f64| {
            let y = self.place((self.x.low, value)).1;
            lines.push(vec![(bounds.left, y), (bounds.left + length, y)]);
            lines.push(vec![(bounds.right, y), (bounds.right - length, y)]);
        };
        self.y.minor().iter().for_each(|v| upward(*v, MINOR_TICK));
        self.y.ticks().iter().for_each(|t| upward(t.value, TICK));
        let stroke = style::frame();
        let shape = |points| Shape::Line { points, stroke };
        drawing.group("frame", lines.into_iter().map(shape).collect());
    }

    /// Draws the frame, the numbers at its ticks and the labels of both axes.
    pub(crate) fn draw_with_labels(&self, drawing: &mut Drawing, [x, y]: [Text; 2]) {
        self.draw(drawing);
        self.label_x(drawing, x);
        self.label_y(drawing, y, ticks_width(&self.y));
    }

    /// The room that the numbers and the name of a quantity to the left of the frame take, mm.
    pub(crate) fn room_left(&self, quantity: Quantity) -> f64 {
        room_left(&self.y, &quantity.text(self.y.exponent))
    }

    /// Draws the frame with two quantities along its axes.
    pub(crate) fn draw_with_names(&self, drawing: &mut Drawing, [x, y]: [Quantity; 2]) {
        let labels = [x.text(self.x.exponent), y.text(self.y.exponent)];
        self.draw_with_labels(drawing, labels);
    }

    /// Draws the numbers below the frame, and the label of the axis.
    pub(crate) fn label_x(&self, drawing: &mut Drawing, text: Text) {
        let (left, right) = (self.bounds.left, self.bounds.right);
        let baseline = self.bounds.bottom + GAP + 0.66 * FONT;
        let mut from = 0.0;
        for tick in self.x.ticks() {
            let x = self.place((tick.value, self.y.low)).0;
            let number = Text::plain(&tick.label);
            let half = 0.5 * number.width * FONT;
            // Numbers with many digits would run into one another, or out of the frame.
            if x - half >= from && x + half <= right + ROOM_RIGHT {
                drawing.label(number, (x, baseline), Anchor::Middle);
                from = x + half + GAP;
            }
        }
        let middle = f64::midpoint(left, right);
        drawing.label(text, (middle, baseline + LINE), Anchor::Middle);
    }

    /// Draws the numbers to the left of the frame, and beyond their `width` the label of the axis.
    pub(crate) fn label_y(&self, drawing: &mut Drawing, text: Text, width: f64) {
        let (left, heights) = (self.bounds.left, (self.bounds.top, self.bounds.bottom));
        for tick in self.y.ticks() {
            let y = self.place((self.x.low, tick.value)).1 + 0.33 * FONT;
            drawing.label(Text::plain(&tick.label), (left - GAP, y), Anchor::End);
        }
        let ink = (text.above + text.below) * FONT;
        drawing.upward_label(text, left - 2.0 * GAP - width - ink, heights);
    }

    /// Marks where curves go furthest beyond the upper and the lower end of the upright axis.
    pub(crate) fn draw_beyond(&self, drawing: &mut Drawing, curves: &[&[Point]]) {
        let finite = || {
            curves
                .iter()
                .copied()
                .flatten()
                .filter(|point| point.1.is_finite())
        };
        let highest = finite().max_by(|one, other| one.1.total_cmp(&other.1));
        let lowest = finite().min_by(|one, other| one.1.total_cmp(&other.1));
        let is_above = |point: &&Point| point.1 > self.y.high;
        let is_below = |point: &&Point| point.1 < self.y.low;
        let Bounds { top, bottom, .. } = self.bounds;
        let place = |point: &Point| self.place(*point).0;
        let up = highest
            .filter(is_above)
            .map(|point| legend::mark((place(point), top), 1.0));
        let down = lowest
            .filter(is_below)
            .map(|point| legend::mark((place(point), bottom), -1.0));
        let marks: Vec<_> = up.into_iter().chain(down).collect();
        if !marks.is_empty() {
            drawing.group("beyond the axis", marks);
        }
    }

    /// Marks the upright axis as broken at its lower end.
    pub(crate) fn draw_break(&self, drawing: &mut Drawing) {
        let bounds = self.bounds;
        let mark = |x: f64, y: f64| Shape::Line {
            points: vec![(x - 0.8, y + 0.5), (x + 0.8, y - 0.5)],
            stroke: style::frame(),
        };
        let ends = [bounds.bottom, bounds.bottom + BREAK];
        let marks = ends.map(|y| [bounds.left, bounds.right].map(|x| mark(x, y)));
        drawing.group("break of the axis", marks.concat());
    }
}

/// The room that numbers and this label to the left of a frame take, mm.
pub(crate) fn room_left(scale: &Scale, text: &Text) -> f64 {
    2.0 * GAP + ticks_width(scale) + (text.above + text.below) * FONT
}

/// The width of the numbers at an upright axis, mm.
pub(crate) fn ticks_width(scale: &Scale) -> f64 {
    let ticks = scale.ticks().into_iter();
    let widths = ticks.map(|tick| Text::plain(&tick.label).width * FONT);
    widths.fold(0.0, f64::max)
}

/// The room that numbers and label below a frame take, mm.
pub(crate) const ROOM_BELOW: f64 = GAP + 0.66 * FONT + LINE + 0.25 * FONT;

/// The room to the right of a frame, where half a number may stick out, mm.
pub(crate) const ROOM_RIGHT: f64 = 2.2;

/// The distance between the two parts of a broken axis, mm.
pub(crate) const BREAK: f64 = 1.6;

/// The most numbers that a horizontal axis of this length has.
pub(crate) fn ticks_across(length: f64) -> usize {
    (length / TICK_ROOM_ACROSS) as usize
}

/// The most numbers that an upright axis of this length has.
pub(crate) fn ticks_up(length: f64) -> usize {
    (length / TICK_ROOM_UP) as usize
}

/// The distance from a frame up to the baseline of what stands above it, mm.
pub(crate) const ABOVE: f64 = 1.1;

/// Draws the letter of a panel.
pub(crate) fn draw_letter(drawing: &mut Drawing, letter: char, place: Point) {
    drawing.label(Text::plain(&format!("({letter})")), place, Anchor::Start);
}
