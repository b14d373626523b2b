//! Scales of the arrows: round numbers, derived from the weight and the size of the top.

use nalgebra::Vector3;

use super::preview::Preview;
use crate::physics::kinematics::Tilt;
use crate::physics::math;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::proportions::Proportions;
use crate::words::number::with_power;

/// Maximum length of an arrow, in heights of the top: from every side of the top, the tip is in the view.
pub(super) const MAX_LENGTH: f64 = 1.25;
/// Lengths of the arrow for the usual magnitude of a quantity, in heights of the top. Their ratio is greater than that of
/// neighbours in the series 1, 2, 5, so that each magnitude has a scale.
const MAX_USUAL: f64 = 1.15;
const MIN_USUAL: f64 = 0.25;
/// Length of the arrow of the weight, about, in heights of the top.
const WEIGHT_LENGTH: f64 = 0.42;
/// Ratio between the longest and the nominal length of an arrow whose scale is rounded to the nearest of 1, 2 and 5.
const ROUNDING: f64 = 1.582;
/// Ratios of the usual magnitude to that at the start which a scale follows. Friction that fades further is to be seen as
/// faded; a torque that grows further, because a law has only some of its components, is cut off.
const FOLLOWED: [f64; 2] = [1e-3, 2.0];

/// Magnitudes below this fraction of that which the digit of a scale follows from are rounding errors.
const ROUNDING_ERROR: f64 = 1e-9;

/// Quantity per metre of arrow, a round number: 1, 2 or 5 × 10^n; 0 if not drawn.
///
/// The digit follows from the top alone: from the weight M g, the torques M g l and M g R, and the speed √(2g × height).
/// Only the power of ten depends on the run, unless arrows of that scale would be too short to see. Friction that is 1.5
/// times as strong is therefore mostly drawn 1.5 times as long, also in another run of the same top.
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
    /// Weight, N.
    pub weight: f64,
    /// Greatest horizontal part of the angular momentum, N m s: not a scale, but the size of a picture of it.
    pub horizontal_momentum: f64,
    /// Usual torques of friction and of the weight, N m: not scales.
    pub usual_torques: [f64; 2],
    /// Friction force per metre at which the usual force is drawn in the greatest length, N/m: not rounded; 0 if not drawn.
    pub min_force: f64,
}

impl Scales {
    /// The scales for the runs of a scenario.
    pub(crate) fn new(scenario: &Scenario) -> Self {
        let top = &scenario.model.top;
        let height = Proportions::new(top).size();
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        let weight = top.weight();
        let preview = Preview::new(scenario);
        let slip = followed(preview.slip, scenario.slip_speed_at_start());
        let force = followed(preview.force, scenario.force_scale());
        // About the centre of mass the lever is that of the whole top, and not the radius of the peg.
        let torque_at_start = if scenario.model.support.is_free() {
            0.0
        } else {
            scenario.torque_scale()
        };
        let friction_torque = followed(preview.friction_torque, torque_at_start);
        let longest = MAX_USUAL * height;
        let speed = (2.0 * top.gravity * height).sqrt();
        let nominal = MAX_LENGTH / ROUNDING * height;
        let force_scale = scale(weight / longest, force, height);
        Self {
            slip: scale(speed / longest, slip, height),
            force: force_scale,
            gravity_torque: scale(
                top.gravity_moment().abs() / nominal,
                preview.gravity_torque,
                height,
            ),
            friction_torque: scale(weight * top.peg_radius / longest, friction_torque, height),
            momentum: round(momentum(top, &tilt) / nominal),
            weight: round(weight / (WEIGHT_LENGTH * height)),
            horizontal_momentum: preview.horizontal_momentum,
            usual_torques: [preview.friction_torque, preview.gravity_torque],
            min_force: if force_scale > 0.0 {
                force / longest
            } else {
                0.0
            },
        }
    }

    /// The scale of friction forces for two runs in one picture: the smallest round number at which the usual forces of
    /// both fit the view.
    pub fn common_force(&self, other: &Self) -> f64 {
        round_up(self.min_force.max(other.min_force))
    }
}

/// The usual magnitude of a quantity in a run, as far as a scale follows it, given the magnitude at the start.
fn followed(usual: f64, start: f64) -> f64 {
    if start > 0.0 {
        let [least, greatest] = FOLLOWED.map(|ratio| ratio * start);
        usual.clamp(least, greatest)
    } else {
        usual
    }
}

