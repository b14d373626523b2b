//! Pages: panels that share a horizontal axis, one below the other or in two columns, with legends above them.

use super::drawing::Drawing;
use super::frame::{self, Band, Frame, Quantity};
use super::legend::{self, LegendEntry};
use super::range::{self, extremes, union};
use super::shape::{Bounds, Point, Stroke};
use super::style::{LINE_HEIGHT, MARGIN, TWO_COLUMNS};
use super::ticks::Scale;

/// The height of a panel relative to its width.
const PROPORTION: f64 = 0.46;

/// The greatest height of a panel, mm.
const MAX_HEIGHT: f64 = 48.0;

/// Padding of the vertical axis above and below the curves, relative to their range.
const PADDING: f64 = 0.06;

/// A range that starts within this fraction of its end above zero is extended to zero.
const NEARLY_ZERO: f64 = 0.02;

/// The distance between columns, mm.
const COLUMN_GAP: f64 = 4.0;

/// Space for the letter of a panel in front of its legend, mm.
const INDENT: f64 = 6.5;

/// A curve of a panel.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Curve {
    pub(crate) meaning: String,
    pub(crate) points: Vec<Point>,
    pub(crate) stroke: Stroke,
}

/// One plot of a page.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Panel {
    pub(crate) quantity: Quantity,
    /// Regions behind the curves, which may be larger than the panel.
    pub(crate) bands: Vec<Band>,
    /// Regions in which curves oscillate too fast to be drawn.
    pub(crate) envelopes: Vec<Band>,
    /// The curves in the order of drawing.
    pub(crate) curves: Vec<Curve>,
    /// Values that are drawn as dots below the curves.
    pub(crate) dots: Vec<Curve>,
    /// The legend above the panel.
    pub(crate) legend: Vec<LegendEntry>,
    /// The height relative to that of a normal panel.
    pub(crate) height: f64,
    /// Whether the vertical axis is broken and continues in the next panel.
    pub(crate) is_broken: bool,
    /// Whether the quantity may diverge; brief spikes are clipped and marked.
    pub(crate) is_singular: bool,
    /// The widest range that the axis may show.
    pub(crate) max_range: (f64, f64),
    /// Values below this magnitude are rounding errors and are drawn as zero.
    pub(crate) rounding: f64,
}

impl Panel {
    pub(crate) fn new(symbol: &'static str, unit: &'static str) -> Self {
        Self {
            quantity: Quantity::new(symbol, unit),
            bands: Vec::new(),
            envelopes: Vec::new(),
            curves: Vec::new(),
            dots: Vec::new(),
            legend: Vec::new(),
            height: 1.0,
            is_broken: false,
            is_singular: false,
            max_range: (f64::NEG_INFINITY, f64::INFINITY),
            rounding: 0.0,
        }
    }

    /// Adds a curve above those before.
    pub(crate) fn curve(&mut self, meaning: impl Into<String>, points: Vec<Point>, stroke: Stroke) {
        self.curves.push(Curve {
            meaning: meaning.into(),
            points,
            stroke,
        });
    }

    /// Adds values as dots.
    #[cfg(feature = "fit")]
    pub(crate) fn dots(&mut self, meaning: impl Into<String>, points: Vec<Point>, stroke: Stroke) {
        self.dots.push(Curve {
            meaning: meaning.into(),
            points,
            stroke,
        });
    }

    /// Whether nothing is drawn.
    pub(crate) fn is_empty(&self) -> bool {
        self.range() == range::EMPTY
    }

    /// Whether all values are zero, up to rounding errors.
    pub(crate) fn is_zero(&self) -> bool {
        self.range() == (0.0, 0.0)
    }

    /// All lines that determine the range: curves, dots, and the edges of envelopes.
    fn lines(&self) -> Vec<&[Point]> {
        let mut lines: Vec<&[Point]> = Vec::new();
        for curve in self.curves.iter().chain(&self.dots) {
            lines.push(&curve.points);
        }
        for envelope in &self.envelopes {
            lines.extend([&envelope.lower[..], &envelope.upper[..]]);
        }
        lines
    }

    /// The range of values that the axis may show.
    pub(crate) fn range(&self) -> (f64, f64) {
        let (low, high) = self
            .lines()
            .into_iter()
            .map(|line| self.range_of_line(line))
            .fold(range::EMPTY, union);
        if low.abs().max(high.abs()) < self.rounding {
            return (0.0, 0.0);
        }
        (low.max(self.max_range.0), high.min(self.max_range.1))
    }

