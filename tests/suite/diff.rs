//! Comparing two runs.

use crate::support::{archive, assert_near, in_memory, scenario};
use proptest::prelude::*;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::tempdir;
use toprise::analysis::diff::{
    Align, ChannelDifference, DiffError, FieldDifference, GrowthLaw, Matrix, Offset, Options,
    Report, Residual, Tolerance, Verdict, compare,
};
use toprise::archive::recording::Recording;
use toprise::archive::writer::Form;
use toprise::physics::math::{exp, ln};
use toprise::run::scenario::Scenario;
use toprise::telemetry::Topic;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::fields::{EVENTS, NumberField, STATE, events};

fn quick() -> Options {
    Options {
        floor: false,
        ..Options::default()
    }
}

fn short(overrides: &[(&str, &str)]) -> Scenario {
    let mut all = vec![("stop.duration", "2.0")];
    all.extend_from_slice(overrides);
    scenario("paper", &all)
}

fn channel<'r>(report: &'r Report, topic: &str) -> &'r ChannelDifference {
    let found = report
        .signals
        .channels
        .iter()
        .find(|channel| channel.topic == topic);
    found.unwrap_or_else(|| panic!("no {topic}"))
}

fn field<'r>(report: &'r Report, topic: &str, name: &str) -> &'r FieldDifference {
    let found = channel(report, topic)
        .fields
        .iter()
        .find(|field| field.field == name);
    found.unwrap_or_else(|| panic!("no {topic}.{name}"))
}

fn recorded(path: &Path, scenario: &Scenario, encoding: Encoding) -> Recording {
    let form = Form {
        encoding,
        ..Form::default()
    };
    archive(path, scenario, &[], form).unwrap();
    Recording::open(path).unwrap()
}

fn data(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("tests/data")
        .join(name)
}

fn foreign(name: &str) -> Recording {
    Recording::open(&data(&format!("foreign/{name}.mcap"))).unwrap()
}

// Against numbers that were computed without this project.

fn truth() -> Value {
    let text = fs::read_to_string(data("two_runs.json")).unwrap();
    serde_json::from_str::<Value>(&text).unwrap()["values"].clone()
}

fn number(value: &Value) -> f64 {
    value
        .as_f64()
        .unwrap_or_else(|| panic!("{value} is no number"))
}

/// The integrator's error in φ̇ and ψ̇ reaches 1e-7 rad/s where θ is 0.02 rad: 1e-12 of the tolerance times the
/// number of steps, divided by sin θ. That of θ and θ̇ is a hundred times smaller, accelerations have ω ≈ 140/s
/// more.
const RATE_ERROR: f64 = 2e-7;

/// Maximum and RMS of a quantity: `largest` is checked with its sign if the truth has one.
#[track_caller]
fn assert_deviation(what: &str, (largest, rms): (f64, f64), truth: &Value, tolerance: f64) {
    assert_near(what, largest.abs(), number(&truth["max_abs"]), tolerance);
    assert_near(what, rms, number(&truth["rms"]), tolerance);
    if number(&truth["gap"]) > tolerance {
        assert_eq!(
            largest < 0.0,
            number(&truth["signed"]) < 0.0,
            "{what}: sign"
        );
    }
}

fn val_pair(pair: &str, run_b: &str, b: &Scenario) {
    let a = scenario("paper", &[]);
    let report = compare(&a, b, &Options::default()).unwrap();
    let truth = truth();
    let (runs, expected) = (&truth["runs"], &truth["pairs"][pair]);
    val_happened(&report, runs, run_b, expected);
    val_averaged(&report, expected);
    val_signals(&report, expected);
    val_discrepancy(&report, expected);
    val_floor(&report);
}

fn val_happened(report: &Report, runs: &Value, run_b: &str, expected: &Value) {
    let happened = report.happened.as_ref().unwrap();
    let shift = number(&expected["rise_shift"]);
    // The rise's own error is 1e-10 s (tests/suite/reference.rs).
    assert_near("rise shift", happened.rise_shift.unwrap(), shift, 1e-9);
    let crossing = &expected["averaged_crossing"];
    assert_near(
        "level",
        happened.averaged_level.unwrap(),
        number(&crossing["level"]),
        1e-10,
    );
    // The averages fall by 0.02 rad/s, and have the error of θ.
    let [a, b] = [happened.averaged_crossing_a, happened.averaged_crossing_b].map(Option::unwrap);
    assert_near("crossing of A", a, number(&crossing["time_A"]), 1e-8);
    assert_near("crossing of B", b, number(&crossing["time_B"]), 1e-8);
    for (run, name) in [(&report.a, "A"), (&report.b, run_b)] {
        let (course, expected) = (run.course.as_ref().unwrap(), &runs[name]);
        assert_eq!(
            course.nutations.unwrap(),
            expected["nutation"]["cycles"].as_u64().unwrap()
        );
        assert_near(
            "rise",
            course.rise_time.unwrap(),
            number(&expected["rise"]["time"]),
            1e-9,
        );
        let rates = (
            course.precession_rate_last.unwrap(),
            course.spin_rate_last.unwrap(),
        );
        assert_near(
            "φ̇",
            rates.0,
            number(&expected["rise"]["phi_dot"]),
            RATE_ERROR,
        );
        assert_near(
            "ψ̇",
            rates.1,
            number(&expected["rise"]["psi_dot"]),
            RATE_ERROR,
        );
        // Summed from samples, with an error of h⁴ · 19/720 of the third derivatives at both ends: the power
        // changes by at most 1e-3 W with ω = 140/s.
        let work = course.friction_work_node.unwrap();
        for (work, axis) in work.into_iter().zip(["e_N", "e_2", "n"]) {
            let expected = number(&expected["energy"]["friction_work_at_last_sample"][axis]);
            assert_near(
                axis,
                work,
                expected,
                1e-12 * 19.0 / 360.0 * 1e-3 * 140.0 * 140.0 * 140.0,
            );
        }
    }
    for (name, key) in [
        ("nutation_maximum", "theta_maxima"),
        ("nutation_minimum", "theta_minima"),
    ] {
        let kind = happened
            .kinds
            .iter()
            .find(|kind| kind.name == name)
            .unwrap();
        let count = |run: &str| runs[run]["events"][key].as_u64().unwrap();
        assert_eq!(
            (kind.count_a, kind.count_b),
            (count("A"), count(run_b)),
            "{name}"
        );
    }
    let loops = happened
        .kinds
        .iter()
        .find(|kind| kind.name == "looping_begins")
        .unwrap();
    match runs[run_b]["events"]["looping_begins"].as_f64() {
        None => {
            assert_eq!(loops.count_b, 0);
            let first = happened
                .only_in_a
                .iter()
                .find(|event| event.name == "looping_begins")
                .unwrap();
            let expected = number(&runs["A"]["events"]["looping_begins"]);
            assert_near("looping", first.time, expected, 1e-8);
        }
        Some(expected) => {
            let first = happened
                .matched
                .iter()
                .find(|event| event.name == "looping_begins")
                .unwrap();
            assert_near("looping", first.time_b, expected, 1e-8);
        }
    }
}

fn val_averaged(report: &Report, expected: &Value) {
    let averaged = report.averaged.as_ref().unwrap();
    let truth = &expected["averaged"];
    assert_eq!(averaged.cycles, truth["points"].as_u64().unwrap());
    for quantity in ["theta", "theta_dot", "phi_dot", "psi_dot"] {
        let of = |deviations: &[toprise::analysis::diff::Deviation], ending: &str| {
            let name = format!("{quantity}_{ending}");
            let found = deviations
                .iter()
                .find(|deviation| deviation.quantity == name)
                .unwrap();
            (found.largest, found.rms)
        };
        // Averages have the integrator's error; extremes between samples are those of a cubic, whose error is
        // (ω h)⁴/384 = 1e-6 of the amplitude, which is at most 5.4 rad/s, in either run.
        let tolerance = if quantity.starts_with("theta") {
            1e-9
        } else {
            RATE_ERROR
        };
        let between = if quantity == "theta" { 1e-9 } else { 1.1e-5 };
        assert_deviation(
            quantity,
            of(&averaged.means, "mean"),
            &truth["mean"][quantity],
            tolerance,
        );
        assert_deviation(
            quantity,
            of(&averaged.envelopes, "min"),
            &truth["lower"][quantity],
            between,
        );
        assert_deviation(
            quantity,
            of(&averaged.envelopes, "max"),
            &truth["upper"][quantity],
            between,
        );
    }
    let frequency = (averaged.frequency.largest, averaged.frequency.rms);
    assert_deviation("frequency", frequency, &truth["frequency"], 1e-6);
    let phase = &expected["phase"];
    assert_deviation(
        "phase",
        (averaged.phase.largest, averaged.phase.rms),
        phase,
        1e-7,
    );
    assert_near(
        "phase at last",
        averaged.phase_last,
        number(&phase["at_last"]),
        1e-7,
    );
    match phase["quarter_at_boundary"].as_f64() {
        Some(time) => assert_near("decorrelated", averaged.decorrelated.unwrap(), time, 1e-7),
        None => assert_eq!(averaged.decorrelated, None),
    }
    let ratio = &expected["amplitude_ratio"];
    assert_near(
        "first ratio",
        averaged.amplitude_ratio_first.unwrap(),
        number(&ratio["first"]),
        4e-6,
    );
    assert_near(
        "last ratio",
        averaged.amplitude_ratio_last.unwrap(),
        number(&ratio["last"]),
        4e-6,
    );
}

fn val_signals(report: &Report, expected: &Value) {
    let truth = &expected["signals"];
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
        let found = field(report, "/top/state", name);
        assert_eq!(found.count, truth["samples"].as_u64().unwrap());
        assert_deviation(name, (found.largest, found.rms), &truth[name], tolerance);
        assert_near(name, found.at, number(&truth[name]["time"]), 1e-12);
    }
}

fn val_discrepancy(report: &Report, expected: &Value) {
    let truth = &expected["discrepancy"];
    let found = report.discrepancy.as_ref().unwrap();
    assert_eq!(found.states, truth["samples"].as_u64().unwrap());
    let of = |name: &str| -> &Residual {
        found
            .quantities
            .iter()
            .find(|residual| residual.quantity == name)
            .unwrap()
    };
    let torque = of("friction torque");
    // Torques of 1e-4 N m along a motion whose rates are known to 1e-9.
    assert_near(
        "torque",
        torque.largest,
        number(&truth["torque"]["max_abs"]),
        1e-12,
    );
    assert_near("torque", torque.rms, number(&truth["torque"]["rms"]), 1e-12);
    assert_near(
        "torque of A",
        torque.rms_a,
        number(&truth["torque"]["rms_of_A"]),
        1e-12,
    );
    for (name, key) in [
        ("about the line of nodes", "e_N"),
        ("about n × e_N", "e_2"),
        ("about the symmetry axis", "n"),
    ] {
        let truth = &truth["torque_components"][key];
        assert_near(name, of(name).largest, number(&truth["max_abs"]), 1e-12);
        assert_near(name, of(name).rms, number(&truth["rms"]), 1e-12);
    }
    for axis in ["theta_ddot", "phi_ddot", "psi_ddot"] {
        let (truth, name) = (&truth["acceleration"][axis], format!("frictional {axis}"));
        assert_near(
            axis,
            of(&name).largest,
            number(&truth["max_abs"]),
            RATE_ERROR,
        );
        assert_near(axis, of(&name).rms, number(&truth["rms"]), RATE_ERROR);
    }
}

