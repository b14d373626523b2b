//! How far the axis of a top can swing whose peg rolls without losses.

use crate::physics::dynamics::Model;
use crate::physics::integrate::zero;
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use std::f64::consts::PI;

/// The longest step in θ in which the end of a swing is looked for, rad: the energy at rest in θ is a smooth function of θ
/// with features as wide as θ itself.
const STEP: f64 = 1e-3;
/// Where the axis is this near upright (rad) without having turned, it swings through.
const THROUGH: f64 = 1e-6;
/// Roundings in the sum of the terms of an energy.
const ROUNDINGS: f64 = 16.0;

/// The integrals of a top that rolls, as its motion at one inclination has them.
struct Integrals<'t> {
    top: &'t Top,
    jellett: f64,
    routh: f64,
}

impl Integrals<'_> {
    /// The energy of a top with these integrals that is at rest in θ, J, and the sum of the magnitudes of its terms.
    fn energy(&self, theta: f64) -> [f64; 2] {
        let top = self.top;
        let (sin, cos) = sin_cos(theta);
        let axial_rate = self.routh / top.rolling_moments(sin, cos).sqrt();
        let axial = top.axial_moment * axial_rate;
        let vertical = (self.jellett - top.center_distance * axial) / top.peg_radius;
        let across = (vertical - axial * cos) / sin;
        let phi = across / (top.central_moment() * sin);
        let psi = axial_rate - phi * cos;
        let speed = (top.peg_radius * psi - top.center_distance * phi) * sin;
        let terms = [
            0.5 * axial * axial_rate,
            0.5 * across * across / top.central_moment(),
            0.5 * top.mass * speed * speed,
            top.gravity_moment() * cos,
        ];
        [
            terms.iter().sum(),
            terms.iter().map(|term| term.abs()).sum(),
        ]
    }
}

/// The least and the greatest inclination (rad) that the energy, Jellett's and Routh's integral of a top in this motion let
/// it reach, widened by what rounding leaves open; none where they don't bound it. The peg rolls without losses.
pub(super) fn swing(model: &Model, theta: f64, rates: Euler) -> Option<[f64; 2]> {
    let top = &model.top;
    let tilt = Tilt::from_rates(theta, rates);
    let momentum = tilt.node_to_lean(&top.about_center().angular_momentum_node(&tilt));
    let (rate, moments) = (tilt.axial_rate(), top.rolling_moments(tilt.sin, tilt.cos));
    let integrals = Integrals {
        top,
        jellett: top.center_distance * top.axial_moment * rate + top.peg_radius * momentum.z,
        routh: rate * moments.sqrt(),
    };
    let height = top.peg_radius + top.center_distance * tilt.cos;
    let lean = top.center_distance * tilt.sin;
    let rocking = top.central_moment() + top.mass * (height * height + lean * lean);
    let nodding = 0.5 * rocking * rates.theta * rates.theta;
    let [at_rest, size] = integrals.energy(theta);
    // What is left for θ̇, and at most what rounding adds to it.
    let left = |theta: f64| {
        let [energy, terms] = integrals.energy(theta);
        (at_rest - energy) + nodding + ROUNDINGS * f64::EPSILON * (size + terms)
    };
    let is_known = theta > THROUGH && theta < PI - THROUGH && left(theta) > 0.0;
    if !is_known {
        return None;
    }
    let least = turn(theta, -1.0, left).unwrap_or(0.0);
    let greatest = turn(theta, 1.0, left)?;
    Some([least, greatest])
}

/// Where θ comes to rest from `theta` on, upward or downward; none if it goes on to where the axis is vertical.
fn turn(theta: f64, way: f64, left: impl Fn(f64) -> f64) -> Option<f64> {
    let mut step = 1e-9;
    let (mut from, mut here) = (theta, left(theta));
    loop {
        let to = from + way * step;
        if !(THROUGH..=PI - THROUGH).contains(&to) {
            return None;
        }
        let there = left(to);
        if there <= 0.0 {
            return Some(from + way * step * zero(here, there, |s| left(from + way * step * s)));
        }
        (from, here) = (to, there);
        step = STEP.min(1.5 * step);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::{Preset, Scenario};
    use crate::run::simulation::{Record, Simulation};

    /// The extremes of θ in a run, sampled each 10 µs, against what follows from its first sample.
    #[test]
    fn val_tops_that_roll_swing_as_far_as_their_integrals_let_them() {
        for (preset, keys) in [
            (
                "tippe-top-hangs",
                [("initial.theta", "0.5"), ("friction.k", "1")],
            ),
            (
                "free-paper",
                [("initial.psi_dot", "100"), ("friction.k", "1")],
            ),
        ] {
            let mut values = Preset::find(preset).unwrap().values().unwrap();
            for (key, value) in keys
                .into_iter()
                .chain([("stop.duration", "0.5"), ("sampling.period", "1e-5")])
            {
                values.set(key, value).unwrap();
            }
            let scenario = Scenario::new(values).unwrap();
            let mut found: Option<([f64; 2], [f64; 2])> = None;
            for record in Simulation::new(&scenario).unwrap() {
                let Ok(Record::Sample(sample)) = record else {
                    continue;
                };
                if sample.regime() != 0.0 {
                    found = None;
                    continue;
                }
                let theta = sample.angles.theta;
                let (_, [least, greatest]) = found.get_or_insert_with(|| {
                    let swing = swing(&scenario.model, theta, sample.tilt.rates).unwrap();
                    (swing, [theta; 2])
                });
                (*least, *greatest) = (least.min(theta), greatest.max(theta));
            }
            let (swing, sampled) = found.unwrap();
            // A sample is at most 5 µs from a turning point, where θ̈ is 2e4 rad/s² at most.
            for (bound, extreme, way) in [(swing[0], sampled[0], 1.0), (swing[1], sampled[1], -1.0)]
            {
                let inside = way * (extreme - bound);
                assert!(
                    (-1e-11..5e-7).contains(&inside),
                    "{preset}: {bound} {extreme}"
                );
            }
        }
    }

    #[test]
    fn a_top_that_does_not_turn_about_its_axis_swings_through_upright_or_falls() {
        let mut values = Preset::find("tippe-top-hangs").unwrap().values().unwrap();
        values.set("initial.psi_dot", "0").unwrap();
        let scenario = Scenario::new(values.clone()).unwrap();
        let still = Euler::default();
        let [least, greatest] = swing(&scenario.model, 0.3, still).unwrap();
        assert!(least == 0.0 && (greatest - 0.3).abs() < 1e-9, "{greatest}");
        let heavy = Preset::find("free-paper").unwrap().values().unwrap();
        let heavy = Scenario::new(heavy).unwrap();
        assert_eq!(swing(&heavy.model, 0.3, still), None);
    }
}
