//! How far motions agree that are different as a whole.

use super::{only, quick, short};
use crate::support::scenario;
use toprise::analysis::diff::{
    Agreement, Change, EndCondition, Options, Precision, RunEnd, Verdict, compare,
};
use toprise::run::simulation::StopReason;

/// Overrides of one run.
type Overrides<'a> = &'a [(&'a str, &'a str)];

fn agreement(
    preset: &str,
    a: Overrides<'_>,
    b: Overrides<'_>,
    options: &Options,
) -> Option<Agreement> {
    let [a, b] = [a, b].map(|overrides| scenario(preset, overrides));
    let report = compare(&a, &b, options).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    report.agreement
}

fn ends_at(time: f64) -> RunEnd {
    RunEnd {
        time,
        condition: Some(EndCondition {
            reason: StopReason::Duration,
            limit: Some(time),
        }),
    }
}

#[test]
fn shorter_copies_agree_as_long_as_both_run() {
    for preset in ["paper", "tippe-top", "full-coulomb"] {
        let (long, short) = ([("stop.duration", "0.3")], [("stop.duration", "0.2")]);
        let expected = |ends| {
            Some(Agreement::WhileBothRun {
                samples: 201,
                precision: Precision::Exact,
                ends: Some(ends),
            })
        };
        let found = agreement(preset, &long, &short, &quick());
        assert_eq!(found, expected([ends_at(0.3), ends_at(0.2)]), "{preset}");
        assert_eq!(
            found.unwrap().sentence().to_string(),
            "As long as both run, the motions agree: 201 samples are identical, bit for bit. B ends first, at 0.2000 s, \
             at the time limit; A ends at 0.3000 s, at the time limit."
        );
        let found = agreement(preset, &short, &long, &quick());
        assert_eq!(found, expected([ends_at(0.2), ends_at(0.3)]), "{preset}");
    }
}

/// A run that ends between two samples has a last sample that the other lacks.
#[test]
fn shorter_copy_may_end_between_samples() {
    let (long, short) = ([("stop.duration", "1")], [("stop.theta_risen", "0.49")]);
    let found = agreement("paper", &long, &short, &quick()).unwrap();
    let Agreement::WhileBothRun {
        precision: Precision::Exact,
        ends: Some([_, end]),
        samples,
    } = found
    else {
        panic!("{found:?}");
    };
    assert!(
        end.time < 1.0 && (1e3 * end.time).fract() != 0.0,
        "{found:?}"
    );
    assert_eq!(samples, (1e3 * end.time).ceil() as u64);
    assert!(
        found
            .sentence()
            .to_string()
            .contains("s, risen to 0.490 rad; A ends at 1.0000 s"),
        "{found:?}"
    );
}

#[test]
fn other_tolerances_agree_within_the_integration_error() {
    let other = [
        ("stop.duration", "1"),
        ("integrator.relative_tolerance", "1e-9"),
    ];
    let found = agreement("paper", &other[..1], &other, &Options::default()).unwrap();
    let Agreement::WhileBothRun {
        samples: 1001,
        precision: Precision::IntegrationError { theta },
        ends: None,
    } = found
    else {
        panic!("{found:?}");
    };
    assert!(theta > 0.0 && theta < 1e-8, "{theta}");
    // Without an estimate nothing shows that they agree.
    assert_eq!(agreement("paper", &other[..1], &other, &quick()), None);
}

#[test]
fn other_restitution_parts_the_motions_at_an_impact() {
    let other = [("stop.duration", "0.1"), ("support.restitution", "0.3")];
    let found = agreement("drop", &other[..1], &other, &quick()).unwrap();
    let Agreement::Until {
        time,
        change: Some(Change::Impact),
    } = found
    else {
        panic!("{found:?}");
    };
    // The peg falls 5 mm, and the nutation moves it by less.
    let fall = (2.0 * 0.005 / 9.81_f64).sqrt();
    assert!((0.9 * fall..1.1 * fall).contains(&time), "{time}");
}

#[test]
fn other_forces_part_the_motions_at_once() {
    let found = agreement(
        "paper",
        &[("stop.duration", "0.3")],
        &[("stop.duration", "0.2"), ("friction.k", "0.031")],
        &Options::default(),
    );
    assert_eq!(found, None);
}

/// What was left out may differ.
#[test]
fn partial_runs_have_no_agreement() {
    let (a, b) = (short(&[]), short(&[("stop.duration", "1")]));
    assert_eq!(
        compare(&a, &b, &only("/top/state")).unwrap().agreement,
        None
    );
}
