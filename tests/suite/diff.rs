//! Comparing two runs.

mod agreeing;
mod edited;
mod findings;
mod nothing;
mod others;
mod values;
mod variation;

use crate::damage::chunks;
use crate::random_scenarios::{Random, free_tops};
use crate::support::{Folder, Run, archive, assert_contains, assert_near, in_memory, scenario};
use assert_cmd::Command;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use toprise::analysis::diff::{
    ChannelDifference, FieldDifference, Finding, Observer, Options, Quantity, Report, TopicBytes,
    Verdict, compare, compare_observed,
};
use toprise::archive::memory::Owned;
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::{Sink as _, SinkError};
use toprise::archive::writer::Form;
use toprise::run::scenario::Scenario;
use toprise::run::simulation::{EventKind, Regime, Sample};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::fields::{EVENTS, NUTATION, nutation, torque};
use toprise::telemetry::{Message, Telemetry};

fn quick() -> Options {
    Options {
        integration_error: false,
        ..Options::default()
    }
}

fn ignoring(pattern: &str) -> Options {
    let mut options = quick();
    options.tolerances.ignored.push(pattern.to_owned());
    options
}

fn tolerating(pattern: &str) -> Options {
    let mut options = quick();
    options.tolerances.add(pattern).unwrap();
    options
}

fn only(topic: &str) -> Options {
    Options {
        topics: vec![topic.to_owned()],
        ..quick()
    }
}

fn short(overrides: &[(&str, &str)]) -> Scenario {
    let mut all = vec![("stop.duration", "2.0")];
    all.extend_from_slice(overrides);
    scenario("paper", &all)
}

fn channel<'r>(report: &'r Report, topic: &str) -> &'r ChannelDifference {
    let mut channels = report.channels.iter();
    let found = channels.find(|channel| channel.topic == topic);
    found.unwrap_or_else(|| panic!("no {topic}"))
}

fn field<'r>(report: &'r Report, topic: &str, name: &str) -> &'r FieldDifference {
    let mut fields = channel(report, topic).fields.iter();
    let found = fields.find(|field| field.field == name);
    found.unwrap_or_else(|| panic!("no {topic}.{name}"))
}

/// The finding whose name begins so.
fn finding<'r>(report: &'r Report, what: &str) -> Option<&'r Finding> {
    let mut findings = report.findings.iter();
    findings.find(|finding| finding.quantity.label().to_string().starts_with(what))
}

fn values(report: &Report, what: &str) -> [Option<f64>; 2] {
    let found = finding(report, what).unwrap_or_else(|| panic!("no {what}"));
    [found.a, found.b]
}

fn recorded(folder: &Folder, name: &str, scenario: &Scenario, encoding: Encoding) -> Recording {
    let form = Form {
        encoding,
        ..Form::default()
    };
    let path = folder.at(name);
    archive(&path, scenario, &[], form).unwrap();
    Recording::open(&path).unwrap()
}

/// A recording of a run with some messages changed.
fn rewritten(
    folder: &Folder,
    name: &str,
    scenario: &Scenario,
    mut change: impl FnMut(&mut Owned),
) -> Recording {
    edited(folder, name, scenario, |messages| {
        for message in messages {
            change(message);
        }
    })
}

/// A recording of a run whose list of messages was edited.
fn edited(
    folder: &Folder,
    name: &str,
    scenario: &Scenario,
    edit: impl FnOnce(&mut Vec<Owned>),
) -> Recording {
    let path = folder.at(name);
    let (telemetry, form) = (Telemetry::default(), Form::default());
    let mut sink = McapSink::create(&path, Existing::Keep, scenario, &telemetry, form).unwrap();
    let (mut original, end) = in_memory(scenario);
    edit(&mut original.messages);
    for message in original.messages {
        sink.write(&message.as_message()).unwrap();
    }
    sink.finish(&end).unwrap();
    Recording::open(&path).unwrap()
}

fn data(name: &str) -> PathBuf {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    root.join("tests/data").join(name)
}

