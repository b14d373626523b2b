//! The human-readable report of a comparison.

use crate::analysis::diff::{
    Averaged, ChannelDifference, ComparedRun, Discrepancy, FieldDifference, Floor, KeyDifference,
    Report, TopicBytes, Verdict,
};
use crate::analysis::phrase::significant;
use crate::cli::numbers::count;
use crate::cli::page::{Section, Tone};
use crate::cli::table::Table;

/// Maximum number of table rows without --all.
const MOST_ROWS: usize = 12;
/// Maximum number of topics listed in a line.
const MOST_NAMED: usize = 6;

/// The page: one screen, or everything.
pub(super) fn page(report: &Report, all: bool) -> Vec<Section> {
    let mut sections = vec![setup(report, all), findings(report, all)];
    if all || report.findings.is_empty() {
        sections.push(others(&report.others));
    }
    if all || !report.is_of_other_scenarios() {
        sections.push(topics(report));
    }
    if all {
        sections.extend(report.channels.iter().map(fields));
        sections.extend(report.averaged.iter().map(averages));
        sections.extend(report.discrepancy.iter().map(models));
        sections.extend(report.floor.iter().map(integrators));
    }
    sections.push(notes(report, all));
    sections.retain(|section| !section.parts.is_empty());
    sections.splice(0..0, [subjects(report), verdict(report)]);
    sections
}

fn subjects(report: &Report) -> Section {
    let row = |(letter, run): (&str, &ComparedRun)| {
        vec![
            letter.to_owned(),
            run.name.clone(),
            run.file.clone().unwrap_or_else(|| "simulated".to_owned()),
            format!("{} messages", count(run.messages)),
        ]
    };
    let rows = [("A", &report.a), ("B", &report.b)].map(row);
    Section::of(Table::of_texts(rows.to_vec()))
}

fn verdict(report: &Report) -> Section {
    let tone = match report.verdict {
        Verdict::Identical | Verdict::SameValues | Verdict::Equal => Tone::Good,
        Verdict::Agreeing => Tone::Weak,
        Verdict::Different => Tone::Bad,
    };
    Section::toned(tone, report.verdict.title())
}

