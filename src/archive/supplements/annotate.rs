//! Annotating a recording: a copy that holds a metadata record more.

use super::{Supplements, copy_channels};
use crate::archive::format::{
    END_RECORD, Entries, RUN_RECORD, SCENARIO_ATTACHMENT, is_reserved, is_reserved_attachment,
};
use crate::archive::recording::{Condition, Recording};
use crate::archive::writer::{metadata, options};
use mcap::write::NoSeek;
use mcap::{McapError, Writer};
use std::io::Write;
use thiserror::Error;

/// Error of annotating a recording.
#[derive(Debug, Error)]
pub enum AnnotateError {
    /// It is not a whole recording of toprise: a copy would hide that.
    #[error("it is {}: only a whole recording of toprise can be annotated", .0.name())]
    NotWhole(Condition),
    /// It has a metadata record or an attachment with a reserved name that belongs to no run.
    #[error(
        "it has {0}, a name that is reserved for toprise and belongs to no run: see toprise verify"
    )]
    Reserved(String),
    /// Parts of it can't be read.
    #[error("parts of it can't be read, and a copy would lack them: see toprise info")]
    Unreadable,
    /// The target can't be written, or the recording can't be read.
    #[error(transparent)]
    Mcap(#[from] McapError),
}

/// Copies a recording, its supplements included, into `target`, with a metadata record instead of those of its name. The
/// bytes are those of a new run of its scenario by its version, with the same supplements.
///
/// # Errors
/// [`AnnotateError`].
pub fn annotate<W: Write>(
    recording: &Recording,
    record: (&'static str, Entries),
    target: W,
) -> Result<W, AnnotateError> {
    if recording.condition() != Condition::Whole {
        return Err(AnnotateError::NotWhole(recording.condition()));
    }
    if let Some(name) = unknown_name(recording) {
        return Err(AnnotateError::Reserved(name.to_owned()));
    }
    let options = options()
        .library(recording.library())
        .profile(recording.profile());
    let mut writer = options.create(NoSeek::new(target))?;
    copy_run(recording, &mut writer)?;
    let supplements = Supplements {
        source: Some(recording),
        metadata: Some(record),
    };
    supplements.write(&mut writer)?;
    if let Some(end) = recording.end() {
        writer.write_metadata(&metadata(END_RECORD, end.clone()))?;
    }
    writer.finish()?;
    Ok(writer.into_inner().into_inner())
}

/// A reserved name of a metadata record or an attachment that no run has: the copy would lack it.
fn unknown_name(recording: &Recording) -> Option<&str> {
    let metadata = recording.all_metadata().map(|(name, _)| name);
    let metadata =
        metadata.filter(|name| is_reserved(name) && ![RUN_RECORD, END_RECORD].contains(name));
    let attachments = recording.attachments().map(|(name, _)| name);
    let attachments =
        attachments.filter(|name| is_reserved_attachment(name) && *name != SCENARIO_ATTACHMENT);
    metadata.chain(attachments).next()
}

/// Copies what belongs to the run, except its end record, in the order in which a run is written.
fn copy_run<W: Write>(
    recording: &Recording,
    writer: &mut Writer<NoSeek<W>>,
) -> Result<(), AnnotateError> {
    if let Some(run) = recording.run() {
        writer.write_metadata(&metadata(RUN_RECORD, run.clone()))?;
    }
    for attachment in &recording.layout.attachments {
        if attachment.header.name == SCENARIO_ATTACHMENT {
            attachment.copy(&recording.source, writer)?;
        }
    }
    writer.flush()?;
    if copy_channels(recording, |channel| !channel.is_supplement(), writer)? {
        Ok(())
    } else {
        Err(AnnotateError::Unreadable)
    }
}
