//! Input tables with the values of each run.

use super::axis::find_key;
use super::cells::{Cells, cells as column_cells, values_of};
use super::error::{CellError, SweepError, TableError};
use super::reader::{self, Opened};
use crate::archive::input::read_file;
use crate::run::scenario::{Key, Value};
use arrow_array::{RecordBatch, new_empty_array};
use arrow_schema::{DataType, Schema};
use csv::StringRecord;
use serde_json::Value as Json;
use sha2::{Digest as _, Sha256};
use std::path::{Path, PathBuf};

/// Maximum number of rows (held in memory).
const MAX_ROWS: u64 = 10_000_000;

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
    /// [`SweepError::Table`] for other file types, or a column that is not a key.
    pub fn read(path: &Path) -> Result<Self, SweepError> {
        let extension = path.extension().unwrap_or_default();
        let mut table = if extension == "parquet" {
            reader::read(path, from_parquet)?
        } else if extension == "csv" {
            let text = read_file(path).map_err(SweepError::io("read", path))?;
            from_csv(&text).map_err(SweepError::table(path))?
        } else {
            return Err(SweepError::table(path)(TableError::Extension));
        };
        table.file = Some(path.to_owned());
        Ok(table)
    }

    /// Reads the columns of Arrow batches, which all have this schema. A pandas index is ignored unless it has the
    /// name of a key.
    ///
    /// # Errors
    /// A column that is not a key, or has values that are neither numbers nor words.
    pub fn from_batches(schema: &Schema, batches: &[RecordBatch]) -> Result<Self, TableError> {
        let rows = batches.iter().map(|batch| batch.num_rows() as u64).sum();
        let mut table = Self::empty(schema, rows)?;
        for batch in batches {
            table.add(batch)?;
        }
        Ok(table)
    }

    /// An empty table for a schema and number of rows, validated before any cell is read.
    fn empty(schema: &Schema, rows: u64) -> Result<Self, TableError> {
        check_rows(rows)?;
        let indices = pandas_indices(schema);
        let mut columns = Vec::new();
        for field in schema.fields() {
            let name = field.name();
            let key = match find_key(name) {
                Ok(key) => key,
                Err(_) if indices.contains(name) || is_nameless_index(name) => continue,
                Err(error) => return Err(error.into()),
            };
            check_type(key, field.data_type()).map_err(TableError::column(name))?;
            columns.push(Column {
                name: name.clone(),
                key,
                cells: Vec::new(),
            });
        }
        Ok(Self {
            columns,
            rows: 0,
            file: None,
        })
    }

    /// Adds the rows of a batch.
    fn add(&mut self, batch: &RecordBatch) -> Result<(), TableError> {
        self.rows += batch.num_rows() as u64;
        check_rows(self.rows.max(1))?;
        for Column { name, cells, .. } in &mut self.columns {
            if let Some(column) = batch.column_by_name(name) {
                cells.extend(column_cells(column).map_err(TableError::column(name))?);
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
        self.columns
            .iter()
            .map(|column| column.cells[row as usize].clone())
            .collect()
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
fn check_rows(rows: u64) -> Result<(), TableError> {
    match rows {
        0 => Err(TableError::Empty),
        1..=MAX_ROWS => Ok(()),
        _ => Err(TableError::TooManyRows(MAX_ROWS)),
    }
}

/// Checks that a column type suits its key.
fn check_type(key: &Key, kind: &DataType) -> Result<(), CellError> {
    column_cells(&new_empty_array(kind))?;
    let values = values_of(kind);
    match (values.is_string(), key.kind.is_text()) {
        _ if *values == DataType::Null => Ok(()),
        (true, false) => Err(CellError::Words(key.kind)),
        (false, true) => Err(CellError::Numbers(key.kind)),
        (true, true) | (false, false) => Ok(()),
    }
}

fn from_parquet(opened: Opened) -> Result<Table, TableError> {
    let rows = opened
        .metadata()
        .row_groups()
        .iter()
        // The numbers are those that a damaged file claims.
        .map(|group| u64::try_from(group.num_rows()).unwrap_or(u64::MAX))
        .fold(0, u64::saturating_add);
    let schema = opened.schema().clone();
    let mut table = Table::empty(&schema, rows)?;
    // Columns that aren't keys are not decoded.
    let mut wanted = Vec::new();
    for (index, field) in schema.fields().iter().enumerate() {
        if table
            .columns
            .iter()
            .any(|column| column.name == *field.name())
        {
            wanted.push(index);
        }
    }
    for batch in reader::batches(opened, wanted)? {
        table.add(&batch?)?;
    }
    Ok(table)
}

/// The columns in which pandas has stored its row index.
fn pandas_indices(schema: &Schema) -> Vec<String> {
    let Some(text) = schema.metadata().get("pandas") else {
        return Vec::new();
    };
    let metadata: Json = serde_json::from_str(text).unwrap_or_default();
    let names = metadata["index_columns"].as_array().into_iter().flatten();
    // A RangeIndex is not a column; it is described by an object.
    names
        .filter_map(|name| name.as_str().map(str::to_owned))
        .collect()
}

/// Whether this is the name of an unnamed pandas index: `__index_level_0__`.
fn is_nameless_index(name: &str) -> bool {
    name.strip_prefix("__index_level_")
        .and_then(|rest| rest.strip_suffix("__"))
        .is_some_and(|level| level.parse::<u32>().is_ok())
}

/// Whether a line of a comma-separated table has no cell with content. Editors leave blank lines, and spreadsheets write
/// commas where nothing was entered. An empty cell of a table with one column is written as `""`.
fn is_empty_row(line: &str) -> bool {
    line.split(',').all(|cell| cell.trim().is_empty())
}

/// The lines of a comma-separated table that have content, with their numbers; no cell contains a line break.
fn csv_lines(text: &str) -> Result<Vec<(&str, u64)>, TableError> {
    let mut lines = Vec::new();
    for (text, line) in text.split(['\n', '\r']).zip(1..) {
        if is_empty_row(text) {
            continue;
        }
        // The CSV reader would take all that follows for one cell.
        if text.matches('"').count() % 2 == 1 {
            return Err(TableError::UnclosedQuote { line });
        }
        lines.push((text, line));
    }
    Ok(lines)
}

/// Reads a comma-separated table.
fn from_csv(text: &str) -> Result<Table, TableError> {
    // Spreadsheets write a byte order mark, which would belong to the name of the first column.
    let text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let lines = csv_lines(&text)?;
    let filled: Vec<&str> = lines.iter().map(|(line, _)| *line).collect();
    let filled = filled.join("\n");
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(csv::Trim::All)
        .from_reader(filled.as_bytes());
    let mut records = reader.records();
    let header = records.next().transpose()?.unwrap_or_default();
    let mut table = CsvTable::new(&header)?;
    for (record, (_, line)) in records.zip(lines.into_iter().skip(1)) {
        table.add(&record?, line)?;
    }
    check_rows(table.rows)?;
    Ok(Table {
        columns: table.columns,
        rows: table.rows,
        file: None,
    })
}

/// A comma-separated table that is being read.
struct CsvTable {
    /// Number of cells of each row.
    width: usize,
    /// Columns without a name: row indices that pandas has written.
    indices: Vec<usize>,
    /// Where the cells of each column are in a row.
    places: Vec<usize>,
    columns: Vec<Column>,
    rows: u64,
}

impl CsvTable {
    fn new(header: &StringRecord) -> Result<Self, TableError> {
        let mut table = Self {
            width: header.len(),
            indices: Vec::new(),
            places: Vec::new(),
            columns: Vec::new(),
            rows: 0,
        };
        for (place, name) in header.iter().enumerate() {
            if name.is_empty() {
                table.indices.push(place);
                continue;
            }
            table.places.push(place);
            table.columns.push(Column {
                name: name.to_owned(),
                key: find_key(name)?,
                cells: Vec::new(),
            });
        }
        Ok(table)
    }

    fn add(&mut self, record: &StringRecord, line: u64) -> Result<(), TableError> {
        if record.len() != self.width {
            return Err(TableError::CellCount {
                line,
                count: record.len(),
                expected: self.width,
            });
        }
        // Spreadsheets may quote the cells in which nothing was entered.
        if self.width > 1 && record.iter().all(str::is_empty) {
            return Ok(());
        }
        for place in &self.indices {
            let cell = &record[*place];
            if cell.parse() != Ok(self.rows) {
                let cell = cell.to_owned();
                return Err(TableError::UnnamedColumn { line, cell });
            }
        }
        for (Column { key, cells, .. }, place) in self.columns.iter_mut().zip(&self.places) {
            cells.push(csv_cell(key, &record[*place], line)?);
        }
        self.rows += 1;
        Ok(())
    }
}

/// A cell of a CSV file: empty, a word or a number.
fn csv_cell(key: &'static Key, cell: &str, line: u64) -> Result<Option<Value>, TableError> {
    if cell.is_empty() {
        return Ok(None);
    }
    if key.kind.is_text() {
        return Ok(Some(Value::Text(cell.to_owned())));
    }
    match cell.parse() {
        Ok(number) => Ok(Some(Value::Number(number))),
        Err(_) => Err(TableError::NotANumber {
            line,
            key,
            cell: cell.to_owned(),
        }),
    }
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
    fn ignores_pandas_index_in_csv() {
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
    fn skips_csv_rows_of_commas() {
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
    fn csv_errors_name_the_line() {
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
