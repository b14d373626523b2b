//! Names of columns.

use super::unit::{Dimension, split_header};
use crate::run::suggestion::{did_you_mean, most_similar, similarity};

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

/// Names of columns of times.
const CLOCKS: [&str; 7] = [
    "t",
    "time",
    "timestamp",
    "elapsed time",
    "elapsed",
    "zeit",
    "seconds",
];

/// How a name can be one of [`CLOCKS`], the surest first. `T` can be a temperature.
const CLOCK_MATCHES: [fn(&str, &str) -> bool; 3] =
    [is_column, is_in_another_case, is_in_a_data_set];

/// The columns of times: those with a name, or else those whose names are the surest. Several are equally sure.
pub(super) fn clocks(columns: &[String], time: Option<&str>) -> Vec<usize> {
    if let Some(name) = time {
        return positions(columns, name);
    }
    let mut candidates = Vec::new();
    for (at, column) in columns.iter().enumerate() {
        if is_time(column) {
            candidates.push(at);
        }
    }
    // `t (frames)` has the times only if no other column has.
    if candidates.iter().any(|at| can_have_times(&columns[*at])) {
        candidates.retain(|at| can_have_times(&columns[*at]));
    }
    for is_match in CLOCK_MATCHES {
        for clock in CLOCKS {
            let mut found = candidates.clone();
            found.retain(|at| is_match(plain(&columns[*at]), clock));
            if !found.is_empty() {
                return found;
            }
        }
    }
    Vec::new()
}

/// Whether the name of a column is that of times.
pub(super) fn is_time(column: &str) -> bool {
    let name = plain(column);
    CLOCKS.iter().any(|clock| is_in_a_data_set(name, clock))
}

/// Whether the unit of a column is one of time, or not stated.
fn can_have_times(column: &str) -> bool {
    Dimension::Time
        .factor(split_header(column).1, column)
        .is_ok()
}

/// The name of a column without its unit, and without a colon at its end.
pub(super) fn plain(column: &str) -> &str {
    split_header(column).0.trim_end_matches(':').trim_end()
}

fn is_in_another_case(column: &str, name: &str) -> bool {
    column.to_lowercase() == name
}

/// Whether a name, in any case, is one without the data set.
fn is_in_a_data_set(column: &str, name: &str) -> bool {
    is_in_another_case(without_data_set(column), name)
}

/// A name without the data set that Vernier writes before it: `Latest: Time`.
pub(super) fn without_data_set(column: &str) -> &str {
    column.rsplit_once(": ").map_or(column, |(_, bare)| bare)
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

/// Names with their verb: "are: t, theta".
pub(super) fn listed(names: &[String]) -> String {
    let verb = if names.len() == 1 { "is" } else { "are" };
    format!("{verb}: {}", names.join(", "))
}

/// The hint for the columns or topics that are most like a name, or an empty string. Case and units don't count, and a
/// topic is compared with that of the name.
pub(super) fn similar(name: &str, known: &[String]) -> String {
    let wrong = split_header(name).0.to_lowercase();
    let topic = wrong.rsplit_once('.').map_or("", |(topic, _)| topic);
    let mut similarities = Vec::new();
    for known_name in known {
        let bare = split_header(known_name).0.to_lowercase();
        if bare == topic {
            // The topic is right: no other one is meant.
            return String::new();
        }
        let compared = if bare.starts_with('/') { topic } else { &wrong };
        similarities.push((similarity(compared, &bare), known_name.as_str()));
    }
    did_you_mean(&most_similar(similarities.into_iter()))
}
