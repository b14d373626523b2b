//! Channels and attachments that a recording has in addition to its run.

use crate::archive::container::attachment::Attachment;
use crate::archive::recording::{Recording, Selection};
use crate::telemetry::Topics;
use crate::telemetry::supplement::SUPPLEMENTARY_ATTACHMENTS;
use crate::words::plural;
use schemars::JsonSchema;
use serde::Serialize;
use std::fmt;

/// A channel or an attachment in addition to the run.
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
}

impl fmt::Display for Supplementary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (name, count, noun) = match self {
            Self::Channel { topic, messages } => (topic, *messages, "message"),
            Self::Attachment { name, size } => (name, *size, "byte"),
        };
        write!(f, "{name} ({count} {})", plural(count, noun))
    }
}

/// Whether an attachment is one that a recording may have in addition to its scenario.
pub(super) fn is_supplementary(attachment: &Attachment) -> bool {
    let header = &attachment.header;
    attachment.is_intact
        && (header.log_time, header.create_time) == (0, 0)
        && SUPPLEMENTARY_ATTACHMENTS
            .iter()
            .any(|kind| (kind.name, kind.media_type) == (&header.name, &header.media_type))
}

/// The channels and attachments in addition to the run.
pub(super) fn list(recording: &Recording) -> Vec<Supplementary> {
    let mut found = Vec::new();
    for (channel, messages) in recording.channels().iter().zip(count_messages(recording)) {
        if channel.is_supplement() {
            found.push(Supplementary::Channel {
                topic: channel.topic.clone(),
                messages,
            });
        }
    }
    for attachment in &recording.layout.attachments {
        if is_supplementary(attachment) {
            found.push(Supplementary::Attachment {
                name: attachment.header.name.clone(),
                size: attachment.data_length,
            });
        }
    }
    found
}

/// Number of messages of each supplementary channel; 0 for the channels of the run.
fn count_messages(recording: &Recording) -> Vec<u64> {
    let channels = recording.channels();
    let mut counts = vec![0; channels.len()];
    let topics: Vec<String> = channels
        .iter()
        .filter(|channel| channel.is_supplement())
        .map(|channel| channel.topic.clone())
        .collect();
    // Most recordings have none, and need not be read again.
    if topics.is_empty() {
        return counts;
    }
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(topics),
        ..Selection::default()
    });
    while let Some(message) = reader.next_undecoded() {
        counts[message.position] += 1;
    }
    counts
}
