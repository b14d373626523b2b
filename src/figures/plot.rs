//! Plots over time: panels one below the other or in two columns, with legends above them.

use super::decimate;
use super::drawing::{Bounds, Colour, Drawing, Label, Point, Shape, Stroke};
use super::png::RESOLUTION;
use super::style::{self, FONT};
use super::text::Text;
use super::ticks::Scale;

/// Lengths of ticks, mm.
const TICK: f64 = 1.1;
const MINOR_TICK: f64 = 0.6;

/// From a frame to the numbers at its ticks, and from these to the label of the axis, mm.
const GAP: f64 = 1.0;

/// Around the whole figure, mm.
const MARGIN: f64 = 0.8;

/// A line of text with the room between lines, mm.
const LINE: f64 = 1.35 * FONT;

/// The room that a number at a tick needs along its axis, mm.
const TICK_ROOM_ACROSS: f64 = 11.0;
const TICK_ROOM_UP: f64 = 6.5;

/// A quantity and its unit, as on axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Quantity {
    /// Markup of its symbol.
    pub(super) symbol: &'static str,
    /// Its unit, empty for pure numbers.
    pub(super) unit: &'static str,
}

impl Quantity {
    /// What stands at an axis whose numbers are multiplied by a power of ten.
    fn text(self, exponent: i32) -> Text {
        let Self { symbol, unit } = self;
        let power = match exponent {
            0 => String::new(),
            _ => format!("10^{{{}}}", exponent.to_string().replace('-', "−")),
        };
        let in_brackets = match (power.is_empty(), unit.is_empty()) {
            (true, true) => return Text::markup(symbol),
            (false, false) => format!("{power} {unit}"),
            _ => format!("{power}{unit}"),
        };
        Text::markup(&format!("{symbol} ({in_brackets})"))
    }
}

/// A line through data.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Curve {
    pub(super) meaning: String,
    pub(super) points: Vec<Point>,
    pub(super) stroke: Stroke,
}

/// A shaded region between two lines with the same times.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Band {
    pub(super) meaning: String,
    pub(super) lower: Vec<Point>,
    pub(super) upper: Vec<Point>,
    pub(super) fill: Colour,
}

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry {
    pub(super) sample: Sample,
    pub(super) text: Text,
}

/// What stands before the words of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Sample {
    Line(Stroke),
    Area(Colour),
}

impl Entry {
    pub(super) fn line(stroke: Stroke, markup: &str) -> Self {
        Self {
            sample: Sample::Line(stroke),
            text: Text::markup(markup),
        }
    }

    /// Length of the piece of line, mm.
    const SAMPLE: f64 = 6.5;
    const AFTER_SAMPLE: f64 = 1.2;
    /// To the next entry, mm.
    const AFTER: f64 = 4.0;

    fn width(&self) -> f64 {
        Self::SAMPLE + Self::AFTER_SAMPLE + self.text.width * FONT
    }

    fn draw(&self, drawing: &mut Drawing, left: f64, baseline: f64) {
        let middle = baseline - 0.24 * FONT;
        let right = left + Self::SAMPLE;
        let shape = match self.sample {
            Sample::Line(stroke) => Shape::Line {
                points: vec![(left, middle), (right, middle)],
                stroke,
            },
            Sample::Area(fill) => Shape::Area {
                points: Bounds {
                    left,
                    top: middle - 0.35 * FONT,
                    right,
                    bottom: middle + 0.35 * FONT,
                }
                .corners(),
                fill,
            },
        };
        drawing.group(&format!("key: {}", self.text.spoken), vec![shape]);
        label(
            drawing,
            self.text.clone(),
            (right + Self::AFTER_SAMPLE, baseline),
            Anchor::Start,
        );
    }
}

/// Divides entries into lines of a width.
fn wrapped(entries: &[Entry], width: f64) -> Vec<&[Entry]> {
    let mut lines = Vec::new();
    let (mut start, mut used) = (0, 0.0);
    for (index, entry) in entries.iter().enumerate() {
        if index > start && used + entry.width() > width {
            lines.push(&entries[start..index]);
            (start, used) = (index, 0.0);
        }
        used += entry.width() + Entry::AFTER;
    }
    if start < entries.len() {
        lines.push(&entries[start..]);
    }
    lines
}