// Runs that are the same.

#[test]
fn run_is_identical_to_itself_in_any_encoding() {
    let folder = Folder::new();
    let scenario = short(&[]);
    let json = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    let protobuf = recorded(&folder, "b.mcap", &scenario, Encoding::Protobuf);
    let renamed = short(&[("name", "other")]);
    for (report, verdict) in [
        (compare(&json, &json, &quick()), Verdict::Identical),
        (compare(&scenario, &protobuf, &quick()), Verdict::Identical),
        (compare(&scenario, &scenario, &quick()), Verdict::Identical),
        (compare(&json, &protobuf, &quick()), Verdict::SameValues),
        (compare(&scenario, &renamed, &quick()), Verdict::SameValues),
    ] {
        let report = report.unwrap();
        assert_eq!(report.verdict, verdict);
        assert!(report.is_complete);
        let differences = report.findings.iter().filter_map(|f| f.difference);
        assert!(differences.into_iter().all(|difference| difference == 0.0));
    }
}

#[test]
fn finer_sampling_agrees_at_common_times() {
    let (coarse, fine) = (short(&[("sampling.period", "0.004")]), short(&[]));
    for (a, b, between) in [(&coarse, &fine, [0, 1500]), (&fine, &coarse, [1500, 0])] {
        let report = compare(a, b, &quick()).unwrap();
        assert_eq!(report.verdict, Verdict::Agreeing);
        let state = channel(&report, "/top/state");
        assert_eq!((state.pairs, state.identical), (501, 501));
        assert_eq!(state.between, between);
        assert_eq!(report.setup.scenario[0].key, "sampling.period");
    }
}

