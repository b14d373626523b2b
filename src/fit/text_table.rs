//! Text tables: CSV as video trackers, phones, loggers and spreadsheets write it.

use super::cell::{is_missing, parse_number};
use super::data_error::DataError;
use super::signal::{FileSignals, SignalSpec};
use super::table::{Line, MAX_ROWS, MAX_SHOWN, Rows, Table};
use super::unit::is_unit;
use crate::archive::input::{read_file, text_of};
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
    let text = read_file(path).map_err(|reason| DataError::Io {
        path: path.to_owned(),
        reason,
    })?;
    read_text(path, &text, file, specs, time)
}

fn check_size(path: &Path, bytes: u64) -> Result<(), DataError> {
    if bytes > MAX_BYTES {
        return Err(DataError::TooLarge {
            path: path.to_owned(),
            limit: MAX_BYTES,
        });
    }
    Ok(())
}

/// Reads the signals of the text of a file.
fn read_text(
    path: &Path,
    text: &str,
    file: usize,
    specs: &[SignalSpec],
    time: Option<&str>,
) -> Result<FileSignals, DataError> {
    parse(path, text.trim_start_matches('\u{feff}'))?.signals(file, specs, time)
}

/// Reads the signals of the only file of a fit, whose content is in memory.
pub(super) fn read_bytes(
    path: &Path,
    bytes: Vec<u8>,
    specs: &[SignalSpec],
) -> Result<FileSignals, DataError> {
    check_size(path, bytes.len() as u64)?;
    let text = text_of(bytes).map_err(|reason| DataError::Io {
        path: path.to_owned(),
        reason,
    })?;
    read_text(path, &text, 0, specs, None)
}

/// Parses a table: lines before the first row of numbers are its header.
fn parse<'a>(path: &'a Path, text: &str) -> Result<Table<'a>, DataError> {
    let delimiter = delimiter(text);
    // Where commas separate columns, they can't also be in numbers.
    let has_decimal_comma = delimiter != b',' && has_decimal_comma(text);
    let mut reader = csv::ReaderBuilder::new()
        .delimiter(delimiter)
        .has_headers(false)
        // Titles and comments have other numbers of cells than the rows.
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(text.as_bytes());
    let mut lines: Vec<Line> = Vec::new();
    // The last two lines of text before the first row of numbers.
    let mut titles = [StringRecord::new(), StringRecord::new()];
    for read in reader.records() {
        let record = read.map_err(|error| DataError::Io {
            path: path.to_owned(),
            reason: error.into(),
        })?;
        if is_comment(&record) {
            continue;
        }
        if lines.is_empty() && !is_numeric(&record, has_decimal_comma) {
            titles = [std::mem::take(&mut titles[1]), record];
            continue;
        }
        if lines.len() == MAX_ROWS {
            return Err(DataError::TooLong {
                path: path.to_owned(),
                limit: MAX_ROWS,
            });
        }
        let number = line_of(&record);
        // A single cell is a title, and names no column.
        let width = match titles[1].len() {
            0 | 1 => lines.first().map_or(record.len(), |line| line.record.len()),
            named => named,
        };
        if record.iter().skip(width).any(|cell| !cell.is_empty()) {
            return Err(DataError::Width {
                path: path.to_owned(),
                line: number,
                cells: record.len(),
                columns: width,
                has_commas: delimiter == b',',
            });
        }
        lines.push(Line { number, record });
    }
    let Some(first) = lines.first() else {
        return Err(DataError::Empty {
            path: path.to_owned(),
            refused: refused_cell(&titles, has_decimal_comma),
        });
    };
    Ok(Table {
        path,
        columns: headers(&titles, first.record.len()),
        rows: Rows::Text {
            lines,
            has_decimal_comma,
        },
    })
}

/// The line of a record in the file, from 1.
fn line_of(record: &StringRecord) -> u64 {
    record.position().map_or(0, csv::Position::line)
}

/// The first cell of the last line that is no number, if a header is before that line.
fn refused_cell(titles: &[StringRecord; 2], has_decimal_comma: bool) -> Option<(u64, String)> {
    let [before, last] = titles;
    if before.is_empty() {
        return None;
    }
    for cell in last {
        if parse_number(cell, has_decimal_comma).is_none() && !is_missing(cell) {
            return Some((line_of(last), cell.chars().take(MAX_SHOWN).collect()));
        }
    }
    None
}

/// Whether the cells are numbers, at least one of them present.
fn is_numeric(record: &StringRecord, has_decimal_comma: bool) -> bool {
    let mut has_number = false;
    for cell in record {
        match parse_number(cell, has_decimal_comma) {
            Some(_) => has_number = true,
            None if is_missing(cell) => {}
            None => return false,
        }
    }
    has_number
}

/// The names of the columns from the lines before the numbers: header, or header and units.
fn headers(titles: &[StringRecord; 2], width: usize) -> Vec<String> {
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

fn is_comment(record: &StringRecord) -> bool {
    // `#N/A` is a missing value.
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
    beginning(text).any(|line| {
        line.as_bytes()
            .windows(3)
            .any(|bytes| bytes[1] == b',' && bytes[0].is_ascii_digit() && bytes[2].is_ascii_digit())
    })
}

/// The first lines that are not comments.
fn beginning(text: &str) -> impl Iterator<Item = &str> + Clone {
    text.lines()
        .filter(|line| !line.starts_with(['#', '%']))
        .take(20)
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
        ] {
            let [signal] = &signals_of(text, &[]).unwrap()[..] else {
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
                "no rows of numbers; line 3: \"0.5 rad\" is not a number",
            ),
            (
                "t,theta (rpm)\n0,0.5\n",
                "theta",
                ": column theta (rpm): \"rpm\" is not",
            ),
            ("", "theta", "no rows of numbers"),
            ("t,theta\n", "theta", "no rows of numbers"),
            ("t,theta\n0,\n1,\n", "theta", "column theta has no values"),
        ] {
            let error = signals_of(text, &[signal]).unwrap_err().to_string();
            assert!(error.contains(expected), "{text:?}: {error}");
        }
        let error = signals_of("t,x\n0,1\n", &[]).unwrap_err().to_string();
        assert!(error.contains("--signal theta=x"), "{error}");
    }
}
