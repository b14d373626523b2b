//! What `diff` says of many pairs of runs, as reviewed against the recorded numbers.
//!
//! The sentences are kept in `snapshots/`. A sentence that changes is to be checked against numbers that were computed
//! otherwise before it is kept: `INSTA_UPDATE=always cargo test --test suite diff_pairs` writes them.

use crate::support::scenario;
use proptest::prelude::*;
use std::fmt::Write as _;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use toprise::analysis::diff::{Options, Report, compare};

type Overrides = &'static [(&'static str, &'static str)];

/// Two runs: presets with overrides, and whether the integrators' errors are wanted.
struct Pair {
    name: &'static str,
    a: (&'static str, Overrides),
    b: (&'static str, Overrides),
    has_floor: bool,
}

const fn pair(
    name: &'static str,
    a: (&'static str, Overrides),
    b: (&'static str, Overrides),
) -> Pair {
    Pair {
        name,
        a,
        b,
        has_floor: false,
    }
}

const fn exact(
    name: &'static str,
    a: (&'static str, Overrides),
    b: (&'static str, Overrides),
) -> Pair {
    Pair {
        has_floor: true,
        ..pair(name, a, b)
    }
}

const STICKING: Overrides = &[
    ("stop.theta_risen", ""),
    ("stop.on_stick", "continue"),
    ("sampling.period", "0.01"),
    ("stop.duration", "30"),
];

#[rustfmt::skip]
const PAIRS: &[Pair] = &[
    exact("two friction models", ("paper", &[]), ("full-coulomb", &[])),
    exact("the same in the other order", ("full-coulomb", &[]), ("paper", &[])),
    pair("nutation against none", ("full-coulomb", &[]), ("nutation-free", &[])),
    pair("none against loops", ("nutation-free", &[]), ("paper", &[])),
    pair("spin the other way", ("paper", &[]), ("paper", &[("initial.psi_dot", "-170")])),
    pair("the mirror image", ("paper", &[("initial.psi_dot", "170")]), ("paper", &[("initial.psi_dot", "-170"), ("initial.phi_dot", "-1.75")])),
    pair("a little less gravity", ("full-coulomb", &[]), ("full-coulomb", &[("gravity", "9.80665")])),
    pair("one percent more friction", ("paper", &[]), ("paper", &[("friction.k", "0.0303")])),
    pair("twice the friction", ("paper", &[]), ("paper", &[("friction.k", "0.06")])),
    pair("other levels of the risen", ("paper", &[]), ("paper", &[("stop.theta_risen", "0.1")])),
    pair("other levels and other friction", ("paper", &[("stop.theta_risen", "0.3")]), ("paper", &[("friction.k", "0.04"), ("stop.theta_risen", "0.2")])),
    pair("ended early", ("paper", &[]), ("paper", &[("stop.duration", "2")])),
    pair("a life and a rise", ("lifecycle", &[("stop.duration", "30")]), ("paper", &[])),
    pair("two lives", ("lifecycle", &[]), ("lifecycle", &[("friction.k", "0.031")])),
    exact("two formulations", ("paper", &[("stop.duration", "5")]), ("paper", &[("stop.duration", "5"), ("formulation", "body")])),
    exact("other times of the samples", ("paper", &[("stop.duration", "2")]), ("paper", &[("stop.duration", "2"), ("sampling.period", "0.0007")])),
    exact("a coarser sampling", ("paper", &[("stop.duration", "2")]), ("paper", &[("stop.duration", "2"), ("sampling.period", "0.004")])),
    exact("a coarser integrator", ("paper", &[("stop.duration", "2")]), ("paper", &[("stop.duration", "2"), ("integrator.relative_tolerance", "1e-7"), ("integrator.absolute_tolerance", "1e-9")])),
    pair("another name", ("paper", &[("stop.duration", "1")]), ("paper", &[("stop.duration", "1"), ("name", "other")])),
    pair("the same run", ("paper", &[("stop.duration", "1")]), ("paper", &[("stop.duration", "1")])),
    pair("two falls", ("paper-spin-term-only", &[]), ("paper-spin-term-only", &[("friction.k", "0.031")])),
    pair("a fall to another level", ("paper-spin-term-only", &[]), ("paper-spin-term-only", &[("stop.theta_fallen", "1.0")])),
    pair("a fall and a rise", ("paper-spin-term-only", &[]), ("paper", &[])),
    pair("another fall", ("spin-torque-only", &[("friction.k", "0.12")]), ("paper-spin-term-only", &[])),
    pair("without friction", ("frictionless", &[("stop.duration", "5")]), ("frictionless", &[("stop.duration", "5"), ("initial.psi_dot", "171")])),
    pair("with friction and without", ("frictionless", &[("stop.duration", "2")]), ("paper", &[("stop.duration", "2")])),
    pair("cusps", ("frictionless", &[("stop.duration", "2"), ("initial.phi_dot", "0")]), ("frictionless", &[("stop.duration", "2"), ("initial.phi_dot", "0.01")])),
    pair("loops without friction", ("frictionless", &[("stop.duration", "2"), ("initial.phi_dot", "-1")]), ("frictionless", &[("stop.duration", "2"), ("initial.phi_dot", "0.01")])),
    pair("precession alone", ("paper-precession-term-only", &[("stop.duration", "3")]), ("paper", &[("stop.duration", "3")])),
    pair("the tilting torque alone", ("tilt-torque-only", &[]), ("full-coulomb", &[])),
    pair("viscous", ("viscous", &[("stop.duration", "20")]), ("full-coulomb", &[("stop.duration", "20")])),
    pair("Stribeck", ("stribeck", &[]), ("full-coulomb", &[])),
    pair("Contensou", ("contensou", &[]), ("full-coulomb", &[])),
    pair("the fast root", ("rise-by-loss-of-spin", &[]), ("rise-by-loss-of-spin", &[("friction.k", "0.031")])),
    pair("the fast root and the slow one", ("paper", &[("stop.duration", "2"), ("initial.phi_dot", "300")]), ("paper", &[("stop.duration", "2")])),
    pair("oblate tops", ("rise-by-loss-of-spin", &[("stop.duration", "3")]), ("rise-by-loss-of-spin", &[("stop.duration", "3"), ("top.axial_moment", "1.115e-4")])),
    pair("no spin", ("paper", &[("initial.psi_dot", "0")]), ("paper", &[("initial.psi_dot", "0"), ("friction.k", "0.04")])),
    pair("too little spin", ("paper", &[("initial.psi_dot", "20"), ("initial.phi_dot", "0")]), ("paper", &[("initial.psi_dot", "25"), ("initial.phi_dot", "0")])),
    pair("too little and enough", ("paper", &[("initial.psi_dot", "20")]), ("paper", &[("stop.duration", "1")])),
    pair("short", ("paper", &[("stop.duration", "0.1")]), ("paper", &[("stop.duration", "0.2")])),
    pair("shorter than a nutation", ("paper", &[("stop.duration", "0.01")]), ("full-coulomb", &[("stop.duration", "0.01")])),
    pair("sticking", ("full-coulomb", STICKING), ("full-coulomb", &[("stop.theta_risen", ""), ("stop.on_stick", "continue"), ("sampling.period", "0.01"), ("stop.duration", "30"), ("friction.k", "0.031")])),
    pair("slip stops", ("full-coulomb", &[("stop.theta_risen", "")]), ("full-coulomb", &[])),
    pair("coming to rest", ("full-coulomb", &[("stop.theta_risen", ""), ("stop.on_stick", "continue"), ("sampling.period", "0.01"), ("stop.duration", "60"), ("initial.psi_dot", "0"), ("initial.phi_dot", "10"), ("friction.k", "10"), ("drilling.k", "10"), ("drilling.patch_radius", "1e-3")]), ("full-coulomb", &[("stop.theta_risen", ""), ("stop.on_stick", "continue"), ("sampling.period", "0.01"), ("stop.duration", "60"), ("initial.psi_dot", "0"), ("initial.phi_dot", "10"), ("friction.k", "10"), ("drilling.k", "9"), ("drilling.patch_radius", "1e-3")])),
    pair("through upright", ("frictionless", &[("formulation", "body"), ("stop.duration", "2"), ("initial.theta", "0.05"), ("initial.phi_dot", "0")]), ("frictionless", &[("formulation", "body"), ("stop.duration", "2"), ("initial.theta", "0.06"), ("initial.phi_dot", "0")])),
    pair("hanging", ("frictionless", &[("stop.duration", "2"), ("initial.theta", "2.5")]), ("frictionless", &[("stop.duration", "2"), ("initial.theta", "2.6")])),
    pair("air", ("full-coulomb", &[("stop.duration", "10")]), ("full-coulomb", &[("stop.duration", "10"), ("air.axial", "1.45e-6"), ("air.transverse", "4e-6")])),
    pair("a heavier top", ("full-coulomb", &[]), ("full-coulomb", &[("top.mass", "0.111")])),
];

/// Runs of tops whose pegs are free, in one of them or in both.
#[rustfmt::skip]
const FREE_PAIRS: &[Pair] = &[
    exact("held and free", ("paper", &[]), ("free-paper", &[])),
    pair("free and held", ("free-paper", &[]), ("paper", &[])),
    pair("the whole torque, held and free", ("full-coulomb", &[("formulation", "body")]), ("free-paper", &[])),
    pair("held and free under viscous friction", ("full-coulomb", &[("friction.law", "viscous"), ("friction.viscous_speed", "0.5")]), ("free-viscous", &[])),
    pair("held and free, ended early", ("paper", &[("stop.duration", "2")]), ("free-paper", &[("stop.duration", "2")])),
    pair("two coefficients", ("free-paper", &[]), ("free-rolls", &[])),
    pair("a coefficient and a law", ("free-paper", &[("stop.duration", "8")]), ("free-paper", &[("stop.duration", "8"), ("friction.law", "coulomb-sqrt"), ("friction.smoothing_speed", "0.007")])),
    pair("a little less restitution", ("free-paper", &[("stop.duration", "4"), ("support.restitution", "0.5")]), ("free-paper", &[("stop.duration", "4"), ("support.restitution", "0.49")])),
    exact("one ulp apart", ("free-paper", &[("stop.duration", "4")]), ("free-paper", &[("stop.duration", "4"), ("initial.psi_dot", "170.00000000000003")])),
    exact("the free mirror image", ("free-paper", &[("stop.duration", "8")]), ("free-paper", &[("stop.duration", "8"), ("initial.psi_dot", "-170"), ("initial.phi_dot", "-1.75")])),
    pair("the same free run", ("drop", &[("stop.duration", "0.5")]), ("drop", &[("stop.duration", "0.5")])),
    pair("two heights", ("drop", &[]), ("drop", &[("initial.height", "0.01")])),
    pair("a drop and none", ("drop", &[]), ("drop", &[("initial.height", ""), ("support.restitution", "")])),
    pair("a bounce without loss", ("drop", &[("stop.duration", "0.5")]), ("drop", &[("stop.duration", "0.5"), ("support.restitution", "1")])),
    pair("tippe tops", ("tippe-top", &[]), ("tippe-top-hangs", &[])),
    pair("more rolling resistance", ("free-paper", &[("friction.k", "0.1"), ("rolling.arm", "2.1e-4"), ("stop.duration", "3")]), ("free-paper", &[("friction.k", "0.1"), ("rolling.arm", "1e-4"), ("stop.duration", "3")])),
    pair("held and free without friction", ("frictionless", &[("stop.duration", "2")]), ("free-paper", &[("friction.k", "0"), ("stop.duration", "2")])),
    pair("falling, held and free", ("paper", &[("initial.psi_dot", "0"), ("initial.phi_dot", "0")]), ("free-paper", &[("initial.psi_dot", "0"), ("initial.phi_dot", "0")])),
];

fn sentences(pair: &Pair) -> Vec<String> {
    let ((a, of_a), (b, of_b)) = (pair.a, pair.b);
    let options = Options {
        floor: pair.has_floor,
        ..Options::default()
    };
    let report = compare(&scenario(a, of_a), &scenario(b, of_b), &options).unwrap();
    report.summary
}

#[test]
fn what_is_said_of_many_pairs() {
    insta::assert_snapshot!(told_of(PAIRS));
}

#[test]
fn what_is_said_of_free_pegs() {
    insta::assert_snapshot!(told_of(FREE_PAIRS));
}

/// What is said of pairs, as a text.
fn told_of(pairs: &[Pair]) -> String {
    let (next, told) = (
        AtomicUsize::new(0),
        Mutex::new(vec![Vec::new(); pairs.len()]),
    );
    std::thread::scope(|scope| {
        for _ in 0..2 {
            scope.spawn(|| {
                while let Some(pair) = pairs.get(next.fetch_add(1, Ordering::Relaxed)) {
                    let at = pairs
                        .iter()
                        .position(|other| other.name == pair.name)
                        .unwrap();
                    let sentences = sentences(pair);
                    told.lock().unwrap()[at] = sentences;
                }
            });
        }
    });
    let mut text = String::new();
    for (pair, sentences) in pairs.iter().zip(told.into_inner().unwrap()) {
        writeln!(text, "{}\n  {}\n", pair.name, sentences.join("\n  ")).unwrap();
    }
    text
}

/// The numbers in a sentence without their signs, in rising order.
fn numbers(sentence: &str) -> Vec<String> {
    let words = sentence.split(|c: char| !(c.is_ascii_digit() || c == '.' || c == 'e' || c == '-'));
    let words = words.map(|word| word.trim_matches(['.', 'e', '-']).to_owned());
    let mut numbers: Vec<String> = words.filter(|word| !word.is_empty()).collect();
    numbers.sort();
    numbers
}

/// The sentences that don't name the run whose states they are about.
fn symmetric(report: &Report) -> Vec<&String> {
    let sentences = report.summary.iter();
    sentences
        .filter(|sentence| !sentence.starts_with("At the states that"))
        .collect()
}

fn mirrored(there: &Report, back: &Report) -> Result<(), TestCaseError> {
    let (x, y) = (
        there.happened.as_ref().unwrap(),
        back.happened.as_ref().unwrap(),
    );
    let negative = |value: Option<f64>| value.map(|value| -value);
    prop_assert_eq!(x.averaged_level, y.averaged_level);
    prop_assert_eq!(x.averaged_shift, negative(y.averaged_shift));
    prop_assert_eq!(x.averaged_shift_uncertainty, y.averaged_shift_uncertainty);
    prop_assert_eq!(x.rise_shift, negative(y.rise_shift));
    let turned = y
        .rise_shift_uncertainty
        .map(|[least, greatest]| [-greatest, -least]);
    prop_assert_eq!(x.rise_shift_uncertainty, turned);
    prop_assert_eq!(x.common_budget_a, y.common_budget_b);
    if let (Some(x), Some(y)) = (&there.averaged, &back.averaged) {
        prop_assert_eq!(&x.either_way.means, &y.either_way.means);
        prop_assert_eq!(x.either_way.phase, y.either_way.phase.map(|ahead| -ahead));
    }
    let (x, y) = (symmetric(there), symmetric(back));
    prop_assert_eq!(x.len(), y.len(), "{:?} {:?}", x, y);
    for (x, y) in x.iter().zip(&y) {
        prop_assert_eq!(numbers(x), numbers(y), "{} {}", x, y);
    }
    // Each says of the other what the other says of it.
    for (word, turned) in [
        ("later", "earlier"),
        ("ahead", "behind"),
        ("stronger", "weaker"),
    ] {
        let count = |sentences: &[&String], word: &str| {
            sentences
                .iter()
                .map(|sentence| sentence.matches(word).count())
                .sum::<usize>()
        };
        prop_assert_eq!(count(&x, word), count(&y, turned), "{:?} {:?}", x, y);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 16, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn swapping_two_runs_mirrors_what_is_said(
        preset in 0..4_usize,
        k in 0.0..0.3_f64,
        spin in -200.0..200.0_f64,
        precession in -3.0..3.0_f64,
        duration in 0.2..1.5_f64,
        period in 0..3_usize,
    ) {
        let preset = ["paper", "full-coulomb", "paper-spin-term-only", "lifecycle"][preset];
        let (k, spin, precession, duration) =
            [k, spin, precession, duration].map(|value| format!("{value:?}")).into();
        let a = scenario("paper", &[("stop.duration", "1.0")]);
        let b = scenario(preset, &[
            ("friction.k", &k),
            ("initial.psi_dot", &spin),
            ("initial.phi_dot", &precession),
            ("stop.duration", &duration),
            ("sampling.period", ["0.001", "0.002", "0.0007"][period]),
        ]);
        let options = Options { floor: false, ..Options::default() };
        let [there, back] = [compare(&a, &b, &options), compare(&b, &a, &options)].map(Result::unwrap);
        mirrored(&there, &back)?;
    }
}
