//! Shapes: lines, areas and dots. Lengths are in mm, from the upper left corner.

/// A colour: red, green, blue.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Colour(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// A point: distances to the right and downwards.
pub(crate) type Point = (f64, f64);

/// A rectangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) right: f64,
    pub(crate) bottom: f64,
}

impl Bounds {
    /// The rectangle with this upper left corner.
    pub(crate) fn new((left, top): Point, width: f64, height: f64) -> Self {
        Self::between((left, top), (left + width, top + height))
    }

    /// The rectangle between its upper left and its lower right corner.
    pub(crate) fn between((left, top): Point, (right, bottom): Point) -> Self {
        Self {
            left,
            top,
            right,
            bottom,
        }
    }

    pub(crate) fn width(&self) -> f64 {
        self.right - self.left
    }

    pub(crate) fn height(&self) -> f64 {
        self.bottom - self.top
    }

    /// The corners, clockwise from the upper left.
    pub(crate) fn corners(&self) -> Vec<Point> {
        vec![
            (self.left, self.top),
            (self.right, self.top),
            (self.right, self.bottom),
            (self.left, self.bottom),
        ]
    }

    /// The rectangle as a filled area.
    pub(crate) fn area(&self, fill: Colour) -> Shape {
        let points = self.corners();
        Shape::Area { points, fill }
    }

    /// The part of a segment within the rectangle, by the algorithm of Liang and Barsky.
    pub(crate) fn clip(&self, a: Point, b: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        let edges = [
            (-dx, a.0 - self.left),
            (dx, self.right - a.0),
            (-dy, a.1 - self.top),
            (dy, self.bottom - a.1),
        ];
        for (slope, room) in edges {
            // Parallel to this edge, and outside.
            if slope == 0.0 && room < 0.0 {
                return None;
            }
            let crossing = room / slope;
            if slope < 0.0 {
                from = from.max(crossing);
            } else if slope > 0.0 {
                to = to.min(crossing);
            }
        }
        if from > to {
            return None;
        }
        let start = (a.0 + from * dx, a.1 + from * dy);
        let end = (a.0 + to * dx, a.1 + to * dy);
        Some((start, end))
    }

    /// The parts of a line within the rectangle.
    pub(crate) fn clip_line(&self, line: &[Point]) -> Vec<Vec<Point>> {
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

/// The pen of a line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) colour: Colour,
    /// The width, mm.
    pub(crate) width: f64,
    /// Alternating lengths of dashes and gaps, mm; empty for a solid line.
    pub(crate) dash: &'static [f64],
    /// The opacity, from 0 to 1.
    pub(crate) opacity: f64,
}

/// A part of a drawing. Lengths are in mm.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Shape {
    /// An open line.
    Line { points: Vec<Point>, stroke: Stroke },
    /// A filled polygon.
    Area { points: Vec<Point>, fill: Colour },
    /// A filled circle with an outline.
    Dot {
        centre: Point,
        radius: f64,
        fill: Colour,
        stroke: Stroke,
    },
}

impl Shape {
    /// Open lines of one stroke.
    pub(crate) fn lines(lines: impl IntoIterator<Item = Vec<Point>>, stroke: Stroke) -> Vec<Self> {
        lines
            .into_iter()
            .map(|points| Self::Line { points, stroke })
            .collect()
    }
}
