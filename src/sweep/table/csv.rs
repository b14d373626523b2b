//! Comma-separated tables, as pandas and spreadsheets write them.

use super::column::Column;
use crate::run::scenario::{Key, Value};
use crate::sweep::error::TableError;
use crate::sweep::spec::axis::find_key;
use csv::StringRecord;

/// Whether a line of a comma-separated table has no cell with content. Editors leave blank lines, and spreadsheets write
/// commas where nothing was entered. An empty cell of a table with one column is written as `""`.
fn is_empty_row(line: &str) -> bool {
    line.split(',').all(|cell| cell.trim().is_empty())
}

/// The lines of a comma-separated table that have content, with their numbers; no cell contains a line break.
fn lines(text: &str) -> Result<Vec<(&str, u64)>, TableError> {
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

/// Reads the columns of a comma-separated table, and the number of their rows.
pub(super) fn read(text: &str) -> Result<(Vec<Column>, u64), TableError> {
    // Spreadsheets write a byte order mark, which would belong to the name of the first column.
    let content = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    let lines = lines(&content)?;
    let filled: Vec<&str> = lines.iter().map(|(line, _)| *line).collect();
    let joined = filled.join("\n");
    let mut reader = ::csv::ReaderBuilder::new()
        .has_headers(false)
        .flexible(true)
        .trim(::csv::Trim::All)
        .from_reader(joined.as_bytes());
    let mut records = reader.records();
    let header = records.next().transpose()?.unwrap_or_default();
    let mut table = CsvTable::new(&header)?;
    for (record, (_, line)) in records.zip(lines.into_iter().skip(1)) {
        table.add(&record?, line)?;
    }
    Ok((table.columns, table.rows))
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
                return Err(TableError::UnnamedColumn {
                    line,
                    cell: cell.to_owned(),
                });
            }
        }
        for (Column { key, cells, .. }, place) in self.columns.iter_mut().zip(&self.places) {
            cells.push(parse_cell(key, &record[*place], line)?);
        }
        self.rows += 1;
        Ok(())
    }
}

/// A cell of a CSV file: empty, a word or a number.
fn parse_cell(key: &'static Key, cell: &str, line: u64) -> Result<Option<Value>, TableError> {
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
    use super::super::Table;
    use std::io::Write as _;

    fn read_file(text: impl AsRef<[u8]>) -> Result<Table, String> {
        let mut file = tempfile::NamedTempFile::with_suffix(".csv").unwrap();
        file.write_all(text.as_ref()).unwrap();
        let path = format!("{}: ", file.path().display());
        Table::read(file.path()).map_err(|error| error.to_string().replace(&path, ""))
    }

    /// Output of `DataFrame.to_csv`.
    #[test]
    fn ignores_pandas_index_in_csv() {
        let plain = read_file("friction_k,initial.phi\n0.1,1\n0.2,\n").unwrap();
        let table = read_file(",friction_k,initial.phi\n0,0.1,1\n1,0.2,\n").unwrap();
        assert_eq!(table.rows(), 2);
        assert_eq!(table.digest(), plain.digest());
        // An unnamed column that does not count the rows could be meant as values.
        for text in [
            ",friction_k\n0,0.1\n2,0.2\n",
            ",friction_k\n0,0.1\n,0.2\n",
            ",friction_k\n0,0.1\n0.5,0.2\n",
        ] {
            let message = read_file(text).unwrap_err();
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
            let table = read_file(text).unwrap();
            let plain = read_file("friction_k\n0.1\n0.2\n").unwrap();
            assert_eq!(
                (table.rows(), table.digest()),
                (2, plain.digest()),
                "{text:?}"
            );
        }
        // A missing value of pandas.
        assert_eq!(read_file("friction_k\n0.1\n\"\"\n").unwrap().rows(), 2);
    }

    #[test]
    fn skips_csv_rows_of_commas() {
        let plain = read_file("friction_k,initial.phi\n0.1,1\n0.2,\n").unwrap();
        for text in [
            "friction_k,initial.phi\n0.1,1\n,\n0.2,\n,\n",
            "friction_k,initial.phi\n , \n0.1,1\n0.2,\n",
            "friction_k,initial.phi\n,,,,\n0.1,1\n0.2,\n,,,\n",
            ",friction_k,initial.phi\n0,0.1,1\n,,\n1,0.2,\n",
        ] {
            let table = read_file(text).unwrap();
            assert_eq!(
                (table.rows(), table.digest()),
                (2, plain.digest()),
                "{text:?}"
            );
        }
        let message = read_file("friction_k,initial.phi\n,\n").unwrap_err();
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
            assert_eq!(read_file(text).unwrap_err(), message, "{text:?}");
        }
        let message = read_file(b"friction_k\n\xff\n").unwrap_err();
        assert!(
            message.ends_with("it is not UTF-8 text (line 2): save it as UTF-8"),
            "{message}"
        );
        let message = read_file(b"\xff\xfef\0r\0").unwrap_err();
        assert!(message.ends_with("save it as UTF-8"), "{message}");
    }
}
