//! Sampling that is fine enough for a figure.

use crate::run::scenario::Scenario;
use crate::run::simulation::{Record, Simulation};

/// Samples per nutation needed to show the envelope; the error is below a line width.
const PER_NUTATION: f64 = 20.0;

/// Minimum samples per nutation for drawing the samples directly.
pub(super) const MIN_PER_NUTATION: f64 = 0.9 * PER_NUTATION;

/// The samples in a run that make its curves smooth.
const PER_RUN: f64 = 500.0;

/// Maximum ratio of the mean nutation period to the shortest that sampling follows; bounds its cost.
const MAX_SHORTENING: f64 = 8.0;

/// A sampling period longer than any run, ns.
const NEVER: u64 = i64::MAX.unsigned_abs();

/// The run with a sampling period short enough to draw it. Samples come from the dense output and don't change
/// the motion.
pub(super) fn finely_sampled(scenario: &Scenario) -> Scenario {
    let period = scenario.sample_period_ns;
    let wanted = max_period_ns(scenario).unwrap_or(period as f64);
    // A whole fraction, so that the samples of the recording are among the finer ones.
    let parts = (period as f64 / wanted).ceil().max(1.0) as u64;
    sampled(scenario, (period / parts).max(1))
}

fn sampled(scenario: &Scenario, period_ns: u64) -> Scenario {
    let mut sampled = scenario.clone();
    sampled.sample_period_ns = period_ns;
    sampled
}

/// The longest time between samples that shows everything, ns; `None` if the run can't be simulated.
fn max_period_ns(scenario: &Scenario) -> Option<f64> {
    // Nutation cycles and the duration don't depend on samples, so a run without them is enough.
    let mut simulation = Simulation::new(&sampled(scenario, NEVER)).ok()?;
    let mut shortest = f64::INFINITY;
    let mut count = 0.0;
    for record in simulation.by_ref() {
        if let Record::Nutation(cycle) = record.ok()? {
            shortest = shortest.min(cycle.period());
            count += 1.0;
        }
    }
    let duration = simulation.end().time;
    let shortest_drawn = shortest.max(duration / (MAX_SHORTENING * count));
    let period = (shortest_drawn / PER_NUTATION).min(duration / PER_RUN);
    (period > 0.0).then_some(1e9 * period)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::scenario::Preset;

    fn scenario(preset: &str, changes: &[(&str, &str)]) -> Scenario {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        for (key, value) in changes {
            values.set(key, value).unwrap();
        }
        Scenario::new(values).unwrap()
    }

    #[test]
    fn samples_follow_the_fastest_nutation() {
        let period = |preset: &str, changes: &[(&str, &str)]| {
            finely_sampled(&scenario(preset, changes)).sample_period_ns
        };
        // Forty samples in each of the paper's nutations show it.
        assert_eq!(period("paper", &[("stop.duration", "1")]), 1_000_000);
        // At 3000 rad/s a nutation takes 2.46 ms.
        let fast = [("initial.psi_dot", "3000"), ("stop.duration", "1")];
        assert_eq!(period("paper", &fast), 111_111);
        let short = period("paper", &[("stop.duration", "0.003")]);
        assert!((5_900..=6_000).contains(&short), "{short}");
    }

    #[test]
    fn runs_without_nutation_need_no_short_period() {
        let falling = [("initial.psi_dot", "0"), ("stop.duration", "0.6")];
        let scenario = scenario("paper", &falling);
        let fine = finely_sampled(&scenario);
        assert!(fine.sample_period_ns <= scenario.sample_period_ns);
        assert!(fine.sample_period_ns > 100_000);
    }
}
