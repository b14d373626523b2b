//! The report as JUnit's XML, which CI services read: a test suite for each pair of runs, with a test for each topic.

use crate::analysis::diff::{ChannelDifference, ComparedRun, FieldDifference, Report, Verdict};
use crate::analysis::phrase::quantity;
use std::fmt::Write as _;

/// Failures name no more fields of a topic than this.
const NAMED: usize = 20;

/// A test: its name, and what is wrong if it failed.
struct Test {
    name: String,
    failure: Option<String>,
}

/// The reports as a document.
pub(super) fn document<'r>(reports: impl IntoIterator<Item = &'r Report>) -> String {
    let mut document =
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"toprise diff\">\n"
            .to_owned();
    for report in reports {
        add_suite(report, &mut document);
    }
    document + "</testsuites>\n"
}

fn add_suite(report: &Report, document: &mut String) {
    let tests = tests(report);
    let failures = tests.iter().filter(|test| test.failure.is_some()).count();
    let name = format!("{} and {}", name(&report.a), name(&report.b));
    // Writing into a string can't fail.
    let _ = writeln!(
        document,
        "  <testsuite name=\"{}\" tests=\"{}\" failures=\"{failures}\">",
        escaped(&name),
        tests.len()
    );
    for Test { name, failure } in &tests {
        let name = escaped(name);
        let _ = match failure {
            None => writeln!(
                document,
                "    <testcase classname=\"toprise.diff\" name=\"{name}\"/>"
            ),
            Some(failure) => {
                let (first, text) = (failure.lines().next().unwrap_or_default(), escaped(failure));
                writeln!(
                    document,
                    "    <testcase classname=\"toprise.diff\" name=\"{name}\">\n      <failure message=\"{}\">{text}</failure>\n    </testcase>",
                    escaped(first)
                )
            }
        };
    }
    document.push_str("  </testsuite>\n");
}

fn name(run: &ComparedRun) -> &str {
    run.file.as_deref().unwrap_or(&run.name)
}

/// The verdict, and one test for each topic.
fn tests(report: &Report) -> Vec<Test> {
    let is_different = report.verdict == Verdict::Different;
    // What agrees only as far as it was compared is no success.
    let is_same = report.verdict.has_same_messages();
    let verdict = Test {
        name: "verdict".to_owned(),
        failure: (!is_same).then(|| report.summary.join("\n")),
    };
    let topics = report.signals.channels.iter().map(|channel| Test {
        name: channel.topic.clone(),
        failure: failure(channel).filter(|_| is_different),
    });
    std::iter::once(verdict).chain(topics).collect()
}

/// What differs in a topic by more than the tolerances.
fn failure(channel: &ChannelDifference) -> Option<String> {
    let differing = channel
        .fields
        .iter()
        .filter(|field| field.beyond > 0 && !field.is_derived);
    let mut lines: Vec<String> = differing.clone().take(NAMED).map(line).collect();
    if differing.clone().count() > NAMED {
        lines.push(format!("and {} more fields", differing.count() - NAMED));
    }
    if let Some(texts) = &channel.texts {
        lines.push(format!(
            "{} texts differ, first at {} s: {:?} in A, {:?} in B",
            texts.count, texts.time, texts.a, texts.b
        ));
    }
    if let Some(bytes) = &channel.bytes {
        lines.push(format!(
            "{} pairs differ byte by byte, first at {} s from byte {} on",
            bytes.count, bytes.time, bytes.offset
        ));
    }
    for (run, alone) in [
        ("A", channel.only_in_a + channel.beyond_in_a),
        ("B", channel.only_in_b + channel.beyond_in_b),
    ] {
        if alone > 0 {
            lines.push(format!("{alone} messages are only in {run}"));
        }
    }
    (!lines.is_empty()).then(|| lines.join("\n"))
}

fn line(field: &FieldDifference) -> String {
    format!(
        "{}: {} of {} beyond the tolerance, first at {} s, by up to {} at {} s",
        field.field,
        field.beyond,
        field.count + field.not_numbers,
        field.first_beyond.unwrap_or_default(),
        quantity(field.largest, 3, &field.unit),
        field.at
    )
}

/// A text as XML can hold it: control characters, which it can't, are shown as �.
fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\n' | '\t' => escaped.push(c),
            _ if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => escaped.push('\u{fffd}'),
            _ => escaped.push(c),
        }
    }
    escaped
}
