//! Pages: panels that share a horizontal axis, one below the other or in two columns, with legends above them.

use super::drawing::Drawing;
use super::frame::{self, Band, Frame, Quantity};
use super::legend::{self, Entry};
use super::range::{self, extremes, union};
use super::shape::{Bounds, Point, Stroke};
use super::style::{LINE, MARGIN, TWO_COLUMNS};
use super::ticks::Scale;

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
    /// The legend above the panel.
    pub(crate) legend: Vec<Entry>,
    /// The height relative to that of a normal panel.
    pub(crate) height: f64,
    /// Whether the vertical axis is broken and continues in the next panel.
    pub(crate) is_broken: bool,
    /// Whether the quantity may diverge; brief spikes are clipped and marked.
    pub(crate) is_singular: bool,
    /// The widest range that the axis may show.
    pub(crate) most: (f64, f64),
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
            legend: Vec::new(),
            height: 1.0,
            is_broken: false,
            is_singular: false,
            most: (f64::NEG_INFINITY, f64::INFINITY),
            rounding: 0.0,
        }
    }

    pub(crate) fn curve(&mut self, meaning: impl Into<String>, points: Vec<Point>, stroke: Stroke) {
        self.curves.push(Curve {
            meaning: meaning.into(),
            points,
            stroke,
        });
    }

    /// Whether nothing is drawn.
    pub(crate) fn is_empty(&self) -> bool {
        self.range() == range::NONE
    }

    /// All lines that determine the range.
    fn lines(&self) -> Vec<&[Point]> {
        let curves = self.curves.iter().map(|curve| &curve.points);
        let envelopes = self.envelopes.iter();
        let envelopes = envelopes.flat_map(|band| [&band.lower, &band.upper]);
        curves.chain(envelopes).map(Vec::as_slice).collect()
    }

    /// The range of values that the axis may show.
    pub(crate) fn range(&self) -> (f64, f64) {
        let of = |line: &[Point]| {
            if self.is_singular {
                range::without_spikes(line)
            } else {
                extremes(line.iter().map(|point| point.1))
            }
        };
        let lines = self.lines().into_iter().map(of);
        let (low, high) = lines.fold(range::NONE, union);
        if low.abs().max(high.abs()) < self.rounding {
            return (0.0, 0.0);
        }
        (low.max(self.most.0), high.min(self.most.1))
    }

    /// Whether curves go beyond this range.
    fn is_cut(&self) -> bool {
        let (low, high) = self.range();
        let values = self.lines().into_iter().flatten().map(|point| point.1);
        let (lowest, highest) = extremes(values);
        lowest < low - self.rounding || highest > high + self.rounding
    }

    /// The scale of the vertical axis: the range of the curves with padding.
    fn scale(&self, usual_height: f64) -> Scale {
        let (low, high) = self.range();
        let air = 0.06 * (high - low);
        let most = frame::ticks_up(self.height * usual_height);
        Scale::new(low - air, high + air, most)
    }
}

/// Panels and their common legend.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Page {
    /// The quantity along the horizontal axes.
    pub(crate) x: Quantity,
    pub(crate) legend: Vec<Entry>,
    pub(crate) panels: Vec<Panel>,
    /// Whether all panels show the same range of x.
    pub(crate) shares_x: bool,
}

/// The height of a panel relative to its width.
const PROPORTION: f64 = 0.46;

/// The greatest height of a panel, mm.
const TALLEST: f64 = 48.0;

/// A range that starts within this fraction of its end above zero is extended to zero.
const NEARLY_ZERO: f64 = 0.02;

/// The distance between columns, mm.
const COLUMN_GAP: f64 = 4.0;

