//! The human-readable report of a comparison.

use super::{slip, variation};
use crate::analysis::diff::{
    Averaged, ChannelDifference, ComparedRun, Deviation, Discrepancy, FieldDifference, Finding,
    FirstDifference, IntegrationErrors, IntegratorError, KeyDifference, Report, Residual,
    TopicBytes, Verdict, full_name,
};
use crate::cli::extension::SPAWN_HINT;
use crate::telemetry::Topic;
use crate::telemetry::side::Side;
use crate::words::number::significant;
use crate::words::{Column, Section, Sentence, Table, Tone, counted, grouped};

/// Maximum number of table rows without --all.
const MAX_ROWS: usize = 14;
/// Maximum number of topics listed in a line.
const MAX_NAMED: usize = 6;

/// The page: one screen, or everything. `is_cut` shortens long values to their difference.
pub(in crate::cli) fn page(report: &Report, all: bool, is_cut: bool) -> Vec<Section> {
    let mut sections = vec![setup(report, all, is_cut), slip::section(report)];
    sections.push(beyond(report, all));
    sections.push(findings(report, all));
    sections.push(equals(report, all));
    sections.push(variation::by_key(report));
    sections.push(variation::matched(report));
    sections.push(variation::sensitivity(report));
    sections.push(others(report, all));
    if all || !report.has_other_scenarios() {
        sections.push(topics(report));
    }
    if all {
        sections.extend(report.channels.iter().map(fields));
        sections.extend(report.averaged.iter().map(averages));
        sections.extend(report.discrepancy.iter().map(models));
        sections.extend(report.integration_errors.iter().map(integrators));
    }
    sections.push(notes(report, all));
    sections.retain(|section| !section.parts.is_empty());
    sections.splice(0..0, [subjects(report), verdict(report)]);
    sections
}

pub(in crate::cli) fn subjects(report: &Report) -> Section {
    let rows = [("A", &report.a), ("B", &report.b)];
    Section::from(Table::from_texts(rows.map(subject_row)))
}

fn subject_row((letter, run): (&str, &ComparedRun)) -> Vec<String> {
    vec![
        letter.to_owned(),
        run.name.clone(),
        run.file.clone().unwrap_or_else(|| "simulated".to_owned()),
        counted(run.messages, "message"),
    ]
}

pub(in crate::cli) fn verdict(report: &Report) -> Section {
    let tone = match report.verdict {
        Verdict::Identical | Verdict::SameValues | Verdict::Equal => Tone::Good,
        Verdict::Agreeing => Tone::Weak,
        Verdict::Different => Tone::Bad,
    };
    let mut section = Section::with_tone(tone, report.headline());
    if let Some(agreement) = report.agreement {
        section.line(agreement.sentence());
    }
    section
}

/// Differing scenario keys and file metadata.
pub(in crate::cli) fn setup(report: &Report, all: bool, is_cut: bool) -> Section {
    let mut section = Section::default();
    let setup = &report.setup;
    let mut shown: Vec<_> = setup
        .scenario
        .iter()
        .filter(|key| all || key.changes_the_run())
        .collect();
    // How the files were recorded matters where the runs are the same.
    if shown.is_empty() || all {
        shown.extend(&setup.files);
    }
    let columns: [Column<&KeyDifference>; 3] = [
        ("", |key| key.key.clone()),
        ("A", |key| with_its_unit(key, key.a.as_deref())),
        ("B", |key| with_its_unit(key, key.b.as_deref())),
    ];
    let excerpts: [Column<&KeyDifference>; 3] = [
        ("", |key| key.key.clone()),
        ("A", |key| excerpt(key, key.a.as_deref())),
        ("B", |key| excerpt(key, key.b.as_deref())),
    ];
    let columns = if is_cut { excerpts } else { columns };
    let hidden = shown.len().saturating_sub(max_rows(all));
    section.table(Table::new(
        shown.into_iter().take(max_rows(all)),
        3,
        &columns,
    ));
    if hidden > 0 {
        section.line(format!("{hidden} more with --all"));
    }
    for (what, [a, b]) in [
        ("only in", &setup.topics_only_in),
        ("fields only in", &setup.fields_only_in),
    ] {
        for (letter, only) in [("A", a), ("B", b)] {
            if !only.is_empty() {
                section.line(format!("{what} {letter}: {}", some(only)));
            }
        }
    }
    section
}

