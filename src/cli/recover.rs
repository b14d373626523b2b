//! `toprise recover`.

use super::progress::Progress;
use super::{Done, Format, format, output};
use crate::analysis::complete::complete;
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use crate::archive::recover::{Recovered, recover as save};
use crate::archive::writer::Archived;
use anyhow::{Context as _, Error};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

/// Arguments of `toprise recover`.
#[derive(Args, Debug, PartialEq)]
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

    /// Form of the answer.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    format: Format,
}

/// Saves what can be saved.
pub(super) fn recover(arguments: &RecoverArguments) -> Result<Done, Error> {
    let context = || arguments.input.display().to_string();
    let recording = Recording::open(&arguments.input).with_context(context)?;
    let existing = Existing::forced(arguments.force);
    if arguments.complete {
        let progress = Progress::of_bytes("comparing", 2 * recording.size());
        let completed = complete(&recording, &arguments.output, existing, &|bytes| {
            progress.add(bytes);
        });
        progress.finish();
        let archived = completed.with_context(context)?;
        output::print(&told_of_whole(&archived, arguments.format))?;
        return Ok(Done::Well);
    }
    let progress = Progress::of_bytes("recovering", recording.size());
    let saved = save(&recording, &arguments.output, existing, &|bytes| {
        progress.add(bytes);
    });
    progress.finish();
    let recovered = saved.with_context(context)?;
    let can_complete = recording.scenario().is_ok();
    output::print(&match arguments.format {
        Format::Text => text(&recovered, can_complete),
        Format::Json => json(&recovered),
    })?;
    Ok(match recovered.lost {
        None => Done::Well,
        Some(_) => Done::WithLosses,
    })
}

fn told_of_whole(archived: &Archived, form: Format) -> String {
    match form {
        Format::Text => format!(
            "wrote {}  {}: the whole run, simulated again; what could be read is equal, bit for bit",
            archived.path.display(),
            format::bytes(archived.bytes)
        ),
        Format::Json => format!(
            "{:#}",
            json!({
                "file": archived.path.display().to_string(),
                "bytes": archived.bytes,
                "content_digest": archived.digest,
                "lost": null,
            })
        ),
    }
}

fn text(recovered: &Recovered, can_complete: bool) -> String {
    let archived = &recovered.archived;
    let mut text = format!(
        "wrote {}  {}: {} messages\n",
        archived.path.display(),
        format::bytes(archived.bytes),
        format::count(recovered.messages)
    );
    match &recovered.lost {
        None => text.push_str("nothing is lost: the content is what the end record says\n"),
        Some(lost) => text.push_str(&format!("lost: {lost}\n")),
    }
    if recovered.lost.is_some() && can_complete {
        text.push_str("its scenario is intact: --complete simulates the whole run again\n");
    }
    text
}

fn json(recovered: &Recovered) -> String {
    let archived = &recovered.archived;
    format!(
        "{:#}",
        json!({
            "file": archived.path.display().to_string(),
            "bytes": archived.bytes,
            "content_digest": archived.digest,
            "messages": recovered.messages,
            "undecodable": recovered.undecodable,
            "losses": recovered.losses.iter().map(ToString::to_string).collect::<Vec<_>>(),
            "lost": recovered.lost,
        })
    )
}
