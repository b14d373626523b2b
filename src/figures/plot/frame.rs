//! Frames: plots with axes, ticks and the curves within them.

use super::decimate;
use super::drawing::{Anchor, Drawing};
use super::legend;
use super::shape::{Bounds, Colour, Point, Shape, Stroke};
use super::style::{self, FONT_SIZE, LINE_HEIGHT, MARGIN, RESOLUTION};
use super::text::Text;
use super::ticks::Scale;
use std::borrow::Cow;

/// The lengths of ticks with and without labels, mm.
const TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;

/// The radius of the dots of values, mm.
const DOT: f64 = 0.25;

/// The distance from a frame to the labels of its ticks, and from these to the label of the axis, mm.
const GAP: f64 = 1.0;

/// The space along a horizontal and a vertical axis for the label of a tick, mm.
const TICK_ROOM_ACROSS: f64 = 11.0;
const TICK_ROOM_UP: f64 = 6.5;

/// The length of the axes of a square frame, relative to the range that they show.
const SQUARE_LENGTH: f64 = 1.08;

/// The shortest range of a square frame, relative to its values; the tick labels of a shorter one would have too many
/// digits.
const MIN_SQUARE: f64 = 1e-6;

/// The height of tick labels and axis label below a frame, mm.
pub(crate) const ROOM_BELOW: f64 = GAP + 0.66 * FONT_SIZE + LINE_HEIGHT + 0.25 * FONT_SIZE;

/// The space to the right of a frame for half a tick label, mm.
pub(crate) const ROOM_RIGHT: f64 = 2.2;

/// The distance between the two parts of a broken axis, mm.
pub(crate) const BREAK: f64 = 1.6;

/// The distance from a frame up to the baseline of the text above it, mm.
pub(crate) const ABOVE: f64 = 1.1;

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
        Self {
            symbol: Cow::Borrowed(symbol),
            unit: Cow::Borrowed(unit),
        }
    }

    /// The label of an axis whose tick labels are in units of a power of ten.
    pub(crate) fn text(&self, exponent: i32) -> Text {
        let symbol = &self.symbol;
        match unit_with_power(exponent, &self.unit).as_str() {
            "" => Text::markup(symbol),
            unit => Text::markup(&format!("{symbol} ({unit})")),
        }
    }
}

