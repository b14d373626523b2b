//! Explaining a run.

mod energies;
mod gaps;
mod statements;
mod story;

use crate::random_scenarios::{Random, free_tops};
use crate::support::{Folder, Run, archive, assert_contains, assert_near, scenario};
use std::f64::consts::FRAC_PI_2;
use std::fs;
use tempfile::tempdir;
use toprise::analysis::explain::{Explanation, Fact, PrecessionRoot, explain, explain_while};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::physics::kinematics::Tilt;
use toprise::physics::math::sin_cos;
use toprise::run::scenario::{PRESETS, Scenario};
use toprise::run::simulation::{EventKind, Sample};
use toprise::telemetry::fields::ACCELERATION;

fn facts(explanation: &Explanation) -> impl Iterator<Item = &Fact> {
    let chapters = explanation.chapters.iter();
    chapters.flat_map(|chapter| &chapter.facts)
}

/// Numbers of a sentence: words that begin with a digit, or with a sign and a digit.
fn numbers(sentence: &str) -> usize {
    let mut count = 0;
    for word in sentence.split(' ') {
        let word = word.trim_start_matches(['−', '(']);
        // `3 × 10⁻⁷` is one number.
        let is_power = word.starts_with("10⁻");
        count += usize::from(!is_power && word.starts_with(|c: char| c.is_ascii_digit()));
    }
    count
}

#[test]
fn explains_presets_in_short_sentences() {
    for preset in PRESETS.iter() {
        let explanation = explain(&scenario(&preset.name, &[])).unwrap();
        assert!(explanation.title.starts_with(&preset.name));
        let sentences: Vec<String> = facts(&explanation)
            .map(|fact| fact.sentence().to_string())
            .collect();
        assert!((4..=14).contains(&sentences.len()), "{sentences:#?}");
        for sentence in sentences {
            assert!(numbers(&sentence) <= 2, "{}: {sentence}", preset.name);
            assert!(sentence.ends_with('.'), "{sentence}");
            assert!(
                !sentence.contains("NaN") && !sentence.contains("inf"),
                "{sentence}"
            );
        }
    }
}

fn energy(sample: &Sample) -> f64 {
    sample.energy.kinetic + sample.energy.potential
}

