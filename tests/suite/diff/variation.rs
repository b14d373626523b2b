//! Runs with other values than those of A and B.

use super::*;
use toprise::analysis::diff::{KeyPlan, Match, MatchError, find_match, sensitivities};

fn no_count() {}

fn rise_time(scenario: &Scenario) -> f64 {
    Run::of(scenario).end.time
}

/// The part of a key is what it does alone, and the interaction is the rest.
#[test]
fn val_parts_of_keys_are_those_of_runs_with_one_change() {
    let (k, radius) = (("friction.k", "0.06"), ("top.peg_radius", "0.008"));
    let [a, b] = [&[][..], &[k, radius]].map(|changes| scenario("paper", changes));
    let report = compare(&a, &b, &quick()).unwrap();
    let plan = KeyPlan::new(&a, &b, &report.setup.scenario).unwrap();
    assert_eq!((plan.runs(), plan.has_pairs()), (3, false));
    let by_key = plan.compute(&report.findings, &no_count);
    let is_end = |quantity| matches!(quantity, Quantity::End { .. });
    let mut effects = by_key.effects.iter();
    let end = effects.find(|effect| is_end(effect.quantity)).unwrap();
    let own = rise_time(&a);
    let mut rest = rise_time(&b) - own;
    assert_near("difference", end.difference, rest, 1e-12);
    for (change, part) in by_key.changes.iter().zip(&end.parts) {
        let values = [k, radius];
        let value = values
            .iter()
            .find(|(key, _)| *key == change.keys[0])
            .unwrap();
        let alone = rise_time(&scenario("paper", &[*value])) - own;
        assert_near(value.0, part.unwrap(), alone, 1e-12);
        rest -= alone;
    }
    assert_near("interaction", end.interaction.unwrap(), rest, 1e-12);
}

/// Keys that need others change with them or after them.
#[test]
fn keys_change_in_an_order_that_is_possible() {
    for (a, b, expected) in [
        (
            "paper",
            "viscous",
            vec![
                (vec!["friction.dissipation"], vec![]),
                (vec!["friction.law", "friction.viscous_speed"], vec![]),
            ],
        ),
        (
            "paper",
            "free-paper",
            vec![
                (vec!["formulation"], vec![]),
                (vec!["friction.dissipation"], vec![]),
                (
                    vec!["support.kind"],
                    vec!["formulation", "friction.dissipation"],
                ),
                (vec!["stop.on_stick"], vec!["friction.dissipation"]),
            ],
        ),
    ] {
        let end = ("stop.duration", "0.1");
        let [a, b] = [a, b].map(|name| scenario(name, &[end]));
        let report = compare(&a, &b, &quick()).unwrap();
        let plan = KeyPlan::new(&a, &b, &report.setup.scenario).unwrap();
        let changes = plan.changes.iter();
        let found: Vec<_> = changes
            .map(|change| {
                let words = |keys: &[String]| keys.to_vec();
                (words(&change.keys), words(&change.after))
            })
            .collect();
        let expected: Vec<_> = expected
            .iter()
            .map(|(keys, after): &(Vec<&str>, Vec<&str>)| {
                let words = |keys: &[&str]| keys.iter().map(ToString::to_string).collect();
                (words(keys), words(after))
            })
            .collect::<Vec<(Vec<String>, Vec<String>)>>();
        assert_eq!(found, expected);
    }
}

/// A run that is the other with another value is found again.
#[test]
fn val_match_finds_the_value_of_the_other_run() {
    let [a, b] = ["0.03", "0.0413"].map(|k| scenario("paper", &[("friction.k", k)]));
    let Match {
        value,
        rms,
        until,
        is_at_bound,
        ..
    } = find_match(&a, &b, "friction.k", &no_count).unwrap();
    assert_near("k", value, 0.0413, 1e-5 * 0.0413);
    assert!(rms[1] < 1e-4 * rms[0] && until.is_none(), "{rms:?}");
    assert!(!is_at_bound);
    let far = scenario("paper", &[("friction.k", "0.9"), ("stop.duration", "1")]);
    assert!(
        find_match(&a, &far, "friction.k", &no_count)
            .unwrap()
            .is_at_bound
    );
    for key in ["friction.law", "initial.theta_dot", "none"] {
        let error = find_match(&a, &b, key, &no_count).unwrap_err();
        assert_eq!(
            error,
            MatchError::NoNumber {
                key: key.to_owned()
            }
        );
    }
}

/// What remains of a match is the distance of the matched run.
#[test]
fn val_match_tells_what_remains() {
    let [a, b] = ["paper", "viscous"].map(|name| scenario(name, &[("stop.duration", "20")]));
    let found = find_match(&a, &b, "friction.k", &no_count).unwrap();
    let matched = a.with([("friction.k", found.value.into())]).unwrap();
    let [x, y] = [&matched, &b].map(Run::of);
    let mut largest = 0.0_f64;
    for (x, y) in x.samples.iter().zip(&y.samples) {
        let distance = (y.angles.theta - x.angles.theta).abs();
        largest = largest.max(distance);
        if x.time_ns as f64 / 1e9 < found.until.unwrap() - 0.02 {
            assert!(distance <= 0.01);
        }
    }
    // Compared at every tenth sample, in which θ nutates by less.
    assert_near("largest", found.largest, largest, 1e-4);
    assert!(found.rms[1] < found.rms[0]);
    let sentence = found.sentence().to_string();
    assert!(sentence.contains("A comes closest to B"), "{sentence}");
}

/// A percent of a measured number shifts the rise as runs with that number do.
#[test]
fn val_sensitivities_are_those_of_changed_runs() {
    let [a, b] = ["0.06", "0.066"].map(|k| scenario("paper", &[("friction.k", k)]));
    let report = compare(&a, &b, &quick()).unwrap();
    let found = sensitivities([&a, &b], &report.findings, &no_count);
    let mut rows = found.iter();
    let end = rows.find(|row| matches!(row.quantity, Quantity::End { .. }));
    let changes = end.unwrap().changes;
    for (at, key, values) in [
        (0, "friction.k", [0.06, 0.066]),
        (1, "top.peg_radius", [0.007, 0.007]),
    ] {
        let difference = |factor: f64| {
            let changed = |run: &Scenario, value: f64| {
                rise_time(&run.with([(key, (factor * value).into())]).unwrap())
            };
            changed(&b, values[1]) - changed(&a, values[0])
        };
        let expected = 0.5 * (difference(1.01) - difference(0.99));
        assert_near(key, changes[at].unwrap(), expected, 1e-12);
    }
}
