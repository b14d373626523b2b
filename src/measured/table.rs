//! Tables of measured values: their columns as signals.

use super::cell::{Cell, Mark};
use super::column;
use super::error::DataError;
use super::signal::{Clock, FileSignals, SigmaSpec, Signal, SignalRow, SignalSpec};
use super::unit::{Dimension, is_unit, split_header};
use crate::words::{Piece, Sentence, sentence};
use std::path::Path;

/// Maximum number of rows of a table (held in memory).
pub(super) const MAX_ROWS: usize = 2_000_000;

/// Maximum number of characters of a cell in an error.
pub(super) const MAX_SHOWN: usize = 40;

/// A table of cells with a header.
pub(super) struct Table<'a> {
    pub path: &'a Path,
    /// Names of the columns, with their units.
    pub columns: Vec<String>,
    /// Whether a line names the columns, and not only their numbers.
    pub is_named: bool,
    /// Whether arguments can name the columns, too.
    pub has_arguments: bool,
    pub rows: TableRows,
}

/// The cells of a table.
pub(super) enum TableRows {
    /// Cells of text.
    Text {
        lines: Vec<Line>,
        /// Decimal mark of each column; `None` if it is not certain.
        marks: Vec<Option<Mark>>,
    },
    /// Cells of numbers, by column.
    #[cfg(feature = "sweep")]
    Numbers {
        columns: Vec<NumberColumn>,
        count: usize,
    },
}

/// A column of numbers.
#[cfg(feature = "sweep")]
#[derive(Default)]
pub(super) struct NumberColumn {
    /// None of a column that is not needed.
    pub cells: Vec<Option<f64>>,
    /// Whether the cells are times in seconds because the type of the column says so.
    pub is_time: bool,
}

/// A line of a text table.
pub(super) struct Line {
    /// Number of the line in the file, from 1.
    pub number: u64,
    pub record: csv::StringRecord,
}

impl TableRows {
    fn count(&self) -> usize {
        match self {
            Self::Text { lines, .. } => lines.len(),
            #[cfg(feature = "sweep")]
            Self::Numbers { count, .. } => *count,
        }
    }

    /// The number of a row in the file, from 1.
    fn line(&self, row: usize) -> u64 {
        match self {
            Self::Text { lines, .. } => lines[row].number,
            #[cfg(feature = "sweep")]
            Self::Numbers { .. } => row as u64 + 1,
        }
    }

    /// Whether the type of a column says that its cells are times, in seconds.
    #[cfg_attr(
        not(feature = "sweep"),
        expect(unused_variables, reason = "only Parquet has types")
    )]
    fn is_typed_time(&self, column: usize) -> bool {
        match self {
            Self::Text { .. } => false,
            #[cfg(feature = "sweep")]
            Self::Numbers { columns, .. } => columns[column].is_time,
        }
    }
}

