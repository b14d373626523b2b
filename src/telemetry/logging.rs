//! Conversion of records to messages.

use super::message::Message;
use super::table::channels;
use super::table::{
    Channel, EVENTS, IMPACTS, NUTATION, SAMPLES, Source, events, impacts, nutation,
};
use super::topic::{Topic, Topics};
use crate::physics::dynamics::Support;
use crate::run::simulation::Record;
use crate::run::time::seconds;
use thiserror::Error;

/// Error of converting a record to messages: a quantity is infinite or not a number.
#[derive(Clone, Debug, PartialEq, Error)]
#[error("{topic} {field} is {value} at t = {} s: only finite numbers are recorded", seconds(*time_ns))]
pub struct TelemetryError {
    /// Topic of the message.
    pub topic: &'static str,
    /// Path of the field.
    pub field: String,
    /// The value.
    pub value: f64,
    /// Time of the message, ns.
    pub time_ns: u64,
}

/// Converts the records of a run to messages.
#[derive(Debug)]
pub struct Telemetry {
    wanted: Vec<bool>,
    numbers: Vec<f64>,
    texts: Vec<String>,
}

impl Default for Telemetry {
    /// With all topics.
    fn default() -> Self {
        Self::with_topics(&Topics::All)
    }
}

impl Telemetry {
    /// With some topics.
    pub fn with_topics(topics: &Topics) -> Self {
        Self {
            wanted: Topic::all().map(|topic| topics.include(&topic)).collect(),
            numbers: Vec::new(),
            texts: Vec::new(),
        }
    }

    /// The recorded topics for this support, in table order.
    pub fn topics(&self, support: Support) -> Topics {
        let all = Topic::all_with(support);
        let (recorded, others): (Vec<_>, Vec<_>) = all.partition(|topic| self.is_enabled(*topic));
        if others.is_empty() {
            Topics::All
        } else {
            Topics::Only(recorded)
        }
    }

    /// Whether messages of this topic are produced.
    pub fn is_enabled(&self, topic: Topic) -> bool {
        self.wanted[topic.index()]
    }

    /// Passes the messages of a record to `emit`, in table order.
    ///
    /// # Errors
    /// [`TelemetryError`], or the first error of `emit`.
    pub fn messages<E: From<TelemetryError>>(
        &mut self,
        record: &Record,
        mut emit: impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        match record {
            Record::Sample(sample) => {
                // The sampled channels come first in the table, so their places are their indices.
                for (channel, row) in SAMPLES.iter().enumerate() {
                    let at = (channel, sample.index, sample.time_ns);
                    self.message(row, at, sample.as_ref(), &mut emit)?;
                }
                Ok(())
            }
            Record::Nutation(cycle) => {
                let at = (NUTATION.index(), cycle.index, cycle.time_ns);
                self.message(&nutation::CHANNEL, at, cycle.as_ref(), &mut emit)
            }
            Record::Event(event) => {
                let at = (EVENTS.index(), event.index, event.time_ns);
                self.message(&events::CHANNEL, at, event.as_ref(), &mut emit)
            }
            Record::Impact(impact) => {
                let at = (IMPACTS.index(), impact.index, impact.time_ns);
                self.message(&impacts::CHANNEL, at, impact.as_ref(), &mut emit)
            }
        }
    }

    fn message<S, E: From<TelemetryError>>(
        &mut self,
        row: &Channel<S>,
        (channel, sequence, time_ns): (usize, u32, u64),
        source: &S,
        emit: &mut impl FnMut(&Message<'_>) -> Result<(), E>,
    ) -> Result<(), E> {
        if !self.wanted[channel] || row.present.is_some_and(|present| !present(source)) {
            return Ok(());
        }
        self.numbers.clear();
        self.texts.clear();
        for field in row.fields {
            match field.source {
                Source::Number(get) => self.numbers.push(get(source)),
                Source::Vector(get) => self.numbers.extend(get(source).iter()),
                // nalgebra keeps the components in the order of the table: x, y, z, w.
                Source::Rotation(get) => self.numbers.extend(get(source).coords.iter()),
                Source::Text(get) => self.texts.push(get(source).to_owned()),
            }
        }
        // JSON has neither NaN nor infinity, and `serde_json` would write `null` without an error.
        if let Some(index) = self.numbers.iter().position(|number| !number.is_finite()) {
            return Err(E::from(TelemetryError {
                topic: row.topic,
                field: channels()[channel].numbers[index].path.clone(),
                value: self.numbers[index],
                time_ns,
            }));
        }
        emit(&Message {
            channel,
            sequence,
            time_ns,
            numbers: &self.numbers,
            texts: &self.texts,
        })
    }
}