/// Maximum number of table rows.
fn max_rows(all: bool) -> usize {
    if all { usize::MAX } else { MAX_ROWS }
}

/// A value with its unit.
fn with_its_unit(key: &KeyDifference, value: Option<&str>) -> String {
    match value {
        Some(text) => format!("{text} {}", key.unit).trim_end().to_owned(),
        None => "–".to_owned(),
    }
}

/// A value with its unit, shortened to a part that differs from the other value.
fn excerpt(key: &KeyDifference, value: Option<&str>) -> String {
    /// Maximum length, characters.
    const MAX_LENGTH: usize = 40;
    /// Characters shown before the first difference.
    const CONTEXT: usize = 12;
    let full = with_its_unit(key, value);
    if full.chars().count() <= MAX_LENGTH {
        return full;
    }
    let [a, b] = [&key.a, &key.b].map(|text| text.as_deref().unwrap_or_default());
    // By characters, not bytes: a cut within a character would panic.
    let common = a.chars().zip(b.chars()).take_while(|(a, b)| a == b).count();
    let start = match common.saturating_sub(CONTEXT) {
        // To leave out as little as that would not save anything.
        start if common < MAX_LENGTH && start <= CONTEXT => 0,
        start => start,
    };
    let part: String = full.chars().skip(start).take(MAX_LENGTH).collect();
    let before = if start > 0 { "…" } else { "" };
    let is_to_end = full.chars().count() <= start + MAX_LENGTH;
    let after = if is_to_end { "" } else { "…" };
    format!("{before}{part}{after}")
}

/// The fields beyond the tolerances, if some were set or topics were chosen.
pub(in crate::cli) fn beyond(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    let beyond = report.fields_beyond();
    if !report.is_limited || beyond.is_empty() {
        return section;
    }
    let columns: [Column<&(&ChannelDifference, &FieldDifference)>; 6] = [
        ("beyond the tolerances", |(channel, field)| {
            with_unit(&full_name(&channel.topic, &field.field), &field.unit)
        }),
        ("A", |(_, field)| value(field, Side::A)),
        ("B", |(_, field)| value(field, Side::B)),
        ("largest B − A", |(_, field)| {
            significant(field.largest, 3)
        }),
        ("at", |(_, field)| format!("{} s", field.at)),
        ("pairs", |(_, field)| {
            format!("{} of {}", grouped(field.beyond), grouped(field.count))
        }),
    ];
    let shown = beyond.iter().take(max_rows(all));
    section.table(Table::new(shown, 1, &columns));
    let hidden = beyond.len().saturating_sub(max_rows(all));
    if hidden > 0 {
        section.line(format!("{hidden} more with --all"));
    }
    section
}

/// The value of a run where a field differs most.
fn value(field: &FieldDifference, side: Side) -> String {
    let values = field.values.map(|values| values[side.index()]);
    values.map_or_else(String::new, |value| significant(value, 6))
}

/// The numbers that differ, with their remarks.
pub(in crate::cli) fn findings(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    let shown: Vec<_> = report.differing().take(max_rows(all)).collect();
    let cells = shown.iter().map(|finding| finding.cells());
    section.table(Table::new(cells, 1, &columns("B − A")));
    for remark in shown.into_iter().filter_map(Finding::remark) {
        section.line(remark);
    }
    section
}

/// The numbers that are equal, and the integration errors. Without `--all` not of runs of one scenario, of which each number
/// is equal.
pub(in crate::cli) fn equals(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    if !all && !report.has_other_scenarios() {
        return section;
    }
    let equal = report.findings.iter().filter(|finding| !finding.differs());
    let cells = equal.take(max_rows(all)).map(Finding::cells_of_equal);
    section.table(Table::new(cells, 1, &columns("equal within")));
    if let Some(line) = no_numbers(report) {
        section.line(line);
    }
    if let Some(errors) = &report.integration_errors {
        section.line(errors.sentence());
    }
    section
}