/// Magnitude of the angular momentum about the peg's centre, kg m²/s.
fn momentum(top: &Top, tilt: &Tilt) -> f64 {
    let axis = tilt.axis();
    let axial = tilt.omega_lean.dot(&axis);
    let across: Vector3<f64> = tilt.omega_lean - axial * axis;
    (top.transverse_moment * across + top.axial_moment * axial * axis).norm()
}

/// The scale for a quantity with a `usual` magnitude. Its digit is that of a `reference` scale, and its power of ten the
/// smallest that draws the quantity short enough; if that is too short, the next smaller round number that is not. 0 for
/// rounding errors, such as the slip of a top that rolls all the time.
fn scale(reference: f64, usual: f64, height: f64) -> f64 {
    if usual <= ROUNDING_ERROR * reference * height {
        return 0.0;
    }
    let scale = round(reference);
    let decades = math::log10(usual / (scale * MAX_USUAL * height)).ceil();
    let mut scale = round_by(scale, decades);
    while usual < MIN_USUAL * height * scale {
        // The one before it in the series: the nearest to a half.
        scale = round(scale / 2.0);
    }
    scale
}

/// The smallest of 1, 2 and 5 times a power of ten that is not less than a value.
fn round_up(value: f64) -> f64 {
    let nearest = round(value);
    if nearest < value {
        // The next one in the series: 2, 4 and 10 are nearest to 2, 5 and 10.
        round(2.0 * nearest)
    } else {
        nearest
    }
}

/// The nearest of 1, 2 and 5 times a power of ten; 0 for what is neither positive nor finite.
pub(crate) fn round(value: f64) -> f64 {
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
pub(crate) fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or(0.0)
}

/// A scale as text, the quantity of a centimetre, e.g. `20 µN m`.
pub(crate) fn per_centimetre(per_metre: f64, unit: &str) -> String {
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
            format!("{:.0} {prefix}{unit}", per_centimetre / factor)
        }
        _ => format!("{} {unit}", with_power(per_centimetre, 1)),
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
    fn friction_scale_is_common_to_runs_of_a_top() {
        let paper = scales("paper", "friction.k", "0.03");
        for (preset, k) in [
            ("paper", "0.06"),
            ("paper", "0.07"),
            ("full-coulomb", "0.03"),
        ] {
            let other = scales(preset, "friction.k", k);
            assert_eq!(other.force, paper.force, "{preset}, k = {k}");
            assert_eq!(
                other.friction_torque, paper.friction_torque,
                "{preset}, k = {k}"
            );
            assert_eq!(
                other.gravity_torque, paper.gravity_torque,
                "{preset}, k = {k}"
            );
        }
        let tenfold = scales("paper", "friction.k", "0.3");
        assert!((tenfold.force / paper.force - 10.0).abs() < 1e-12);
        assert_eq!(scales("frictionless", "stop.duration", "1").force, 0.0);
    }

    #[test]
    fn common_scale_fits_the_stronger_friction() {
        let [weak, strong] = ["0.03", "0.3"].map(|k| scales("paper", "friction.k", k));
        let common = weak.common_force(&strong);
        assert_eq!(common, strong.common_force(&weak));
        assert!(common >= strong.min_force && common < 2.5 * strong.min_force);
    }

    #[test]
    fn rounding_errors_have_no_scale() {
        assert_eq!(scale(1.0, 1e-12, 0.05), 0.0);
        assert_eq!(scale(0.0, 1e-12, 0.05), 0.0);
        assert!(scale(1.0, 1e-6, 0.05) > 0.0);
    }

    #[test]
    fn rounds_up_to_the_next_of_the_series() {
        for (value, expected) in [
            (1.0, 1.0),
            (1.1, 2.0),
            (1.9, 2.0),
            (2.1, 5.0),
            (4.9, 5.0),
            (5.1, 10.0),
            (0.011, 0.02),
            (0.0, 0.0),
        ] {
            assert_eq!(round_up(value), expected, "{value}");
        }
    }

    #[test]
    fn legends_have_a_prefix() {
        for (per_metre, unit, expected) in [
            (0.5, "N", "5 mN"),
            (100.0, "m/s", "1 m/s"),
            (0.002, "N m", "20 µN m"),
            (0.2, "kg m²/s", "2 mN m s"),
            (5e9, "N", "5 × 10⁷ N"),
            (1e-15, "N", "1 × 10⁻¹⁷ N"),
        ] {
            assert_eq!(per_centimetre(per_metre, unit), expected);
        }
    }
}
