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
use serde_json::{Map, Value, json};
use std::path::Path;

/// Member of a report: the id of its schema.
const SCHEMA: &str = "$schema";
/// Member of a report: the version of the program.
const VERSION: &str = "toprise_version";

/// Prints a report in the selected format; --quiet suppresses text.
pub(super) fn print<R: Serialize + JsonSchema>(
    report: &R,
    sections: impl FnOnce() -> Vec<Section>,
) -> Result<(), Error> {
    match output::format() {
        Format::Text if output::is_quiet() => {}
        Format::Text => output::print_styled(&terminal::render(&sections(), output::columns()))?,
        Format::Markdown => output::print(&markdown(&sections(), terminal::option))?,
        Format::Json => output::print(&json_document(report)?)?,
        // The only command with such a table prints it itself.
        Format::Csv => {}
    }
    Ok(())
}

/// A report as the documents that the formats JSON and Markdown give.
pub(super) fn documents<R: Serialize + JsonSchema>(
    report: &R,
    sections: &[Section],
) -> Result<[String; 2], Error> {
    let json = json_document(report)?;
    let markdown = markdown(sections, terminal::option);
    Ok([json, markdown].map(|text| format!("{}\n", text.trim_end())))
}

/// A report as JSON, with the id of its schema and the version of the program; a list has no place for them.
fn json_document<R: Serialize + JsonSchema>(report: &R) -> Result<String, Error> {
    let document = match serde_json::to_value(report)? {
        Value::Object(members) => {
            let mut document = Map::new();
            document.insert(SCHEMA.to_owned(), schema_id(&R::schema_name()).into());
            document.insert(VERSION.to_owned(), env!("CARGO_PKG_VERSION").into());
            document.extend(members);
            Value::Object(document)
        }
        other => other,
    };
    Ok(sanitized_json(&serde_json::to_string_pretty(&document)?))
}

fn schema_id(name: &str) -> String {
    format!("urn:toprise:{}:{name}", env!("CARGO_PKG_VERSION"))
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
        let _ = output::print(&sanitized_json(&format!("{report:#}")));
    }
}

/// The JSON Schema of a report, as a file name and its content.
pub(super) fn schema<R: JsonSchema>() -> (String, String) {
    let name = R::schema_name();
    let mut schema = schema_for!(R);
    schema.insert("$id".to_owned(), schema_id(&name).into());
    if let Some(Value::Object(members)) = schema.get_mut("properties") {
        for (member, description, value) in [
            (SCHEMA, "The `$id` of this schema", schema_id(&name)),
            (
                VERSION,
                "The version of toprise",
                env!("CARGO_PKG_VERSION").to_owned(),
            ),
        ] {
            let description = format!("{description}; not in Python's reports.");
            let value = json!({ "description": description, "const": value });
            members.insert(member.to_owned(), value);
        }
    }
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