/// The columns of a table of findings; the last has this name.
fn columns(last: &'static str) -> [Column<[Sentence; 4], Sentence>; 4] {
    [
        ("", |cells| cells[0].clone()),
        ("A", |cells| cells[1].clone()),
        ("B", |cells| cells[2].clone()),
        (last, |cells| cells[3].clone()),
    ]
}

/// Says so if there is no number to compare, or no nutation.
fn no_numbers(report: &Report) -> Option<&'static str> {
    if report.findings.is_empty() {
        Some("Neither run has a number to compare, such as an event or a mean over a nutation.")
    } else if report.averaged.is_none() {
        Some("There are no complete nutations to compare.")
    } else {
        None
    }
}

/// The topics that differ, with the first difference of each.
pub(in crate::cli) fn topics(report: &Report) -> Section {
    let differing = report.channels.iter().filter(|channel| {
        channel.identical < channel.pairs || channel.unmatched != [0; 2] || channel.beyond != [0; 2]
    });
    let columns: [Column<&ChannelDifference>; 4] = [
        ("topic", |channel| channel.topic.clone()),
        ("first difference: A, B", |channel| {
            let first = channel.first.as_ref();
            first.map_or_else(String::new, |FirstDifference { field, time, a, b }| {
                format!("{field} at {time} s: {a}, {b}")
            })
        }),
        ("different", |channel| {
            grouped(channel.pairs - channel.identical)
        }),
        ("unmatched", |channel| {
            grouped(channel.unmatched.iter().chain(&channel.beyond).sum())
        }),
    ];
    Section::from(Table::new(differing, 2, &columns))
}

/// Topics compared byte by byte. Without `--all`, equal ones are shown only if there is nothing else, and those of the
/// telemetry table not at all: their values are identical.
pub(in crate::cli) fn others(report: &Report, all: bool) -> Section {
    let shown = report.others.iter().filter(|topic| {
        let is_of_interest = report.findings.is_empty() || !topic.is_equal();
        all || (is_of_interest && Topic::find(&topic.topic).is_none())
    });
    let columns: [Column<&TopicBytes>; 7] = [
        ("topic", |topic| topic.topic.clone()),
        ("", |topic| {
            let is_other = topic.is_described_differently;
            let described = is_other.then_some("different schema or encoding");
            described.unwrap_or_default().to_owned()
        }),
        ("equal", |topic| grouped(topic.equal + topic.respelled)),
        ("different", |topic| grouped(topic.different)),
        ("only A", |topic| grouped(topic.unmatched[0])),
        ("only B", |topic| grouped(topic.unmatched[1])),
        ("first", |topic| match topic.first {
            Some(time) => format!("{time} s"),
            None => String::new(),
        }),
    ];
    Section::from(Table::new(shown, 2, &columns))
}

/// The fields of a topic that differ.
fn fields(channel: &ChannelDifference) -> Section {
    let differing = channel
        .fields
        .iter()
        .filter(|field| field.first_different.is_some() && field.largest != 0.0);
    let columns: [Column<&FieldDifference>; 5] = [
        ("field", |field| with_unit(&field.field, &field.unit)),
        ("largest B − A", |field| {
            let mark = if field.is_within_integration_error {
                "≈ "
            } else {
                ""
            };
            format!("{mark}{}", significant(field.largest, 3))
        }),
        ("at", |field| format!("{} s", field.at)),
        ("RMS", |field| significant(field.rms, 2)),
        ("relative", |field| {
            let relative = field.relative();
            let shown = (relative > 0.0).then(|| significant(relative, 2));
            shown.unwrap_or_default()
        }),
    ];
    Section::from(Table::new(differing, 1, &columns))
        .titled(&channel.topic, format!("{} pairs", grouped(channel.pairs)))
}