/// A power of ten and a unit, as markup; the power 0 is left out.
pub(crate) fn unit_with_power(exponent: i32, unit: &str) -> String {
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
    /// A frame of equal sides whose axes have the same scale, around the middle of two ranges.
    pub(crate) fn square(bounds: Bounds, [across, upward]: [(f64, f64); 2]) -> Self {
        let magnitude = [across.0, across.1, upward.0, upward.1]
            .into_iter()
            .map(f64::abs)
            .fold(1e-6, f64::max);
        let half =
            ((across.1 - across.0).max(upward.1 - upward.0) / 2.0).max(MIN_SQUARE * magnitude);
        // Both axes have as many labels as the tighter one can have.
        let max_labels = max_labels_across(bounds.width()).min(max_labels_up(bounds.height()));
        Self {
            x: centred_scale(across, half, max_labels),
            y: centred_scale(upward, half, max_labels),
            bounds,
        }
    }

    /// The position in the drawing of a data point.
    pub(crate) fn place(&self, (x, y): Point) -> Point {
        let Bounds { left, bottom, .. } = self.bounds;
        (
            left + self.x.fraction(x) * self.bounds.width(),
            bottom - self.y.fraction(y) * self.bounds.height(),
        )
    }

    /// The shapes of a curve whose points are in the order of x.
    pub(crate) fn line(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places = points.iter().map(|point| self.place(*point));
        let lines = decimate::by_column(places, 1.0 / RESOLUTION);
        let visible = lines.iter().flat_map(|line| self.bounds.clip_line(line));
        Shape::lines(visible, stroke)
    }

    /// The shapes of a curve whose points are in any order.
    pub(crate) fn path(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places: Vec<Point> = points.iter().map(|point| self.place(*point)).collect();
        // Half a pixel, so that small loops stay round.
        let thinned = decimate::by_distance(&places, 0.5 / RESOLUTION);
        Shape::lines(self.bounds.clip_line(&thinned), stroke)
    }

    /// The shapes of values as dots. Of dots that cover each other one is drawn, so that their number is bounded.
    pub(crate) fn dots(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let Bounds { top, bottom, .. } = self.bounds;
        let mut places: Vec<Point> = points.iter().map(|point| self.place(*point)).collect();
        places.retain(|(_, y)| (top..=bottom).contains(y));
        places.sort_by_key(dot_cell);
        places.dedup_by_key(|place| dot_cell(place));
        let mut dots = Vec::new();
        for centre in places {
            dots.push(Shape::Dot {
                centre,
                radius: DOT,
                fill: stroke.colour,
                stroke: style::line(stroke.colour, 0.1),
            });
        }
        dots
    }

    /// The shapes of a shaded region: one for each part whose ends are numbers.
    pub(crate) fn areas(&self, band: &Band) -> Vec<Shape> {
        let ends: Vec<(Point, Point)> = band
            .lower
            .iter()
            .copied()
            .zip(band.upper.iter().copied())
            .collect();
        ends.split(|(lower, upper)| !(lower.1 + upper.1).is_finite())
            .filter(|part| !part.is_empty())
            .map(|part| {
                let mut points = self.edge(part.iter().map(|(lower, _)| *lower));
                let upper = self.edge(part.iter().map(|(_, upper)| *upper));
                points.extend(upper.into_iter().rev());
                let fill = band.fill;
                Shape::Area { points, fill }
            })
            .collect()
    }

    /// The edge of a region, which follows the frame where the curve is beyond it.
    fn edge(&self, curve: impl Iterator<Item = Point>) -> Vec<Point> {
        let Bounds { top, bottom, .. } = self.bounds;
        let places = curve.map(|point| {
            let (x, y) = self.place(point);
            (x, y.clamp(top, bottom))
        });
        decimate::by_column(places, 1.0 / RESOLUTION).concat()
    }

    /// Draws the frame and its ticks, which point inwards on all sides.
    pub(crate) fn draw(&self, drawing: &mut Drawing) {
        let bounds = self.bounds;
        let mut border = bounds.corners();
        // One corner more than a closed line needs, so that the first corner is joined like the others.
        border.extend_from_within(..2);
        let mut lines = vec![border];
        // Ticks on all sides help to read values far from the labels.
        for (value, length) in all_ticks(&self.x) {
            let x = self.place((value, self.y.low)).0;
            lines.push(vec![(x, bounds.bottom), (x, bounds.bottom - length)]);
            lines.push(vec![(x, bounds.top), (x, bounds.top + length)]);
        }
        for (value, length) in all_ticks(&self.y) {
            let y = self.place((self.x.low, value)).1;
            lines.push(vec![(bounds.left, y), (bounds.left + length, y)]);
            lines.push(vec![(bounds.right, y), (bounds.right - length, y)]);
        }
        drawing.group("frame", Shape::lines(lines, style::frame()));
    }

    /// Draws the frame with two quantities along its axes, and ends the drawing below it.
    pub(crate) fn finish(&self, drawing: &mut Drawing, [x, y]: [&Quantity; 2]) {
        self.draw(drawing);
        self.label_x(drawing, x);
        self.label_y(drawing, y, tick_labels_width(&self.y));
        drawing.height = self.bounds.bottom + ROOM_BELOW + MARGIN;
    }

    /// Draws the labels of ticks below the frame, and the label of the axis.
    pub(crate) fn label_x(&self, drawing: &mut Drawing, quantity: &Quantity) {
        let (left, right) = (self.bounds.left, self.bounds.right);
        let baseline = self.bounds.bottom + GAP + 0.66 * FONT_SIZE;
        let mut free_from = 0.0;
        for tick in &self.x.ticks {
            let x = self.place((tick.value, self.y.low)).0;
            let text = Text::plain(&tick.label);
            let half = 0.5 * text.width * FONT_SIZE;
            // Numbers with many digits would overlap or extend beyond the frame.
            if x - half >= free_from && x + half <= right + ROOM_RIGHT {
                drawing.label(text, (x, baseline), Anchor::Middle);
                free_from = x + half + GAP;
            }
        }
        let middle = f64::midpoint(left, right);
        let text = quantity.text(self.x.exponent);
        drawing.label(text, (middle, baseline + LINE_HEIGHT), Anchor::Middle);
    }

    /// Draws the labels of ticks to the left of the frame, and beyond their `width` the label of the axis.
    pub(crate) fn label_y(&self, drawing: &mut Drawing, quantity: &Quantity, width: f64) {
        let Bounds {
            left, top, bottom, ..
        } = self.bounds;
        for tick in &self.y.ticks {
            // A baseline a third of the font size below the tick centres the digits.
            let y = self.place((self.x.low, tick.value)).1 + 0.33 * FONT_SIZE;
            drawing.label(Text::plain(&tick.label), (left - GAP, y), Anchor::End);
        }
        let text = quantity.text(self.y.exponent);
        let ink = (text.above + text.below) * FONT_SIZE;
        drawing.upward_label(text, left - 2.0 * GAP - width - ink, (top, bottom));
    }

    /// Marks where curves exceed the vertical axis the most, at its upper and lower end.
    pub(crate) fn draw_beyond(&self, drawing: &mut Drawing, curves: &[&[Point]]) {
        let finite = curves
            .iter()
            .copied()
            .flatten()
            .filter(|point| point.1.is_finite());
        let highest = finite.clone().max_by(|a, b| a.1.total_cmp(&b.1));
        let lowest = finite.min_by(|a, b| a.1.total_cmp(&b.1));
        let mut marks = Vec::new();
        if let Some(highest) = highest
            && highest.1 > self.y.high
        {
            marks.push(legend::mark((self.place(*highest).0, self.bounds.top), 1.0));
        }
        if let Some(lowest) = lowest
            && lowest.1 < self.y.low
        {
            marks.push(legend::mark(
                (self.place(*lowest).0, self.bounds.bottom),
                -1.0,
            ));
        }
        if !marks.is_empty() {
            drawing.group("beyond the axis", marks);
        }
    }

    /// Marks the vertical axis as broken at its lower end.
    pub(crate) fn draw_break(&self, drawing: &mut Drawing) {
        let bounds = self.bounds;
        let mut marks = Vec::new();
        for y in [bounds.bottom, bounds.bottom + BREAK] {
            for x in [bounds.left, bounds.right] {
                marks.push(vec![(x - 0.8, y + 0.5), (x + 0.8, y - 0.5)]);
            }
        }
        drawing.group("break of the axis", Shape::lines(marks, style::frame()));
    }
}

