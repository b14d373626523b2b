//! Errors of measured data.

use super::unit::split_header;
use crate::archive::recording::RecordingError;
use crate::run::suggestion::{did_you_mean, most_similar, similarity};
use crate::telemetry::fields::state;
use crate::words::{Piece, Sentence, counted, sentence};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of reading measured data. [`DataError::sentence`] says also what can be done about it.
#[derive(Debug, Error)]
pub enum DataError {
    /// The file can't be read.
    #[error("cannot read {}: {reason}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system error.
        #[source]
        reason: io::Error,
    },
    /// The recording can't be read.
    #[error("{}: {reason}", path.display())]
    Recording {
        /// The file.
        path: PathBuf,
        /// The reason.
        #[source]
        reason: RecordingError,
    },
    /// The Parquet file can't be read.
    #[cfg(feature = "sweep")]
    #[error("{}: {reason}", path.display())]
    Parquet {
        /// The file.
        path: PathBuf,
        /// The reason.
        #[source]
        reason: ParquetError,
    },
    /// This build can't read Parquet files.
    #[error("{}: this build can't read Parquet files (its feature `sweep` is off): convert it to CSV", path.display())]
    NoParquet {
        /// The file.
        path: PathBuf,
    },
    /// The file has no rows of numbers.
    #[error("{}: no rows of numbers{}", path.display(), refused.as_ref().map_or_else(String::new, |(line, text)| format!("; line {line}: {text:?} is not a number")))]
    Empty {
        /// The file.
        path: PathBuf,
        /// Line, from 1, and text of a cell that should be a number, if there is one.
        refused: Option<(u64, String)>,
    },
    /// A row has more cells than there are columns.
    #[error("{}:{line}: {}, but {}{}", path.display(), counted(*cells as u64, "cell"), counted(*columns as u64, "column"), if *has_commas { "; if numbers have decimal commas, separate the columns with semicolons or tabs" } else { "" })]
    Width {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Number of cells of the row.
        cells: usize,
        /// Number of columns.
        columns: usize,
        /// Whether commas separate the columns.
        has_commas: bool,
    },
    /// An error in a file.
    #[error("{}: {reason}", path.display())]
    InFile {
        /// The file.
        path: PathBuf,
        /// The error.
        #[source]
        reason: Box<DataError>,
    },
    /// The file is too large.
    #[error("{}: more than {limit} rows: thin out the data", path.display())]
    TooLong {
        /// The file.
        path: PathBuf,
        /// Maximum number of rows.
        limit: usize,
    },
    /// The file is too large to be held in memory.
    #[error("{}: larger than {} MB: thin out the data", path.display(), limit >> 20)]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Maximum size, bytes.
        limit: u64,
    },
    /// There is no such column or topic.
    #[error("{}: no {what} {name}; there {}{}", path.display(), listed(known), similar(name, known))]
    Missing {
        /// The file.
        path: PathBuf,
        /// What is missing: a column, topic or field.
        what: &'static str,
        /// Name of the missing column, topic or field.
        name: String,
        /// What the file has instead.
        known: Vec<String>,
    },
    /// No line names the columns.
    #[error("{}: {}", path.display(), if *columns == 1 { "a single column".to_owned() } else { format!("no line names the {columns} columns") })]
    NoHeader {
        /// The file.
        path: PathBuf,
        /// Number of columns.
        columns: usize,
    },
    /// No column is named like times.
    #[error("{}: no column of times; there {}", path.display(), listed(columns))]
    NoTimes {
        /// The file.
        path: PathBuf,
        /// The columns of the file.
        columns: Vec<String>,
    },
    /// Several columns are equally well named like times.
    #[error("{}: several columns are named like times: {}", path.display(), columns.join(", "))]
    SeveralTimes {
        /// The file.
        path: PathBuf,
        /// The columns.
        columns: Vec<String>,
    },
    /// A signal is in none of the files.
    #[error("{}", not_found(source_name, files))]
    NotFound {
        /// Column of the signal, or topic and path.
        source_name: String,
        /// The files.
        files: Vec<Contents>,
    },
    /// A file has none of the signals.
    #[error("{}: none of the signals is in this file; there {}", .0.path.display(), listed(&.0.known))]
    UnusedFile(Contents),
    /// No column has the name of a field.
    #[error("{}: no column is named like a field of the top; there {}", path.display(), listed(columns))]
    NoSignals {
        /// The file.
        path: PathBuf,
        /// The columns of the file.
        columns: Vec<String>,
        /// The first column that is not named like times.
        example: String,
    },
    /// A recording has all fields: some must be chosen.
    #[error("{}: no fields to fit are chosen", path.display())]
    ChooseSignals {
        /// The file.
        path: PathBuf,
    },
    /// A cell is not a number.
    #[error("{}:{line}: column {column}: {text:?} is not a number", path.display())]
    NotANumber {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column.
        column: String,
        /// The text.
        text: String,
    },
    /// The marks in a number may separate thousands.
    #[error("{}:{line}: column {column}: {text:?} {}: write numbers without separators of thousands", path.display(), decimal.map_or_else(|| "has separators of thousands".to_owned(), |number| format!("can be {number} or {}", 1e3 * number)))]
    Thousands {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column.
        column: String,
        /// The text.
        text: String,
        /// The number if its only mark is decimal.
        decimal: Option<f64>,
    },
    /// A standard deviation is not positive.
    #[error("{}:{line}: column {column}: the standard deviation {value} is not positive", path.display())]
    Sigma {
        /// The file.
        path: PathBuf,
        /// Line, from 1.
        line: u64,
        /// Column.
        column: String,
        /// The value.
        value: f64,
    },
    /// A unit is unknown or does not suit the field.
    #[error("column {column}: {unit:?} is not a unit of {quantity}; allowed: {}", allowed.join(", "))]
    Unit {
        /// Column.
        column: String,
        /// The unit.
        unit: String,
        /// What is measured.
        quantity: &'static str,
        /// Allowed units.
        allowed: Vec<&'static str>,
    },
    /// A column of timestamps is read as another quantity.
    #[error("{}: column {column} has times, by its type; expected: {quantity}", path.display())]
    Timestamps {
        /// The file.
        path: PathBuf,
        /// Column.
        column: String,
        /// What should be measured.
        quantity: &'static str,
    },
    /// A signal can't be parsed.
    #[error("{text}: {reason}")]
    Signal {
        /// The argument.
        text: String,
        /// The reason.
        reason: SignalError,
    },
    /// A name stands for several columns.
    #[error("{}: several columns are called {name}: rename them", path.display())]
    Ambiguous {
        /// The file.
        path: PathBuf,
        /// The name.
        name: String,
    },
    /// A column would count twice.
    #[error("{}: {source_name} is read twice as a signal: each value may count only once", path.display())]
    Duplicate {
        /// The file.
        path: PathBuf,
        /// Column of the signal, or topic and path.
        source_name: String,
    },
    /// Columns that were found by their names measure the same field.
    #[error("{}: the columns {} and {} both measure {field}", path.display(), columns[0], columns[1])]
    SameField {
        /// The file.
        path: PathBuf,
        /// The field.
        field: String,
        /// The columns.
        columns: [String; 2],
    },
    /// A file is given twice.
    #[error("{} is given twice: each value may count only once", path.display())]
    SameFile {
        /// The file.
        path: PathBuf,
    },
    /// No JSON message has a number.
    #[error("{}: member {name} has no values: {reason}", path.display())]
    NoMember {
        /// The file.
        path: PathBuf,
        /// Topic and path.
        name: String,
        /// The reason.
        #[source]
        reason: MemberError,
    },
    /// The column of times is named, but no file has columns.
    #[error(
        "there is no column of times {name} in MCAP files: the times are those of their messages; leave the name out"
    )]
    NoTimeColumn {
        /// Name of the column.
        name: String,
    },
    /// All values of a signal are missing.
    #[error("{}: {what} {name} has no values", path.display())]
    NoValues {
        /// The file.
        path: PathBuf,
        /// What has no values: a column, field or member.
        what: &'static str,
        /// Name of the column, or topic and path.
        name: String,
    },
}