impl Page {
    /// Draws the page with a width in mm; the height follows.
    pub(crate) fn draw(&self, width: f64) -> Drawing {
        let count = self.panels.len();
        let is_divided = self.panels.iter().any(|panel| panel.is_broken);
        let is_wide = width >= TWO_COLUMNS && count > 1 && !is_divided;
        let columns = if is_wide { 2 } else { 1 };
        let share = (width - 2.0 * MARGIN - (columns - 1) as f64 * COLUMN_GAP) / columns as f64;
        let height = TALLEST.min(share * PROPORTION);
        let scales = self.panels.iter().map(|panel| panel.scale(height));
        let scales: Vec<_> = scales.collect();
        let of_column = |column: usize| (column..count).step_by(columns);
        let sides = |column: usize| {
            let left = MARGIN + column as f64 * (share + COLUMN_GAP);
            let room =
                |index: usize| frame::room_left(&scales[index], &self.panels[index].quantity);
            let room = of_column(column).map(room).fold(0.0, f64::max);
            (left + room, left + share - frame::ROOM_RIGHT)
        };
        let sides: Vec<_> = (0..columns).map(sides).collect();
        let has_x_axis = |index: usize| !self.shares_x || index + columns >= count;

        let mut drawing = Drawing::new(width);
        let mut legend = self.legend.clone();
        if self.panels.iter().any(Panel::is_cut) {
            legend.push(Entry::beyond());
        }
        let mut top = legend::draw_at_top(&mut drawing, &legend);
        let mut frames = Vec::new();
        for panels in self.panels.chunks(columns) {
            top += self.room_above(frames.len(), &sides);
            let tall = panels.iter().map(|panel| panel.height * height);
            let bottom = top + tall.fold(0.0, f64::max);
            for (panel, (left, right)) in panels.iter().zip(&sides) {
                let index = frames.len();
                let (first, last) = self.range(panel);
                let bounds = Bounds::between((*left, top), (*right, bottom));
                let frame = Frame {
                    x: Scale::new(first, last, frame::ticks_across(bounds.width())),
                    y: scales[index].clone(),
                    bounds,
                };
                self.draw_panel(&mut drawing, index, &frame, has_x_axis(index));
                frames.push(frame);
            }
            let has_axis = has_x_axis(frames.len() - 1);
            top = bottom + if has_axis { frame::ROOM_BELOW } else { 0.0 };
        }
        // The labels of vertical axes in one column are aligned.
        for column in 0..columns {
            let widths = of_column(column).map(|index| frame::ticks_width(&scales[index]));
            let width = widths.fold(0.0, f64::max);
            for index in of_column(column) {
                frames[index].label_y(&mut drawing, &self.panels[index].quantity, width);
            }
        }
        drawing.height = top + MARGIN;
        drawing
    }

    /// The range of x of a panel.
    fn range(&self, panel: &Panel) -> (f64, f64) {
        let all = if self.shares_x {
            &self.panels[..]
        } else {
            std::slice::from_ref(panel)
        };
        let lines = all.iter().flat_map(Panel::lines);
        let (first, last) = extremes(lines.flatten().map(|point| point.0));
        let is_from_zero = (0.0..NEARLY_ZERO * last).contains(&first);
        (if is_from_zero { 0.0 } else { first }, last)
    }

    /// The space above a row, for letters and legends.
    fn room_above(&self, first: usize, sides: &[(f64, f64)]) -> f64 {
        if self.continues(first) {
            return frame::BREAK;
        }
        let panels = self.panels[first..].iter().zip(sides);
        let lines = panels
            .map(|(panel, (left, right))| legend::lines(&panel.legend, right - left - INDENT));
        let letters = usize::from(self.letter(first).is_some());
        lines.max().unwrap_or(0).max(letters) as f64 * LINE + 0.6
    }

    /// Whether a panel continues the axis of the previous one.
    fn continues(&self, index: usize) -> bool {
        index > 0 && self.panels[index - 1].is_broken
    }

    fn draw_panel(&self, drawing: &mut Drawing, index: usize, frame: &Frame, has_x_axis: bool) {
        let panel = &self.panels[index];
        for band in panel.bands.iter().chain(&panel.envelopes) {
            drawing.group(&band.meaning, frame.areas(band));
        }
        for curve in &panel.curves {
            drawing.group(&curve.meaning, frame.line(&curve.points, curve.stroke));
        }
        frame.draw(drawing);
        frame.draw_beyond(drawing, &panel.lines());
        if panel.is_broken {
            frame.draw_break(drawing);
        }
        if has_x_axis {
            frame.label_x(drawing, &self.x);
        }
        let (left, right) = (frame.bounds.left, frame.bounds.right);
        let lines = legend::lines(&panel.legend, right - left - INDENT);
        let baseline = frame.bounds.top - frame::ABOVE - lines.saturating_sub(1) as f64 * LINE;
        if let Some(letter) = self.letter(index) {
            frame::draw_letter(drawing, letter, (left, baseline));
        }
        legend::draw(drawing, &panel.legend, (left + INDENT, right), baseline);
    }

    /// The letter of a panel; the parts of a broken axis share one.
    fn letter(&self, index: usize) -> Option<char> {
        let count = |until: usize| (0..until).filter(|n| !self.continues(*n)).count();
        if count(self.panels.len()) < 2 || self.continues(index) {
            return None;
        }
        ('a'..='z').nth(count(index))
    }
}

/// Space for the letter of a panel in front of its legend, mm.
const INDENT: f64 = 6.5;
