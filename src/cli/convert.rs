//! `toprise convert`.

use super::progress::Progress;
use super::{Done, EncodingName, format, output};
use crate::archive::convert::convert as write;
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use anyhow::{Context as _, Error};
use clap::Args;
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
    encoding: EncodingName,

    /// Replace the file if it exists.
    #[arg(long)]
    force: bool,
}

/// Writes a recording in another encoding.
pub(super) fn convert(arguments: &ConvertArguments) -> Result<Done, Error> {
    let context = || arguments.input.display().to_string();
    let recording = Recording::open(&arguments.input).with_context(context)?;
    let existing = Existing::forced(arguments.force);
    let progress = Progress::of_bytes("converting", recording.size());
    let encoding = arguments.encoding.into();
    let written = write(
        &recording,
        &arguments.output,
        existing,
        encoding,
        &|bytes| {
            progress.add(bytes);
        },
    );
    progress.finish();
    let archived = written.with_context(context)?;
    output::print(&format!(
        "wrote {}  {}\ncontent sha-256 {}, as before",
        archived.path.display(),
        format::bytes(archived.bytes),
        archived.digest
    ))?;
    Ok(Done::Well)
}
