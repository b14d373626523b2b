//! Errors of a sweep as a whole. Errors of rows are in the table.

use super::counts::RowError;
use crate::archive::input::InputError;
use crate::archive::sink::SinkError;
use crate::run::scenario::{Key, Kind, ScenarioError};
use arrow_schema::{ArrowError, DataType};
use parquet::errors::ParquetError;
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of a sweep.
#[derive(Debug, Error)]
pub enum SweepError {
    /// The definition of the sweep is wrong.
    #[error(transparent)]
    Spec(#[from] SpecError),
    /// The values of an axis are wrong.
    #[error("{}={text}: {problem}", key.path)]
    Axis {
        /// The key.
        key: &'static Key,
        /// The values as given.
        text: String,
        /// The problem.
        problem: AxisProblem,
    },
    /// Scenarios don't have a key, or can't have a value of it.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A key can't be set in a base.
    #[error("{base}: {source}")]
    Base {
        /// The base as given.
        base: String,
        /// The reason.
        source: ScenarioError,
    },
    /// Base scenario not found.
    #[error(transparent)]
    Input(#[from] InputError),
    /// A table can't be read.
    #[error("{}: {source}", path.display())]
    Table {
        /// The table.
        path: PathBuf,
        /// The reason.
        source: TableError,
    },
    /// A table, a part or the directory of parts belongs to another sweep, or is damaged.
    #[error("{} {problem}", path.display())]
    Unusable {
        /// The file or directory.
        path: PathBuf,
        /// The problem.
        problem: FileProblem,
    },
    /// A row failed (with `fail_fast`).
    #[error("run {}: {}", .0.run, .0.error)]
    Row(RowError),
    /// The Parquet writer failed.
    #[error("cannot write Parquet: {0}")]
    Parquet(#[from] ParquetError),
    /// The threads can't be started.
    #[error("cannot start threads: {0}")]
    Threads(#[from] rayon::ThreadPoolBuildError),
    /// A file can't be read or published.
    #[error(transparent)]
    Sink(#[from] SinkError),
}

/// Why bases, axes and samples don't define a sweep.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SpecError {
    /// There is no base.
    #[error("a sweep needs at least one preset or scenario file")]
    NoBase,
    /// Runs may take no step.
    #[error("max_steps must be at least 1")]
    NoSteps,
    /// Two axes or columns have the same key.
    #[error("{0} varies twice")]
    VariesTwice(&'static str),
    /// A key is set in a base and varies in each row.
    #[error("{0} is both set and varied: remove one of the two")]
    SetAndVaried(&'static str),
    /// There are no rows.
    #[error("there is nothing to run")]
    Empty,
    /// There are more rows than part numbers can count.
    #[error("more than {0} runs")]
    TooMany(u64),
    /// A table of runs excludes axes and samples.
    #[error("a table can't be combined with axes or a sample")]
    TableWithAxes,
    /// A sample has no axis.
    #[error("a sample needs at least one axis, e.g. friction.k = 0.01..1")]
    SampleWithoutAxis,
    /// The file is not TOML, or has other keys than a spec.
    #[error("not a sweep spec: {0}")]
    Syntax(String),
    /// TOML reads a key with a dot as a table.
    #[error("[{section}] {key}: a key with a dot needs quotes, as in \"{key}\" = …")]
    UnquotedKey {
        /// Section of the file.
        section: &'static str,
        /// The key.
        key: String,
    },
}

/// Why a text is not the values of an axis.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum AxisProblem {
    /// A list like `1,,2`.
    #[error("a value is empty")]
    EmptyValue,
    /// A word in quotes.
    #[error("{0}: don't quote words")]
    Quoted(String),
    /// A number is expected.
    #[error("{0:?} is not a finite number")]
    NotANumber(String),
    /// A range has a slash, but no number of values.
    #[error("the number of values is missing")]
    NoCount,
    /// Not a range.
    #[error("expected a..b/N or a..b/Nlog, or a..b for a sample")]
    NotARange,
    /// Not a possible number of values.
    #[error("{text:?} is not a number of values from 2 to {most}")]
    WrongCount {
        /// The number as given.
        text: String,
        /// Largest possible number.
        most: u32,
    },
    /// The logarithm of an end does not exist.
    #[error("a logarithmic range needs positive ends")]
    NotPositive,
    /// A grid needs a number of values of each axis.
    #[error("a grid needs a number of values, e.g. {0} = a..b/10 (or draw a sample)")]
    GridWithoutCount(&'static str),
    /// A sample chooses values itself.
    #[error("for a sample, write a..b or a..b/log (without a number of values)")]
    SampleWithCount,
    /// An item of a list in a file is a list itself.
    #[error("each item of a list must be one value, without commas")]
    ListInList,
}

/// Why a table of runs or outcomes can't be read.
#[derive(Debug, Error)]
pub enum TableError {
    /// The name has another extension.
    #[error("must be a .parquet or a .csv file")]
    Extension,
    /// The file is no Parquet file.
    #[error("not a Parquet file (wrong magic bytes)")]
    NotParquet,
    /// There are no rows.
    #[error("there are no rows")]
    Empty,
    /// The rows don't fit into memory.
    #[error("more than {0} rows: split the table")]
    TooManyRows(u64),
    /// A column is not a key.
    #[error(transparent)]
    Key(#[from] ScenarioError),
    /// Two columns have the same key.
    #[error("{0} varies twice")]
    VariesTwice(&'static str),
    /// The cells of a column can't be read.
    #[error("{column}: {source}")]
    Column {
        /// Name of the column.
        column: String,
        /// The reason.
        source: CellError,
    },
    /// A quote in a CSV file is not closed.
    #[error("line {line}: unclosed quote")]
    UnclosedQuote {
        /// Line, from 1.
        line: u64,
    },
    /// A row of a CSV file has another number of cells than the header.
    #[error("line {line} has {count} {}, the header has {expected}", if *count == 1 { "cell" } else { "cells" })]
    CellCount {
        /// Line, from 1.
        line: u64,
        /// Cells of the line.
        count: usize,
        /// Cells of the header.
        expected: usize,
    },
    /// A column without a name is no row index.
    #[error(
        "line {line}: {cell:?} is in an unnamed column, which must be a row index (0, 1, 2, …): name the column or remove it"
    )]
    UnnamedColumn {
        /// Line, from 1.
        line: u64,
        /// The cell.
        cell: String,
    },
    /// A cell of a CSV file is not a number.
    #[error("line {line}: {} = {cell:?} is not a number", key.path)]
    NotANumber {
        /// Line, from 1.
        line: u64,
        /// Key of the column.
        key: &'static Key,
        /// The cell.
        cell: String,
    },
    /// The CSV file can't be parsed.
    #[error(transparent)]
    Csv(#[from] csv::Error),
    /// The Parquet file can't be read.
    #[error(transparent)]
    Parquet(#[from] ParquetError),
    /// The rows of a Parquet file can't be read.
    #[error(transparent)]
    Arrow(#[from] ArrowError),
    /// The file makes its reader panic.
    #[error("the file is damaged")]
    Damaged,
    /// The table lacks a column.
    #[error("no column {name}; columns: {columns}")]
    NoColumn {
        /// The requested column.
        name: String,
        /// All columns, separated by commas.
        columns: String,
    },
    /// The file has no spec of a sweep.
    #[error("it is not the table of a sweep")]
    NotASweep,
    /// There is no row with this number.
    #[error("no row {row}: the table has {rows} rows, numbered from 0")]
    NoRow {
        /// The requested row.
        row: u64,
        /// Number of rows.
        rows: u64,
    },
    /// A row that should exist can't be read.
    #[error("row {0} is missing")]
    MissingRow(u64),
    /// The base in the spec has a value that is neither number nor text.
    #[error(transparent)]
    Json(#[from] serde_json::Error),
    /// The values of a row are not those that were run.
    #[error(
        "the scenario of row {0} does not match its digest: the table was modified or written by another version"
    )]
    ModifiedRow(u64),
}

/// Why the cells of a column can't be read.
#[derive(Debug, Error)]
pub enum CellError {
    /// Values of this type are neither numbers nor words.
    #[error("values of type {0} are neither numbers nor words")]
    Type(DataType),
    /// Words in a column of numbers.
    #[error("the values are words; expected {0}")]
    Words(Kind),
    /// Numbers in a column of words.
    #[error("the values are numbers; expected {0}")]
    Numbers(Kind),
    /// A word in a column that is read as numbers.
    #[error("{0:?} is not a number")]
    NotANumber(String),
    /// A value can't be converted.
    #[error(transparent)]
    Conversion(#[from] ArrowError),
}

/// Why an existing file or directory can't be used.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum FileProblem {
    /// The table is another kind of file.
    #[error("exists and is not a sweep table: choose another name")]
    NotATable,
    /// The table's checksum is wrong.
    #[error(
        "is damaged or was modified: choose another name, or delete it and run the sweep again"
    )]
    Modified,
    /// The spec of the existing files can't be read.
    #[error("is damaged (its spec is unreadable): choose another name or delete it")]
    UnreadableSpec,
    /// The existing files have another spec, with this difference.
    #[error("belongs to another sweep: {0}; choose another name or delete it")]
    OtherSweep(String),
    /// The part belongs to another sweep.
    #[error("can't be merged: it belongs to another sweep; delete it and run the sweep again")]
    OtherPart,
    /// The part is missing or damaged.
    #[error("can't be merged: it is missing or damaged; delete it and run the sweep again")]
    MissingPart,
}

impl SweepError {
    /// The error of a scenario, if it is one.
    pub fn scenario_error(&self) -> Option<&ScenarioError> {
        match self {
            Self::Scenario(error) | Self::Base { source: error, .. } => Some(error),
            Self::Input(error) => error.scenario_error(),
            Self::Table { source, .. } => match source {
                TableError::Key(error) => Some(error),
                _ => None,
            },
            Self::Spec(_)
            | Self::Axis { .. }
            | Self::Unusable { .. }
            | Self::Row(_)
            | Self::Parquet(_)
            | Self::Threads(_)
            | Self::Sink(_) => None,
        }
    }

    /// The key that is at fault, if it is a single one.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Axis { key, .. }
            | Self::Table {
                source: TableError::NotANumber { key, .. },
                ..
            } => Some(key.path),
            Self::Spec(SpecError::VariesTwice(key) | SpecError::SetAndVaried(key))
            | Self::Table {
                source: TableError::VariesTwice(key),
                ..
            } => Some(key),
            Self::Spec(SpecError::UnquotedKey { key, .. }) => Some(key),
            other => other.scenario_error()?.key.as_deref(),
        }
    }

    /// An error for an existing file or directory that can't be used.
    pub(super) fn unusable(path: &Path, problem: FileProblem) -> Self {
        Self::Unusable {
            path: path.to_owned(),
            problem,
        }
    }

    /// The error for a table that can't be read.
    pub(super) fn table<E: Into<TableError>>(path: &Path, reason: E) -> Self {
        Self::Table {
            path: path.to_owned(),
            source: reason.into(),
        }
    }

    /// The error for a failed operation on a file.
    pub(super) fn io(action: &'static str, path: &Path, reason: io::Error) -> Self {
        Self::Sink(SinkError::Io {
            action,
            path: path.to_owned(),
            reason,
        })
    }
}

impl TableError {
    /// The error for a column whose cells can't be read.
    pub(super) fn column<E: Into<CellError>>(column: &str, reason: E) -> Self {
        Self::Column {
            column: column.to_owned(),
            source: reason.into(),
        }
    }

    /// The error for a missing column.
    pub(super) fn no_column(name: &str, columns: &[&str]) -> Self {
        Self::NoColumn {
            name: name.to_owned(),
            columns: columns.join(", "),
        }
    }
}
