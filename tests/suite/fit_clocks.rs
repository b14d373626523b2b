//! `toprise fit` with clocks of several files.

use crate::fit::{THETA_PHI, data, data_set, measure, preset};
use toprise::fit::report::{Estimate, Report};
use toprise::fit::{Data, FileReading, Request, Signal, Verdict, fit};
use toprise::telemetry::fields::{pose, state};

/// Adds the signals of a further file, whose clock shows `early` s less.
fn add_file(all: &mut Data, mut file: Data, early: f64) {
    for signal in &mut file.signals {
        signal.file = all.files.len();
        for time in &mut signal.times {
            *time -= early;
        }
    }
    all.signals.extend(file.signals);
    all.files.push(FileReading::default());
}

/// The estimate of the second file's offset.
fn offset(report: &Report) -> &Estimate {
    let mut parameters = report.parameters.iter();
    parameters.find(|p| p.name == "offset").unwrap()
}

#[test]
fn offsets_are_as_exact_for_clocks_that_differ_by_much() {
    let (_, scenario) = data_set("offset");
    let files = ["offset_camera.csv", "offset_gyro.csv"];
    let signals = ["theta:1.5mrad", "phi:1.5mrad", "omega_n:0.05"];
    let mut same_clock: Option<(f64, f64)> = None;
    for (name, shift) in [
        ("the same clock", 0.0),
        ("17 minutes", -1000.0),
        ("a day", 86_400.0),
        ("one since 1970", 1_764_158_407.25),
    ] {
        let mut data = data(&files, &signals);
        for signal in data.signals.iter_mut().filter(|signal| signal.file == 1) {
            for time in &mut signal.times {
                *time += shift;
            }
        }
        let request = Request::new(scenario.clone(), data, &["friction.k", "initial", "offset"]);
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.verdict, Verdict::Fitted, "{name}");
        let offset = report.parameters.iter().find(|p| p.name == "offset");
        let offset = offset.unwrap();
        let (value, sd) = (offset.value + shift, offset.sd.unwrap());
        let (known, known_sd) = *same_clock.get_or_insert((value, sd));
        // Times since 1970 are rounded to 0.24 µs, which is 0.6 % of the standard deviation.
        assert!((value - known).abs() < 0.01 * known_sd, "{name}: {value}");
        assert!((sd / known_sd - 1.0).abs() < 1e-3, "{name}: {sd}");
    }
}

#[test]
#[ignore = "takes minutes"]
fn minima_of_an_offset_are_compared_over_the_same_points() {
    // Of 3 s of θ̇ with this noise, a shift by one nutation, 44 ms, is excluded or not, as the noise has it.
    const EARLY: f64 = 0.4;
    let truth = preset("full-coulomb")
        .with([
            ("initial.phi_dot", 1.9.into()),
            ("initial.theta_dot", 0.03.into()),
        ])
        .unwrap();
    let mut ambiguous = 0;
    for seed in 0..5 {
        let mut both = measure(&truth, 100.0, 3.0, &THETA_PHI, Some(seed));
        let rates = measure(
            &truth,
            100.0,
            3.0,
            &[(state::THETA_DOT, 0.03)],
            Some(100 + seed),
        );
        add_file(&mut both, rates, EARLY);
        let request = Request::new(truth.clone(), both, &["friction.k", "initial", "offset"]);
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.verdict, Verdict::Fitted, "{seed}");
        let at = report.parameters.iter().position(|p| p.name == "offset");
        let mut near = vec![(offset(&report).value, offset(&report).sd.unwrap())];
        for mode in &report.modes {
            assert!(mode.delta_chi2 >= 0.0, "{seed}: {}", mode.delta_chi2);
            near.push((mode.values[at.unwrap()], mode.sds[at.unwrap()]));
        }
        ambiguous += usize::from(near.len() > 1);
        // Of 5 normal numbers one above 4 is unlikely: p = 3e-4.
        let is_found = near
            .iter()
            .any(|(value, sd)| (value - EARLY).abs() < 4.0 * sd);
        assert!(is_found, "{seed}: {near:?}");
    }
    assert!(ambiguous > 0);
}

#[test]
fn other_minima_of_a_preferred_law_are_not_its_own() {
    let truth = preset("full-coulomb");
    let viscous = truth
        .with([
            ("friction.law", "viscous".into()),
            ("friction.viscous_speed", 0.5.into()),
        ])
        .unwrap();
    let mut listed = 0;
    for seed in 0..3 {
        let mut both = measure(&truth, 100.0, 3.0, &THETA_PHI, Some(seed));
        let noisy = [(state::THETA_DOT, 0.03)];
        add_file(
            &mut both,
            measure(&truth, 100.0, 3.0, &noisy, Some(100 + seed)),
            0.4,
        );
        let mut request = Request::new(viscous.clone(), both, &["friction.k", "initial", "offset"]);
        request.compare = vec!["coulomb".to_owned()];
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.law, "coulomb", "{seed}");
        let at = report.parameters.iter().position(|p| p.name == "offset");
        let own = offset(&report);
        for mode in &report.modes {
            let distance = (mode.values[at.unwrap()] - own.value).abs();
            // The next minimum is a nutation away, some hundred standard deviations.
            assert!(distance > 10.0 * own.sd.unwrap(), "{seed}: {distance}");
        }
        listed += report.modes.len();
    }
    assert!(listed > 0);
}

