//! The slip of runs: what comparisons say of it, recomputed from the messages.

use crate::support::{assert_near, scenario};
use std::f64::consts::PI;
use toprise::analysis::diff::{Options, compare};
use toprise::analysis::slip::Slip;
use toprise::analysis::subject::Subject;
use toprise::physics::math::{cos, exp};
use toprise::run::scenario::Scenario;
use toprise::telemetry::Topics;
use toprise::telemetry::fields::{CONTACT, STATE, contact, state};

/// A sample that slips: time in s, slip speed in m/s, and rate about the vertical in rad/s.
type Sample = [f64; 3];

/// The coefficient of friction at a slip speed in m/s and a rate about the vertical in rad/s.
type Law = fn(f64, f64) -> f64;

/// The samples of a run that slip.
fn samples(scenario: &Scenario) -> Vec<Sample> {
    let mut samples = Vec::new();
    let mut rate = f64::NAN;
    let topics = Topics::Only(vec![STATE, CONTACT]);
    Subject::from(scenario).read(&topics, &mut |message, _| {
        if message.topic() == STATE {
            let theta = state::THETA.of(message);
            rate = state::PHI_DOT.of(message) + state::PSI_DOT.of(message) * cos(theta);
        } else if contact::REGIME.of(message) == 1.0 {
            let time = message.time_ns as f64 * 1e-9;
            samples.push([time, contact::SLIP_SPEED.of(message), rate]);
        }
        true
    });
    samples
}

fn slip_of(scenario: &Scenario) -> Slip {
    let options = Options {
        integration_error: false,
        ..Options::default()
    };
    let report = compare(scenario, scenario, &options).unwrap();
    let slip = report.slip.unwrap();
    assert_eq!(slip.a, slip.b);
    assert_eq!(slip.sentence(), None);
    slip.a.unwrap()
}

/// The mean coefficient of friction of the samples at a part of the speeds.
fn mean(samples: &[Sample], [from, to]: [f64; 2], mu: Law) -> (f64, f64) {
    let (mut sum, mut count) = (0.0, 0.0);
    for [_, speed, rate] in samples {
        if (from..to).contains(speed) {
            sum += mu(*speed, *rate);
            count += 1.0;
        }
    }
    (sum / count, count)
}

#[test]
fn val_slip_is_that_of_the_samples() {
    /// The coefficients of friction of the presets, by hand.
    const LAWS: [(&str, Law); 5] = [
        ("full-coulomb", |_, _| 0.03),
        ("viscous", |v, _| 0.03 * v / 0.5),
        ("stribeck", |v, _| {
            0.03 + 0.015 * exp(-v * v / 0.0025) + 0.01 * v
        }),
        ("contensou", |v, rate| {
            0.03 * v / (v + 8.0 / (3.0 * PI) * 1.4e-4 * rate.abs())
        }),
        // It slips, hops, and rolls at the end.
        ("free-paper", |_, _| 0.03),
    ];
    for (preset, mu) in LAWS {
        let scenario = scenario(preset, &[("stop.duration", "25")]);
        let samples = samples(&scenario);
        let slip = slip_of(&scenario);
        for (found, expected) in [
            (slip.start, samples[0]),
            (slip.end, samples[samples.len() - 1]),
        ] {
            let [time, speed, rate] = expected;
            assert_near(preset, found.time, time, 1e-9);
            assert_eq!(found.speed, speed, "{preset}");
            assert_near(preset, found.coefficient, mu(speed, rate), 1e-15);
        }
        assert_near(preset, slip.time, samples.len() as f64 * 1e-3, 1e-9);
        for bin in slip.visited.bins() {
            let (coefficient, count) = mean(&samples, [bin.from, bin.to], mu);
            assert_near(preset, bin.time, count * 1e-3, 1e-12);
            // A rounding for each sample of the sum.
            assert_near(
                preset,
                bin.coefficient,
                coefficient,
                count * f64::EPSILON * coefficient,
            );
        }
        let mut speeds: Vec<f64> = samples.iter().map(|[_, speed, _]| *speed).collect();
        speeds.sort_by(f64::total_cmp);
        for (part, found) in [0.05, 0.5, 0.95].into_iter().zip(slip.quantiles) {
            let expected = speeds[(part * speeds.len() as f64) as usize];
            assert_near(preset, found, expected, expected / 64.0);
        }
        let [fastest, .., slowest] = &slip.path[..] else {
            panic!("{preset}: {:?}", slip.path);
        };
        assert_eq!(
            [slowest.speed, fastest.speed],
            [speeds[0], speeds[speeds.len() - 1]],
            "{preset}"
        );
        // Only Stribeck's law has an extreme: dμ/dv = 0 at v = 0.1105 m/s.
        let extremes = &slip.path[1..slip.path.len() - 1];
        assert_eq!(
            extremes.len(),
            usize::from(preset == "stribeck"),
            "{preset}"
        );
        for extreme in extremes {
            assert_near(preset, extreme.speed, 0.1105, 0.1105 / 64.0);
            assert_near(preset, extreme.coefficient, mu(0.1105, 0.0), 1e-5);
        }
    }
}