/// Draws a legend whose first baseline is at `baseline`.
fn key(drawing: &mut Drawing, entries: &[Entry], (left, right): (f64, f64), baseline: f64) {
    for (index, line) in wrapped(entries, right - left).into_iter().enumerate() {
        let mut at = left;
        for entry in line {
            entry.draw(drawing, at, baseline + index as f64 * LINE);
            at += entry.width() + Entry::AFTER;
        }
    }
}

/// Which point of a label is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// Puts a text on a baseline.
pub(super) fn label(drawing: &mut Drawing, text: Text, (x, y): Point, anchor: Anchor) {
    let width = text.width * FONT;
    let x = match anchor {
        Anchor::Start => x,
        Anchor::Middle => x - width / 2.0,
        Anchor::End => x - width,
    };
    drawing.labels.push(Label {
        text,
        origin: (x, y),
        size: FONT,
        is_upward: false,
        colour: style::BLACK,
    });
}

/// A frame with two axes.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Frame {
    pub(super) bounds: Bounds,
    pub(super) x: Scale,
    pub(super) y: Scale,
}

impl Frame {
    /// Where a point of the data is drawn.
    fn place(&self, (x, y): Point) -> Point {
        let Bounds { left, bottom, .. } = self.bounds;
        (
            left + self.x.place(x) * self.bounds.width(),
            bottom - self.y.place(y) * self.bounds.height(),
        )
    }

    /// The shapes of a line whose points are in the order of time.
    fn line(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places = points.iter().map(|point| self.place(*point));
        decimate::by_column(places, 1.0 / RESOLUTION)
            .iter()
            .flat_map(|line| self.bounds.clip_line(line))
            .map(|points| Shape::Line { points, stroke })
            .collect()
    }

    /// The shapes of a line that goes anywhere.
    pub(super) fn path(&self, points: &[Point], stroke: Stroke) -> Vec<Shape> {
        let places: Vec<_> = points.iter().map(|point| self.place(*point)).collect();
        let places = decimate::by_distance(&places, 0.5 / RESOLUTION);
        let parts = self.bounds.clip_line(&places).into_iter();
        parts.map(|points| Shape::Line { points, stroke }).collect()
    }

    fn area(&self, band: &Band) -> Shape {
        let Bounds { top, bottom, .. } = self.bounds;
        let places = |points: &[Point]| {
            let places = points.iter().map(|point| {
                let (x, y) = self.place(*point);
                (x, y.clamp(top, bottom))
            });
            decimate::by_column(places, 1.0 / RESOLUTION).concat()
        };
        let mut points = places(&band.lower);
        points.extend(places(&band.upper).into_iter().rev());
        Shape::Area {
            points,
            fill: band.fill,
        }
    }

    /// The frame and its ticks, which point inwards on all sides.
    pub(super) fn draw(&self, drawing: &mut Drawing) {
        let mut border = self.bounds.corners();
        border.extend_from_within(..2);
        let mut lines = vec![border];
        let Bounds {
            left,
            top,
            right,
            bottom,
        } = self.bounds;
        let mut across = |value: f64, length: f64| {
            let x = self.place((value, self.y.low)).0;
            lines.push(vec![(x, bottom), (x, bottom - length)]);
            lines.push(vec![(x, top), (x, top + length)]);
        };
        self.x.minor().iter().for_each(|v| across(*v, MINOR_TICK));
        self.x.ticks().iter().for_each(|t| across(t.value, TICK));
        let mut upward = |value: f64, length: f64| {
            let y = self.place((self.x.low, value)).1;
            lines.push(vec![(left, y), (left + length, y)]);
            lines.push(vec![(right, y), (right - length, y)]);
        };
        self.y.minor().iter().for_each(|v| upward(*v, MINOR_TICK));
        self.y.ticks().iter().for_each(|t| upward(t.value, TICK));
        let stroke = style::frame();
        let shape = |points| Shape::Line { points, stroke };
        drawing.group("frame", lines.into_iter().map(shape).collect());
    }

