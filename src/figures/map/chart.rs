//! The layout that maps and curves share.

use super::along::Along;
use crate::figures::plot::frame::{self, Frame};
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{self, MARGIN};

/// The aspect ratio of the frame.
const HEIGHT: f64 = 0.72;
/// The greatest height of the frame, mm.
const TALLEST: f64 = 90.0;

/// The radius of the dots of runs, mm.
const DOT: f64 = 0.55;

/// The height of the frame in a drawing of this width, mm.
pub(super) fn height(width: f64) -> f64 {
    TALLEST.min(width * HEIGHT)
}

/// The frame below `top` in a drawing of this width, with some room to its right, mm, whose axes show these ranges.
pub(super) fn frame(
    width: f64,
    (top, room_right): (f64, f64),
    [across, upward]: [&Along; 2],
    [x, y]: [(f64, f64); 2],
) -> Frame {
    let height = height(width);
    let y = upward.scale(y, frame::ticks_up(height));
    let left = MARGIN + frame::room_left(&y, &upward.quantity);
    let right = width - MARGIN - room_right;
    let bounds = Bounds::between((left, top), (right, top + height));
    let x = across.scale(x, frame::ticks_across(bounds.width()));
    Frame { bounds, x, y }
}

/// A range with padding at both ends.
pub(super) fn aired((low, high): (f64, f64)) -> (f64, f64) {
    let air = 0.04 * (high - low);
    (low - air, high + air)
}

pub(super) fn dot(centre: Point, fill: Colour) -> Shape {
    Shape::Dot {
        centre,
        radius: DOT,
        fill,
        stroke: style::line(fill, 0.1),
    }
}
