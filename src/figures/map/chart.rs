//! The layout that maps and curves share.

use super::axis_values::AxisValues;
use crate::figures::plot::frame::{self, Frame};
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{self, MARGIN};

/// The height of the frame relative to the width of the drawing.
const PROPORTION: f64 = 0.72;

/// The greatest height of the frame, mm.
const MAX_HEIGHT: f64 = 90.0;

/// The padding at both ends of a range, relative to its length.
const PADDING: f64 = 0.04;

/// The radius of the dots of runs, mm.
const DOT: f64 = 0.55;

/// The height of the frame in a drawing of this width, mm.
pub(super) fn height(width: f64) -> f64 {
    MAX_HEIGHT.min(width * PROPORTION)
}

/// The frame below `top` in a drawing of this width, with some room to its right, mm, whose axes show these ranges.
pub(super) fn frame(
    width: f64,
    (top, room_right): (f64, f64),
    [across, upward]: [&AxisValues; 2],
    [x, y]: [(f64, f64); 2],
) -> Frame {
    let height = height(width);
    let y = upward.scale(y, frame::max_labels_up(height));
    let left = MARGIN + frame::room_left(&y, &upward.quantity);
    let right = width - MARGIN - room_right;
    let bounds = Bounds::between((left, top), (right, top + height));
    let x = across.scale(x, frame::max_labels_across(bounds.width()));
    Frame { bounds, x, y }
}

/// A range with padding at both ends.
pub(super) fn padded((low, high): (f64, f64)) -> (f64, f64) {
    let padding = PADDING * (high - low);
    (low - padding, high + padding)
}

/// The dot of a run.
pub(super) fn dot(centre: Point, fill: Colour) -> Shape {
    Shape::Dot {
        centre,
        radius: DOT,
        fill,
        stroke: style::line(fill, 0.1),
    }
}
