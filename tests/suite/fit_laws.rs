//! Comparisons of friction laws.

use crate::fit::{THETA_PHI, data, data_set, measure, preset};
use toprise::fit::{Failure, Request, Signal, Verdict, fit};

/// Compared laws as a request has them.
fn laws(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

#[test]
fn laws_have_their_own_estimated_deviations() {
    let truth = preset("full-coulomb");
    let mut data = measure(&truth, 100.0, 5.0, &THETA_PHI, Some(3));
    for signal in &mut data.signals {
        *signal = Signal::from_values(signal.field, &signal.times, &signal.values, None).unwrap();
    }
    let mut differences = Vec::new();
    // 2 m/s is the mean slip speed: viscous friction is then about as large as Coulomb's.
    let viscous = [
        ("friction.law", "viscous".into()),
        ("friction.viscous_speed", 2.0.into()),
    ];
    for scenario in [truth.clone(), truth.with(viscous).unwrap()] {
        let mut request = Request::new(scenario, data.clone(), &["friction.k", "initial"]);
        request.compare = laws(&["coulomb", "viscous"]);
        let report = fit(&request, &|_| {}).unwrap().report;
        assert_eq!(report.law, "coulomb");
        let comparison = report.comparison.unwrap();
        let [coulomb, viscous] = &comparison.laws[..] else {
            panic!("{comparison:?}");
        };
        assert_eq!(
            (coulomb.law.as_str(), viscous.law.as_str()),
            ("coulomb", "viscous")
        );
        // The likelihood's maximum over σ is that of n ln σ, and both laws have as many parameters. σ is estimated to
        // 1e-3, so n ln σ to n · 1e-3 at most; it converges to the square of that.
        let mut expected = 0.0;
        for (signal, (a, b)) in
            (report.signals.iter()).zip(coulomb.sigmas.iter().zip(&viscous.sigmas))
        {
            expected += 2.0 * signal.samples as f64 * libm::log(b / a);
        }
        let delta_aic = viscous.delta_aic.unwrap();
        assert!((delta_aic - expected).abs() < 0.5, "{delta_aic} {expected}");
        differences.push(delta_aic);
    }
    let [from_coulomb, from_viscous] = differences[..] else {
        panic!("{differences:?}");
    };
    assert!((from_coulomb - from_viscous).abs() < 0.5, "{differences:?}");
}

#[test]
fn skips_only_laws_that_end_early() {
    let data = measure(&preset("frictionless"), 100.0, 5.0, &THETA_PHI, Some(1));
    // With k = 0.3 the top rises in 2.5 s.
    let start = preset("full-coulomb")
        .with([("friction.k", 0.5.into())])
        .unwrap();
    let mut request = Request::new(start, data, &["friction.k", "initial"]);
    request.bounds = vec![("friction.k".to_owned(), [0.3, 1.0])];
    request.compare = laws(&["coulomb", "none"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(
        (report.verdict, report.law.as_str()),
        (Verdict::Fitted, "none")
    );
    let comparison = report.comparison.unwrap();
    let coulomb = comparison.laws.iter().find(|law| law.law == "coulomb");
    let failure = coulomb.unwrap().failure.as_ref().unwrap();
    assert!(matches!(failure, Failure::Apart(_)), "{failure:?}");
}

#[test]
fn files_with_other_clocks_are_held_out() {
    let (_, scenario) = data_set("offset");
    let files = ["offset_camera.csv", "offset_gyro.csv"];
    let signals = ["theta:1.5mrad", "phi:1.5mrad", "omega_n:0.05"];
    let mut request = Request::new(
        scenario,
        data(&files, &signals),
        &["friction.k", "initial", "offset"],
    );
    request.holdout = 0.2;
    let report = fit(&request, &|_| {}).unwrap().report;
    let gyroscope = report
        .signals
        .iter()
        .find(|signal| signal.file == 2)
        .unwrap();
    assert!(gyroscope.held_out_samples > 100, "{gyroscope:?}");
    // Predicted to the noise; the mean of these squares is 1 to 20 %, and the prediction adds to it.
    let rms = gyroscope.held_out_rms.unwrap();
    assert!((0.8..1.5).contains(&rms), "{rms}");
}

#[test]
fn says_that_a_law_reduces_to_the_one_inside_it() {
    let truth = preset("full-coulomb");
    let data = measure(&truth, 100.0, 3.0, &THETA_PHI, Some(3));
    let mut request = Request::new(truth, data, &["friction.k", "initial"]);
    request.compare = laws(&["coulomb", "coulomb-sqrt"]);
    let report = fit(&request, &|_| {}).unwrap().report;
    assert_eq!(report.verdict, Verdict::Fitted);
    let comparison = report.comparison.as_ref().unwrap();
    let nested = comparison.laws.iter().find(|law| law.law == "coulomb-sqrt");
    assert_eq!(nested.unwrap().reduces_to.as_deref(), Some("coulomb"));
    assert_eq!(nested.unwrap().verdict, Verdict::Fitted);
}
