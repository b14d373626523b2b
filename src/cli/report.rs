//! Reports: what a command found or did, as data. JSON is the data itself; text and Markdown are made from it.

use super::arguments::Format;
use super::numbers::bytes;
use super::output;
use super::page::Page;
use crate::archive::publish::Draft;
use crate::archive::recording::Loss;
use crate::archive::sink::SinkError;
use anyhow::Error;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::Path;

/// Prints a report in the output format; text only without `--quiet`.
pub(super) fn print(report: &impl Serialize, page: impl FnOnce() -> Page) -> Result<(), Error> {
    match output::format() {
        Format::Text if output::is_quiet() => {}
        Format::Text => output::print_styled(&page().text(output::columns()))?,
        Format::Markdown => output::print(&page().markdown())?,
        Format::Json => output::print_json(&serde_json::to_string_pretty(report)?)?,
    }
    Ok(())
}

/// A command that failed.
#[derive(Serialize)]
struct Failure<'a> {
    error: &'a str,
}

/// Prints an error as a report, if reports are JSON: programs find it where they expect the answer.
pub(super) fn print_error(error: &str) {
    if output::format() == Format::Json {
        // Where standard output is gone, standard error has it.
        let _ = print(&Failure { error }, Page::default);
    }
}

/// A file that a command wrote.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(super) struct WrittenFile {
    /// Its place.
    pub(super) path: String,
    /// Its size.
    pub(super) bytes: u64,
}

impl WrittenFile {
    pub(super) fn new(path: &Path, bytes: u64) -> Self {
        Self {
            path: path.display().to_string(),
            bytes,
        }
    }

    /// Gives a draft its name.
    pub(super) fn publish(draft: Draft) -> Result<Self, SinkError> {
        let path = draft.path().to_owned();
        Ok(Self::new(&path, draft.publish()?))
    }

    /// Its path and size, human-readable.
    pub(super) fn line(&self) -> String {
        file_line(&self.path, self.bytes)
    }
}

/// The path and the size of a file, human-readable.
pub(super) fn file_line(path: &str, size: u64) -> String {
    format!("{path}  {}", bytes(size))
}

/// A part of a file that can't be read.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(super) struct LossReport {
    /// Its start in the file, bytes.
    pub(super) offset: u64,
    /// Length, bytes.
    pub(super) length: u64,
    /// Messages are lost from this time on, ns; absent if none are.
    pub(super) from_ns: Option<u64>,
    /// Messages are lost up to this time, ns; absent if the end is not known.
    pub(super) to_ns: Option<u64>,
    /// The reason why it can't be read.
    pub(super) reason: String,
}

impl From<&Loss> for LossReport {
    fn from(loss: &Loss) -> Self {
        Self {
            offset: loss.offset,
            length: loss.length,
            from_ns: loss.span.map(|span| span.from_ns),
            to_ns: loss.span.and_then(|span| span.to_ns),
            reason: loss.reason.clone(),
        }
    }
}
