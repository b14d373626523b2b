//! Tables of measured values as text: CSV as video trackers, phones, loggers and spreadsheets write it.

use super::error::DataError;
use super::signal::{Row, SigmaSpec, Signal, SignalSpec};
use super::unit::{Dimension, is_unit, split_header};
use crate::archive::input::read_file;
use std::path::Path;

/// Maximum number of rows of a table (held in memory).
pub(super) const MAX_ROWS: usize = 2_000_000;

/// Maximum size of a text file (held in memory), bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Texts that stand for a missing value, in lower case.
const MISSING: &[&str] = &["", "nan", "na", "n/a", "#n/a", "null", "none", "-", "--"];

/// A table of cells with a header.
struct Table<'a> {
    path: &'a Path,
    columns: Vec<String>,
    /// Cells of each row, and the line in the file.
    rows: Vec<(u64, csv::StringRecord)>,
    has_decimal_comma: bool,
}

/// Reads the signals of a text file. Without `specs`, these are the columns that are named like fields.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<Vec<Signal>, DataError> {
    // A file that can't be examined can't be read either, and is reported below.
    if std::fs::metadata(path).is_ok_and(|file| file.len() > MAX_BYTES) {
        return Err(DataError::TooLarge {
            path: path.to_owned(),
            limit: MAX_BYTES,
        });
    }
    let text = read_file(path).map_err(|reason| DataError::Io {
        path: path.to_owned(),
        reason,
    })?;
    let table = Table::parse(path, text.trim_start_matches('\u{feff}'))?;
    let clock = table.time_column(time)?;
    let named: Vec<SignalSpec> = if specs.is_empty() {
        table.named_signals()
    } else {
        let exists = |spec: &&SignalSpec| table.position(&spec.source).is_some();
        specs.iter().filter(exists).cloned().collect()
    };
    match (named.is_empty(), specs.first()) {
        (false, _) => {}
        (true, Some(spec)) => return Err(table.missing(&spec.source)),
        (true, None) => {
            return Err(DataError::NoSignals {
                path: path.to_owned(),
                columns: table.columns,
            });
        }
    }
    table.check_duplicates(&named, specs.is_empty())?;
    let signals = named.iter().map(|spec| table.signal(spec, clock, file));
    signals.collect()
}

