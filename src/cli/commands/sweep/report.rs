//! The report of `toprise sweep`.

use crate::cli::report::WrittenFile;
use crate::run::simulation::StopReason;
use crate::sweep::{RowError, Shard};
use crate::words::number::fixed;
use crate::words::{Section, Table, Tone, counted, grouped};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Result of a sweep.
#[derive(Debug, Serialize, JsonSchema)]
pub(crate) struct SweepReport {
    /// Number of runs of the whole sweep.
    pub(super) runs: u64,
    /// Number of runs computed by this command; the others already existed or remain.
    pub(super) computed: u64,
    /// The table; absent if it is not complete.
    pub(super) table: Option<WrittenFile>,
    /// The directory of parts; absent once they are merged.
    pub(super) parts: Option<String>,
    /// Number of runs by stop reason, in the whole table or, if it is incomplete, in this command.
    pub(super) outcomes: BTreeMap<String, u64>,
    /// Number of failed runs.
    pub(super) errors: u64,
    /// The first failed run; absent if there is none.
    pub(super) first_error: Option<RowError>,
    /// Whether the sweep was interrupted.
    pub(super) interrupted: bool,
    /// Duration, s.
    pub(super) wall_time: f64,
}

/// Counts of results, in a few words.
pub(super) fn summary(stops: &BTreeMap<String, u64>, errors: u64) -> String {
    let mut all: Vec<_> = stops.iter().collect();
    // The most frequent first, because the progress line is cut at its end.
    all.sort_by_key(|(_, number)| std::cmp::Reverse(**number));
    let mut words: Vec<_> = all
        .into_iter()
        .map(|(stop, number)| format!("{} {}", grouped(*number), stop_words(stop)))
        .collect();
    if errors > 0 {
        words.push(format!("{} failed", grouped(errors)));
    }
    words.join(", ")
}

/// The words for the name of a stop reason; a table of another version may have other names.
fn stop_words(name: &str) -> String {
    StopReason::find(name).map_or_else(|| name.replace('_', " "), StopReason::words)
}

impl SweepReport {
    /// The human-readable report; `left` is the number of runs that remained before this command.
    pub(super) fn page(&self, left: u64, dry_run: bool, shard: Option<Shard>) -> Vec<Section> {
        let mut facts = Vec::new();
        let outcomes = summary(&self.outcomes, self.errors);
        if !outcomes.is_empty() {
            facts.push(("outcomes", outcomes));
        }
        if let Some(error) = &self.first_error {
            // The lines that point at a place in a formula need a line of their own.
            let reason = error.error.lines().next().unwrap_or_default();
            facts.push(("first error", format!("run {}: {reason}", error.run)));
        }
        if dry_run {
            facts.push(("left", counted(left, "run")));
        } else {
            let computed = match self.computed {
                0 if left > 0 => "nothing".to_owned(),
                0 => "0 runs (all were already computed)".to_owned(),
                computed => format!(
                    "{} in {} s ({} per second)",
                    counted(computed, "run"),
                    fixed(self.wall_time, 2),
                    fixed(computed as f64 / self.wall_time, 1)
                ),
            };
            facts.push(("computed", computed));
        }
        if let Some(table) = &self.table {
            facts.push(("table", table.line()));
        }
        if self.interrupted {
            // The other runs of a shard belong to other commands.
            let (kept, left) = (grouped(self.computed), counted(left, "run"));
            facts.push(("kept", format!("{kept} of the {left} that were left")));
        }
        if let Some(parts) = &self.parts {
            facts.push(("parts", parts.clone()));
            let how = if shard.is_some() && !self.interrupted {
                "when all shards are done, run without --shard to merge them"
            } else {
                "run the same command to resume"
            };
            facts.push(("", how.to_owned()));
        }
        vec![
            self.title(dry_run, shard),
            Section::from(Table::from_facts(facts)),
        ]
    }

    fn title(&self, dry_run: bool, shard: Option<Shard>) -> Section {
        let runs = counted(self.runs, "run");
        // The last shard may have completed the table.
        let is_part = self.table.is_none();
        if self.interrupted {
            Section::with_tone(Tone::Weak, format!("{runs}: interrupted"))
        } else if dry_run {
            Section::new(runs)
        } else if let Some(Shard { index, count }) = shard.filter(|_| is_part) {
            Section::with_tone(
                Tone::Good,
                format!("{runs}: shard {index} of {count} is done"),
            )
        } else if self.errors > 0 {
            Section::with_tone(
                Tone::Weak,
                format!("{runs}, {} failed", grouped(self.errors)),
            )
        } else {
            Section::with_tone(Tone::Good, runs)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_outcomes_in_the_words_of_a_run() {
        let stops = [("duration", 2), ("risen", 4), ("slip_stopped", 1)]
            .map(|(name, count)| (name.to_owned(), count));
        assert_eq!(
            summary(&stops.into(), 0),
            "4 risen, 2 at the time limit, 1 slip stopped"
        );
    }
}
