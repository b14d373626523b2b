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
    // Upright the averages stand still: the shift is told where they still fall.
    assert_eq!(happened(&found).is_averaged_shift_clear(), Some(true));
    assert!(happened(&found).averaged_level.unwrap() > 0.01);
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

/// At 1 and at 0.7 ms the samples have few times in common. The difference is that of interpolation.
#[test]
fn another_sampling_is_the_same_motion() {
    let sampled = |period: &str| {
        scenario(
            "paper",
            &[("stop.duration", "2.0"), ("sampling.period", period)],
        )
    };
    let found = report(&sampled("0.001"), &sampled("0.0007"));
    assert_told(
        &found,
        &[
            "The same motion: no difference is larger than the errors of the integrators and of interpolation.",
        ],
    );
    assert!(found.signals.parted.is_empty() && found.signals.growth.is_empty());
    for (topic, field) in found
        .signals
        .fields()
        .filter(|(_, field)| !field.is_derived)
    {
        let is_equal = field.first_different.is_none() || field.is_below_floor;
        assert!(is_equal, "{topic} {field:?}");
    }
    let regime = found
        .signals
        .fields()
        .find(|(_, field)| field.field == "regime");
    assert_eq!(regime.unwrap().1.first_different, None);
}

/// What is lost follows from the motion, not from when it was sampled last.
#[test]
fn budgets_do_not_depend_on_the_sampling() {
    let sampled = |period: &str| scenario("full-coulomb", &[("sampling.period", period)]);
    let options = Options {
        floor: false,
        ..Options::default()
    };
    for period in ["0.002", "0.0007"] {
        let found = compare(&sampled("0.001"), &sampled(period), &options).unwrap();
        let of = happened(&found);
        for (a, b) in [
            (of.budget_a, of.budget_b),
            (of.common_budget_a, of.common_budget_b),
        ] {
            let (a, b) = (a.unwrap(), b.unwrap());
            assert_eq!(a.time, b.time);
            // Over 2 ms of a nutation of 22 Hz the cubic through the powers is off by (ω h)⁴ = 6e-3 of their ripple,
            // which is a hundredth of 0.01 W.
            assert!((a.energy_lost - b.energy_lost).abs() < 1e-9, "{a:?} {b:?}");
            assert!(
                (a.friction_work - b.friction_work).abs() < 1e-9,
                "{a:?} {b:?}"
            );
            assert!((a.energy_lost + a.friction_work).abs() < 1e-12, "{a:?}");
            let (a, b) = (a.friction_work_node.unwrap(), b.friction_work_node.unwrap());
            for (a, b) in a.iter().zip(b) {
                assert!((a - b).abs() < 1e-9, "{a} {b}");
            }
        }
    }
}

/// Recordings of 0.1.0 have cycles in a fall, of which one lasts eight times as long as a nutation.
#[test]
fn falls_of_old_recordings_are_no_nutation() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data/0.1.0/paper-spin-term-only.mcap");
    let old = toprise::archive::recording::Recording::open(&path).unwrap();
    let options = Options {
        floor: false,
        ..Options::default()
    };
    let found = compare(&old, &scenario("paper-spin-term-only", &[]), &options).unwrap();
    for run in [&found.a, &found.b] {
        assert_eq!(run.course.as_ref().unwrap().nutations, Some(306));
    }
}

#[test]
fn rest_is_told() {
    let resting = |k: &str| {
        scenario(
            "full-coulomb",
            &[
                ("stop.theta_risen", ""),
                ("stop.on_stick", "continue"),
                ("sampling.period", "0.01"),
                ("initial.psi_dot", "0"),
                ("initial.phi_dot", "10"),
                ("friction.k", "10"),
                ("drilling.k", k),
                ("drilling.patch_radius", "1e-3"),
                ("stop.duration", "60"),
            ],
        )
    };
    let found = report(&resting("10"), &resting("9"));
    assert_told(&found, &["A comes to rest at 0.1187 s; B at 0.1318 s."]);
}
