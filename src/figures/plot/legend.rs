//! Legends: the meanings of the lines, areas and dots of a drawing.

use super::drawing::{Anchor, Drawing};
use super::shape::{Bounds, Colour, Point, Shape, Stroke};
use super::style::{self, FONT_SIZE, LINE_HEIGHT, MARGIN};
use super::text::Text;

/// The width of lines and areas in a legend, mm.
const SAMPLE_WIDTH: f64 = 6.5;

/// The space between the sample and the text of an entry, mm.
const AFTER_SAMPLE: f64 = 1.2;

/// The space between two entries, mm.
const AFTER_ENTRY: f64 = 4.0;

/// Half the width of a mark at the end of an axis, and half its height, mm.
const MARK: f64 = 0.9;

/// The radius of the dots at the ends of a path, mm.
const DOT: f64 = 0.7;

/// An entry of a legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct LegendEntry {
    sample: LegendSymbol,
    pub(crate) text: Text,
}

/// The symbol before the text of an entry.
#[derive(Clone, Copy, Debug, PartialEq)]
enum LegendSymbol {
    Line(Stroke),
    Area(Colour),
    Start,
    End,
    /// The marks of curves that go beyond their axis.
    Marks,
    /// No symbol: the text is a note.
    None,
}

impl LegendEntry {
    fn new(sample: LegendSymbol, text: Text) -> Self {
        Self { sample, text }
    }

    /// The entry of a line whose text is typeset already.
    pub(crate) fn from_text(stroke: Stroke, text: Text) -> Self {
        Self::new(LegendSymbol::Line(stroke), text)
    }

    /// The entry of a line.
    pub(crate) fn line(stroke: Stroke, markup: &str) -> Self {
        Self::from_text(stroke, Text::markup(markup))
    }

    /// The entry of an area.
    pub(crate) fn area(fill: Colour, markup: &str) -> Self {
        Self::new(LegendSymbol::Area(fill), Text::markup(markup))
    }

    /// The entries of the dots at the ends of a path.
    pub(crate) fn ends() -> [Self; 2] {
        [
            Self::new(LegendSymbol::Start, Text::plain("start")),
            Self::new(LegendSymbol::End, Text::plain("end")),
        ]
    }

    /// The entry of a dot.
    pub(crate) fn dot(text: &str) -> Self {
        Self::new(LegendSymbol::End, Text::plain(text))
    }

    /// The entry of the marks where curves exceed their axis.
    pub(crate) fn beyond() -> Self {
        Self::new(LegendSymbol::Marks, Text::plain("beyond the axis"))
    }

    /// A note without a symbol.
    pub(crate) fn note(text: &str) -> Self {
        Self::new(LegendSymbol::None, Text::plain(text))
    }

    /// The width of symbol and text, mm.
    fn width(&self) -> f64 {
        self.indent() + self.text.width * FONT_SIZE
    }

    /// The width of the symbol before the text, mm.
    fn indent(&self) -> f64 {
        match self.sample {
            LegendSymbol::Line(_) | LegendSymbol::Area(_) => SAMPLE_WIDTH + AFTER_SAMPLE,
            LegendSymbol::Start | LegendSymbol::End => 2.0 * DOT + AFTER_SAMPLE,
            LegendSymbol::Marks => 4.0 * MARK + 0.6 + AFTER_SAMPLE,
            LegendSymbol::None => 0.0,
        }
    }

    fn draw(&self, drawing: &mut Drawing, left: f64, baseline: f64) {
        let start = left + self.indent();
        let shapes = self.sample.shapes(left, start - AFTER_SAMPLE, baseline);
        if !shapes.is_empty() {
            drawing.group(&format!("key: {}", self.text.spoken), shapes);
        }
        drawing.label(self.text.clone(), (start, baseline), Anchor::Start);
    }
}

impl LegendSymbol {
    /// The symbol between two sides, before text on a baseline.
    fn shapes(self, left: f64, right: f64, baseline: f64) -> Vec<Shape> {
        let middle = baseline - 0.24 * FONT_SIZE;
        match self {
            Self::Line(stroke) => vec![Shape::Line {
                points: vec![(left, middle), (right, middle)],
                stroke,
            }],
            Self::Area(fill) => {
                let (top, bottom) = (middle - 0.35 * FONT_SIZE, middle + 0.35 * FONT_SIZE);
                vec![Bounds::between((left, top), (right, bottom)).area(fill)]
            }
            Self::Start => vec![start_dot((left + DOT, middle), style::BLACK)],
            Self::End => vec![end_dot((left + DOT, middle), style::BLACK)],
            Self::Marks => vec![
                mark((left + MARK, middle - MARK), 1.0),
                mark((right - MARK, middle + MARK), -1.0),
            ],
            Self::None => Vec::new(),
        }
    }
}

/// A triangle with its tip at a point; it points upwards for 1 and downwards for −1.
pub(crate) fn mark((x, y): Point, upward: f64) -> Shape {
    let base = y + upward * 2.0 * MARK;
    Shape::Area {
        points: vec![(x, y), (x + MARK, base), (x - MARK, base)],
        fill: style::BLACK,
    }
}

/// A ring at the start of a path.
pub(crate) fn start_dot(centre: Point, colour: Colour) -> Shape {
    dot(centre, style::WHITE, colour)
}

/// A filled dot at the end of a path.
pub(crate) fn end_dot(centre: Point, colour: Colour) -> Shape {
    dot(centre, colour, colour)
}

fn dot(centre: Point, fill: Colour, outline: Colour) -> Shape {
    Shape::Dot {
        centre,
        radius: DOT,
        fill,
        stroke: style::line(outline, style::HAIRLINE),
    }
}

/// The number of lines of a legend.
pub(crate) fn line_count(entries: &[LegendEntry], width: f64) -> usize {
    wrap(entries, width).len()
}

/// Draws a legend at the top of a drawing and returns the position of its lower edge, mm.
pub(crate) fn draw_at_top(drawing: &mut Drawing, entries: &[LegendEntry]) -> f64 {
    let sides = (MARGIN, drawing.width - MARGIN);
    draw(drawing, entries, sides, MARGIN + 0.75 * FONT_SIZE);
    MARGIN + line_count(entries, sides.1 - sides.0) as f64 * LINE_HEIGHT
}

/// Divides entries into lines of a width.
fn wrap(entries: &[LegendEntry], width: f64) -> Vec<&[LegendEntry]> {
    let mut lines = Vec::new();
    let (mut start, mut used) = (0, 0.0);
    for (index, entry) in entries.iter().enumerate() {
        // An entry that is wider than a line gets a line of its own.
        if index > start && used + entry.width() > width {
            lines.push(&entries[start..index]);
            (start, used) = (index, 0.0);
        }
        used += entry.width() + AFTER_ENTRY;
    }
    if start < entries.len() {
        lines.push(&entries[start..]);
    }
    lines
}

/// Draws a legend whose first baseline is at `baseline`.
pub(crate) fn draw(
    drawing: &mut Drawing,
    entries: &[LegendEntry],
    (left, right): (f64, f64),
    baseline: f64,
) {
    for (index, line) in wrap(entries, right - left).into_iter().enumerate() {
        let mut entry_left = left;
        for entry in line {
            entry.draw(drawing, entry_left, baseline + index as f64 * LINE_HEIGHT);
            entry_left += entry.width() + AFTER_ENTRY;
        }
    }
}
