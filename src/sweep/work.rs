//! Computes the missing parts of a sweep in parallel.

use super::counts::{Counts, RowError};
use super::error::SweepError;
use super::part::Sweep;
use super::row::Watch;
use super::store::Store;
use rayon::iter::{IntoParallelRefIterator as _, ParallelIterator as _};
use std::path::Path;
use std::thread;

/// A shard of the parts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Index, from 0.
    pub index: u64,
    /// Number of shards.
    pub count: u64,
}

impl Shard {
    /// Whether a part is in this shard.
    pub(super) fn has(self, part: u64) -> bool {
        part % self.count == self.index
    }
}

/// Options of a computation. They don't affect the bytes.
#[derive(Clone, Copy, Debug, Default)]
pub struct Options {
    /// Number of threads; see [`threads`].
    pub threads: usize,
    /// Compute only the parts of this shard, and don't merge.
    pub shard: Option<Shard>,
    /// Stop at the first failed row, including rows computed before.
    pub fail_fast: bool,
}

/// The number of threads for some runs: the requested number (0: all), but no more than there are processors and runs.
pub fn threads(wanted: usize, runs: u64) -> usize {
    let processors = thread::available_parallelism().map_or(1, usize::from);
    let requested = if wanted == 0 { processors } else { wanted };
    // A thread without a row would only be started and ended.
    let useful = usize::try_from(runs).unwrap_or(usize::MAX).max(1);
    requested.min(processors).min(useful)
}

/// The result of a computation.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Finished {
    /// Whether the table is complete (not after a shard or interruption).
    pub is_merged: bool,
    /// Whether the sweep was interrupted.
    pub is_interrupted: bool,
    /// Number of rows computed now; the others already existed.
    pub computed: u64,
    /// Counts of their results: all rows of the table, or those computed now if the table is incomplete.
    pub counts: Counts,
}

/// Computes the parts of a sweep that are missing next to `table`, and merges them into it. Does nothing if the table
/// is complete.
///
/// # Errors
/// [`SweepError`] if existing files belong to another sweep, a file can't be written, or a row fails with [`Options::fail_fast`].
/// Complete parts are kept.
pub fn run(
    sweep: &Sweep,
    table: &Path,
    options: &Options,
    watch: &Watch<'_>,
) -> Result<Finished, SweepError> {
    let store = Store::new(sweep, table)?;
    let mut finished = Finished::default();
    let mut merged = store.finished()?;
    if merged.is_none() {
        merged = match complete(&store, options, watch, &mut finished) {
            Ok(()) => store.finished()?,
            // A row that fails does so for every process.
            Err(error @ SweepError::Row(_)) => return Err(error),
            // Another process may have completed the table meanwhile.
            Err(error) => Some(store.finished().ok().flatten().ok_or(error)?),
        };
    }
    if let Some(counts) = merged {
        store.clear_rest();
        if options.fail_fast {
            fail_on(counts.first_error.as_ref())?;
        }
        finished.counts = counts;
        finished.is_merged = true;
    }
    Ok(finished)
}

/// Fails with the error of a row, if there is one.
fn fail_on(error: Option<&RowError>) -> Result<(), SweepError> {
    error
        .cloned()
        .map_or(Ok(()), |error| Err(SweepError::Row(error)))
}

/// Computes missing parts and merges them unless sharded. `finished` counts the rows computed, even on failure.
fn complete(
    store: &Store<'_>,
    options: &Options,
    watch: &Watch<'_>,
    finished: &mut Finished,
) -> Result<(), SweepError> {
    store.open()?;
    let sweep = store.sweep;
    let (to_do, failed) = missing_parts(store, options.shard, options.fail_fast)?;
    let threads = threads(options.threads, rows_in(sweep, &to_do));
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(threads)
        .build()?;
    for parts in to_do.chunks(parts_at_once(threads, sweep.part_rows())) {
        let batches: Vec<_> = pool.install(|| {
            parts
                .par_iter()
                .map(|part| sweep.batch(sweep.rows_of(*part), watch))
                .collect()
        });
        // After an interruption, the parts that were finished before are kept.
        for (part, batch) in parts.iter().zip(batches) {
            let Some((batch, counts)) = batch else {
                finished.is_interrupted = true;
                continue;
            };
            if options.fail_fast {
                fail_on(counts.first_error.as_ref())?;
            }
            store.write(*part, &batch, &counts)?;
            finished.computed += batch.num_rows() as u64;
            finished.counts.add(counts);
        }
        if finished.is_interrupted {
            return Ok(());
        }
    }
    fail_on(failed.as_ref())?;
    if options.shard.is_none() {
        store.merge()?;
    }
    Ok(())
}

/// The number of parts to compute together, so that each thread has a few rows: parts of long runs have fewer rows than
/// a machine has threads.
fn parts_at_once(threads: usize, part_rows: u64) -> usize {
    let rows = usize::try_from(part_rows).unwrap_or(usize::MAX);
    threads.saturating_mul(2).div_ceil(rows)
}

/// Number of rows that are still to be computed; an error if the files belong to another sweep.
///
/// # Errors
/// As [`run`].
pub fn remaining_rows(
    sweep: &Sweep,
    table: &Path,
    shard: Option<Shard>,
) -> Result<u64, SweepError> {
    let store = Store::new(sweep, table)?;
    if store.finished()?.is_some() {
        return Ok(0);
    }
    store.check_parts()?;
    Ok(rows_in(sweep, &missing_parts(&store, shard, false)?.0))
}

/// The number of rows of some parts.
fn rows_in(sweep: &Sweep, parts: &[u64]) -> u64 {
    parts
        .iter()
        .map(|part| sweep.rows_of(*part))
        .map(|rows| rows.end - rows.start)
        .sum()
}

/// The missing parts of a shard, or of all, in order. With `fail_fast` it ends at the first part with a failed
/// row, whose error it returns.
///
/// # Errors
/// [`SweepError::File`] for a part of another sweep.
fn missing_parts(
    store: &Store<'_>,
    shard: Option<Shard>,
    fail_fast: bool,
) -> Result<(Vec<u64>, Option<RowError>), SweepError> {
    let mut missing = Vec::new();
    for part in 0..store.sweep.parts() {
        if shard.is_some_and(|shard| !shard.has(part)) {
            continue;
        }
        match store.counts(part)? {
            None => missing.push(part),
            Some(counts) if fail_fast && counts.first_error.is_some() => {
                return Ok((missing, counts.first_error));
            }
            Some(_) => {}
        }
    }
    Ok((missing, None))
}
