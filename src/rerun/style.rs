//! Names, colours and widths of the numbers in plots.

use rerun::components::{AggregationPolicy, InterpolationMode, MarkerShape};
use rerun::{AsComponents, Color, SeriesLines, SeriesPoints};

use super::role::Role;
use crate::rerun::palette::{BLUE, GREEN, GREY, ORANGE, PALE, PURPLE, SKY, VERMILION, YELLOW};
use crate::telemetry::fields::{
    NUTATION, NumberField, acceleration, contact, energy, momentum, nutation, precession, state,
    torque,
};

/// Colours of numbers that are not in [`NAMED_STYLES`], in their order within a plot.
const PALETTE: [u32; 7] = [SKY, ORANGE, GREEN, PURPLE, YELLOW, VERMILION, BLUE];

/// Names, colours and widths of the numbers in the layouts' charts.
#[rustfmt::skip]
const NAMED_STYLES: [(NumberField, &str, u32, f32); 42] = [
    (state::THETA, "θ", SKY, 3.5),
    (state::THETA_DOT, "dθ/dt", PALE, 1.0),
    (state::PHI_DOT, "dφ/dt", PALE, 1.0),
    (state::PSI_DOT, "dψ/dt", SKY, 3.5),
    (state::THETA_DDOT, "sum", GREY, 1.0),
    (state::PHI_DDOT, "sum", GREY, 1.0),
    (state::PSI_DDOT, "sum", GREY, 1.0),
    (nutation::THETA_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::THETA_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PHI_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PSI_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PERIOD, "nutation period", SKY, 1.5),
    (precession::SLOW_ROOT, "slow rate", VERMILION, 4.0),
    (precession::FAST_ROOT, "fast rate", PURPLE, 1.5),
    (precession::EXCESS, "dφ/dt − slow rate", SKY, 1.0),
    (precession::STRENGTH_RATIO, "strength ratio", GREEN, 1.5),
    (torque::FRICTION_NODE.x(), "line of nodes", SKY, 1.2),
    (torque::FRICTION_NODE.y(), "perpendicular", ORANGE, 1.2),
    (torque::FRICTION_NODE.z(), "symmetry axis", VERMILION, 1.2),
    (torque::GRAVITY_NODE.x(), "line of nodes", SKY, 1.2),
    (torque::GRAVITY_NODE.y(), "perpendicular", ORANGE, 1.2),
    (torque::GRAVITY_NODE.z(), "symmetry axis", VERMILION, 1.2),
    (acceleration::THETA_DDOT_GYROSCOPIC, "gyroscopic", YELLOW, 1.2),
    (acceleration::THETA_DDOT_CENTRIFUGAL, "centrifugal", PURPLE, 1.2),
    (acceleration::THETA_DDOT_GRAVITATIONAL, "gravitational", GREEN, 1.2),
    (acceleration::THETA_DDOT_FRICTIONAL, "frictional", VERMILION, 1.2),
    (acceleration::PHI_DDOT_GYROSCOPIC, "gyroscopic", YELLOW, 1.2),
    (acceleration::PHI_DDOT_CORIOLIS, "Coriolis", PURPLE, 1.2),
    (acceleration::PHI_DDOT_FRICTIONAL, "frictional", VERMILION, 1.2),
    (acceleration::PSI_DDOT_GYROSCOPIC, "gyroscopic", YELLOW, 1.2),
    (acceleration::PSI_DDOT_CORIOLIS, "Coriolis", PURPLE, 1.2),
    (acceleration::PSI_DDOT_FRICTIONAL, "frictional", VERMILION, 1.2),
    (contact::SLIP_SPEED, "speed", SKY, 2.0),
    (contact::SLIP_WORLD.x(), "x", ORANGE, 1.0),
    (contact::SLIP_WORLD.y(), "y", PURPLE, 1.0),
    (contact::SLIP_WORLD.z(), "z", GREY, 1.0),
    (momentum::VERTICAL, "vertical", SKY, 1.5),
    (momentum::AXIAL, "symmetry axis", YELLOW, 1.5),
    (energy::KINETIC, "kinetic", SKY, 1.2),
    (energy::POTENTIAL, "potential", GREEN, 1.2),
    (energy::TOTAL, "total", YELLOW, 1.5),
    (energy::FRICTION_WORK, "work of friction", VERMILION, 1.5),
];

