//! Nutation cycles, their envelopes, and the integrals of the terms of φ̈.

use crate::random_scenarios::{Random, free_tops, held_tops};
use crate::support::{Run, archive, scenario};
use tempfile::tempdir;
use toprise::archive::format::{TELEMETRY, recorded_form};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::physics::kinematics::Euler;
use toprise::run::scenario::{Scenario, Values};
use toprise::run::simulation::{EventKind, NutationCycle, Sample};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::fields::STATE;
use toprise::telemetry::{Topics, table};

/// The period of nutation without friction from the state of the sample that is next to a cycle's start.
fn period(run: &Run, scenario: &Scenario, cycle: &NutationCycle) -> f64 {
    let distance = |s: &&Sample| (s.time_ns as f64 / 1e9 - cycle.start).abs();
    let nearest = |a: &&Sample, b: &&Sample| distance(a).total_cmp(&distance(b));
    let sample = run.samples.iter().min_by(nearest).unwrap();
    let extremes = [cycle.theta_min, cycle.theta_max];
    let top = &scenario.model.top;
    top.nutation_period(&sample.tilt, extremes).unwrap()
}

#[test]
fn val_the_period_of_nutation_of_any_amplitude() {
    for (psi_dot, phi_dot, theta) in [
        ("170", "1.75", "0.5"),
        ("170", "0", "0.5"),
        ("40", "0", "0.5"),
        ("38", "3", "1.2"),
        ("60", "-8", "0.3"),
        ("120", "400", "0.7"),
        ("3", "0", "2.5"),
    ] {
        let changes = [
            ("initial.psi_dot", psi_dot),
            ("initial.phi_dot", phi_dot),
            ("initial.theta", theta),
            ("stop.duration", "3"),
            ("formulation", "body"),
            ("stop.theta_fallen", ""),
            ("stop.theta_risen", ""),
        ];
        let scenario = scenario("frictionless", &changes);
        let run = Run::of(&scenario);
        let what = format!("{psi_dot} {phi_dot} {theta}");
        assert!(run.cycles.len() > 2, "{what}");
        for cycle in &run.cycles {
            let expected = period(&run, &scenario, cycle);
            let error = (cycle.period() / expected - 1.0).abs();
            assert!(error < 1e-8, "{what}: {cycle:?} {expected}");
        }
        // No nutation is lost: each begins where the one before ends.
        let mut pairs = run.cycles.windows(2);
        assert!(pairs.all(|pair| pair[0].end == pair[1].start), "{what}");
    }
}

#[test]
fn fall_is_not_a_nutation() {
    // Of the presets those that fall: what lasted 9 to 100 times as long as a nutation was a cycle once.
    for (preset, count) in [("lifecycle", 614), ("paper-spin-term-only", 322)] {
        let scenario = scenario(preset, &[]);
        let run = Run::of(&scenario);
        assert_eq!(run.cycles.len(), count, "{preset}");
        for cycle in &run.cycles {
            let periods = cycle.period() / period(&run, &scenario, cycle);
            // 1.12 is that of the last one before the fall.
            let is_one = (0.9..1.15).contains(&periods);
            assert!(is_one, "{preset}: {periods} {cycle:?}");
        }
        let indices = run.cycles.iter().map(|cycle| cycle.index as usize);
        assert!(indices.eq(0..count), "{preset}");
    }
}

/// An impact shifts the phase of the nutation. What lies between it and a maximum of θ̇, or between two maxima half a
/// nutation apart, is no nutation: its mean φ̇ was up to 15.2 rad/s, nine times that of the motion.
#[test]
fn nutations_cut_by_impacts_are_not_cycles() {
    for restitution in ["1", "0.9", "0.5"] {
        let scenario = scenario("free-paper", &[("support.restitution", restitution)]);
        let run = Run::of(&scenario);
        let top = scenario.model.nutating_top();
        for cycle in &run.cycles {
            for hit in &run.impacts {
                let is_end = [cycle.start, cycle.end].contains(&hit.time);
                assert!(!is_end, "{restitution}: {cycle:?}");
            }
            // Only nutations in sliding and in the air: rolling has another period.
            let is_rolling = run
                .events_of(EventKind::RollBegins)
                .any(|event| event.time < cycle.end);
            let at_start = run
                .samples
                .iter()
                .rfind(|sample| sample.time_ns as f64 / 1e9 <= cycle.start);
            let Some(sample) = at_start.filter(|_| !is_rolling) else {
                continue;
            };
            let extremes = [cycle.theta_min, cycle.theta_max];
            let Some(period) = top.nutation_period(&sample.tilt, extremes) else {
                continue;
            };
            // √2, and 2 % because the sample is up to 1 ms before the cycle.
            let ratio = cycle.period() / period;
            assert!(
                (0.69..1.45).contains(&ratio),
                "{restitution}: {ratio} {cycle:?}"
            );
        }
        assert!(
            run.cycles.len() > 300,
            "{restitution}: {}",
            run.cycles.len()
        );
    }
}

