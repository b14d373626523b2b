//! Input tables with the values of each run.

use super::axis::find_key;
use super::cells::{Cells, cells as cells_of, values_of};
use super::error::SweepError;
use super::reader::{self, Opened};
use crate::archive::input::read_file;
use crate::run::scenario::{Key, Value};
use arrow_array::{RecordBatch, new_empty_array};
use arrow_schema::{DataType, Schema};
use serde_json::Value as Json;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Maximum number of rows (held in memory).
const MOST_ROWS: u64 = 10_000_000;

/// A table with a column for each key that varies. Empty cells keep the base's value.
#[derive(Clone, Debug)]
pub struct Table {
    columns: Vec<Column>,
    rows: u64,
    /// The file that it was read from.
    file: Option<PathBuf>,
}

#[derive(Clone, Debug)]
struct Column {
    name: String,
    key: &'static Key,
    cells: Cells,
}

impl Table {
    /// Reads a `.parquet` or a `.csv` file.
    ///
    /// # Errors
    /// [`SweepError::File`] for other file types, or a column that is not a key.
    pub fn read(path: &Path) -> Result<Self, SweepError> {
        let has = |kind| path.extension().is_some_and(|extension| extension == kind);
        let wrong = SweepError::table(path);
        let mut table = if has("parquet") {
            reader::read(path, |opened| from_parquet(opened).map_err(wrong))?
        } else if has("csv") {
            let text = read_file(path).map_err(SweepError::io("read", path))?;
            from_csv(&text).map_err(wrong)?
        } else {
            return Err(wrong("must be a .parquet or a .csv file".to_owned()));
        };
        table.file = Some(path.to_owned());
        Ok(table)
    }

    /// Reads the columns of Arrow batches, which all have this schema. A pandas index is ignored unless it has the
    /// name of a key.
    ///
    /// # Errors
    /// A column that is not a key, or has values that are neither numbers nor words.
    pub fn from_batches(schema: &Schema, batches: &[RecordBatch]) -> Result<Self, String> {
        let rows = batches.iter().map(|batch| batch.num_rows() as u64).sum();
        let mut table = Self::of_schema(schema, rows)?;
        for batch in batches {
            table.add(batch)?;
        }
        Ok(table)
    }

    /// An empty table for a schema and number of rows, validated before any cell is read.
    fn of_schema(schema: &Schema, rows: u64) -> Result<Self, String> {
        check_rows(rows)?;
        let indices = pandas_indices(schema);
        let mut columns = Vec::new();
        for field in schema.fields() {
            let name = field.name().clone();
            let key = match find_key(&name) {
                Err(_) if indices.contains(&name) || is_nameless_index(&name) => continue,
                found => found.map_err(|error| error.to_string())?,
            };
            check_type(key, field.data_type()).map_err(|reason| format!("{name}: {reason}"))?;
            let cells = Vec::new();
            columns.push(Column { name, key, cells });
        }
        Ok(Self {
            columns,
            rows: 0,
            file: None,
        })
    }

    /// Adds the rows of a batch.
    fn add(&mut self, batch: &RecordBatch) -> Result<(), String> {
        self.rows += batch.num_rows() as u64;
        check_rows(self.rows.max(1))?;
        for Column { name, cells, .. } in &mut self.columns {
            if let Some(column) = batch.column_by_name(name) {
                let read = cells_of(column.as_ref());
                cells.extend(read.map_err(|reason| format!("{name}: {reason}"))?);
            }
        }
        Ok(())
    }

    /// The file that it was read from.
    pub(super) fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// The keys that vary.
    pub fn keys(&self) -> Vec<&'static Key> {
        self.columns.iter().map(|column| column.key).collect()
    }

    /// Whether each row has a value for this key, so that none is left to the base.
    pub(super) fn always_has(&self, key: &str) -> bool {
        let mut columns = self.columns.iter();
        columns.any(|column| column.key.path == key && column.cells.iter().all(Option::is_some))
    }

    /// The number of rows.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// The cells of a row.
    pub(super) fn row(&self, row: u64) -> Vec<Option<Value>> {
        let cells = |column: &Column| column.cells[row as usize].clone();
        self.columns.iter().map(cells).collect()
    }

    /// SHA-256 of keys and cells, independent of the file type.
    pub(super) fn digest(&self) -> String {
        let mut hash = Sha256::new();
        hash.update(self.rows.to_le_bytes());
        for Column { key, cells, .. } in &self.columns {
            hash.update(format!("{}\n", key.path));
            for cell in cells {
                match cell {
                    Some(value) => hash.update(format!("{value}\n")),
                    None => hash.update("\n"),
                }
            }
        }
        format!("{:x}", hash.finalize())
    }
}

/// Checks the number of rows.
fn check_rows(rows: u64) -> Result<(), String> {
    match rows {
        0 => Err("there are no rows".to_owned()),
        1..=MOST_ROWS => Ok(()),
        _ => Err(format!("more than {MOST_ROWS} rows: split the table")),
    }
}

