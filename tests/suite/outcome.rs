//! The outcome of a run is that of the whole simulation.

use crate::support::{Run, assert_near, scenario};
use proptest::prelude::*;
use std::f64::consts::FRAC_PI_2;
use toprise::run::outcome;
use toprise::run::outcome::{COLUMNS, Cell, Outcome};
use toprise::run::scenario::{PRESETS, Scenario};
use toprise::run::simulation::{EventKind, StopReason, Tally};

/// The outcome according to the records of a whole simulation.
fn outcome_of_simulation(scenario: &Scenario) -> Outcome {
    let run = Run::of(scenario);
    let mut tally = Tally::default();
    for event in &run.events {
        tally.record(event.kind, event.time);
    }
    assert_eq!(run.end.nutations, run.cycles.len() as u64);
    assert_eq!(run.end.impacts, run.impacts.len() as u64);
    Outcome::new(scenario, run.end, tally)
}

/// Every value of an outcome, numbers by their bits.
fn bits(outcome: &Outcome) -> Vec<(&'static str, Option<String>)> {
    let value = |cell| match cell {
        Cell::Text(text) => text.to_owned(),
        Cell::Integer(number) => number.to_string(),
        Cell::Number(number) => format!("{:016x} {number:?}", number.to_bits()),
    };
    let columns = COLUMNS.iter();
    columns
        .map(|column| (column.name, column.value_of(outcome).map(value)))
        .collect()
}

#[test]
fn outcomes_of_presets_match_whole_runs_bit_for_bit() {
    for preset in PRESETS.iter() {
        let mut scenario = preset.scenario().unwrap();
        // What a free top does in all its run takes too long for a test.
        if scenario.model.support.is_free() {
            let duration = scenario.stop.duration.map(|whole| whole.min(4.0));
            scenario.stop.duration = duration;
        }
        let alone = outcome(&scenario, || true).unwrap();
        let simulated = outcome_of_simulation(&scenario);
        assert_eq!(bits(&alone), bits(&simulated), "{}", preset.name);
    }
}

