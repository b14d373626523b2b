//! `toprise explain`.

use super::arguments::{Override, parse_override};
use super::input::open;
use super::report;
use super::status::Status;
use crate::analysis::explain::{self, EventSummary, Explanation, Fact, Stage};
use crate::run::simulation::EventKind;
use crate::words::number::significant;
use crate::words::{Part, Section, Table};
use anyhow::{Context as _, Error};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `toprise explain`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct ExplainArguments {
    /// A recording, a preset or a scenario file.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// Set a key of the scenario, e.g. friction.k=0.02 (not for recordings)
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// Also show all events and a table of the averaged motion
    #[arg(long)]
    all: bool,
}

/// Explains a run.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Status, Error> {
    let input = open(&arguments.run, &[], &arguments.overrides)?;
    let explanation =
        explain::explain(input.subject()).with_context(|| arguments.run.display().to_string())?;
    report::print(&explanation, || page(&explanation, arguments.all))?;
    Ok(Status::from_whole(explanation.losses.is_empty()))
}

fn page(explanation: &Explanation, all: bool) -> Vec<Section> {
    let mut sections = Vec::new();
    // The causes come first, in words; the numbers follow.
    let mut story = Section::default();
    story.parts.extend(
        explanation
            .story
            .text()
            .map(|text| Part::Paragraph(text.into())),
    );
    sections.push(story);
    for chapter in &explanation.chapters {
        let sentences = chapter.facts.iter().map(Fact::sentence);
        sections.push(Section::from_lines(chapter.heading, sentences));
    }
    sections.push(events(explanation));
    if all {
        sections.push(stages(&explanation.stages));
    }
    let losses = explanation.losses.iter().cloned();
    sections.push(Section::from_lines("Incomplete input", losses));
    sections.retain(|section| !section.parts.is_empty());
    // After that: a title has no parts.
    sections.insert(0, Section::new(&explanation.title));
    sections
}

/// One line for each kind of event.
fn events(explanation: &Explanation) -> Section {
    let rows = explanation.events.iter().map(event_row);
    Section::from(Table::from_texts(rows)).titled("Events", "")
}

/// First time, name and further occurrences of an event.
fn event_row(event: &EventSummary) -> Vec<String> {
    // Recordings of later versions may have other kinds.
    let words = EventKind::find(&event.name)
        .map_or_else(|| event.name.clone(), |kind| kind.words(event.count));
    let again = match event.count {
        1 => String::new(),
        count => format!("{count} times, last at {:.4} s", event.last),
    };
    vec![format!("{:.4} s", event.first), words, again]
}

/// A mean, or a dash if it was not recorded (NaN).
fn mean(value: f64, digits: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else {
        significant(value, digits)
    }
}

/// Table of the averaged motion.
fn stages(stages: &[Stage]) -> Section {
    let table = Table::new(
        stages,
        1,
        &[
            ("time [s]", |stage| {
                format!("{:.2} to {:.2}", stage.from, stage.to)
            }),
            ("nutations", |stage| stage.nutations.to_string()),
            ("θ [rad]", |stage| mean(stage.theta, 4)),
            ("θ̇ [rad/s]", |stage| mean(stage.theta_dot, 3)),
            ("φ̇ [rad/s]", |stage| mean(stage.phi_dot, 5)),
            ("slow root", |stage| match stage.slow_root {
                Some(root) => significant(root, 5),
                None => "–".to_owned(),
            }),
            ("ψ̇ [rad/s]", |stage| mean(stage.psi_dot, 5)),
        ],
    );
    Section::from(table).titled("Nutations", "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn prints_missing_means_as_dashes() {
        assert_eq!(mean(f64::NAN, 3), "–");
        assert_eq!(mean(0.5, 3), significant(0.5, 3));
    }

    #[test]
    fn parses_one_run() {
        assert_eq!(
            parse::<ExplainArguments>("paper --set friction.k=0.02").unwrap(),
            ExplainArguments {
                run: "paper".into(),
                overrides: vec![("friction.k".to_owned(), "0.02".to_owned())],
                ..ExplainArguments::default()
            }
        );
        assert!(parse::<ExplainArguments>("").is_err());
    }
}
