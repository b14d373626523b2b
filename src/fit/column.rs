//! Names of columns.

use super::unit::split_header;

/// How a name can stand for a column, the surest first. Names that differ only in case come last, because columns may do so, too.
const MATCHES: [fn(&str, &str) -> bool; 4] = [
    is_column,
    is_column_with_unit,
    is_column_without_unit,
    can_mean,
];

/// The columns with a name: with their unit, or else without, or else without the unit that the name adds, or else in
/// another case.
pub(super) fn positions(columns: &[String], name: &str) -> Vec<usize> {
    for is_match in MATCHES {
        let mut found = Vec::new();
        for (at, column) in columns.iter().enumerate() {
            if is_match(column, name) {
                found.push(at);
            }
        }
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

/// The column of times: that with a name, or else the first one that is named so.
pub(super) fn clock(columns: &[String], time: Option<&str>) -> Option<usize> {
    match time {
        Some(name) => positions(columns, name).first().copied(),
        None => columns
            .iter()
            .position(|column| is_time(split_header(column).0)),
    }
}

/// Whether a column of this name, without unit, has the times.
pub(super) fn is_time(name: &str) -> bool {
    ["t", "time", "timestamp", "zeit", "seconds"].contains(&&*name.to_lowercase())
}

/// Whether a name can stand for a column, in any case.
pub(super) fn can_mean(column: &str, name: &str) -> bool {
    let (column, name) = (column.to_lowercase(), name.to_lowercase());
    is_column(&column, &name)
        || is_column_with_unit(&column, &name)
        || is_column_without_unit(&column, &name)
}

/// Whether a name is that of a column.
fn is_column(column: &str, name: &str) -> bool {
    column == name
}

/// Whether a name is that of a column without its unit.
fn is_column_with_unit(column: &str, name: &str) -> bool {
    split_header(column).0 == name
}

/// Whether a name adds a unit to that of a column.
fn is_column_without_unit(column: &str, name: &str) -> bool {
    column == split_header(name).0
}
