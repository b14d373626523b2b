//! What `diff` says of two runs.

use crate::support::scenario;
use toprise::analysis::diff::{Happened, Options, Report, compare};
use toprise::run::scenario::Scenario;

fn report(a: &Scenario, b: &Scenario) -> Report {
    compare(a, b, &Options::default()).unwrap()
}

fn told(report: &Report) -> String {
    report.summary.join(" ")
}

#[track_caller]
fn assert_told(report: &Report, sentences: &[&str]) {
    let told = told(report);
    for sentence in sentences {
        assert!(told.contains(sentence), "{sentence:?} is not in: {told}");
    }
}

#[track_caller]
fn assert_not_told(report: &Report, words: &[&str]) {
    let told = told(report);
    for word in words {
        assert!(!told.contains(word), "{word:?} is in: {told}");
    }
}

fn happened(report: &Report) -> &Happened {
    report.happened.as_ref().unwrap()
}

/// The shifts of averages were computed from the recorded cycles in Python, with a cubic through the four nearest
/// middles (numpy, `brentq`): −121.327, 339.370, 694 105.7 and 8 538.9 µs. Means over a nutation that begins at any phase
/// pass the level up to 4.95 µs (full-coulomb), 0.2 µs (nutation-free) and 122 µs (paper) from there.
#[test]
fn val_the_averaged_motion_leads_and_the_first_touch_follows() {
    let paper = scenario("paper", &[]);
    let full = scenario("full-coulomb", &[]);
    let free = scenario("nutation-free", &[]);
    let found = report(&full, &free);
    assert_told(
        &found,
        &[
            "Averaged over a nutation, B passes 0.0216 rad 121 µs earlier (± ",
            "In B θ first touches 0.0200 rad 5.92 ms later (24.7369 s, not 24.7309 s), which is not distinguishable from \
             what the nutation does to it (−7.07 ms to +7.07 ms).",
        ],
    );
    let of = happened(&found);
    assert!((of.averaged_shift.unwrap() + 121.327e-6).abs() < 1e-9);
    let uncertainty = of.averaged_shift_uncertainty.unwrap();
    assert!((4e-6..6e-6).contains(&uncertainty), "{uncertainty}");
    let [earlier, later] = of.rise_by_nutation_a.unwrap();
    assert!(
        (earlier + later).abs() < 1e-12 && (later - 7e-3).abs() < 0.1e-3,
        "{later}"
    );

    let found = report(&free, &paper);
    assert_told(
        &found,
        &[
            "B passes 0.0216 rad 339 µs later (± 1",
            "In B θ first touches 0.0200 rad 17.5 ms earlier (24.7194 s, not 24.7369 s), which is not distinguishable",
        ],
    );
    let [earlier, later] = happened(&found).rise_by_nutation_b.unwrap();
    assert!((earlier + 27.3e-3).abs() < 0.1e-3 && (later - 7.2e-3).abs() < 0.1e-3);

    let backward = scenario("paper", &[("initial.psi_dot", "-170")]);
    let found = report(&paper, &backward);
    assert_told(
        &found,
        &[
            "B passes 0.0664 rad 694 ms later (± ",
            "1.40 s earlier",
            "not distinguishable",
        ],
    );

    let found = report(&full, &scenario("full-coulomb", &[("gravity", "9.80665")]));
    assert_told(
        &found,
        &[
            "B passes 0.0216 rad 8.54 ms later (± ",
            "0.0200 rad 21.5 ms later",
        ],
    );
}

#[test]
fn levels_are_compared_that_both_reach() {
    let found = report(
        &scenario("paper", &[]),
        &scenario("paper", &[("stop.theta_risen", "0.1")]),
    );
    assert_told(
        &found,
        &[
            "both pass 0.101 rad at 20.9371 s.",
            "θ first touches 0.100 rad at 20.9828 s in both.",
            "A loops from 24.2703 s on; B ended before, at 20.9828 s.",
        ],
    );
    assert_not_told(&found, &["3.74 s"]);
}

#[test]
fn not_reached_is_not_never() {
    // It rises, passes through upright, and falls much later.
    let found = report(&scenario("lifecycle", &[]), &scenario("paper", &[]));
    assert_told(
        &found,
        &[
            "In B θ first touches 0.0200 rad 2.21 s later (24.7194 s, not 22.5101 s)",
            "A falls to 1.57 rad at 78.4097 s; B ended before, at 24.7194 s.",
        ],
    );
    assert_not_told(&found, &["doesn't rise", "never"]);
    // Loops at other inclinations are other loops.
    let loops = happened(&found)
        .kinds
        .iter()
        .find(|kind| kind.name == "looping_begins");
    assert_eq!(loops.unwrap().matched, 0);
    let short = scenario("paper", &[("stop.duration", "2.0")]);
    let found = report(&scenario("paper", &[]), &short);
    assert_told(
        &found,
        &[
            "A rises to 0.0200 rad at 24.7194 s; B ended before, at 2.0000 s.",
            "A loops from 24.2703 s on; B ended before, at 2.0000 s.",
        ],
    );
}

#[test]
fn a_fall_is_no_nutation() {
    // θ̇ takes 18.6 s from its last maximum of the nutation to that of the fall.
    let found = report(
        &scenario("lifecycle", &[]),
        &scenario("lifecycle", &[("friction.k", "0.031")]),
    );
    assert_eq!(found.a.course.as_ref().unwrap().nutations, Some(614));
    assert!(found.averaged.as_ref().unwrap().to < 52.0);
}

#[test]
fn two_falls_are_told() {
    let falls = |k: &str| scenario("paper-spin-term-only", &[("friction.k", k)]);
    let found = report(&falls("0.03"), &falls("0.031"));
    assert_told(
        &found,
        &["B falls to 1.57 rad 985 ms earlier (29.5499 s, not 30.5354 s)."],
    );
}

#[test]
fn differences_below_the_errors_are_no_physics() {
    let short = |overrides: &[(&str, &str)]| {
        scenario("paper", &[&[("stop.duration", "5.0")], overrides].concat())
    };
    let found = report(&short(&[]), &short(&[("formulation", "body")]));
    assert_told(
        &found,
        &["The same motion, to 1e-10 s: no difference is larger than the integrators' own errors."],
    );
    assert!(found.signals.parted.is_empty() && found.signals.growth.is_empty());
}
