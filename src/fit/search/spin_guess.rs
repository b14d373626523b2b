//! The spin that a measured precession shows, for a start that is too far from the data.

use crate::fit::problem::identify::spin_rate;
use crate::fit::problem::model::Problem;
use crate::physics::math::cos;
use crate::telemetry::fields::state;
use std::f64::consts::TAU;

/// Time in which the precession is measured, s: several nutations of a fast top, in which it hardly changes.
const WINDOW: f64 = 1.0;

/// Fewest values with which a slope has a meaning.
const MIN_VALUES: usize = 5;

/// Start values with another spin.
pub(in crate::fit) struct GuessedStart {
    pub values: Vec<f64>,
    /// Spin rate ψ̇, rad/s.
    pub spin: f64,
}

/// The start values with the spin that belongs to the measured rate of precession at the beginning of the data, if the
/// precession is measured and the spin is free.
///
/// Regular precession: (I_x − I_z) cos θ φ̇² − I_z ψ̇ φ̇ + M g l = 0 (the paper, section 3).
pub(in crate::fit) fn start_with_measured_spin(problem: &Problem) -> Option<GuessedStart> {
    let spin = spin_rate(problem)?;
    let rate = precession_rate(problem)?;
    let scenario = &problem.scenario;
    let top = scenario.model.nutating_top();
    let quadratic = (top.transverse_moment - top.axial_moment) * cos(scenario.angles.theta);
    let guess = (top.gravity_moment() / rate + quadratic * rate) / top.axial_moment;
    let mut values = problem.start();
    values[spin] = problem.parameters[spin].clamp(guess);
    Some(GuessedStart {
        spin: values[spin],
        values,
    })
    .filter(|start| start.spin.is_finite())
}

/// The median slope of φ between neighbours at the beginning of the data, rad/s. Turns and outliers don't change it.
pub(in crate::fit) fn precession_rate(problem: &Problem) -> Option<f64> {
    let mut slopes = Vec::new();
    for pair in problem.points.windows(2) {
        let [a, b] = [pair[0], pair[1]];
        let signal = &problem.signals[a.signal];
        let is_pair = a.signal == b.signal && a.time < b.time && b.time <= WINDOW;
        if signal.field == state::PHI && is_pair && problem.is_on_clock(&a) {
            let step = b.value - a.value;
            slopes.push((step - (step / TAU).round() * TAU) / (b.time - a.time));
        }
    }
    if slopes.len() < MIN_VALUES {
        return None;
    }
    slopes.sort_by(f64::total_cmp);
    let rate = slopes[slopes.len() / 2];
    // Differences of neighbours are noisy. From a rotation with their rate, φ departs by less than a turn.
    let [early, late] = [0.0, 0.5 * WINDOW].map(|start| {
        let mut departures = Vec::new();
        for point in &problem.points {
            let signal = &problem.signals[point.signal];
            let is_within = (start..start + 0.5 * WINDOW).contains(&point.time);
            if signal.field == state::PHI && problem.is_on_clock(point) && is_within {
                departures.push(point.value - rate * point.time);
            }
        }
        departures
    });
    let (Some(first), false) = (early.first().copied(), late.is_empty()) else {
        return Some(rate);
    };
    let [early, late] = [early, late].map(|mut departures| {
        for departure in &mut departures {
            *departure -= ((*departure - first) / TAU).round() * TAU;
        }
        departures.sort_by(f64::total_cmp);
        departures[departures.len() / 2]
    });
    let rate = rate + (late - early) / (0.5 * WINDOW);
    Some(rate).filter(|rate| *rate != 0.0 && rate.is_finite())
}
