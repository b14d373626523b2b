//! Tables of measured values: their columns as signals.

use super::error::DataError;
use super::layout::{Decimal, Delimiter, Layout};
use super::name::{ColumnName, Meaning, unit_of};
use super::number::Cell;
use super::reading::{ColumnReading, FileReading, SIGMA, TIME};
use super::rows::{Row, Rows};
use super::signal::Signal;
use super::spec::{SigmaSpec, SignalSpec};
use super::text::{Line, cut};
use super::unit::{Dimension, Unit};
use crate::run::suggestion::{did_you_mean, similar_names};
use crate::words::{Piece, Sentence, sentence};
use std::path::Path;

/// A table of cells with a header.
pub(super) struct Table<'a> {
    pub path: &'a Path,
    /// Index of the file.
    pub file: usize,
    /// Names of the columns, with their units.
    pub columns: Vec<String>,
    pub cells: Cells,
}

/// The cells of a table.
pub(super) enum Cells {
    /// Cells of text.
    Text {
        lines: Vec<Line>,
        delimiter: Delimiter,
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

impl Cells {
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

/// A column that is read.
struct Column<'a> {
    at: usize,
    name: &'a str,
    dimension: Dimension,
    /// `None` for none, that is, the SI unit.
    unit: Option<&'static Unit>,
    /// Whether the type of the column says that it has times in seconds.
    is_typed_time: bool,
}

impl Column<'_> {
    fn reading(&self, measures: &str, missing: u64) -> ColumnReading {
        let has_unit = self.unit.is_some() || self.is_typed_time;
        ColumnReading {
            column: self.name.to_owned(),
            measures: measures.to_owned(),
            unit: self.unit.map_or(self.dimension.si(), Unit::name).to_owned(),
            is_unit_assumed: !has_unit && self.dimension != Dimension::Number,
            missing,
        }
    }
}

/// The signals of a file, and what was read of it.
pub(super) struct FileSignals {
    pub signals: Vec<Signal>,
    pub reading: FileReading,
    /// Names of all columns, or topics.
    pub known: Vec<String>,
}

impl Table<'_> {
    /// The signals that are in the table. Without `specs`, these are the columns that are named like fields.
    pub(super) fn signals(
        self,
        specs: &[SignalSpec],
        layout: &Layout,
    ) -> Result<FileSignals, DataError> {
        let clock = self.clock(layout)?;
        let specs = if specs.is_empty() {
            self.named_signals()?
        } else {
            let known = |name: &str| !self.positions(name).is_empty();
            specs
                .iter()
                .filter_map(|spec| spec.resolved(known))
                .collect()
        };
        let mut columns = vec![clock];
        // Index of the column of values among those that are read, and that of their standard deviations.
        let mut places = Vec::new();
        for spec in &specs {
            let dimension = Dimension::from_si(spec.field.unit());
            let values = self.column(&spec.source, dimension)?;
            if columns.iter().any(|column| column.at == values.at) {
                return Err(read_twice(&spec.source).in_file(self.path));
            }
            columns.push(values);
            places.push((columns.len() - 1, None));
        }
        for (spec, place) in specs.iter().zip(&mut places) {
            if let SigmaSpec::Column(name) = &spec.sigma {
                columns.push(self.column(name, Dimension::from_si(spec.field.unit()))?);
                place.1 = Some(columns.len() - 1);
            }
        }
        let rows = self.rows(&columns, layout.decimal)?;
        let mut signals = Vec::new();
        let mut missing = vec![rows.without_time; columns.len()];
        for (spec, (values, sigma)) in specs.iter().zip(&places) {
            let signal = rows
                .signal(spec, self.file, *values, *sigma)?
                .ok_or_else(|| self.error(sentence!("column {} has no values", &spec.source)))?;
            missing[*values] = signal.missing;
            signals.push(signal);
        }
        let mut reading = FileReading {
            file: self.path.display().to_string(),
            rows: self.cells.count() as u64,
            left_out: rows.left_out(),
            ..FileReading::default()
        };
        for (at, column) in columns.iter().enumerate() {
            let spec = places.iter().position(|(values, _)| *values == at);
            let field = spec.map(|spec| specs[spec].field.to_string());
            let measures = match &field {
                Some(field) => field,
                None if at == 0 => TIME,
                None => SIGMA,
            };
            reading.columns.push(column.reading(measures, missing[at]));
        }
        for (at, column) in self.columns.iter().enumerate() {
            if columns.iter().all(|read| read.at != at) && !column.is_empty() {
                reading.unused.push(column.clone());
            }
        }
        Ok(FileSignals {
            signals,
            reading,
            known: self.columns,
        })
    }

    /// The rows with these columns, the first of which has the times.
    fn rows(
        &self,
        columns: &[Column<'_>],
        decimal: Option<Decimal>,
    ) -> Result<Rows<'_>, DataError> {
        let mut marks = Marks::new(&self.cells, decimal);
        let mut rows = Rows::new(Some(self.path));
        for row in 0..self.cells.count() {
            let mut cells = Vec::with_capacity(columns.len());
            for column in columns {
                cells.push(self.cell(column, row, &mut marks)?);
            }
            rows.push(Row {
                line: self.cells.line(row),
                cells,
            });
        }
        rows.complete();
        Ok(rows)
    }

