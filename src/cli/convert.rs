//! `toprise convert`.

use super::arguments::FormArguments;
use super::done::Done;
use super::page::{Page, Section};
use super::progress::Progress;
use super::report;
use super::table::Table;
use crate::archive::convert::convert as write;
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use crate::telemetry::encoding::Encoding;
use anyhow::{Context as _, Error};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::PathBuf;

/// Arguments of `toprise convert`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ConvertArguments {
    /// A recording (MCAP file).
    #[arg(value_name = "IN")]
    input: PathBuf,

    /// The file to write.
    #[arg(value_name = "OUT")]
    output: PathBuf,

    /// Encoding of the new recording's messages.
    #[arg(long, value_enum)]
    encoding: Encoding,

    /// Replace the file if it exists.
    #[arg(long)]
    force: bool,

    #[command(flatten)]
    form: FormArguments,
}

/// What a conversion has written.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct ConvertReport {
    /// The new recording.
    file: String,
    /// Its size.
    bytes: u64,
    /// The encoding of its messages.
    encoding: Encoding,
    /// SHA-256 of its content, which is that of the old recording.
    content_digest: String,
}

/// Writes a recording in another encoding.
pub(super) fn convert(arguments: &ConvertArguments) -> Result<Done, Error> {
    let context = || arguments.input.display().to_string();
    let recording = Recording::open(&arguments.input).with_context(context)?;
    let progress = Progress::of_bytes("converting", recording.size());
    let written = write(
        &recording,
        &arguments.output,
        Existing::forced(arguments.force),
        arguments.encoding,
        &|bytes| progress.add(bytes),
    );
    progress.finish();
    let archived = written.with_context(context)?;
    let report = ConvertReport {
        file: archived.path.display().to_string(),
        bytes: archived.bytes,
        encoding: arguments.encoding,
        content_digest: archived.digest,
    };
    report::print(&report, arguments.form.format(), || report.page())?;
    Ok(Done::Well)
}

impl ConvertReport {
    fn page(&self) -> Page {
        let mut section = Section::default();
        section.table(Table::of_facts(vec![
            ("wrote", report::file_line(&self.file, self.bytes)),
            (
                "content",
                format!("sha-256 {}, as before", self.content_digest),
            ),
        ]));
        Page::of(section)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn an_encoding_must_be_chosen() {
        assert_eq!(
            parse::<ConvertArguments>("a.mcap b.mcap --encoding protobuf").unwrap(),
            ConvertArguments {
                input: "a.mcap".into(),
                output: "b.mcap".into(),
                encoding: Encoding::Protobuf,
                force: false,
                form: FormArguments::default(),
            }
        );
        for line in ["a.mcap b.mcap", "a.mcap b.mcap --encoding xml", "a.mcap"] {
            assert!(parse::<ConvertArguments>(line).is_err(), "{line}");
        }
    }
}
