//! Drawings: shapes and labels, before they become a file. Lengths are in mm, from the upper left corner.

#[cfg(test)]
use super::shape::Bounds;
use super::shape::{Colour, Point, Shape};
use super::style::{self, FONT};
use super::text::Text;

/// Shapes that belong together, with a description for screen readers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Group {
    pub(crate) meaning: String,
    pub(crate) shapes: Vec<Shape>,
}

/// A text at a place of a drawing.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Label {
    pub(crate) text: Text,
    /// The start of the baseline.
    pub(crate) origin: Point,
    /// The size of an em, mm.
    pub(crate) size: f64,
    /// Whether the text runs upwards.
    pub(crate) is_upward: bool,
    pub(crate) colour: Colour,
}

#[cfg(test)]
impl Label {
    /// The space that the label takes.
    pub(crate) fn bounds(&self) -> Bounds {
        let (x, y) = self.origin;
        let [width, above, below] =
            [self.text.width, self.text.above, self.text.below].map(|em| em * self.size);
        if self.is_upward {
            Bounds {
                left: x - above,
                top: y - width,
                right: x + below,
                bottom: y,
            }
        } else {
            Bounds {
                left: x,
                top: y - above,
                right: x + width,
                bottom: y + below,
            }
        }
    }
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
    pub(crate) groups: Vec<Group>,
    pub(crate) labels: Vec<Label>,
}

impl Drawing {
    /// The width and height, mm.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// An empty drawing; the height is set when it is known.
    pub(crate) fn new(width: f64) -> Self {
        Self {
            title: String::new(),
            width,
            height: 0.0,
            groups: Vec::new(),
            labels: Vec::new(),
        }
    }

    /// Adds a text on a baseline.
    pub(crate) fn label(&mut self, text: Text, (x, y): Point, anchor: Anchor) {
        let width = text.width * FONT;
        let x = match anchor {
            Anchor::Start => x,
            Anchor::Middle => x - width / 2.0,
            Anchor::End => x - width,
        };
        self.labels.push(Label {
            text,
            origin: (x, y),
            size: FONT,
            is_upward: false,
            colour: style::BLACK,
        });
    }

    /// Adds a text that runs upwards in the middle of two heights, with its ink right of `left`.
    pub(crate) fn upward_label(&mut self, text: Text, left: f64, (top, bottom): (f64, f64)) {
        let y = f64::midpoint(top, bottom) + text.width * FONT / 2.0;
        self.labels.push(Label {
            origin: (left + text.above * FONT, y),
            text,
            size: FONT,
            is_upward: true,
            colour: style::BLACK,
        });
    }

    pub(crate) fn group(&mut self, meaning: &str, shapes: Vec<Shape>) {
        self.groups.push(Group {
            meaning: meaning.to_owned(),
            shapes,
        });
    }
}
