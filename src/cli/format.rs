//! Numbers and tables for people.

use std::borrow::Cow;
use unicode_width::UnicodeWidthStr as _;

/// A number with `digits` after the point and the typographic minus.
pub(super) fn number(value: f64, digits: usize) -> String {
    format!("{value:.digits$}").replace('-', "−")
}

/// A whole number with its thousands set apart.
pub(super) fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// A number of bytes.
pub(super) fn bytes(value: u64) -> String {
    match value {
        0..1_000 => format!("{value} B"),
        1_000..1_000_000 => format!("{:.1} kB", value as f64 / 1e3),
        1_000_000..1_000_000_000 => format!("{:.1} MB", value as f64 / 1e6),
        _ => format!("{:.2} GB", value as f64 / 1e9),
    }
}

/// Rows as columns: those in `right` right-aligned, the others left-aligned, two spaces between.
pub(super) fn table(rows: &[Vec<String>], right: &[usize]) -> String {
    let mut text = String::new();
    for line in aligned(rows, |column| right.contains(&column)) {
        text.push_str(&line);
        text.push('\n');
    }
    text
}

/// A line for each row, with the cells of a column below each other and two spaces between.
///
/// A cell alone in its row is a heading: it may stand over the next columns.
pub(super) fn aligned(rows: &[Vec<String>], is_right: impl Fn(usize) -> bool) -> Vec<String> {
    let columns = rows.iter().map(Vec::len).max().unwrap_or(0);
    let width = |column: usize| {
        let several = rows.iter().filter(|row| row.len() > 1);
        let cells = several.filter_map(|row| row.get(column));
        cells.map(|cell| cell.width()).max().unwrap_or(0)
    };
    let widths: Vec<usize> = (0..columns).map(width).collect();
    let line = |row: &Vec<String>| {
        let mut line = String::new();
        for (column, cell) in row.iter().enumerate() {
            let cell = harmless(cell);
            let padding = " ".repeat(widths[column].saturating_sub(cell.width()));
            let (before, after) = if is_right(column) {
                (padding.as_str(), "")
            } else {
                ("", padding.as_str())
            };
            line.push_str(&format!("  {before}{cell}{after}"));
        }
        line.truncate(line.trim_end().len());
        line
    };
    rows.iter().map(line).collect()
}

/// A text without what would break a table or a terminal.
pub(super) fn harmless(text: &str) -> Cow<'_, str> {
    if text.contains(char::is_control) {
        Cow::Owned(text.replace(char::is_control, "\u{fffd}"))
    } else {
        Cow::Borrowed(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(count(0), "0");
        assert_eq!(count(999), "999");
        assert_eq!(count(24_720), "24,720");
        assert_eq!(count(1_000_000), "1,000,000");
        assert_eq!(bytes(999), "999 B");
        assert_eq!(bytes(31_400_000), "31.4 MB");
        assert_eq!(number(-0.2969, 3), "−0.297");
    }

    #[test]
    fn columns_line_up() {
        let row = |cells: [&str; 2]| cells.map(str::to_owned).to_vec();
        let rows = [row(["a", "1"]), row(["bcd", "23"])];
        assert_eq!(table(&rows, &[1]), "  a     1\n  bcd  23\n");
    }
}