impl DataError {
    /// What is wrong, and what can be done about it.
    pub fn sentence(&self) -> Sentence {
        match self.remedy() {
            Some(remedy) => sentence!("{}; {}", self.to_string(), remedy),
            None => self.to_string().into(),
        }
    }

    /// What can be done about the error, if its text does not say it.
    fn remedy(&self) -> Option<Sentence> {
        Some(match self {
            Self::InFile { reason, .. } => return reason.remedy(),
            Self::NoHeader { columns: 1, .. } => {
                sentence!("write the times beside the values, e.g. t,theta (deg)")
            }
            Self::NoHeader { .. } => sentence!(
                "write a first line that does, e.g. t,theta (deg) or t,theta (deg),phi (deg)"
            ),
            Self::NoTimes { .. } => sentence!(
                "name it with {}, or add one: the number of the frame divided by the frame rate",
                Piece::argument("time")
            ),
            Self::SeveralTimes { .. } => sentence!(
                "call one of them t, or choose with {}",
                Piece::argument("time")
            ),
            Self::NoSignals { example, .. } => sentence!(
                "name the columns, e.g. {}",
                Piece::argument_with("signal", format!("theta={example}"))
            ),
            Self::UnusedFile(_) => sentence!(
                "leave it out, or name its signals with {}",
                Piece::argument("signal")
            ),
            Self::ChooseSignals { .. } => sentence!(
                "choose the fields to fit, e.g. {}",
                Piece::argument_with("signal", format!("{}:1mrad", state::THETA))
            ),
            Self::SameField { field, columns, .. } => sentence!(
                "choose one, e.g. {}",
                Piece::argument_with("signal", format!("{field}={}", columns[0]))
            ),
            Self::Signal { .. } => sentence!(
                "describe signals as in {}",
                Piece::argument_with("signal", "theta=tilt (deg):2mrad")
            ),
            _ => return None,
        })
    }