impl Table<'_> {
    /// The signals that are in a file. Without `specs`, these are the columns that are named like fields.
    pub(super) fn signals(
        self,
        file: usize,
        specs: &[SignalSpec],
        time: Option<&str>,
    ) -> Result<FileSignals, DataError> {
        let clock = self.clock(time)?;
        let named: Vec<SignalSpec> = if specs.is_empty() {
            self.named_signals()
        } else {
            specs.iter().filter_map(|spec| self.find(spec)).collect()
        };
        if named.is_empty() && specs.is_empty() {
            let other = self.columns.iter().find(|column| !column::is_time(column));
            let example = other.map_or("COLUMN", String::as_str);
            let problem = sentence!(
                "no column is named like a field of the top; there {}",
                column::listed(&self.columns)
            );
            let remedy = sentence!(
                "name the columns, e.g. {}",
                Piece::argument_with("signal", format!("theta={example}"))
            );
            return Err(self.error(problem).with_remedy(remedy));
        }
        self.check_duplicates(&named, specs.is_empty())?;
        let mut signals = Vec::new();
        for spec in &named {
            signals.push(Signal {
                clock: Some(self.clock_of(&clock, time.is_some())),
                ..self.signal(spec, &clock, file)?
            });
        }
        Ok(FileSignals {
            signals,
            known: self.columns,
        })
    }

    /// A signal if it is in this table: which one of several files it is in, its name says. A colon may belong to the
    /// name of a column, and is tried as a part of it first.
    fn find(&self, spec: &SignalSpec) -> Option<SignalSpec> {
        let unsplit = spec.unsplit();
        [unsplit.as_ref(), Some(spec)]
            .into_iter()
            .flatten()
            .find(|spec| self.position(&spec.source).is_some())
            .cloned()
    }

    /// The column with a name; the first one if there are several.
    fn position(&self, name: &str) -> Option<usize> {
        self.positions(name).first().copied()
    }

    /// The columns with a name.
    fn positions(&self, name: &str) -> Vec<usize> {
        column::positions(&self.columns, name)
    }

    /// The only column with a name.
    fn only_position(&self, name: &str) -> Result<usize, DataError> {
        match self.positions(name)[..] {
            [] => Err(self.missing(name)),
            [at] => Ok(at),
            [..] => Err(self.error(sentence!(
                "several columns are called {}: rename them",
                name.to_owned()
            ))),
        }
    }

    /// Refuses columns that would count twice, and names that stand for several columns.
    fn check_duplicates(
        &self,
        specs: &[SignalSpec],
        is_found_by_name: bool,
    ) -> Result<(), DataError> {
        for (at, spec) in specs.iter().enumerate() {
            self.only_position(&spec.source)?;
            for other in &specs[..at] {
                if self.position(&other.source) == self.position(&spec.source) {
                    return Err(read_twice(&spec.source).in_file(self.path));
                }
                if is_found_by_name && other.field == spec.field {
                    return Err(self.measured_twice(spec, other, specs));
                }
            }
        }
        Ok(())
    }

    /// The error of the file.
    fn error(&self, problem: impl Into<Sentence>) -> DataError {
        DataError::new(problem).in_file(self.path)
    }

    /// The error of a cell.
    fn cell_error(
        &self,
        column: &Cells<'_>,
        row: usize,
        problem: impl Into<Sentence>,
    ) -> DataError {
        self.error(problem)
            .in_line(self.rows.line(row))
            .in_column(column.name)
    }

    /// The error of two columns that were found by their names and measure the same field. Columns that are named replace
    /// all that were found, so the remedy names those of the other fields, too.
    fn measured_twice(
        &self,
        spec: &SignalSpec,
        other: &SignalSpec,
        specs: &[SignalSpec],
    ) -> DataError {
        let field = spec.field.to_string();
        let choice = format!("{field}={}", other.source);
        let further = specs
            .iter()
            .filter(|further| further.field != spec.field)
            .map(SignalSpec::description)
            .collect();
        let problem = sentence!(
            "the columns {} and {} both measure {}",
            &other.source,
            &spec.source,
            field
        );
        self.error(problem).with_remedy(sentence!(
            "choose one, e.g. {}",
            Piece::argument_with_all("signal", choice, further)
        ))
    }

    fn missing(&self, name: &str) -> DataError {
        self.error(format!(
            "no column {name}; there {}{}",
            column::listed(&self.columns),
            column::similar(name, &self.columns)
        ))
    }

    /// The column of times.
    fn clock<'a>(&'a self, name: Option<&'a str>) -> Result<Cells<'a>, DataError> {
        if let Some(name) = name {
            return self.cells(name, Dimension::Time);
        }
        match column::clocks(&self.columns, None)[..] {
            [at] => self.cells_at(at, &self.columns[at], Dimension::Time),
            [] if !self.is_named => Err(self.no_header()),
            [] => {
                let problem = sentence!(
                    "no column of times; there {}",
                    column::listed(&self.columns)
                );
                Err(self.error(problem).with_remedy(sentence!(
                    "name it with {}, or add one: the number of the frame divided by the frame rate",
                    Piece::argument("time")
                )))
            }
            ref several => {
                let names: Vec<&str> = several.iter().map(|at| &*self.columns[*at]).collect();
                let problem =
                    sentence!("several columns are named like times: {}", names.join(", "));
                Err(self
                    .error(problem)
                    .with_remedy(self.rename_or_choose(&names)))
            }
        }
    }

    /// What helps with several columns of times: only a name that no other column has can be chosen.
    fn rename_or_choose(&self, names: &[&str]) -> Sentence {
        let mut choices = Vec::new();
        for name in names {
            if self.has_arguments && self.positions(name).len() == 1 {
                choices.push(Piece::argument_with("time", *name).into());
            }
        }
        if choices.is_empty() {
            return sentence!("rename all but one");
        }
        let choices = Sentence::join(choices, " or ");
        sentence!("rename all but one, or choose with {}", choices)
    }

    /// The error of a table in which no line names the columns.
    fn no_header(&self) -> DataError {
        let columns = self.columns.len();
        if columns == 1 {
            return self.error("a single column").with_remedy(sentence!(
                "write the times beside the values, e.g. t,theta (deg)"
            ));
        }
        let problem = sentence!("no line names the {} columns", columns.to_string());
        let first_line = sentence!(
            "write a first line that does, e.g. t,theta (deg) or t,theta (deg),phi (deg)"
        );
        self.error(problem).with_remedy(if self.has_arguments {
            sentence!(
                "{}, or use their numbers: {} {}",
                first_line,
                Piece::argument_with("time", "1"),
                Piece::argument_with("signal", "theta=2 (deg)")
            )
        } else {
            first_line
        })
    }

    /// The columns that are named like fields, or else those that are within a data set.
    fn named_signals(&self) -> Vec<SignalSpec> {
        for field_of in [SignalSpec::from_column, SignalSpec::from_data_set] {
            let named: Vec<_> = self.columns.iter().filter_map(|c| field_of(c)).collect();
            if !named.is_empty() {
                return named;
            }
        }
        Vec::new()
    }

    fn signal(
        &self,
        spec: &SignalSpec,
        times: &Cells<'_>,
        file: usize,
    ) -> Result<Signal, DataError> {
        let dimension = Dimension::from_si(spec.field.unit());
        let values = self.cells(&spec.source, dimension)?;
        let deviations = match &spec.sigma {
            SigmaSpec::Estimate | SigmaSpec::Number(..) => None,
            SigmaSpec::Column(name) => Some(self.cells(name, dimension)?),
        };
        let (mut rows, mut missing) = (Vec::new(), 0);
        for row in 0..self.rows.count() {
            let sigma = match &deviations {
                Some(cells) => {
                    let Some(sigma) = self.cell(cells, row)? else {
                        missing += 1;
                        continue;
                    };
                    Some(self.check_sigma(cells, row, sigma)?)
                }
                None => None,
            };
            match (self.cell(times, row)?, self.cell(&values, row)?) {
                (Some(time), Some(value)) => rows.push(SignalRow {
                    time,
                    value,
                    sigma,
                    line: self.rows.line(row),
                }),
                (Some(_) | None, Some(_) | None) => missing += 1,
            }
        }
        if rows.is_empty() {
            return Err(self.error(sentence!("column {} has no values", &spec.source)));
        }
        let signal = Signal::new(spec, file, rows, missing, Some(self.path))
            .map_err(|error| error.in_file(self.path))?;
        Ok(Signal {
            is_unit_known: !values.unit.is_empty(),
            ..signal
        })
    }

    /// The column with a name. Its unit is that of its type, or else of the header, or else of the name.
    fn cells<'a>(&'a self, name: &'a str, dimension: Dimension) -> Result<Cells<'a>, DataError> {
        let at = self.only_position(name)?;
        self.cells_at(at, name, dimension)
    }

    /// The column at an index.
    fn cells_at<'a>(
        &'a self,
        at: usize,
        name: &'a str,
        dimension: Dimension,
    ) -> Result<Cells<'a>, DataError> {
        let column = &self.columns[at];
        if self.rows.is_typed_time(at) {
            // A unit in the name can be that of the ticks, which the type has already turned into seconds.
            if dimension != Dimension::Time {
                return Err(self.error(sentence!(
                    "column {} has times, by its type; expected: {}",
                    column,
                    dimension.meaning()
                )));
            }
            return Ok(Cells {
                at,
                name: column,
                unit: "s",
                factor: 1.0,
            });
        }
        let unit = match split_header(column).1 {
            "" => split_header(name).1,
            unit => unit,
        };
        let factor = dimension
            .factor(unit, column)
            .map_err(|error| error.in_file(self.path))?;
        Ok(Cells {
            at,
            name: column,
            unit,
            factor,
        })
    }

    /// The column of times as signals know it. One that was named is beyond doubt.
    fn clock_of(&self, cells: &Cells<'_>, is_named: bool) -> Clock {
        let mut others = Vec::new();
        for column in &self.columns {
            if !is_named && column::is_time(column) && column != cells.name {
                others.push(column.clone());
            }
        }
        Clock {
            name: cells.name.to_owned(),
            is_unit_known: !cells.unit.is_empty() || is_unit(cells.name),
            others,
        }
    }

    /// The value of a cell in SI units; `None` if it is missing.
    fn cell(&self, column: &Cells<'_>, row: usize) -> Result<Option<f64>, DataError> {
        let number = match &self.rows {
            TableRows::Text { lines, marks } => {
                let text = lines[row].record.get(column.at).unwrap_or_default();
                match Cell::parse(text) {
                    Cell::Missing => None,
                    Cell::Number(number, _) => Some(number),
                    Cell::Unclear(number, mark) if marks[column.at] == Some(mark) => Some(number),
                    Cell::Unclear(number, _) => {
                        return Err(self.thousands(column, row, text, Some(number)));
                    }
                    Cell::Grouped => return Err(self.thousands(column, row, text, None)),
                    Cell::Text => {
                        let problem = format!("{:?} is not a number", shown(text));
                        return Err(self.cell_error(column, row, problem));
                    }
                }
            }
            #[cfg(feature = "sweep")]
            TableRows::Numbers { columns, .. } => {
                columns[column.at].cells.get(row).copied().flatten()
            }
        };
        Ok(number.map(|number| number * column.factor))
    }

    fn thousands(
        &self,
        column: &Cells<'_>,
        row: usize,
        text: &str,
        decimal: Option<f64>,
    ) -> DataError {
        let meaning = match decimal {
            Some(number) => format!("can be {number} or {}", 1e3 * number),
            None => "has separators of thousands".to_owned(),
        };
        let text = shown(text);
        let problem = format!("{text:?} {meaning}: write numbers without separators of thousands");
        self.cell_error(column, row, problem)
    }

    fn check_sigma(&self, column: &Cells<'_>, row: usize, value: f64) -> Result<f64, DataError> {
        if value > 0.0 {
            return Ok(value);
        }
        let problem = format!("the standard deviation {value} is not positive");
        Err(self.cell_error(column, row, problem))
    }
}