    /// The numbers below it, and what they are.
    pub(super) fn name_x(&self, drawing: &mut Drawing, quantity: Quantity) {
        let Bounds {
            left,
            right,
            bottom,
            ..
        } = self.bounds;
        let baseline = bottom + GAP + 0.66 * FONT;
        for tick in self.x.ticks() {
            let x = self.place((tick.value, self.y.low)).0;
            label(
                drawing,
                Text::plain(&tick.label),
                (x, baseline),
                Anchor::Middle,
            );
        }
        let middle = f64::midpoint(left, right);
        let text = quantity.text(self.x.exponent);
        label(drawing, text, (middle, baseline + LINE), Anchor::Middle);
    }

    /// The numbers to its left, and what they are, beyond the `width` of the numbers.
    pub(super) fn name_y(&self, drawing: &mut Drawing, quantity: Quantity, width: f64) {
        let Bounds {
            left, top, bottom, ..
        } = self.bounds;
        for tick in self.y.ticks() {
            let y = self.place((self.x.low, tick.value)).1 + 0.33 * FONT;
            label(
                drawing,
                Text::plain(&tick.label),
                (left - GAP, y),
                Anchor::End,
            );
        }
        let text = quantity.text(self.y.exponent);
        let y = f64::midpoint(top, bottom) + text.width * FONT / 2.0;
        drawing.labels.push(Label {
            origin: (left - 2.0 * GAP - width - text.below * FONT, y),
            text,
            size: FONT,
            is_upward: true,
            colour: style::BLACK,
        });
    }

    /// Marks that the axis is broken at its lower end.
    fn draw_break(&self, drawing: &mut Drawing) {
        let Bounds {
            left,
            right,
            bottom,
            ..
        } = self.bounds;
        let mark = |x: f64, y: f64| Shape::Line {
            points: vec![(x - 0.8, y + 0.5), (x + 0.8, y - 0.5)],
            stroke: style::frame(),
        };
        let ends = [bottom, bottom + BREAK];
        let marks = ends.map(|y| [left, right].map(|x| mark(x, y)));
        drawing.group("break of the axis", marks.concat());
    }
}

/// The room that numbers and label to the left of a frame take, mm.
pub(super) fn room_left(scale: &Scale, quantity: Quantity) -> f64 {
    let text = quantity.text(scale.exponent);
    2.0 * GAP + ticks_width(scale) + (text.above + text.below) * FONT
}

/// The width of the numbers at an upright axis, mm.
fn ticks_width(scale: &Scale) -> f64 {
    let ticks = scale.ticks().into_iter();
    let widths = ticks.map(|tick| Text::plain(&tick.label).width * FONT);
    widths.fold(0.0, f64::max)
}

/// The room that numbers and label below a frame take, mm.
pub(super) const ROOM_BELOW: f64 = GAP + 0.66 * FONT + LINE + 0.25 * FONT;

/// How many numbers an axis of this length has at most.
pub(super) fn ticks_across(length: f64) -> usize {
    (length / TICK_ROOM_ACROSS) as usize
}

/// The same for an upright one.
pub(super) fn ticks_up(length: f64) -> usize {
    (length / TICK_ROOM_UP) as usize
}

/// A plot over time.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Panel {
    pub(super) quantity: Quantity,
    pub(super) bands: Vec<Band>,
    /// In the order of drawing.
    pub(super) curves: Vec<Curve>,
    /// Its own legend.
    pub(super) key: Vec<Entry>,
    /// Its height as a part of the usual one.
    pub(super) height: f64,
    /// Whether its axis is broken below it, and goes on in the next panel.
    pub(super) is_broken: bool,
}

impl Panel {
    pub(super) fn new(symbol: &'static str, unit: &'static str) -> Self {
        Self {
            quantity: Quantity { symbol, unit },
            bands: Vec::new(),
            curves: Vec::new(),
            key: Vec::new(),
            height: 1.0,
            is_broken: false,
        }
    }

    pub(super) fn curve(&mut self, meaning: impl Into<String>, points: Vec<Point>, stroke: Stroke) {
        self.curves.push(Curve {
            meaning: meaning.into(),
            points,
            stroke,
        });
    }