    /// The value of a cell in SI units; `None` if it is missing.
    fn cell(
        &self,
        column: &Column<'_>,
        row: usize,
        marks: &mut Marks,
    ) -> Result<Option<f64>, DataError> {
        let factor = column.unit.map_or(1.0, |unit| unit.factor);
        let text = match &self.cells {
            Cells::Text { lines, .. } => lines[row].cell(column.at),
            #[cfg(feature = "sweep")]
            Cells::Numbers { columns, .. } => {
                let number = columns[column.at].cells.get(row).copied().flatten();
                return Ok(number.map(|number| number * factor));
            }
        };
        let problem = match Cell::parse(text, column.unit) {
            Cell::Missing => return Ok(None),
            Cell::Number(number, mark) => match marks.check(mark) {
                Ok(()) => return Ok(Some(number * factor)),
                Err(problem) => sentence!("{}: {}", format!("{:?}", cut(text)), problem),
            },
            Cell::Infinite => sentence!("{} is infinite", cut(text)),
            Cell::Text => sentence!("{} is not a number", format!("{:?}", cut(text))),
        };
        Err(self
            .error(problem)
            .in_line(self.cells.line(row))
            .in_column(column.name))
    }

    /// The columns with a name, or else with the same words.
    fn positions(&self, name: &str) -> Vec<usize> {
        let given = ColumnName::parse(name);
        let mut found = Vec::new();
        for is_exact in [true, false] {
            for (at, column) in self.columns.iter().enumerate() {
                let is_called = if is_exact {
                    column == name
                } else {
                    ColumnName::parse(column).is_called(&given)
                };
                if is_called {
                    found.push(at);
                }
            }
            if !found.is_empty() {
                break;
            }
        }
        found
    }

    /// The only column with a name. Its unit is that of the header, or else of the name.
    fn column<'a>(&'a self, name: &str, dimension: Dimension) -> Result<Column<'a>, DataError> {
        match self.positions(name)[..] {
            [] => {
                let known = self.columns.iter().map(String::as_str);
                let similar = did_you_mean(&similar_names(name, known));
                let name = name.to_owned();
                Err(self.error(sentence!(
                    "no column {}; there {}{}",
                    name,
                    listed(&self.columns),
                    similar
                )))
            }
            [at] => self.column_at(at, name, dimension),
            [..] => Err(self.error(sentence!(
                "several columns are called {}: rename them",
                name.to_owned()
            ))),
        }
    }

    fn column_at<'a>(
        &'a self,
        at: usize,
        name: &str,
        dimension: Dimension,
    ) -> Result<Column<'a>, DataError> {
        let column = &self.columns[at];
        let is_typed_time = self.cells.is_typed_time(at);
        if is_typed_time && dimension != Dimension::Time {
            return Err(self.error(sentence!(
                "column {} has times, by its type; expected: {}",
                column,
                dimension.meaning()
            )));
        }
        let unit = if is_typed_time {
            // A unit in the name can be that of the ticks, which the type has already turned into seconds.
            ""
        } else {
            match unit_of(column) {
                "" => unit_of(name),
                unit => unit,
            }
        };
        let unit = dimension
            .unit(unit)
            .map_err(|error| error.in_file(self.path).in_column(column))?;
        Ok(Column {
            at,
            name: column,
            dimension,
            unit,
            is_typed_time,
        })
    }

    /// The column of times: the one that is given, or else the only one that is named like times. One with a unit comes
    /// before those without.
    fn clock(&self, layout: &Layout) -> Result<Column<'_>, DataError> {
        if let Some(name) = &layout.time {
            return self.column(name, Dimension::Time);
        }
        let (mut clocks, mut unclear) = (Vec::new(), Vec::new());
        for (at, column) in self.columns.iter().enumerate() {
            let name = ColumnName::parse(column);
            let is_certain = name.rest.is_empty() || self.cells.is_typed_time(at);
            match name.meaning {
                Some(Meaning::Time) if is_certain => clocks.push((at, name.unit.is_some())),
                Some(Meaning::Time) => unclear.push((column, name)),
                Some(Meaning::Field(_)) | None => {}
            }
        }
        if clocks.iter().any(|(_, has_unit)| *has_unit) {
            clocks.retain(|(_, has_unit)| *has_unit);
        }
        match (&clocks[..], &unclear[..]) {
            ([(at, _)], _) => self.column_at(*at, &self.columns[*at], Dimension::Time),
            ([], [(column, name), ..]) => Err(self.not_understood(column, name)),
            ([], []) => {
                let problem = sentence!("no column of times; there {}", listed(&self.columns));
                Err(self.error(problem).with_remedy(sentence!(
                    "name it with {}, or add one: the number of the frame divided by the frame rate",
                    Piece::argument("time")
                )))
            }
            (several, _) => {
                let names: Vec<&str> = several.iter().map(|(at, _)| &*self.columns[*at]).collect();
                let problem =
                    sentence!("several columns are named like times: {}", names.join(", "));
                Err(self.error(problem).with_remedy(sentence!(
                    "choose one, e.g. {}",
                    Piece::argument_with("time", names[0])
                )))
            }
        }
    }

    /// The columns that are named like fields.
    fn named_signals(&self) -> Result<Vec<SignalSpec>, DataError> {
        let mut specs: Vec<SignalSpec> = Vec::new();
        for column in &self.columns {
            let name = ColumnName::parse(column);
            let Some(Meaning::Field(field)) = name.meaning else {
                continue;
            };
            if !name.rest.is_empty() {
                return Err(self.not_understood(column, &name));
            }
            if let Some(other) = specs.iter().find(|spec| spec.field == field) {
                let example = format!("{field}={}", other.source);
                let problem = sentence!(
                    "the columns {} and {} both measure {}",
                    &other.source,
                    column,
                    field.to_string()
                );
                return Err(self.error(problem).with_remedy(choose(example)));
            }
            specs.push(SignalSpec::new(field, column, SigmaSpec::Estimate));
        }
        if specs.is_empty() {
            let example = self.columns.last().map_or("COLUMN", String::as_str);
            let problem = sentence!(
                "no column is named like a field of the top; there {}",
                listed(&self.columns)
            );
            return Err(self
                .error(problem)
                .with_remedy(choose(format!("theta={example}"))));
        }
        Ok(specs)
    }

    /// The error of a column whose name has a known word and others.
    fn not_understood(&self, column: &str, name: &ColumnName) -> DataError {
        let (meaning, remedy) = match name.meaning {
            Some(Meaning::Field(field)) => {
                let example = format!("{}={column}", field.path());
                (field.to_string(), choose(example))
            }
            Some(Meaning::Time) | None => {
                let example = Piece::argument_with("time", column);
                ("times".to_owned(), sentence!("name the times: {}", example))
            }
        };
        let problem = sentence!(
            "the name says {}, but “{}” is not understood (units: deg, rad, s, ms, rad/s, rpm …)",
            meaning,
            name.rest.join(" ")
        );
        self.error(problem).in_column(column).with_remedy(remedy)
    }

    /// The error of the file.
    fn error(&self, problem: impl Into<Sentence>) -> DataError {
        DataError::new(problem).in_file(self.path)
    }
}

