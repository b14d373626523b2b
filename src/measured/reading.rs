//! What was read of a file, what was assumed, and what was left out.

use super::name::{ColumnName, Meaning};
use crate::words::{Piece, Sentence, and, sentence};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// What was read of a file.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct FileReading {
    /// The file; empty for arrays.
    pub file: String,
    /// The columns, or members of messages, that were read.
    pub columns: Vec<ColumnReading>,
    /// Columns, or members of messages, that were not read.
    pub unused: Vec<String>,
    /// Number of rows, or messages.
    pub rows: u64,
    /// Rows that don't count.
    pub left_out: Vec<SkippedRows>,
}

/// A column that was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ColumnReading {
    /// The column, or topic and path.
    pub column: String,
    /// `time`, `sigma`, or the field of the simulation.
    pub measures: String,
    /// The unit; empty for pure numbers.
    pub unit: String,
    /// Whether the unit is not stated, and was taken for the SI unit.
    pub is_unit_assumed: bool,
    /// Number of rows without a value.
    pub missing: u64,
}

/// Rows that don't count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct SkippedRows {
    /// Why they don't count.
    pub reason: SkipReason,
    /// Number of rows.
    pub rows: u64,
    /// The first line, from 1; absent where there are no lines.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub first_line: Option<u64>,
}

/// Why rows don't count.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SkipReason {
    /// They have no time.
    NoTime,
    /// They are equal to another row.
    Repeated,
}

/// The column of times of messages, if no member has them.
pub(super) const LOG_TIME: &str = "log time";

/// What [`ColumnReading::measures`] of a column of times is.
pub(super) const TIME: &str = "time";
/// What [`ColumnReading::measures`] of a column of standard deviations is.
pub(super) const SIGMA: &str = "sigma";

impl FileReading {
    /// The column of times.
    pub(crate) fn time(&self) -> Option<&ColumnReading> {
        self.columns.iter().find(|column| column.measures == TIME)
    }

    /// Whether the unit of a column is not stated.
    pub(crate) fn assumes_unit_of(&self, column: &str) -> bool {
        self.columns
            .iter()
            .any(|read| read.column == column && read.is_unit_assumed)
    }

    /// A member of the messages that is named like times, where those of logging were read.
    pub(crate) fn unread_clock(&self) -> Option<&str> {
        self.time().filter(|clock| clock.column == LOG_TIME)?;
        self.unused.iter().find_map(|path| {
            let (_, name) = path.rsplit_once('.')?;
            (ColumnName::parse(name).meaning == Some(Meaning::Time)).then_some(name)
        })
    }

    /// What was read, in a sentence.
    pub fn sentence(&self) -> Sentence {
        let columns = self.columns.iter().map(ColumnReading::clause).collect();
        let mut sentence = sentence!(
            "{}: {}; {}.",
            &self.file,
            and(columns),
            Piece::count(self.rows, "row")
        );
        if !self.unused.is_empty() {
            sentence += sentence!(" Not used: {}.", self.unused.join(", "));
        }
        for left_out in &self.left_out {
            sentence += left_out.sentence();
        }
        sentence
    }
}

impl ColumnReading {
    fn clause(&self) -> Sentence {
        let meaning = match self.measures.as_str() {
            TIME => "the time".into(),
            SIGMA => "a standard deviation".into(),
            field => Piece::field(field.to_owned()),
        };
        let unit = match (self.is_unit_assumed, self.unit.as_str()) {
            (true, unit) => format!(" (no unit: {unit})"),
            (false, "") => String::new(),
            (false, unit) => format!(" in {unit}"),
        };
        sentence!("{} is {}{}", &self.column, meaning, unit)
    }
}

impl SkippedRows {
    fn sentence(self) -> Sentence {
        let rows = Piece::count(self.rows, "row");
        let line = match self.first_line {
            Some(line) => format!(", the first in line {line}"),
            None => String::new(),
        };
        match self.reason {
            SkipReason::NoTime => sentence!(" Without a time: {}{}.", rows, line),
            SkipReason::Repeated => {
                sentence!(" Equal to another row, and counted once: {}{}.", rows, line)
            }
        }
    }
}
