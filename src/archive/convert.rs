//! A recording in another encoding: the same content, metadata and attachments.

use crate::archive::format::{
    CONTENT_DIGEST, ENCODING, END_RECORD, LIBRARY, RECOVERY_RECORD, RUN_RECORD,
};
use crate::archive::publish::{Draft, Existing};
use crate::archive::recording::{
    Any, Condition, Entries, FileChannel, MessageError, Recording, RecordingError, Selection,
    Undecoded,
};
use crate::archive::sink::{Sink as _, SinkError};
use crate::archive::writer::{Archived, Ending, McapSink, Opening, RawChannel, RawMessage};
use crate::telemetry::encoding::Encoding;
use crate::telemetry::{Topic, Version};
use std::borrow::Cow;
use std::path::Path;
use thiserror::Error;

/// Why a recording can't be converted.
#[derive(Debug, Error)]
pub enum ConvertError {
    /// The file was written by another program, or is incomplete.
    #[error("it is {}: {advice}", condition.name())]
    Condition {
        /// What the file is.
        condition: Condition,
        /// What can be done.
        advice: &'static str,
    },
    /// The recording has other fields than the telemetry that it names: some would be lost.
    #[error("its telemetry is none that this toprise knows: {topic} differs in {}", fields.join(", "))]
    Version {
        /// The first topic that differs.
        topic: String,
        /// The fields.
        fields: Vec<String>,
    },
    /// The recording is of a newer version.
    #[error(transparent)]
    Newer(#[from] RecordingError),
    /// The content is not what the end record says.
    #[error(
        "its content is not what its end record says (digest {found}, not {expected}): messages are changed, missing \
         or out of order, as toprise verify tells"
    )]
    Content {
        /// The digest in the end record.
        expected: String,
        /// The digest of the content.
        found: String,
    },
    /// An attachment is damaged.
    #[error("its attachment {name} is damaged: {reason}")]
    Attachment {
        /// Its name.
        name: String,
        /// What is wrong.
        reason: String,
    },
    /// A message can't be decoded.
    #[error(transparent)]
    Message(#[from] MessageError),
    /// Parts of it can't be read.
    #[error("it is damaged: {0}; save what there is with toprise recover")]
    Damage(String),
    /// The result can't be written.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

/// Writes `recording` to `path` with the channels of the table in `encoding`.
///
/// The content digest of the new recording is checked against the end record before the file gets its
/// name. So a recording may be converted in its place, with [`Existing::Replace`]. `progress` is told how many more bytes have been read.
///
/// # Errors
/// [`ConvertError`]; nothing is left at `path` then.
pub fn convert(
    recording: &Recording,
    path: &Path,
    existing: Existing,
    encoding: Encoding,
    progress: &dyn Fn(u64),
) -> Result<Archived, ConvertError> {
    check_condition(recording)?;
    recording.refuse_newer()?;
    let version = recording.version().unwrap_or_default();
    check_fields(recording, &version)?;
    let opening = opening(recording, version, encoding)?;
    let ending = ending(recording);
    let mut sink = McapSink::open(Draft::new(path, existing)?, &opening)?;
    copy(recording, &mut sink, progress)?;
    sink.finish_with(ending).map_err(|error| match error {
        SinkError::Digest {
            expected, found, ..
        } => ConvertError::Content { expected, found },
        error => error.into(),
    })
}

fn check_condition(recording: &Recording) -> Result<(), ConvertError> {
    let condition = recording.condition();
    let advice = match condition {
        Condition::Whole | Condition::Recovered => return Ok(()),
        Condition::Foreign => "only recordings of toprise can be converted",
        Condition::Interrupted | Condition::Damaged => {
            "save what there is with toprise recover, and convert that"
        }
    };
    Err(ConvertError::Condition { condition, advice })
}

/// Refuses a recording that has other fields than its version of the telemetry.
fn check_fields(recording: &Recording, version: &Version) -> Result<(), ConvertError> {
    for (topic, fields) in recording.differences() {
        let info = Topic::find(&topic).map(|topic| &version.channels()[topic.index()]);
        let is_its = |path: &String| info.is_some_and(|i| i.leaves().any(|l| l.path == *path));
        let missing = fields.missing.into_iter().filter(is_its);
        let fields: Vec<_> = missing.chain(fields.unknown).collect();
        if !fields.is_empty() {
            return Err(ConvertError::Version { topic, fields });
        }
    }
    Ok(())
}

/// Everything that comes before the messages.
fn opening(
    recording: &Recording,
    version: Version,
    encoding: Encoding,
) -> Result<Opening, ConvertError> {
    let attachments = attachments(recording).collect::<Result<_, _>>()?;
    Ok(Opening {
        library: LIBRARY,
        metadata: metadata_but(recording, &[END_RECORD, RECOVERY_RECORD])
            .map(|(name, mut entries)| {
                if name == RUN_RECORD {
                    name_encoding(&mut entries, encoding);
                }
                (name, entries)
            })
            .collect(),
        attachments,
        version,
        encoding,
        wanted: wanted(recording),
        raw: raw(recording),
    })
}

/// Names another encoding in the record of the run, if it names one.
fn name_encoding(run: &mut Entries, encoding: Encoding) {
    if let Some(named) = run.get_mut(ENCODING) {
        encoding.name().clone_into(named);
    }
}

/// The metadata records of a recording, but for those with some names.
pub(crate) fn metadata_but(
    recording: &Recording,
    names: &[&str],
) -> impl Iterator<Item = (String, Entries)> {
    let kept = recording.all_metadata();
    let kept = kept.filter(move |(name, _)| !names.contains(name));
    kept.map(|(name, entries)| (name.to_owned(), entries.clone()))
}

/// The attachments of a recording, or what is wrong with them.
pub(crate) fn attachments(
    recording: &Recording,
) -> impl Iterator<Item = Result<mcap::Attachment<'static>, ConvertError>> {
    recording.layout.attachments.iter().map(|attachment| {
        let read = recording.attachment(&attachment.place);
        let (header, data) = read.map_err(|reason| ConvertError::Attachment {
            name: attachment.name.clone(),
            reason,
        })?;
        Ok(mcap::Attachment {
            log_time: header.log_time,
            create_time: header.create_time,
            name: header.name,
            media_type: header.media_type,
            data: Cow::Owned(data),
        })
    })
}