impl<'a> Table<'a> {
    fn parse(path: &'a Path, text: &str) -> Result<Self, DataError> {
        let delimiter = delimiter(text);
        let has_decimal_comma = delimiter != b',' && has_decimal_comma(text);
        let mut reader = csv::ReaderBuilder::new()
            .delimiter(delimiter)
            .has_headers(false)
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes());
        let mut table = Self {
            path,
            columns: Vec::new(),
            rows: Vec::new(),
            has_decimal_comma,
        };
        // The last two lines of text before the first row of numbers.
        let mut titles = [csv::StringRecord::new(), csv::StringRecord::new()];
        for record in reader.records() {
            let record = record.map_err(|error| DataError::Io {
                path: path.to_owned(),
                reason: error.into(),
            })?;
            let line = record.position().map_or(0, csv::Position::line);
            if is_comment(&record) {
                continue;
            }
            if table.rows.is_empty() && !table.is_numeric(&record) {
                titles = [std::mem::take(&mut titles[1]), record];
                continue;
            }
            if table.rows.len() == MAX_ROWS {
                return Err(DataError::TooLong {
                    path: path.to_owned(),
                    limit: MAX_ROWS,
                });
            }
            table.rows.push((line, record));
        }
        let Some((_, first)) = table.rows.first() else {
            return Err(DataError::Empty {
                path: path.to_owned(),
            });
        };
        table.columns = headers(&titles, first.len());
        Ok(table)
    }

    /// Whether the cells are numbers, at least one of them present.
    fn is_numeric(&self, record: &csv::StringRecord) -> bool {
        let mut has_number = false;
        for cell in record {
            match self.number(cell) {
                Some(_) => has_number = true,
                None if is_missing(cell) => {}
                None => return false,
            }
        }
        has_number
    }

    /// The number in a cell.
    fn number(&self, cell: &str) -> Option<f64> {
        let number = if self.has_decimal_comma {
            cell.replace(',', ".").parse::<f64>()
        } else {
            cell.parse()
        };
        number.ok().filter(|number| number.is_finite())
    }

    fn position(&self, name: &str) -> Option<usize> {
        let exact = self.columns.iter().position(|column| column == name);
        exact.or_else(|| {
            let mut columns = self.columns.iter();
            columns.position(|column| split_header(column).0 == name)
        })
    }

    /// Refuses columns that would count twice, and names that stand for several columns.
    fn check_duplicates(
        &self,
        specs: &[SignalSpec],
        is_found_by_name: bool,
    ) -> Result<(), DataError> {
        for (at, spec) in specs.iter().enumerate() {
            if self.is_ambiguous(&spec.source) {
                return Err(DataError::Ambiguous {
                    path: self.path.to_owned(),
                    name: spec.source.clone(),
                });
            }
            for other in &specs[..at] {
                if self.position(&other.source) == self.position(&spec.source) {
                    return Err(DataError::Duplicate {
                        path: self.path.to_owned(),
                        source_name: spec.source.clone(),
                    });
                }
                if is_found_by_name && other.field == spec.field {
                    return Err(DataError::SameField {
                        path: self.path.to_owned(),
                        field: spec.field.to_string(),
                        columns: [other.source.clone(), spec.source.clone()],
                    });
                }
            }
        }
        Ok(())
    }

    /// Whether several columns have this name, with their units or without.
    fn is_ambiguous(&self, name: &str) -> bool {
        let exact = self.columns.iter().filter(|column| *column == name).count();
        let names = self.columns.iter().map(|column| split_header(column).0);
        exact > 1 || exact == 0 && names.filter(|column| *column == name).count() > 1
    }

    fn missing(&self, name: &str) -> DataError {
        DataError::Missing {
            path: self.path.to_owned(),
            what: "column",
            name: name.to_owned(),
            known: self.columns.clone(),
        }
    }

    /// The column of times.
    fn time_column(&self, name: Option<&str>) -> Result<usize, DataError> {
        if let Some(name) = name {
            return self.position(name).ok_or_else(|| self.missing(name));
        }
        let mut columns = self.columns.iter();
        let found = columns.position(|column| {
            let (name, _) = split_header(column);
            ["t", "time", "timestamp", "zeit", "seconds"].contains(&&*name.to_lowercase())
        });
        found.ok_or_else(|| self.missing("of times (name it with --time)"))
    }

    /// The columns that are named like fields.
    fn named_signals(&self) -> Vec<SignalSpec> {
        let columns = self.columns.iter();
        let spec = |column: &String| SignalSpec::from_column(column, split_header(column).0);
        columns.filter_map(spec).collect()
    }

    fn signal(&self, spec: &SignalSpec, clock: usize, file: usize) -> Result<Signal, DataError> {
        let dimension = Dimension::from_si(spec.field.unit());
        let time = self.cells(clock, Dimension::Time)?;
        let at = self.position(&spec.source);
        let at = at.ok_or_else(|| self.missing(&spec.source))?;
        let value = self.cells(at, dimension)?;
        let sigma = match &spec.sigma {
            SigmaSpec::Estimate | SigmaSpec::Number(..) => None,
            SigmaSpec::Column(name) => {
                let at = self.position(name).ok_or_else(|| self.missing(name))?;
                Some(self.cells(at, dimension)?)
            }
        };
        let (mut rows, mut missing) = (Vec::new(), 0);
        for (line, record) in &self.rows {
            let cells = [Some(&time), Some(&value), sigma.as_ref()];
            let [time, value, sigma] = [
                self.cell(cells[0], record, *line)?,
                self.cell(cells[1], record, *line)?,
                self.cell(cells[2], record, *line)?,
            ];
            if let (Some(cells), Some(value)) = (cells[2], sigma)
                && value <= 0.0
            {
                return Err(DataError::Sigma {
                    path: self.path.to_owned(),
                    line: *line,
                    column: cells.name.to_owned(),
                    value,
                });
            }
            match (time, value) {
                (Some(time), Some(value)) if cells[2].is_none() || sigma.is_some() => {
                    rows.push(Row { time, value, sigma });
                }
                (Some(_) | None, Some(_) | None) => missing += 1,
            }
        }
        if rows.is_empty() {
            return Err(DataError::NoValues {
                path: self.path.to_owned(),
                column: spec.source.clone(),
            });
        }
        Signal::new(spec, file, rows, missing)
    }

    /// A column in SI units.
    fn cells(&self, at: usize, dimension: Dimension) -> Result<Cells<'_>, DataError> {
        let name = &self.columns[at];
        let factor = dimension.factor(split_header(name).1, name)?;
        Ok(Cells { at, name, factor })
    }

    /// The value of a cell in SI units; `None` if it is missing.
    fn cell(
        &self,
        column: Option<&Cells<'_>>,
        record: &csv::StringRecord,
        line: u64,
    ) -> Result<Option<f64>, DataError> {
        let Some(column) = column else {
            return Ok(None);
        };
        let text = record.get(column.at).unwrap_or_default();
        match self.number(text) {
            Some(number) => Ok(Some(number * column.factor)),
            None if is_missing(text) => Ok(None),
            None => Err(DataError::NotANumber {
                path: self.path.to_owned(),
                line,
                column: column.name.to_owned(),
                text: text.chars().take(40).collect(),
            }),
        }
    }
}

