//! Checks that the channels of a summary are those of the data.

use super::equality::{check_equal, list};
use crate::archive::recording::{FileChannel, Recording};
use crate::archive::verify::difference::Difference;
use crate::words::plural;
use mcap::{Channel, Summary};
use std::collections::BTreeMap;

/// A channel, in the summary or in the data.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct ListedChannel {
    id: u16,
    topic: String,
    encoding: String,
    metadata: BTreeMap<String, String>,
    schema: Option<Schema>,
}

/// The schema of a channel.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Schema {
    name: String,
    language: String,
    data: Vec<u8>,
}

/// Compares the channels of the summary with those of the data. Without any, readers search the data.
pub(super) fn check(recording: &Recording, summary: &Summary) -> Result<(), Difference> {
    if summary.channels.is_empty() {
        return Ok(());
    }
    let mut stated: Vec<_> = summary
        .channels
        .values()
        .map(|channel| ListedChannel::from_summary(channel))
        .collect();
    let mut found: Vec<_> = recording
        .channels()
        .iter()
        .map(ListedChannel::from_data)
        .collect();
    // The summary may have another order. Hashes of the summary's map must not decide what is named first.
    stated.sort_unstable();
    found.sort_unstable();
    // Only what differs is shown, since there may be dozens of channels.
    check_equal(
        "the channels of the summary",
        &without(&stated, &found),
        &without(&found, &stated),
        |channels| list(channels.iter().map(|channel| channel.describe())),
    )
}

/// The definitions of the first list that are not in the second.
fn without<'d>(all: &'d [ListedChannel], others: &[ListedChannel]) -> Vec<&'d ListedChannel> {
    all.iter()
        .filter(|definition| !others.contains(definition))
        .collect()
}

impl ListedChannel {
    fn from_summary(channel: &Channel<'_>) -> Self {
        Self {
            id: channel.id,
            topic: channel.topic.clone(),
            encoding: channel.message_encoding.clone(),
            metadata: channel.metadata.clone(),
            schema: channel.schema.as_ref().map(|schema| Schema {
                name: schema.name.clone(),
                language: schema.encoding.clone(),
                data: schema.data.to_vec(),
            }),
        }
    }

    fn from_data(channel: &FileChannel) -> Self {
        Self {
            id: channel.id,
            topic: channel.topic.clone(),
            encoding: channel.encoding.clone(),
            metadata: channel.metadata.clone(),
            schema: channel.schema.as_ref().map(|schema| Schema {
                name: schema.name.clone(),
                language: schema.encoding.clone(),
                data: schema.data.clone(),
            }),
        }
    }

    fn describe(&self) -> String {
        let schema = match &self.schema {
            Some(schema) => format!(
                "the {} {:?} of {} bytes (crc32 {:08x})",
                schema.language,
                schema.name,
                schema.data.len(),
                crc32fast::hash(&schema.data)
            ),
            None => "no schema".to_owned(),
        };
        let metadata = match self.metadata.len() {
            0 => String::new(),
            count => format!(" and {count} metadata {}", plural(count as u64, "entry")),
        };
        format!(
            "channel {} {} in {} with {schema}{metadata}",
            self.id, self.topic, self.encoding
        )
    }
}
