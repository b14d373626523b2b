//! Single columns of a recording.

use super::loss::Loss;
use super::{MessageError, Reader, Recording, Selection};
use crate::telemetry::{ChannelInfo, channels};
use std::ops::Range;
use std::thread;
use thiserror::Error;

/// One quantity over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Topic.
    pub topic: &'static str,
    /// Field, as in `theta` or `slip_world.x`.
    pub field: String,
    /// Unit, empty for pure numbers.
    pub unit: &'static str,
    /// Times, ns.
    pub times_ns: Vec<u64>,
    /// Values.
    pub values: Vec<f64>,
}

/// Why there is no such series.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum SeriesError {
    /// The recording has no such topic of the table.
    #[error("the recording has no {topic}; it has {}", present.join(", "))]
    Topic {
        /// The topic.
        topic: String,
        /// Those that it has.
        present: Vec<String>,
    },
    /// The channel has no such field.
    #[error("{topic} has no field {field}; its fields: {}", present.join(", "))]
    Field {
        /// The topic.
        topic: &'static str,
        /// The field.
        field: String,
        /// Those that it has.
        present: Vec<String>,
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
    /// What could not be read.
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
    /// One quantity over time, as in `series("/top/state", "theta")`.
    ///
    /// # Errors
    /// [`SeriesError`] if there is none, or a message of its channel can't be decoded.
    pub fn series(&self, topic: &str, field: &str) -> Result<Series, SeriesError> {
        let info = self.table_channel(topic)?.1;
        let leaf = &info.numbers[number(info, field)?];
        let mut columns = self.columns(topic, &[field])?;
        Ok(Series {
            topic: info.topic,
            field: leaf.path.clone(),
            unit: leaf.unit,
            times_ns: columns.times_ns,
            values: columns.values.pop().unwrap_or_default(),
        })
    }

    /// Several numbers of one channel. The others are not decoded, and the chunks are read by all
    /// processors at once.
    ///
    /// # Errors
    /// As for [`Recording::series`].
    pub fn columns(&self, topic: &str, fields: &[&str]) -> Result<Columns, SeriesError> {
        let (table, info) = self.table_channel(topic)?;
        let numbers = fields
            .iter()
            .map(|field| number(info, field))
            .collect::<Result<Vec<_>, _>>()?;
        let ranges = shares(self.layout.sections.len());
        let parts: Vec<_> = thread::scope(|scope| {
            let read = |range| {
                let numbers = &numbers;
                scope.spawn(move || self.columns_within(table, info, numbers, range))
            };
            let threads: Vec<_> = ranges.into_iter().map(read).collect();
            threads.into_iter().map(|thread| thread.join()).collect()
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
        table: usize,
        info: &'static ChannelInfo,
        numbers: &[usize],
        sections: Range<usize>,
    ) -> Result<Columns, MessageError> {
        let selection = Selection {
            topics: vec![info.topic.to_owned()],
            ..Selection::default()
        };
        let mut reader = Reader::new(self, selection)
            .within(sections)
            .only(table, numbers);
        let mut columns = Columns::of(numbers.len());
        while let Some(message) = reader.next() {
            let message = message?;
            columns.times_ns.push(message.time_ns);
            for (column, number) in columns.values.iter_mut().zip(numbers) {
                column.push(message.numbers[*number]);
            }
        }
        columns.losses = reader.losses().to_vec();
        Ok(columns)
    }

    /// The channel of the table with this topic, if the recording has it.
    fn table_channel(&self, topic: &str) -> Result<(usize, &'static ChannelInfo), SeriesError> {
        let tables = || self.channels().iter().filter_map(|c| c.table);
        let table = tables().find(|table| channels()[*table].topic == topic);
        table
            .map(|table| (table, &channels()[table]))
            .ok_or_else(|| SeriesError::Topic {
                topic: topic.to_owned(),
                present: tables().map(|t| channels()[t].topic.to_owned()).collect(),
            })
    }
}

fn number(info: &'static ChannelInfo, field: &str) -> Result<usize, SeriesError> {
    info.number_index(field).ok_or_else(|| SeriesError::Field {
        topic: info.topic,
        field: field.to_owned(),
        present: info.numbers.iter().map(|leaf| leaf.path.clone()).collect(),
    })
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