#[test]
fn envelopes_match_finer_sampling() {
    for preset in [
        "paper",
        "full-coulomb",
        "paper-precession-term-only",
        "rise-by-loss-of-spin",
    ] {
        let run = |period| {
            let keys = [("stop.duration", "0.3"), ("sampling.period", period)];
            Run::with(preset, &keys)
        };
        let (coarse, fine) = (run("0.05"), run("1e-5"));
        // What is recorded of cycles doesn't depend on the sampling.
        assert_eq!(coarse.cycles, fine.cycles);
        for cycle in &fine.cycles {
            let range_of = |get: fn(&Euler) -> f64, margin: f64| {
                let inside = fine.samples.iter().filter(|sample| {
                    let time = sample.time_ns as f64 / 1e9;
                    time >= cycle.start - margin && time <= cycle.end + margin
                });
                let values = inside.map(|sample| get(&sample.tilt.rates));
                values.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| {
                    [a.min(x), b.max(x)]
                })
            };
            for get in [|r: &Euler| r.theta, |r: &Euler| r.phi, |r: &Euler| r.psi] {
                let get: fn(&Euler) -> f64 = get;
                let [least, greatest] = [get(&cycle.least_rates), get(&cycle.greatest_rates)];
                // What lies within the cycle, and what reaches a sample beyond its ends.
                let (inner, outer) = (range_of(get, 0.0), range_of(get, 1e-5));
                // Between samples 1e-5 s apart at 140 rad/s a rate can pass its extreme by (ω h)²/8, 3e-7 of its range;
                // what the search misses is less.
                let slack = 1e-6 * (greatest - least) + 1e-12 * greatest.abs();
                assert!(least <= inner[0] + slack && least >= outer[0] - slack);
                assert!(greatest >= inner[1] - slack && greatest <= outer[1] + slack);
            }
        }
    }
}

/// Time between samples that see every impact and turn of a rate, s.
const FINE: f64 = 1e-5;

/// A scenario with fine samples of its first 0.2 s and the tolerances of the presets.
fn finely_sampled(scenario: &Scenario) -> Option<Scenario> {
    let mut values = Values::from_toml(&scenario.to_toml()).unwrap();
    for (key, value) in [
        ("sampling.period", FINE),
        ("stop.duration", 0.2),
        ("integrator.relative_tolerance", 1e-12),
        ("integrator.absolute_tolerance", 1e-12),
    ] {
        values.set_value(key, value).unwrap();
    }
    Scenario::new(values).ok()
}