/// Every number that a fact states, from the simulation itself.
#[track_caller]
fn assert_fact(fact: &Fact, scenario: &Scenario, run: &Run) {
    let (first, last) = (&run.samples[0], run.samples.last().unwrap());
    let end = run.end.time;
    let count = |kind| run.events_of(kind).count() as u64;
    let is_event = |kind, time: f64, theta: f64| {
        let event = run.first(kind);
        assert_eq!(
            (event.time, event.motion.angles.theta),
            (time, theta),
            "{fact:?}"
        );
    };
    match fact {
        Fact::Start { theta, psi_dot } => {
            assert_eq!(*theta, first.angles.theta);
            assert_near("ψ̇", *psi_dot, first.tilt.rates.psi, 1e-12);
        }
        Fact::MeanTheta { first, last } => {
            assert_eq!(*first, run.cycles[0].theta_mean);
            assert_eq!(*last, run.cycles.last().unwrap().theta_mean);
        }
        Fact::ThetaConstant { theta } => {
            assert_near("θ", *theta, run.cycles[0].theta_mean, 1e-5);
        }
        Fact::Loops {
            count: loops,
            first,
        } => {
            assert_eq!(*loops, count(EventKind::LoopingBegins));
            assert_eq!(*first, run.first(EventKind::LoopingBegins).time);
        }
        Fact::Risen { theta, time } => is_event(EventKind::Risen, *time, *theta),
        Fact::Fallen { theta, time } => is_event(EventKind::Fallen, *time, *theta),
        Fact::Inverted { time } => {
            let over = run.samples.iter().find(|s| s.angles.theta >= FRAC_PI_2);
            let over = over.unwrap().time_ns as f64 / 1e9;
            let period = scenario.sample_period_ns as f64 / 1e9;
            assert!((over - period..=over).contains(time), "{time} {over}");
        }
        Fact::NotInverted { time } => {
            assert_eq!(*time, end);
            assert!(run.samples.iter().all(|s| s.angles.theta < FRAC_PI_2));
        }
        Fact::Hops { count: hops, first } if *first > 0.0 => {
            assert_eq!(*hops, count(EventKind::LiftOff));
            assert_eq!(*first, run.first(EventKind::LiftOff).time);
        }
        Fact::Hops { count: hops, .. } => assert_eq!(*hops, 1 + count(EventKind::LiftOff)),
        Fact::Impacts {
            count,
            after_samples,
            lost,
        } => {
            assert_eq!(*count, run.impacts.len() as u64);
            let end = last.time_ns as f64 / 1e9;
            let after = run.impacts.iter().filter(|impact| impact.time > end);
            assert_eq!(*after_samples, after.count() as u64);
            let of_impacts = run.impacts.iter();
            let sum: f64 = of_impacts
                .map(|impact| impact.normal_loss + impact.friction_loss)
                .sum();
            assert_near("impacts", *lost, sum, 1e-12);
        }
        Fact::Rolls { from, theta } => {
            let begins = run.events_of(EventKind::RollBegins).last().unwrap();
            assert_eq!((*from, *theta), (begins.time, begins.motion.angles.theta));
            assert!(run.events_of(EventKind::RollEnds).all(|e| e.time < *from));
        }
        Fact::Energy {
            first: a,
            last: b,
            time,
            ..
        } => {
            assert_eq!(*time, last.time_ns as f64 / 1e9);
            assert_near("energy", *a, energy(first), 1e-12);
            assert_near("energy", *b, energy(last), 1e-12);
        }
        Fact::EnergyConstant {
            energy: e,
            deviation,
        } => {
            assert_near("energy", *e, energy(first), 1e-12);
            assert!((energy(last) - e).abs() <= *deviation);
        }
        // In the air nothing slips.
        Fact::SlipPath { length } if run.impacts.is_empty() => {
            // By the trapezoidal rule. Its error is h²/12 of the change of the acceleration of the slip.
            let speed = |s: &Sample| s.contact.slip.norm();
            let pairs = run.samples.windows(2);
            let period = scenario.sample_period_ns as f64 / 1e9;
            let length_of = |p: &[Sample]| 0.5 * period * (speed(&p[0]) + speed(&p[1]));
            let expected: f64 = pairs.map(length_of).sum();
            assert_near("slip path", *length, expected, 1e-3 * expected);
        }
        Fact::VerticalMomentum { deviation, .. } => {
            let momenta = run.samples.iter().map(|s| s.momentum.vertical);
            let at_first = first.momentum.vertical;
            let largest = momenta
                .map(|m| (m / at_first - 1.0).abs())
                .fold(0.0, f64::max);
            assert_near("L_z′", *deviation, largest, 1e-15 + 1e-9 * largest);
        }
        _ => {}
    }
}

#[test]
fn val_facts_match_the_simulation() {
    for preset in PRESETS.iter() {
        let scenario = scenario(&preset.name, &[]);
        let run = Run::of(&scenario);
        for fact in facts(&explain(&scenario).unwrap()) {
            assert_fact(fact, &scenario, &run);
        }
    }
    for scenario in free_tops(Random(23)).take(10) {
        let run = Run::of(&scenario);
        let Ok(explanation) = explain(&scenario) else {
            continue;
        };
        for fact in facts(&explanation) {
            let is_counted = matches!(
                fact,
                Fact::Hops { .. } | Fact::Rolls { .. } | Fact::Energy { .. }
            );
            if is_counted {
                assert_fact(fact, &scenario, &run);
            }
        }
    }
}

