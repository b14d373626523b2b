//! Text tables: CSV as video trackers, phones, loggers and spreadsheets write it.

use super::cell::{Cell, Mark, Marks};
use super::delimiter::{Delimiter, is_blank, is_comment};
use super::error::DataError;
use super::header::{self, TableHeader, is_row_name};
use super::signal::{FileSignals, SignalSpec};
use super::table::{Line, MAX_ROWS, Table, TableRows, too_long};
use crate::archive::input::{read_file, text_of};
use crate::words::{Piece, sentence};
use csv::StringRecord;
use std::path::Path;

/// Maximum size of a text file (held in memory), bytes.
const MAX_BYTES: u64 = 256 << 20;

/// Reads the signals of a text file.
pub(super) fn read(
    path: &Path,
    file: usize,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<FileSignals, DataError> {
    // A file that can't be examined can't be read either, and is reported below.
    let size = std::fs::metadata(path).map_or(0, |file| file.len());
    check_size(path, size)?;
    let text = read_file(path).map_err(|reason| DataError::unreadable(path, reason))?;
    parse(path, &text, time)?.signals(file, specs, time)
}

fn check_size(path: &Path, bytes: u64) -> Result<(), DataError> {
    if bytes > MAX_BYTES {
        let limit = (MAX_BYTES >> 20).to_string();
        let problem = sentence!("larger than {} MB: thin out the data", limit);
        return Err(DataError::new(problem).in_file(path));
    }
    Ok(())
}

/// Reads the signals of the only file of a fit, whose content is in memory.
pub(super) fn read_bytes(
    path: &Path,
    bytes: Vec<u8>,
    specs: &[SignalSpec],
) -> Result<FileSignals, DataError> {
    check_size(path, bytes.len() as u64)?;
    let text = text_of(bytes).map_err(|reason| DataError::unreadable(path, reason))?;
    let table = Table {
        // Those who have the content, and no file, have no arguments for its columns either.
        has_arguments: false,
        ..parse(path, &text, None)?
    };
    table.signals(0, specs, None)
}

/// Parses a table: its header, and the rows below it.
fn parse<'a>(path: &'a Path, text: &str, time: Option<&str>) -> Result<Table<'a>, DataError> {
    let text = text.trim_start_matches('\u{feff}');
    let delimiter = Delimiter::find(text);
    let header = header::find(text, delimiter, time);
    let TableHeader {
        names,
        first_row,
        has_row_names,
    } = header.map_err(|error| unreadable(path, error))?;
    let mut lines: Vec<Line> = Vec::new();
    let mut marks: Vec<Marks> = Vec::new();
    let mut width = names.len();
    for read in delimiter.records(text).skip(first_row) {
        let record = read.map_err(|error| unreadable(path, error))?;
        if is_comment(&record) || is_blank(&record) {
            continue;
        }
        if lines.len() == MAX_ROWS {
            return Err(too_long().in_file(path));
        }
        let number = line_of(&record);
        if width == 0 {
            width = record.len();
        }
        // A row without a name shows that the first one had a cell too many.
        if has_row_names && !is_row_name(&record) {
            return Err(wrong_width(&record, width - 1).in_file(path));
        }
        // Where spaces separate cells, a missing one can't be seen.
        let has_lost_cells = delimiter == Delimiter::Blanks && record.len() < width;
        if has_lost_cells || record.iter().skip(width).any(|cell| !cell.is_empty()) {
            let error = wrong_width(&record, width).in_file(path);
            return Err(match delimiter {
                Delimiter::Comma => error.with_remedy(sentence!(
                    "if numbers have decimal commas, separate the columns with semicolons or tabs"
                )),
                _ => error,
            });
        }
        marks.resize(width, Marks::default());
        for (marks, cell) in marks.iter_mut().zip(&record) {
            marks.add(Cell::parse(cell));
        }
        lines.push(Line { number, record });
    }
    if lines.is_empty() {
        return Err(DataError::new("no rows of numbers").in_file(path));
    }
    let unnamed = names.len() + 1..=width;
    Ok(Table {
        path,
        is_named: !names.is_empty(),
        has_arguments: true,
        columns: names
            .into_iter()
            .chain(unnamed.map(|number| number.to_string()))
            .collect(),
        rows: TableRows::Text {
            lines,
            marks: decimal_marks(&marks, delimiter),
        },
    })
}

fn unreadable(path: &Path, error: csv::Error) -> DataError {
    DataError::unreadable(path, error.into())
}

/// The error of a row with another number of cells than there are columns.
fn wrong_width(record: &StringRecord, columns: usize) -> DataError {
    let problem = sentence!(
        "{}, but {}",
        Piece::count(record.len() as u64, "cell"),
        Piece::count(columns as u64, "column")
    );
    DataError::new(problem).in_line(line_of(record))
}