/// The errors that the report tells bound the true ones, to within a factor of ten, and are no larger than
/// what the tolerances above allow.
fn val_floor(report: &Report) {
    let floor = report.floor.as_ref().unwrap();
    for error in [&floor.a, &floor.b] {
        let of = |name: &str| {
            error
                .fields
                .iter()
                .find(|(field, _)| field == name)
                .unwrap()
                .1
        };
        assert!(of("/top/state.phi_dot") < RATE_ERROR && of("/top/state.phi_dot") > 1e-12);
        assert!(of("/top/state.theta") < 1e-10);
        assert!(error.event_shift < 1e-8 && error.theta_mean < 1e-10);
    }
}

#[test]
fn val_the_whole_friction_torque_against_the_paper_s() {
    val_pair("A_B1", "B1", &scenario("full-coulomb", &[]));
}

#[test]
fn val_one_percent_more_friction() {
    val_pair(
        "A_B2",
        "B2",
        &scenario("paper", &[("friction.k", "0.0303")]),
    );
}

#[test]
fn the_summary_states_what_was_found() {
    let report = compare(
        &scenario("paper", &[]),
        &scenario("full-coulomb", &[]),
        &Options::default(),
    );
    let summary = report.unwrap().summary.join(" ");
    for finding in [
        "friction.dissipation (A: without-nutation-part, B: full)",
        "Averaged over a nutation, B passes 0.0216 rad 218 µs earlier",
        "In B θ first touches 0.0200 rad 11.6 ms later (24.7309 s, not 24.7194 s)",
        "the averages differ by up to 4.7e-6 rad in θ",
        "3.9 times weaker",
        "A loops from 24.2703 s on; B does not by its end, at 24.7309 s.",
        "friction torques differ by up to 7.1e-6 N m; the RMS of A's is 2.3e-4 N m",
    ] {
        assert!(summary.contains(finding), "{finding} is not in: {summary}");
    }
}

// Runs that are the same.

#[test]
fn a_run_is_identical_to_itself_in_any_encoding_and_on_the_fly() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let json = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Json);
    let protobuf = recorded(
        &directory.path().join("b.mcap"),
        &scenario,
        Encoding::Protobuf,
    );
    let reports = [
        compare(&json, &protobuf, &quick()),
        compare(&json, &json, &quick()),
        compare(&scenario, &protobuf, &quick()),
        compare(&scenario, &scenario, &Options::default()),
    ];
    for (report, is_rewritten) in reports
        .map(Result::unwrap)
        .iter()
        .zip([true, false, false, false])
    {
        let (verdict, opening) = match is_rewritten {
            true => (Verdict::SameValues, "The same values"),
            false => (Verdict::Identical, "Identical, bit for bit"),
        };
        assert_eq!(report.verdict, verdict);
        assert!(report.is_complete);
        assert!(
            report.summary[0].starts_with(opening),
            "{:?}",
            report.summary
        );
        assert!(report.signals.parted.is_empty());
    }
    let same = compare(&json, &json, &quick()).unwrap();
    assert_eq!(same.notes, ["A and B are the same file."]);
}

#[test]
fn a_finer_run_agrees_at_the_times_that_both_have() {
    let coarse = short(&[("sampling.period", "0.004")]);
    let report = compare(&coarse, &short(&[]), &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Agreeing, "{:?}", report.summary);
    let theta = field(&report, "/top/state", "theta");
    assert_eq!((theta.count, theta.largest), (501, 0.0));
}

#[test]
fn val_interpolation_is_as_exact_as_it_says() {
    // 0.7 and 1 ms have few times in common. The truth is the same run at the times of the coarser one.
    let (a, b) = (short(&[]), short(&[("sampling.period", "0.0007")]));
    let report = compare(&a, &b, &quick()).unwrap();
    // B's last sample is at 1.9999 s.
    let state = channel(&report, "/top/state");
    assert_eq!((state.pairs, state.beyond_in_a), (2000, 0));
    for (topic, fields) in [
        (
            "/top/state",
            &["theta", "phi", "psi", "theta_dot", "phi_dot", "theta_ddot"][..],
        ),
        ("/top/torque", &["friction_node.y", "total_body.x"][..]),
    ] {
        for name in fields {
            let found = field(&report, topic, name);
            let estimate = found.interpolation_error.unwrap();
            assert!(estimate > 0.0 && found.relative < 1e-4, "{name}: {found:?}");
            // The estimate is made in the middle, at every eighth message.
            assert!(
                found.largest.abs() <= 2.0 * estimate + 1e-13 * found.scale,
                "{name}: {found:?}"
            );
        }
    }
    // Angles with two derivatives are worth more than their values alone.
    assert!(field(&report, "/top/state", "theta").relative < 1e-10);
}

// What was put in comes out.

/// A recording of A with its messages changed: times, sequences, numbers.
fn rewritten(
    path: &Path,
    scenario: &Scenario,
    mut change: impl FnMut(&mut toprise::archive::memory::Owned),
) -> Recording {
    use toprise::archive::sink::Sink as _;
    use toprise::telemetry::Telemetry;
    let telemetry = Telemetry::default();
    let existing = toprise::archive::publish::Existing::Replace;
    let mut sink = toprise::archive::writer::McapSink::create(
        path,
        existing,
        scenario,
        &telemetry,
        Form::default(),
    )
    .unwrap();
    let (original, end) = in_memory(scenario);
    for mut message in original.messages {
        change(&mut message);
        sink.write(&message.as_message()).unwrap();
    }
    sink.finish(&end).unwrap();
    Recording::open(path).unwrap()
}

fn at(topic: &str, name: &str) -> (usize, usize) {
    let field = NumberField::find(topic, name).unwrap();
    (field.topic().index(), field.index())
}

#[test]
fn one_ulp_in_one_number_is_named() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Json);
    let (channel, number) = at("/top/torque", "friction_body.y");
    let b = rewritten(&directory.path().join("b.mcap"), &scenario, |message| {
        if message.channel == channel && message.time_ns == 123_000_000 {
            message.numbers[number] = message.numbers[number].next_up();
        }
    });
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let sentence = &report.summary[0];
    assert!(
        sentence.contains("/top/torque.friction_body.y"),
        "{sentence}"
    );
    assert!(
        sentence.contains("0.123 s") && sentence.contains("1 ulp"),
        "{sentence}"
    );
    assert!(sentence.contains("no other field differs"), "{sentence}");
    let found = field(&report, "/top/torque", "friction_body.y");
    assert_eq!(
        (found.ulp, found.beyond, found.first_beyond),
        (Some(1), 1, Some(0.123))
    );
    // Three messages before and after, and the bits.
    let divergence = report.divergence.as_ref().unwrap();
    assert_eq!(
        (divergence.topic.as_str(), divergence.time),
        ("/top/torque", 0.123)
    );
    let [context] = divergence.fields.as_slice() else {
        panic!("{divergence:?}");
    };
    assert_eq!(context.field, "friction_body.y");
    let times: Vec<f64> = context.pairs.iter().map(|pair| pair.time).collect();
    assert_eq!(times, [0.120, 0.121, 0.122, 0.123, 0.124, 0.125, 0.126]);
    for (at, pair) in context.pairs.iter().enumerate() {
        assert_eq!(
            (pair.is_first, pair.bits.is_some(), pair.a == pair.b),
            (at == 3, at == 3, at != 3)
        );
    }
    let [x, y] =
        [&context.pairs[3].a, &context.pairs[3].b].map(|text| text.parse::<f64>().unwrap());
    assert_eq!(x.next_up(), y);
    let bits = u64::from_str_radix(context.pairs[3].bits.as_ref().unwrap(), 16).unwrap();
    assert_eq!(bits, x.to_bits() ^ y.to_bits());
    // What is ignored doesn't count, but then not everything is the same.
    for pattern in ["/top/torque", "/top/torque.friction_body", "*.y"] {
        let mut ignoring = quick();
        ignoring.tolerances.ignored.push(pattern.to_owned());
        let report = compare(&a, &b, &ignoring).unwrap();
        assert_eq!(report.verdict, Verdict::Equal, "{pattern}");
        assert_eq!(report.divergence, None);
    }
    let mut ignoring = quick();
    ignoring.tolerances.ignored.push("/top/torq".to_owned());
    let error = compare(&a, &b, &ignoring).unwrap_err().to_string();
    assert!(error.contains("/top/torq"), "{error}");
    let mut tolerant = quick();
    tolerant.tolerances.general = Tolerance {
        ulp: 1,
        ..Tolerance::default()
    };
    assert_eq!(compare(&a, &b, &tolerant).unwrap().verdict, Verdict::Equal);
    let mut elsewhere = quick();
    elsewhere.tolerances.add("/top/state=ulp:1").unwrap();
    assert_eq!(
        compare(&a, &b, &elsewhere).unwrap().verdict,
        Verdict::Different
    );
}

/// Over 1001 samples a difference of 0.1 in one has the root mean square 0.1/√1001 = 0.00316.
#[test]
fn derived_angles_count_all_pairs() {
    let directory = tempdir().unwrap();
    let scenario = short(&[("stop.duration", "1.0")]);
    let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Json);
    let (channel, number) = at("/top/state", "psi");
    let b = rewritten(&directory.path().join("b.mcap"), &scenario, |message| {
        if message.channel == channel && message.time_ns == 500_000_000 {
            message.numbers[number] += 0.1;
        }
    });
    let report = compare(&a, &b, &quick()).unwrap();
    for name in ["psi", "ψ as a direction"] {
        let found = field(&report, "/top/state", name);
        assert_eq!(found.count, 1001, "{name}");
        assert_near(name, found.rms, 0.1 / 1001.0_f64.sqrt(), 1e-12);
        assert_near(name, found.mean, 0.1 / 1001.0, 1e-12);
    }
}

#[test]
fn a_changed_event_is_different_whatever_the_tolerance() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Json);
    let changed = |text: usize, name: &str| {
        rewritten(&directory.path().join(name), &scenario, |message| {
            if message.channel == EVENTS.index() && message.sequence == 3 {
                message.texts[text] = "other".to_owned();
            }
        })
    };
    let mut tolerant = quick();
    tolerant.tolerances.general.abs = 1e9;
    let kind = compare(&a, &changed(0, "kind.mcap"), &tolerant).unwrap();
    assert_eq!(kind.verdict, Verdict::Different);
    // Descriptions repeat the numbers for people: where those are the same, so are these.
    let description = changed(1, "description.mcap");
    let report = compare(&a, &description, &tolerant).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 12, failure_persistence: None, ..ProptestConfig::default() })]

    /// Offset, scale and growth of a signal come back.
    #[test]
    fn known_changes_come_back(
        offset in -1.0..1.0_f64,
        scale in 0.5..2.0_f64,
        rate in 0.1..2.0_f64,
        power in 0.5..3.0_f64,
    ) {
        let directory = tempdir().unwrap();
        let scenario = short(&[("stop.duration", "1.0")]);
        let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Protobuf);
        let (state, theta) = at("/top/state", "theta");
        let (_, phi) = at("/top/state", "phi");
        let (_, psi) = at("/top/state", "psi");
        let (_, spin) = at("/top/state", "psi_dot");
        let b = rewritten(&directory.path().join("b.mcap"), &scenario, |message| {
            if message.channel == state {
                let t = message.time_ns as f64 / 1e9;
                message.numbers[theta] += offset;
                message.numbers[spin] *= scale;
                message.numbers[phi] += 1e-3 * exp(rate * t);
                message.numbers[psi] += exp(power * ln(t));
            }
        });
        let report = compare(&a, &b, &quick()).unwrap();
        let theta = field(&report, "/top/state", "theta");
        prop_assert!((theta.mean - offset).abs() < 1e-12 && (theta.rms - offset.abs()).abs() < 1e-12);
        let spin = field(&report, "/top/state", "psi_dot");
        let expected = (scale - 1.0).abs() / scale.max(1.0);
        prop_assert!((spin.relative - expected).abs() < 1e-3, "{spin:?} {expected}");
        let growth = |name: &str| report.signals.growth.iter().find(|g| g.field == name).unwrap();
        prop_assert_eq!(growth("/top/state.theta").law, GrowthLaw::Bounded);
        let phi = growth("/top/state.phi");
        // Too slow to be told from no growth at all.
        if rate > 0.8 {
            prop_assert_eq!(phi.law, GrowthLaw::Exponential);
            prop_assert!((phi.parameter - rate).abs() < 1e-3 && phi.quality > 0.999);
        }
        let psi = growth("/top/state.psi");
        prop_assert_eq!(psi.law, GrowthLaw::Power);
        prop_assert!((psi.parameter - power).abs() < 1e-6 && psi.quality > 0.999_999);
    }

    /// A shift of all cycles and events comes back as a phase, and as shifts.
    #[test]
    fn known_shifts_come_back(cycles in 0.01..0.4_f64) {
        let directory = tempdir().unwrap();
        let scenario = short(&[("stop.duration", "1.0")]);
        let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Protobuf);
        let (nutation, start) = at("/top/nutation", "start");
        let time = events::TIME.index();
        let delay = 0.04398 * cycles;
        let b = rewritten(&directory.path().join("b.mcap"), &scenario, |message| {
            if message.channel == nutation {
                message.numbers[start] += delay;
            }
            if message.channel == EVENTS.index() && message.texts[0] != "start" {
                message.numbers[time] += delay;
            }
        });
        let report = compare(&a, &b, &quick()).unwrap();
        let averaged = report.averaged.as_ref().unwrap();
        // The period grows from 43.98 to 44.4 ms.
        prop_assert!((averaged.phase_last + cycles).abs() < 1e-2 * cycles, "{averaged:?}");
        prop_assert!(averaged.decorrelated.is_none() || cycles > 0.249);
        prop_assert!(averaged.decorrelated.is_some() || cycles < 0.253);
        for kind in report.happened.unwrap().kinds.iter().filter(|kind| kind.name != "start") {
            prop_assert_eq!(kind.matched, kind.count_a);
            prop_assert!((kind.mean_shift.unwrap() - delay).abs() < 1e-12);
        }
        // What was delayed is the same again at equal phases.
        let aligned = compare(&a, &b, &Options { align: Align::Nutation, ..quick() });
        prop_assert!(aligned.is_ok());
    }
}

