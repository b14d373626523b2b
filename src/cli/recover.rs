//! `toprise recover`.

use super::arguments::FormArguments;
use super::done::Done;
use super::numbers;
use super::page::{Page, Section};
use super::progress::Progress;
use super::report;
use super::table::Table;
use crate::analysis::complete::complete;
use crate::analysis::salvage::salvage;
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use crate::telemetry::table;
use anyhow::{Context as _, Error};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `toprise recover`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct RecoverArguments {
    /// An interrupted or damaged recording (`.mcap` or `.mcap.partial`).
    #[arg(value_name = "IN")]
    input: PathBuf,

    /// The file to write.
    #[arg(value_name = "OUT")]
    output: PathBuf,

    /// Simulate the recording's scenario again and write the whole run. What can be read of the recording
    /// must be what the simulation gives, bit for bit.
    #[arg(long)]
    complete: bool,

    /// Replace the file if it exists.
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    form: FormArguments,
}

/// What was saved of a recording, and what was not.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct RecoverReport {
    /// The new recording.
    file: String,
    /// Its size.
    bytes: u64,
    /// SHA-256 of its content.
    content_digest: String,
    /// Whether it is the whole run, simulated again.
    is_completed: bool,
    /// Whether the scenario could be read, so that the run can be simulated again.
    can_complete: bool,
    /// Number of messages that were saved; absent for a run that was simulated again.
    messages: Option<u64>,
    /// Number of messages that could not be decoded.
    undecodable: u64,
    /// Parts of the file that could not be read.
    losses: Vec<String>,
    /// What is lost, in a sentence; absent if nothing is.
    lost: Option<String>,
}

/// Saves what can be read of a recording.
pub(super) fn recover(arguments: &RecoverArguments) -> Result<Done, Error> {
    let context = || arguments.input.display().to_string();
    let recording = Recording::open(&arguments.input).with_context(context)?;
    let report = if arguments.complete {
        completed(arguments, &recording)
    } else {
        saved(arguments, &recording)
    };
    let report = report.with_context(context)?;
    report::print(&report, arguments.form.format(), || report.page())?;
    Ok(match report.lost {
        None => Done::Well,
        Some(_) => Done::WithLosses,
    })
}

fn completed(arguments: &RecoverArguments, recording: &Recording) -> Result<RecoverReport, Error> {
    let existing = Existing::forced(arguments.force);
    let progress = Progress::of_bytes("comparing", 2 * recording.size());
    let completed = complete(recording, &arguments.output, existing, &|bytes| {
        progress.add(bytes);
    });
    progress.finish();
    let archived = completed?;
    let form_lost = recording.form().is_none().then(|| {
        "how the run was recorded: this is the whole run, simulated again, as JSON with all topics and views".to_owned()
    });
    let former = recording.version().filter(|version| !version.is_current());
    let form_lost = form_lost.or_else(|| {
        let (number, this) = (former?.number(), table::VERSION);
        Some(format!(
            "telemetry {number}, in which it was recorded: this is the whole run, simulated again, as telemetry {this}"
        ))
    });
    Ok(RecoverReport {
        file: archived.path.display().to_string(),
        bytes: archived.bytes,
        content_digest: archived.digest,
        is_completed: true,
        can_complete: true,
        messages: None,
        undecodable: 0,
        losses: Vec::new(),
        lost: form_lost,
    })
}

fn saved(arguments: &RecoverArguments, recording: &Recording) -> Result<RecoverReport, Error> {
    let existing = Existing::forced(arguments.force);
    let progress = Progress::of_bytes("recovering", recording.size());
    let saved = salvage(recording, &arguments.output, existing, &|bytes| {
        progress.add(bytes);
    });
    progress.finish();
    let recovered = saved?;
    Ok(RecoverReport {
        file: recovered.archived.path.display().to_string(),
        bytes: recovered.archived.bytes,
        content_digest: recovered.archived.digest,
        is_completed: false,
        can_complete: recording.scenario().is_ok(),
        messages: Some(recovered.messages),
        undecodable: recovered.undecodable,
        losses: recovered.losses.iter().map(ToString::to_string).collect(),
        lost: recovered.lost,
    })
}

impl RecoverReport {
    fn page(&self) -> Page {
        let mut facts = vec![("wrote", report::file_line(&self.file, self.bytes))];
        if let Some(messages) = self.messages {
            facts.push(("saved", format!("{} messages", numbers::count(messages))));
        }
        let lost = match &self.lost {
            Some(lost) => lost.clone(),
            None if self.is_completed => {
                "nothing: this is the whole run, simulated again, and what could be read of it is equal, \
                 bit for bit"
                    .to_owned()
            }
            None => "nothing: the content is what the end record says".to_owned(),
        };
        facts.push(("lost", lost));
        if self.lost.is_some() && self.can_complete && !self.is_completed {
            facts.push((
                "next",
                "the scenario is intact: --complete simulates the whole run again".to_owned(),
            ));
        }
        let mut section = Section::default();
        section.table(Table::of_facts(facts));
        Page::of(section)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn two_files_are_named() {
        assert_eq!(
            parse::<RecoverArguments>("a.mcap.partial a.mcap --complete --force").unwrap(),
            RecoverArguments {
                input: "a.mcap.partial".into(),
                output: "a.mcap".into(),
                complete: true,
                force: true,
                ..RecoverArguments::default()
            }
        );
        assert!(parse::<RecoverArguments>("a.mcap").is_err());
    }
}
