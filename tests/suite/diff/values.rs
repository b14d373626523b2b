//! Comparisons against numbers that were computed without this project.

use super::*;
use toprise::analysis::diff::Dependence;

fn number(value: &Value) -> f64 {
    let number = value.as_f64();
    number.unwrap_or_else(|| panic!("{value} is no number"))
}

/// The integrator's error in φ̇ and ψ̇ reaches 1e-7 rad/s where θ is 0.02 rad: 1e-12 of the tolerance times the
/// number of steps, divided by sin θ. That of θ and θ̇ is a hundred times smaller, accelerations have ω ≈ 140/s
/// more.
const RATE_ERROR: f64 = 2e-7;

/// The difference with the largest magnitude: its sign is checked unless another of that size has the other one.
#[track_caller]
fn assert_largest(what: &str, largest: f64, truth: &Value, tolerance: f64) {
    assert_near(what, largest.abs(), number(&truth["max_abs"]), tolerance);
    if number(&truth["gap"]) > tolerance {
        let signed = number(&truth["signed"]);
        assert_eq!(largest < 0.0, signed < 0.0, "{what}: sign");
    }
}

fn val_pair(pair: &str, run_b: &str, b: &Scenario) {
    let text = fs::read_to_string(data("two_runs.json")).unwrap();
    let truth = &serde_json::from_str::<Value>(&text).unwrap()["values"];
    let report = compare(&scenario("paper", &[]), b, &Options::default()).unwrap();
    let (runs, expected) = (&truth["runs"], &truth["pairs"][pair]);
    val_findings(&report, [&runs["A"], &runs[run_b]], expected);
    val_averaged(&report, expected);
    val_signals(&report, &expected["signals"]);
    val_discrepancy(&report, &expected["discrepancy"]);
    val_integration_errors(&report);
}

fn val_findings(report: &Report, runs: [&Value; 2], expected: &Value) {
    for (at, run) in runs.into_iter().enumerate() {
        let of = |what| values(report, what)[at];
        // The rise's own error is 1e-10 s (tests/suite/reference.rs).
        let rise = number(&run["rise"]["time"]);
        // The end is the first crossing of the level: one fact, one row.
        let what = "ends (risen to 0.0200 rad)";
        assert_near(what, of(what).unwrap(), rise, 1e-9);
        assert!(finding(report, "θ first reaches").is_none());
        let first = run["events"]["looping_begins"].as_f64();
        assert_eq!(of("first loop").is_some(), first.is_some());
        if let Some(first) = first {
            assert_near("loops", of("first loop").unwrap(), first, 1e-8);
        }
        let summary = [&report.a, &report.b][at].summary.as_ref().unwrap();
        assert_eq!(summary.nutations, run["nutation"]["cycles"].as_u64());
        let work = &run["energy"]["friction_work_at_last_sample"];
        let work: f64 = ["e_N", "e_2", "n"]
            .iter()
            .map(|axis| number(&work[*axis]))
            .sum();
        let slipped = number(&run["energy"]["slip_path"]);
        // The last sample is up to a period before the end, at 0.5 m/s.
        assert_near("slip", summary.slip_path.unwrap(), slipped, 1e-3);
        let is_first = rise <= number(&runs[1 - at]["rise"]["time"]);
        if is_first {
            assert_near("energy", of("energy lost").unwrap(), -work, 1e-9);
        }
    }
    let end = finding(report, "ends (risen").unwrap();
    let [Dependence::Nutation { change }] = end.dependences[..] else {
        panic!("{end:?}");
    };
    assert!(
        change > 1e-3 && end.integration_error < Some(1e-8),
        "{end:?}"
    );
    assert_near(
        "shift",
        end.difference.unwrap(),
        number(&expected["rise_shift"]),
        2e-9,
    );
    // B's averaged θ is lower at the end of the comparison in either pair: B is ahead.
    let crossing = finding(report, "mean θ crosses").unwrap();
    assert!(crossing.difference.unwrap() < 0.0, "{crossing:?}");
    assert!(crossing.integration_error < Some(1e-8), "{crossing:?}");
    let torque = finding(report, "friction torques at").unwrap().difference;
    let expected = number(&expected["discrepancy"]["torque"]["max_abs"]);
    assert_near("torque", torque.unwrap(), expected, 1e-12);
}