/// Checks that a column type suits its key.
fn check_type(key: &Key, of: &DataType) -> Result<(), String> {
    cells_of(&new_empty_array(of))?;
    let of = values_of(of);
    if *of == DataType::Null || of.is_string() == key.kind.is_text() {
        return Ok(());
    }
    let are = if of.is_string() { "words" } else { "numbers" };
    Err(format!("the values are {are}; expected {}", key.kind))
}

fn from_parquet(opened: Opened) -> Result<Table, String> {
    let groups = opened.metadata().row_groups().iter();
    let rows = groups.map(|group| u64::try_from(group.num_rows()).unwrap_or(u64::MAX));
    let rows = rows.fold(0, u64::saturating_add);
    let mut table = Table::of_schema(opened.schema(), rows)?;
    let fields = opened.schema().fields().clone();
    let is_wanted = |name: &String| table.columns.iter().any(|column| column.name == *name);
    let wanted = (0..fields.len()).filter(|at| is_wanted(fields[*at].name()));
    let wanted: Vec<_> = wanted.collect();
    let reader = reader::batches(opened, wanted).map_err(|error| error.to_string())?;
    for batch in reader {
        table.add(&batch.map_err(|error| error.to_string())?)?;
    }
    Ok(table)
}

/// The columns in which pandas has stored its row index.
fn pandas_indices(schema: &Schema) -> Vec<String> {
    let about = schema.metadata().get("pandas");
    let about: Option<Json> = about.and_then(|text| serde_json::from_str(text).ok());
    let indices = about.and_then(|about| about["index_columns"].as_array().cloned());
    let names = indices.into_iter().flatten();
    // A RangeIndex is not a column; it is described by an object.
    names
        .filter_map(|name| name.as_str().map(str::to_owned))
        .collect()
}

/// Whether this is the name of an unnamed pandas index: `__index_level_0__`.
fn is_nameless_index(name: &str) -> bool {
    let level = name.strip_prefix("__index_level_");
    let level = level.and_then(|rest| rest.strip_suffix("__"));
    level.is_some_and(|level| level.parse::<u32>().is_ok())
}

/// Whether a line of a comma-separated table has no cell with content. Editors leave blank lines, and spreadsheets write
/// commas where nothing was entered. An empty cell of a table with one column is written as `""`.
fn is_empty_row(line: &str) -> bool {
    line.split(',').all(|cell| cell.trim().is_empty())
}

/// The lines of a comma-separated table that have content, with their numbers; no cell contains a line break.
fn csv_lines(text: &str) -> Result<Vec<(&str, u64)>, String> {
    let lines = text.split(['\n', '\r']).zip(1..);
    let lines: Vec<_> = lines.filter(|(line, _)| !is_empty_row(line)).collect();
    let is_open = |(line, _): &&(&str, u64)| line.matches('"').count() % 2 == 1;
    if let Some((_, line)) = lines.iter().find(is_open) {
        return Err(format!("line {line}: unclosed quote"));
    }
    Ok(lines)
}

/// Reads a comma-separated table.
fn from_csv(text: &str) -> Result<Table, String> {
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let lines = csv_lines(&text)?;
    let filled: Vec<&str> = lines.iter().map(|(line, _)| *line).collect();
    let filled = filled.join("\n");
    let mut reader = csv::ReaderBuilder::new();
    reader
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All);
    let mut reader = reader.from_reader(filled.as_bytes());
    let mut records = reader
        .records()
        .map(|record| record.map_err(|error| error.to_string()));
    let header = records.next().transpose()?.unwrap_or_default();
    // A column without a name is an index that pandas has written.
    let all = header.iter().enumerate();
    let (indices, named): (Vec<_>, Vec<_>) = all.partition(|(_, name)| name.is_empty());
    let column = |(_, name): &(usize, &str)| {
        let (name, cells) = ((*name).to_owned(), Vec::new());
        let key = find_key(&name).map_err(|error| error.to_string())?;
        Ok(Column { name, key, cells })
    };
    let columns: Result<Vec<_>, String> = named.iter().map(column).collect();
    let mut columns = columns?;
    let mut rows: u64 = 0;
    for (record, (_, line)) in records.zip(lines.into_iter().skip(1)) {
        let record = record?;
        let (count, expected) = (record.len(), header.len());
        if count != expected {
            let cells = if count == 1 { "cell" } else { "cells" };
            return Err(format!(
                "line {line} has {count} {cells}, the header has {expected}"
            ));
        }
        // Spreadsheets may quote the cells in which nothing was entered.
        if expected > 1 && record.iter().all(str::is_empty) {
            continue;
        }
        let mut cells = indices.iter().map(|(at, _)| &record[*at]);
        if let Some(cell) = cells.find(|cell| cell.parse() != Ok(rows)) {
            return Err(format!(
                "line {line}: {cell:?} is in an unnamed column, which must be a row index (0, 1, 2, …): name the column or remove it"
            ));
        }
        for (Column { key, cells, .. }, (at, _)) in columns.iter_mut().zip(&named) {
            let cell = csv_cell(key, &record[*at]);
            cells.push(cell.map_err(|reason| format!("line {line}: {reason}"))?);
        }
        rows += 1;
    }
    check_rows(rows)?;
    Ok(Table {
        columns,
        rows,
        file: None,
    })
}