#[test]
fn val_phase_and_average_undo_a_delay() {
    // The same top, started later on its way: B is A from 0.5 s on.
    let a = short(&[("stop.duration", "3.0")]);
    let run = crate::support::Run::of(&a);
    let later = run.at(0.5);
    let value = |x: f64| format!("{x:?}");
    let (angles, rates) = (later.angles, later.tilt.rates);
    let b = short(&[
        ("initial.theta", &value(angles.theta)),
        ("initial.theta_dot", &value(rates.theta)),
        ("initial.phi_dot", &value(rates.phi)),
        ("initial.psi_dot", &value(rates.psi)),
        ("stop.duration", "2.5"),
    ]);
    let at_equal_times = compare(&a, &b, &quick()).unwrap();
    let by_average = compare(
        &a,
        &b,
        &Options {
            align: Align::Theta,
            ..quick()
        },
    )
    .unwrap();
    let spin = |report: &Report| field(report, "/top/state", "psi_dot").rms;
    assert!(spin(&at_equal_times) > 0.02);
    // B's cycles are A's: at equal averages it is at the same point of its motion. The averages are known at
    // the middles of cycles; between them the cubic is off by a part of the ripple of the averages, which is
    // 1e-9 of θ, over the drift of 0.0163 rad/s.
    assert!(spin(&by_average) < 1e-5, "{}", spin(&by_average));
    let angle = channel(&by_average, "/top/state")
        .fields
        .iter()
        .find(|f| f.field == "theta")
        .unwrap();
    assert!(angle.largest.abs() < 1e-6, "{angle:?}");
    assert!(by_average.signals.alignment.contains("averaged"));
}

#[test]
fn swapping_the_runs_mirrors_the_report() {
    let (a, b) = (short(&[]), short(&[("friction.dissipation", "full")]));
    let there = compare(&a, &b, &quick()).unwrap();
    let back = compare(&b, &a, &quick()).unwrap();
    for (x, y) in there.signals.channels.iter().zip(&back.signals.channels) {
        assert_eq!(
            (x.pairs, x.identical, x.only_in_a),
            (y.pairs, y.identical, y.only_in_b)
        );
        for (f, g) in x.fields.iter().zip(&y.fields) {
            if f.is_derived {
                // The product of two quaternions in the other order is rounded otherwise.
                assert_near(&f.field, f.largest.abs(), g.largest.abs(), 1e-15);
                assert_near(&f.field, f.rms, g.rms, 1e-15);
                continue;
            }
            let mirrored = (-g.largest, g.rms, g.ulp);
            assert_eq!((f.largest, f.rms, f.ulp), mirrored, "{}", f.field);
            assert_eq!(f.beyond, g.beyond);
            // Cycles and events are told by A's times.
            if !["/top/nutation", "/events"].contains(&x.topic.as_str()) {
                assert_eq!(f.first_different, g.first_different);
            }
        }
    }
    assert_eq!(there.signals.growth, back.signals.growth);
    let shifts = |report: &Report| -> Vec<(u64, Option<f64>)> {
        let happened = report.happened.as_ref().unwrap();
        happened
            .kinds
            .iter()
            .map(|kind| (kind.matched, kind.largest_shift.map(f64::abs)))
            .collect()
    };
    assert_eq!(shifts(&there), shifts(&back));
    let [x, y] = [&there, &back].map(|report| report.averaged.as_ref().unwrap().phase_last);
    // The boundaries at which it is taken are A's, a little before or after B's.
    assert!(x != 0.0 && (x + y).abs() < 0.1 * x.abs(), "{x} {y}");
}

#[test]
fn differences_below_the_integrators_errors_are_marked() {
    // Two ways of integrating the same motion.
    let report = compare(
        &short(&[]),
        &short(&[("formulation", "body")]),
        &Options::default(),
    )
    .unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let summary = report.summary.join(" ");
    let floor = report.floor.as_ref().unwrap();
    assert!(floor.a.compared_with < floor.a.relative_tolerance);
    let theta = field(&report, "/top/state", "theta");
    assert!(
        theta.largest != 0.0 && theta.largest.abs() < 1e-11,
        "{theta:?}"
    );
    assert!(theta.floor.unwrap() > 0.0);
    let below = report
        .signals
        .channels
        .iter()
        .flat_map(|c| &c.fields)
        .filter(|f| f.is_below_floor);
    assert!(below.count() > 20, "{summary}");
}

#[test]
fn causes_part_before_effects() {
    let report = compare(&short(&[]), &short(&[("friction.k", "0.0303")]), &quick()).unwrap();
    let first = |kind: &str| {
        let parted = report.signals.parted.iter();
        parted
            .filter(|parting| parting.kind.name() == kind)
            .map(|parting| parting.time)
            .next()
            .unwrap()
    };
    assert_eq!(first("torque"), 0.0);
    assert!(first("acceleration") <= first("rate") && first("rate") <= first("angle"));
    assert!(first("angle") > 0.0);
}

// Files of others.

#[test]
fn json_of_others_is_compared() {
    for (a, b) in [("json_a", "json_b"), ("schemaless_a", "schemaless_b")] {
        let report = compare(&foreign(a), &foreign(b), &Options::default()).unwrap();
        assert_eq!(report.verdict, Verdict::Different);
        assert!(report.happened.is_none() && report.averaged.is_none() && report.floor.is_none());
    }
    let report = compare(&foreign("json_a"), &foreign("json_b"), &quick()).unwrap();
    let z = field(&report, "/imu", "angular_velocity.z");
    assert_eq!((z.count, z.beyond, z.first_beyond), (200, 100, Some(1.0)));
    assert!((z.largest - 1e-3).abs() < 1e-15);
    let others = channel(&report, "/imu")
        .fields
        .iter()
        .filter(|field| field.field != z.field);
    let others = others.filter(|field| field.field != "header.frame_id");
    assert!(
        others.clone().count() == 7 && others.clone().all(|field| field.first_different.is_none())
    );
    let name = field(&report, "/imu", "header.frame_id");
    assert_eq!((name.other_values, name.count), (200, 0));
    let texts = channel(&report, "/imu").texts.as_ref().unwrap();
    assert_eq!((texts.a.as_str(), texts.b.as_str()), ("imu_a", "imu_b"));
    // Different rates: B's times, A on straight lines, which it is.
    let x = field(&report, "/odom", "x");
    assert_eq!(x.count, 40);
    assert!((x.largest - 1e-4).abs() < 1e-15 && (x.rms - 1e-4).abs() < 1e-15);
    assert!(x.interpolation_error.is_some());
    let (one, both) = (
        field(&report, "/nan", "one"),
        field(&report, "/nan", "both"),
    );
    assert_eq!(
        (one.not_numbers, one.beyond, one.first_different),
        (1, 1, Some(0.7))
    );
    assert_eq!((both.not_numbers, both.first_different), (0, None));
    assert!(channel(&report, "/empty").is_empty());
    assert_eq!(report.setup.topics_only_in_a, ["/only_a"]);
    assert_eq!(report.setup.topics_only_in_b, ["/only_b"]);
    let theta = compare(&foreign("schemaless_a"), &foreign("schemaless_b"), &quick()).unwrap();
    let theta = field(&theta, "/state", "theta");
    assert_eq!((theta.largest, theta.at, theta.beyond), (0.25, 0.84, 1));
}

#[test]
fn protobuf_of_others_is_compared() {
    let (a, b) = (foreign("protobuf_a"), foreign("protobuf_b"));
    let report = compare(&a, &b, &quick()).unwrap();
    for (name, largest, first, beyond) in [
        ("position.y", 1e-6, 0.0, 100),
        ("joints.1", 0.5, 1.0, 1),
        ("mode", 1.0, 0.4, 1),
        ("ticks", 1.0, 1.5, 25),
    ] {
        let found = field(&report, "/robot", name);
        assert!((found.largest - largest).abs() < 1e-12, "{found:?}");
        assert_eq!(
            (found.first_different, found.beyond),
            (Some(first), beyond),
            "{name}"
        );
    }
    assert_eq!(
        report.setup.fields_only_in_b,
        ["/robot.contacts.1.id", "/robot.contacts.1.force"]
    );
    assert_eq!(channel(&report, "/pose").identical, 20);
    let as_json = compare(&a, &foreign("protobuf_as_json"), &quick()).unwrap();
    // The bytes are in one of them only, and what is no number is null in JSON.
    assert_eq!(as_json.verdict, Verdict::Different);
    assert_eq!(as_json.setup.fields_only_in_a, ["/robot.raw"]);
    assert!(as_json.setup.fields_only_in_b.is_empty());
    let fields = as_json.signals.fields();
    let differing = fields.filter(|(_, field)| field.first_different.is_some());
    let differing: Vec<_> = differing
        .map(|(_, field)| (&*field.field, field.beyond))
        .collect();
    assert_eq!(differing, [("quality", 3)]);
}