    /// The scale of its axis: the range of its curves with some air.
    fn scale(&self, usual_height: f64) -> Scale {
        let values = self.curves.iter().flat_map(|curve| &curve.points);
        let (low, high) = extremes(values.map(|point| point.1));
        let air = 0.06 * (high - low);
        let most = ticks_up(self.height * usual_height);
        Scale::new(low - air, high + air, most)
    }
}

/// The least and the greatest of the numbers that are finite.
pub(super) fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .filter(|value| value.is_finite())
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
            (low.min(value), high.max(value))
        })
}

/// Names the upright axes of frames one below the other, the names in one line.
fn name_all_y(drawing: &mut Drawing, frames: &[(&Frame, &Panel)]) {
    let widths = frames.iter().map(|(frame, _)| ticks_width(&frame.y));
    let width = widths.fold(0.0, f64::max);
    for (frame, panel) in frames {
        frame.name_y(drawing, panel.quantity, width);
    }
}

/// Panels over time and their common legend.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Page {
    pub(super) key: Vec<Entry>,
    pub(super) panels: Vec<Panel>,
    /// Whether all panels show the same span of time.
    pub(super) shares_time: bool,
}

/// Time, as on axes.
const TIME: Quantity = Quantity {
    symbol: "*t*",
    unit: "s",
};

/// From this width on there are two columns, mm.
const TWO_COLUMNS: f64 = 130.0;

/// Height of a panel, as a part of its width, and at most so many mm.
const PROPORTION: f64 = 0.46;
const TALLEST: f64 = 48.0;

/// Between columns, and right of the last one, where half a number may stick out, mm.
const COLUMN_GAP: f64 = 4.0;
const RIGHT: f64 = 2.2;

/// Between the two parts of a broken axis, mm.
const BREAK: f64 = 1.6;

impl Page {
    /// Draws it with a width in mm; the height follows.
    pub(super) fn draw(&self, width: f64) -> Drawing {
        let columns = self.columns(width);
        let mut drawing = Drawing {
            title: String::new(),
            width,
            height: 0.0,
            groups: Vec::new(),
            labels: Vec::new(),
        };
        let usable = (MARGIN, width - MARGIN);
        let lines = wrapped(&self.key, usable.1 - usable.0).len();
        let mut top = MARGIN + lines as f64 * LINE;
        key(&mut drawing, &self.key, usable, MARGIN + 0.75 * FONT);
        let frames = self.frames(width, columns, &mut top);
        for (index, frame) in frames.iter().enumerate() {
            self.draw_panel(&mut drawing, index, columns, frame);
        }
        for column in 0..columns {
            let of_column = frames
                .iter()
                .zip(&self.panels)
                .skip(column)
                .step_by(columns);
            name_all_y(&mut drawing, &of_column.collect::<Vec<_>>());
        }
        drawing.height = top + MARGIN;
        drawing
    }

    fn columns(&self, width: f64) -> usize {
        let is_divided = self.panels.iter().any(|panel| panel.is_broken);
        if width >= TWO_COLUMNS && self.panels.len() > 1 && !is_divided {
            2
        } else {
            1
        }
    }

    /// The span of time of a panel.
    fn times(&self, panel: &Panel) -> (f64, f64) {
        let all = if self.shares_time {
            &self.panels[..]
        } else {
            std::slice::from_ref(panel)
        };
        let curves = all.iter().flat_map(|panel| &panel.curves);
        extremes(curves.flat_map(|curve| curve.points.iter().map(|point| point.0)))
    }

    /// Whether the panel has numbers of its own below it.
    fn has_time_axis(&self, index: usize, columns: usize) -> bool {
        !self.shares_time || index + columns >= self.panels.len()
    }

