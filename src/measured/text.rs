//! Text tables: lines of cells, by one strict reader.

use super::error::DataError;
use super::layout::{Delimiter, Layout};
use super::name::{ColumnName, Meaning};
use super::number::is_number;
use crate::archive::input::text_of;
use crate::words::{Piece, Sentence, sentence};
use csv::StringRecord;
use std::io;
use std::path::Path;

/// Maximum number of rows of a table (held in memory).
pub(super) const MAX_ROWS: usize = 2_000_000;

/// The header is within so many lines: loggers write fewer before it.
const HEAD: usize = 100;

/// A text table.
pub(super) struct TextTable {
    /// The cells of the header.
    pub columns: Vec<String>,
    pub delimiter: Delimiter,
    pub lines: Vec<Line>,
}

/// A line of a text table.
#[derive(Debug)]
pub(super) struct Line {
    /// Number of the line in the file, from 1.
    pub number: u64,
    pub cells: StringRecord,
}

impl Line {
    pub(super) fn cell(&self, column: usize) -> &str {
        self.cells.get(column).unwrap_or_default()
    }

    fn is_blank(&self) -> bool {
        self.cells.iter().all(str::is_empty)
    }

    /// Whether the line has no cells beyond so many. Those at its end may be empty.
    fn fits(&self, columns: usize) -> bool {
        self.cells.iter().skip(columns).all(str::is_empty)
    }
}

/// Reads a table: the header, and the rows below it.
pub(super) fn read(path: &Path, text: &str, layout: &Layout) -> Result<TextTable, DataError> {
    // Each line ends alike, also the last: a quote that is not closed then has a line break after it.
    let mut text = text.trim_start_matches('\u{feff}').replace("\r\n", "\n");
    text = text.replace('\r', "\n");
    text.push('\n');
    let delimiters = match &layout.delimiter {
        Some(delimiter) => std::slice::from_ref(delimiter),
        None => &Delimiter::ALL[..],
    };
    for delimiter in delimiters {
        if let Some(header) = find_header(&text, *delimiter, layout.time.as_deref()) {
            return read_rows(&text, *delimiter, &header).map_err(|error| error.in_file(path));
        }
    }
    Err(not_understood(&text, delimiters).in_file(path))
}

/// The text of a file. Spreadsheets write UTF-16, too, with a byte order mark.
pub(super) fn decode(path: &Path, bytes: Vec<u8>) -> Result<String, DataError> {
    let from_bytes: fn([u8; 2]) -> u16 = match bytes[..] {
        // The mark of UTF-32 begins as this one.
        [0xff, 0xfe, 0, 0, ..] => return text(path, bytes),
        [0xff, 0xfe, ..] => u16::from_le_bytes,
        [0xfe, 0xff, ..] => u16::from_be_bytes,
        _ => return text(path, bytes),
    };
    let units: Vec<u16> = bytes
        .chunks_exact(2)
        .map(|pair| from_bytes([pair[0], pair[1]]))
        .collect();
    String::from_utf16(&units).map_err(|error| DataError::unreadable(path, io::Error::other(error)))
}

fn text(path: &Path, bytes: Vec<u8>) -> Result<String, DataError> {
    text_of(bytes).map_err(|reason| DataError::unreadable(path, reason))
}

/// The header: the last line that names the times before the first row, which has a number there and as many cells.
fn find_header(text: &str, delimiter: Delimiter, time: Option<&str>) -> Option<Line> {
    let mut header: Option<(Line, Vec<usize>)> = None;
    for line in Lines::new(text, delimiter).take(HEAD) {
        let line = line.ok()?;
        if line.is_blank() {
            continue;
        }
        if let Some((names, clocks)) = &header {
            let has_time = clocks.iter().any(|at| is_number(line.cell(*at)));
            if has_time && line.fits(names.cells.len()) {
                return header.map(|(names, _)| names);
            }
        }
        let clocks = clocks(&line.cells, time);
        if !clocks.is_empty() && line.cells.len() > 1 {
            header = Some((line, clocks));
        }
    }
    None
}

/// The columns that a line names like times.
fn clocks(cells: &StringRecord, time: Option<&str>) -> Vec<usize> {
    let given = time.map(|name| (name, ColumnName::parse(name)));
    let mut clocks = Vec::new();
    for (at, cell) in cells.iter().enumerate() {
        let name = ColumnName::parse(cell);
        let is_clock = match &given {
            Some((text, given)) => cell == *text || name.is_called(given),
            None => name.meaning == Some(Meaning::Time),
        };
        if is_clock {
            clocks.push(at);
        }
    }
    clocks
}