/// A text, cut for an error.
fn shown(text: &str) -> String {
    text.chars().take(MAX_SHOWN).collect()
}

/// The error of more rows than are held in memory.
pub(super) fn too_long() -> DataError {
    let limit = MAX_ROWS.to_string();
    DataError::new(sentence!("more than {} rows: thin out the data", limit))
}

/// The error of a column, or topic and path, that would count twice.
pub(super) fn read_twice(source: &str) -> DataError {
    DataError::new(sentence!(
        "{} is read twice as a signal: each value may count only once",
        source.to_owned()
    ))
}

/// A column: index, name, unit (may be empty), and size of the unit.
struct Cells<'a> {
    at: usize,
    name: &'a str,
    unit: &'a str,
    factor: f64,
}

/// Whether a column is needed for these signals.
#[cfg(feature = "sweep")]
pub(super) fn is_needed(header: &str, specs: &[SignalSpec], time: Option<&str>) -> bool {
    let is_clock = match time {
        Some(time) => column::can_mean(header, time),
        None => column::is_time(header),
    };
    let mut is_named = specs.is_empty() && SignalSpec::from_data_set(header).is_some();
    for spec in specs {
        is_named |= column::can_mean(header, &spec.source);
        if let Some(unsplit) = spec.unsplit() {
            is_named |= column::can_mean(header, &unsplit.source);
        }
        if let SigmaSpec::Column(sigma) = &spec.sigma {
            is_named |= column::can_mean(header, sigma);
        }
    }
    is_clock || is_named
}