    /// Places the frames from `top` downwards, and moves `top` below them.
    fn frames(&self, width: f64, columns: usize, top: &mut f64) -> Vec<Frame> {
        let share = (width - 2.0 * MARGIN - (columns - 1) as f64 * COLUMN_GAP) / columns as f64;
        let height = TALLEST.min(share * PROPORTION);
        let rooms = self.rooms_left(columns, height);
        let mut frames: Vec<Frame> = Vec::new();
        for (row, panels) in self.panels.chunks(columns).enumerate() {
            let first = row * columns;
            let sides: Vec<_> = (0..panels.len())
                .map(|column| {
                    let left = MARGIN + column as f64 * (share + COLUMN_GAP);
                    (left + rooms[column], left + share - RIGHT)
                })
                .collect();
            *top += self.room_above(first, &sides);
            let tall = panels.iter().map(|panel| panel.height * height);
            let bottom = *top + tall.fold(0.0, f64::max);
            for (panel, (left, right)) in panels.iter().zip(sides) {
                let (low, high) = self.times(panel);
                let bounds = Bounds {
                    left,
                    top: *top,
                    right,
                    bottom,
                };
                frames.push(Frame {
                    x: Scale::new(low, high, ticks_across(bounds.width())),
                    y: panel.scale(height),
                    bounds,
                });
            }
            let has_axis = (0..panels.len()).any(|n| self.has_time_axis(first + n, columns));
            *top = bottom + if has_axis { ROOM_BELOW } else { 0.0 };
        }
        frames
    }

    /// For each column the room that the labels left of its frames need.
    fn rooms_left(&self, columns: usize, height: f64) -> Vec<f64> {
        let room = |panel: &Panel| room_left(&panel.scale(height), panel.quantity);
        let of_column = |column| self.panels.iter().skip(column).step_by(columns).map(room);
        (0..columns)
            .map(|column| of_column(column).fold(0.0, f64::max))
            .collect()
    }

    /// The room above a row: for letters and legends.
    fn room_above(&self, first: usize, sides: &[(f64, f64)]) -> f64 {
        if self.continues(first) {
            return BREAK;
        }
        let panels = self.panels[first..].iter().zip(sides);
        let lines =
            panels.map(|(panel, (left, right))| wrapped(&panel.key, right - left - INDENT).len());
        let letters = usize::from(self.letter(first).is_some());
        lines.max().unwrap_or(0).max(letters) as f64 * LINE + 0.6
    }

    /// Whether a panel goes on with the axis of the one before it.
    fn continues(&self, index: usize) -> bool {
        index > 0 && self.panels[index - 1].is_broken
    }

    fn draw_panel(&self, drawing: &mut Drawing, index: usize, columns: usize, frame: &Frame) {
        let panel = &self.panels[index];
        for band in &panel.bands {
            drawing.group(&band.meaning, vec![frame.area(band)]);
        }
        for curve in &panel.curves {
            drawing.group(&curve.meaning, frame.line(&curve.points, curve.stroke));
        }
        frame.draw(drawing);
        if panel.is_broken {
            frame.draw_break(drawing);
        }
        if self.has_time_axis(index, columns) {
            frame.name_x(drawing, TIME);
        }
        self.draw_heading(drawing, index, frame);
    }

    fn draw_heading(&self, drawing: &mut Drawing, index: usize, frame: &Frame) {
        let panel = &self.panels[index];
        let Bounds {
            left, right, top, ..
        } = frame.bounds;
        let (left_of_key, lines) = (left + INDENT, wrapped(&panel.key, right - left - INDENT));
        let baseline = top - 1.1 - lines.len().saturating_sub(1) as f64 * LINE;
        if let Some(letter) = self.letter(index) {
            let text = Text::plain(&format!("({letter})"));
            label(drawing, text, (left, baseline), Anchor::Start);
        }
        key(drawing, &panel.key, (left_of_key, right), baseline);
    }

    /// The letter of a panel; the parts of a broken axis have one together.
    fn letter(&self, index: usize) -> Option<char> {
        let count = |until: usize| (0..until).filter(|n| !self.continues(*n)).count();
        if count(self.panels.len()) < 2 || self.continues(index) {
            return None;
        }
        letters().nth(count(index))
    }
}

/// The letters of panels.
pub(super) fn letters() -> impl Iterator<Item = char> {
    'a'..='z'
}

/// Room for the letter of a panel before its legend, mm.
const INDENT: f64 = 6.5;