fn read_rows(text: &str, delimiter: Delimiter, header: &Line) -> Result<TextTable, DataError> {
    let columns = header.cells.len();
    let mut lines = Vec::new();
    for line in Lines::new(text, delimiter) {
        let line = line?;
        if line.number <= header.number || line.is_blank() {
            continue;
        }
        if lines.len() == MAX_ROWS {
            return Err(too_long());
        }
        if !line.fits(columns) {
            let problem = sentence!(
                "{}, but {}",
                Piece::count(line.cells.len() as u64, "cell"),
                Piece::count(columns as u64, "column")
            );
            return Err(DataError::new(problem).in_line(line.number));
        }
        lines.push(line);
    }
    Ok(TextTable {
        columns: header.cells.iter().map(str::to_owned).collect(),
        delimiter,
        lines,
    })
}

/// The error of more rows than are held in memory.
pub(super) fn too_long() -> DataError {
    let limit = MAX_ROWS.to_string();
    DataError::new(sentence!("more than {} rows: thin out the data", limit))
}

/// The error of a text that is no table, with its first lines as they were understood: with the delimiter that makes most
/// cells of them.
fn not_understood(text: &str, delimiters: &[Delimiter]) -> DataError {
    const SHOWN: usize = 3;
    let mut best: Vec<Line> = Vec::new();
    let count = |lines: &[Line]| lines.iter().map(|line| line.cells.len()).sum::<usize>();
    for delimiter in delimiters {
        let mut lines = Vec::new();
        for line in Lines::new(text, *delimiter) {
            match line {
                Ok(line) if line.is_blank() => {}
                Ok(line) => lines.push(line),
                Err(error) => return error,
            }
            if lines.len() == SHOWN {
                break;
            }
        }
        if count(&lines) > count(&best) {
            best = lines;
        }
    }
    if best.is_empty() {
        return DataError::new("no rows of numbers");
    }
    let shown = best.iter().map(|line| {
        let cells: Vec<&str> = line.cells.iter().collect();
        Sentence::from(format!("“{}”", cut(&cells.join(" | "))))
    });
    let problem = sentence!(
        "no line names the times above rows with as many cells; the first lines are understood as {}",
        Sentence::join(shown, ", ")
    );
    DataError::new(problem).with_remedy(sentence!(
        "write a first line such as t,theta (deg),phi (deg), or see {}, {} and {}",
        Piece::argument("time"),
        Piece::argument("delimiter"),
        Piece::argument("decimal")
    ))
}

/// A text, cut for an error.
pub(super) fn cut(text: &str) -> String {
    const MAX_SHOWN: usize = 60;
    text.chars().take(MAX_SHOWN).collect()
}

/// The lines of a text that are neither empty nor comments.
struct Lines<'a> {
    text: &'a str,
    reader: csv::Reader<&'a [u8]>,
}

impl<'a> Lines<'a> {
    fn new(text: &'a str, delimiter: Delimiter) -> Self {
        let reader = csv::ReaderBuilder::new()
            .delimiter(delimiter.byte())
            .has_headers(false)
            .comment(Some(b'#'))
            // Lines above the header have other numbers of cells.
            .flexible(true)
            .from_reader(text.as_bytes());
        Self { text, reader }
    }

    /// The line in which a record begins that goes on over several.
    fn line_of(&self, record: &StringRecord) -> u64 {
        let start = record
            .position()
            .map_or(0, |position| position.byte() as usize);
        let (before, after) = self.text.split_at(start);
        // The position is that of the empty lines and comments before it.
        let skipped = after
            .lines()
            .take_while(|line| line.is_empty() || line.starts_with('#'));
        (before.matches('\n').count() + skipped.count() + 1) as u64
    }
}

