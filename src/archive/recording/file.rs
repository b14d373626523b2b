//! A recording as an open file.

use super::condition::Condition;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::layout::Layout;
use crate::archive::container::loss::Loss;
use crate::archive::container::record::{HEAD, RecordSpan, parse};
use crate::archive::container::source::Source;
use crate::archive::error::RecordingError;
use crate::archive::format::{
    END_RECORD, Entries, Form, RUN_RECORD, SCENARIO_ATTACHMENT, STOP_REASON, recorded_form,
};
use crate::run::scenario::Scenario;
use crate::run::simulation::StopReason;
use crate::telemetry::encoding::{Encoding, FieldDifferences};
use crate::telemetry::{Topic, Topics};
use mcap::records::Record;
use std::path::{Path, PathBuf};

/// Maximum size of a scenario, bytes.
const LONGEST_SCENARIO: u64 = 1 << 20;

/// An MCAP file, opened for reading.
///
/// Stores positions only, so memory use is independent of the number of messages.
#[derive(Debug)]
pub struct Recording {
    pub(crate) source: Source,
    pub(crate) layout: Layout,
    path: PathBuf,
}

impl Recording {
    /// Opens and scans a file.
    ///
    /// # Errors
    /// [`RecordingError`] if it can't be opened or is not an MCAP file. Damage is not an error.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        let source = Source::open(path)?;
        let layout = Layout::read(&source)?;
        let recording = Self {
            source,
            layout,
            path: path.to_owned(),
        };
        let topics = recording.topics();
        let mut later = topics.iter().enumerate();
        let twice = later.find(|(at, topic)| topics[..*at].contains(topic));
        if let Some((_, twice)) = twice
            && recording.condition() != Condition::Foreign
        {
            return Err(RecordingError::because(format!(
                "it has two channels named {twice}, which is ambiguous"
            )));
        }
        Ok(recording)
    }

    /// Its path.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Its size, bytes.
    pub fn size(&self) -> u64 {
        self.source.length()
    }

    /// The library field of its header.
    pub fn library(&self) -> &str {
        &self.layout.library
    }

    /// The profile of its header: the conventions that it follows in addition to those of MCAP.
    pub fn profile(&self) -> &str {
        &self.layout.profile
    }

    /// State of the file.
    pub fn condition(&self) -> Condition {
        if self.run().is_none() && !self.layout.is_ours() {
            return Condition::Foreign;
        }
        let cut_in_the_middle = self.end().is_some() && !self.layout.is_ended;
        if self.layout.losses.iter().any(|loss| !self.is_tail(loss)) || cut_in_the_middle {
            Condition::Damaged
        } else if self.end().is_none() {
            Condition::Interrupted
        } else {
            Condition::Whole
        }
    }

    /// Whether a loss is only the last, incompletely written record.
    fn is_tail(&self, loss: &Loss) -> bool {
        self.end().is_none() && loss.offset + loss.length == self.size()
    }

    /// The entries of the `toprise.run` record.
    pub fn run(&self) -> Option<&Entries> {
        self.metadata(RUN_RECORD)
    }

    /// The entries of the `toprise.end` record; `None` if the run did not end.
    pub fn end(&self) -> Option<&Entries> {
        self.metadata(END_RECORD)
    }

    /// Whether the run was interrupted.
    pub fn is_interrupted(&self) -> bool {
        let reason = self.end().map(|end| end.get(STOP_REASON));
        let interrupted = StopReason::Interrupted.name();
        reason.is_none_or(|reason| reason.is_some_and(|reason| reason == interrupted))
    }

    /// The entries of the first metadata record with a name.
    pub fn metadata(&self, name: &str) -> Option<&Entries> {
        let mut records = self.layout.metadata.iter();
        records.find(|r| r.name == name).map(|r| &r.metadata)
    }

    /// Form and topics, from `toprise.run` or from the channels; `None` if both are lost.
    pub fn form(&self) -> Option<(Form, Topics)> {
        let named = self.run().and_then(recorded_form);
        named.or_else(|| {
            let views = self.channels().iter().any(FileChannel::is_view);
            let encoding = self.encoding()?;
            Some((Form { encoding, views }, Topics::Only(self.topics())))
        })
    }

    /// All metadata records: names and entries, in the order of the file.
    pub fn all_metadata(&self) -> impl Iterator<Item = (&str, &Entries)> {
        let records = self.layout.metadata.iter();
        records.map(|record| (record.name.as_str(), &record.metadata))
    }

    /// All channels, in the order of the file.
    pub fn channels(&self) -> &[FileChannel] {
        self.layout.channels.list()
    }

    /// The common encoding of its table channels, if any.
    pub fn encoding(&self) -> Option<Encoding> {
        let mut ours = self.channels().iter().filter(|c| c.table.is_some());
        let first = ours.next()?;
        ours.all(|channel| channel.encoding == first.encoding)
            .then(|| Encoding::find(&first.encoding))?
    }

    /// Whether it has this channel of the table.
    pub fn has(&self, topic: Topic) -> bool {
        self.channels().iter().any(|c| c.table == Some(topic))
    }

    /// The topics of the table that it has, in the order of the file.
    pub fn topics(&self) -> Vec<Topic> {
        self.channels().iter().filter_map(|c| c.table).collect()
    }

    /// Damage found on opening.
    pub fn losses(&self) -> &[Loss] {
        &self.layout.losses
    }

    /// Differences from this version: topics with missing or unknown fields, and unknown topics.
    pub fn differences(&self) -> Vec<(String, FieldDifferences)> {
        let mut differences = Vec::new();
        for channel in self.channels() {
            let of_channel = match channel.decoder() {
                Some(Ok(decoder)) => decoder.differences().clone(),
                Some(Err(_)) => continue,
                None if channel.is_view() => continue,
                None => FieldDifferences {
                    missing: Vec::new(),
                    unknown: vec!["the whole channel".to_owned()],
                },
            };
            if !of_channel.is_empty() {
                differences.push((channel.topic.clone(), of_channel));
            }
        }
        differences
    }

    /// Its scenario as the text that was attached.
    ///
    /// # Errors
    /// [`RecordingError`] if it has none, or it is damaged.
    pub fn scenario_text(&self) -> Result<String, RecordingError> {
        let attached = self.layout.attachments.iter();
        let mut attached = attached.filter(|attachment| attachment.name == SCENARIO_ATTACHMENT);
        let missing = || RecordingError::because("it has no scenario attached");
        let place = &attached.next().ok_or_else(missing)?.place;
        let damaged =
            |reason: String| RecordingError::because(format!("its scenario is damaged: {reason}"));
        if place.length > LONGEST_SCENARIO {
            return Err(damaged(format!(
                "it is longer than {LONGEST_SCENARIO} bytes"
            )));
        }
        let data = self.attachment(place).map_err(damaged)?;
        String::from_utf8(data.1).map_err(|error| damaged(error.to_string()))
    }

    /// Its scenario.
    ///
    /// # Errors
    /// [`RecordingError`] if it has none, or it can't be used.
    pub fn scenario(&self) -> Result<Scenario, RecordingError> {
        Scenario::from_toml(&self.scenario_text()?).map_err(|error| {
            RecordingError::because(format!("its scenario can't be used: {error}"))
        })
    }

    /// An attachment's head and data, if its checksum is right.
    pub(crate) fn attachment(
        &self,
        place: &RecordSpan,
    ) -> Result<(mcap::records::AttachmentHeader, Vec<u8>), String> {
        let mut bytes = Vec::new();
        let read = self.source.read(place.offset, place.length, &mut bytes);
        read.map_err(|error| error.to_string())?;
        let body = bytes.get(HEAD as usize..).unwrap_or_default();
        match parse(place.opcode, body) {
            Ok(Record::Attachment { header, data, crc }) => {
                let checked = body.len().saturating_sub(4);
                if crc != 0 && crc32fast::hash(&body[..checked]) != crc {
                    return Err("its checksum is wrong".to_owned());
                }
                Ok((header, data.into_owned()))
            }
            Ok(_) => Err("it is not an attachment".to_owned()),
            Err(error) => Err(error.to_string()),
        }
    }
}