/// A column: index, name, and size of its unit.
struct Cells<'a> {
    at: usize,
    name: &'a str,
    factor: f64,
}

/// The names of the columns from the lines before the numbers: header, or header and units.
fn headers(titles: &[csv::StringRecord; 2], width: usize) -> Vec<String> {
    let [before, last] = titles;
    let is_unit_row = before.len() == last.len()
        && last.iter().any(is_unit)
        && last.iter().all(|cell| cell.is_empty() || is_unit(cell));
    let mut names = Vec::new();
    for at in 0..width.max(last.len()) {
        let name = match (is_unit_row, last.get(at).unwrap_or_default()) {
            (true, "") => before.get(at).unwrap_or_default().to_owned(),
            (true, unit) => format!("{} ({unit})", before.get(at).unwrap_or_default()),
            (false, name) => name.to_owned(),
        };
        if name.is_empty() {
            names.push((at + 1).to_string());
        } else {
            names.push(name);
        }
    }
    names
}

fn is_missing(cell: &str) -> bool {
    MISSING.contains(&&*cell.to_lowercase())
}

fn is_comment(record: &csv::StringRecord) -> bool {
    let first = record.get(0).unwrap_or_default();
    first.starts_with(['#', '%']) && !is_missing(first) || record.iter().all(str::is_empty)
}

/// The delimiter of the first lines: tab or semicolon if they have any, else comma.
fn delimiter(text: &str) -> u8 {
    let mut lines = beginning(text);
    if lines.clone().any(|line| line.contains('\t')) {
        b'\t'
    } else if lines.any(|line| line.contains(';')) {
        b';'
    } else {
        b','
    }
}

/// Whether numbers are written with a comma.
fn has_decimal_comma(text: &str) -> bool {
    let is_digit = |c: Option<&u8>| c.is_some_and(u8::is_ascii_digit);
    beginning(text).any(|line| {
        let bytes = line.as_bytes();
        let mut commas = line.match_indices(',').map(|(at, _)| at);
        commas.any(|at| at > 0 && is_digit(bytes.get(at - 1)) && is_digit(bytes.get(at + 1)))
    })
}