/// The paper's argument, from the cycles and samples of the run.
#[test]
fn val_friction_drives_the_precession() {
    for name in ["paper", "full-coulomb", "viscous"] {
        let scenario = scenario(name, &[]);
        let (run, explanation) = (Run::of(&scenario), explain(&scenario).unwrap());
        let top = &scenario.model.top;
        let mut found = 0;
        for fact in facts(&explanation) {
            match fact {
                Fact::FollowsRoot { root, within } => {
                    assert_eq!(*root, PrecessionRoot::Slow);
                    let distance = run.cycles.iter().map(|cycle| {
                        let tilt = Tilt::from_rates(cycle.theta_mean, cycle.mean_rates);
                        let slow = top.precession_roots(&tilt).unwrap().slow;
                        (cycle.mean_rates.phi - slow).abs()
                    });
                    assert_near(name, *within, distance.fold(0.0, f64::max), 1e-12);
                }
                Fact::FrictionOnPrecession { friction, change } => {
                    let [first, last] =
                        [run.samples.first(), run.samples.last()].map(Option::unwrap);
                    assert_eq!(*change, last.tilt.rates.phi - first.tilt.rates.phi);
                    // By the trapezoidal rule, where a nutation has 40 samples.
                    let terms = run.samples.iter().map(|s| s.accelerations.frictional.phi);
                    let ends =
                        first.accelerations.frictional.phi + last.accelerations.frictional.phi;
                    let sum = 1e-3 * (terms.sum::<f64>() - 0.5 * ends);
                    assert_near(name, *friction, sum, 1e-3 * sum);
                }
                Fact::TermsCancel { demanded, mean } => {
                    // θ̈'s and φ̈'s gyroscopic and Coriolis terms at the mean motion.
                    let (mut answer, mut drift, mut time) = (0.0, 0.0, 0.0);
                    for cycle in &run.cycles {
                        let rates = cycle.mean_rates;
                        let (sin, cos) = sin_cos(cycle.theta_mean);
                        let spin = rates.psi + rates.phi * cos;
                        let gyroscopic = top.axial_moment * spin / top.transverse_moment;
                        let per_rate = (gyroscopic - 2.0 * rates.phi * cos) / sin;
                        answer -= cycle.period() * cycle.mean_phi_frictional / per_rate;
                        drift += cycle.period() * rates.theta;
                        time += cycle.period();
                    }
                    assert_near(name, *demanded, answer / time, 1e-9);
                    assert_near(name, *mean, drift / time, 1e-9);
                    // And they are the same within the ripple of the averages.
                    assert_near(name, *demanded, *mean, 0.01 * mean.abs());
                }
                _ => continue,
            }
            found += 1;
        }
        assert_eq!(found, 3, "{name}");
    }
}

#[test]
fn reports_conserved_quantities() {
    let constants = |name: &str| {
        let explanation = explain(&scenario(name, &[])).unwrap();
        facts(&explanation)
            .filter_map(|fact| match fact {
                Fact::VerticalMomentum { is_constant, .. } | Fact::Jellett { is_constant, .. } => {
                    Some(*is_constant)
                }
                Fact::EnergyConstant { .. } | Fact::ThetaConstant { .. } => Some(true),
                _ => None,
            })
            .collect::<Vec<_>>()
    };
    assert_eq!(constants("frictionless"), [true; 3]);
    assert_eq!(constants("paper"), [true]);
    assert_eq!(constants("tilt-torque-only"), [false]);
    assert_eq!(constants("tippe-top"), [true]);
}

/// A quantity that friction changes by more than rounding is not reported constant: with loose tolerances, in a small
/// top, after an interruption of the nutation.
#[test]
fn changing_quantities_are_not_reported_constant() {
    let short = ("stop.duration", "5");
    let loose = |tolerance| {
        [
            short,
            ("integrator.relative_tolerance", tolerance),
            ("integrator.absolute_tolerance", tolerance),
        ]
    };
    let small = [
        short,
        ("top.mass", "1e-9"),
        ("top.transverse_moment", "8.52e-13"),
        ("top.axial_moment", "7.25e-13"),
    ];
    let coarse = [("sampling.period", "0.01")];
    let cases: [(&str, &[(&str, &str)]); 4] = [
        ("paper", &loose("1e-3")),
        ("paper-precession-term-only", &loose("1e-2")),
        ("paper", &small),
        ("paper-spin-term-only", &coarse),
    ];
    for (name, keys) in cases {
        let scenario = scenario(name, keys);
        let (run, explanation) = (Run::of(&scenario), explain(&scenario).unwrap());
        for fact in facts(&explanation) {
            assert_fact(fact, &scenario, &run);
            let is_constant = match fact {
                Fact::EnergyConstant { .. } | Fact::ThetaConstant { .. } => true,
                Fact::NoFrictionOnPrecession => name != "paper-spin-term-only",
                _ => false,
            };
            assert!(!is_constant, "{name} {keys:?}: {fact:?}");
        }
        let cycles = run.cycles.len() as u64;
        assert_eq!(explanation.summary.nutations, Some(cycles), "{name}");
        let counted: u64 = explanation.stages.iter().map(|stage| stage.nutations).sum();
        assert_eq!(counted, cycles, "{name}");
    }
}