#[test]
fn clocks_of_files_that_are_much_longer_than_the_motion_are_found() {
    let truth = preset("full-coulomb");
    let mut both = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(1));
    let mut rate = measure(&truth, 100.0, 2.0, &[(pose::OMEGA_BODY.z(), 0.05)], Some(2));
    // The sensor lies still for 30 s before and 40 s after the motion.
    let signal = &mut rate.signals[0];
    let still = |from: usize, to: usize| (from..to).map(|i| i as f64 / 100.0);
    let times: Vec<f64> = still(0, 3000)
        .chain(signal.times.iter().map(|time| time + 30.0))
        .chain(still(3201, 7200))
        .collect();
    let mut values = vec![0.0; 3000];
    values.extend(&signal.values);
    values.resize(times.len(), 0.0);
    *signal = Signal::from_values(signal.field, &times, &values, Some(0.05)).unwrap();
    add_file(&mut both, rate, 0.0);
    let request = Request::new(truth, both, &["friction.k", "initial", "offset"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::Fitted);
    let found = offset(&report);
    assert!(
        (found.value + 30.0).abs() < 4.0 * found.sd.unwrap(),
        "{found:?}"
    );
}

#[test]
fn turns_of_an_angle_follow_the_offset() {
    // The second camera starts when the first one has seen φ turn once, and counts from the same zero.
    let truth = preset("full-coulomb");
    let mut both = measure(&truth, 100.0, 4.0, &THETA_PHI, Some(1));
    let mut later = measure(&truth, 100.0, 4.0, &[(state::PHI, 1e-3)], Some(2));
    let signal = &later.signals[0];
    let first = signal.times.partition_point(|time| *time < 2.5);
    let (times, values) = (&signal.times[first..], &signal.values[first..]);
    assert!(values[0] > std::f64::consts::PI);
    later.signals[0] = Signal::from_values(state::PHI, times, values, Some(1e-3)).unwrap();
    add_file(&mut both, later, 7.5);
    let request = Request::new(truth, both, &["friction.k", "initial", "offset"]);
    let fitted = fit(&request, &|_| {}).unwrap();
    let report = &fitted.report;
    assert_eq!(report.verdict, Verdict::Fitted, "{report:#?}");
    let found = offset(report);
    assert!(
        (found.value - 7.5).abs() < 4.0 * found.sd.unwrap(),
        "{found:?}"
    );
}

#[test]
fn refuses_offsets_that_leave_a_file_outside_the_motion() {
    let truth = preset("full-coulomb");
    for (name, rate, bounds, expected) in [
        (
            "bounds",
            100.0,
            Some([5.0, 6.0]),
            "offset: no offset from 5 to 6 s brings its file into the motion (0 to 2 s), but those from −1 to 1 s do: change its bounds",
        ),
        (
            "milliseconds taken for seconds",
            0.1,
            None,
            "offset: at most 1 of the 201 samples of its file are within the motion (0 to 2 s) at once; are the times of both files in the unit that is stated, or else in s?",
        ),
    ] {
        let mut both = measure(&truth, 100.0, 2.0, &THETA_PHI, None);
        let mut rates = measure(&truth, 100.0, 2.0, &[(pose::OMEGA_BODY.z(), 0.05)], None);
        for time in &mut rates.signals[0].times {
            *time *= 100.0 / rate;
        }
        add_file(&mut both, rates, 0.0);
        let mut request = Request::new(truth.clone(), both, &["friction.k", "initial", "offset"]);
        request
            .bounds
            .extend(bounds.map(|bounds| ("offset".to_owned(), bounds)));
        let error = fit(&request, &|_| {}).unwrap_err();
        assert_eq!(error.to_string(), expected, "{name}");
    }
}

#[test]
fn refuses_offsets_of_missing_files() {
    let truth = preset("full-coulomb");
    let mut both = measure(&truth, 100.0, 0.5, &THETA_PHI, None);
    add_file(
        &mut both,
        measure(&truth, 100.0, 0.5, &THETA_PHI, None),
        0.0,
    );
    let request = Request::new(truth, both, &["friction.k", "offset", "offset.3"]);
    let error = fit(&request, &|_| {}).unwrap_err().to_string();
    assert!(
        error.starts_with("offset.3 can't be fitted: there is no file"),
        "{error}"
    );
}

#[test]
fn points_of_all_files_are_held_out() {
    let truth = preset("full-coulomb");
    let mut both = measure(&truth, 100.0, 2.0, &THETA_PHI, Some(3));
    let rate = measure(&truth, 100.0, 2.0, &[(pose::OMEGA_BODY.z(), 0.05)], Some(4));
    add_file(&mut both, rate, 0.25);
    let mut request = Request::new(truth, both, &["friction.k", "initial", "offset"]);
    request.holdout = 0.25;
    let report = fit(&request, &|_| {}).unwrap().report;
    let mut samples = Vec::new();
    for signal in &report.signals {
        samples.push((signal.samples, signal.held_out_samples, signal.outside));
    }
    // The first sample of the second file is less than a step of the scan after the start.
    assert_eq!(samples, [(151, 50, 0), (151, 50, 0), (150, 50, 1)]);
}
