//! The spin that a measured precession shows, for a start that is too far from the data.

use crate::fit::problem::identify::spin_rate;
use crate::fit::problem::model::Problem;
use crate::physics::math::cos;
use crate::telemetry::fields::state;

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

/// The slope of φ in the first file at the beginning of the data, rad/s.
fn precession_rate(problem: &Problem) -> Option<f64> {
    let mut values = Vec::new();
    for point in &problem.points {
        let signal = &problem.signals[point.signal];
        if signal.field == state::PHI && signal.file == 0 && point.time <= WINDOW {
            values.push((point.time, point.value));
        }
    }
    if values.len() < MIN_VALUES {
        return None;
    }
    let count = values.len() as f64;
    let mean_time = values.iter().map(|(time, _)| time).sum::<f64>() / count;
    let mean = values.iter().map(|(_, value)| value).sum::<f64>() / count;
    let (mut covariance, mut variance) = (0.0, 0.0);
    for (time, value) in values {
        covariance += (time - mean_time) * (value - mean);
        variance += (time - mean_time) * (time - mean_time);
    }
    Some(covariance / variance).filter(|rate| *rate != 0.0 && rate.is_finite())
}