/// Style of a number in a plot.
struct PlotStyle {
    name: String,
    color: u32,
    width: f32,
}

/// Names, colours and widths of the numbers of one plot.
///
/// Nutation means are dots, because dots are drawn above lines. Lines show the envelope where many values share a
/// pixel.
pub(super) fn series(numbers: &[NumberField], role: &Role) -> Box<dyn AsComponents> {
    let styles: Vec<PlotStyle> = numbers
        .iter()
        .enumerate()
        .map(|(place, number)| style_of(*number, place, role))
        .collect();
    let names = styles.iter().map(|style| style.name.as_str());
    let colors = styles.iter().map(|style| Color::from_u32(style.color));
    let widths = styles.iter().map(|style| style.width);
    if numbers.iter().all(|number| number.topic() == NUTATION) {
        let points = SeriesPoints::new().with_names(names).with_colors(colors);
        let markers = numbers.iter().map(|_| MarkerShape::Circle);
        Box::new(points.with_markers(markers).with_marker_sizes(widths))
    } else {
        let lines = SeriesLines::new()
            .with_names(names)
            .with_colors(colors)
            .with_widths(widths)
            // The default of Rerun 0.41 averages the values of a pixel, which hides the nutation.
            .with_aggregation_policy(AggregationPolicy::MinMax)
            .with_interpolation_mode(InterpolationMode::Linear);
        Box::new(lines)
    }
}

/// Name, colour and width of a line.
pub(super) type LineStyle = (&'static str, u32, f32);

/// Lines in these styles.
pub(super) fn lines(styles: &[LineStyle]) -> SeriesLines {
    SeriesLines::new()
        .with_names(styles.iter().map(|(name, ..)| *name))
        .with_colors(styles.iter().map(|(_, color, _)| Color::from_u32(*color)))
        .with_widths(styles.iter().map(|(.., width)| *width))
        .with_aggregation_policy(AggregationPolicy::MinMax)
        .with_interpolation_mode(InterpolationMode::Linear)
}

/// Marks of these colours and sizes.
pub(super) fn marks(styles: &[LineStyle], shape: MarkerShape) -> SeriesPoints {
    SeriesPoints::new()
        .with_names(styles.iter().map(|(name, ..)| *name))
        .with_colors(styles.iter().map(|(_, color, _)| Color::from_u32(*color)))
        .with_markers(styles.iter().map(|_| shape))
        .with_marker_sizes(styles.iter().map(|(.., size)| *size))
}

/// The style of a number, given its position in the plot.
fn style_of(number: NumberField, place: usize, role: &Role) -> PlotStyle {
    let known = NAMED_STYLES.iter().find(|(known, ..)| *known == number);
    let (name, color, width) = if let Some(&(_, name, color, width)) = known {
        (name.to_owned(), color, width)
    } else {
        let path = number.path();
        let name = path.rsplit('.').next().unwrap_or(path);
        (name.replace('_', " "), PALETTE[place % PALETTE.len()], 1.2)
    };
    // The means of two runs and of their difference are lighter than the curve behind them.
    let shade = if number.topic() == NUTATION { 1 } else { place };
    PlotStyle {
        name: role.name(&name),
        color: role.color(color, shade),
        width: role.width(width),
    }
}

/// A text in letters that the viewer can draw: its font leaves the dots of time derivatives out, so that θ̈ looks like θ.
pub(super) fn legible(text: &str) -> String {
    let second = text
        .replace("θ\u{308}", "d²θ/dt²")
        .replace("φ\u{308}", "d²φ/dt²");
    ["θ", "φ", "ψ"].iter().fold(second, |text, angle| {
        text.replace(&format!("{angle}\u{307}"), &format!("d{angle}/dt"))
    })
}
