//! Reports of commands. They are serialized as JSON, or rendered as text or Markdown.

use super::arguments::Format;
use super::text::sanitized_json;
use super::{output, terminal};
use crate::archive::publish::Draft;
use crate::archive::sink::SinkError;
use crate::words::number::bytes;
use crate::words::{Section, markdown};
use anyhow::Error;
use schemars::{JsonSchema, schema_for};
use serde::Serialize;
use serde_json::json;
use std::path::Path;

/// Prints a report in the selected format; --quiet suppresses text.
pub(super) fn print(
    report: &impl Serialize,
    sections: impl FnOnce() -> Vec<Section>,
) -> Result<(), Error> {
    match output::format() {
        Format::Text if output::is_quiet() => {}
        Format::Text => output::print_styled(&terminal::render(&sections(), output::columns()))?,
        Format::Markdown => output::print(&markdown(&sections(), terminal::option))?,
        Format::Json => output::print(&sanitized_json(&serde_json::to_string_pretty(report)?))?,
    }
    Ok(())
}

/// A report as the documents that the formats JSON and Markdown give.
pub(super) fn documents(
    report: &impl Serialize,
    sections: &[Section],
) -> Result<[String; 2], Error> {
    let json = sanitized_json(&serde_json::to_string_pretty(report)?);
    let markdown = markdown(sections, terminal::option);
    Ok([json, markdown].map(|text| format!("{}\n", text.trim_end())))
}

/// With --format json, prints an error as JSON on standard output, with the key of the scenario that is wrong, if any.
pub(super) fn print_error(error: &str, key: Option<&str>) {
    if output::format() == Format::Json {
        // Programs that read reports find the reason where the report would be.
        let mut report = json!({ "error": error });
        if let Some(key) = key {
            report["key"] = json!(key);
        }
        // The error is on standard error, too.
        let _ = print(&report, Vec::new);
    }
}

/// The JSON Schema of a report, as a file name and its content.
pub(super) fn schema<R: JsonSchema>(name: &str) -> (String, String) {
    let mut schema = schema_for!(R);
    let version = env!("CARGO_PKG_VERSION");
    let id = format!("urn:toprise:{version}:{name}");
    schema.insert("$id".to_owned(), id.into());
    (
        format!("toprise.{name}.json"),
        format!("{:#}\n", schema.as_value()),
    )
}

/// A file that a command wrote.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub(super) struct WrittenFile {
    /// Path of the file.
    pub(super) path: String,
    /// Size, bytes.
    pub(super) bytes: u64,
}

impl WrittenFile {
    pub(super) fn new(path: &Path, bytes: u64) -> Self {
        Self {
            path: path.display().to_string(),
            bytes,
        }
    }

    /// Publishes a draft.
    pub(super) fn publish(draft: Draft) -> Result<Self, SinkError> {
        let path = draft.path().to_owned();
        Ok(Self::new(&path, draft.publish()?))
    }

    /// Path and size of the file, human-readable.
    pub(super) fn line(&self) -> String {
        file_line(&self.path, self.bytes)
    }
}

/// The path and the size of a file, human-readable.
pub(super) fn file_line(path: &str, size: u64) -> String {
    format!("{path}  {}", bytes(size))
}

/// A Rerun stream that has ended.
#[derive(Debug, Default)]
pub(super) struct Completed {
    /// The file that was written.
    pub(super) file: Option<WrittenFile>,
    /// Whether a viewer went away before it had everything.
    pub(super) is_viewer_lost: bool,
}