/// Differing scenario keys and file metadata.
fn setup(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    let setup = &report.setup;
    let keys = setup.scenario.iter();
    let keys: Vec<_> = keys.filter(|key| all || key.changes_the_run()).collect();
    let files: Vec<_> = setup.files.iter().collect();
    let shown = if keys.is_empty() || all {
        [keys, files].concat()
    } else {
        keys
    };
    let rows = shown.iter().take(most_rows(all)).map(|key| key_row(key));
    section.table(Table::new(&["", "A", "B"], rows.collect(), 3));
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
fn most_rows(all: bool) -> usize {
    if all { usize::MAX } else { MOST_ROWS }
}

fn key_row(key: &KeyDifference) -> Vec<String> {
    const LONGEST: usize = 40;
    let value = |value: &Option<String>| {
        let text = value.clone().unwrap_or_else(|| "–".to_owned());
        let short: String = text.chars().take(LONGEST).collect();
        match short.len() < text.len() {
            true => format!("{short}…"),
            false if key.unit.is_empty() || text == "–" => text,
            false => format!("{text} {}", key.unit),
        }
    };
    vec![key.key.clone(), value(&key.a), value(&key.b)]
}

fn findings(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    let shown = report.findings.iter().filter(|f| all || f.differs());
    let rows: Vec<_> = shown
        .take(most_rows(all))
        .map(|f| f.cells().to_vec())
        .collect();
    if rows.is_empty() && report.floor.is_some() && report.is_of_other_scenarios() {
        section.line("No average, event or energy differs by more than the integration error.");
    }
    section.table(Table::new(&["", "A", "B", "B − A"], rows, 1));
    section
}

/// The topics that differ, with the first difference of each.
fn topics(report: &Report) -> Section {
    let differing = report.channels.iter().filter(|channel| {
        channel.identical < channel.pairs || channel.unmatched != [0; 2] || channel.beyond != [0; 2]
    });
    let row = |channel: &ChannelDifference| {
        let first = channel.first.as_ref().map(|first| {
            let (field, time) = (&first.field, first.time);
            format!("{field} at {time} s: {}, {}", first.a, first.b)
        });
        let alone: u64 = channel.unmatched.iter().chain(&channel.beyond).sum();
        vec![
            channel.topic.clone(),
            first.unwrap_or_default(),
            count(channel.pairs - channel.identical),
            count(alone),
        ]
    };
    let rows: Vec<_> = differing.map(row).collect();
    let header = ["topic", "first difference: A, B", "different", "unmatched"];
    Section::of(Table::new(&header, rows, 2))
}

fn others(topics: &[TopicBytes]) -> Section {
    let row = |topic: &TopicBytes| {
        let first = topic.first.map(|time| format!("{time} s"));
        let is_other = topic.is_described_differently;
        let described = is_other.then_some("other schema or encoding");
        vec![
            topic.topic.clone(),
            described.unwrap_or_default().to_owned(),
            count(topic.equal),
            count(topic.different),
            count(topic.unmatched[0]),
            count(topic.unmatched[1]),
            first.unwrap_or_default(),
        ]
    };
    let header = [
        "topic",
        "",
        "equal",
        "different",
        "only A",
        "only B",
        "first",
    ];
    Section::of(Table::new(&header, topics.iter().map(row).collect(), 2))
}

/// The fields of a topic that differ.
fn fields(channel: &ChannelDifference) -> Section {
    let differing = channel
        .fields
        .iter()
        .filter(|field| field.first_different.is_some() && field.largest != 0.0);
    let row = |field: &FieldDifference| {
        let mark = if field.is_below_floor { "≈ " } else { "" };
        let relative = Some(field.largest.abs() / field.scale).filter(|share| share.is_finite());
        vec![
            format!("{} [{}]", field.field, field.unit).replace(" []", ""),
            format!("{mark}{}", significant(field.largest, 3)),
            format!("{} s", field.at),
            significant(field.rms, 2),
            relative.map_or_else(String::new, |share| significant(share, 2)),
        ]
    };
    let header = ["field", "largest B − A", "at", "RMS", "relative"];
    Section::of(Table::new(&header, differing.map(row).collect(), 1))
        .titled(&channel.topic, format!("{} pairs", count(channel.pairs)))
}

fn averages(averaged: &Averaged) -> Section {
    let rows = averaged.deviations.iter().map(|deviation| {
        vec![
            format!("{} [{}]", deviation.quantity, deviation.unit),
            significant(deviation.values[0], 5),
            significant(deviation.values[1], 5),
            significant(deviation.largest, 3),
            format!("{:.3} s", deviation.at),
        ]
    });
    let header = ["", "A", "B", "largest B − A", "at"];
    Section::of(Table::new(&header, rows.collect(), 1)).titled(
        "Averaged motion",
        format!("{:.3} s to {:.3} s", averaged.from, averaged.to),
    )
}

fn models(discrepancy: &Discrepancy) -> Section {
    let rows = discrepancy.quantities.iter().map(|residual| {
        vec![
            format!("{} [{}]", residual.quantity, residual.unit),
            significant(residual.largest, 3),
            format!("{} s", residual.at),
            significant(residual.rms, 3),
            significant(residual.rms_a, 3),
        ]
    });
    let header = ["", "largest", "at", "RMS", "RMS of A"];
    Section::of(Table::new(&header, rows.collect(), 1)).titled(
        "Models",
        format!(
            "B − A, evaluated at {} states of A",
            count(discrepancy.states)
        ),
    )
}

fn integrators(floor: &Floor) -> Section {
    let rows = [("A", &floor.a), ("B", &floor.b)].map(|(letter, error)| {
        vec![
            letter.to_owned(),
            format!("{:e} → {:e}", error.relative_tolerance, error.compared_with),
            significant(error.theta_mean, 2),
            significant(error.event_time, 2),
        ]
    });
    let header = ["", "tolerance", "mean θ [rad]", "events [s]"];
    Section::of(Table::new(&header, rows.to_vec(), 2)).titled(
        "Integrator errors",
        "estimated with tighter tolerances; ≈ marks differences below the integration error",
    )
}

fn notes(report: &Report, all: bool) -> Section {
    let mut section = Section::default();
    for (run, letter) in [(&report.a, "A"), (&report.b, "B")] {
        for loss in &run.losses {
            section.line(format!("{letter}: missing {loss}"));
        }
    }
    for note in &report.notes {
        section.line(note.clone());
    }
    if !all && report.verdict == Verdict::Different && !report.findings.is_empty() {
        let findings = report.findings.iter().filter(|f| f.differs()).count();
        let more = match findings.saturating_sub(MOST_ROWS) {
            0 => String::new(),
            1 => "one more finding and ".to_owned(),
            more => format!("{more} more findings and"),
        };
        let viewer = if cfg!(feature = "rerun") {
            ", --spawn shows both tops in Rerun"
        } else {
            ""
        };
        section.line(format!("More: --all shows {more}every field{viewer}."));
    }
    section
}

/// A list, truncated.
fn some(list: &[String]) -> String {
    match list.len().checked_sub(MOST_NAMED) {
        None | Some(0) => list.join(", "),
        Some(more) => format!("{} and {more} more", list[..MOST_NAMED].join(", ")),
    }
}