/// Of 0.7 ms and 1 ms neither is a multiple of the other: they have every 7 ms in common. Nothing that was not compared is
/// identical.
#[test]
fn pairs_samples_at_common_times() {
    let folder = Folder::new();
    let (a, b) = (short(&[]), short(&[("sampling.period", "0.0007")]));
    let of_a = recorded(&folder, "a.mcap", &a, Encoding::Json);
    let of_b = recorded(&folder, "b.mcap", &b, Encoding::Protobuf);
    for (name, report) in [
        ("scenarios", compare(&a, &b, &quick())),
        ("B recorded", compare(&a, &of_b, &quick())),
        ("A recorded", compare(&of_a, &b, &quick())),
        ("both recorded", compare(&of_a, &of_b, &quick())),
    ] {
        let report = report.unwrap();
        assert_eq!(report.verdict, Verdict::Agreeing, "{name}");
        let state = channel(&report, "/top/state");
        assert_eq!((state.pairs, state.identical), (286, 286), "{name}");
        assert_eq!(state.between, [1715, 2572], "{name}");
        assert_eq!(report.setup.scenario[0].key, "sampling.period");
    }
    let more = short(&[("sampling.period", "0.0007"), ("friction.k", "0.031")]);
    let report = compare(&a, &more, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
}

#[test]
fn cut_recording_agrees_up_to_the_cut() {
    let folder = Folder::new();
    let whole = recorded(&folder, "a.mcap", &short(&[]), Encoding::Json);
    let bytes = fs::read(whole.path()).unwrap();
    let path = folder.write("cut.mcap", &bytes[..bytes.len() * 2 / 3]);
    let cut = Recording::open(&path).unwrap();
    for (a, b) in [(&whole, &cut), (&cut, &whole)] {
        let report = compare(a, b, &quick()).unwrap();
        assert!(!report.is_complete);
        assert_eq!(report.verdict, Verdict::Agreeing);
    }
    // A whole run that is shorter is another one.
    let report = compare(&whole, &short(&[("stop.duration", "1.0")]), &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    assert_eq!(channel(&report, "/top/state").beyond, [1000, 0]);
}

#[test]
fn flipped_bit_loses_one_chunk() {
    let folder = Folder::new();
    let whole = recorded(&folder, "a.mcap", &short(&[]), Encoding::Json);
    let bytes = fs::read(whole.path()).unwrap();
    let chunks = chunks(&bytes);
    let damaged = |name: &str, damaged: &[std::ops::Range<usize>]| {
        let mut bytes = bytes.clone();
        for chunk in damaged {
            bytes[usize::midpoint(chunk.start, chunk.end)] ^= 1;
        }
        Recording::open(&folder.write(name, &bytes)).unwrap()
    };
    let middle = chunks.len() / 2;
    let one = damaged("one.mcap", &chunks[middle..=middle]);
    let report = compare(&whole, &one, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Agreeing);
    assert!(!report.is_complete && channel(&report, "/top/state").unmatched[0] > 0);
    assert_eq!(report.b.losses.len(), 1);
    let all = damaged("all.mcap", &chunks);
    let error = compare(&whole, &all, &quick()).unwrap_err();
    let error = error.to_string();
    assert!(error.starts_with("B has no readable messages ("), "{error}");
}

// Runs that differ.

#[test]
fn names_the_field_that_differs_by_one_ulp() {
    let folder = Folder::new();
    let scenario = short(&[]);
    let a = recorded(&folder, "a.mcap", &scenario, Encoding::Json);
    let changed = torque::FRICTION_BODY.y();
    let mut values = [0.0; 2];
    let b = rewritten(&folder, "b.mcap", &scenario, |message| {
        if message.channel == changed.topic().index() && message.time_ns == 123_000_000 {
            let number = &mut message.numbers[changed.index()];
            values = [*number, number.next_up()];
            *number = values[1];
        }
    });
    let report = compare(&a, &b, &quick()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let first = channel(&report, "/top/torque").first.as_ref().unwrap();
    assert_eq!(first.field, "friction_body.y");
    assert_eq!(first.time, 0.123);
    let found = [&first.a, &first.b].map(|text| text.parse::<f64>().unwrap());
    assert_eq!(found, values);
    let found = field(&report, "/top/torque", "friction_body.y");
    assert_eq!((found.beyond, found.largest), (1, values[1] - values[0]));
    for other in report.channels.iter().filter(|c| c.topic != "/top/torque") {
        assert!(other.first.is_none(), "{}", other.topic);
        assert_eq!(other.identical, other.pairs, "{}", other.topic);
    }
    let page = folder.toprise("diff a.mcap b.mcap --color never", 1).stdout;
    let row = format!(
        "friction_body.y at 0.123 s: {:?}, {:?}",
        values[0], values[1]
    );
    assert_contains(&page, &row);
    for pattern in ["/top/torque", "/top/torque.friction_body", "*.y"] {
        let report = compare(&a, &b, &ignoring(pattern)).unwrap();
        assert_eq!(report.verdict, Verdict::Equal, "{pattern}");
    }
    let equal = compare(&a, &b, &tolerating("*=rel:1e-15")).unwrap();
    assert_eq!(equal.verdict, Verdict::Equal);
    let elsewhere = compare(&a, &b, &tolerating("/top/state=1")).unwrap();
    assert_eq!(elsewhere.verdict, Verdict::Different);
    let other_topic = compare(&a, &b, &only("/top/state")).unwrap();
    assert_eq!(other_topic.verdict, Verdict::Equal);
    assert_eq!(other_topic.channels.len(), 1);
}

#[test]
fn changed_event_differs_at_any_tolerance() {
    let folder = Folder::new();
    let scenario = short(&[]);
    let mut times = Vec::new();
    let b = rewritten(&folder, "b.mcap", &scenario, |message| {
        if message.channel == EVENTS.index() && message.sequence == 3 {
            times.push(message.time_ns as f64 / 1e9);
            message.texts[0] = "other".to_owned();
        }
    });
    let report = compare(&scenario, &b, &tolerating("*=1e9")).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    // Events of two kinds are not one event, not even at one time.
    let events = channel(&report, "/events");
    assert_eq!(events.unmatched, [1, 1]);
    assert_eq!(events.first_unmatched, Some(times[0]));
}

/// Another value of a key is shown as set-up; the numbers decide.
#[test]
fn tolerances_decide_about_small_parameter_changes() {
    let b = short(&[("friction.k", "0.030001")]);
    let mut options = quick();
    options.tolerances.general.abs = 1e-2;
    let report = compare(&short(&[]), &b, &options).unwrap();
    assert_eq!(report.verdict, Verdict::Equal);
    assert_eq!(report.setup.scenario.len(), 1);
}

/// A derived angle is beyond the tolerance only where a field that it is derived from is.
#[test]
fn derived_angles_agree_with_the_verdict() {
    let b = short(&[("friction.k", "0.030001")]);
    for (abs, verdict) in [(1e-2, Verdict::Equal), (1e-9, Verdict::Different)] {
        let mut options = quick();
        options.tolerances.general.abs = abs;
        let report = compare(&short(&[]), &b, &options).unwrap();
        assert_eq!(report.verdict, verdict);
        let fields = report.channels.iter().flat_map(|channel| &channel.fields);
        let (derived, own): (Vec<_>, Vec<_>) = fields.partition(|field| field.is_derived);
        assert_eq!(derived.len(), 4);
        let is_beyond = |fields: &[&FieldDifference]| fields.iter().any(|f| f.beyond > 0);
        assert_eq!(is_beyond(&own), verdict == Verdict::Different);
        assert_eq!(is_beyond(&derived), verdict == Verdict::Different);
        assert!(
            derived
                .iter()
                .all(|field| field.largest != 0.0 && field.tolerance.abs == abs)
        );
    }
    // Without the field there is nothing to derive.
    let report = compare(&short(&[]), &b, &ignoring("/top/state.phi")).unwrap();
    let state = channel(&report, "/top/state").fields.iter();
    let derived: Vec<_> = state.filter(|field| field.is_derived).collect();
    assert_eq!(derived.len(), 2, "{derived:?}");
}

#[test]
fn rejects_patterns_without_match() {
    let scenario = short(&[("stop.duration", "0.1")]);
    let refused = |options: &Options| compare(&scenario, &scenario, options).unwrap_err();
    for options in [ignoring("/top/torq"), tolerating("/top/stat.*=1")] {
        let error = refused(&options).to_string();
        assert!(error.starts_with("no field matches"), "{error}");
    }
    let error = refused(&tolerating("/top/state.thet=1")).to_string();
    assert_contains(&error, "/top/state.theta");
    let error = refused(&only("/imu")).to_string();
    assert_contains(&error, "/imu");
    assert_contains(&error, "/top/state");
}

#[test]
fn lists_differing_keys() {
    let b = short(&[("friction.k", "0.04"), ("friction.dissipation", "full")]);
    let report = compare(&short(&[]), &b, &quick()).unwrap();
    let rows = report.setup.scenario.iter();
    let rows = rows.map(|row| {
        (
            &*row.key,
            row.a.as_deref().unwrap(),
            row.b.as_deref().unwrap(),
        )
    });
    let dissipation = ("friction.dissipation", "without-nutation-part", "full");
    let expected = [("friction.k", "0.03", "0.04"), dissipation];
    assert_eq!(rows.collect::<Vec<_>>(), expected);
}

/// The quantity for the runs in the other order.
fn swapped(quantity: Quantity) -> Quantity {
    match quantity {
        Quantity::End { ends: [a, b] } => Quantity::End { ends: [b, a] },
        other => other,
    }
}

#[test]
fn swapping_the_runs_mirrors_the_report() {
    for (a, b) in [
        (short(&[]), short(&[("friction.dissipation", "full")])),
        (scenario("free-paper", &[]), scenario("free-rolls", &[])),
    ] {
        let there = compare(&a, &b, &quick()).unwrap();
        let back = compare(&b, &a, &quick()).unwrap();
        assert_eq!(there.findings.len(), back.findings.len());
        // The torques are compared at A's states: they depend on which run is A.
        for x in &there.findings {
            if matches!(x.quantity, Quantity::TorqueDifference { .. }) {
                continue;
            }
            let y = back
                .findings
                .iter()
                .find(|y| swapped(y.quantity) == x.quantity);
            let y = y.unwrap_or_else(|| panic!("no {:?}", x.quantity));
            assert_eq!([x.a, x.b], [y.b, y.a], "{:?}", x.quantity);
            let [there, back] = [x.difference, y.difference].map(|d| d.unwrap_or(0.0));
            let is_distance = matches!(
                x.quantity,
                Quantity::AxisDistance { .. } | Quantity::InclinationDistance { .. }
            );
            let sign = if is_distance { 1.0 } else { -1.0 };
            assert_near("back", back, sign * there, 1e-15);
        }
        for (x, y) in there.channels.iter().zip(&back.channels) {
            assert_eq!((x.pairs, x.identical), (y.pairs, y.identical));
            assert_eq!(x.unmatched, [y.unmatched[1], y.unmatched[0]]);
            let fields = x.fields.iter().zip(&y.fields);
            for (f, g) in fields.filter(|(f, _)| !f.is_derived) {
                assert_eq!((f.largest, f.rms), (-g.largest, g.rms), "{}", f.field);
            }
        }
    }
}

#[test]
fn marks_differences_below_the_integration_error() {
    // Two ways of integrating the same motion.
    let body = short(&[("formulation", "body")]);
    let report = compare(&short(&[]), &body, &Options::default()).unwrap();
    assert_eq!(report.verdict, Verdict::Different);
    let theta = field(&report, "/top/state", "theta");
    let is_small = theta.largest != 0.0 && theta.largest.abs() < 1e-11;
    assert!(is_small, "{theta:?}");
    let fields = report.channels.iter().flat_map(|channel| &channel.fields);
    let (below, above): (Vec<_>, Vec<_>) = fields
        .filter(|field| field.largest != 0.0 && field.integration_error.is_some())
        .partition(|field| field.is_within_integration_error);
    let are_most_below = below.len() > 20 && above.len() < below.len() / 10;
    assert!(are_most_below, "{above:?}");
    // A real difference is not below.
    let other = short(&[("friction.k", "0.0301")]);
    let report = compare(&short(&[]), &other, &Options::default());
    assert!(!field(&report.unwrap(), "/top/state", "theta").is_within_integration_error);
}

/// Errors are numbers or absent, as the schema has it.
#[test]
fn reports_match_the_schema() {
    let changes = [("stop.duration", "2"), ("friction.k", "0.05")];
    let b = scenario("free-paper", &changes);
    let a = scenario("free-paper", &[("stop.duration", "2")]);
    let report = serde_json::to_value(compare(&a, &b, &quick()).unwrap()).unwrap();
    let schemas = toprise::cli::schemas();
    let mut schemas = schemas.iter();
    let schema = schemas.find(|(name, _)| name == "toprise.DiffReport.json");
    let schema: Value = serde_json::from_str(&schema.unwrap().1).unwrap();
    for (name, value) in report.as_object().unwrap() {
        assert!(schema["properties"].get(name).is_some(), "{name}");
        let required = schema["required"].as_array().unwrap();
        let may_be_absent = !required.contains(&name.as_str().into());
        assert!(!value.is_null() || may_be_absent, "{name}");
    }
}

/// A run that ends before its first nutation has no message in `/top/nutation`.
#[test]
fn runs_without_messages_are_equal_only_if_they_are_one_scenario() {
    let folder = Folder::new();
    for (name, preset) in [("a", "paper"), ("b", "paper"), ("c", "viscous")] {
        let scenario = scenario(preset, &[("stop.duration", "0.01")]);
        let path = folder.at(format!("{name}.mcap"));
        archive(&path, &scenario, &["/top/nutation"], Form::default()).unwrap();
    }
    let equal = folder.toprise("diff a.mcap b.mcap", 0).stdout;
    assert_contains(&equal, "Identical");
    folder.refuses("diff a.mcap c.mcap", "neither run has a message");
}
