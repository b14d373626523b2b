//! Scales of the arrows: round numbers, derived from the weight and the size of the top.

use nalgebra::Vector3;

use crate::physics::kinematics::Tilt;
use crate::physics::math;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::proportions::Proportions;

/// Maximum length of an arrow, in heights of the top: from every side of the top, the tip and its label are in the view.
const MAX_LENGTH: f64 = 1.25;
/// Maximum length at the start of arrows of a fixed peg and of a free one, whose normal force can double as it nutates.
const MAX_START_FIXED: f64 = 1.15;
const MAX_START_FREE: f64 = 0.5 * MAX_START_FIXED;
/// Ratio between the longest and the nominal length of an arrow whose scale is rounded to the nearest of 1, 2 and 5.
const ROUNDING: f64 = 1.582;

/// Quantity per metre of arrow, a round number: 1, 2 or 5 × 10^n; 0 if not drawn.
///
/// The digit follows from the top alone: from the weight M g, the torques M g l and M g R, and the speed √(2g × height).
/// Only the power of ten depends on the run. Friction that is 1.5 times as strong is therefore drawn 1.5 times as long,
/// also in another run of the same top, unless a power of ten lies between them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales {
    /// Slip velocity, m/s.
    pub slip: f64,
    /// Friction force, N.
    pub force: f64,
    /// Torque of gravity, N m.
    pub gravity_torque: f64,
    /// Torque of friction, N m.
    pub friction_torque: f64,
    /// Angular momentum, N m s.
    pub momentum: f64,
}

impl Scales {
    /// The scales for the runs of a scenario.
    pub(super) fn new(scenario: &Scenario) -> Self {
        let top = &scenario.model.top;
        let height = Proportions::new(top).size();
        let nominal = MAX_LENGTH / ROUNDING * height;
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        // A top that starts without slip may slip as fast as its peg turns.
        let slip = match scenario.slip_speed_at_start() {
            0.0 => top.peg_radius * tilt.omega_lean.norm(),
            speed => speed,
        };
        let weight = top.weight();
        let longest = if scenario.model.support.is_free() {
            MAX_START_FREE * height
        } else {
            MAX_START_FIXED * height
        };
        let reference = MAX_START_FIXED * height;
        let speed = (2.0 * top.gravity * height).sqrt();
        let torque = weight * top.peg_radius;
        Self {
            slip: decade(speed / reference, slip, longest),
            force: decade(weight / reference, scenario.force_scale(), longest),
            gravity_torque: round(top.gravity_moment().abs() / nominal),
            friction_torque: decade(torque / reference, scenario.torque_scale(), longest),
            momentum: round(momentum(top, &tilt) / nominal),
        }
    }

    /// The larger scale of two runs.
    pub(super) fn common(&self, other: &Self) -> Self {
        Self {
            slip: self.slip.max(other.slip),
            force: self.force.max(other.force),
            gravity_torque: self.gravity_torque.max(other.gravity_torque),
            friction_torque: self.friction_torque.max(other.friction_torque),
            momentum: self.momentum.max(other.momentum),
        }
    }
}

/// Magnitude of the angular momentum about the peg's centre, kg m²/s.
fn momentum(top: &Top, tilt: &Tilt) -> f64 {
    let axis = tilt.axis();
    let axial = tilt.omega_lean.dot(&axis);
    let across: Vector3<f64> = tilt.omega_lean - axial * axis;
    (top.transverse_moment * across + top.axial_moment * axial * axis).norm()
}

/// Maximum length of any arrow, m, given the height of the top.
pub(super) fn max_length(height: f64) -> f64 {
    MAX_LENGTH * height
}

/// A scale whose digit is that of a `reference` scale, and whose power of ten is the smallest that draws the quantity at
/// the `start` of the run no longer than `longest`, m.
fn decade(reference: f64, start: f64, longest: f64) -> f64 {
    let scale = round(reference);
    round_by(scale, math::log10(start / (scale * longest)).ceil())
}

