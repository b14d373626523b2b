//! What separates the cells of a text table.

use super::cell::{Cell, is_missing, is_spreadsheet_error};
use super::unit::is_bracketed_unit;
use csv::StringRecord;

/// What separates the cells of a text table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Delimiter {
    Tab,
    Semicolon,
    Comma,
    /// Runs of spaces.
    Blanks,
}

impl Delimiter {
    /// The surest first: commas may be decimal marks, and spaces are anywhere.
    const ALL: [Self; 4] = [Self::Tab, Self::Semicolon, Self::Comma, Self::Blanks];

    /// The delimiter that makes most of the first lines rows of numbers. If none does, the first one that these lines
    /// have.
    pub(super) fn find(text: &str) -> Self {
        let mut most_rows = 0;
        let mut best = None;
        for delimiter in Self::ALL {
            let rows = delimiter.beginning(text).filter(is_row).count();
            if rows > most_rows {
                (most_rows, best) = (rows, Some(delimiter));
            }
        }
        if let Some(best) = best {
            return best;
        }
        for delimiter in Self::ALL {
            if delimiter.beginning(text).any(|record| record.len() > 1) {
                return delimiter;
            }
        }
        Self::Comma
    }

    /// The first lines that are not comments.
    fn beginning(self, text: &str) -> impl Iterator<Item = StringRecord> {
        /// Loggers write fewer lines before the numbers.
        const LINES: usize = 100;
        self.records(text)
            .map_while(Result::ok)
            .filter(|record| !is_comment(record) && !is_blank(record))
            .take(LINES)
    }

    /// The lines of a text.
    pub(super) fn records(self, text: &str) -> impl Iterator<Item = csv::Result<StringRecord>> {
        let byte = match self {
            Self::Tab => b'\t',
            Self::Semicolon => b';',
            Self::Comma => b',',
            Self::Blanks => b' ',
        };
        csv::ReaderBuilder::new()
            .delimiter(byte)
            .has_headers(false)
            // Titles and comments have other numbers of cells than the rows.
            .flexible(true)
            .trim(csv::Trim::All)
            .from_reader(text.as_bytes())
            .into_records()
            .map(move |record| match self {
                Self::Tab | Self::Semicolon | Self::Comma => record,
                Self::Blanks => record.map(|record| without_runs(&record)),
            })
    }
}

/// Whether all cells are numbers or missing, and at least one is a number.
fn is_row(record: &StringRecord) -> bool {
    let mut numbers = 0;
    for text in record {
        match Cell::parse(text) {
            // A space may be the delimiter.
            Cell::Number(..) | Cell::Unclear(..) | Cell::Grouped if !text.contains(' ') => {
                numbers += 1;
            }
            Cell::Missing => {}
            Cell::Number(..) | Cell::Unclear(..) | Cell::Grouped | Cell::Text => return false,
        }
    }
    numbers > 0 && record.len() > 1
}

/// The cells that are separated by runs of spaces. A unit in brackets belongs to the name before it.
pub(super) fn without_runs(record: &StringRecord) -> StringRecord {
    let mut cells: Vec<String> = Vec::new();
    for cell in record.iter().filter(|cell| !cell.is_empty()) {
        match cells.last_mut() {
            Some(name) if is_bracketed_unit(cell) && !is_bracketed_unit(name) => {
                *name = format!("{name} {cell}");
            }
            Some(_) | None => cells.push(cell.to_owned()),
        }
    }
    let mut joined = StringRecord::from(cells);
    joined.set_position(record.position().cloned());
    joined
}

/// Whether a line is a comment. `#N/A` is a missing value, `#REF!` a cell to complain about.
pub(super) fn is_comment(record: &StringRecord) -> bool {
    let first = record.get(0).unwrap_or_default();
    first.starts_with(['#', '%']) && !is_missing(first) && !is_spreadsheet_error(first)
}

pub(super) fn is_blank(record: &StringRecord) -> bool {
    record.iter().all(str::is_empty)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_what_separates_numbers() {
        for (name, text, expected) in [
            ("tabs", "t\ttheta\n0\t0,5\n", Delimiter::Tab),
            ("semicolons", "t;theta\n0,1;0,5\n", Delimiter::Semicolon),
            ("commas", "t,theta\n0,0.5\n", Delimiter::Comma),
            ("commas and spaces", "t, theta\n0, 0.5\n", Delimiter::Comma),
            (
                "a semicolon in a title",
                "camera; lab 2\nt,theta\n0,0.5\n",
                Delimiter::Comma,
            ),
            (
                "a tab in a title",
                "camera\t2\nt,theta\n0,0.5\n",
                Delimiter::Comma,
            ),
            (
                "a text in all rows",
                "t;theta;x\n0,1;0,5;a\n",
                Delimiter::Semicolon,
            ),
            ("spaces", "t theta\n0 0.5\n", Delimiter::Blanks),
            ("decimal commas", "t theta\n0,00 0,51\n", Delimiter::Blanks),
            (
                "decimal commas and thousands",
                "t phi\n1 250,5\n2 260,5\n",
                Delimiter::Blanks,
            ),
            (
                "fixed width",
                "  t     theta\n  0.0   0.5\n",
                Delimiter::Blanks,
            ),
            ("one column", "t\n0\n1\n", Delimiter::Comma),
            ("nothing", "", Delimiter::Comma),
        ] {
            assert_eq!(Delimiter::find(text), expected, "{name}");
        }
    }
}
