//! Statistics of a file's content, compared with those that it states.

use crate::archive::container::layout::Layout;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::fmt;

/// Messages of a file, counted as they are read.
#[derive(Clone, Debug, Default)]
pub(super) struct MessageTally {
    /// Number of sections that were read.
    sections: usize,
    /// Messages by channel id.
    counts: BTreeMap<u16, u64>,
    /// Earliest and latest log time, ns.
    times: Option<(u64, u64)>,
}

impl MessageTally {
    pub(super) fn count_section(&mut self) {
        self.sections += 1;
    }

    pub(super) fn count_message(&mut self, channel_id: u16, time_ns: u64) {
        *self.counts.entry(channel_id).or_default() += 1;
        let (first, last) = self.times.unwrap_or((time_ns, time_ns));
        self.times = Some((first.min(time_ns), last.max(time_ns)));
    }
}

/// A number in the statistics of a file that contradicts its content.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct StatisticsFault {
    /// The name of the number, e.g. `messages`.
    pub name: String,
    /// The number in the statistics.
    pub stated: u64,
    /// The number in the content.
    pub found: u64,
}

impl fmt::Display for StatisticsFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            name,
            stated,
            found,
        } = self;
        write!(
            f,
            "the statistics contradict the content: {name} {stated}, found {found}"
        )
    }
}

/// The first number of a file's statistics that contradicts its content; `None` unless all of the content was counted.
pub(super) fn find_fault(layout: &Layout, tally: &MessageTally) -> Option<StatisticsFault> {
    let stated = layout.statistics.as_ref()?;
    if tally.sections < layout.sections.len() {
        return None;
    }
    let chunks = layout.sections.iter().filter(|section| section.is_chunk);
    let (first, last) = tally.times.unwrap_or_default();
    let numbers = [
        (
            "messages",
            stated.message_count,
            tally.counts.values().sum(),
        ),
        (
            "schemas",
            u64::from(stated.schema_count),
            layout.channels.schema_count() as u64,
        ),
        (
            "channels",
            u64::from(stated.channel_count),
            layout.channels.list().len() as u64,
        ),
        (
            "attachments",
            u64::from(stated.attachment_count),
            layout.attachments.len() as u64,
        ),
        (
            "metadata records",
            u64::from(stated.metadata_count),
            layout.metadata.len() as u64,
        ),
        (
            "chunks",
            u64::from(stated.chunk_count),
            chunks.count() as u64,
        ),
        ("first time (ns)", stated.message_start_time, first),
        ("last time (ns)", stated.message_end_time, last),
    ];
    let number = numbers
        .into_iter()
        .find(|(_, stated, found)| stated != found);
    if let Some((name, stated, found)) = number {
        return Some(StatisticsFault {
            name: name.to_owned(),
            stated,
            found,
        });
    }
    // The specification: an empty map indicates that this statistic is not available.
    if stated.channel_message_counts.is_empty() {
        return None;
    }
    let ids = stated
        .channel_message_counts
        .keys()
        .chain(tally.counts.keys());
    for id in ids {
        // Some writers list channels without messages, too.
        let fault = StatisticsFault {
            name: format!("messages of channel {id}"),
            stated: stated.channel_message_counts.get(id).copied().unwrap_or(0),
            found: tally.counts.get(id).copied().unwrap_or(0),
        };
        if fault.stated != fault.found {
            return Some(fault);
        }
    }
    None
}