/// What helps where columns are not found by their names: to name all that are wanted.
fn choose(example: String) -> Sentence {
    sentence!(
        "name the columns to read, e.g. {}",
        Piece::argument_with("signal", example)
    )
}

/// The decimal marks of a text table.
struct Marks {
    /// The one that is declared, or that a number has.
    known: Option<Decimal>,
    /// Whether commas separate the cells.
    has_commas: bool,
}

impl Marks {
    fn new(cells: &Cells, declared: Option<Decimal>) -> Self {
        Self {
            known: declared,
            has_commas: match cells {
                Cells::Text { delimiter, .. } => *delimiter == Delimiter::Comma,
                #[cfg(feature = "sweep")]
                Cells::Numbers { .. } => false,
            },
        }
    }

    /// Refuses another mark than that of the other numbers.
    fn check(&mut self, mark: Option<Decimal>) -> Result<(), Sentence> {
        let declare = |decimal: &'static str| Piece::argument_with("decimal", decimal);
        match (mark, self.known) {
            (None, _) => Ok(()),
            (Some(Decimal::Comma), None) if self.has_commas => Err(sentence!(
                "commas separate the cells, so they are no decimal marks; if they are, {}",
                declare(",")
            )),
            (Some(mark), None) => {
                self.known = Some(mark);
                Ok(())
            }
            (Some(mark), Some(known)) if mark == known => Ok(()),
            (Some(_), Some(_)) => Err(sentence!(
                "points and commas are not both decimal marks; write numbers without separators of thousands, or declare {} or {}",
                declare("."),
                declare(",")
            )),
        }
    }
}

/// Names with their verb: "are: t, theta".
pub(super) fn listed(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{verb}: {}", names.join(", "))
}

/// The error of a column, or topic and path, that would count twice.
pub(super) fn read_twice(source: &str) -> DataError {
    DataError::new(sentence!(
        "{} is read twice as a signal: each value may count only once",
        source.to_owned()
    ))
}

/// Whether a column is needed for these signals.
#[cfg(feature = "sweep")]
pub(super) fn is_needed(header: &str, specs: &[SignalSpec], layout: &Layout) -> bool {
    let name = ColumnName::parse(header);
    let is_called = |given: &str| header == given || name.is_called(&ColumnName::parse(given));
    let is_clock = match &layout.time {
        Some(time) => is_called(time),
        None => name.meaning == Some(Meaning::Time),
    };
    let is_named = specs.is_empty() && name.meaning.is_some();
    let is_source = |spec: &SignalSpec| {
        let is_sigma = matches!(&spec.sigma, SigmaSpec::Column(sigma) if is_called(sigma));
        is_sigma || spec.resolved(is_called).is_some()
    };
    is_clock || is_named || specs.iter().any(is_source)
}
