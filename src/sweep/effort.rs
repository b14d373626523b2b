//! Estimated work of a sweep, from which the size of its parts follows.
//!
//! An interrupted sweep loses the parts that are not finished, so a part should take seconds. Machines that share a
//! sweep must agree on its parts, so their size follows from the definition alone, without measuring time. An estimate
//! within a factor of three is enough.

use crate::run::scenario::Scenario;

/// Rows of the largest part, and of each row group of the table.
pub(super) const BLOCK_ROWS: u64 = 1000;

/// Work of a part, integrator steps: 2.5 s on one core, at 2 µs per step. So an interruption costs at most about 10 s, also
/// where runs take three times as many steps as estimated, or the machine is busy.
const STEPS_PER_PART: f64 = 1.25e6;

/// Steps per radian of the fastest rotation: the paper's top takes 10,642 steps in 24.7 s at 170 rad/s of spin and
/// 145 rad/s of nutation, at its tolerance of 1e-12.
const STEPS_PER_RADIAN: f64 = 3.0;

/// Simulated time of a run that has no `stop.duration`, s: the paper's top rises within 25 s.
const USUAL_DURATION: f64 = 60.0;

/// The number of rows of a part, if no row takes more steps than this: a divisor of [`BLOCK_ROWS`], so that each row
/// group is made of whole parts.
pub(super) fn part_rows(steps_per_row: f64) -> u64 {
    (1..=BLOCK_ROWS)
        .rev()
        .filter(|rows| BLOCK_ROWS.is_multiple_of(*rows))
        .find(|rows| *rows as f64 * steps_per_row <= STEPS_PER_PART)
        .unwrap_or(1)
}

/// The estimated number of integrator steps of a run, if it doesn't end before its duration.
pub(super) fn estimate_steps(scenario: &Scenario) -> f64 {
    let top = &scenario.model.top;
    let rates = scenario.rates;
    // A top that is hardly spinning swings like a pendulum.
    let pendulum = (top.gravity_moment().abs() / top.transverse_moment).sqrt();
    let spin = rates.phi.abs() + rates.theta.abs() + rates.psi.abs();
    // The nutation of a fast top is I_z/I_x times as fast as its spin, which is less than twice.
    let nutation = spin * (top.axial_moment / top.transverse_moment);
    let fastest = spin.max(nutation).max(pendulum);
    let duration = scenario.stop.duration.unwrap_or(USUAL_DURATION);
    duration * fastest * STEPS_PER_RADIAN
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::outcome::outcome;
    use crate::run::scenario::PRESETS;

    #[test]
    fn parts_are_whole_fractions_of_a_row_group() {
        for (steps, rows) in [
            (0.0, 1000),
            (1.25e3, 1000),
            (1.3e3, 500),
            (2.5e4, 50),
            (4e6, 1),
            (f64::INFINITY, 1),
            (f64::NAN, 1),
        ] {
            assert_eq!(part_rows(steps), rows, "{steps}");
        }
    }

    /// Of the presets that reach their duration; the others take less.
    #[test]
    fn estimates_are_within_an_order_of_magnitude() {
        for preset in PRESETS.iter() {
            let scenario = preset.scenario().unwrap();
            let end = outcome(&scenario, || true).unwrap().end;
            let share = scenario.stop.duration.map_or(1.0, |all| end.time / all);
            let ratio = estimate_steps(&scenario) * share / end.statistics.accepted as f64;
            assert!((0.1..10.0).contains(&ratio), "{}: {ratio}", preset.name);
        }
    }
}
