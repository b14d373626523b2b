//! Counts of rows by result.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

/// Counts of rows by result.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Counts {
    /// Number of rows for each reason why a run stopped.
    pub stops: BTreeMap<String, u64>,
    /// Number of rows that have an error instead of an outcome.
    pub errors: u64,
    /// The first row that has an error; absent if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub first_error: Option<RowError>,
}

/// A row without an outcome.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RowError {
    /// The number of the row.
    pub run: u64,
    /// The reason why it has no outcome.
    pub error: String,
}

impl Counts {
    /// Counts a row by its stop reason, or its error.
    pub fn count(&mut self, run: u64, result: Result<&str, &str>) {
        match result {
            Ok(stop) => *self.stops.entry(stop.to_owned()).or_default() += 1,
            Err(error) => {
                self.errors += 1;
                self.first_error.get_or_insert_with(|| RowError {
                    run,
                    error: error.to_owned(),
                });
            }
        }
    }

    /// Adds the counts of later rows.
    pub fn add(&mut self, later: Self) {
        for (stop, count) in later.stops {
            *self.stops.entry(stop).or_default() += count;
        }
        self.errors += later.errors;
        self.first_error = self.first_error.take().or(later.first_error);
    }
}
