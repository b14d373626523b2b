//! Tables for a terminal and for documents.

use super::text::{markdown_text, sanitized};
use anstyle::{Effects, Style};
use comfy_table::{
    CellAlignment, ColumnConstraint, ContentArrangement, Table as Layout, TableComponent, presets,
};

const FAINT: Style = Style::new().effects(Effects::DIMMED);
/// Marks the end of the header; can't occur in sanitised cells.
const RULE: char = '\u{1}';

/// A column of a table: its name, and its cell in the row of an item.
pub(super) type Column<T> = (&'static str, fn(&T) -> String);

/// A table. The first `left` columns contain text and may be wrapped; the others contain right-aligned numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Table {
    /// Names of the columns; empty for a table without.
    pub(super) header: Vec<String>,
    /// The cells.
    pub(super) rows: Vec<Vec<String>>,
    /// Number of columns that hold text.
    pub(super) left: usize,
}

impl Table {
    /// A row for each item; the first `left` columns hold text.
    pub(super) fn new<T>(
        items: impl IntoIterator<Item = T>,
        left: usize,
        columns: &[Column<T>],
    ) -> Self {
        let mut rows = Vec::new();
        for item in items {
            rows.push(columns.iter().map(|(_, cell)| cell(&item)).collect());
        }
        Self {
            header: columns.iter().map(|(name, _)| (*name).to_owned()).collect(),
            rows,
            left,
        }
    }

    /// A table of text without a header.
    pub(super) fn from_texts(rows: impl IntoIterator<Item = Vec<String>>) -> Self {
        Self {
            header: Vec::new(),
            rows: rows.into_iter().collect(),
            left: usize::MAX,
        }
    }

    /// A list of facts, each with a label.
    pub(super) fn from_facts<'a>(facts: impl IntoIterator<Item = (&'a str, String)>) -> Self {
        Self::from_texts(
            facts
                .into_iter()
                .map(|(label, fact)| vec![label.to_owned(), fact]),
        )
    }

    fn columns(&self) -> usize {
        let widest = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        widest.max(self.header.len())
    }

    fn has_header(&self) -> bool {
        self.header.iter().any(|name| !name.is_empty())
    }

    /// Renders as text with a dimmed header. Wraps text columns if the table is wider than the terminal.
    pub(super) fn text(&self, columns: Option<usize>) -> String {
        let mut layout = Layout::new();
        layout.load_preset(presets::NOTHING);
        if let Some(columns) = columns {
            layout
                .set_content_arrangement(ContentArrangement::Dynamic)
                .set_width(u16::try_from(columns).unwrap_or(u16::MAX));
        }
        let width = self.columns();
        if self.has_header() {
            layout
                .set_style(TableComponent::HeaderLines, RULE)
                .set_header(cells(&self.header, width));
        }
        layout.add_rows(self.rows.iter().map(|row| cells(row, width)));
        for (at, column) in layout.column_iter_mut().enumerate() {
            // Padding on the right would end each line with spaces.
            column.set_padding((2, 0));
            if at >= self.left {
                column.set_cell_alignment(CellAlignment::Right);
                // A number broken into two lines could be read as two.
                column.set_constraint(ColumnConstraint::ContentWidth);
            }
        }
        let mut text = String::new();
        let mut is_header = self.has_header();
        for line in layout.to_string().lines().map(str::trim_end) {
            if line.contains(RULE) {
                is_header = false;
            } else if is_header {
                text.push_str(&format!("{FAINT}{line}{FAINT:#}\n"));
            } else {
                text.push_str(&format!("{line}\n"));
            }
        }
        text
    }

    /// Renders as Markdown.
    pub(super) fn markdown(&self) -> String {
        let columns = self.columns();
        let rule: Vec<&str> = (0..columns)
            .map(|at| if at < self.left { ":--" } else { "--:" })
            .collect();
        let mut text = markdown_row(&self.header, columns);
        text += &format!("| {} |\n", rule.join(" | "));
        for cells in &self.rows {
            text += &markdown_row(cells, columns);
        }
        text
    }
}

fn markdown_row(row: &[String], columns: usize) -> String {
    let cells: Vec<String> = (0..columns)
        .map(|at| markdown_text(row.get(at).map_or("", String::as_str)))
        .collect();
    format!("| {} |\n", cells.join(" | "))
}

/// The sanitised cells of a row; empty ones at the end, if it has fewer.
fn cells(row: &[String], columns: usize) -> Vec<String> {
    (0..columns)
        .map(|at| sanitized(row.get(at).map_or("", String::as_str)).into_owned())
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row<const N: usize>(cells: [&str; N]) -> Vec<String> {
        cells.map(str::to_owned).to_vec()
    }

    fn plain(table: &Table, columns: Option<usize>) -> String {
        anstream::adapter::strip_str(&table.text(columns)).to_string()
    }

    #[test]
    fn aligns_columns_with_combining_marks() {
        let table = Table {
            header: row(["a", "b"]),
            rows: vec![row(["φ̇", "1"]), row(["xx", "22"])],
            left: 1,
        };
        assert_eq!(plain(&table, None), "  a    b\n  φ̇    1\n  xx  22\n");
        assert_eq!(
            table.markdown(),
            "| a | b |\n| :-- | --: |\n| φ̇ | 1 |\n| xx | 22 |\n"
        );
    }

    #[test]
    fn wraps_text_but_not_numbers() {
        let table = Table {
            header: Vec::new(),
            rows: vec![row(["one two three", "12345678"])],
            left: 1,
        };
        let narrow = plain(&table, Some(20));
        assert_eq!(narrow, "  one two   12345678\n  three\n");
        // In a pipe or a file, each row is one line.
        assert_eq!(plain(&table, None), "  one two three  12345678\n");
    }

    #[test]
    fn sanitizes_cells() {
        let table = Table::from_texts(vec![row(["a\n\x1b[2Jb"])]);
        assert_eq!(plain(&table, None), "  a��[2Jb\n");
    }
}
