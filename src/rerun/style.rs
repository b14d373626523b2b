//! Names, colours and widths of the numbers in plots.

use rerun::components::{AggregationPolicy, InterpolationMode, MarkerShape};
use rerun::{AsComponents, Color, SeriesLines, SeriesPoints};

use super::role::Role;
use crate::rerun::palette::{BLUE, GREEN, GREY, ORANGE, PALE, PURPLE, SKY, VERMILION, YELLOW};
use crate::telemetry::fields::{
    NUTATION, NumberField, contact, energy, momentum, nutation, precession, state, torque,
};

/// Colours of numbers that are not in [`NAMED_STYLES`], in their order within a plot.
const PALETTE: [u32; 7] = [SKY, ORANGE, GREEN, PURPLE, YELLOW, VERMILION, BLUE];

/// Names, colours and widths of the numbers in the layouts' charts.
#[rustfmt::skip]
const NAMED_STYLES: [(NumberField, &str, u32, f32); 27] = [
    (state::THETA, "θ", SKY, 3.5),
    (state::THETA_DOT, "dθ/dt", PALE, 1.0),
    (state::PHI_DOT, "dφ/dt", PALE, 1.0),
    (state::PSI_DOT, "dψ/dt", SKY, 3.5),
    (nutation::THETA_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::THETA_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PHI_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PSI_DOT_MEAN, "nutation mean", ORANGE, 0.8),
    (nutation::PERIOD, "nutation period", SKY, 1.5),
    (precession::SLOW_ROOT, "slow rate", VERMILION, 4.0),
    (precession::EXCESS, "dφ/dt − slow rate", SKY, 1.0),
    (torque::FRICTION_NODE.x(), "line of nodes", SKY, 1.2),
    (torque::FRICTION_NODE.y(), "perpendicular", ORANGE, 1.2),
    (torque::FRICTION_NODE.z(), "symmetry axis", VERMILION, 1.2),
    (torque::GRAVITY_NODE.x(), "line of nodes", SKY, 1.2),
    (torque::GRAVITY_NODE.y(), "perpendicular", ORANGE, 1.2),
    (torque::GRAVITY_NODE.z(), "symmetry axis", VERMILION, 1.2),
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

/// Name, colour and width of a line, or size of a mark.
pub(super) type LineStyle<N = &'static str> = (N, u32, f32);

/// Names, colours and widths of the numbers of one plot.
///
/// Nutation means are dots, because dots are drawn above lines. Lines show the envelope where many values share a
/// pixel.
pub(super) fn series(numbers: &[NumberField], role: &Role) -> Box<dyn AsComponents> {
    let mut styles = Vec::new();
    for (place, number) in numbers.iter().enumerate() {
        styles.push(style_of(*number, place, role));
    }
    if numbers.iter().all(|number| number.topic() == NUTATION) {
        Box::new(marks(&styles, MarkerShape::Circle))
    } else {
        Box::new(lines(&styles))
    }
}

/// Lines in these styles.
pub(super) fn lines<N: AsRef<str>>(styles: &[LineStyle<N>]) -> SeriesLines {
    SeriesLines::new()
        .with_names(styles.iter().map(|(name, ..)| name.as_ref()))
        .with_colors(styles.iter().map(|(_, color, _)| Color::from_u32(*color)))
        .with_widths(styles.iter().map(|(.., width)| *width))
        // The default of Rerun 0.41 averages the values of a pixel, which hides the nutation.
        .with_aggregation_policy(AggregationPolicy::MinMax)
        .with_interpolation_mode(InterpolationMode::Linear)
}

/// Marks of these colours and sizes.
pub(super) fn marks<N: AsRef<str>>(styles: &[LineStyle<N>], shape: MarkerShape) -> SeriesPoints {
    SeriesPoints::new()
        .with_names(styles.iter().map(|(name, ..)| name.as_ref()))
        .with_colors(styles.iter().map(|(_, color, _)| Color::from_u32(*color)))
        .with_markers(styles.iter().map(|_| shape))
        .with_marker_sizes(styles.iter().map(|(.., size)| *size))
}

/// The style of a number, given its position in the plot.
fn style_of(number: NumberField, place: usize, role: &Role) -> LineStyle<String> {
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
    (
        role.name(&name),
        role.color(color, shade),
        role.width(width),
    )
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