/// The peg of a dropped top starts in the air, and that it hits the table takes energy that friction does not.
#[test]
fn drop_is_one_hop_with_impacts() {
    let explanation = explain(&scenario("drop", &[])).unwrap();
    let sentences: Vec<String> = facts(&explanation)
        .map(|fact| fact.sentence().to_string())
        .collect();
    for sentence in [
        "The peg flew once, from 0.0000 s (bounces do not end a flight).",
        "The peg hit the table 21 times; the impacts dissipated 0.01049 J.",
    ] {
        assert!(sentences.contains(&sentence.to_owned()), "{sentences:#?}");
    }
    let balance = sentences.iter().find(|s| s.contains("equals this change"));
    let is_of_both = balance
        .unwrap()
        .starts_with("The work of friction and impacts");
    assert!(is_of_both, "{balance:?}");
}

/// An impact after the last sample is reported with its energy loss; the energies include samples only.
#[test]
fn counts_impacts_after_the_last_sample() {
    let scenario = scenario("drop", &[("stop.duration", "0.0318")]);
    let explanation = explain(&scenario).unwrap();
    let run = Run::of(&scenario);
    assert!(run.impacts[0].time > run.samples.last().unwrap().time_ns as f64 / 1e9);
    let impacts: Vec<_> = facts(&explanation)
        .filter(|fact| matches!(fact, Fact::Impacts { lost, .. } if *lost > 1e-3))
        .collect();
    assert_eq!(impacts.len(), 1);
    assert_fact(impacts[0], &scenario, &run);
    let constant = facts(&explanation).find(|fact| matches!(fact, Fact::EnergyConstant { .. }));
    assert!(
        constant
            .unwrap()
            .sentence()
            .to_string()
            .contains("in all samples")
    );
}

/// Nothing is said of a rate that is known only in a part of the run, as near the vertical.
#[test]
fn omits_rates_known_for_a_part_of_the_run() {
    let explanation = explain(&scenario("lifecycle", &[])).unwrap();
    let follows = facts(&explanation).any(|fact| matches!(fact, Fact::FollowsRoot { .. }));
    assert!(!follows);
}

#[test]
fn explains_recordings_like_scenarios() {
    let directory = tempdir().unwrap();
    for name in ["paper", "free-paper"] {
        let path = directory.path().join(format!("{name}.mcap"));
        let scenario = scenario(name, &[("stop.duration", "4.0")]);
        archive(&path, &scenario, &[], Form::default()).unwrap();
        let recording = Recording::open(&path).unwrap();
        assert_eq!(explain(&recording).unwrap(), explain(&scenario).unwrap());
        // What is there of one that was cut off.
        let bytes = fs::read(&path).unwrap();
        let cut = directory.path().join("cut.mcap");
        fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
        let explanation = explain(&Recording::open(&cut).unwrap()).unwrap();
        assert_contains(&explanation.title, "recorded until");
        assert!(!explanation.losses.is_empty());
    }
}

#[test]
fn rejects_foreign_and_incomplete_recordings() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let scenario = scenario("paper", &[("stop.duration", "0.1")]);
    archive(&path, &scenario, &["/top/state"], Form::default()).unwrap();
    let error = explain(&Recording::open(&path).unwrap()).unwrap_err();
    let missing = ACCELERATION;
    let error = error.to_string();
    assert!(
        error.starts_with(&format!("it has no {missing}")),
        "{error}"
    );
    let file = fs::File::create(directory.path().join("b.mcap")).unwrap();
    mcap::Writer::new(std::io::BufWriter::new(file))
        .unwrap()
        .finish()
        .unwrap();
    let foreign = Recording::open(&directory.path().join("b.mcap")).unwrap();
    let error = explain(&foreign).unwrap_err().to_string();
    assert_eq!(error, "not a toprise recording");
}

