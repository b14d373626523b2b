//! The colour map and its colour bar.

use super::along::Along;
use super::chart;
use super::runs::Map;
use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::frame;
use crate::figures::plot::shape::{Bounds, Colour, Shape};
use crate::figures::plot::style::{self, FONT, MARGIN};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::Scale;

/// The width of the bar of colours, and its distances from the frame and from its numbers, mm.
const BAR: f64 = 3.0;
const BAR_GAP: f64 = 2.5;
const NUMBER_GAP: f64 = 1.0;
/// The number of colours in the bar.
const SHADES: usize = 64;

/// Overlap of neighbouring areas, mm; avoids visible seams.
pub(super) const OVERLAP: f64 = 0.15;

/// The viridis colour map (S. van der Walt and N. Smith), perceptually uniform.
const RAMP: [Colour; 9] = [
    Colour(68, 1, 84),
    Colour(71, 44, 122),
    Colour(59, 81, 139),
    Colour(44, 113, 142),
    Colour(33, 144, 141),
    Colour(39, 173, 129),
    Colour(92, 200, 99),
    Colour(170, 220, 50),
    Colour(253, 231, 37),
];

/// A bar of colours.
pub(super) struct Bar {
    values: Along,
    scale: Scale,
}

impl Bar {
    /// The bar of a map's values, next to the frame of a drawing of this width.
    pub(super) fn new(map: &Map, width: f64) -> Self {
        let values = Along::of_colours(&map.color, map.values(|run| run.color));
        let scale = values.scale(values.range(), frame::ticks_up(chart::height(width)));
        Self { values, scale }
    }

    /// Whether there are no values.
    pub(super) fn is_empty(&self) -> bool {
        self.values.values.is_empty()
    }

    /// The width needed by the bar to the right of the frame, mm.
    pub(super) fn room(&self) -> f64 {
        if self.is_empty() {
            return frame::ROOM_RIGHT;
        }
        BAR_GAP + BAR + NUMBER_GAP + frame::ticks_width(&self.scale)
    }

    /// The colour of a value.
    pub(super) fn colour(&self, value: f64) -> Colour {
        shade(self.values.place(value), self.values.range())
    }

    /// Draws the bar next to a frame.
    pub(super) fn draw(&self, drawing: &mut Drawing, frame: Bounds) {
        let left = frame.right + BAR_GAP;
        let right = left + BAR;
        let bounds = Bounds::between((left, frame.top), (right, frame.bottom));
        let (scale, range) = (&self.scale, self.values.range());
        let step = bounds.height() / SHADES as f64;
        let area = |index: usize| {
            let bottom = bounds.bottom - index as f64 * step;
            let middle = (index as f64 + 0.5) / SHADES as f64;
            let value = scale.low + middle * (scale.high - scale.low);
            let top = (bottom - step - OVERLAP).max(bounds.top);
            Bounds::between((left, top), (right, bottom)).area(shade(value, range))
        };
        drawing.group("colours", (0..SHADES).map(area).collect());
        let mut points = bounds.corners();
        points.extend_from_within(..1);
        let stroke = style::frame();
        drawing.group("frame", vec![Shape::Line { points, stroke }]);
        for tick in &scale.ticks {
            let y = bounds.bottom - scale.place(tick.value) * bounds.height() + 0.33 * FONT;
            let place = (right + NUMBER_GAP, y);
            drawing.label(Text::plain(&tick.label), place, Anchor::Start);
        }
        let place = (drawing.width - MARGIN, bounds.top - frame::ABOVE);
        let label = self.values.quantity.text(scale.exponent);
        drawing.label(label, place, Anchor::End);
    }
}

/// The colour at a position in a range.
fn shade(place: f64, (low, high): (f64, f64)) -> Colour {
    let part = if high > low {
        ((place - low) / (high - low)).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let place = part * (RAMP.len() - 1) as f64;
    let index = (place as usize).min(RAMP.len() - 2);
    let (Colour(r0, g0, b0), Colour(r1, g1, b1)) = (RAMP[index], RAMP[index + 1]);
    let share = place - index as f64;
    let mix = |one: u8, other: u8| {
        (f64::from(one) + share * (f64::from(other) - f64::from(one))).round() as u8
    };
    Colour(mix(r0, r1), mix(g0, g1), mix(b0, b1))
}