fn averages(averaged: &Averaged) -> Section {
    let columns: [Column<&Deviation>; 5] = [
        ("", |mean| with_unit(&mean.quantity, &mean.unit)),
        ("A", |mean| significant(mean.values[0], 5)),
        ("B", |mean| significant(mean.values[1], 5)),
        ("largest B − A", |mean| significant(mean.largest, 3)),
        ("at", |mean| format!("{:.3} s", mean.at)),
    ];
    Section::from(Table::new(&averaged.deviations, 1, &columns)).titled(
        "Averaged motion",
        format!("{:.3} s to {:.3} s", averaged.from, averaged.to),
    )
}

fn models(discrepancy: &Discrepancy) -> Section {
    let columns: [Column<&Residual>; 5] = [
        ("", |residual| with_unit(&residual.quantity, &residual.unit)),
        ("largest", |residual| significant(residual.largest, 3)),
        ("at", |residual| format!("{} s", residual.at)),
        ("RMS", |residual| significant(residual.rms, 3)),
        ("RMS of A", |residual| significant(residual.rms_a, 3)),
    ];
    Section::from(Table::new(&discrepancy.quantities, 1, &columns)).titled(
        "Models",
        format!(
            "B − A, evaluated at {} states of A",
            grouped(discrepancy.states)
        ),
    )
}

fn integrators(errors: &IntegrationErrors) -> Section {
    let columns: [Column<(&str, &IntegratorError)>; 4] = [
        ("", |(letter, _)| (*letter).to_owned()),
        ("tolerance", |(_, run)| {
            format!("{:e} → {:e}", run.relative_tolerance, run.compared_with)
        }),
        ("mean θ [rad]", |(_, run)| significant(run.theta_mean, 2)),
        ("events [s]", |(_, run)| significant(run.event_time, 2)),
    ];
    let runs = [("A", &errors.a), ("B", &errors.b)];
    Section::from(Table::new(runs, 2, &columns)).titled(
        "Integrator errors",
        "estimated with tighter tolerances; ≈ marks differences below the integration error",
    )
}

pub(in crate::cli) fn notes(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    for (run, letter) in [(&report.a, "A"), (&report.b, "B")] {
        for loss in &run.losses {
            section.line(format!("{letter}: {loss}"));
        }
    }
    for note in &report.notes {
        section.line(note.clone());
    }
    if !all && report.verdict == Verdict::Different && !report.findings.is_empty() {
        let findings = report.differing().count();
        let more = match findings.saturating_sub(MAX_ROWS) {
            0 => String::new(),
            1 => "one more finding and ".to_owned(),
            more => format!("{more} more findings and "),
        };
        section.line(format!("More: --all shows {more}every field{SPAWN_HINT}."));
    }
    section
}

/// The name of a quantity with its unit, if it has one.
fn with_unit(quantity: &str, unit: &str) -> String {
    match unit {
        "" => quantity.to_owned(),
        unit => format!("{quantity} [{unit}]"),
    }
}

/// A list, truncated.
fn some(list: &[String]) -> String {
    match list.len().checked_sub(MAX_NAMED) {
        None | Some(0) => list.join(", "),
        Some(more) => format!("{} and {more} more", list[..MAX_NAMED].join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn excerpts_show_what_differs() {
        let common = "json, schema Example (crc32 59468744), metadata ";
        let shared = "x".repeat(39);
        for (name, a, b) in [
            (
                "at the end",
                format!("{common}{{}}"),
                format!("{common}{{\"k\": \"v\"}}"),
            ),
            (
                "one is longer",
                common.to_owned(),
                format!("{common}{common}"),
            ),
            ("at the limit", format!("{shared}aa"), format!("{shared}bb")),
            ("at the start", format!("a{common}"), format!("b{common}")),
            ("absent", common.to_owned(), String::new()),
        ] {
            let key = KeyDifference {
                key: "channel /a".to_owned(),
                unit: String::new(),
                a: Some(a),
                b: Some(b).filter(|b| !b.is_empty()),
            };
            let cells = [&key.a, &key.b].map(|value| excerpt(&key, value.as_deref()));
            assert_ne!(cells[0], cells[1], "{name}");
            for cell in &cells {
                assert!(cell.chars().count() <= 42, "{name}: {cell}");
            }
        }
    }
}
