//! Scales of the arrows: round numbers, which follow from the weight and the size of the top.

use nalgebra::Vector3;

use crate::physics::kinematics::Tilt;
use crate::physics::math;
use crate::physics::top::Top;
use crate::run::scenario::Scenario;
use crate::telemetry::proportions::Proportions;

/// Lengths of arrows in heights of the top: of a torque M g l and of the speed of a fall from this height; of friction with
/// k = 1, 0.1, 0.01 and so on; of the angular momentum at the start, which reaches beyond the tip.
const REFERENCE_LENGTH: f64 = 2.5;
const FRICTION_LENGTH: f64 = 3.5;
const MOMENTUM_LENGTH: f64 = 1.5;

/// What one metre of an arrow stands for, each 10^n times 1, 2 or 5; 0 where there is nothing to draw.
///
/// They follow from the weight M g, the torques M g l and M g R, and √(2 g × height): friction that is 1.5 times as strong is
/// drawn 1.5 times as long, also in another run of the same top. Only whole decades of a typical size count.
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
    pub(in crate::rerun) fn new(scenario: &Scenario) -> Self {
        let top = &scenario.model.top;
        let height = Proportions::new(top).size();
        let reference = REFERENCE_LENGTH * height;
        let friction = FRICTION_LENGTH * height;
        let speed = (2.0 * top.gravity * height).sqrt();
        let weight = top.weight();
        let moment = momentum(
            top,
            &Tilt::from_rates(scenario.angles.theta, scenario.rates),
        );
        Self {
            slip: enlarged(speed / reference, scenario.slip_speed_at_start() / speed),
            force: enlarged(weight / friction, scenario.force_scale() / weight),
            gravity_torque: round(top.gravity_moment().abs() / reference),
            friction_torque: enlarged(
                weight * top.peg_radius / friction,
                scenario.torque_scale() / (weight * top.peg_radius),
            ),
            momentum: round(moment / (MOMENTUM_LENGTH * height)),
        }
    }

    /// The coarser scales of two runs: what fits both.
    pub(in crate::rerun) fn common(&self, other: &Self) -> Self {
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

/// A scale for a quantity that is typically `share` of the reference: smaller by whole decades, so that its arrow is at
/// least a tenth as long as the reference's.
fn enlarged(scale: f64, share: f64) -> f64 {
    let decades = math::log10(share).floor() + 1.0;
    round(scale) * power_of_ten(decades)
}

/// The nearest of 1, 2 and 5 times a power of ten; 0 for what is neither positive nor finite.
pub(in crate::rerun) fn round(value: f64) -> f64 {
    let decade = math::log10(value).floor();
    let digits = value / power_of_ten(decade);
    let nearest = [1.0, 2.0, 5.0, 10.0]
        .into_iter()
        .min_by(|a, b| (math::ln(digits / a).abs()).total_cmp(&math::ln(digits / b).abs()));
    let rounded = nearest.unwrap_or_default() * power_of_ten(decade);
    if rounded.is_normal() { rounded } else { 0.0 }
}

/// Ten to a whole power; 0 for infinite ones.
fn power_of_ten(exponent: f64) -> f64 {
    format!("1e{exponent}").parse().unwrap_or_default()
}

/// A scale for people, as in `1 cm = 20 µN m`.
pub(in crate::rerun) fn legend(per_metre: f64, unit: &str) -> String {
    const PREFIXES: [(f64, &str); 5] = [
        (1.0, ""),
        (1e-3, "m"),
        (1e-6, "µ"),
        (1e-9, "n"),
        (1e-12, "p"),
    ];
    // A unit that prefixes go with.
    let unit = if unit == "kg m²/s" { "N m s" } else { unit };
    let per_centimetre = 0.01 * per_metre;
    // Half a unit of the last digit: 1e-3 is one thousandth, whatever its rounding.
    let fits = |(factor, _): &&(f64, &str)| per_centimetre >= 0.999 * factor;
    match PREFIXES.iter().find(fits) {
        Some((factor, prefix)) if per_centimetre < 1e4 => {
            format!("1 cm = {:.0} {prefix}{unit}", per_centimetre / factor)
        }
        _ => format!("1 cm = {per_centimetre:.0e} {unit}"),
    }
}