#[test]
fn a_file_that_lost_its_origin_is_compared_with_a_scenario() {
    // As another tool would write it: the same messages, without a word about toprise.
    let directory = tempdir().unwrap();
    let scenario = short(&[("stop.duration", "0.5")]);
    let path = directory.path().join("a.mcap");
    recorded(&path, &scenario, Encoding::Json);
    let other = directory.path().join("b.mcap");
    let bytes = fs::read(&path).unwrap();
    let mut writer = mcap::WriteOptions::new()
        .library("other")
        .create(std::io::BufWriter::new(fs::File::create(&other).unwrap()))
        .unwrap();
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        writer.write(&message.unwrap()).unwrap();
    }
    writer.finish().unwrap();
    let other = Recording::open(&other).unwrap();
    let report = compare(&other, &scenario, &quick()).unwrap();
    assert_eq!(report.happened, None);
    assert_eq!(channel(&report, "/top/state").pairs, 501);
    // Views are nothing that is simulated.
    for channel in report
        .signals
        .channels
        .iter()
        .filter(|c| Topic::find(&c.topic).is_some())
    {
        assert!(channel.pairs > 0, "{}", channel.topic);
        assert_eq!(
            (channel.only_in_a, channel.only_in_b),
            (0, 0),
            "{}",
            channel.topic
        );
    }
    assert!(
        report.summary[0].starts_with("What both have is the same"),
        "{:?}",
        report.summary
    );
    // What only the file has are the numbers of the timestamps, and the view channels.
    assert!(
        report
            .setup
            .fields_only_in_a
            .iter()
            .all(|name| name.contains(".timestamp."))
    );
    assert!(report.setup.fields_only_in_b.is_empty());
}

