//! The colour map and its colour bar.

use super::axis_values::AxisValues;
use super::chart;
use super::runs::Map;
use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::frame;
use crate::figures::plot::shape::{Bounds, Colour, Shape};
use crate::figures::plot::style::{self, FONT_SIZE, MARGIN};
use crate::figures::plot::text::Text;
use crate::figures::plot::ticks::Scale;

/// The width of the bar of colours, mm.
const WIDTH: f64 = 3.0;

/// The distance from the frame of the plot to the bar, mm.
const GAP: f64 = 2.5;

/// The distance from the bar to its tick labels, mm.
const LABEL_GAP: f64 = 1.0;

/// The number of colours in the bar.
const SHADES: usize = 64;

/// Overlap of neighbouring areas, mm; avoids visible seams.
pub(super) const OVERLAP: f64 = 0.15;

/// The viridis colour map (S. van der Walt and N. Smith), perceptually uniform.
const VIRIDIS: [Colour; 9] = [
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
    values: AxisValues,
    scale: Scale,
}

impl Bar {
    /// The bar of a map's values, next to the frame of a drawing of this width.
    pub(super) fn new(map: &Map, width: f64) -> Self {
        let values = AxisValues::for_colours(&map.color, map.values(|run| run.color));
        // The bar is as high as the frame.
        let max_labels = frame::max_labels_up(chart::height(width));
        let scale = values.scale(values.range(), max_labels);
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
        GAP + WIDTH + LABEL_GAP + frame::tick_labels_width(&self.scale)
    }

    /// The colour of a value.
    pub(super) fn colour(&self, value: f64) -> Colour {
        colour_in_range(self.values.position(value), self.values.range())
    }

    /// Draws the bar next to a frame.
    pub(super) fn draw(&self, drawing: &mut Drawing, frame: Bounds) {
        let left = frame.right + GAP;
        let bounds = Bounds::between((left, frame.top), (left + WIDTH, frame.bottom));
        drawing.group("colours", self.shades(bounds));
        let mut border = bounds.corners();
        border.extend_from_within(..1);
        drawing.group("frame", Shape::lines([border], style::frame()));
        for tick in &self.scale.ticks {
            let height = self.scale.fraction(tick.value) * bounds.height();
            let place = (
                bounds.right + LABEL_GAP,
                bounds.bottom - height + 0.33 * FONT_SIZE,
            );
            drawing.label(Text::plain(&tick.label), place, Anchor::Start);
        }
        let place = (drawing.width - MARGIN, bounds.top - frame::ABOVE);
        let label = self.values.quantity.text(self.scale.exponent);
        drawing.label(label, place, Anchor::End);
    }

    /// The areas of the colours in the bar, from the bottom up.
    fn shades(&self, bounds: Bounds) -> Vec<Shape> {
        let step = bounds.height() / SHADES as f64;
        let mut shades = Vec::new();
        for index in 0..SHADES {
            let bottom = bounds.bottom - index as f64 * step;
            let top = (bottom - step - OVERLAP).max(bounds.top);
            let middle = (index as f64 + 0.5) / SHADES as f64;
            let position = self.scale.low + middle * (self.scale.high - self.scale.low);
            let colour = colour_in_range(position, self.values.range());
            shades.push(Bounds::between((bounds.left, top), (bounds.right, bottom)).area(colour));
        }
        shades
    }
}

/// The colour at a position in a range; positions outside have the colours of its ends.
fn colour_in_range(position: f64, (low, high): (f64, f64)) -> Colour {
    let fraction = if high > low {
        ((position - low) / (high - low)).clamp(0.0, 1.0)
    } else {
        0.5
    };
    let place = fraction * (VIRIDIS.len() - 1) as f64;
    let index = (place as usize).min(VIRIDIS.len() - 2);
    mix(VIRIDIS[index], VIRIDIS[index + 1], place - index as f64)
}

/// The colour between two others; `share` is the part of the second, from 0 to 1.
fn mix(Colour(r0, g0, b0): Colour, Colour(r1, g1, b1): Colour, share: f64) -> Colour {
    Colour(
        mix_component(r0, r1, share),
        mix_component(g0, g1, share),
        mix_component(b0, b1, share),
    )
}

fn mix_component(first: u8, second: u8, share: f64) -> u8 {
    let (first, second) = (f64::from(first), f64::from(second));
    (first + share * (second - first)).round() as u8
}
