//! Rows of measured values, each counted once.

use super::error::DataError;
use super::reading::{SkipReason, SkippedRows};
use super::signal::{Lines, Signal, SignalRow, sort};
use super::spec::SignalSpec;
use std::path::Path;

/// Rows of a table, or messages of a topic.
pub(super) struct Rows<'a> {
    /// The file with the lines; `None` where there are none.
    path: Option<&'a Path>,
    kept: Vec<Row>,
    /// Number of rows without a time.
    pub without_time: u64,
    out_of_order: u64,
    left_out: Vec<SkippedRows>,
}

/// A row.
pub(super) struct Row {
    /// The line in the file, from 1; 0 where there are no lines.
    pub line: u64,
    /// The time, then the other cells, in SI units.
    pub cells: Vec<Option<f64>>,
}

impl Row {
    fn time(&self) -> f64 {
        self.cells[0].unwrap_or_default()
    }
}

impl<'a> Rows<'a> {
    pub(super) fn new(path: Option<&'a Path>) -> Self {
        Self {
            path,
            kept: Vec::new(),
            without_time: 0,
            out_of_order: 0,
            left_out: Vec::new(),
        }
    }

    pub(super) fn push(&mut self, row: Row) {
        if row.cells[0].is_some() {
            self.kept.push(row);
        } else {
            self.without_time += 1;
            self.leave_out(SkipReason::NoTime, row.line);
        }
    }

    fn leave_out(&mut self, reason: SkipReason, line: u64) {
        let known = self
            .left_out
            .iter_mut()
            .find(|known| known.reason == reason);
        match known {
            Some(known) => known.rows += 1,
            None => self.left_out.push(SkippedRows {
                reason,
                rows: 1,
                first_line: (line > 0).then_some(line),
            }),
        }
    }

    /// Sorts the rows by time, after the last one, and leaves out those that are equal to another.
    pub(super) fn complete(&mut self) {
        self.out_of_order = sort(&mut self.kept, Row::time);
        let mut kept: Vec<Row> = Vec::with_capacity(self.kept.len());
        for row in std::mem::take(&mut self.kept) {
            let mut same_time = kept
                .iter()
                .rev()
                .take_while(|known| known.time() == row.time());
            if same_time.any(|known| known.cells == row.cells) {
                self.leave_out(SkipReason::Repeated, row.line);
            } else {
                kept.push(row);
            }
        }
        self.kept = kept;
    }

    /// The rows that don't count.
    pub(super) fn left_out(&self) -> Vec<SkippedRows> {
        self.left_out.clone()
    }

    /// The signal whose values are the cells with an index, with those of its standard deviations; `None` without values.
    pub(super) fn signal(
        &self,
        spec: &SignalSpec,
        file: usize,
        values: usize,
        sigmas: Option<usize>,
    ) -> Result<Option<Signal>, DataError> {
        let mut rows = Vec::new();
        for row in &self.kept {
            let sigma = sigmas.map(|at| row.cells[at]);
            let (Some(value), None | Some(Some(_))) = (row.cells[values], sigma) else {
                continue;
            };
            let sigma = sigma.flatten();
            if let Some(sigma) = sigma.filter(|sigma| *sigma <= 0.0) {
                let problem = format!("the standard deviation {sigma} is not positive");
                return Err(self.in_file(DataError::new(problem).in_line(row.line)));
            }
            rows.push(SignalRow {
                time: row.time(),
                value,
                sigma,
                line: row.line,
            });
        }
        if rows.is_empty() {
            return Ok(None);
        }
        let missing = self.without_time + (self.kept.len() - rows.len()) as u64;
        let signal = Signal::new(spec, file, &rows).map_err(|error| self.in_file(error))?;
        Ok(Some(Signal {
            missing,
            out_of_order: self.out_of_order,
            lines: self.path.map(|path| Lines {
                path: path.to_owned(),
                numbers: rows.iter().map(|row| row.line).collect(),
            }),
            ..signal
        }))
    }

    fn in_file(&self, error: DataError) -> DataError {
        match self.path {
            Some(path) => error.in_file(path),
            None => error,
        }
    }
}

/// The zero of times that count from an epoch, such as 1970: the first of them in all files. As doubles they would have no
/// fraction of a microsecond.
#[derive(Default)]
pub(super) struct Epoch {
    first_ns: Option<i128>,
}

impl Epoch {
    /// Seconds since the first time, ns.
    pub(super) fn seconds(&mut self, time_ns: i128) -> f64 {
        let first = *self.first_ns.get_or_insert(time_ns);
        (time_ns - first) as f64 / 1e9
    }
}
