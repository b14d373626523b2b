//! A recording as an open file.

use super::condition::Condition;
use crate::archive::container::attachment::Attachment;
use crate::archive::container::channels::FileChannel;
use crate::archive::container::layout::Layout;
use crate::archive::container::loss::Loss;
use crate::archive::container::source::Source;
use crate::archive::error::RecordingError;
use crate::archive::format::{
    END_RECORD, Entries, Form, RUN_RECORD, SCENARIO_ATTACHMENT, STOP_REASON, TELEMETRY,
    recorded_form,
};
use crate::run::scenario::Scenario;
use crate::run::simulation::StopReason;
use crate::telemetry::encoding::{Encoding, FieldDifferences};
use crate::telemetry::{Topic, Topics, table};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

/// Maximum size of a scenario, bytes.
const MAX_SCENARIO_SIZE: u64 = 1 << 20;

/// An MCAP file, opened for reading.
///
/// Stores positions only, so memory use is independent of the number of messages.
#[derive(Debug)]
pub struct Recording {
    pub(crate) source: Source,
    pub(crate) layout: Layout,
    path: PathBuf,
    /// Log time minus time stamp, if the log times are another clock's: see [`Relogged`](super::Relogged).
    pub(super) log_offset_ns: OnceLock<Option<i64>>,
}

impl Recording {
    /// Opens and scans a file.
    ///
    /// # Errors
    /// [`RecordingError`] if it can't be opened or is not an MCAP file. Damage is not an error.
    pub fn open(path: &Path) -> Result<Self, RecordingError> {
        Self::from_source(Source::open(path)?, path)
    }

    /// Scans a file whose content is in memory; `path` is its name.
    ///
    /// # Errors
    /// [`RecordingError`] if it is not an MCAP file. Damage is not an error.
    pub fn from_bytes(bytes: Vec<u8>, path: &Path) -> Result<Self, RecordingError> {
        Self::from_source(Source::from_bytes(bytes)?, path)
    }

    /// Scans an open file; `path` is its name.
    pub(crate) fn from_source(source: Source, path: &Path) -> Result<Self, RecordingError> {
        let layout = Layout::read(&source)?;
        let recording = Self {
            source,
            layout,
            path: path.to_owned(),
            log_offset_ns: OnceLock::new(),
        };
        let runs = recording.runs()?;
        if runs > 1 {
            return Err(RecordingError::MergedRuns(runs));
        }
        if recording.is_ours()
            && let Some(topic) = recording.ambiguous_topic()
        {
            return Err(RecordingError::AmbiguousTopic(topic));
        }
        Ok(recording)
    }

    /// The first topic of the table whose channels have different encodings or schemas. Equal ones, e.g. of two publishers,
    /// are one topic.
    fn ambiguous_topic(&self) -> Option<Topic> {
        let mut first: BTreeMap<Topic, &FileChannel> = BTreeMap::new();
        for channel in self.channels().iter().filter(|c| !c.is_superseded) {
            let Some(topic) = channel.table else { continue };
            let known = first.entry(topic).or_insert(channel);
            if (&known.encoding, &known.schema) != (&channel.encoding, &channel.schema) {
                return Some(topic);
            }
        }
        None
    }

    /// Number of runs of toprise in the file. Either of their first records may be damaged. Equal records are of one run:
    /// some software repeats what it copies.
    fn runs(&self) -> Result<usize, RecordingError> {
        let mut records: Vec<&Entries> = Vec::new();
        for (_, record) in &self.layout.metadata {
            if record.name == RUN_RECORD && !records.contains(&&record.metadata) {
                records.push(&record.metadata);
            }
        }
        let mut scenarios = Vec::new();
        for scenario in self.scenarios() {
            let description = scenario.describe(&self.source)?;
            if !scenarios.contains(&description) {
                scenarios.push(description);
            }
        }
        Ok(records.len().max(scenarios.len()))
    }

    /// The attached scenarios.
    fn scenarios(&self) -> impl Iterator<Item = &Attachment> {
        self.layout
            .attachments
            .iter()
            .filter(|attachment| attachment.header.name == SCENARIO_ATTACHMENT)
    }

    /// The path as it was given.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// Size of the file, bytes.
    pub fn size(&self) -> u64 {
        self.source.length()
    }

    /// The library field of the header.
    pub fn library(&self) -> &str {
        &self.layout.library
    }

    /// The profile in the header: the conventions that the file follows in addition to those of MCAP.
    pub fn profile(&self) -> &str {
        &self.layout.profile
    }

    /// Whether toprise recorded it.
    pub fn is_ours(&self) -> bool {
        self.run().is_some() || self.layout.is_ours()
    }

    /// Whether opening the file has found damage.
    pub(crate) fn is_damaged(&self) -> bool {
        self.losses().iter().any(|loss| !self.is_tail(loss))
            || !self.layout.wrong_checksums.is_empty()
    }

    /// State of the file.
    pub fn condition(&self) -> Condition {
        if self.is_damaged() || (self.is_finished() && !self.layout.is_ended) {
            Condition::Damaged
        } else if self.lacks_end() {
            Condition::Interrupted
        } else if self.is_ours() {
            Condition::Whole
        } else {
            Condition::Foreign
        }
    }

    /// Whether its writer came to the end.
    fn is_finished(&self) -> bool {
        if self.is_ours() {
            self.end().is_some()
        } else {
            self.layout.is_ended
        }
    }

    /// Whether its run, or in other files its writer, was ended early. A run that was ended by Ctrl-C has an end record
    /// that says so.
    pub(crate) fn lacks_end(&self) -> bool {
        if self.is_ours() {
            self.is_interrupted()
        } else {
            !self.is_finished()
        }
    }