    fn range_of_line(&self, line: &[Point]) -> (f64, f64) {
        if self.is_singular {
            range::without_spikes(line)
        } else {
            extremes(line.iter().map(|point| point.1))
        }
    }

    /// Whether curves go beyond this range.
    fn is_cut(&self) -> bool {
        let (low, high) = self.range();
        let values = self.lines().into_iter().flatten().map(|point| point.1);
        let (lowest, highest) = extremes(values);
        lowest < low - self.rounding || highest > high + self.rounding
    }

    /// The scale of the vertical axis: the range of the curves with padding.
    fn scale(&self, normal_height: f64) -> Scale {
        let (low, high) = range::widened(self.range(), self.rounding);
        let padding = PADDING * (high - low);
        let max_labels = frame::max_labels_up(self.height * normal_height);
        Scale::new(low - padding, high + padding, max_labels)
    }
}

/// Panels and their common legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Page {
    /// The quantity along the horizontal axes.
    pub(crate) x: Quantity,
    pub(crate) legend: Vec<LegendEntry>,
    pub(crate) panels: Vec<Panel>,
    /// Whether all panels show the same range of x.
    pub(crate) shares_x: bool,
}

/// The arrangement of panels in columns.
struct PageLayout {
    columns: usize,
    /// The height of a normal panel, mm.
    height: f64,
    /// The vertical axis of each panel.
    scales: Vec<Scale>,
    /// The left and the right side of the frames in each column, mm.
    sides: Vec<(f64, f64)>,
}

impl PageLayout {
    fn new(page: &Page, width: f64) -> Self {
        let count = page.panels.len();
        // The parts of a broken axis are one above the other.
        let is_broken = page.panels.iter().any(|panel| panel.is_broken);
        let is_wide = width >= TWO_COLUMNS && count > 1 && !is_broken;
        let columns = if is_wide { 2 } else { 1 };
        let share = (width - 2.0 * MARGIN - (columns - 1) as f64 * COLUMN_GAP) / columns as f64;
        let height = MAX_HEIGHT.min(share * PROPORTION);
        let mut layout = Self {
            columns,
            height,
            scales: page
                .panels
                .iter()
                .map(|panel| panel.scale(height))
                .collect(),
            sides: Vec::new(),
        };
        for column in 0..columns {
            let left = MARGIN + column as f64 * (share + COLUMN_GAP);
            let room = layout
                .panels_in_column(column)
                .map(|index| frame::room_left(&layout.scales[index], &page.panels[index].quantity))
                .fold(0.0, f64::max);
            layout
                .sides
                .push((left + room, left + share - frame::ROOM_RIGHT));
        }
        layout
    }

    /// The indices of the panels in a column.
    fn panels_in_column(&self, column: usize) -> impl Iterator<Item = usize> {
        (column..self.scales.len()).step_by(self.columns)
    }

    /// Whether a panel is the lowest in its column.
    fn is_lowest(&self, panel: usize) -> bool {
        panel + self.columns >= self.scales.len()
    }

    /// The height of the highest panel in a row, mm.
    fn row_height(&self, row: &[Panel]) -> f64 {
        row.iter()
            .map(|panel| panel.height * self.height)
            .fold(0.0, f64::max)
    }

    /// The width of the tick labels in a column, mm.
    fn tick_labels_width(&self, column: usize) -> f64 {
        self.panels_in_column(column)
            .map(|index| frame::tick_labels_width(&self.scales[index]))
            .fold(0.0, f64::max)
    }
}

