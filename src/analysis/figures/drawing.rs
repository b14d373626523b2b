//! A figure as shapes and labels, before it becomes a file. Lengths are in mm, from the upper left corner.

use super::style::{self, FONT};
use super::text::Text;

/// A colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Colour(pub(super) u8, pub(super) u8, pub(super) u8);

/// A place: to the right, and downwards.
pub(super) type Point = (f64, f64);

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Bounds {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) right: f64,
    pub(super) bottom: f64,
}

impl Bounds {
    pub(super) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(super) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    pub(super) fn corners(&self) -> Vec<Point> {
        vec![
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
        ]
    }

    /// The part of a segment within it.
    pub(super) fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let edges = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        for (slope, room) in edges {
            if slope == 0.0 && room < 0.0 {
                return None;
            }
            let at = room / slope;
            if slope < 0.0 {
                from = from.max(at);
            } else if slope > 0.0 {
                to = to.min(at);
            }
        }
        let point = |t: f64| (a.0 + t * dx, a.1 + t * dy);
        (from <= to).then(|| (point(from), point(to)))
    }

    /// The parts of a line within it.
    pub(super) fn clip_line(&self, line: &[Point]) -> Vec<Vec<Point>> {
        let mut parts: Vec<Vec<Point>> = Vec::new();
        for pair in line.windows(2) {
            let Some((from, to)) = self.clip(pair[0], pair[1]) else {
                continue;
            };
            match parts.last_mut() {
                Some(part) if part.last() == Some(&from) => part.push(to),
                _ => parts.push(vec![from, to]),
            }
        }
        parts
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stroke {
    pub(super) colour: Colour,
    pub(super) width: f64,
    /// Lengths of dashes and gaps by turns; empty for a solid line.
    pub(super) dash: &'static [f64],
    pub(super) opacity: f64,
}

/// Something that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Shape {
    /// An open line.
    Line { points: Vec<Point>, stroke: Stroke },
    /// A filled polygon.
    Area { points: Vec<Point>, fill: Colour },
    /// A dot, filled or not.
    Dot {
        centre: Point,
        radius: f64,
        fill: Colour,
        stroke: Stroke,
    },
}

/// Shapes that belong together, and what they are.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Group {
    pub(super) meaning: String,
    pub(super) shapes: Vec<Shape>,
}

/// A text at its place.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Label {
    pub(super) text: Text,
    /// Where its baseline begins.
    pub(super) origin: Point,
    /// Em, mm.
    pub(super) size: f64,
    /// Whether it runs upwards.
    pub(super) is_upward: bool,
    pub(super) colour: Colour,
}

#[cfg(test)]
impl Label {
    /// The space that it takes.
    pub(super) fn bounds(&self) -> Bounds {
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

/// Which point of a label is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// A whole figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(super) title: String,
    pub(super) width: f64,
    pub(super) height: f64,
    /// In the order of drawing; labels are drawn last.
    pub(super) groups: Vec<Group>,
    pub(super) labels: Vec<Label>,
}

impl Drawing {
    /// Its width and height, mm.
    #[must_use]
    pub fn size(&self) -> (f64, f64) {
        (self.width, self.height)
    }

    /// An empty figure; its height is given when it is known.
    pub(super) fn new(width: f64) -> Self {
        Self {
            title: String::new(),
            width,
            height: 0.0,
            groups: Vec::new(),
            labels: Vec::new(),
        }
    }

    /// Puts a text on a baseline.
    pub(super) fn label(&mut self, text: Text, (x, y): Point, anchor: Anchor) {
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

    /// Puts a text that runs upwards between two heights, with its ink right of `left`.
    pub(super) fn upward_label(&mut self, text: Text, left: f64, (top, bottom): (f64, f64)) {
        let y = f64::midpoint(top, bottom) + text.width * FONT / 2.0;
        self.labels.push(Label {
            origin: (left + text.above * FONT, y),
            text,
            size: FONT,
            is_upward: true,
            colour: style::BLACK,
        });
    }

    pub(super) fn group(&mut self, meaning: &str, shapes: Vec<Shape>) {
        self.groups.push(Group {
            meaning: meaning.to_owned(),
            shapes,
        });
    }
}
