//! The corner of correlations: for each pair of parameters the ellipses of their joint 68.3 % and 95.4 %.

use crate::figures::plot::drawing::{Anchor, Drawing};
use crate::figures::plot::legend::{self, LegendEntry};
use crate::figures::plot::shape::{Bounds, Colour, Point, Shape};
use crate::figures::plot::style::{self, BLACK, FONT_SIZE, HAIRLINE, LINE_HEIGHT, MARGIN};
use crate::figures::plot::text::Text;
use crate::fit::Fit;
use crate::physics::math::{cos, sin};
use std::f64::consts::TAU;

/// Half axes of the ellipses in standard deviations: √Δχ² of 68.3 % and 95.4 % for two parameters.
const RADII: [f64; 2] = [1.515, 2.486];

/// Colours of the areas within the outer and the inner ellipse.
const FILLS: [Colour; 2] = [Colour(0xd6, 0xea, 0xf6), Colour(0x9c, 0xce, 0xec)];

/// Half width of a box in standard deviations.
const HALF_WIDTH: f64 = 3.0;

/// Distance between two boxes, mm.
const GAP: f64 = 1.0;

/// Number of corners of an ellipse.
const CORNERS: u32 = 90;

/// Draws the ellipses of all pairs. Each is in units of the standard deviations; the numbers are the correlations.
pub(super) fn draw(fit: &Fit, width: f64) -> Drawing {
    let names: Vec<Text> = fit
        .report
        .parameters
        .iter()
        .map(|estimate| Text::plain(short(&estimate.name)))
        .collect();
    let count = names.len();
    let mut drawing = Drawing::new(width);
    let entries = [
        LegendEntry::area(FILLS[1], "68.3 %"),
        LegendEntry::area(FILLS[0], "95.4 %"),
    ];
    let top = legend::draw_at_top(&mut drawing, &entries) + 0.6;
    let widest = names.iter().map(|name| name.width).fold(0.0, f64::max) * FONT_SIZE;
    let left = MARGIN + widest + GAP;
    let pitch = (width - MARGIN - left) / (count - 1) as f64;
    for (row, name) in names.iter().enumerate().skip(1) {
        let baseline = top + (row as f64 - 0.5) * pitch + 0.33 * FONT_SIZE;
        drawing.label(name.clone(), (left - GAP, baseline), Anchor::End);
        for column in 0..row {
            let corner = (left + column as f64 * pitch, top + (row - 1) as f64 * pitch);
            let bounds = Bounds::new(corner, pitch - GAP, pitch - GAP);
            draw_pair(&mut drawing, bounds, fit.correlation(row, column));
        }
    }
    let bottom = top + (count - 1) as f64 * pitch;
    for (column, name) in names[..count - 1].iter().enumerate() {
        let middle = left + (column as f64 + 0.5) * pitch - 0.5 * GAP;
        // Names that are wider than a box would overlap: they take turns on two lines.
        let is_wide = name.width * FONT_SIZE > pitch;
        let line = if is_wide { (column % 2) as f64 } else { 0.0 };
        let baseline = bottom + FONT_SIZE + line * LINE_HEIGHT;
        drawing.label(name.clone(), (middle, baseline), Anchor::Middle);
    }
    drawing.height = bottom + 2.5 * LINE_HEIGHT + MARGIN;
    drawing
}

/// The name of a parameter without its section.
fn short(name: &str) -> &str {
    name.rsplit_once('.').map_or(name, |(_, name)| name)
}

fn draw_pair(drawing: &mut Drawing, bounds: Bounds, correlation: Option<f64>) {
    let mut border = bounds.corners();
    border.extend_from_within(..1);
    if let Some(correlation) = correlation {
        let mut areas = Vec::new();
        for (radius, fill) in RADII.iter().rev().zip(FILLS) {
            let points = ellipse(&bounds, correlation, *radius);
            areas.push(Shape::Area { points, fill });
        }
        drawing.group(&format!("correlation {correlation:.2}"), areas);
    }
    let text = match correlation {
        // Adding zero turns −0.00 into 0.00.
        Some(correlation) => {
            let hundredths = (100.0 * correlation).round() + 0.0;
            format!("{:.2}", hundredths / 100.0).replace('-', "−")
        }
        None => "–".to_owned(),
    };
    let frame = style::line(BLACK, HAIRLINE);
    drawing.group("frame", Shape::lines([border], frame));
    let baseline = bounds.bottom - 0.3 * FONT_SIZE;
    let place = (bounds.right - 0.6, baseline);
    drawing.label(Text::plain(&text), place, Anchor::End);
}

/// The ellipse x² − 2ρxy + y² = (1 − ρ²) r² in units of the standard deviations, in a box.
fn ellipse(bounds: &Bounds, correlation: f64, radius: f64) -> Vec<Point> {
    let across = (1.0 - correlation * correlation).max(0.0).sqrt();
    let scale = 0.5 * bounds.width() / HALF_WIDTH;
    let middle = (
        f64::midpoint(bounds.left, bounds.right),
        f64::midpoint(bounds.top, bounds.bottom),
    );
    let mut points = Vec::new();
    for corner in 0..CORNERS {
        let angle = TAU * f64::from(corner) / f64::from(CORNERS);
        let x = cos(angle);
        let y = correlation * x + across * sin(angle);
        points.push((middle.0 + scale * radius * x, middle.1 - scale * radius * y));
    }
    points
}