    /// Whether a loss is only the last, incompletely written record of an unfinished file.
    pub(crate) fn is_tail(&self, loss: &Loss) -> bool {
        !self.is_finished() && self.layout.cut == Some(loss.offset)
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
        match self.end() {
            Some(end) => end
                .get(STOP_REASON)
                .is_some_and(|reason| reason == StopReason::Interrupted.name()),
            // A writer that was ended at once leaves no end record.
            None => true,
        }
    }

    /// The entries of the first metadata record with a name.
    pub fn metadata(&self, name: &str) -> Option<&Entries> {
        self.all_metadata()
            .find(|(known, _)| *known == name)
            .map(|(_, entries)| entries)
    }

    /// Form and topics, from `toprise.run` or from the channels; `None` if both are lost.
    pub fn form(&self) -> Option<(Form, Topics)> {
        let named = self.run().and_then(recorded_form);
        // Enough to repeat a run whose first record is damaged.
        named.or_else(|| {
            let views = self.channels().iter().any(FileChannel::is_view);
            let encoding = self.encoding()?;
            Some((Form { encoding, views }, Topics::Only(self.topics())))
        })
    }

    /// All metadata records: names and entries, in the order of the file.
    pub fn all_metadata(&self) -> impl Iterator<Item = (&str, &Entries)> {
        self.layout
            .metadata
            .iter()
            .map(|(_, record)| (record.name.as_str(), &record.metadata))
    }

    /// Names and sizes (bytes) of all attachments, in the order of the file.
    pub fn attachments(&self) -> impl Iterator<Item = (&str, u64)> {
        self.layout
            .attachments
            .iter()
            .map(|attachment| (attachment.header.name.as_str(), attachment.data_length))
    }

    /// The data of the first intact attachment with this name and at most this size in bytes, if it can be read.
    pub fn attachment(&self, name: &str, max_size: u64) -> Option<Vec<u8>> {
        let mut attachments = self.layout.attachments.iter();
        attachments
            .find(|attachment| {
                attachment.header.name == name
                    && attachment.is_intact
                    && attachment.data_length <= max_size
            })?
            .data(&self.source)
            .ok()
    }

    /// All channels, in the order of the file.
    pub fn channels(&self) -> &[FileChannel] {
        self.layout.channels.list()
    }

    /// The common encoding of its table channels, if any.
    pub fn encoding(&self) -> Option<Encoding> {
        let mut ours = self
            .channels()
            .iter()
            .filter(|channel| channel.table.is_some() && !channel.is_superseded);
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
        let mut topics = Vec::new();
        for topic in self.channels().iter().filter_map(|c| c.table) {
            if !topics.contains(&topic) {
                topics.push(topic);
            }
        }
        topics
    }

    /// Whether it was recorded with the telemetry of this version.
    pub(crate) fn has_this_telemetry(&self) -> bool {
        let telemetry = self.run().and_then(|run| run.get(TELEMETRY));
        telemetry.is_some_and(|number| *number == table::VERSION.to_string())
    }

    /// The topics of the table that it should have: those that its run was recorded with, or else those of its channels.
    pub(super) fn expected_topics(&self) -> Vec<Topic> {
        match (self.form(), self.scenario()) {
            // Other telemetry may lack topics of today's.
            (Some((_, topics)), Ok(scenario)) if self.has_this_telemetry() => {
                Topic::all_with(scenario.model.support)
                    .filter(|topic| topics.include(topic))
                    .collect()
            }
            _ => self.topics(),
        }
    }

    /// Damage found on opening: the first parts. [`Reader::all_losses`](super::Reader::all_losses) also has what is
    /// found on reading.
    pub fn losses(&self) -> &[Loss] {
        self.layout.losses.list()
    }

    /// Differences from this version: topics with missing or unknown fields, and unknown topics.
    pub fn differences(&self) -> Vec<(String, FieldDifferences)> {
        let mut differences = Vec::new();
        let mut topics = BTreeSet::new();
        for channel in self.channels() {
            // Equal channels of a topic differ alike.
            if !topics.insert(&channel.topic) {
                continue;
            }
            let found = match channel.decoder() {
                Some(Ok(decoder)) => decoder.differences().clone(),
                Some(Err(_)) => continue,
                None if channel.is_view() || channel.is_supplement() => continue,
                None => FieldDifferences {
                    missing: Vec::new(),
                    unknown: vec!["the whole channel".to_owned()],
                },
            };
            if !found.is_empty() {
                differences.push((channel.topic.clone(), found));
            }
        }
        differences
    }

    /// The scenario as the text that was attached.
    ///
    /// # Errors
    /// [`RecordingError`] if it has none, or it is damaged.
    pub fn scenario_text(&self) -> Result<String, RecordingError> {
        let scenario = self.scenarios().next().ok_or(RecordingError::NoScenario)?;
        if scenario.data_length > MAX_SCENARIO_SIZE {
            return Err(RecordingError::LargeScenario(MAX_SCENARIO_SIZE));
        }
        if !scenario.is_intact {
            return Err(RecordingError::DamagedScenario);
        }
        let data = scenario.data(&self.source)?;
        String::from_utf8(data).map_err(RecordingError::ScenarioText)
    }

    /// The scenario.
    ///
    /// # Errors
    /// [`RecordingError`] if it has none, or it can't be used.
    pub fn scenario(&self) -> Result<Scenario, RecordingError> {
        Scenario::from_toml(&self.scenario_text()?).map_err(RecordingError::UnusableScenario)
    }
}
