//! Versions of the telemetry: what recordings of each hold.

use super::channel::{ChannelInfo, channels};
use super::fields::ACCELERATION;
use super::message::Message;
use super::table::VERSION;
use super::topic::Topic;

/// What channels were said to carry, up to a version of the telemetry.
const FORMER_MEANINGS: &[(u32, Topic, &str)] = &[(
    1,
    ACCELERATION,
    "the terms of the equations of motion: why the top rises at this instant",
)];

/// A version of the telemetry.
#[derive(Clone, Debug)]
pub struct Version {
    number: u32,
    channels: Vec<ChannelInfo>,
    /// For each channel the indices of its numbers in the table.
    kept: Vec<Vec<usize>>,
    /// Those of the message that was narrowed last.
    numbers: Vec<f64>,
}

impl Default for Version {
    fn default() -> Self {
        Self::up_to(VERSION)
    }
}

impl Version {
    /// The version with a number; none if there is no such version, or none yet.
    #[must_use]
    pub fn find(number: u32) -> Option<Self> {
        (1..=VERSION).contains(&number).then(|| Self::up_to(number))
    }

    fn up_to(number: u32) -> Self {
        let kept = |channel: &ChannelInfo| {
            let leaves = channel.numbers.iter().enumerate();
            let kept = leaves.filter(|(_, leaf)| leaf.since <= number);
            kept.map(|(index, _)| index).collect()
        };
        let kept: Vec<Vec<usize>> = channels().iter().map(kept).collect();
        let channels = Topic::all().zip(&kept).map(|(topic, kept)| {
            let info = topic.info();
            let mut meanings = FORMER_MEANINGS.iter();
            let former = meanings.find(|(last, of, _)| number <= *last && *of == topic);
            ChannelInfo {
                meaning: former.map_or(info.meaning, |(_, _, meaning)| meaning),
                numbers: kept.iter().map(|at| info.numbers[*at].clone()).collect(),
                ..info.clone()
            }
        });
        Self {
            number,
            channels: channels.collect(),
            kept,
            numbers: Vec::new(),
        }
    }

    /// Its number.
    #[must_use]
    pub fn number(&self) -> u32 {
        self.number
    }

    /// Whether it is the one that this program records.
    #[must_use]
    pub fn is_current(&self) -> bool {
        self.number == VERSION
    }

    /// Its channels, in table order. A leaf's derivative is not an index into these.
    #[must_use]
    pub fn channels(&self) -> &[ChannelInfo] {
        &self.channels
    }

    /// For a channel of the table the indices of the numbers that this version has.
    #[must_use]
    pub fn kept(&self, channel: usize) -> &[usize] {
        &self.kept[channel]
    }

    /// A message without the numbers that this version doesn't have.
    pub fn narrowed<'a>(&'a mut self, message: &Message<'a>) -> Message<'a> {
        let kept = self.kept[message.channel].iter();
        self.numbers.clear();
        self.numbers.extend(kept.map(|at| message.numbers[*at]));
        Message {
            numbers: &self.numbers,
            ..*message
        }
    }
}
