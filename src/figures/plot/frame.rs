//! Frames: plots with axes, ticks and the curves within them.

use super::decimate;
use super::drawing::{Anchor, Drawing};
use super::legend;
use super::shape::{Bounds, Colour, Point, Shape, Stroke};
use super::style::{self, FONT, LINE, MARGIN, RESOLUTION};
use super::text::Text;
use super::ticks::Scale;
use std::borrow::Cow;

/// The lengths of ticks with and without numbers, mm.
const TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;

/// The distance from a frame to the numbers at its ticks, and from these to the label of the axis, mm.
const GAP: f64 = 1.0;

/// The space needed along the axis by a number at a tick, mm.
const TICK_ROOM_ACROSS: f64 = 11.0;
const TICK_ROOM_UP: f64 = 6.5;

/// Quantity of an axis, with its unit.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Quantity {
    /// The symbol, as markup (see [`Text::markup`]).
    pub(crate) symbol: Cow<'static, str>,
    /// The unit, empty for pure numbers.
    pub(crate) unit: Cow<'static, str>,
}

impl Quantity {
    pub(crate) const fn new(symbol: &'static str, unit: &'static str) -> Self {
        let (symbol, unit) = (Cow::Borrowed(symbol), Cow::Borrowed(unit));
        Self { symbol, unit }
    }

    /// The label of an axis whose numbers are to be multiplied by a power of ten.
    pub(crate) fn text(&self, exponent: i32) -> Text {
        let symbol = &self.symbol;
        match in_brackets(exponent, &self.unit).as_str() {
            "" => Text::markup(symbol),
            in_brackets => Text::markup(&format!("{symbol} ({in_brackets})")),
        }
    }
}