/// The nearest of 1, 2 and 5 times a power of ten; 0 for what is neither positive nor finite.
pub(super) fn round(value: f64) -> f64 {
    round_by(value, 0.0)
}

/// The same, times ten to the power of `decades`.
fn round_by(value: f64, decades: f64) -> f64 {
    let decade = math::log10(value).floor();
    let digits: f64 = value / power_of_ten(decade);
    // Halfway, in logarithms, between 1, 2, 5 and 10.
    let nearest = match digits * digits {
        square if square < 2.0 => 1,
        square if square < 10.0 => 2,
        square if square < 50.0 => 5,
        _ => 10,
    };
    // Through text, because parsing rounds correctly, and multiplying by powers of ten does not.
    let decimal = format!("{nearest}e{}", decade + decades);
    let rounded: f64 = decimal.parse().unwrap_or_default();
    if rounded.is_normal() { rounded } else { 0.0 }
}

/// Ten to the power of a whole number, exactly rounded.
pub(super) fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(0.0)
}

/// A scale as text, e.g. `1 cm = 20 µN m`.
pub(super) fn legend(per_metre: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 5] = [
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "µ"),
        (1e-9, "n"),
        (1e-12, "p"),
    ];
    // Use a unit that takes SI prefixes.
    let unit = if unit == "kg m²/s" { "N m s" } else { unit };
    let per_centimetre = 0.01 * per_metre;
    // A little less than the factor: rounding must not push a round number below its prefix.
    match PREFIXES
        .iter()
        .find(|(factor, _)| per_centimetre >= 0.999 * factor)
    {
        Some((factor, prefix)) if per_centimetre < 1e4 => {
            format!("1 cm = {:.0} {prefix}{unit}", per_centimetre / factor)
        }
        _ => format!("1 cm = {per_centimetre:.0e} {unit}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;

    fn scales(preset: &str, key: &str, value: &str) -> Scales {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        values.set(key, value).unwrap();
        Scales::new(&Scenario::new(values).unwrap())
    }

    #[test]
    fn friction_scale_is_common_within_a_decade() {
        let paper = scales("paper", "friction.k", "0.03");
        assert_eq!(scales("paper", "friction.k", "0.06"), paper);
        assert_eq!(scales("full-coulomb", "friction.k", "0.03"), paper);
        let tenfold = scales("paper", "friction.k", "0.3");
        assert!((tenfold.force / paper.force - 10.0).abs() < 1e-12);
        assert_eq!(tenfold.gravity_torque, paper.gravity_torque);
        assert_eq!(scales("frictionless", "stop.duration", "1").force, 0.0);
    }

    #[test]
    fn scales_of_presets_are_round() {
        for preset in crate::run::scenario::PRESETS.iter() {
            let scenario = preset.scenario().unwrap();
            let scales = Scales::new(&scenario);
            let Scales {
                slip,
                force,
                gravity_torque,
                friction_torque,
                momentum,
            } = scales;
            for scale in [slip, force, gravity_torque, friction_torque, momentum] {
                let digits = format!("{scale:e}");
                let is_round = ["1e", "2e", "5e"]
                    .iter()
                    .any(|start| digits.starts_with(start));
                let is_absent = scale == 0.0 && (scenario.is_frictionless() || scale == slip);
                assert!(is_round || is_absent, "{}: {digits}", preset.name);
            }
        }
    }

    #[test]
    fn legends_have_a_prefix() {
        for (per_metre, unit, expected) in [
            (0.5, "N", "1 cm = 5 mN"),
            (100.0, "m/s", "1 cm = 1 m/s"),
            (0.002, "N m", "1 cm = 20 µN m"),
            (0.2, "kg m²/s", "1 cm = 2 mN m s"),
            (5e9, "N", "1 cm = 5e7 N"),
            (1e-15, "N", "1 cm = 1e-17 N"),
        ] {
            assert_eq!(legend(per_metre, unit), expected);
        }
    }
}