/// An MCAP file with JSON messages: topics, times in ms, and values of `x`.
fn numbers(
    directory: &tempfile::TempDir,
    name: &str,
    topics: &[(&str, &[(u64, &str)])],
) -> Recording {
    let path = directory.path().join(name);
    let file = std::io::BufWriter::new(fs::File::create(&path).unwrap());
    let mut writer = mcap::WriteOptions::new()
        .library("test")
        .create(file)
        .unwrap();
    for (topic, messages) in topics {
        let channel = writer
            .add_channel(0, topic, "json", &std::collections::BTreeMap::new())
            .unwrap();
        for (sequence, (milliseconds, x)) in messages.iter().enumerate() {
            let header = mcap::records::MessageHeader {
                channel_id: channel,
                sequence: sequence as u32,
                log_time: milliseconds * 1_000_000,
                publish_time: 0,
            };
            writer
                .write_to_known_channel(&header, x.as_bytes())
                .unwrap();
        }
    }
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

/// Messages every so many ms in a span of time, all the same.
fn every(step: u64, span: std::ops::Range<u64>) -> Vec<(u64, &'static str)> {
    span.step_by(step as usize)
        .map(|time| (time, r#"{"x":1}"#))
        .collect()
}

fn verdict_of(a: &Recording, b: &Recording, options: &Options) -> Verdict {
    let [there, back] = [compare(a, b, options), compare(b, a, options)].map(Result::unwrap);
    assert_eq!(
        there.verdict, back.verdict,
        "{:?} {:?}",
        there.summary, back.summary
    );
    there.verdict
}

#[test]
fn what_only_one_file_has_is_different() {
    let directory = tempdir().unwrap();
    let file =
        |name: &str, messages: &[(u64, &str)]| numbers(&directory, name, &[("/x", messages)]);
    let whole = file("whole.mcap", &every(10, 0..20_000));
    let is_different =
        |other: &Recording| verdict_of(&whole, other, &quick()) == Verdict::Different;
    // A gap, messages lost here and there, an end that comes earlier.
    let gap = [every(10, 0..5_000), every(10, 15_000..20_000)].concat();
    assert!(is_different(&file("gap.mcap", &gap)));
    let some: Vec<_> = every(10, 0..20_000)
        .into_iter()
        .filter(|(time, _)| time % 30 != 0)
        .collect();
    assert!(is_different(&file("some.mcap", &some)));
    assert!(is_different(&file("short.mcap", &every(10, 0..10_000))));
    // Every second message is missing.
    assert!(is_different(&file("coarse.mcap", &every(20, 0..20_000))));
    assert!(is_different(&file(
        "coarse-short.mcap",
        &every(20, 0..10_000)
    )));
    let gap = [every(20, 0..5_000), every(20, 15_000..20_000)].concat();
    assert!(is_different(&file("coarse-gap.mcap", &gap)));
    // At other times and another rate they can agree, and are not the same.
    let other = file("other.mcap", &every(23, 3..20_000));
    assert_eq!(verdict_of(&whole, &other, &quick()), Verdict::Agreeing);
    assert!(is_different(&file(
        "other-short.mcap",
        &every(23, 3..10_000)
    )));
    let gap = [every(23, 3..5_000), every(23, 15_000..20_000)].concat();
    assert!(is_different(&file("other-gap.mcap", &gap)));
}

#[test]
fn topics_and_fields_that_never_meet_are_different() {
    let directory = tempdir().unwrap();
    let (early, late) = (every(10, 0..1_000), every(10, 5_000..6_000));
    let both = |name: &str, y: &[(u64, &'static str)]| {
        numbers(&directory, name, &[("/x", &early), ("/y", y)])
    };
    let (a, b) = (both("a.mcap", &early), both("b.mcap", &late));
    assert_eq!(verdict_of(&a, &b, &quick()), Verdict::Different);
    // A field that only one has numbers in, and one that comes late.
    let with = |name: &str, e: fn(usize) -> &'static str| {
        let messages: Vec<_> = (0..6_000).map(|i| (i as u64, e(i))).collect();
        numbers(&directory, name, &[("/x", &messages)])
    };
    let always = with("always.mcap", |_| r#"{"x":1,"e":2}"#);
    let never = with("never.mcap", |_| r#"{"x":1,"e":"2"}"#);
    let late = with("late.mcap", |i| {
        if i < 5_000 {
            r#"{"x":1}"#
        } else {
            r#"{"x":1,"e":2}"#
        }
    });
    assert_eq!(verdict_of(&always, &never, &quick()), Verdict::Different);
    assert_eq!(verdict_of(&always, &late, &quick()), Verdict::Different);
    let report = compare(&always, &late, &quick()).unwrap();
    let e = field(&report, "/x", "e");
    assert_eq!(
        (e.not_numbers, e.beyond, e.first_different),
        (5_000, 5_000, Some(0.0))
    );
}

#[test]
fn infinity_is_equal_to_itself_only() {
    let directory = tempdir().unwrap();
    let with =
        |name: &str, x: &'static str| numbers(&directory, name, &[("/x", &[(0, x), (1, x)])]);
    let one = with("one.mcap", r#"{"x":1}"#);
    let infinite = with("infinite.mcap", r#"{"x":Infinity}"#);
    let negative = with("negative.mcap", r#"{"x":-Infinity}"#);
    let nan = with("nan.mcap", r#"{"x":NaN}"#);
    let mut tolerant = quick();
    tolerant.tolerances.general.rel = 1e-3;
    tolerant.tolerances.general.ulp = 1000;
    for (a, b) in [
        (&one, &infinite),
        (&infinite, &negative),
        (&infinite, &nan),
        (&one, &nan),
    ] {
        assert_eq!(verdict_of(a, b, &tolerant), Verdict::Different);
    }
    assert_eq!(
        verdict_of(&infinite, &infinite, &quick()),
        Verdict::Identical
    );
}

#[test]
fn files_may_have_one_topic_after_the_other() {
    let directory = tempdir().unwrap();
    let (x, y) = (every(10, 0..20_000), every(10, 0..20_000));
    let topics = [("/x", x.as_slice()), ("/y", y.as_slice())];
    let (a, b) = (
        numbers(&directory, "a.mcap", &topics),
        numbers(&directory, "b.mcap", &topics),
    );
    assert_eq!(verdict_of(&a, &b, &quick()), Verdict::Identical);
    let mut mixed = x.clone();
    mixed.swap(3, 700);
    mixed.swap(4, 5);
    let (a, b) = (
        numbers(&directory, "c.mcap", &[("/x", &mixed)]),
        numbers(&directory, "d.mcap", &[("/x", &x)]),
    );
    // The sequence numbers are those of the other order.
    assert_eq!(verdict_of(&a, &b, &quick()), Verdict::SameValues);
}

/// A message of a file of others: its topic, time in ns, and bytes.
type Raw<'a> = (&'a str, u64, Vec<u8>);

/// An MCAP file in which all channels have one encoding and none a schema.
fn file_of(
    directory: &tempfile::TempDir,
    name: &str,
    encoding: &str,
    messages: &[Raw<'_>],
) -> Recording {
    let path = directory.path().join(name);
    let file = std::io::BufWriter::new(fs::File::create(&path).unwrap());
    let mut writer = mcap::WriteOptions::new()
        .library("test")
        .create(file)
        .unwrap();
    for (sequence, (topic, log_time, data)) in messages.iter().enumerate() {
        // A channel that is there already is given again.
        let nothing = std::collections::BTreeMap::new();
        let channel_id = writer.add_channel(0, topic, encoding, &nothing).unwrap();
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: sequence as u32,
            log_time: *log_time,
            publish_time: *log_time,
        };
        writer.write_to_known_channel(&header, data).unwrap();
    }
    writer.finish().unwrap();
    Recording::open(&path).unwrap()
}

/// A hundred messages, 10 ms apart, of JSON that depends on their number.
fn hundred(start_ns: u64, text: impl Fn(u64) -> String) -> Vec<Raw<'static>> {
    let message = |i| ("/x", start_ns + i * 10_000_000, text(i).into_bytes());
    (0..100).map(message).collect()
}

#[test]
fn what_is_no_double_is_compared_too() {
    let directory = tempdir().unwrap();
    let file = |name: &str, messages: &[Raw<'_>]| file_of(&directory, name, "json", messages);
    let other_in_50 = |one: &str, other: &str| {
        let a = file("a.mcap", &hundred(0, |_| one.to_owned()));
        let text = |i| if i == 50 { other } else { one }.to_owned();
        let b = file("b.mcap", &hundred(0, text));
        let mut tolerant = quick();
        tolerant.tolerances.general.rel = 1e-9;
        tolerant.tolerances.general.ulp = 4;
        // Large integers that lie within the tolerance are the only ones that are equal.
        let tolerated = compare(&a, &b, &tolerant).unwrap().verdict;
        (verdict_of(&a, &b, &quick()), tolerated)
    };
    for (one, other) in [
        (r#"{"x":1,"s":"RUN"}"#, r#"{"x":1,"s":"ERR"}"#),
        (r#"{"x":true}"#, r#"{"x":false}"#),
        (r#"{"x":1}"#, r#"{"x":"1"}"#),
        (r#"{"x":1,"y":null}"#, r#"{"x":1}"#),
        (r#"{"x":1,"y":[]}"#, r#"{"x":1,"y":{"a":[]}}"#),
        (r#"{"x":1,"x":2}"#, r#"{"x":3,"x":2}"#),
        (r#"{"x":1}"#, r#"{"x":1"#),
        (r#"{"x":9007199254740993}"#, r#"{"x":"9007199254740993"}"#),
        (r#""RUN""#, r#""ERR""#),
        (r#"{"x":NaN}"#, r#"{"x":null}"#),
        (
            r#"{"x":18446744073709551616}"#,
            r#"{"x":18446744073709551617}"#,
        ),
        (r#"{"x":0.1}"#, r#"{"x":0.1000000000000000000000001}"#),
        (r#"{"x":{}}"#, r#"{"x":[]}"#),
        (r#"{"x":{"p.q":1}}"#, r#"{"x":{"p":{"q":1}}}"#),
        (r#"{"x":{"0":1}}"#, r#"{"x":[1]}"#),
        (r#"{"n":1e308}"#, r#"{"n":-1e308}"#),
    ] {
        let found = other_in_50(one, other);
        assert_eq!(
            found,
            (Verdict::Different, Verdict::Different),
            "{one} {other}"
        );
    }
    let large = other_in_50(r#"{"x":9007199254740992}"#, r#"{"x":9007199254740993}"#);
    assert_eq!(large, (Verdict::Different, Verdict::Equal));
    // The same value, written in another way.
    let alike = other_in_50(r#"{"x":1,"y":"a"}"#, r#"{ "y":"\u0061", "x":1.0 }"#);
    assert_eq!(alike, (Verdict::Equal, Verdict::Equal));
    let report = compare(
        &file(
            "a.mcap",
            &hundred(0, |i| format!(r#"{{"n":{}}}"#, u64::MAX - i)),
        ),
        &file(
            "b.mcap",
            &hundred(0, |i| format!(r#"{{"n":{}}}"#, u64::MAX - i - i / 99)),
        ),
        &quick(),
    );
    let report = report.unwrap();
    let n = field(&report, "/x", "n");
    assert_eq!((n.beyond, n.largest, n.first_beyond), (1, -1.0, Some(0.99)));
}

#[test]
fn what_differs_beside_equal_values_is_told() {
    let directory = tempdir().unwrap();
    let file = |name: &str, encoding: &str, messages: &[Raw<'_>]| {
        file_of(&directory, name, encoding, messages)
    };
    let text = |text: &'static str| hundred(0, move |_| text.to_owned());
    let a = file("a.mcap", "json", &text(r#"{"x":1}"#));
    let summary = |a: &Recording, b: &Recording| {
        let report = compare(a, b, &quick()).unwrap();
        (report.verdict, report.summary[0].clone())
    };
    let spaced = file("spaced.mcap", "json", &text(r#"{"x": 1}"#));
    assert_eq!(
        summary(&a, &spaced),
        (
            Verdict::SameValues,
            "The same values: 100 messages in 1 topic. What differs beside them: the bytes of 100 messages."
                .to_owned()
        )
    );
    // Another message first moves the sequence numbers.
    let mut more = text(r#"{"x":1}"#);
    more.insert(0, ("/y", 0, b"1".to_vec()));
    let mut last = text(r#"{"x":1}"#);
    last.push(("/y", 0, b"1".to_vec()));
    let [first, last] =
        [("f.mcap", more), ("l.mcap", last)].map(|(name, of)| file(name, "json", &of));
    let (_, told) = summary(&first, &last);
    assert!(
        told.ends_with("the sequence numbers of 101 messages."),
        "{told}"
    );
    // Equal bytes of other encodings are not equal.
    let [x, y] = ["msgpack", "cbor"].map(|encoding| file(encoding, encoding, &text("1")));
    assert_eq!(summary(&x, &y).0, Verdict::Different);
    // More than a double holds.
    let [x, y] = [("x", r#"{"n":1e308}"#), ("y", r#"{"n":-1e308}"#)]
        .map(|(name, one)| file(name, "json", &text(one)));
    let (_, told) = summary(&x, &y);
    assert!(
        told.contains("by more than 1.80e308") || told.contains("by more than 1.8e308"),
        "{told}"
    );
}

#[test]
fn a_file_that_was_not_closed_is_not_whole() {
    let directory = tempdir().unwrap();
    let a = file_of(
        &directory,
        "a.mcap",
        "json",
        &hundred(0, |_| r#"{"x":1}"#.to_owned()),
    );
    let bytes = fs::read(a.path()).unwrap();
    let end = records(&bytes);
    let (_, data_end) = end
        .iter()
        .find(|(opcode, _)| *opcode == mcap::records::op::DATA_END)
        .unwrap();
    let cut = directory.path().join("cut.mcap");
    fs::write(&cut, &bytes[..data_end.start]).unwrap();
    let report = compare(&a, &Recording::open(&cut).unwrap(), &quick()).unwrap();
    assert_eq!(
        (report.verdict, report.is_complete),
        (Verdict::Agreeing, false)
    );
    assert!(report.summary[0].starts_with("All that could be read of both is the same"));
}

#[test]
fn messages_that_do_not_fit_the_table_are_compared_by_their_bytes() {
    let directory = tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let scenario = short(&[("stop.duration", "0.5")]);
    let whole = recorded(&path("a.mcap"), &scenario, Encoding::Json);
    let changed = |name: &str, to: &'static str| {
        with_other_bytes(&path("a.mcap"), &path(name), move |topic, time, data| {
            if topic == STATE.name() && time == 200_000_000 {
                let text = String::from_utf8(data.clone()).unwrap();
                *data = text.replacen("\"theta\":", to, 1).into_bytes();
            }
        })
    };
    let [b, c] = [
        ("b.mcap", "\"theta\":null,\"t\":"),
        ("c.mcap", "\"more\":1,\"theta\":"),
    ]
    .map(|(name, to)| changed(name, to));
    for (x, y) in [(&whole, &b), (&b, &whole), (&b, &c)] {
        let report = compare(x, y, &quick()).unwrap();
        assert_eq!(
            (report.verdict, report.is_complete),
            (Verdict::Different, true),
            "{:?}",
            report.summary
        );
        let found = channel(&report, STATE.name()).bytes.clone().unwrap();
        assert_eq!((found.count, found.time), (1, 0.2));
    }
    let again = changed("d.mcap", "\"theta\":null,\"t\":");
    assert_eq!(verdict_of(&b, &again, &quick()), Verdict::Identical);
}

#[test]
fn other_encodings_are_compared_byte_by_byte() {
    let directory = tempdir().unwrap();
    let bytes = |at: usize, byte: u8| -> Vec<Raw<'_>> {
        let mut messages: Vec<Raw<'_>> = (0..20).map(|i| ("/x", i, vec![i as u8; 50])).collect();
        messages[5].2[at] = byte;
        messages
    };
    let file = |name: &str, messages: &[Raw<'_>]| file_of(&directory, name, "flatbuffer", messages);
    let (a, b) = (file("a.mcap", &bytes(0, 5)), file("b.mcap", &bytes(7, 9)));
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    // Neither file is damaged, and the encoding is told once.
    assert!(report.is_complete && report.a.losses.is_empty() && report.b.losses.is_empty());
    let notes: Vec<_> = report
        .notes
        .iter()
        .filter(|note| note.contains("flatbuffer"))
        .collect();
    assert_eq!(notes.len(), 1, "{notes:?}");
    let found = channel(&report, "/x").bytes.clone().unwrap();
    assert_eq!(
        (found.count, found.offset, found.length_a),
        (1, 7, Some(50))
    );
    assert_eq!(channel(&report, "/x").identical, 19);
    let same = file("c.mcap", &bytes(0, 5));
    assert_eq!(verdict_of(&a, &same, &quick()), Verdict::Identical);
    let shorter = file("d.mcap", &bytes(0, 5)[..19]);
    assert_eq!(verdict_of(&a, &shorter, &quick()), Verdict::Different);
}

#[test]
fn clocks_may_jitter_be_shifted_or_mean_nothing() {
    let directory = tempdir().unwrap();
    let file = |name: &str, messages: &[Raw<'_>]| file_of(&directory, name, "json", messages);
    let text = |i| format!(r#"{{"x":{i}.5,"mode":{}}}"#, i / 10);
    let plain = hundred(50_000_000, text);
    let mut jittering = plain.clone();
    for (at, (_, time, _)) in jittering.iter_mut().enumerate() {
        *time = *time + at as u64 * 7_919_317 % 4_000_000 - 2_000_000;
    }
    let (a, b) = (file("a.mcap", &plain), file("b.mcap", &jittering));
    // Nothing is interpolated for it, and nothing is called equal.
    let error = compare(&a, &b, &quick()).unwrap_err();
    assert!(error.to_string().contains("--max-dt"), "{error}");
    let within = |ns: u64| Options {
        max_dt: Some(ns),
        ..quick()
    };
    assert_eq!(verdict_of(&a, &b, &within(2_000_000)), Verdict::Equal);
    let report = compare(&a, &b, &within(1_000_000)).unwrap();
    let found = channel(&report, "/x");
    assert_eq!(report.verdict, Verdict::Different);
    assert!(found.pairs < 70 && found.pairs + found.only_in_a + found.beyond_in_a == 100);
    let by_index = Options {
        align: Align::Index,
        ..quick()
    };
    assert_eq!(verdict_of(&a, &b, &by_index), Verdict::Equal);
    let short = file("short.mcap", &jittering[..99]);
    assert_eq!(verdict_of(&a, &short, &by_index), Verdict::Different);
    // The same messages, 23 years later.
    let late = file("late.mcap", &hundred(1_700_000_000_123_456_789, text));
    let offset = |offset| Options { offset, ..quick() };
    assert_eq!(
        verdict_of(&a, &late, &offset(Offset::Start)),
        Verdict::Equal
    );
    assert_eq!(verdict_of(&a, &late, &by_index), Verdict::Equal);
    let by = 50_000_000 - 1_700_000_000_123_456_789;
    let report = compare(&a, &late, &offset(Offset::By(by))).unwrap();
    assert_eq!(report.verdict, Verdict::Equal);
    let report = compare(&late, &a, &offset(Offset::By(-by))).unwrap();
    assert_eq!(report.verdict, Verdict::Equal);
    let clock = report.clock.unwrap();
    assert_eq!(
        clock.origin.as_deref(),
        Some("2023-11-14T22:13:20.123456789Z")
    );
    assert_eq!(clock.offset_ns, -by);
}

#[test]
fn times_since_1970_are_exact() {
    let directory = tempdir().unwrap();
    let start = 1_700_000_000_123_456_789;
    let with = |name: &str, x: &str| {
        let mut messages = hundred(start, |_| r#"{"x":1.5}"#.to_owned());
        messages[42] = ("/x", start + 420_000_001, x.as_bytes().to_vec());
        file_of(&directory, name, "json", &messages)
    };
    let (a, b) = (
        with("a.mcap", r#"{"x":1.5}"#),
        with("b.mcap", r#"{"x":2.5}"#),
    );
    let report = compare(&a, &b, &quick()).unwrap();
    let x = field(&report, "/x", "x");
    assert_eq!((x.at, x.first_beyond), (0.420_000_001, Some(0.420_000_001)));
    assert_eq!(report.clock.unwrap().origin_ns, start as i64);
    assert_eq!(report.a.first_ns, Some(start));
}

#[test]
fn only_what_is_continuous_is_interpolated() {
    let directory = tempdir().unwrap();
    // x rises evenly; the mode and the text change at 500 ms.
    let at = |ms: u64| {
        let is_late = ms >= 500;
        let (mode, text) = if is_late { (2, "late") } else { (1, "early") };
        let x = ms as f64 / 8.0 + 0.0625;
        format!(r#"{{"x":{x},"mode":{mode},"on":{is_late},"text":"{text}"}}"#)
    };
    let file = |name: &str, step: u64, start: u64| {
        let times = (start..1000).step_by(step as usize);
        let messages: Vec<_> = times
            .map(|ms| ("/x", ms * 1_000_000, at(ms).into_bytes()))
            .collect();
        file_of(&directory, name, "json", &messages)
    };
    let (a, b) = (file("a.mcap", 10, 0), file("b.mcap", 25, 3));
    // Roundings of what lies on a straight line.
    let mut options = quick();
    options.tolerances.add("/x.x=1e-12").unwrap();
    let report = compare(&a, &b, &options).unwrap();
    // The last mode of A before 503 ms is that of 500 ms.
    assert_eq!(report.verdict, Verdict::Agreeing, "{:?}", report.summary);
    let found = channel(&report, "/x");
    assert_eq!((found.pairs, found.between_in_a), (40, 100));
    // At equal rates nothing is.
    let c = file("c.mcap", 10, 3);
    assert!(matches!(
        compare(&a, &c, &quick()),
        Err(DiffError::NoCommonTimes)
    ));
}

#[test]
fn duplicates_and_messages_out_of_order_are_counted() {
    let directory = tempdir().unwrap();
    let plain = hundred(0, |i| format!("{{\"x\":{i}}}"));
    let mut mixed = plain.clone();
    mixed.swap(20, 60);
    mixed.insert(10, mixed[9].clone());
    let a = file_of(&directory, "a.mcap", "json", &plain);
    let b = file_of(&directory, "b.mcap", "json", &mixed);
    let report = compare(&a, &b, &quick()).unwrap();
    let found = channel(&report, "/x");
    // The repeated message has no counterpart; the others have, wherever they stand.
    assert_eq!((found.pairs, found.only_in_b, found.only_in_a), (100, 1, 0));
    let [a, b] = [&found.times_a, &found.times_b].map(|times| times.clone().unwrap());
    assert_eq!((a.duplicates, a.out_of_order), (0, 0));
    assert_eq!((b.duplicates, b.out_of_order), (1, 40));
    assert!((a.rate.unwrap() - 100.0).abs() < 1e-9);
    assert_eq!(a.longest_gap, Some(0.01));
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("behind later ones"))
    );
}

#[test]
fn signs_of_zero_and_bits_of_nan_are_told_for_their_field() {
    let directory = tempdir().unwrap();
    let with = |name: &str, text: &str| {
        file_of(&directory, name, "json", &hundred(0, |_| text.to_owned()))
    };
    let a = with(
        "a.mcap",
        r#"{"z":0.0,"max":1.7976931348623157e308,"n":NaN}"#,
    );
    let b = with(
        "b.mcap",
        r#"{"z":-0.0,"max":1.7976931348623157e308,"n":NaN}"#,
    );
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Equal);
    assert_eq!(field(&report, "/x", "z").signs_of_zero, 100);
    let others = ["max", "n"].map(|name| field(&report, "/x", name));
    assert!(others.iter().all(|field| field.first_different.is_none()));
    // The largest double is not infinite because there is no number beside it.
    assert_eq!(others[0].scale, f64::MAX);
    let c = with("c.mcap", r#"{"z":0.0,"max":Infinity,"n":NaN}"#);
    assert_eq!(verdict_of(&a, &c, &quick()), Verdict::Different);
}

#[test]
fn messages_of_ros_2_are_compared() {
    let report = compare(&foreign("ros2_a"), &foreign("ros2_b"), &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let fields = report.signals.fields();
    let differing = fields.filter(|(_, field)| field.beyond > 0);
    let differing: Vec<_> = differing
        .map(|(_, field)| (&*field.field, field.beyond, field.first_beyond.unwrap()))
        .collect();
    let expected = [
        ("ticks", 25, 1.5),
        ("name", 1, 0.66),
        ("joints.1", 1, 1.0),
        ("image", 1, 1.2),
    ];
    assert_eq!(differing, expected);
    let found = channel(&report, "/robot");
    assert_eq!((found.pairs, found.compared_bytes), (100, 0));
}

/// A file that is written again, in which a message is changed.
fn with_other_bytes(from: &Path, to: &Path, change: impl Fn(&str, u64, &mut Vec<u8>)) -> Recording {
    rewritten_messages(from, to, |mut message| {
        let mut data = message.data.to_vec();
        change(&message.channel.topic, message.log_time, &mut data);
        message.data = data.into();
        vec![message]
    })
}

/// A recording with other messages instead of each.
fn rewritten_messages(
    from: &Path,
    to: &Path,
    change: impl Fn(mcap::Message<'static>) -> Vec<mcap::Message<'static>>,
) -> Recording {
    let bytes = fs::read(from).unwrap();
    let whole = Recording::open(from).unwrap();
    let file = std::io::BufWriter::new(fs::File::create(to).unwrap());
    let mut writer = mcap::WriteOptions::new()
        .library(whole.library())
        .create(file)
        .unwrap();
    for (name, entries) in whole.all_metadata() {
        let metadata = mcap::records::Metadata {
            name: name.to_owned(),
            metadata: entries.clone(),
        };
        writer.write_metadata(&metadata).unwrap();
    }
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let message = message.unwrap();
        let owned = mcap::Message {
            data: message.data.into_owned().into(),
            channel: message.channel,
            ..message
        };
        for message in change(owned) {
            writer.write(&message).unwrap();
        }
    }
    writer.finish().unwrap();
    Recording::open(to).unwrap()
}

#[test]
fn view_channels_count_if_nothing_else_differs() {
    let directory = tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let scenario = short(&[("stop.duration", "0.5")]);
    let whole = recorded(&path("a.mcap"), &scenario, Encoding::Protobuf);
    let same = with_other_bytes(&path("a.mcap"), &path("same.mcap"), |_, _, _| {});
    let report = compare(&whole, &same, &quick()).unwrap();
    let messages: u64 = report.signals.channels.iter().map(|c| c.pairs).sum();
    assert_eq!(
        report.summary,
        [format!(
            "The same values: {messages} messages in 19 topics. What differs beside them: the attachment scenario.toml."
        )]
    );
    assert_eq!(report.verdict, Verdict::SameValues);
    let turned = with_other_bytes(&path("a.mcap"), &path("b.mcap"), |topic, time, data| {
        if topic == "/tf" && time == 200_000_000 {
            *data.last_mut().unwrap() ^= 1;
        }
    });
    let report = compare(&whole, &turned, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different, "{:?}", report.summary);
    assert_eq!(report.signals.channels.len(), 19);
    let found = channel(&report, "/tf").bytes.clone().unwrap();
    assert_eq!((found.count, found.time), (1, 0.2));
    // Of another run they follow.
    let other = recorded(
        &path("c.mcap"),
        &short(&[("stop.duration", "0.5"), ("friction.k", "0.04")]),
        Encoding::Protobuf,
    );
    let report = compare(&whole, &other, &quick()).unwrap();
    assert_eq!(report.signals.channels.len(), 10);
}

/// In a recording of toprise each message has a place of its own: what comes twice, or says that it has another place, is
/// a difference and no damage.
#[test]
fn messages_that_repeat_others_are_a_difference() {
    let directory = tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let scenario = short(&[("stop.duration", "0.5")]);
    let whole = recorded(&path("a.mcap"), &scenario, Encoding::Json);
    let is_it = |message: &mcap::Message<'_>| {
        message.channel.topic == STATE.name() && message.log_time == 200_000_000
    };
    let twice = rewritten_messages(&path("a.mcap"), &path("twice.mcap"), |message| {
        let copies = if is_it(&message) { 2 } else { 1 };
        vec![message; copies]
    });
    let moved = rewritten_messages(&path("a.mcap"), &path("moved.mcap"), |mut message| {
        message.sequence += if is_it(&message) { 7 } else { 0 };
        vec![message]
    });
    for (other, expected) in [
        (
            &twice,
            "What both have is the same, but B has 1 message that A has not (/top/state), first at 0.2 s.",
        ),
        (
            &moved,
            "No number differs, but the sequence numbers of 1 message differ (/top/state).",
        ),
    ] {
        let report = compare(&whole, other, &quick()).unwrap();
        assert_eq!(report.summary[0], expected);
        assert_eq!(
            (report.verdict, report.is_complete),
            (Verdict::Different, true)
        );
        assert_eq!(report.b.losses, [""; 0]);
        assert_eq!(verdict_of(other, &whole, &quick()), Verdict::Different);
        assert_equal_to_itself(other);
        let mut tolerant = quick();
        tolerant.tolerances.general.abs = 1.0;
        assert_eq!(verdict_of(&whole, other, &tolerant), Verdict::Different);
        // The story is that of the messages that are in their places.
        let story = |run: &toprise::analysis::diff::ComparedRun| run.course.clone().unwrap();
        assert_eq!(story(&report.a).rise_time, story(&report.b).rise_time);
    }
    let report = compare(&whole, &twice, &quick()).unwrap();
    assert!(
        report.notes[0].contains("B: 1 message that repeats another or goes back in time"),
        "{:?}",
        report.notes
    );
}

/// What stands beside the messages of two files, which are the same.
#[test]
fn the_same_values_are_identical_only_if_all_else_is() {
    let directory = tempdir().unwrap();
    let with = |name: &str, metadata: &[(&str, &str)], attachment: &[u8], channel: &str| {
        let path = directory.path().join(name);
        let file = std::io::BufWriter::new(fs::File::create(&path).unwrap());
        let mut writer = mcap::WriteOptions::new()
            .library("test")
            .create(file)
            .unwrap();
        for (name, value) in metadata {
            let metadata = mcap::records::Metadata {
                name: (*name).to_owned(),
                metadata: [("key".to_owned(), (*value).to_owned())].into(),
            };
            writer.write_metadata(&metadata).unwrap();
        }
        let attachment = mcap::Attachment {
            log_time: 0,
            create_time: 0,
            name: "notes".to_owned(),
            media_type: "text/plain".to_owned(),
            data: attachment.to_vec().into(),
        };
        writer.attach(&attachment).unwrap();
        let metadata = [("of".to_owned(), channel.to_owned())].into();
        let channel_id = writer.add_channel(0, "/x", "json", &metadata).unwrap();
        let header = mcap::records::MessageHeader {
            channel_id,
            sequence: 0,
            log_time: 0,
            publish_time: 0,
        };
        writer.write_to_known_channel(&header, b"1").unwrap();
        writer.finish().unwrap();
        Recording::open(&path).unwrap()
    };
    let twice = [("m", "1"), ("m", "2")];
    let a = with("a.mcap", &twice, b"one", "x");
    for (name, other, expected) in [
        ("same.mcap", (&twice, &b"one"[..], "x"), ""),
        (
            "b.mcap",
            (&[("m", "1"), ("m", "3")], b"one", "x"),
            "the metadata m (2): key",
        ),
        ("c.mcap", (&twice, b"two", "x"), "the attachment notes"),
        ("d.mcap", (&twice, b"one", "y"), "the channels of /x"),
    ] {
        let (metadata, attachment, channel) = other;
        let b = with(name, metadata, attachment, channel);
        let report = compare(&a, &b, &quick()).unwrap();
        let (verdict, told) = if expected.is_empty() {
            (
                Verdict::Identical,
                "Identical, bit for bit: 1 message in 1 topic.".to_owned(),
            )
        } else {
            (
                Verdict::SameValues,
                format!(
                    "The same values: 1 message in 1 topic. What differs beside them: {expected}."
                ),
            )
        };
        assert_eq!((report.verdict, report.summary), (verdict, vec![told]));
    }
}

#[test]
fn means_of_large_differences_are_numbers() {
    let directory = tempdir().unwrap();
    let [a, b] = [("a.mcap", "3e200"), ("b.mcap", "-1e200")].map(|(name, number)| {
        let text = format!("{{\"n\":{number}}}");
        file_of(&directory, name, "json", &hundred(0, |_| text.clone()))
    });
    let report = compare(&a, &b, &quick()).unwrap();
    let n = field(&report, "/x", "n");
    let relative = |found: f64, expected: f64| (found / expected - 1.0).abs();
    assert!(relative(n.rms, 4e200) < 1e-14, "{}", n.rms);
    assert!(relative(n.mean, -4e200) < 1e-14, "{}", n.mean);
}

/// Near upright the averages of θ hardly change, so they don't tell one nutation from the next.
#[test]
fn nutations_near_upright_are_matched_in_their_order() {
    let lifecycle = |k: &str| {
        let mut values = toprise::run::scenario::Preset::find("lifecycle")
            .unwrap()
            .values()
            .unwrap();
        values.set("friction.k", k).unwrap();
        values.set("sampling.period", "0.01").unwrap();
        Scenario::new(values).unwrap()
    };
    let report = compare(&lifecycle("0.03"), &lifecycle("0.0301"), &quick()).unwrap();
    for kind in report.happened.unwrap().kinds {
        assert_eq!(kind.matched, kind.count_a, "{kind:?}");
        assert_eq!(kind.matched, kind.count_b, "{kind:?}");
        // The fall is 42 ms earlier; a nutation takes 190 ms.
        assert!(kind.largest_shift.unwrap().abs() < 0.19, "{kind:?}");
    }
}

/// A few kilobytes that become more than a gigabyte.
#[test]
fn what_grows_without_end_is_read_to_a_bound() {
    let directory = tempdir().unwrap();
    let with = |name: &str, last: u8| {
        let path = directory.path().join(name);
        let file = std::io::BufWriter::new(fs::File::create(&path).unwrap());
        let mut writer = mcap::WriteOptions::new()
            .chunk_size(Some(1))
            .create(file)
            .unwrap();
        let nothing = std::collections::BTreeMap::new();
        let channel_id = writer.add_channel(0, "/x", "zeros", &nothing).unwrap();
        for log_time in 0..40 {
            let header = mcap::records::MessageHeader {
                channel_id,
                sequence: 0,
                log_time,
                publish_time: 0,
            };
            let mut data = vec![0; 30_000_000];
            data[0] = last;
            writer.write_to_known_channel(&header, &data).unwrap();
        }
        writer.finish().unwrap();
        Recording::open(&path).unwrap()
    };
    let a = with("a.mcap", 0);
    assert!(a.size() < 200_000, "{}", a.size());
    let report = compare(&a, &with("b.mcap", 1), &quick()).unwrap();
    assert!(
        report.a.losses[0].contains("1000 times as long"),
        "{:?}",
        report.a.losses
    );
    assert!(report.a.messages < 12, "{}", report.a.messages);
    assert_eq!(report.verdict, Verdict::Different);
    let report = compare(&a, &a, &quick()).unwrap();
    assert_eq!(
        (report.verdict, report.is_complete),
        (Verdict::Identical, false)
    );
}

#[test]
fn a_topic_may_have_two_kinds_of_messages() {
    let directory = tempdir().unwrap();
    let path = |name: &str| directory.path().join(name);
    let write = |name: &str, q: u64| {
        let file = std::io::BufWriter::new(fs::File::create(path(name)).unwrap());
        let mut writer = mcap::WriteOptions::new().create(file).unwrap();
        let nothing = std::collections::BTreeMap::new();
        let channels = ["A", "B"].map(|name| {
            let schema = writer.add_schema(name, "jsonschema", b"{}").unwrap();
            writer.add_channel(schema, "/x", "json", &nothing).unwrap()
        });
        for (log_time, channel_id) in [(1, 0), (1, 1), (2, 1), (3, 0)] {
            let header = mcap::records::MessageHeader {
                channel_id: channels[channel_id],
                sequence: 0,
                log_time,
                publish_time: log_time,
            };
            let data = [format!("{{\"v\":{log_time}}}"), format!("{{\"q\":{q}}}")];
            writer
                .write_to_known_channel(&header, data[channel_id].as_bytes())
                .unwrap();
        }
        writer.finish().unwrap();
        Recording::open(&path(name)).unwrap()
    };
    let (a, b, c) = (write("a.mcap", 1), write("b.mcap", 1), write("c.mcap", 2));
    assert_eq!(verdict_of(&a, &b, &quick()), Verdict::Identical);
    let report = compare(&a, &c, &quick()).unwrap();
    assert_eq!(
        (report.verdict, report.setup.schemas.len()),
        (Verdict::Different, 0)
    );
    assert_eq!(field(&report, "/x", "q").beyond, 2);
}

#[test]
fn files_without_messages_are_the_same() {
    let directory = tempdir().unwrap();
    let empty = |name: &str| file_of(&directory, name, "json", &[]);
    let (a, b) = (empty("a.mcap"), empty("b.mcap"));
    assert_eq!(verdict_of(&a, &b, &quick()), Verdict::Identical);
    let other = file_of(
        &directory,
        "c.mcap",
        "json",
        &hundred(0, |_| "{}".to_owned()),
    );
    assert!(compare(&a, &other, &quick()).is_err());
}

#[test]
fn times_may_be_as_far_apart_as_they_can_be() {
    let directory = tempdir().unwrap();
    let far = u64::MAX / 1_000_000;
    let with = |name: &str, times: [u64; 3]| {
        numbers(
            &directory,
            name,
            &[("/x", &times.map(|time| (time, r#"{"x":1}"#)))],
        )
    };
    let (a, b) = (with("a.mcap", [0, 5, far]), with("b.mcap", [1, 7, far - 1]));
    // Whatever it is, it is an answer.
    let _ = compare(&a, &b, &quick());
    assert_eq!(verdict_of(&a, &a, &quick()), Verdict::Identical);
}

#[test]
fn a_run_without_events_is_not_said_to_have_none() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("b.mcap");
    let full = scenario("full-coulomb", &[]);
    archive(
        &path,
        &full,
        &["/top/state", "/top/nutation"],
        Form::default(),
    )
    .unwrap();
    let b = Recording::open(&path).unwrap();
    let options = Options {
        topics: vec!["/top/state".to_owned()],
        ..quick()
    };
    let report = compare(&scenario("paper", &[]), &b, &options).unwrap();
    assert!(report.happened.as_ref().unwrap().kinds.is_empty());
    let summary = report.summary.join(" ");
    // The end record knows when it rose.
    assert!(
        summary.contains("In B θ first touches 0.0200 rad 11.6 ms later"),
        "{summary}"
    );
    assert!(!summary.contains("loops"), "{summary}");
    let course = report.b.course.unwrap();
    assert_eq!((course.spin_rate_last, course.nutations), (None, Some(515)));
}

#[test]
fn a_channel_that_lacks_a_field_shows_no_differences() {
    use toprise::analysis::diff::{Observer, compare_observed};
    struct Channels(Vec<usize>);
    impl Observer for Channels {
        fn difference(
            &mut self,
            message: &toprise::telemetry::Message<'_>,
        ) -> Result<(), toprise::archive::sink::SinkError> {
            let channel = &toprise::telemetry::channels()[message.channel];
            assert_eq!(message.numbers.len(), channel.numbers.len());
            self.0.push(message.channel);
            Ok(())
        }
    }
    let mut seen = Channels(Vec::new());
    let (a, b) = (
        short(&[("stop.duration", "0.1")]),
        short(&[("stop.duration", "0.1")]),
    );
    compare_observed(&a, &b, &quick(), &mut seen).unwrap();
    seen.0.sort_unstable();
    seen.0.dedup();
    assert!(seen.0.len() >= 8);
}

#[test]
fn a_floor_that_nobody_wants_any_more_is_not_computed() {
    use toprise::analysis::diff::{Observer, compare_observed};
    struct Wanting(bool);
    impl Observer for Wanting {
        fn carry_on(&self) -> Box<dyn Fn() -> bool + Send + Sync> {
            let is_wanted = self.0;
            Box::new(move || is_wanted)
        }
    }
    let runs = ["0.03", "0.04"].map(|k| short(&[("stop.duration", "0.1"), ("friction.k", k)]));
    for (a, b) in [(0, 0), (0, 1)] {
        let floor = |is_wanted| {
            let observer = &mut Wanting(is_wanted);
            let report = compare_observed(&runs[a], &runs[b], &Options::default(), observer);
            report.unwrap().floor
        };
        assert!(floor(true).is_some());
        assert_eq!(floor(false), None);
    }
}

#[test]
fn a_run_is_at_its_own_phase_and_average() {
    let scenario = short(&[]);
    for align in [Align::Nutation, Align::Theta] {
        let options = Options { align, ..quick() };
        let report = compare(&scenario, &scenario, &options).unwrap();
        assert_eq!(report.verdict, Verdict::Identical);
    }
}

#[test]
fn what_can_t_be_compared_is_refused() {
    let a = foreign("json_a");
    let refused = |b: &Recording, options: &Options| compare(&a, b, options).unwrap_err();
    let error = refused(&foreign("no_common"), &quick());
    assert!(matches!(error, DiffError::NoCommonTopics { .. }), "{error}");
    assert!(error.to_string().contains("/imu") && error.to_string().contains("/elsewhere"));
    let error = refused(&foreign("later"), &quick());
    assert!(matches!(error, DiffError::NoOverlap { .. }), "{error}");
    assert!(error.to_string().contains("1000"), "{error}");
    let b = foreign("json_b");
    let by_phase = Options {
        align: Align::Nutation,
        ..quick()
    };
    assert!(matches!(refused(&b, &by_phase), DiffError::Align { .. }));
    let mut patterned = quick();
    patterned
        .tolerances
        .add("/imu.angular_velocity.x=1")
        .unwrap();
    assert!(compare(&a, &b, &patterned).is_ok());
    patterned
        .tolerances
        .add("/imu.angular_velocty.z=1")
        .unwrap();
    let error = refused(&b, &patterned).to_string();
    assert!(error.contains("/imu.angular_velocity.z"), "{error}");
    let topics = Options {
        topics: vec!["/imux".to_owned()],
        ..quick()
    };
    assert!(matches!(
        refused(&b, &topics),
        DiffError::UnknownTopic { .. }
    ));
    // No nutation within 0.05 s.
    let tiny = short(&[("stop.duration", "0.05")]);
    let error = compare(&tiny, &tiny, &by_phase).unwrap_err();
    assert!(error.to_string().contains("at least 4"), "{error}");
}

#[test]
fn only_the_topics_that_are_asked_for_count() {
    let (a, b) = (foreign("json_a"), foreign("json_b"));
    let options = Options {
        topics: vec!["/empty".to_owned(), "/odom".to_owned()],
        tolerances: {
            let mut tolerances = toprise::analysis::diff::Tolerances::default();
            tolerances.add("*=1.1e-4").unwrap();
            tolerances
        },
        ..quick()
    };
    let report = compare(&a, &b, &options).unwrap();
    assert_eq!(report.verdict, Verdict::Agreeing, "{:?}", report.summary);
    assert_eq!(report.signals.channels.len(), 2);
}

// What can't be read as a whole.

#[test]
fn a_cut_recording_is_equal_so_far() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let path = directory.path().join("a.mcap");
    let whole = recorded(&path, &scenario, Encoding::Json);
    let bytes = fs::read(&path).unwrap();
    let cut_path = directory.path().join("cut.mcap");
    fs::write(&cut_path, &bytes[..bytes.len() * 2 / 3]).unwrap();
    let cut = Recording::open(&cut_path).unwrap();
    for (a, b) in [(&whole, &cut), (&cut, &whole)] {
        let report = compare(a, b, &quick()).unwrap();
        assert!(!report.is_complete);
        assert_eq!(report.verdict, Verdict::Agreeing, "{:?}", report.summary);
        assert!(
            report
                .summary
                .iter()
                .any(|sentence| sentence.contains("as a whole"))
        );
    }
    // Without an excuse, a shorter run is another one.
    let shorter = short(&[("stop.duration", "1.0")]);
    let report = compare(&whole, &shorter, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    assert!(report.is_complete);
    assert_eq!(channel(&report, "/top/state").beyond_in_a, 1000);
}

#[test]
fn a_flipped_bit_costs_a_chunk_and_no_more() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let path = directory.path().join("a.mcap");
    let whole = recorded(&path, &scenario, Encoding::Json);
    let mut bytes = fs::read(&path).unwrap();
    let chunks = records(&bytes).into_iter();
    let chunks: Vec<_> = chunks.filter(|(opcode, _)| *opcode == 6).collect();
    let (_, chunk) = &chunks[chunks.len() / 2];
    bytes[usize::midpoint(chunk.start, chunk.end)] ^= 1;
    let broken_path = directory.path().join("b.mcap");
    fs::write(&broken_path, &bytes).unwrap();
    let report = compare(&whole, &Recording::open(&broken_path).unwrap(), &quick()).unwrap();
    assert!(
        !report.is_complete && report.verdict != Verdict::Different,
        "{:?}",
        report.summary
    );
    assert!(channel(&report, "/top/state").only_in_a > 0);
    assert_eq!(report.b.losses.len(), 1);
}

#[test]
fn nothing_is_said_of_runs_of_which_nothing_can_be_read() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    recorded(&path, &short(&[]), Encoding::Json);
    let mut bytes = fs::read(&path).unwrap();
    for (opcode, content) in records(&bytes) {
        if opcode == 6 {
            bytes[usize::midpoint(content.start, content.end)] ^= 1;
        }
    }
    let broken = directory.path().join("b.mcap");
    fs::write(&broken, &bytes).unwrap();
    let broken = Recording::open(&broken).unwrap();
    let error = compare(&broken, &broken, &quick()).unwrap_err();
    assert!(
        matches!(error, DiffError::NoMessages { side: "A", .. }),
        "{error}"
    );
}

// Several runs, and the form of the report.

#[test]
fn three_runs_make_a_matrix() {
    let scenarios = ["0.02", "0.03", "0.04"].map(|k| short(&[("friction.k", k)]));
    let matrix = Matrix::new(3, |i, j| compare(&scenarios[i], &scenarios[j], &quick())).unwrap();
    assert_eq!(matrix.runs.len(), 3);
    assert_eq!(matrix.against_first.len(), 2);
    let distance = |i: usize, j: usize| matrix.theta_distance[i][j].unwrap();
    assert_eq!(distance(1, 1), 0.0);
    assert_eq!(distance(0, 2), distance(2, 0));
    // θ falls in proportion to k.
    let ratio = distance(0, 2) / distance(0, 1);
    assert!((ratio - 2.0).abs() < 0.05, "{ratio}");
}

#[test]
fn reports_have_no_gaps_in_json() {
    let report = compare(
        &short(&[]),
        &short(&[("friction.k", "0.04")]),
        &Options::default(),
    )
    .unwrap();
    let value = serde_json::to_value(&report).unwrap();
    fn numbers_are_there(path: &str, value: &Value, schema: &Value, root: &Value) {
        let reference = schema.get("$ref").and_then(Value::as_str);
        let schema = reference.map_or(schema, |name| root.pointer(&name[1..]).unwrap());
        let options = schema.get("anyOf").and_then(Value::as_array);
        if let Some(some) = options.and_then(|options| options.first()) {
            if !value.is_null() {
                numbers_are_there(path, value, some, root);
            }
            return;
        }
        match value {
            Value::Object(members) => {
                for (name, member) in members {
                    let inner = &schema["properties"][name];
                    assert!(!inner.is_null(), "{path}.{name} is not in the schema");
                    numbers_are_there(&format!("{path}.{name}"), member, inner, root);
                }
            }
            Value::Array(items) => {
                for item in items {
                    if let Some(inner) = schema.get("items") {
                        numbers_are_there(path, item, inner, root);
                    }
                }
            }
            // What is infinite or not a number becomes null: only where nothing may be there.
            Value::Null => {
                let kinds = schema["type"].as_array();
                assert!(
                    kinds.is_some_and(|kinds| kinds.contains(&"null".into())),
                    "{path} is null"
                );
            }
            _ => {}
        }
    }
    let schemas = toprise::cli::schemas();
    let of_reports = schemas
        .iter()
        .find(|(name, _)| name == "toprise.DiffReport.json");
    let schema: Value = serde_json::from_str(&of_reports.unwrap().1).unwrap();
    numbers_are_there("", &value, &schema, &schema);
}

// Whatever is in a file, it is equal to itself.

/// That a file is equal to itself, whatever is in it, unless nothing of it can be read.
#[track_caller]
fn assert_equal_to_itself(recording: &Recording) {
    let report = match compare(recording, recording, &quick()) {
        Err(DiffError::NoMessages { losses, .. }) if !losses.is_empty() => return,
        report => report.unwrap(),
    };
    assert_eq!(report.verdict, Verdict::Identical, "{:?}", report.summary);
    let channels = report.signals.channels.iter();
    for channel in channels.filter(|channel| channel.pairs > 0) {
        assert_eq!(channel.identical, channel.pairs, "{channel:?}");
    }
}

#[test]
fn a_recording_out_of_order_is_identical_to_itself() {
    let directory = tempdir().unwrap();
    let scenario = short(&[]);
    let a = recorded(&directory.path().join("a.mcap"), &scenario, Encoding::Json);
    let b = rewritten(&directory.path().join("b.mcap"), &scenario, |message| {
        if message.channel == STATE.index() && message.time_ns == 500_000_000 {
            message.time_ns = 300_000_000;
        }
    });
    let report = compare(&b, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Identical, "{:?}", report.summary);
    let other = compare(&a, &b, &quick()).unwrap();
    assert_eq!(other.verdict, Verdict::Different);
    // The message that goes back in time is told in either comparison.
    for report in [report, other] {
        assert!(report.is_complete);
        let notes = report.notes.join("\n");
        assert!(
            notes.contains("B: ")
                && notes.contains("back in time, the first in /top/state at t = 0.3 s"),
            "{notes}"
        );
    }
}

/// The records of a file: where each begins, its opcode, and where the next one begins.
fn records(bytes: &[u8]) -> Vec<(u8, std::ops::Range<usize>)> {
    let magic = 8;
    let mut records = Vec::new();
    let mut at = magic;
    while at + magic < bytes.len() {
        let length = u64::from_le_bytes(bytes[at + 1..at + 9].try_into().unwrap()) as usize;
        records.push((bytes[at], at..at + 9 + length));
        at += 9 + length;
    }
    records
}

#[derive(Clone, Debug)]
enum Harm {
    Flip(prop::sample::Index, u8),
    Cut(prop::sample::Index),
    Repeat(prop::sample::Index),
    Swap(prop::sample::Index, prop::sample::Index),
}

fn harm() -> impl Strategy<Value = Harm> {
    let place = any::<prop::sample::Index>;
    prop_oneof![
        (place(), 0..8_u8).prop_map(|(at, bit)| Harm::Flip(at, bit)),
        place().prop_map(Harm::Cut),
        place().prop_map(Harm::Repeat),
        (place(), place()).prop_map(|(one, other)| Harm::Swap(one, other)),
    ]
}

impl Harm {
    /// Harms a file with these chunks.
    fn apply(&self, bytes: &mut Vec<u8>, chunks: &[std::ops::Range<usize>]) {
        let chunk = |at: &prop::sample::Index| chunks[at.index(chunks.len())].clone();
        match self {
            Self::Flip(at, bit) => {
                let at = at.index(bytes.len());
                bytes[at] ^= 1 << bit;
            }
            Self::Cut(at) => bytes.truncate(at.index(bytes.len()).max(8)),
            Self::Repeat(at) => {
                let chunk = chunk(at);
                let copy = bytes[chunk.clone()].to_vec();
                bytes.splice(chunk.end..chunk.end, copy);
            }
            Self::Swap(one, other) => {
                let (mut first, mut second) = (chunk(one), chunk(other));
                if second.start < first.start {
                    std::mem::swap(&mut first, &mut second);
                }
                if first != second {
                    let swapped = [
                        &bytes[second.clone()],
                        &bytes[first.end..second.start],
                        &bytes[first.clone()],
                    ]
                    .concat();
                    bytes.splice(first.start..second.end, swapped);
                }
            }
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_damaged_recording_is_equal_to_itself(harms in prop::collection::vec(harm(), 1..4)) {
        static WHOLE: std::sync::LazyLock<Vec<u8>> = std::sync::LazyLock::new(|| {
            let directory = tempdir().unwrap();
            let path = directory.path().join("whole.mcap");
            recorded(&path, &short(&[("stop.duration", "0.3")]), Encoding::Json);
            fs::read(&path).unwrap()
        });
        let mut bytes = WHOLE.clone();
        for harm in &harms {
            let chunks: Vec<_> = records(&WHOLE).into_iter().filter(|(opcode, _)| *opcode == 6).map(|(_, at)| at).collect();
            // The chunks stand where they stood as long as the length is the same.
            if bytes.len() == WHOLE.len() {
                harm.apply(&mut bytes, &chunks);
            }
        }
        let directory = tempdir().unwrap();
        let path = directory.path().join("harmed.mcap");
        fs::write(&path, &bytes).unwrap();
        if let Ok(recording) = Recording::open(&path) {
            assert_equal_to_itself(&recording);
        }
    }

    /// Times in any order, repeated, with gaps; values that are numbers or not.
    #[test]
    fn any_file_is_equal_to_itself(
        topics in prop::collection::vec(prop::collection::vec((0..40_u64, 0..5_usize), 0..30), 1..4),
    ) {
        const VALUES: [&str; 5] = [
            r#"{"x":1}"#, r#"{"x":NaN,"y":2}"#, r#"{"y":-Infinity}"#, r#"{"z":[1,2],"x":0.5}"#, "{}",
        ];
        let messages: Vec<Vec<(u64, &str)>> = topics
            .iter()
            .map(|topic| topic.iter().map(|(time, value)| (*time, VALUES[*value])).collect())
            .collect();
        let names = ["/x", "/y", "/z"];
        let topics: Vec<(&str, &[(u64, &str)])> = names
            .into_iter()
            .zip(messages.iter().map(Vec::as_slice))
            .collect();
        let directory = tempdir().unwrap();
        assert_equal_to_itself(&numbers(&directory, "a.mcap", &topics));
    }
}

#[test]
fn inputs_that_fuzzing_found_are_equal_to_themselves() {
    let fuzz = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz");
    let directory = tempdir().unwrap();
    let whole = recorded(
        &directory.path().join("a.mcap"),
        &short(&[("stop.duration", "0.1")]),
        Encoding::Json,
    );
    let mut count = 0;
    for kind in ["corpus/recording", "regressions/recording"] {
        let Ok(files) = fs::read_dir(fuzz.join(kind)) else {
            continue;
        };
        for file in files {
            let path = file.unwrap().path();
            println!("{}", path.display());
            if let Ok(recording) = Recording::open(&path) {
                assert_equal_to_itself(&recording);
                // Whatever comes of it.
                let _ = compare(&whole, &recording, &quick());
                count += 1;
            }
        }
    }
    assert!(count > 10, "{count}");
}

// Large files.

/// As many topics would take minutes if each were looked for among all others, or looked at for each batch.
#[test]
fn sixty_thousand_topics_are_compared() {
    let directory = tempdir().unwrap();
    let names: Vec<String> = (0..60_000).map(|i| format!("/topic/{i}")).collect();
    let messages = [(1, r#"{"x":1}"#), (2, r#"{"x":2}"#)];
    let topics: Vec<_> = names
        .iter()
        .map(|name| (name.as_str(), &messages[..]))
        .collect();
    let a = numbers(&directory, "a.mcap", &topics);
    let b = numbers(&directory, "b.mcap", &topics[1..]);
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    assert_eq!(report.setup.topics_only_in_a, ["/topic/0"]);
    assert_eq!(report.signals.channels.len(), 59_999);
    assert!(
        report
            .signals
            .channels
            .iter()
            .all(|channel| channel.identical == 2)
    );
    assert_equal_to_itself(&a);
}

#[test]
fn no_more_fields_are_compared_than_memory_allows() {
    let directory = tempdir().unwrap();
    let fields: Vec<String> = (0..4096).map(|i| format!("\"{i}\":1")).collect();
    let message = format!("{{{}}}", fields.join(","));
    let messages = [(1, message.as_str())];
    let names: Vec<String> = (0..65).map(|i| format!("/topic/{i}")).collect();
    let topics: Vec<_> = names
        .iter()
        .map(|name| (name.as_str(), &messages[..]))
        .collect();
    let file = numbers(&directory, "a.mcap", &topics);
    let report = compare(&file, &file, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Identical);
    assert!(report.is_complete);
    assert!(
        report
            .notes
            .iter()
            .any(|note| note.contains("262144 fields"))
    );
    // The bytes of messages with other fields are compared instead.
    let other = message.replacen("\"7\":1", "\"7\":2", 1);
    let last = [(1, other.as_str())];
    let mut topics = topics.clone();
    topics[64].1 = &last;
    let other = numbers(&directory, "b.mcap", &topics);
    assert_eq!(verdict_of(&file, &other, &quick()), Verdict::Different);
    assert_eq!(report.signals.fields().count(), 1 << 18);
}