    /// Adds the file to an error that is found where only a column is known.
    pub(super) fn in_file(self, path: &Path) -> Self {
        Self::InFile {
            path: path.to_owned(),
            reason: Box::new(self),
        }
    }
}

/// What a file of data has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Contents {
    /// The file.
    pub path: PathBuf,
    /// Names of the columns that can be read, or of the topics.
    pub known: Vec<String>,
}

/// Names with their verb: "are: t, theta".
fn listed(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{verb}: {}", names.join(", "))
}

/// A sentence about a signal that is in none of the files.
fn not_found(name: &str, files: &[Contents]) -> String {
    let mut topics = files.iter().flat_map(|file| &file.known);
    if name.starts_with('/') && topics.any(|topic| topic == name) {
        return format!("{name} is a topic: name a value in its messages, {name}.NAME");
    }
    if let [file] = files {
        let path = file.path.display();
        return format!(
            "{path}: no column or topic {name}; there {}{}",
            listed(&file.known),
            similar(name, &file.known)
        );
    }
    let mut sentence = format!("no column or topic {name} in any file");
    for file in files {
        let path = file.path.display();
        sentence += &format!("; in {path} there {}", listed(&file.known));
    }
    let mut known = Vec::new();
    for file in files {
        known.extend(file.known.iter().cloned());
    }
    sentence + &similar(name, &known)
}

/// The hint for the columns or topics that are most like a name, or an empty string. Case and units don't count, and a
/// topic is compared with that of the name.
fn similar(name: &str, known: &[String]) -> String {
    let wrong = split_header(name).0.to_lowercase();
    let topic = wrong.rsplit_once('.').map_or("", |(topic, _)| topic);
    let mut similarities = Vec::new();
    for known_name in known {
        let bare = split_header(known_name).0.to_lowercase();
        if bare == topic {
            // The topic is right: no other one is meant.
            return String::new();
        }
        let compared = if bare.starts_with('/') { topic } else { &wrong };
        similarities.push((similarity(compared, &bare), known_name.as_str()));
    }
    did_you_mean(&most_similar(similarities.into_iter()))
}

/// Reason why a Parquet file can't be read.
#[cfg(feature = "sweep")]
#[derive(Debug, Error)]
pub enum ParquetError {
    /// The file is damaged, or no Parquet file.
    #[error("the file is damaged")]
    Damaged,
    /// The file has too many rows to be held in memory.
    #[error("more than {limit} rows: thin out the data")]
    TooLong {
        /// Maximum number of rows.
        limit: usize,
    },
    /// The file can't be decoded.
    #[error(transparent)]
    Parquet(#[from] parquet::errors::ParquetError),
    /// A column can't be converted.
    #[error(transparent)]
    Arrow(#[from] arrow_schema::ArrowError),
}

/// Reason why a member of a JSON message is no number.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MemberError {
    /// There is no such member, or it has members itself.
    #[error("the messages have: {}", known.join(", "))]
    Absent {
        /// Paths of the members where it should be.
        known: Vec<String>,
    },
    /// The value is text.
    #[error("they are texts, e.g. {0:?}, not numbers")]
    Text(String),
    /// The value is null.
    #[error("they are null")]
    Null,
    /// No message can be decoded.
    #[error("the messages are no JSON")]
    NoJson,
    /// The value is true or false.
    #[error("they are true or false, not numbers")]
    Boolean,
}

/// Reason why the description of a signal can't be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SignalError {
    /// There is no such field.
    #[error("unknown field {name}{}", match similar[..] {
        [] => format!("; fields: {known}"),
        _ => did_you_mean(similar),
    })]
    UnknownField {
        /// The name that no field has.
        name: String,
        /// The paths of similar ones.
        similar: Vec<&'static str>,
        /// The fields that can be measured.
        known: String,
    },
    /// The standard deviation is not positive.
    #[error("the standard deviation {0} is not a positive number")]
    Sigma(String),
    /// A name is empty.
    #[error("a name is empty")]
    Empty,
}
