//! Colours and names, the same in the plots and in the scene.
//!
//! The palette is Okabe and Ito's, which stays distinguishable with any kind of colour vision.

use rerun::{AsComponents, SeriesLines, SeriesPoints};
use rerun::{Color, components::MarkerShape};

use super::look::Look;
use crate::telemetry::Leaf;

pub(super) const ORANGE: u32 = 0xE69F_00FF;
pub(super) const SKY: u32 = 0x56B4_E9FF;
/// For ripple that other curves shine through.
const PALE: u32 = 0x56B4_E990;
pub(super) const GREEN: u32 = 0x00B0_80FF;
pub(super) const YELLOW: u32 = 0xF0E4_42FF;
pub(super) const BLUE: u32 = 0x4C8F_D6FF;
pub(super) const VERMILLION: u32 = 0xE863_1AFF;
pub(super) const PURPLE: u32 = 0xCC79_A7FF;
pub(super) const GREY: u32 = 0xB4BA_C4FF;

/// The topic of the means over a nutation.
const MEANS: &str = "/top/nutation";

/// For leaves that no rule names, in their order within a plot.
const PALETTE: [u32; 7] = [SKY, ORANGE, GREEN, PURPLE, YELLOW, VERMILLION, BLUE];

/// How one number appears in a plot.
#[derive(Clone, Copy)]
struct Series {
    name: &'static str,
    color: u32,
    width: f32,
}

const fn series(name: &'static str, color: u32, width: f32) -> Series {
    Series { name, color, width }
}

/// The numbers of the blueprint's plots.
#[rustfmt::skip]
const STORY: [(&str, &str, Series); 42] = [
    ("/top/state", "theta", series("θ", SKY, 3.5)),
    ("/top/state", "theta_dot", series("dθ/dt", PALE, 1.0)),
    ("/top/state", "phi_dot", series("dφ/dt", PALE, 1.0)),
    ("/top/state", "psi_dot", series("dψ/dt", SKY, 3.5)),
    ("/top/state", "theta_ddot", series("sum", GREY, 1.0)),
    ("/top/state", "phi_ddot", series("sum", GREY, 1.0)),
    ("/top/state", "psi_ddot", series("sum", GREY, 1.0)),
    ("/top/nutation", "theta_mean", series("nutation mean", ORANGE, 0.8)),
    ("/top/nutation", "theta_dot_mean", series("nutation mean", ORANGE, 0.8)),
    ("/top/nutation", "phi_dot_mean", series("nutation mean", ORANGE, 0.8)),
    ("/top/nutation", "psi_dot_mean", series("nutation mean", ORANGE, 0.8)),
    ("/top/nutation", "period", series("nutation period", SKY, 1.5)),
    ("/top/precession", "slow_root", series("slow root", VERMILLION, 4.0)),
    ("/top/precession", "fast_root", series("fast root", PURPLE, 1.5)),
    ("/top/precession", "excess", series("dφ/dt − slow root", SKY, 1.0)),
    ("/top/precession", "strength_ratio", series("strength ratio", GREEN, 1.5)),
    ("/top/torque", "friction_node.x", series("line of nodes", SKY, 1.2)),
    ("/top/torque", "friction_node.y", series("perpendicular", ORANGE, 1.2)),
    ("/top/torque", "friction_node.z", series("symmetry axis", VERMILLION, 1.2)),
    ("/top/torque", "gravity_node.x", series("line of nodes", SKY, 1.2)),
    ("/top/torque", "gravity_node.y", series("perpendicular", ORANGE, 1.2)),
    ("/top/torque", "gravity_node.z", series("symmetry axis", VERMILLION, 1.2)),
    ("/top/acceleration", "theta_ddot.gyroscopic", series("gyroscopic", YELLOW, 1.2)),
    ("/top/acceleration", "theta_ddot.centrifugal", series("centrifugal", PURPLE, 1.2)),
    ("/top/acceleration", "theta_ddot.gravitational", series("gravitational", GREEN, 1.2)),
    ("/top/acceleration", "theta_ddot.frictional", series("frictional", VERMILLION, 1.2)),
    ("/top/acceleration", "phi_ddot.gyroscopic", series("gyroscopic", YELLOW, 1.2)),
    ("/top/acceleration", "phi_ddot.coriolis", series("coriolis", PURPLE, 1.2)),
    ("/top/acceleration", "phi_ddot.frictional", series("frictional", VERMILLION, 1.2)),
    ("/top/acceleration", "psi_ddot.gyroscopic", series("gyroscopic", YELLOW, 1.2)),
    ("/top/acceleration", "psi_ddot.coriolis", series("coriolis", PURPLE, 1.2)),
    ("/top/acceleration", "psi_ddot.frictional", series("frictional", VERMILLION, 1.2)),
    ("/top/contact", "slip_speed", series("speed", SKY, 2.0)),
    ("/top/contact", "slip_world.x", series("x", ORANGE, 1.0)),
    ("/top/contact", "slip_world.y", series("y", PURPLE, 1.0)),
    ("/top/contact", "slip_world.z", series("z", GREY, 1.0)),
    ("/top/momentum", "vertical", series("vertical", SKY, 1.5)),
    ("/top/momentum", "axial", series("symmetry axis", YELLOW, 1.5)),
    ("/top/energy", "kinetic", series("kinetic", SKY, 1.2)),
    ("/top/energy", "potential", series("potential", GREEN, 1.2)),
    ("/top/energy", "total", series("total", YELLOW, 1.5)),
    ("/top/energy", "friction_work", series("work of friction", VERMILLION, 1.5)),
];

