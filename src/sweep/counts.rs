//! Counts of rows by result.

use crate::run::simulation::StopReason;
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
    /// Counts a row that has an outcome.
    pub fn count_stop(&mut self, stop: StopReason) {
        *self.stops.entry(stop.name().to_owned()).or_default() += 1;
    }

    /// Counts a row that has none.
    pub fn count_error(&mut self, run: u64, error: &impl ToString) {
        self.errors += 1;
        self.first_error.get_or_insert_with(|| RowError {
            run,
            error: error.to_string(),
        });
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