/// A power of ten and a unit, as markup; one is left out.
pub(crate) fn in_brackets(exponent: i32, unit: &str) -> String {
    let power = match exponent {
        0 => String::new(),
        _ => format!("10^{{{exponent}}} ").replace('-', "−"),
    };
    format!("{power}{unit}").trim().to_owned()
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
    /// The position in the drawing of a data point.
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

    /// The shapes of a curve whose points are in any order.
    pub(crate) fn path(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places: Vec<_> = points.iter().map(|point| self.place(*point)).collect();
        let places = decimate::by_distance(&places, 0.5 / RESOLUTION);
        let parts = self.bounds.clip_line(&places).into_iter();
        parts.map(|points| Shape::Line { points, stroke }).collect()
    }

    /// The shapes of a shaded region: one for each part whose ends are numbers.
    pub(crate) fn areas(&self, band: &Band) -> Vec<Shape> {
        let Bounds { top, bottom, .. } = self.bounds;
        let places = |ends: &mut dyn Iterator<Item = Point>| {
            let places = ends.map(|point| self.place(point));
            let places = places.map(|(x, y)| (x, y.clamp(top, bottom)));
            decimate::by_column(places, 1.0 / RESOLUTION).concat()
        };
        let ends: Vec<_> = band.lower.iter().zip(&band.upper).collect();
        let is_gap = |(lower, upper): &(&Point, &Point)| !(lower.1 + upper.1).is_finite();
        let shape = |part: &[(&Point, &Point)]| {
            let mut points = places(&mut part.iter().map(|ends| *ends.0));
            let upper = places(&mut part.iter().map(|ends| *ends.1));
            points.extend(upper.into_iter().rev());
            let fill = band.fill;
            Shape::Area { points, fill }
        };
        let parts = ends.split(is_gap).filter(|part| !part.is_empty());
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
        for (value, length) in marks(&self.x) {
            let x = self.place((value, self.y.low)).0;
            lines.push(vec![(x, bounds.bottom), (x, bounds.bottom - length)]);
            lines.push(vec![(x, bounds.top), (x, bounds.top + length)]);
        }
        for (value, length) in marks(&self.y) {
            let y = self.place((self.x.low, value)).1;
            lines.push(vec![(bounds.left, y), (bounds.left + length, y)]);
            lines.push(vec![(bounds.right, y), (bounds.right - length, y)]);
        }
        let stroke = style::frame();
        let shape = |points| Shape::Line { points, stroke };
        drawing.group("frame", lines.into_iter().map(shape).collect());
    }

    /// Draws the frame with two quantities along its axes, and ends the drawing below it.
    pub(crate) fn finish(&self, drawing: &mut Drawing, [x, y]: [&Quantity; 2]) {
        self.draw(drawing);
        self.label_x(drawing, x);
        self.label_y(drawing, y, ticks_width(&self.y));
        drawing.height = self.bounds.bottom + ROOM_BELOW + MARGIN;
    }

    /// Draws the numbers below the frame, and the label of the axis.
    pub(crate) fn label_x(&self, drawing: &mut Drawing, quantity: &Quantity) {
        let (left, right) = (self.bounds.left, self.bounds.right);
        let baseline = self.bounds.bottom + GAP + 0.66 * FONT;
        let mut from = 0.0;
        for tick in &self.x.ticks {
            let x = self.place((tick.value, self.y.low)).0;
            let number = Text::plain(&tick.label);
            let half = 0.5 * number.width * FONT;
            // Numbers with many digits would overlap or extend beyond the frame.
            if x - half >= from && x + half <= right + ROOM_RIGHT {
                drawing.label(number, (x, baseline), Anchor::Middle);
                from = x + half + GAP;
            }
        }
        let middle = f64::midpoint(left, right);
        let text = quantity.text(self.x.exponent);
        drawing.label(text, (middle, baseline + LINE), Anchor::Middle);
    }

    /// Draws the numbers to the left of the frame, and beyond their `width` the label of the axis.
    pub(crate) fn label_y(&self, drawing: &mut Drawing, quantity: &Quantity, width: f64) {
        let (left, heights) = (self.bounds.left, (self.bounds.top, self.bounds.bottom));
        for tick in &self.y.ticks {
            let y = self.place((self.x.low, tick.value)).1 + 0.33 * FONT;
            drawing.label(Text::plain(&tick.label), (left - GAP, y), Anchor::End);
        }
        let text = quantity.text(self.y.exponent);
        let ink = (text.above + text.below) * FONT;
        drawing.upward_label(text, left - 2.0 * GAP - width - ink, heights);
    }

    /// Marks where curves exceed the vertical axis the most, at its upper and lower end.
    pub(crate) fn draw_beyond(&self, drawing: &mut Drawing, curves: &[&[Point]]) {
        let points = curves.iter().copied().flatten();
        let finite = points.filter(|point| point.1.is_finite());
        let highest = finite.clone().max_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = finite.min_by(|a, b| a.1.total_cmp(&b.1));
        let mark = |point: &Point, y, upward| legend::mark((self.place(*point).0, y), upward);
        let up = highest.filter(|point| point.1 > self.y.high);
        let up = up.map(|point| mark(point, self.bounds.top, 1.0));
        let down = lowest.filter(|point| point.1 < self.y.low);
        let down = down.map(|point| mark(point, self.bounds.bottom, -1.0));
        let marks: Vec<_> = up.into_iter().chain(down).collect();
        if !marks.is_empty() {
            drawing.group("beyond the axis", marks);
        }
    }

    /// Marks the vertical axis as broken at its lower end.
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

/// The values of all ticks of an axis, and their lengths.
fn marks(scale: &Scale) -> impl Iterator<Item = (f64, f64)> {
    let minor = scale.minor.iter().map(|value| (*value, MINOR_TICK));
    minor.chain(scale.ticks.iter().map(|tick| (tick.value, TICK)))
}

/// The width of numbers and axis label to the left of a frame, mm.
pub(crate) fn room_left(scale: &Scale, quantity: &Quantity) -> f64 {
    let text = quantity.text(scale.exponent);
    2.0 * GAP + ticks_width(scale) + (text.above + text.below) * FONT
}

/// The width of the numbers at a vertical axis, mm.
pub(crate) fn ticks_width(scale: &Scale) -> f64 {
    let numbers = scale.ticks.iter().map(|tick| Text::plain(&tick.label));
    numbers
        .map(|number| number.width * FONT)
        .fold(0.0, f64::max)
}

/// The height of numbers and axis label below a frame, mm.
pub(crate) const ROOM_BELOW: f64 = GAP + 0.66 * FONT + LINE + 0.25 * FONT;

/// The space to the right of a frame for half a number, mm.
pub(crate) const ROOM_RIGHT: f64 = 2.2;

/// The distance between the two parts of a broken axis, mm.
pub(crate) const BREAK: f64 = 1.6;

/// The maximum number of labelled ticks on a horizontal axis of this length.
pub(crate) fn ticks_across(length: f64) -> usize {
    (length / TICK_ROOM_ACROSS) as usize
}

/// The maximum number of labelled ticks on a vertical axis of this length.
pub(crate) fn ticks_up(length: f64) -> usize {
    (length / TICK_ROOM_UP) as usize
}

/// The distance from a frame up to the baseline of the text above it, mm.
pub(crate) const ABOVE: f64 = 1.1;

/// Draws the letter of a panel.
pub(crate) fn draw_letter(drawing: &mut Drawing, letter: char, place: Point) {
    drawing.label(Text::plain(&format!("({letter})")), place, Anchor::Start);
}
