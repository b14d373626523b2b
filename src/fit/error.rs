//! Errors of fits.

use super::degeneracy::{Degeneracy, join_clauses, pronoun};
use super::parameter::is_offset;
use super::place::{Place, ValuePlace};
use crate::archive::recording::RecordingError;
use crate::run::scenario::ScenarioError;
use crate::run::simulation::SimulationError;
use crate::telemetry::fields::state;
use std::fmt::{self, Display, Formatter};
use std::io;
use std::path::{Path, PathBuf};
use thiserror::Error;

/// Error of reading measured data.
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
    #[error("{}:{line}: {cells} cells, but {columns} columns{}", path.display(), if *has_commas { "; if numbers have decimal commas, separate the columns with semicolons or tabs" } else { "" })]
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
    #[error("{}: no {what} {name}; there {}", path.display(), listed(known))]
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
    /// A signal is in none of the files.
    #[error("{}", not_found(source_name, files))]
    NotFound {
        /// Column of the signal, or topic and path.
        source_name: String,
        /// The files.
        files: Vec<Contents>,
    },
    /// A file has none of the signals.
    #[error("{}: none of the signals is in this file: leave it out, or name its signals with --signal; there {}", .0.path.display(), listed(&.0.known))]
    UnusedFile(Contents),
    /// No column has the name of a field.
    #[error("{}: no column is named like a field of the top; name the columns with --signal, e.g. --signal theta={}; columns: {}", path.display(), quoted(columns.last()), columns.join(", "))]
    NoSignals {
        /// The file.
        path: PathBuf,
        /// The columns of the file.
        columns: Vec<String>,
    },
    /// A recording has all fields: some must be chosen.
    #[error("{}: choose the fields to fit, e.g. --signal {}:1mrad", path.display(), state::THETA)]
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
    /// A signal can't be parsed.
    #[error("--signal {text}: {reason}; write FIELD=COLUMN:SIGMA, e.g. theta=\"tilt (deg)\":2mrad")]
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
    #[error("{}: the columns {} and {} both measure {field}: choose with --signal", path.display(), columns[0], columns[1])]
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
    /// All values of a signal are missing.
    #[error("{}: column {column} has no values", path.display())]
    NoValues {
        /// The file.
        path: PathBuf,
        /// Column.
        column: String,
    },
}

