//! The report of `toprise sweep`.

use crate::cli::numbers::{count, counted, number};
use crate::cli::page::{Page, Section, Tone};
use crate::cli::report::WrittenFile;
use crate::cli::table::Table;
use crate::sweep::{RowError, Shard};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;
use std::time::Duration;

/// Result of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SweepReport {
    /// Number of runs of the whole sweep.
    pub(super) runs: u64,
    /// Number of runs that were computed now; the others were there, or are left.
    pub(super) computed: u64,
    /// The table; absent if it is not complete.
    pub(super) table: Option<WrittenFile>,
    /// The directory of parts; absent once they are merged.
    pub(super) parts: Option<String>,
    /// Number of runs for each reason why they stopped: of the table, or of those computed now if it is not complete.
    pub(super) outcomes: BTreeMap<String, u64>,
    /// Number of runs that have an error instead of an outcome.
    pub(super) errors: u64,
    /// The first run that has an error; absent if none has.
    pub(super) first_error: Option<RowError>,
    /// Whether the sweep was interrupted.
    pub(super) interrupted: bool,
    /// Duration, s.
    pub(super) wall_time: f64,
}

/// Further content of a report's page.
pub(super) struct Asked {
    /// Whether nothing was to be computed.
    pub(super) dry_run: bool,
    /// The share that was to be computed.
    pub(super) shard: Option<Shard>,
    /// Number of runs that were left to compute.
    pub(super) left: u64,
    /// Time of the computation.
    pub(super) computing: Duration,
}

/// Counts of results, in a few words.
pub(super) fn summary(stops: &BTreeMap<String, u64>, errors: u64) -> String {
    let mut all: Vec<_> = stops.iter().collect();
    all.sort_by_key(|(_, number)| std::cmp::Reverse(**number));
    let mut words: Vec<_> = all
        .into_iter()
        .map(|(stop, number)| format!("{} {}", count(*number), stop.replace('_', " ")))
        .collect();
    if errors > 0 {
        words.push(format!("{} without an outcome", count(errors)));
    }
    words.join(", ")
}

impl SweepReport {
    pub(super) fn page(&self, asked: &Asked) -> Page {
        let mut facts = Vec::new();
        let outcomes = summary(&self.outcomes, self.errors);
        if !outcomes.is_empty() {
            facts.push(("outcomes", outcomes));
        }
        if let Some(error) = &self.first_error {
            facts.push(("first error", format!("run {}: {}", error.run, error.error)));
        }
        if asked.dry_run {
            facts.push(("left", counted(asked.left, "run")));
        } else {
            let computing = asked.computing.as_secs_f64();
            let computed = match self.computed {
                0 if asked.left > 0 => "nothing".to_owned(),
                0 => "nothing: nothing was left to do".to_owned(),
                computed => format!(
                    "{} in {} s, {} a second",
                    counted(computed, "run"),
                    number(computing, 2),
                    number(computed as f64 / computing, 1)
                ),
            };
            facts.push(("computed", computed));
        }
        if let Some(table) = &self.table {
            facts.push(("table", table.line()));
        }
        if let Some(parts) = &self.parts {
            facts.push(("parts", parts.clone()));
            let how = if asked.shard.is_some() && !self.interrupted {
                "once all shards are done, the command without --shard merges them"
            } else {
                "the same command goes on"
            };
            facts.push(("", how.to_owned()));
        }
        let mut section = Section::default();
        section.table(Table::of_facts(facts));
        let (title, tone) = self.title(asked);
        Page {
            title,
            tone,
            ..Page::of(section)
        }
    }

    fn title(&self, asked: &Asked) -> (String, Tone) {
        let runs = counted(self.runs, "run");
        if self.interrupted {
            (format!("{runs}: interrupted"), Tone::Weak)
        } else if asked.dry_run {
            (runs, Tone::Neutral)
        } else if let Some(Shard { index, count }) = asked.shard.filter(|_| self.table.is_none()) {
            (
                format!("{runs}: shard {index} of {count} is done"),
                Tone::Good,
            )
        } else if self.errors > 0 {
            let errors = count(self.errors);
            (
                format!("{runs}, {errors} of them without an outcome"),
                Tone::Weak,
            )
        } else {
            (runs, Tone::Good)
        }
    }
}