impl Iterator for Lines<'_> {
    type Item = Result<Line, DataError>;

    fn next(&mut self) -> Option<Self::Item> {
        let mut cells = StringRecord::new();
        match self.reader.read_record(&mut cells) {
            Ok(true) => {}
            Ok(false) => return None,
            Err(error) => return Some(Err(DataError::because(error))),
        }
        if cells.iter().any(|cell| cell.contains('\n')) {
            let problem =
                "a quote in this line is not closed, or a cell has a line break in quotes";
            return Some(Err(DataError::new(problem).in_line(self.line_of(&cells))));
        }
        cells.trim();
        Some(Ok(Line {
            // The reader is at the line after the record.
            number: self.reader.position().line() - 1,
            cells,
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn columns(text: &str, layout: &Layout) -> Result<(Delimiter, Vec<String>, u64), DataError> {
        let table = read(Path::new("a.csv"), text, layout)?;
        Ok((table.delimiter, table.columns, table.lines[0].number))
    }

    #[test]
    fn finds_headers_and_delimiters() {
        use Delimiter::{Comma, Semicolon, Tab};
        for (name, text, delimiter, names, row) in [
            ("plain", "t,theta\n0,1\n", Comma, "t|theta", 2),
            ("tabs", "t\ttheta\n0\t0,5\n", Tab, "t|theta", 2),
            (
                "decimal commas",
                "t;theta\n0,1;0,5\n",
                Semicolon,
                "t|theta",
                2,
            ),
            (
                "commas and spaces",
                "t, theta\n0, 0.5\n",
                Comma,
                "t|theta",
                2,
            ),
            (
                "a semicolon in a title",
                "camera; lab 2\nt,theta\n0,1\n",
                Comma,
                "t|theta",
                3,
            ),
            (
                "a tab in a title",
                "camera\t2\nt,theta\n0,1\n",
                Comma,
                "t|theta",
                3,
            ),
            (
                "titles",
                "Time,12:00\nDate,2026\nt,theta\n0,1\n",
                Comma,
                "t|theta",
                4,
            ),
            (
                "a separator line",
                "sep=;\nt;theta\n0;1\n",
                Semicolon,
                "t|theta",
                3,
            ),
            (
                "numbers before",
                "3\n501\nt,theta\n0,1\n",
                Comma,
                "t|theta",
                4,
            ),
            (
                "comments",
                "# t,x\n\nt,theta\n# a \"b\n0,1\n",
                Comma,
                "t|theta",
                5,
            ),
            ("line ends", "t,theta\r\n\r\n0,1\r\n", Comma, "t|theta", 3),
            ("old line ends", "t,theta\r0,1", Comma, "t|theta", 2),
            (
                "no time in the first row",
                "t,theta\n,1\n1,2\n",
                Comma,
                "t|theta",
                2,
            ),
            (
                "a text in all rows",
                "t;x;theta\n0;ok;1,5\n",
                Semicolon,
                "t|x|theta",
                2,
            ),
        ] {
            let found = columns(text, &Layout::default()).unwrap();
            assert_eq!(
                (found.0, &*found.1.join("|"), found.2),
                (delimiter, names, row),
                "{name}"
            );
        }
        let given = Layout::with_time("Frame");
        assert_eq!(columns("frame,x\n0,1\n", &given).unwrap().1, ["frame", "x"]);
    }

    #[test]
    fn refuses_what_it_does_not_understand() {
        let understood = "the first lines are understood as ";
        for (name, text, expected) in [
            (
                "an open quote",
                "t,theta\n0,1\n1,\"2\n2,3\n3,4\n",
                "a.csv:3: a quote in this line",
            ),
            (
                "an open quote at the end",
                "t,theta\n0,1\n1,\"2",
                "a.csv:3: a quote in this line",
            ),
            (
                "a break in a cell",
                "t,theta\n0,1\n\n1,\"2\n3\"\n",
                "a.csv:4: a quote in this line",
            ),
            (
                "spaces",
                "t theta\n0 1\n1 2\n",
                &format!("{understood}“t theta”, “0 1”, “1 2”"),
            ),
            ("no header", "0,1\n1,2\n", "“0 | 1”, “1 | 2”"),
            (
                "decimal commas",
                "t,theta\n0,0,0,5\n",
                "“t | theta”, “0 | 0 | 0 | 5”",
            ),
            (
                "too many cells",
                "t;theta\n0;0,5\n1;0,5;7\n",
                "a.csv:3: 3 cells, but 2 columns",
            ),
            ("nothing", "", "no rows of numbers"),
        ] {
            let error = columns(text, &Layout::default()).unwrap_err().to_string();
            assert!(error.contains(expected), "{name}: {error}");
        }
    }

    #[test]
    fn decodes_text_of_spreadsheets() {
        let path = Path::new("a.csv");
        let text = "t;θ\n0;1\n";
        let units: Vec<u16> = format!("\u{feff}{text}").encode_utf16().collect();
        for to_bytes in [u16::to_le_bytes, u16::to_be_bytes] {
            let bytes = units.iter().flat_map(|unit| to_bytes(*unit)).collect();
            let decoded = decode(path, bytes).unwrap();
            assert_eq!(decoded.trim_start_matches('\u{feff}'), text);
        }
        assert!(decode(path, vec![0xff, 0xfe, 0, 0xd8]).is_err());
    }
}