fn val_averaged(report: &Report, expected: &Value) {
    let averaged = report.averaged.as_ref().unwrap();
    let truth = &expected["averaged"];
    assert_near("from", averaged.from, number(&truth["first"]), 1e-9);
    for quantity in ["theta", "theta_dot", "phi_dot", "psi_dot"] {
        let of = |ending: &str| {
            let name = format!("{quantity}_{ending}");
            let mut all = averaged.deviations.iter();
            all.find(|deviation| deviation.quantity == name).unwrap()
        };
        let is_angle = quantity.starts_with("theta");
        let mean = of("mean");
        let truth = &truth["mean"][quantity];
        let tolerance = if is_angle { 1e-9 } else { RATE_ERROR };
        // The truth looks at the middles of A's cycles, the comparison at those of B's too.
        if (mean.at - number(&truth["time"])).abs() < 1e-8 {
            assert_largest(quantity, mean.largest, truth, tolerance);
        } else {
            assert!(
                mean.largest.abs() >= number(&truth["max_abs"]) - tolerance,
                "{mean:?}"
            );
        }
        assert_eq!(mean.largest, mean.values[1] - mean.values[0]);
    }
    let phase = &expected["phase"];
    // It drifts by less than 1e-3 in the cycle between the truth's last time and the last beginning.
    let at_last = number(&phase["at_last"]);
    assert_near(
        "phase",
        averaged.phase.as_ref().unwrap().ahead,
        at_last,
        1e-3,
    );
    let ratio = &expected["amplitude_ratio"];
    let last = number(&ratio["last"]);
    let [of_a, of_b] = averaged.amplitudes.unwrap();
    assert_near("amplitude", of_b / of_a, last, 0.01 * last);
}

fn val_signals(report: &Report, truth: &Value) {
    for (name, tolerance) in [
        ("theta", 1e-10),
        ("phi", 1e-8),
        ("psi", 1e-8),
        ("theta_dot", 1e-8),
        ("phi_dot", RATE_ERROR),
        ("psi_dot", RATE_ERROR),
        ("theta_ddot", 1e-6),
        ("phi_ddot", 200.0 * RATE_ERROR),
        ("psi_ddot", 200.0 * RATE_ERROR),
    ] {
        let (found, truth) = (field(report, "/top/state", name), &truth[name]);
        assert_largest(name, found.largest, truth, tolerance);
        assert_near(name, found.rms, number(&truth["rms"]), tolerance);
        assert_near(name, found.at, number(&truth["time"]), 1e-12);
    }
    let samples = truth["samples"].as_u64().unwrap();
    assert_eq!(channel(report, "/top/state").pairs, samples);
}

fn val_discrepancy(report: &Report, truth: &Value) {
    let found = report.discrepancy.as_ref().unwrap();
    assert_eq!(found.states, truth["samples"].as_u64().unwrap());
    let assert_residual = |name: &str, truth: &Value, tolerance: f64| {
        let mut all = found.quantities.iter();
        let residual = all.find(|residual| residual.quantity == name).unwrap();
        assert_near(name, residual.largest, number(&truth["max_abs"]), tolerance);
        assert_near(name, residual.rms, number(&truth["rms"]), tolerance);
        if let Some(own) = truth.get("rms_of_A") {
            assert_near(name, residual.rms_a, number(own), tolerance);
        }
    };
    // Torques of 1e-4 N m along a motion whose rates are known to 1e-9.
    assert_residual("friction torque", &truth["torque"], 1e-12);
    for (name, key) in [
        ("about the line of nodes", "e_N"),
        ("about n × e_N", "e_2"),
        ("about the symmetry axis", "n"),
    ] {
        assert_residual(name, &truth["torque_components"][key], 1e-12);
    }
    for axis in ["theta_ddot", "phi_ddot", "psi_ddot"] {
        let name = format!("frictional {axis}");
        assert_residual(&name, &truth["acceleration"][axis], RATE_ERROR);
    }
}

/// The estimated errors are no larger than what the tolerances above allow.
fn val_integration_errors(report: &Report) {
    let errors = report.integration_errors.as_ref().unwrap();
    for error in [&errors.a, &errors.b] {
        let of = |name: &str| {
            let mut fields = error.fields.iter();
            fields.find(|(field, _)| field == name).unwrap().1
        };
        let of_rate = of("/top/state.phi_dot");
        assert!((1e-12..RATE_ERROR).contains(&of_rate), "{of_rate:e}");
        assert!(of("/top/state.theta") < 1e-10);
        assert!(error.event_time < 1e-8 && error.theta_mean < 1e-10);
    }
}

#[test]
fn val_full_friction_torque_against_the_paper() {
    val_pair("A_B1", "B1", &scenario("full-coulomb", &[]));
}

#[test]
fn val_one_percent_more_friction() {
    let more = scenario("paper", &[("friction.k", "0.0303")]);
    val_pair("A_B2", "B2", &more);
}
