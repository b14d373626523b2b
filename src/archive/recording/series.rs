//! Single columns of a recording.

use super::file::Recording;
use super::reader::{Reader, Selection};
use crate::archive::container::loss::Loss;
use crate::archive::error::MessageError;
use crate::telemetry::fields::NumberField;
use crate::telemetry::{Topic, Topics};
use std::ops::Range;
use std::thread;
use thiserror::Error;

/// One quantity over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// The quantity.
    pub field: NumberField,
    /// Times, ns.
    pub times_ns: Vec<u64>,
    /// Values.
    pub values: Vec<f64>,
    /// Parts that could not be read.
    pub losses: Vec<Loss>,
}

/// The reason why there is no such series.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SeriesError {
    /// The recording has no such channel.
    #[error("the recording has no {topic}; it has {}", present.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "))]
    Topic {
        /// The channel.
        topic: Topic,
        /// Those of the table that it has.
        present: Vec<Topic>,
    },
    /// A message can't be decoded.
    #[error(transparent)]
    Message(#[from] MessageError),
}

/// Several columns of one channel, read in one pass, and what could not be read.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Columns {
    /// Times, ns.
    pub times_ns: Vec<u64>,
    /// For each field that was asked for, its values.
    pub values: Vec<Vec<f64>>,
    /// Parts that could not be read.
    pub losses: Vec<Loss>,
}

impl Columns {
    fn of(fields: usize) -> Self {
        Self {
            values: vec![Vec::new(); fields],
            ..Self::default()
        }
    }

    fn append(&mut self, mut other: Self) {
        self.times_ns.append(&mut other.times_ns);
        for (mine, theirs) in self.values.iter_mut().zip(&mut other.values) {
            mine.append(theirs);
        }
        self.losses.append(&mut other.losses);
    }
}

impl Recording {
    /// One quantity over time, as in `series(state::THETA)` with the handles of
    /// [`telemetry::fields`](crate::telemetry::fields).
    ///
    /// # Errors
    /// [`SeriesError`] if the recording doesn't have it, or a message of its channel can't be decoded.
    pub fn series(&self, field: NumberField) -> Result<Series, SeriesError> {
        let mut columns = self.columns(field.topic(), &[field])?;
        Ok(Series {
            field,
            times_ns: columns.times_ns,
            values: columns.values.pop().unwrap_or_default(),
            losses: columns.losses,
        })
    }

    /// Several numbers of one channel; those of other channels are NaN. No others are decoded, and the chunks are
    /// read by all processors at once.
    ///
    /// # Errors
    /// As for [`Recording::series`].
    pub fn columns(&self, topic: Topic, fields: &[NumberField]) -> Result<Columns, SeriesError> {
        self.require(topic)?;
        let ranges = shares(self.layout.sections.len());
        let parts: Vec<_> = thread::scope(|scope| {
            let read = |range| scope.spawn(move || self.columns_within(topic, fields, range));
            let threads: Vec<_> = ranges.into_iter().map(read).collect();
            threads
                .into_iter()
                .map(std::thread::ScopedJoinHandle::join)
                .collect()
        });
        let mut columns = Columns::of(fields.len());
        for part in parts {
            match part {
                Ok(part) => columns.append(part?),
                Err(panic) => std::panic::resume_unwind(panic),
            }
        }
        Ok(columns)
    }

    fn columns_within(
        &self,
        topic: Topic,
        fields: &[NumberField],
        sections: Range<usize>,
    ) -> Result<Columns, MessageError> {
        let selection = Selection {
            topics: Topics::Only(vec![topic.name().to_owned()]),
            ..Selection::default()
        };
        let numbers: Vec<usize> = fields.iter().map(|field| field.index()).collect();
        let mut reader = Reader::new(self, selection)
            .within(sections)
            .only(topic, &numbers);
        let mut columns = Columns::of(fields.len());
        while let Some(message) = reader.next() {
            let message = message?;
            columns.times_ns.push(message.time_ns);
            for (column, field) in columns.values.iter_mut().zip(fields) {
                column.push(field.of(&message));
            }
        }
        columns.losses = reader.losses().to_vec();
        Ok(columns)
    }

    /// Refuses a channel that the recording doesn't have.
    fn require(&self, topic: Topic) -> Result<(), SeriesError> {
        if self.has(topic) {
            return Ok(());
        }
        let present = self.topics();
        Err(SeriesError::Topic { topic, present })
    }
}

/// Divides sections evenly between the processors.
fn shares(sections: usize) -> Vec<Range<usize>> {
    let workers = thread::available_parallelism().map_or(1, usize::from);
    let share = sections.div_ceil(workers).max(1);
    (0..sections)
        .step_by(share)
        .map(|start| start..(start + share).min(sections))
        .collect()
}
