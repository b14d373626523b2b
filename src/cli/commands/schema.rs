//! `toprise schema`.

use crate::archive::publish::{self, Drafts, Existing};
use crate::cli::report::{self, WrittenFile};
use crate::cli::status::Status;
use crate::run::scenario;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::encoding::protobuf::{proto_file, proto_file_name};
use crate::telemetry::encoding::schema::{file_name, json_schema};
use crate::telemetry::{ChannelInfo, Topic, UnknownTopic, channels};
use crate::words::{Part, Section, Table};
use anyhow::Error;
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `toprise schema`.
#[derive(Args, Debug, PartialEq)]
pub(in crate::cli) struct SchemaArguments {
    /// Topic whose schema to print, e.g. /top/state
    topic: Option<String>,

    /// Print a JSON Schema or a .proto file
    #[arg(long, value_enum, default_value_t = Encoding::Json, requires = "topic")]
    encoding: Encoding,

    /// Write all schemas to this directory (overwrites existing files)
    #[arg(long, value_name = "DIRECTORY", conflicts_with = "topic")]
    write: Option<PathBuf>,
}

/// The listed channels.
#[derive(Debug, Default, Serialize, JsonSchema)]
pub(super) struct SchemaReport {
    /// The channels.
    channels: Vec<ChannelSchema>,
    /// The files that were written.
    written: Vec<WrittenFile>,
}

/// A channel of toprise's recordings.
#[derive(Debug, Serialize, JsonSchema)]
struct ChannelSchema {
    /// Topic.
    topic: &'static str,
    /// The name of its message type.
    schema: &'static str,
    /// Description.
    meaning: &'static str,
    /// The schema language: JSON Schema or protobuf.
    encoding: Encoding,
    /// The definition of its messages.
    definition: String,
}

/// Lists the channels, prints one schema, or writes all schemas including those of `reports`.
pub(super) fn schema(
    arguments: &SchemaArguments,
    reports: Vec<(String, String)>,
    drafts: &Drafts,
) -> Result<Status, Error> {
    let mut report = SchemaReport::default();
    match (&arguments.write, &arguments.topic) {
        (Some(directory), _) => report.written = write_all(directory, reports, drafts)?,
        (None, None) => report.add(channels(), arguments.encoding),
        (None, Some(name)) => {
            let topic = Topic::find(name).ok_or_else(|| UnknownTopic { name: name.clone() })?;
            report.add([topic.info()], arguments.encoding);
        }
    }
    let is_one = arguments.topic.is_some();
    report::print(&report, || report.page(is_one))?;
    Ok(Status::Success)
}

impl SchemaReport {
    fn add(
        &mut self,
        channels: impl IntoIterator<Item = &'static ChannelInfo>,
        encoding: Encoding,
    ) {
        for channel in channels {
            self.channels.push(ChannelSchema {
                topic: channel.topic,
                schema: channel.schema,
                meaning: channel.meaning,
                encoding,
                definition: match encoding {
                    Encoding::Json => json_schema(channel),
                    Encoding::Protobuf => proto_file(channel),
                },
            });
        }
    }

    fn page(&self, is_one: bool) -> Vec<Section> {
        let mut section = Section::default();
        if is_one {
            // Verbatim, so that the output is a schema file.
            for channel in &self.channels {
                section.parts.push(Part::Code(channel.definition.clone()));
            }
        } else {
            section.table(Table::from_texts(self.channels.iter().map(|channel| {
                [channel.topic, channel.schema, channel.meaning]
                    .map(str::to_owned)
                    .to_vec()
            })));
        }
        let written = self.written.iter().map(|file| ("wrote", file.line()));
        section.table(Table::from_facts(written));
        vec![section]
    }
}

/// Writes the schemas of the channels in both encodings, of scenarios and of reports.
fn write_all(
    directory: &Path,
    reports: Vec<(String, String)>,
    drafts: &Drafts,
) -> Result<Vec<WrittenFile>, Error> {
    let mut schemas = Vec::new();
    for channel in channels() {
        schemas.push((file_name(channel), json_schema(channel)));
        schemas.push((proto_file_name(channel), proto_file(channel)));
    }
    schemas.extend(reports);
    schemas.push((scenario::SCHEMA_FILE.to_owned(), scenario::schema()));
    let mut written = Vec::new();
    for (name, text) in schemas {
        let path = directory.join(name);
        // Generated files: nothing is lost.
        publish::write_in(drafts, &path, Existing::Replace, text.as_bytes())?;
        written.push(WrittenFile::new(&path, text.len() as u64));
    }
    Ok(written)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_a_topic_or_a_directory() {
        let base = parse::<SchemaArguments>("").unwrap();
        assert_eq!(
            parse::<SchemaArguments>("/top/state --encoding protobuf").unwrap(),
            SchemaArguments {
                topic: Some("/top/state".to_owned()),
                encoding: Encoding::Protobuf,
                ..base
            }
        );
        for line in ["--encoding protobuf", "/events --write schemas"] {
            assert!(parse::<SchemaArguments>(line).is_err(), "{line}");
        }
    }
}