impl DataError {
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
    if let [file] = files {
        let path = file.path.display();
        return format!(
            "{path}: no column or topic {name}; there {}",
            listed(&file.known)
        );
    }
    let mut sentence = format!("no column or topic {name} in any file");
    for file in files {
        let path = file.path.display();
        sentence += &format!("; in {path} there {}", listed(&file.known));
    }
    sentence
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

/// Reason why the description of a signal can't be used.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SignalError {
    /// There is no such field.
    #[error("unknown field {name}; fields: {known}")]
    UnknownField {
        /// The name that no field has.
        name: String,
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

/// Error of a fit.
#[derive(Debug, Error)]
pub enum FitError {
    /// The data can't be read.
    #[error(transparent)]
    Data(#[from] DataError),
    /// A key can't be fitted, or a scenario is invalid.
    #[error(transparent)]
    Scenario(#[from] ScenarioError),
    /// A key can't be fitted.
    #[error("{name} can't be fitted: {reason}")]
    Key {
        /// The key.
        name: String,
        /// The reason.
        reason: &'static str,
    },
    /// There is no such law.
    #[error("unknown law {name}; laws: {known}")]
    UnknownLaw {
        /// The name that no law has.
        name: String,
        /// The laws.
        known: String,
    },
    /// Bounds exclude the start, or each other.
    #[error("{name}: the bounds {low} to {high} must contain the start, {start}")]
    Bounds {
        /// The parameter.
        name: String,
        /// Lower bound.
        low: f64,
        /// Upper bound.
        high: f64,
        /// Start value.
        start: f64,
    },
    /// A bound is given for a parameter that is not free.
    #[error("--bound {name}: the parameter is not free")]
    NotFree {
        /// The parameter.
        name: String,
    },
    /// No parameter is free.
    #[error("nothing to fit: none of the free parameters changes any signal")]
    NothingFree,
    /// A signal has no value in the time that is fitted.
    #[error("{field} has no value from t = {origin} s{}: its times are {first} to {last} s; see --start and --until", until.map_or(String::new(), |until| format!(" to {until} s")))]
    OutOfRange {
        /// The field.
        field: String,
        /// First time of the signal, s.
        first: f64,
        /// Last time of the signal, s.
        last: f64,
        /// Time at which the scenario starts, s.
        origin: f64,
        /// Time at which the fitted data end, s.
        until: Option<f64>,
    },
    /// The data have a gap that is long compared with all of them.
    #[error(
        "the data have no values from t = {from} to {to} s, and are only {rest} s long without this gap; is a time wrong ({stray} {} {}{})? Remove {}, or leave {} out with {remedy}",
        if *stray == 1 { "row" } else { "rows" },
        remedy.side(),
        place.as_ref().map_or_else(String::new, |place| if *stray == 1 { format!(": {place}") } else { format!(", next to it {place}") }),
        pronoun(*stray),
        pronoun(*stray)
    )]
    Gap {
        /// Last time before the gap, on the clock of the first file, s.
        from: f64,
        /// First time after the gap, s.
        to: f64,
        /// Time of the data without the gap, s.
        rest: f64,
        /// Number of times on the side with fewer of them.
        stray: usize,
        /// The line of that side that is next to the gap.
        place: Option<Place>,
        /// Option that leaves that side out.
        remedy: Cut,
    },
    /// A value is too large for a sum of squares.
    #[error(
        "{place}: the value {value:e} at t = {time} s, with the standard deviation {sigma:e}, is too large to be fitted: remove it"
    )]
    Size {
        /// The value.
        place: ValuePlace,
        /// Time of the value, s.
        time: f64,
        /// The value, SI units.
        value: f64,
        /// Standard deviation of the value.
        sigma: f64,
    },
    /// Inclinations that are too large for radians.
    #[error(
        "most values of {name} are above π (median {median:.4}), but an inclination in rad is not: check the unit; degrees need one in the header, e.g. \"{name} (deg)\""
    )]
    Inclination {
        /// Median of the values, rad if the unit is right.
        median: f64,
        /// Name of the column without its unit, or topic and path.
        name: String,
    },
    /// Values that agree with the motion at the start in another unit only.
    #[error(
        "{field}: the values are about {ratio:.0} times those of the motion at the start; in {unit} they would agree with it. If they are in {unit}, write that into the header: \"{name} ({unit})\"; if they are in {si}, start closer to the motion (--set)"
    )]
    LikelyUnit {
        /// The field.
        field: String,
        /// Size of the values, relative to the motion.
        ratio: f64,
        /// The unit in which they agree.
        unit: &'static str,
        /// The SI unit, in which they were read.
        si: &'static str,
        /// Name of the column without its unit, or topic and path.
        name: String,
    },
    /// All values of a signal are equal, and no standard deviation is given.
    #[error(
        "{field}: all values are {value} {unit}: they have no noise from which a standard deviation could be estimated; check the sensor, leave {source_name} out, or give σ (--signal)"
    )]
    NoNoise {
        /// The field.
        field: String,
        /// Name of the column, or topic and path.
        source_name: String,
        /// The value, SI units.
        value: f64,
        /// Unit; may be empty.
        unit: &'static str,
    },
    /// No motion near the start of a parameter reaches the data.
    #[error(
        "{name}: no motion with a slightly larger or smaller value can be computed: change its start (--set) or its bounds"
    )]
    NoDerivative {
        /// The parameter.
        name: String,
    },
    /// No offset within its bounds brings half of a file's samples into the motion.
    #[error(
        "{name}: no offset from {low} to {high} s brings half of its file's samples ({first} to {last} s) into the motion (0 to {end} s)"
    )]
    NoOverlap {
        /// The offset.
        name: String,
        /// First time of the file, s.
        first: f64,
        /// Last time, s.
        last: f64,
        /// End of the motion, s.
        end: f64,
        /// Lower bound, s.
        low: f64,
        /// Upper bound, s.
        high: f64,
    },
    /// The data are too few.
    #[error("{samples} samples can't determine {parameters} parameters")]
    TooFew {
        /// Number of samples in the fit.
        samples: usize,
        /// Number of free parameters.
        parameters: usize,
    },
    /// Parameters can't be told apart.
    #[error("{}", join_clauses(degeneracies))]
    NotIdentifiable {
        /// The groups of parameters.
        degeneracies: Vec<Degeneracy>,
    },
    /// The model ends before the data.
    #[error(
        "the model ends at t = {end:.4} s ({reason}), the data at {needed:.4} s: fit only the data before that (--until {end:.3}), or start closer to the motion (--set)"
    )]
    ModelEnds {
        /// End of the model, s.
        end: f64,
        /// Why it ends.
        reason: String,
        /// End of the data, s.
        needed: f64,
    },
    /// A simulation failed.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The optimiser refused its input.
    #[error("the optimiser failed: {0}")]
    Optimiser(&'static str),
}

impl FitError {
    /// The key of the scenario that is at fault, if it is a single one.
    pub fn key(&self) -> Option<&str> {
        match self {
            Self::Scenario(error) => error.key.as_deref(),
            // The offset of a clock is a parameter, but no key.
            Self::Key { name, .. }
            | Self::Bounds { name, .. }
            | Self::NotFree { name }
            | Self::NoDerivative { name } => Some(name.as_str()).filter(|name| !is_offset(name)),
            Self::NotIdentifiable { degeneracies } => match &degeneracies[..] {
                [Degeneracy::Unseen { names }] if names.len() == 1 => Some(&names[0]),
                _ => None,
            },
            Self::Data(_)
            | Self::UnknownLaw { .. }
            | Self::NothingFree
            | Self::OutOfRange { .. }
            | Self::Gap { .. }
            | Self::Size { .. }
            | Self::Inclination { .. }
            | Self::LikelyUnit { .. }
            | Self::NoNoise { .. }
            | Self::NoOverlap { .. }
            | Self::TooFew { .. }
            | Self::ModelEnds { .. }
            | Self::Simulation(_)
            | Self::Optimiser(_) => None,
        }
    }
}

/// An option that leaves out a part of the data.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cut {
    /// `--start` at this time of the data, s.
    Start(f64),
    /// `--until` this time after the start, s.
    Until(f64),
}

impl Cut {
    /// The side of a gap that is left out.
    fn side(self) -> &'static str {
        match self {
            Self::Start(_) => "before it",
            Self::Until(_) => "after it",
        }
    }
}

impl Display for Cut {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::Start(time) => write!(f, "--start {time}"),
            Self::Until(time) => write!(f, "--until {time}"),
        }
    }
}

/// A name in quotes for an example on the command line.
fn quoted(name: Option<&String>) -> String {
    match name {
        Some(name) if name.contains(|c: char| !c.is_ascii_alphanumeric() && c != '_') => {
            format!("\"{name}\"")
        }
        Some(name) => name.clone(),
        None => "COLUMN".to_owned(),
    }
}