/// The cell of a grid as fine as a dot that a place lies in.
fn dot_cell((x, y): &Point) -> (i64, i64) {
    ((x / DOT).floor() as i64, (y / DOT).floor() as i64)
}

/// A scale around the middle of a range.
fn centred_scale((low, high): (f64, f64), half: f64, max_labels: usize) -> Scale {
    let middle = f64::midpoint(low, high);
    let half = SQUARE_LENGTH * half;
    Scale::new(middle - half, middle + half, max_labels)
}

/// The values of all ticks of an axis, and their lengths.
fn all_ticks(scale: &Scale) -> impl Iterator<Item = (f64, f64)> {
    let minor = scale.minor.iter().map(|value| (*value, MINOR_TICK));
    minor.chain(scale.ticks.iter().map(|tick| (tick.value, TICK)))
}

/// The width of tick labels and axis label to the left of a frame, mm.
pub(crate) fn room_left(scale: &Scale, quantity: &Quantity) -> f64 {
    let text = quantity.text(scale.exponent);
    2.0 * GAP + tick_labels_width(scale) + (text.above + text.below) * FONT_SIZE
}

/// The width of the tick labels at a vertical axis, mm.
pub(crate) fn tick_labels_width(scale: &Scale) -> f64 {
    scale
        .ticks
        .iter()
        .map(|tick| Text::plain(&tick.label).width * FONT_SIZE)
        .fold(0.0, f64::max)
}

/// The maximum number of tick labels on a horizontal axis of this length.
pub(crate) fn max_labels_across(length: f64) -> usize {
    (length / TICK_ROOM_ACROSS) as usize
}

/// The maximum number of tick labels on a vertical axis of this length.
pub(crate) fn max_labels_up(length: f64) -> usize {
    (length / TICK_ROOM_UP) as usize
}

/// Draws the letter of a panel.
pub(crate) fn draw_letter(drawing: &mut Drawing, letter: char, place: Point) {
    drawing.label(Text::plain(&format!("({letter})")), place, Anchor::Start);
}