/// The line of a record in the file, from 1.
fn line_of(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

/// The decimal mark of each column: that which its own numbers prove, or else the one that all of them have unless the
/// table proves another, or else that of the table.
fn decimal_marks(columns: &[Marks], delimiter: Delimiter) -> Vec<Option<Mark>> {
    let mut table = Marks::default();
    for marks in columns {
        table = table.union(*marks);
    }
    // Whoever separates columns with commas hardly writes them into numbers, which need quotes then.
    table.has_point |= delimiter == Delimiter::Comma && !table.has_comma;
    let mut decimal = Vec::new();
    for marks in columns {
        let uniform = marks.uniform().filter(|mark| {
            let proved = table.single();
            proved.is_none() || proved == Some(*mark)
        });
        decimal.push(if marks.are_proved() {
            marks.single()
        } else {
            uniform.or(table.single())
        });
    }
    decimal
}

#[cfg(test)]
mod tests {
    use super::super::data;
    use super::super::signal::Signal;
    use super::*;
    use crate::telemetry::fields::{pose, state};
    use std::io::Write as _;

    fn signals_of(text: &str, specs: &[&str]) -> Result<Vec<Signal>, DataError> {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        file.write_all(text.as_bytes()).unwrap();
        let specs: Result<Vec<_>, _> = specs.iter().map(|text| SignalSpec::parse(text)).collect();
        let data = data::read(&[file.path().to_owned()], &specs?, None)?;
        Ok(data.signals)
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
            (
                "NumPy",
                "# t,theta\n0.000e+00,5.000e-01\n1.000e-01,2.500e-01\n",
            ),
            (
                "units in brackets",
                "Time,Theta\n(s),[mrad]\n0,500\n0.1,250\n",
            ),
            ("a column of text", "t,theta,state\n0,0.5,ok\n0.1,0.25,ok\n"),
            (
                "a text and an error in the first row",
                "t,theta,note,rate\n0,0.5,released,#DIV/0!\n0.1,0.25,,1\n",
            ),
            ("typographic minus", "t,theta,x\n0,0.5,−1\n1e−1,0.25,−2\n"),
            (
                "decimal commas in quotes",
                "t,theta\n\"0,000\",\"0,500\"\n\"0,100\",\"0,250\"\n",
            ),
            (
                "NumPy, spaces",
                "# t theta\n0.000e+00 5.000e-01\n1.000e-01 2.500e-01\n",
            ),
            (
                "fixed width",
                "   t     theta\n 0.0     0.500\n 0.1     0.250\n",
            ),
            ("spaces, decimal commas", "t theta\n0,0 0,5\n0,1 0,25\n"),
            ("spaces, units", "t(ms) tilt_mrad\n0 500\n100 250\n"),
            (
                "spaces, units in words of their own",
                "Time (ms) Tilt (mrad)\n0 500\n100 250\n",
            ),
            (
                "Vernier",
                "Latest: Time (s),Latest: Theta (rad)\n0,0.5\n0.1,0.25\n",
            ),
            ("colons after names", "t:,theta:\n0,0.5\n0.1,0.25\n"),
            (
                "a temperature before the times",
                "T,t,theta\n20,0,0.5\n21,0.1,0.25\n",
            ),
            (
                "another clock before the times",
                "t (frames),Time (s),theta\n1,0,0.5\n2,0.1,0.25\n",
            ),
            (
                "apostrophes between thousands",
                "t;theta (mrad)\n0;500\n0,1;250\n1'234,5;0\n",
            ),
            (
                "narrow spaces between thousands",
                "t\ttheta (mrad)\n0\t500\n0.1\t250\n1\u{202f}234.5\t0\n",
            ),
        ] {
            let [signal] = &signals_of(text, &[]).unwrap()[..] else {
                panic!("{name}: not one signal");
            };
            assert_eq!(signal.field, state::THETA, "{name}");
            // Some have a third row.
            assert_eq!(signal.times[..2], [0.0, 0.1], "{name}");
            assert_eq!(signal.values[..2], [0.5, 0.25], "{name}");
            assert_eq!(signal.times.get(2).unwrap_or(&1234.5), &1234.5, "{name}");
        }
    }

    #[test]
    fn reads_decimals_that_look_like_thousands() {
        for (name, text, times) in [
            (
                "proved by another row",
                "t\ttheta\n0.900\t0.5\n1.000\t0.5\n",
                [0.9, 1.0],
            ),
            (
                "proved by another column",
                "t;theta\n1,000;0,5\n2,000;0,5\n",
                [1.0, 2.0],
            ),
            (
                "proved by the delimiter",
                "t,theta\n1.000,2.000\n2.000,2.000\n",
                [1.0, 2.0],
            ),
            (
                "three decimals in all rows",
                "t\ttheta\n10.000\t29.241\n10.010\t29.250\n",
                [10.0, 10.01],
            ),
            (
                "three decimals after commas in all rows",
                "t;theta\n10,000;29,241\n10,010;29,250\n",
                [10.0, 10.01],
            ),
        ] {
            let signals = signals_of(text, &[]).unwrap();
            assert_eq!(signals[0].times, times, "{name}");
        }
    }

    #[test]
    fn finds_columns_by_names_in_another_case_or_with_colons() {
        for (name, text, signal) in [
            ("another case", "Time,Theta\n0,0.5\n", "theta:1mrad"),
            ("another case, unit", "t,Theta (rad)\n0,0.5\n", "theta"),
            (
                "a unit added",
                "t,Tilt\n0,500\n",
                "theta=\"tilt (mrad)\":2mrad",
            ),
            (
                "a colon, no deviation",
                "t,Latest: Angle (rad)\n0,0.5\n",
                "theta=Latest: Angle (rad)",
            ),
            (
                "a colon and a deviation",
                "t,Latest: Angle (rad)\n0,0.5\n",
                "theta=Latest: Angle (rad):1mrad",
            ),
            (
                "a colon and a number",
                "t,Run:1,Run\n0,0.5,7\n",
                "theta=Run:1",
            ),
            (
                "exact before another case",
                "t,THETA,theta\n0,7,0.5\n",
                "theta",
            ),
        ] {
            let signals = signals_of(text, &[signal]).unwrap();
            assert_eq!(signals[0].values, [0.5], "{name}");
        }
    }

    #[test]
    fn sorts_rows_and_counts_missing_values() {
        let text = "t,theta,Gyroscope z (rpm)\n0.2,1,60\n0,,60\n0.1,3,NaN\n";
        let [theta, gyro] = &signals_of(text, &[]).unwrap()[..] else {
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
    fn refuses_separators_of_thousands_that_may_be_decimal_marks() {
        for (text, signal, expected) in [
            (
                "t;theta\n0;0,5\n1.000;0,5\n",
                "theta",
                ":3: column t: \"1.000\" can be 1 or 1000: write",
            ),
            (
                "t\ttheta\n0\t0.5\n1,000\t0.5\n",
                "theta",
                ":3: column t: \"1,000\" can be 1 or 1000: write",
            ),
            (
                "t,theta\n0,0.5\n\"1,000\",0.5\n",
                "theta",
                ":3: column t: \"1,000\" can be 1 or 1000: write",
            ),
            (
                "t;theta\n0;0,5\n\"1.234,5\";0,5\n",
                "theta",
                ":3: column t: \"1.234,5\" has separators of thousands",
            ),
        ] {
            let error = signals_of(text, &[signal]).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
    }

    #[test]
    fn names_file_line_and_column_of_errors() {
        for (text, signal, expected) in [
            (
                "t,theta\n0,0.5\n1,abc\n",
                "theta",
                ":3: column theta: \"abc\" is not a number",
            ),
            (
                "t,x\n0,0.5\n",
                "theta",
                "no column or topic theta; there are: t, x",
            ),
            (
                "a,theta\n0,0.5\n",
                "theta",
                "no column of times; there are: a, theta",
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
            (
                "t,theta\n0,0,0,5\n",
                "theta",
                ":2: 4 cells, but 2 columns; if numbers have decimal commas",
            ),
            (
                "t;theta\n0;0,5\n1;0,5;7\n",
                "theta",
                ":3: 3 cells, but 2 columns",
            ),
            (
                "t,theta\n0,abc\n1,0.5 rad\n",
                "theta",
                ":2: column theta: \"abc\" is not a number",
            ),
            (
                "t,theta\n0,#DIV/0!\n1,0.5\n",
                "theta",
                ":2: column theta: \"#DIV/0!\" is not a number",
            ),
            (
                "t,theta\n0,0.5\n#REF!,0.5\n",
                "theta",
                ":3: column t: \"#REF!\" is not a number",
            ),
            (
                "t,Theta\n0,0.5\n",
                "theta=thetta",
                "no column or topic thetta; there are: t, Theta (did you mean Theta?)",
            ),
            (
                "t,theta (rpm)\n0,0.5\n",
                "theta",
                ": column theta (rpm): \"rpm\" is not",
            ),
            ("t theta\n0 0.5\n1\n", "theta", ":3: 1 cell, but 2 columns"),
            (
                "t theta\n0 0.5 1\n0.1 0.4 1\n",
                "theta",
                ":3: 3 cells, but 2 columns",
            ),
            ("0,0.5\n1,0.5\n", "theta", "no line names the 2 columns"),
            (
                "Run 1: Time (s),Run 2: Time (s),theta\n0,0,0.5\n",
                "theta",
                "several columns are named like times: Run 1: Time (s), Run 2: Time (s)",
            ),
            (
                "# Time, place: Monday\nMoment (s),theta\n0,0.5\n",
                "theta",
                "no column of times; there are: Moment (s), theta",
            ),
            ("", "theta", "no rows of numbers"),
            ("t,theta\n", "theta", "no rows of numbers"),
            ("t,theta\n0,\n1,\n", "theta", "column theta has no values"),
        ] {
            let error = signals_of(text, &[signal]).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        let error = signals_of("t,x\n0,1\n", &[]).unwrap_err().to_string();
        assert!(
            error.contains("named like a field of the top; there are: t, x"),
            "{error}"
        );
    }
}