/// Which channels of the table a recording has.
pub(crate) fn wanted(recording: &Recording) -> Vec<bool> {
    Topic::all().map(|topic| recording.has(topic)).collect()
}

/// The channels of a recording that are copied as they are.
fn raw_channels(recording: &Recording) -> impl Iterator<Item = &FileChannel> {
    recording.channels().iter().filter(|c| c.table.is_none())
}

/// The channels of a recording that are copied as they are, in the form in which they are written.
pub(crate) fn raw(recording: &Recording) -> Vec<RawChannel> {
    raw_channels(recording).map(raw_channel).collect()
}

fn raw_channel(channel: &FileChannel) -> RawChannel {
    let schema = channel.schema.as_deref().cloned();
    RawChannel {
        topic: channel.topic.clone(),
        encoding: channel.encoding.clone(),
        schema: schema.map(|schema| (schema.name, schema.encoding, schema.data)),
        metadata: channel.metadata.clone(),
    }
}

fn ending(recording: &Recording) -> Ending {
    let end = recording.end().cloned().unwrap_or_default();
    let recovery = recording.recovery().cloned();
    Ending {
        metadata: recovery
            .map(|entries| (RECOVERY_RECORD.to_owned(), entries))
            .into_iter()
            .collect(),
        digest: end.get(CONTENT_DIGEST).cloned(),
        end: Some(end),
    }
}

fn copy(
    recording: &Recording,
    sink: &mut McapSink,
    progress: &dyn Fn(u64),
) -> Result<(), ConvertError> {
    let copier = Copier::new(recording);
    let mut reader = recording.reader(Selection::default());
    while let Some(message) = reader.next_of_any() {
        match message? {
            Any::Decoded(message) => sink.write(&message)?,
            Any::Other(other) => copier.copy(&other, sink)?,
        }
        progress(reader.progress());
    }
    match reader.losses().first() {
        None => Ok(()),
        Some(loss) => Err(ConvertError::Damage(loss.to_string())),
    }
}

/// Copies messages of other channels than the table's as they are.
pub(crate) struct Copier {
    /// For each channel of the recording that is read its place in [`Opening::raw`], if it has one.
    places: Vec<Option<usize>>,
}

impl Copier {
    pub(crate) fn new(recording: &Recording) -> Self {
        let mut raw = 0..;
        let place = |channel: &FileChannel| match channel.table {
            None => raw.next(),
            Some(_) => None,
        };
        Self {
            places: recording.channels().iter().map(place).collect(),
        }
    }

    pub(crate) fn copy(
        &self,
        message: &Undecoded<'_>,
        sink: &mut McapSink,
    ) -> Result<(), SinkError> {
        let Some(channel) = self.places[message.position] else {
            return Ok(());
        };
        sink.write_raw(&RawMessage {
            channel,
            sequence: message.sequence,
            log_time: message.log_time,
            publish_time: message.publish_time,
            data: message.data,
        })
    }
}
