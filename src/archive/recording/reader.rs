//! Reading messages in the order of the file or in order of time.

use super::condition::Condition;
use super::file::Recording;
use super::loader::{FoundMessage, Loader};
use super::order::{MessageOrder, Misplaced};
use super::selection::Selection;
use super::statistics::{StatisticsFault, find_fault};
use crate::archive::container::channels::FileChannel;
use crate::archive::container::loss::{Loss, Losses};
use crate::archive::container::section::MessageRecord;
use crate::archive::error::MessageError;
use crate::telemetry::encoding::{DecodeError, Decoder, Row};
use crate::telemetry::{Message, Topic};

/// A raw message of any channel.
#[derive(Clone, Copy, Debug)]
pub struct Undecoded<'a> {
    /// The channel.
    pub channel: &'a FileChannel,
    /// Index of the channel in the recording.
    pub position: usize,
    /// Sequence number.
    pub sequence: u32,
    /// The time by which it is read, ns: its log time, or the time stamp in it if the recording was
    /// [logged at other times](Recording::relogged).
    pub time_ns: u64,
    /// Time of logging, ns.
    pub log_time: u64,
    /// Time of publishing, ns.
    pub publish_time: u64,
    /// The encoded message.
    pub data: &'a [u8],
}

impl<'a> Undecoded<'a> {
    fn new(recording: &'a Recording, found: &FoundMessage, message: &MessageRecord<'a>) -> Self {
        Self {
            channel: &recording.channels()[found.channel],
            position: found.channel,
            sequence: message.sequence,
            time_ns: message.time_ns,
            log_time: message.log_time,
            publish_time: message.publish_time,
            data: message.data,
        }
    }
}

/// A message of a channel of the table, or the reason why it can't be decoded.
pub(super) type Decoded<'a> = Result<Message<'a>, MessageError>;

/// Maximum size of the messages that are sorted by time together, bytes. The window and one section are in memory.
const MAX_WINDOW: usize = 128 << 20;

/// Reads the messages of a recording.
///
/// In the order of the file, or in order of time; see [`Reader::in_order_of_time`]. Memory use is bounded in both. Unreadable
/// parts are skipped and listed by [`Reader::losses`].
#[derive(Debug)]
pub struct Reader<'r> {
    recording: &'r Recording,
    loader: Loader<'r>,
    order: Option<MessageOrder>,
    /// Treatment of each of the file's channels.
    treatments: Vec<Treatment>,
    row: Row,
    /// Number of bytes that have been reported as read.
    reported: u64,
}

/// Treatment of the messages of a channel.
#[derive(Debug)]
enum Treatment {
    /// Return raw messages.
    Raw,
    Decode {
        topic: Topic,
        decoder: Result<Box<Decoder>, DecodeError>,
    },
}

impl Treatment {
    fn new(channel: &FileChannel) -> Self {
        match (channel.table, channel.decoder()) {
            (Some(topic), Some(decoder)) => Self::Decode {
                topic,
                decoder: decoder.map(Box::new),
            },
            _ => Self::Raw,
        }
    }

    /// Decodes a message into a row; `None` if its channel is not in the table.
    fn decode<'w>(&self, message: &MessageRecord<'_>, row: &'w mut Row) -> Option<Decoded<'w>> {
        let Self::Decode { topic, decoder } = self else {
            return None;
        };
        let (sequence, time_ns) = (message.sequence, message.time_ns);
        let mut decoded = match decoder {
            Ok(decoder) => decoder.decode(message.data, row),
            Err(error) => Err(error.clone()),
        };
        // The time is in the message and in its head. If only some differ, neither can be trusted.
        let stamp = row.time_ns;
        if decoded.is_ok() && stamp != time_ns {
            decoded = Err(DecodeError::Timestamp(stamp));
        }
        Some(match decoded {
            Ok(()) => Ok(Message {
                channel: topic.index(),
                sequence,
                time_ns,
                numbers: &row.numbers,
                texts: &row.texts,
            }),
            Err(reason) => Err(MessageError {
                topic: topic.name(),
                sequence,
                time_ns,
                reason,
            }),
        })
    }
}

impl Recording {
    /// A reader for some of its messages.
    pub fn reader(&self, selection: Selection) -> Reader<'_> {
        Reader::new(self, selection)
    }
}

impl<'r> Reader<'r> {
    pub(super) fn new(recording: &'r Recording, selection: Selection) -> Self {
        Self {
            treatments: recording.channels().iter().map(Treatment::new).collect(),
            loader: Loader::new(recording, selection),
            recording,
            row: Row::default(),
            order: None,
            reported: 0,
        }
    }