/// The first lines that are not comments.
fn beginning(text: &str) -> impl Iterator<Item = &str> + Clone {
    let lines = text.lines().filter(|line| !line.starts_with(['#', '%']));
    lines.take(20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::{pose, state};
    use std::io::Write as _;

    fn read_text(text: &str, specs: &[&str]) -> Result<Vec<Signal>, DataError> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let specs: Result<Vec<_>, _> = specs.iter().map(|text| SignalSpec::parse(text)).collect();
        read(file.path(), 0, &specs?, None)
    }

    #[test]
    fn reads_the_dialects_of_common_programs() {
        for (name, text) in [
            ("plain", "t,theta\n0,0.5\n0.1,0.25\n"),
            (
                "byte order mark",
                "\u{feff}t,theta\r\n0,0.5\r\n0.1,0.25\r\n",
            ),
            ("Tracker", "mass_A\nt,θ\n0.0,5.0E-1\n1.0E-1,2.5E-1\n"),
            ("German", "Zeit (s);Tilt (rad)\n0,0;0,5\n0,1;0,25\n"),
            (
                "phyphox",
                "\"Time (s)\"\t\"Theta (mrad)\"\n0\t500\n0.1\t250\n",
            ),
            ("units below", "Time,Theta\nms,mrad\n0,500\n100,250\n"),
            (
                "comments",
                "# made by hand\nt, theta\n# start\n0, 0.5\n\n0.1, 0.25\n",
            ),
        ] {
            let [signal] = &read_text(text, &[]).unwrap()[..] else {
                panic!("{name}: not one signal");
            };
            assert_eq!(signal.field, state::THETA, "{name}");
            assert_eq!(signal.times, [0.0, 0.1], "{name}");
            assert_eq!(signal.values, [0.5, 0.25], "{name}");
        }
    }

    #[test]
    fn sorts_rows_and_counts_missing_values() {
        let text = "t,theta,Gyroscope z (rpm)\n0.2,1,60\n0,,60\n0.1,3,NaN\n";
        let [theta, gyro] = &read_text(text, &[]).unwrap()[..] else {
            panic!("not two signals");
        };
        assert_eq!(
            (&theta.times[..], &theta.values[..]),
            (&[0.1, 0.2][..], &[3.0, 1.0][..])
        );
        assert_eq!((theta.missing, theta.out_of_order), (1, 1));
        assert_eq!(gyro.field, pose::OMEGA_BODY.z());
        assert!((gyro.values[0] - std::f64::consts::TAU).abs() < 1e-12);
        assert_eq!(gyro.missing, 1);
    }

    #[test]
    fn names_file_line_and_column_of_errors() {
        for (text, signal, expected) in [
            (
                "t,theta\n0,0.5\n1,abc\n",
                "theta",
                ":3: column theta: \"abc\" is not a number",
            ),
            ("t,x\n0,0.5\n", "theta", "no column theta; there are: t, x"),
            (
                "a,theta\n0,0.5\n",
                "theta",
                "no column of times (name it with --time)",
            ),
            (
                "t,theta (rpm)\n0,0.5\n",
                "theta",
                "\"rpm\" is not a unit of angle",
            ),
            (
                "t,theta,sd\n0,0.5,1\n1,1,0\n",
                "theta:sd",
                ":3: column sd: the standard deviation 0 is not",
            ),
            ("", "theta", "no rows of numbers"),
            ("t,theta\n", "theta", "no rows of numbers"),
            ("t,theta\n0,\n1,\n", "theta", "column theta has no values"),
        ] {
            let error = read_text(text, &[signal]).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        let error = read_text("t,x\n0,1\n", &[]).unwrap_err().to_string();
        assert!(error.contains("--signal theta=x"), "{error}");
    }
}
