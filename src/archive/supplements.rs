//! Supplements: what a recording holds in addition to its run, such as its licence, the data of a fit or others' topics.
//!
//! They don't follow from the scenario, so `verify` lists them and compares nothing, and no digest covers them. The names
//! of a run's own parts are reserved ([`crate::archive::format`], the topics of the table and of the views): a supplement
//! can't stand for, hide or repeat any of them.

pub mod about;
mod annotate;

pub use self::annotate::{AnnotateError, annotate};
use crate::archive::container::attachment::Attachment;
use crate::archive::format::{Entries, is_reserved, is_reserved_attachment};
use crate::archive::recording::{FileChannel, Recording, Selection};
use crate::archive::writer::metadata;
use crate::telemetry::Topics;
use crate::words::plural;
use mcap::records::MessageHeader;
use mcap::{McapResult, Writer};
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;
use std::io::{Seek, Write};

/// A part of a recording in addition to its run.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Supplementary {
    /// A channel.
    Channel {
        /// Topic.
        topic: String,
        /// Number of messages.
        messages: u64,
    },
    /// An attachment.
    Attachment {
        /// Name.
        name: String,
        /// Size, bytes.
        size: u64,
    },
    /// A metadata record.
    Metadata {
        /// Name.
        name: String,
        /// Its keys and values.
        entries: Entries,
    },
}

impl fmt::Display for Supplementary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (kind, name, count, noun) = match self {
            Self::Channel { topic, messages } => ("", topic, *messages, "message"),
            Self::Attachment { name, size } => ("", name, *size, "byte"),
            Self::Metadata { name, entries } => ("metadata ", name, entries.len() as u64, "entry"),
        };
        write!(f, "{kind}{name} ({count} {})", plural(count, noun))
    }
}

impl Recording {
    /// What it holds in addition to its run. Damaged attachments are not listed.
    pub fn supplements(&self) -> Vec<Supplementary> {
        let channels = self.channels().iter().zip(self.count_supplements());
        let channels = channels.filter(|(channel, _)| channel.is_supplement());
        let mut found: Vec<_> = channels
            .map(|(channel, messages)| Supplementary::Channel {
                topic: channel.topic.clone(),
                messages,
            })
            .collect();
        found.extend(self.supplementary_attachments().map(|attachment| {
            Supplementary::Attachment {
                name: attachment.header.name.clone(),
                size: attachment.data_length,
            }
        }));
        found.extend(
            self.supplementary_metadata()
                .into_iter()
                .map(|(name, entries)| Supplementary::Metadata {
                    name: name.to_owned(),
                    entries: entries.clone(),
                }),
        );
        found
    }

    /// Whether it holds anything in addition to its run, be it damaged.
    fn has_supplements(&self) -> bool {
        let mut attachments = self.layout.attachments.iter();
        self.channels().iter().any(FileChannel::is_supplement)
            || attachments.any(|attachment| !is_reserved_attachment(&attachment.header.name))
            || !self.supplementary_metadata().is_empty()
    }

    fn supplementary_attachments(&self) -> impl Iterator<Item = &Attachment> {
        let attachments = self.layout.attachments.iter();
        attachments.filter(|attachment| is_supplementary(attachment))
    }

    /// The metadata records, each once: some software repeats what it copies.
    fn supplementary_metadata(&self) -> Vec<(&str, &Entries)> {
        let mut records = Vec::new();
        for record in self.all_metadata() {
            if !is_reserved(record.0) && !records.contains(&record) {
                records.push(record);
            }
        }
        records
    }

    /// Number of messages of each supplementary channel; 0 for the channels of the run.
    fn count_supplements(&self) -> Vec<u64> {
        let mut counts = vec![0; self.channels().len()];
        // Most recordings have none, and need not be read again.
        if self.channels().iter().any(FileChannel::is_supplement) {
            let mut reader = self.reader(select(self, FileChannel::is_supplement));
            while let Some(message) = reader.next_undecoded() {
                counts[message.position] += 1;
            }
        }
        counts
    }
}

/// Whether an attachment is a supplement. A damaged one may have had any name.
pub(super) fn is_supplementary(attachment: &Attachment) -> bool {
    attachment.is_intact && !is_reserved_attachment(&attachment.header.name)
}

/// The supplements that are written into a recording.
#[derive(Clone, Debug, Default)]
pub struct Supplements<'r> {
    /// The recording whose supplements are carried along.
    pub source: Option<&'r Recording>,
    /// A metadata record of one's own, instead of those of its name in the source: name and entries.
    pub metadata: Option<(&'static str, Entries)>,
}

impl Supplements<'_> {
    /// Writes the channels with their messages, the attachments and the metadata, in the order of the source. Returns
    /// whether none of them was lost with damage of the source.
    pub(super) fn write<W: Write + Seek>(&self, writer: &mut Writer<W>) -> McapResult<bool> {
        let mut is_whole = true;
        if let Some(source) = self.source {
            is_whole = !(source.is_damaged() && source.has_supplements());
            if source.channels().iter().any(FileChannel::is_supplement) {
                is_whole &= copy_channels(source, FileChannel::is_supplement, writer)?;
            }
            for attachment in source.supplementary_attachments() {
                attachment.copy(&source.source, writer)?;
            }
            for (name, entries) in source.supplementary_metadata() {
                if !self.replaces(name) {
                    writer.write_metadata(&metadata(name, entries.clone()))?;
                }
            }
        }
        if let Some((name, entries)) = &self.metadata {
            writer.write_metadata(&metadata(name, entries.clone()))?;
        }
        Ok(is_whole)
    }

    fn replaces(&self, name: &str) -> bool {
        self.metadata.as_ref().is_some_and(|(own, _)| *own == name)
    }
}

/// Copies the messages of some topics of a recording, and the channels that have `belongs`. Returns whether all of the
/// recording could be read.
fn copy_channels<W: Write + Seek>(
    source: &Recording,
    belongs: impl Fn(&FileChannel) -> bool,
    writer: &mut Writer<W>,
) -> McapResult<bool> {
    let mut ids = Vec::new();
    for channel in source.channels() {
        ids.push(if belongs(channel) {
            channel.register(writer)?
        } else {
            0
        });
    }
    let mut reader = source.reader(select(source, belongs));
    while let Some(message) = reader.next_undecoded() {
        let header = MessageHeader {
            channel_id: ids[message.position],
            sequence: message.sequence,
            // On the clock of the run, if they were logged at other times.
            log_time: message.time_ns,
            publish_time: (message.publish_time.wrapping_sub(message.log_time))
                .wrapping_add(message.time_ns),
        };
        writer.write_to_known_channel(&header, message.data)?;
    }
    Ok(reader.all_losses().is_empty())
}

/// The messages of the channels of a recording that have `belongs`.
fn select(recording: &Recording, belongs: impl Fn(&FileChannel) -> bool) -> Selection {
    let channels = recording.channels().iter();
    let topics = channels
        .filter(|channel| belongs(channel))
        .map(|channel| channel.topic.clone())
        .collect();
    Selection {
        topics: Topics::Only(topics),
        ..Selection::default()
    }
}