#[test]
fn explanation_can_be_interrupted() {
    let asked = std::cell::Cell::new(0);
    let carry_on = || {
        asked.set(asked.get() + 1);
        asked.get() < 100
    };
    // A run of an hour, which takes minutes.
    let scenario = scenario("frictionless", &[("stop.duration", "3600")]);
    let explanation = explain_while(&scenario, &carry_on);
    assert_eq!(explanation.unwrap_err().to_string(), "interrupted");
    assert_eq!(asked.get(), 101);
}

#[test]
fn all_option_adds_the_averaged_motion() {
    let page = |more: &str| {
        let line = format!("explain paper --color never {more}");
        Folder::new().toprise(&line, 0).stdout
    };
    let (short, all) = (page(""), page("--all"));
    assert!(!short.contains("Nutations"), "{short}");
    assert_contains(&all, "Nutations");
    assert_contains(&all, "slow rate");
}

/// A rolling peg precesses at another rate than one that slides; in a stage with both, or in the air, none is reported.
#[test]
fn val_slow_rate_depends_on_the_phase_of_the_peg() {
    let scenario = scenario("drop", &[]);
    let run = Run::of(&scenario);
    let rolls = run.events_of(EventKind::RollBegins).last().unwrap().time;
    let explanation = explain(&scenario).unwrap();
    let (rolling, others): (Vec<_>, Vec<_>) = explanation
        .stages
        .iter()
        .partition(|stage| stage.from >= rolls);
    assert!(rolling.len() > 1 && !others.is_empty());
    for stage in rolling {
        // Rolling without losses is regular precession, up to the square of its small nutation.
        assert_near("slow rate", stage.slow_root.unwrap(), stage.phi_dot, 1e-4);
    }
    assert!(others[0].slow_root.is_none(), "{others:#?}");
}

/// The integral of a top at rest is rounding, and the two rates of a large nutation don't cancel.
#[test]
fn omits_unknown_facts() {
    let at_rest = [
        ("initial.psi_dot", "0"),
        ("initial.phi_dot", "0"),
        ("initial.theta", "0.3"),
        ("stop.duration", "3"),
        ("sampling.period", "0.002"),
    ];
    let large = [
        ("friction.law", "coulomb-sqrt"),
        ("friction.k", "0.01784"),
        ("friction.smoothing_speed", "0.00139"),
        ("initial.theta", "0.03"),
        ("initial.phi_dot", "-200"),
        ("initial.psi_dot", "226.9"),
        ("stop.duration", "8"),
    ];
    let is_false = |fact: &Fact| matches!(fact, Fact::Jellett { .. } | Fact::TermsCancel { .. });
    for (name, keys) in [("free-paper", &at_rest[..]), ("full-coulomb", &large)] {
        let explanation = explain(&scenario(name, keys)).unwrap();
        let found = facts(&explanation).find(|fact| is_false(fact));
        assert_eq!(found, None, "{name}");
    }
}

/// Impacts of a recording without their channel are not known; there may have been some.
#[test]
fn unrecorded_impacts_are_unknown() {
    let folder = Folder::new();
    let drop = scenario("drop", &[]);
    let topics = [
        "/top/state",
        "/top/acceleration",
        "/top/energy",
        "/events",
        "/top/free_peg",
    ];
    archive(&folder.at("drop.mcap"), &drop, &topics, Form::default()).unwrap();
    let explanation = explain(&Recording::open(&folder.at("drop.mcap")).unwrap()).unwrap();
    let peg = explanation.summary.peg.as_ref().unwrap();
    assert_eq!((peg.impacts, peg.impact_loss), (None, None));
    let has_impacts = |fact: &Fact| {
        matches!(
            fact,
            Fact::Balance {
                has_impacts: true,
                ..
            }
        )
    };
    assert!(facts(&explanation).any(has_impacts));
}