#[test]
fn tippe_top_inverts_at_the_horizontal() {
    let inverted = scenario("tippe-top", &[("stop.duration", "6.0")]);
    let outcome_of = |scenario| outcome(scenario, || true).unwrap();
    let time = outcome_of(&inverted).end.inversion_time.unwrap();
    let run = Run::of(&inverted);
    assert_eq!(run.times_of(EventKind::Inverts), [time]);
    let theta = run.first(EventKind::Inverts).motion.angles.theta;
    assert_near("θ", theta, FRAC_PI_2, 1e-12);
    let samples = run.samples;
    let above = samples.partition_point(|sample| sample.angles.theta < FRAC_PI_2);
    let [before, after] = [above - 1, above].map(|index| samples[index].time_ns as f64 * 1e-9);
    assert!(before <= time && time <= after, "{before} {time} {after}");

    for (preset, duration) in [
        ("tippe-top", "5.4"),
        ("tippe-top-hangs", "5.0"),
        ("drop", "0.5"),
    ] {
        let scenario = scenario(preset, &[("stop.duration", duration)]);
        let outcome = outcome(&scenario, || true).unwrap();
        assert_eq!(outcome.end.inversion_time, None, "{preset}");
        assert_eq!(outcome.tally.count_of(EventKind::Inverts), 0, "{preset}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Random tops, some of which fall, stick, loop or never do anything.
    #[test]
    fn outcomes_match_whole_runs(
        base in prop_oneof![
            Just("paper"), Just("full-coulomb"), Just("viscous"), Just("stribeck"), Just("free-paper"),
        ],
        k in 0.003..0.3_f64,
        theta in 0.1..1.4_f64,
        psi_dot in 20.0..200.0_f64,
        phi_dot in -20.0..20.0_f64,
        body in any::<bool>(),
    ) {
        let numbers = [k, theta, psi_dot, phi_dot].map(|number| number.to_string());
        let [k, theta, psi_dot, phi_dot] = numbers.each_ref().map(String::as_str);
        let mut changes = vec![
            ("friction.k", k),
            ("initial.theta", theta),
            ("initial.psi_dot", psi_dot),
            ("initial.phi_dot", phi_dot),
            ("stop.duration", "2"),
        ];
        if body {
            changes.push(("formulation", "body"));
        }
        if base == "stribeck" {
            changes.push(("friction.static_k", "0.4"));
        }
        let scenario = scenario(base, &changes);
        let alone = outcome(&scenario, || true).unwrap();
        prop_assert_eq!(bits(&alone), bits(&outcome_of_simulation(&scenario)));
    }
}

/// A top that falls among tops that rise: the dips of its nutation just miss `stop.theta_risen`, whatever the variables and
/// tolerances of the integration. Documented in docs/sweep.md.
#[test]
fn falls_between_rises_are_real() {
    for (formulation, tolerance) in [("euler", "1e-12"), ("body", "1e-10")] {
        let end = |k| {
            let changes = [
                ("initial.psi_dot", "60"),
                ("friction.k", k),
                ("formulation", formulation),
                ("integrator.relative_tolerance", tolerance),
                ("integrator.absolute_tolerance", tolerance),
            ];
            let run = Run::with("paper", &changes);
            let minima = run.events_of(EventKind::NutationMinimum);
            let least = minima.map(|event| event.motion.angles.theta);
            (run.end.stop, least.fold(f64::INFINITY, f64::min))
        };
        assert_eq!(end("0.0925").0, StopReason::Risen);
        assert_eq!(end("0.0945").0, StopReason::Risen);
        let (stop, least) = end("0.0935");
        assert_eq!(stop, StopReason::Fallen);
        // 20 % above the threshold.
        assert!((0.0239..0.0241).contains(&least), "{least}");
    }
}

#[test]
fn outcome_reports_interruption() {
    let scenario = scenario("paper", &[]);
    let mut steps = 0;
    let broken = outcome(&scenario, || {
        steps += 1;
        steps <= 100
    })
    .unwrap();
    assert_eq!(broken.end.stop, StopReason::Interrupted);
    assert_eq!(broken.end.statistics.accepted, 100);
    assert_eq!(broken.tally.first(EventKind::Risen), None);
}

#[test]
fn columns_have_unique_names_and_their_type() {
    let fixed = outcome(&scenario("paper", &[("stop.duration", "1")]), || true).unwrap();
    let free = outcome(&scenario("free-paper", &[("stop.duration", "1")]), || true).unwrap();
    for column in COLUMNS {
        let is_plain = |c: char| c.is_ascii_lowercase() || c == '_';
        assert!(column.name.chars().all(is_plain), "{}", column.name);
        for outcome in [&fixed, &free] {
            let may_be_null = column.null.is_some();
            assert!(
                may_be_null || column.value_of(outcome).is_some(),
                "{}",
                column.name
            );
        }
        let same_name = COLUMNS.iter().filter(|other| other.name == column.name);
        assert_eq!(same_name.count(), 1, "{}", column.name);
    }
    assert_eq!(fixed.get("hops"), None);
    assert_eq!(free.get("hops"), Some(Cell::Integer(0)));
    assert_eq!(fixed.get("no_such_column"), None);
    assert_eq!(fixed.get("stop_time"), Some(Cell::Number(1.0)));
    let json = serde_json::to_value(&fixed).unwrap();
    assert_eq!(json["stop_reason"], "duration");
    assert!(json.get("hops").is_none());
    assert_eq!(json["energy"], fixed.end.energy);
}

#[test]
fn counts_events() {
    let scenario = scenario("paper", &[]);
    let run = Run::of(&scenario);
    let outcome = outcome(&scenario, || true).unwrap();
    assert_eq!(
        outcome.tally.first(EventKind::Risen),
        Some(run.first(EventKind::Risen).time)
    );
    let loops = run.events_of(EventKind::LoopingBegins).count() as u64;
    assert_eq!(
        (outcome.tally.count_of(EventKind::LoopingBegins), loops > 0),
        (loops, true)
    );
    assert_eq!(outcome.tally.first(EventKind::WeakTop), None);
}

/// The documented columns match the table.
#[test]
fn documents_list_every_column() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/sweep.md");
    let text = std::fs::read_to_string(path).unwrap();
    for column in COLUMNS {
        let unit = match column.unit {
            "" => " ".to_owned(),
            unit => format!(" {unit} "),
        };
        let line = format!("| `{}` |{unit}| {} |\n", column.name, column.description());
        assert!(text.contains(&line), "docs/sweep.md lacks {line}");
    }
}

/// A failed run names a duration with which it ends before, also where the last step goes beyond it.
#[test]
fn suggested_duration_ends_before_the_failure() {
    let steep_impact: &[(&str, &str)] = &[
        ("friction.law", "coulomb-rational"),
        ("friction.k", "0.774"),
        ("friction.smoothing_speed", "9.16e-7"),
        ("initial.phi_dot", "-392"),
        ("initial.theta_dot", "5.61e4"),
        ("initial.theta", "1.492"),
        ("initial.height", "0.0076"),
        ("support.restitution", "0.94"),
        ("rolling.arm", "7.26e-5"),
    ];
    let chattering: &[(&str, &str)] = &[
        ("friction.k", "1.45"),
        ("top.mass", "4.52e-6"),
        ("top.center_distance", "1.79"),
        ("top.transverse_moment", "3.837e-5"),
        ("top.axial_moment", "2e-9"),
        ("top.peg_radius", "1.08"),
        ("initial.psi_dot", "2.51e5"),
        ("initial.phi_dot", "12.6"),
        ("initial.theta_dot", "2.13e4"),
        ("initial.theta", "2.768"),
        ("initial.height", "0.0536"),
        ("support.restitution", "0.54"),
        ("integrator.relative_tolerance", "1e-4"),
        ("integrator.absolute_tolerance", "1e-18"),
    ];
    for (what, keys) in [
        ("the impact can't be computed at t = ", steep_impact),
        ("phases of flight alternate without end", chattering),
    ] {
        let mut keys = keys.to_vec();
        keys.extend([
            ("stop.theta_risen", ""),
            ("stop.theta_fallen", ""),
            ("stop.on_stick", ""),
            ("stop.duration", "0.02"),
        ]);
        let error = outcome(&scenario("free-paper", &keys), || true).unwrap_err();
        let error = error.to_string();
        assert!(error.contains(what), "{error}");
        let (_, advice) = error.split_once("a stop.duration of at most ").unwrap();
        let (duration, _) = advice.split_once(" s ends the run before").unwrap();
        keys.push(("stop.duration", duration));
        let outcome = outcome(&scenario("free-paper", &keys), || true).unwrap();
        assert_eq!(outcome.end.stop, StopReason::Duration);
        let time: f64 = duration.parse().unwrap();
        assert_eq!(outcome.end.time, time);
    }
}