/// A cell of a CSV file: empty, a word or a number.
fn csv_cell(key: &Key, cell: &str) -> Result<Option<Value>, String> {
    if cell.is_empty() {
        return Ok(None);
    }
    if key.kind.is_text() {
        return Ok(Some(Value::Text(cell.to_owned())));
    }
    let number = cell.parse().map(|number| Some(Value::Number(number)));
    number.map_err(|_| format!("{} = {cell:?} is not a number", key.path))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::io::Write as _;

    fn read(text: impl AsRef<[u8]>) -> Result<Table, String> {
        let mut file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        file.write_all(text.as_ref()).unwrap();
        let path = format!("{}: ", file.path().display());
        Table::read(file.path()).map_err(|error| error.to_string().replace(&path, ""))
    }

    /// Output of `DataFrame.to_csv`.
    #[test]
    fn an_index_of_pandas_in_a_csv_file_is_passed_over() {
        let plain = read("friction_k,initial.phi\n0.1,1\n0.2,\n").unwrap();
        let table = read(",friction_k,initial.phi\n0,0.1,1\n1,0.2,\n").unwrap();
        assert_eq!(table.rows(), 2);
        assert_eq!(table.digest(), plain.digest());
        // An unnamed column that does not count the rows could be meant as values.
        for text in [
            ",friction_k\n0,0.1\n2,0.2\n",
            ",friction_k\n0,0.1\n,0.2\n",
            ",friction_k\n0,0.1\n0.5,0.2\n",
        ] {
            let message = read(text).unwrap_err();
            assert!(message.starts_with("line 3: "), "{message}");
            assert!(message.contains("unnamed column"), "{message}");
        }
    }

    #[test]
    fn skips_empty_rows_of_one_column() {
        for text in [
            "friction_k\n0.1\n\n0.2\n",
            "friction_k\n0.1\n0.2\n\n\n",
            "friction_k\n0.1\n  \n0.2\n ",
            "friction_k\n,\n0.1\n,,,\n0.2\n",
        ] {
            let table = read(text).unwrap();
            let plain = read("friction_k\n0.1\n0.2\n").unwrap();
            assert_eq!(
                (table.rows(), table.digest()),
                (2, plain.digest()),
                "{text:?}"
            );
        }
        // A missing value of pandas.
        assert_eq!(read("friction_k\n0.1\n\"\"\n").unwrap().rows(), 2);
    }

    #[test]
    fn csv_row_of_only_commas_is_no_run() {
        let plain = read("friction_k,initial.phi\n0.1,1\n0.2,\n").unwrap();
        for text in [
            "friction_k,initial.phi\n0.1,1\n,\n0.2,\n,\n",
            "friction_k,initial.phi\n , \n0.1,1\n0.2,\n",
            "friction_k,initial.phi\n,,,,\n0.1,1\n0.2,\n,,,\n",
            ",friction_k,initial.phi\n0,0.1,1\n,,\n1,0.2,\n",
        ] {
            let table = read(text).unwrap();
            assert_eq!(
                (table.rows(), table.digest()),
                (2, plain.digest()),
                "{text:?}"
            );
        }
        let message = read("friction_k,initial.phi\n,\n").unwrap_err();
        assert_eq!(message, "there are no rows");
    }

    #[test]
    fn what_is_wrong_in_a_csv_file_is_told_with_its_line() {
        for (text, message) in [
            (
                "friction_k\n0.1\nfast\n",
                "line 3: friction.k = \"fast\" is not a number",
            ),
            (
                "friction_k\n\n\nfast\n",
                "line 4: friction.k = \"fast\" is not a number",
            ),
            (
                "friction_k,initial.phi\r\n0.1,1\r\n\r\n\r\n0.2,fast",
                "line 5: initial.phi = \"fast\" is not a number",
            ),
            (
                "\u{feff}friction_k,initial.phi\n\"0.1\",1\n0.2,\"fast\"\n",
                "line 3: initial.phi = \"fast\" is not a number",
            ),
            (
                "friction_k,initial.phi\n0.1,1\n\n0.2\n",
                "line 4 has 1 cell, the header has 2",
            ),
            (
                "friction_k\n\"0.1\"\n\"0.2\n0.3\n",
                "line 3: unclosed quote",
            ),
        ] {
            assert_eq!(read(text).unwrap_err(), message, "{text:?}");
        }
        let message = read(b"friction_k\n\xff\n").unwrap_err();
        assert!(message.ends_with("it is not UTF-8 text"), "{message}");
        let message = read(b"\xff\xfef\0r\0").unwrap_err();
        assert!(message.ends_with("save it as UTF-8"), "{message}");
    }
}
