//! Drawings: shapes and labels, before they become a file. Lengths are in mm, from the upper left corner.

use super::shape::{Point, Shape};
use super::style::FONT_SIZE;
use super::text::Text;

/// Shapes that belong together, with a description for screen readers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct ShapeGroup {
    pub(crate) meaning: String,
    pub(crate) shapes: Vec<Shape>,
}

/// Black text of size [`FONT_SIZE`] at a position in a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    pub(crate) text: Text,
    /// The start of the baseline.
    pub(crate) origin: Point,
    /// Whether the text is rotated to read upwards.
    pub(crate) is_upward: bool,
}

/// The point of a label that is placed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A drawing, which becomes a file with [`Drawing::svg`] or [`Drawing::png`].
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(crate) title: String,
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// The shapes in the order of drawing; labels are drawn last.
    pub(crate) groups: Vec<ShapeGroup>,
    pub(crate) labels: Vec<Label>,
}

impl Drawing {
    /// An empty drawing. The height is set when it is known: it follows from the content.
    pub(crate) fn new(width: f64) -> Self {
        Self {
            title: String::new(),
            width,
            height: 0.0,
            groups: Vec::new(),
            labels: Vec::new(),
        }
    }

    /// The width and height, mm.
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// Adds text on a baseline.
    pub(crate) fn label(&mut self, text: Text, (x, y): Point, anchor: Anchor) {
        let width = text.width * FONT_SIZE;
        let left = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        self.labels.push(Label {
            text,
            origin: (left, y),
            is_upward: false,
        });
    }

    /// Adds text that runs upwards, midway between two heights, with its ink to the right of `left`.
    pub(crate) fn upward_label(&mut self, text: Text, left: f64, (top, bottom): (f64, f64)) {
        let start = f64::midpoint(top, bottom) + text.width * FONT_SIZE / 2.0;
        self.labels.push(Label {
            origin: (left + text.above * FONT_SIZE, start),
            text,
            is_upward: true,
        });
    }

    /// Adds shapes with a description for screen readers, above those before.
    pub(crate) fn group(&mut self, meaning: &str, shapes: Vec<Shape>) {
        self.groups.push(ShapeGroup {
            meaning: meaning.to_owned(),
            shapes,
        });
    }
}