impl Page {
    /// Draws the page with a width in mm; the height follows.
    pub(crate) fn draw(&self, width: f64) -> Drawing {
        let layout = PageLayout::new(self, width);
        let mut drawing = Drawing::new(width);
        let mut legend = self.legend.clone();
        if self.panels.iter().any(Panel::is_cut) {
            legend.push(LegendEntry::beyond());
        }
        let mut top = legend::draw_at_top(&mut drawing, &legend);
        let mut frames = Vec::new();
        for row in self.panels.chunks(layout.columns) {
            top += self.room_above(frames.len(), &layout.sides);
            let bottom = top + layout.row_height(row);
            for (panel, (left, right)) in row.iter().zip(&layout.sides) {
                let index = frames.len();
                let bounds = Bounds::between((*left, top), (*right, bottom));
                let (first, last) = self.x_range(panel);
                let frame = Frame {
                    x: Scale::new(first, last, frame::max_labels_across(bounds.width())),
                    y: layout.scales[index].clone(),
                    bounds,
                };
                self.draw_panel(&mut drawing, index, &frame);
                if self.has_x_axis(index, &layout) {
                    frame.label_x(&mut drawing, &self.x);
                }
                self.draw_heading(&mut drawing, index, &frame);
                frames.push(frame);
            }
            top = bottom;
            if self.has_x_axis(frames.len() - 1, &layout) {
                top += frame::ROOM_BELOW;
            }
        }
        // The labels of vertical axes in one column are aligned.
        for column in 0..layout.columns {
            let width = layout.tick_labels_width(column);
            for index in layout.panels_in_column(column) {
                frames[index].label_y(&mut drawing, &self.panels[index].quantity, width);
            }
        }
        drawing.height = top + MARGIN;
        drawing
    }

    /// Whether a panel has labels at its horizontal axis.
    fn has_x_axis(&self, index: usize, layout: &PageLayout) -> bool {
        !self.shares_x || layout.is_lowest(index)
    }

    /// The range of x of a panel.
    fn x_range(&self, panel: &Panel) -> (f64, f64) {
        let panels = if self.shares_x {
            &self.panels[..]
        } else {
            std::slice::from_ref(panel)
        };
        let lines = panels.iter().flat_map(Panel::lines);
        let (first, last) = extremes(lines.flatten().map(|point| point.0));
        // Means begin half a nutation after the start, where an axis should not begin.
        let is_from_zero = (0.0..NEARLY_ZERO * last).contains(&first);
        (if is_from_zero { 0.0 } else { first }, last)
    }

    /// The space above a row, for letters and legends, mm.
    fn room_above(&self, first: usize, sides: &[(f64, f64)]) -> f64 {
        if self.continues(first) {
            return frame::BREAK;
        }
        let letter_lines = usize::from(self.letter(first).is_some());
        let lines = self.panels[first..]
            .iter()
            .zip(sides)
            .map(|(panel, (left, right))| legend::line_count(&panel.legend, right - left - INDENT))
            .fold(letter_lines, usize::max);
        lines as f64 * LINE_HEIGHT + 0.6
    }

    /// Whether a panel continues the axis of the previous one.
    fn continues(&self, index: usize) -> bool {
        index > 0 && self.panels[index - 1].is_broken
    }

    /// Draws regions, curves and frame of a panel.
    fn draw_panel(&self, drawing: &mut Drawing, index: usize, frame: &Frame) {
        let panel = &self.panels[index];
        for band in panel.bands.iter().chain(&panel.envelopes) {
            drawing.group(&band.meaning, frame.areas(band));
        }
        for values in &panel.dots {
            drawing.group(&values.meaning, frame.dots(&values.points, values.stroke));
        }
        for curve in &panel.curves {
            drawing.group(&curve.meaning, frame.line(&curve.points, curve.stroke));
        }
        frame.draw(drawing);
        frame.draw_beyond(drawing, &panel.lines());
        if panel.is_broken {
            frame.draw_break(drawing);
        }
    }

    /// Draws the letter and the legend above a panel.
    fn draw_heading(&self, drawing: &mut Drawing, index: usize, frame: &Frame) {
        let entries = &self.panels[index].legend;
        let (left, right) = (frame.bounds.left, frame.bounds.right);
        let lines = legend::line_count(entries, right - left - INDENT);
        let baseline =
            frame.bounds.top - frame::ABOVE - lines.saturating_sub(1) as f64 * LINE_HEIGHT;
        if let Some(letter) = self.letter(index) {
            frame::draw_letter(drawing, letter, (left, baseline));
        }
        legend::draw(drawing, entries, (left + INDENT, right), baseline);
    }

    /// The letter of a panel; the parts of a broken axis share one. A single plot has none.
    fn letter(&self, index: usize) -> Option<char> {
        if self.plots_before(self.panels.len()) < 2 || self.continues(index) {
            return None;
        }
        ('a'..='z').nth(self.plots_before(index))
    }

    /// The number of plots before a panel, in which the parts of a broken axis are one plot.
    fn plots_before(&self, index: usize) -> usize {
        (0..index).filter(|panel| !self.continues(*panel)).count()
    }
}
