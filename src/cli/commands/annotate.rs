//! `toprise annotate`.

use crate::archive::publish::{Draft, Drafts, Existing, check_not_an_input};
use crate::archive::recording::Recording;
use crate::archive::supplements::{Supplementary, about, annotate as copy};
use crate::cli::arguments::OUTPUT;
use crate::cli::file_kind::FileKind;
use crate::cli::input::read_about;
use crate::cli::output::warn_of_link;
use crate::cli::report::{self, WrittenFile};
use crate::cli::status::Status;
use crate::words::{Section, Table};
use anyhow::{Context as _, Error};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::io::{BufWriter, IntoInnerError};
use std::path::{Path, PathBuf};

/// Arguments of `toprise annotate`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct AnnotateArguments {
    /// A recording, which stays as it is
    #[arg(value_name = "FILE")]
    recording: PathBuf,

    /// TOML file with title, creators, licence, date and more
    about: PathBuf,

    /// MCAP file to write
    #[arg(short, long, value_name = "FILE", required = true, help_heading = OUTPUT)]
    output: PathBuf,

    /// Overwrite an existing file
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// An annotated copy of a recording.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct AnnotateReport {
    /// The copy.
    mcap: WrittenFile,
    /// What it holds in addition to the run.
    supplements: Vec<Supplementary>,
}

/// Writes a copy of a recording that says who made it, and under which licence it is.
pub(super) fn annotate(arguments: &AnnotateArguments, drafts: &Drafts) -> Result<Status, Error> {
    let AnnotateArguments { output, .. } = arguments;
    FileKind::Mcap.check("-o", output)?;
    let about = read_about(&arguments.about)?;
    let path = &arguments.recording;
    let name = || path.display().to_string();
    let recording = Recording::open(path).with_context(name)?;
    check_not_an_input(output, [path.as_path(), arguments.about.as_path()])?;
    let existing = Existing::forced(arguments.force);
    let draft = Draft::new_in(drafts, output, existing)?;
    warn_of_link(output, arguments.force);
    let record = (about::RECORD, about.to_entries());
    let written = copy(&recording, record, BufWriter::new(draft)).with_context(name)?;
    // The rest of the buffer is written here; when dropped, an error would be lost.
    let draft = written
        .into_inner()
        .map_err(IntoInnerError::into_error)
        .with_context(|| format!("cannot write {}", output.display()))?;
    let report = AnnotateReport::new(WrittenFile::publish(draft)?, output)?;
    report::print(&report, || report.page())?;
    Ok(Status::Success)
}

impl AnnotateReport {
    /// Reads what was written at `path`.
    fn new(mcap: WrittenFile, path: &Path) -> Result<Self, Error> {
        let written = Recording::open(path).with_context(|| path.display().to_string())?;
        Ok(Self {
            mcap,
            supplements: written.supplements(),
        })
    }

    fn page(&self) -> Vec<Section> {
        let mut facts = vec![("wrote", self.mcap.line())];
        let supplements = self.supplements.iter().map(ToString::to_string);
        facts.extend(supplements.map(|supplement| ("in addition", supplement)));
        vec![Section::from(Table::from_facts(facts))]
    }
}