/// Each sample of a cycle lies within its extremes, and between two samples the motion reaches each extreme. A sample beside
/// the cycle counts only where no impact lies between them.
fn assert_ranges_are_tight(scenario: &Scenario) -> usize {
    let run = Run::of(scenario);
    for cycle in &run.cycles {
        let near = |time: f64| {
            let mut distances = run.impacts.iter().map(|hit| (hit.time - time).abs());
            let is_impact = distances.any(|distance| distance < 1e-9);
            if is_impact { 0.0 } else { FINE }
        };
        let [from, to] = [cycle.start - near(cycle.start), cycle.end + near(cycle.end)];
        let time = |sample: &Sample| sample.time_ns as f64 / 1e9;
        let around = run.samples.iter();
        let around: Vec<_> = around.filter(|s| time(s) > from && time(s) < to).collect();
        let inside = |s: &&&Sample| time(s) > cycle.start && time(s) < cycle.end;
        let sine = around.iter().map(|s| s.tilt.sin).fold(1.0, f64::min);
        // So near the vertical that φ̇ and ψ̇ have a peak between two samples.
        let turn = cycle.greatest_rates.theta.max(-cycle.least_rates.theta) * FINE;
        if sine < 2.0 * turn {
            continue;
        }
        for get in
            [|r: &Euler| r.theta, |r: &Euler| r.phi, |r: &Euler| r.psi] as [fn(&Euler) -> f64; 3]
        {
            let [least, greatest] = [get(&cycle.least_rates), get(&cycle.greatest_rates)];
            // The dense output errs by ten tolerances, and φ̇ and ψ̇ by that over sin² θ.
            let slack = 1e-11 * (greatest - least + greatest.abs()) / (sine * sine);
            for sample in around.iter().filter(inside) {
                let rate = get(&sample.tilt.rates);
                let is_inside = rate >= least - slack && rate <= greatest + slack;
                assert!(is_inside, "{rate} {cycle:?} {}", scenario.to_toml());
            }
            let slopes = around.iter().map(|s| get(&s.euler_accelerations).abs());
            let steepest = slopes.fold(0.0, f64::max);
            let range = |of: fn(f64, f64) -> f64, from| {
                around.iter().map(|s| get(&s.tilt.rates)).fold(from, of)
            };
            let reach = 2.0 * steepest * FINE + slack;
            let low = range(f64::min, f64::INFINITY);
            let high = range(f64::max, f64::NEG_INFINITY);
            let is_reached = least >= low - reach && greatest <= high + reach;
            assert!(is_reached, "{low} {high} {cycle:?} {}", scenario.to_toml());
        }
    }
    run.cycles.len()
}

#[test]
fn val_rate_ranges_match_finer_sampling() {
    let drop = scenario("drop", &[("stop.duration", "0.1")]);
    let thrown = [("initial.theta_dot", "10"), ("friction.k", "0.05")];
    let thrown = scenario("free-paper", &thrown);
    let random = free_tops(Random(5))
        .take(60)
        .chain(held_tops(Random(6)).take(40));
    let mut cycles = 0;
    for scenario in [drop, thrown].into_iter().chain(random) {
        cycles += finely_sampled(&scenario).map_or(0, |fine| assert_ranges_are_tight(&fine));
    }
    assert!(cycles > 300, "{cycles}");
}

#[test]
fn val_the_terms_add_up_to_the_change_of_the_rate() {
    // 20 samples a second see a nutation of 23 to 60 Hz at odd phases: sums over them would be anything.
    let overrides = [("stop.duration", "20"), ("sampling.period", "0.05")];
    let run = Run::with("paper-precession-term-only", &overrides);
    let first = run.samples[0].tilt.rates.phi;
    for sample in &run.samples {
        let terms = &sample.integrals.terms;
        let sum = terms.phi_gyroscopic + terms.phi_coriolis + terms.phi_frictional;
        let change = sample.tilt.rates.phi - first;
        assert!((sum - change).abs() < 1e-8, "{sum} {change}");
        let work: f64 = sample.integrals.work_node.iter().sum();
        assert!((work - sample.integrals.friction_work).abs() < 1e-12);
    }
    // In closed form the integral of friction's term in ψ̈ is zero.
    let last = run.samples.last().unwrap().integrals;
    assert_eq!(last.terms.psi_frictional, 0.0);
    let run = Run::with("frictionless", &[("stop.duration", "1")]);
    let last = run.samples.last().unwrap().integrals;
    assert_eq!((last.terms.phi_frictional, last.slip_work), (0.0, 0.0));
}

#[test]
fn recording_names_telemetry_version_and_form() {
    let directory = tempdir().unwrap();
    let scenario = scenario("paper", &[("stop.duration", "0.1")]);
    for (name, topics, form) in [
        ("all", vec![], Form::default()),
        (
            "some",
            vec!["/top/state"],
            Form {
                encoding: Encoding::Protobuf,
                views: false,
            },
        ),
    ] {
        let path = directory.path().join(name).with_extension("mcap");
        archive(&path, &scenario, &topics, form).unwrap();
        let recording = Recording::open(&path).unwrap();
        let run = recording.run().unwrap();
        assert_eq!(run[TELEMETRY], table::VERSION.to_string());
        let expected = if topics.is_empty() {
            Topics::All
        } else {
            Topics::Only(vec![STATE])
        };
        assert_eq!(recorded_form(run), Some((form, expected)));
    }
}
