//! Recordings from which other software has removed messages, and runs that were interrupted.

use super::facts;
use crate::support::{Folder, scenario};
use std::ops::ControlFlow;
use std::path::Path;
use toprise::analysis::diff::{Options, Quantity, Verdict, compare};
use toprise::analysis::explain::{Explanation, Fact, explain};
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::Existing;
use toprise::archive::recording::Recording;
use toprise::archive::sink::{Sink, SinkError, record};
use toprise::archive::writer::Form;
use toprise::run::scenario::Scenario;
use toprise::telemetry::fields::{EVENTS, IMPACTS, NUTATION, STATE};
use toprise::telemetry::{Message, RunMessages, Topics};

/// Removes messages before they are recorded; metadata, numbers and times are those of the whole run.
struct Filter<'f> {
    sink: &'f mut McapSink,
    is_kept: fn(&Message<'_>) -> bool,
}

impl Sink for Filter<'_> {
    fn write(&mut self, message: &Message<'_>) -> Result<(), SinkError> {
        if (self.is_kept)(message) {
            self.sink.write(message)?;
        }
        Ok(())
    }

    fn flush(&mut self) -> Result<(), SinkError> {
        self.sink.flush()
    }
}

/// Records the messages of a run that are kept, until a number of them is reached.
fn filtered(path: &Path, scenario: &Scenario, is_kept: fn(&Message<'_>) -> bool, records: u64) {
    let mut run = RunMessages::new(scenario, &Topics::All).unwrap();
    let (telemetry, form) = (run.telemetry(), Form::default());
    let mut sink = McapSink::create(path, Existing::Keep, scenario, telemetry, form).unwrap();
    let mut filter = Filter {
        sink: &mut sink,
        is_kept,
    };
    let mut count = 0;
    let carry_on = |_: &_, _: &mut [&mut dyn Sink]| {
        count += 1;
        Ok(if count < records {
            ControlFlow::Continue(())
        } else {
            ControlFlow::Break(())
        })
    };
    let sinks: &mut [&mut dyn Sink] = &mut [&mut filter];
    let recorded = record(&mut run, sinks, carry_on).unwrap();
    sink.finish(&recorded.outcome.end).unwrap();
}

fn explain_filtered(preset: &str, is_kept: fn(&Message<'_>) -> bool) -> Explanation {
    let folder = Folder::new();
    let path = folder.at("run.mcap");
    let run = scenario(preset, &[("stop.duration", "1")]);
    filtered(&path, &run, is_kept, u64::MAX);
    explain(&Recording::open(&path).unwrap()).unwrap()
}

fn is_before_half_a_second(message: &Message<'_>) -> bool {
    message.time_ns < 500_000_000
}

fn is_no_late_event(message: &Message<'_>) -> bool {
    message.topic() != EVENTS || is_before_half_a_second(message)
}

fn is_no_late_nutation(message: &Message<'_>) -> bool {
    message.topic() != NUTATION || is_before_half_a_second(message)
}

fn is_no_state_in_the_middle(message: &Message<'_>) -> bool {
    message.topic() != STATE || !(400_000_000..450_000_000).contains(&message.time_ns)
}

fn is_no_late_impact(message: &Message<'_>) -> bool {
    message.topic() != IMPACTS || message.time_ns < 50_000_000
}

fn is_any(_: &Message<'_>) -> bool {
    true
}

#[test]
fn names_messages_that_were_filtered_out() {
    type Case = (&'static str, fn(&Message<'_>) -> bool, &'static str);
    let cases: [Case; 5] = [
        (
            "cut",
            is_before_half_a_second,
            "501 of 1,001 samples of /top/state and 8 other topics",
        ),
        ("events", is_no_late_event, " events of /events"),
        (
            "nutations",
            is_no_late_nutation,
            " nutations of /top/nutation",
        ),
        (
            "hole",
            is_no_state_in_the_middle,
            "50 of 1,001 samples of /top/state",
        ),
        ("impacts", is_no_late_impact, "some impacts of /top/impact"),
    ];
    for (name, is_kept, loss) in cases {
        let explanation = explain_filtered("drop", is_kept);
        let losses = &explanation.losses;
        assert!(
            losses.iter().any(|found| found.contains(loss)),
            "{name}: {losses:?}"
        );
        let unknown: Vec<&Fact> = facts(&explanation)
            .filter(|fact| match fact {
                Fact::Impacts { .. } => ["cut", "hole", "impacts"].contains(&name),
                Fact::Rolls { .. } | Fact::Loops { .. } | Fact::MeanTheta { .. } => {
                    name != "impacts"
                }
                _ => false,
            })
            .collect();
        assert!(unknown.is_empty(), "{name}: {unknown:?}");
    }
}

#[test]
fn complete_recordings_have_no_losses() {
    // The last two: regular precession does not always exist, and impacts without loss.
    for (preset, key, value) in [
        ("paper", "stop.duration", "1"),
        ("drop", "support.restitution", "0"),
        ("drop", "support.restitution", "0.9"),
        ("free-rolls", "friction.k", "10"),
        ("tippe-top-hangs", "initial.height", "0.01"),
        ("drop", "support.restitution", "1"),
    ] {
        let folder = Folder::new();
        let path = folder.at("run.mcap");
        let run = scenario(preset, &[("stop.duration", "1"), (key, value)]);
        filtered(&path, &run, is_any, u64::MAX);
        let explanation = explain(&Recording::open(&path).unwrap()).unwrap();
        assert!(
            explanation.losses.is_empty(),
            "{preset}: {:?}",
            explanation.losses
        );
    }
}

#[test]
fn title_of_a_cut_recording_names_the_end_of_its_samples() {
    let explanation = explain_filtered("paper", is_before_half_a_second);
    let end = "incomplete, recorded until t = 0.4990 s";
    assert!(explanation.title.ends_with(end), "{}", explanation.title);
}

#[test]
fn diff_does_not_compare_counts_of_a_cut_recording() {
    let folder = Folder::new();
    let (whole, cut) = (folder.at("whole.mcap"), folder.at("cut.mcap"));
    let run = scenario("drop", &[("stop.duration", "1")]);
    filtered(&whole, &run, is_any, u64::MAX);
    filtered(&cut, &run, is_before_half_a_second, u64::MAX);
    let [whole, cut] = [whole, cut].map(|path| Recording::open(&path).unwrap());
    let report = compare(&whole, &cut, &Options::default()).unwrap();
    assert_eq!(report.verdict, Verdict::Agreeing);
    assert!(!report.b.losses.is_empty());
    let found = report.findings.iter().find(|finding| {
        matches!(
            finding.quantity,
            Quantity::Loops { .. } | Quantity::FirstLoop | Quantity::End { .. }
        )
    });
    assert!(found.is_none(), "{found:?}");
}

#[test]
fn interrupted_runs_are_compared_in_part() {
    let folder = Folder::new();
    let path = folder.at("run.mcap");
    let run = scenario("paper", &[("stop.duration", "1")]);
    filtered(&path, &run, is_any, 300);
    let recording = Recording::open(&path).unwrap();
    let explanation = explain(&recording).unwrap();
    assert_eq!(explanation.losses, ["missing end of the run (interrupted)"]);
    let report = compare(&recording, &run, &Options::default()).unwrap();
    assert_eq!(report.verdict, Verdict::Agreeing, "{:?}", report.summary());
    let mut findings = report.findings.iter();
    assert!(!findings.any(|finding| matches!(finding.quantity, Quantity::End { .. })));
}