/// Names, colours and widths of the numbers of one plot of a channel.
///
/// Means over a nutation are dots: dots lie above lines, whatever the order of the entities.
pub(super) fn of_plot(topic: &str, leaves: &[&Leaf], look: &Look) -> Box<dyn AsComponents> {
    let styles = || {
        leaves
            .iter()
            .enumerate()
            .map(|(place, leaf)| of_leaf(topic, leaf, place, look))
    };
    let names: Vec<String> = styles().map(|(name, ..)| name).collect();
    let colors: Vec<Color> = styles()
        .map(|(_, color, _)| Color::from_u32(color))
        .collect();
    let widths: Vec<f32> = styles().map(|(.., width)| width).collect();
    if topic == MEANS {
        let points = SeriesPoints::new().with_names(names).with_colors(colors);
        let markers = widths.iter().map(|_| MarkerShape::Circle);
        Box::new(points.with_markers(markers).with_marker_sizes(widths))
    } else {
        let lines = SeriesLines::new().with_names(names).with_colors(colors);
        Box::new(lines.with_widths(widths))
    }
}

fn of_leaf(topic: &str, leaf: &Leaf, place: usize, look: &Look) -> (String, u32, f32) {
    let told = STORY
        .iter()
        .find(|(t, path, _)| *t == topic && *path == leaf.path);
    let (name, color, width) = match told {
        Some((.., series)) => (series.name.to_owned(), series.color, series.width),
        None => {
            let name = leaf.path.rsplit('.').next().unwrap_or(&leaf.path);
            (name.replace('_', " "), PALETTE[place % PALETTE.len()], 1.2)
        }
    };
    // The means of two runs and of their difference are lighter than the ripple that they lie on.
    let shade = if topic == MEANS { 1 } else { place };
    (
        look.name(&name),
        look.color(color, shade),
        look.width(width),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::channels;

    #[test]
    fn every_style_belongs_to_a_number_of_the_table() {
        for (topic, path, _) in &STORY {
            let channel = channels().iter().find(|channel| channel.topic == *topic);
            assert!(
                channel.is_some_and(|channel| channel.number_index(path).is_some()),
                "{topic} {path}"
            );
        }
    }
}