    /// Returns the messages in time order, however they are ordered in the file.
    ///
    /// In a recording of toprise, the messages of one time follow the telemetry table and then their sequence numbers; in
    /// other files they keep the order of the file.
    ///
    /// Messages of toprise's channels that repeat others or go back in time are skipped and counted by
    /// [`Reader::left_out`].
    pub fn in_order_of_time(self) -> Self {
        let order = MessageOrder::new(self.recording);
        Self {
            order: Some(order),
            ..self.sorted(MAX_WINDOW)
        }
    }

    /// Returns all messages in time order, those of the same time in the order of the file.
    pub(crate) fn all_in_order_of_time(self) -> Self {
        self.sorted(MAX_WINDOW)
    }

    fn sorted(mut self, max_window: usize) -> Self {
        self.loader.sort_by_time(max_window);
        self
    }

    /// The messages that have been left out because they repeat others or go back in time.
    pub fn left_out(&self) -> Option<&Misplaced> {
        self.order.as_ref()?.misplaced()
    }

    /// Parts that could not be read so far; complete once the reader has come to its end.
    pub fn losses(&self) -> &[Loss] {
        self.loader.losses().list()
    }

    /// All damage of the file that is known so far: found on opening, found by this reader, or else shown by the
    /// checksums of data and summary. Damaged parts make these checksums wrong, too, so they are not listed then.
    pub fn all_losses(&self) -> Losses {
        let mut losses = self.recording.layout.losses.clone();
        losses.extend(self.loader.losses());
        if losses.is_empty() {
            for loss in &self.recording.layout.wrong_checksums {
                losses.push(loss.clone());
            }
        }
        losses
    }

    /// A number in the statistics of the file that contradicts its content. It is known once all messages have been read,
    /// whichever were selected; in files with unreadable parts it would mean nothing.
    pub fn statistics_fault(&self) -> Option<StatisticsFault> {
        if !self.all_losses().is_empty() {
            return None;
        }
        find_fault(&self.recording.layout, &self.loader.tally)
    }

    /// State of the file after reading it: unlike [`Recording::condition`] also with damage that opening it does not find.
    /// `has_faults` tells whether a check of its messages has found any.
    pub(crate) fn condition(&self, has_faults: bool) -> Condition {
        if !self.losses().is_empty() {
            return Condition::Damaged;
        }
        let is_altered =
            has_faults || self.left_out().is_some() || self.statistics_fault().is_some();
        match self.recording.condition() {
            Condition::Whole | Condition::Foreign if is_altered => Condition::Altered,
            condition => condition,
        }
    }

    /// The next message of a channel of the table, decoded; messages of other channels are skipped.
    ///
    /// An error concerns one message; reading can continue.
    #[allow(clippy::should_implement_trait)] // the message borrows from the reader
    pub fn next(&mut self) -> Option<Result<Message<'_>, MessageError>> {
        loop {
            let found = self.advance()?;
            if matches!(self.treatments[found.channel], Treatment::Decode { .. }) {
                return self.decode(&found);
            }
        }
    }

    /// Decodes a message of a channel of the table.
    fn decode(&mut self, found: &FoundMessage) -> Option<Decoded<'_>> {
        let message = self.loader.message(found)?;
        self.treatments[found.channel].decode(&message, &mut self.row)
    }

    /// Number of bytes that have been read since the last call.
    pub fn progress(&mut self) -> u64 {
        let more = self.loader.bytes_read.saturating_sub(self.reported);
        self.reported += more;
        more
    }

    /// The next message as stored in the file, from any channel.
    pub fn next_undecoded(&mut self) -> Option<Undecoded<'_>> {
        let found = self.advance()?;
        let message = self.loader.message(&found)?;
        Some(Undecoded::new(self.recording, &found, &message))
    }

    /// The next message as stored in the file, from any channel and also if it is left out; with the decoded message if
    /// its channel is in the table and it is not left out.
    pub(super) fn next_both(&mut self) -> Option<(Undecoded<'_>, Option<Decoded<'_>>)> {
        let found = self.loader.next(self.order.as_ref())?;
        let message = self.loader.message(&found)?;
        let is_accepted = match &mut self.order {
            Some(order) => order.accepts(found.channel, &message),
            None => true,
        };
        let decoded = if is_accepted {
            self.treatments[found.channel].decode(&message, &mut self.row)
        } else {
            None
        };
        let stored = Undecoded::new(self.recording, &found, &message);
        Some((stored, decoded))
    }

    /// Finds the next selected message.
    fn advance(&mut self) -> Option<FoundMessage> {
        loop {
            let found = self.loader.next(self.order.as_ref())?;
            let Some(order) = &mut self.order else {
                return Some(found);
            };
            let message = self.loader.message(&found)?;
            if order.accepts(found.channel, &message) {
                return Some(found);
            }
        }
    }
}
