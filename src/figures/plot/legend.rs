//! Legends: the meanings of the lines, areas and dots of a drawing.

use super::drawing::{Anchor, Drawing};
use super::shape::{Bounds, Colour, Point, Shape, Stroke};
use super::style::{self, FONT, LINE, MARGIN};
use super::text::Text;

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Entry {
    sample: Sample,
    pub(crate) text: Text,
}

/// The symbol before the text of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Sample {
    Line(Stroke),
    Area(Colour),
    /// A dot; whether it is filled.
    Dot(bool),
    /// The marks of curves that go beyond their axis.
    Marks,
    /// No symbol: the text is a note.
    None,
}

impl Entry {
    fn new(sample: Sample, text: Text) -> Self {
        Self { sample, text }
    }

    /// The entry of a line whose text is set already.
    pub(crate) fn of(stroke: Stroke, text: Text) -> Self {
        Self::new(Sample::Line(stroke), text)
    }

    pub(crate) fn line(stroke: Stroke, markup: &str) -> Self {
        Self::of(stroke, Text::markup(markup))
    }

    pub(crate) fn area(fill: Colour, markup: &str) -> Self {
        Self::new(Sample::Area(fill), Text::markup(markup))
    }

    /// The dots at the ends of a path.
    pub(crate) fn ends() -> [Self; 2] {
        [(false, "start"), (true, "end")]
            .map(|(is_filled, name)| Self::new(Sample::Dot(is_filled), Text::plain(name)))
    }

    /// Meaning of the marks where curves exceed their axis.
    pub(crate) fn beyond() -> Self {
        Self::new(Sample::Marks, Text::plain("beyond the axis"))
    }

    /// A note without a symbol.
    pub(crate) fn note(text: &str) -> Self {
        Self::new(Sample::None, Text::plain(text))
    }

    /// The space between the sample and the text, mm.
    const AFTER_SAMPLE: f64 = 1.2;

    /// The space after an entry, mm.
    const AFTER: f64 = 4.0;

    fn width(&self) -> f64 {
        self.indent() + self.text.width * FONT
    }

    /// The width of the symbol before the text, mm.
    fn indent(&self) -> f64 {
        match self.sample {
            Sample::Line(_) | Sample::Area(_) => BROAD + Self::AFTER_SAMPLE,
            Sample::Dot(_) => 2.0 * DOT + Self::AFTER_SAMPLE,
            Sample::Marks => 4.0 * MARK + 0.6 + Self::AFTER_SAMPLE,
            Sample::None => 0.0,
        }
    }

    fn draw(&self, drawing: &mut Drawing, left: f64, baseline: f64) {
        let start = left + self.indent();
        let (right, middle) = (start - Self::AFTER_SAMPLE, baseline - 0.24 * FONT);
        let shapes = match self.sample {
            Sample::Line(stroke) => vec![Shape::Line {
                points: vec![(left, middle), (right, middle)],
                stroke,
            }],
            Sample::Area(fill) => {
                let (top, bottom) = (middle - 0.35 * FONT, middle + 0.35 * FONT);
                vec![Bounds::between((left, top), (right, bottom)).area(fill)]
            }
            Sample::Dot(is_filled) => vec![dot((left + DOT, middle), is_filled, style::BLACK)],
            Sample::Marks => vec![
                mark((left + MARK, middle - MARK), 1.0),
                mark((right - MARK, middle + MARK), -1.0),
            ],
            Sample::None => Vec::new(),
        };
        if !shapes.is_empty() {
            drawing.group(&format!("key: {}", self.text.spoken), shapes);
        }
        drawing.label(self.text.clone(), (start, baseline), Anchor::Start);
    }
}

/// The width of lines and areas, mm.
const BROAD: f64 = 6.5;

/// Half the width of a mark, and its height, mm.
const MARK: f64 = 0.9;

/// A triangle with its tip at a point; it points upwards for 1 and downwards for −1.
pub(crate) fn mark((x, y): Point, upward: f64) -> Shape {
    let base = y + upward * 2.0 * MARK;
    Shape::Area {
        points: vec![(x, y), (x + MARK, base), (x - MARK, base)],
        fill: style::BLACK,
    }
}

/// The radius of dots, mm.
const DOT: f64 = 0.7;

/// The shape of a dot at a place.
pub(crate) fn dot(centre: Point, is_filled: bool, colour: Colour) -> Shape {
    Shape::Dot {
        centre,
        radius: DOT,
        fill: if is_filled { colour } else { style::WHITE },
        stroke: style::line(colour, style::HAIRLINE),
    }
}

/// The number of lines of a legend.
pub(crate) fn lines(entries: &[Entry], width: f64) -> usize {
    wrapped(entries, width).len()
}

/// Draws a legend at the top of a drawing and returns the position of its lower edge, mm.
pub(crate) fn draw_at_top(drawing: &mut Drawing, entries: &[Entry]) -> f64 {
    let sides = (MARGIN, drawing.width - MARGIN);
    draw(drawing, entries, sides, MARGIN + 0.75 * FONT);
    MARGIN + lines(entries, sides.1 - sides.0) as f64 * LINE
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
pub(crate) fn draw(
    drawing: &mut Drawing,
    entries: &[Entry],
    (left, right): (f64, f64),
    baseline: f64,
) {
    for (index, line) in wrapped(entries, right - left).into_iter().enumerate() {
        let mut at = left;
        for entry in line {
            entry.draw(drawing, at, baseline + index as f64 * LINE);
            at += entry.width() + Entry::AFTER;
        }
    }
}
