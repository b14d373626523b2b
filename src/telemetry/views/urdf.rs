//! The shape of the top as URDF. Its first comment is a legend of the views, which viewers show as text.
//!
//! Rerun draws primitives with 25 % opacity, so each part is a stack of thin cylinders or nested spheres, which look
//! solid. Other viewers support only boxes, cylinders and spheres, and require single spaces.

use crate::physics::math;
use crate::telemetry::arrows::scale::per_centimetre;
use crate::telemetry::arrows::{Arrow, Scales, palette};
use crate::telemetry::proportions::Proportions;
use std::f64::consts::FRAC_PI_3;

/// Names and colours (linear red, green, blue) of the materials.
const MATERIALS: [(&str, &str); 5] = [
    ("wood", "0.58 0.36 0.15"),
    ("cream", "0.89 0.81 0.67"),
    ("ink", "0.028 0.044 0.084"),
    ("mark", "0.58 0.09 0.046"),
    ("steel", "0.48 0.53 0.58"),
];

/// Layers of a cone or stem, and of the disc or the inlays of a ball.
const LAYERS: u32 = 8;
const DISC_LAYERS: u32 = 9;

/// The description of a robot that is a top, with the link `top`. `is_free`: whether the peg is
/// free.
pub(super) fn urdf(
    proportions: &Proportions,
    arrows: &[Arrow],
    scales: &Scales,
    is_free: bool,
) -> String {
    let legend = legend(arrows, scales, is_free);
    let mut text = format!("<robot name=\"toprise\"><!--\n{legend}-->\n");
    for (name, color) in MATERIALS {
        text.push_str(&format!(
            "  <material name=\"{name}\"><color rgba=\"{color} 1\"/></material>\n"
        ));
    }
    let mut link = Link::default();
    link.top(proportions);
    text.push_str("  <link name=\"top\">\n");
    text.push_str(&link.visuals);
    text.push_str("  </link>\n</robot>\n");
    text
}

fn legend(arrows: &[Arrow], scales: &Scales, is_free: bool) -> String {
    let mut text = "Heavy top with slipping friction\nArrows:\n".to_owned();
    for arrow in arrows {
        let scale = per_centimetre(arrow.scale(scales), arrow.quantity().unit());
        let style = arrow.style();
        let color = palette::name(style.color);
        text.push_str(&format!("- {}, {color}, 1 cm is {scale}\n", style.name));
    }
    text.push_str(
        "Plots, [1] and [2]: minimum and maximum in the last nutation\n\
         - inclination: position = inclination theta, rad;\n  \
         velocity, rad/s; effort = torque about the line of nodes, N m\n\
         - precession_rate: d phi/dt, rad/s\n\
         - slip_speed of the contact point, m/s\n\
         - spin_rate: d psi/dt, rad/s\n",
    );
    if is_free {
        text.push_str("- normal_force of the table, N\n");
    }
    text
}

/// The visible parts of a link.
#[derive(Default)]
struct Link {
    visuals: String,
}

impl Link {
    fn visual(&mut self, material: &str, geometry: &str, [x, y, z]: [f64; 3]) {
        self.visuals.push_str(&format!(
            "    <visual><origin xyz=\"{x:.6} {y:.6} {z:.6}\" rpy=\"0 0 0\"/>\
             <geometry>{geometry}</geometry><material name=\"{material}\"/></visual>\n"
        ));
    }

    fn cylinder(&mut self, material: &str, radius: f64, length: f64, center: [f64; 3]) {
        let shape = format!("<cylinder radius=\"{radius:.6}\" length=\"{length:.6}\"/>");
        self.visual(material, &shape, center);
    }

    fn sphere(&mut self, material: &str, radius: f64, height: f64) {
        let shape = format!("<sphere radius=\"{radius:.6}\"/>");
        self.visual(material, &shape, [0.0, 0.0, height]);
    }

    /// A body of revolution about a vertical through (x, y): `profile` returns its radius at a fraction of the way from
    /// bottom to top.
    fn stack(
        &mut self,
        material: &str,
        [x, y]: [f64; 2],
        [bottom, top]: [f64; 2],
        layers: u32,
        profile: impl Fn(f64) -> f64,
    ) {
        for layer in 0..layers {
            let part = (f64::from(layer) + 0.5) / f64::from(layers);
            let height = bottom + part * (top - bottom);
            let length = (top - bottom) / f64::from(layers);
            self.cylinder(material, profile(part), length, [x, y, height]);
        }
    }

    fn top(&mut self, p: &Proportions) {
        if p.is_ball {
            return self.ball(p);
        }
        let axis = [0.0, 0.0];
        let half = 0.5 * p.thickness();
        let (low, high) = (p.disc_height - half, p.disc_height + half);
        let (neck, shoulder, stem) = (p.neck(), p.shoulder(), p.stem_radius);
        for shell in [1.0, 0.97, 0.94] {
            self.sphere("steel", shell * p.peg, 0.0);
        }
        // The height at which the cone, as wide as the neck, leaves the sphere.
        let seam = (p.peg * p.peg - neck * neck).sqrt();
        self.stack("wood", axis, [seam, low], LAYERS, |part| {
            neck + part * (shoulder - neck)
        });
        self.stack("cream", axis, [low, high], DISC_LAYERS, |part| {
            let off = 2.0 * part - 1.0;
            p.disc_radius - half + half * (1.0 - off * off).sqrt()
        });
        // Inlays through the disc, one of them red, so that the spin shows.
        for sector in 0..6 {
            let angle = FRAC_PI_3 * f64::from(sector);
            let at = [math::cos(angle), math::sin(angle)].map(|x| 0.86 * p.disc_radius * x);
            let material = if sector == 0 { "mark" } else { "ink" };
            let ends = [low - 0.08 * half, high + 0.08 * half];
            self.stack(material, at, ends, DISC_LAYERS, |_| 0.17 * p.disc_radius);
        }
        let foot = high + 0.4 * shoulder;
        self.stack("wood", axis, [high, foot], LAYERS, |part| {
            shoulder + part * (stem - shoulder)
        });
        let knob = p.tip - 1.5 * stem;
        for shell in [1.0, 0.8, 0.6] {
            let middle = [0.0, 0.0, 0.5 * (foot + knob)];
            self.cylinder("steel", shell * stem, knob - foot, middle);
        }
        for shell in [1.0, 0.9, 0.8] {
            self.sphere("steel", 1.5 * shell * stem, knob);
        }
    }

    /// A tippe top with a protruding stem.
    fn ball(&mut self, p: &Proportions) {
        for shell in [1.0, 0.97, 0.94] {
            self.sphere("cream", shell * p.peg, 0.0);
        }
        // Rods through the ball, one of them red, so that the spin shows.
        for sector in 0..6 {
            let angle = FRAC_PI_3 * f64::from(sector);
            let at = [math::cos(angle), math::sin(angle)].map(|x| 0.8 * p.peg * x);
            let material = if sector == 0 { "mark" } else { "ink" };
            let half = 0.63 * p.peg;
            self.stack(material, at, [-half, half], DISC_LAYERS, |_| 0.15 * p.peg);
        }
        self.stack("steel", [0.0, 0.0], [p.peg, 1.5 * p.peg], LAYERS, |_| {
            p.stem_radius
        });
    }
}
