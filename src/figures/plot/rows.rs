//! Time series with automatic decimation, so that memory is bounded by the display resolution, not the run length.

use super::decimate::envelope;
use super::shape::Point;
use std::iter;
use std::ops::Range;

/// Maximum number of rows kept for curves over time: enough for several bins per pixel column.
pub(crate) const MAX_ROWS: usize = 1 << 17;

/// The last part of the time that is kept finer, so that it can be drawn magnified.
pub(crate) const END: f64 = 0.02;

/// The number of bins in the last part for a bin of the same width elsewhere. Means of nutations that have just ended
/// need it, too.
const FINER: f64 = 16.0;

/// The width of the narrowest bins, s: a nanosecond, rounded down to a power of two.
const MIN_BIN_WIDTH: f64 = 1.0 / (1_u64 << 30) as f64;

/// Maximum step between two samples, as a multiple of the shortest step; a longer step is a gap.
const MAX_STEP: f64 = 1.5;

/// Columns of numbers with a common time.
///
/// When there are too many rows, time is divided into bins. Each bin keeps its first and its last row, and for each
/// column the rows with the least and the greatest value, so that envelopes survive. Bin widths are powers of two, so
/// repeated thinning equals thinning once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows {
    times: Vec<f64>,
    columns: Vec<Vec<f64>>,
    max_len: usize,
    /// Whether the rows are equally spaced samples, so that a longer step is a gap.
    are_samples: bool,
    /// The shortest step between two rows, s.
    step: f64,
    /// The width of bins, s.
    bin_width: f64,
}

impl Rows {
    /// An empty table with this number of columns, which keeps at most this number of rows.
    pub(crate) fn new(columns: usize, max_len: usize, are_samples: bool) -> Self {
        Self {
            max_len,
            times: Vec::new(),
            columns: vec![Vec::new(); columns],
            are_samples,
            step: f64::INFINITY,
            bin_width: MIN_BIN_WIDTH,
        }
    }

    /// Adds a row. Times increase from row to row. Missing samples are rows of NaN.
    pub(crate) fn push(&mut self, time: f64, values: impl IntoIterator<Item = f64>) {
        if let Some(last) = self.times.last().copied() {
            let step = time - last;
            if self.are_samples && step > MAX_STEP * self.step {
                self.add(f64::midpoint(last, time), iter::repeat(f64::NAN));
            }
            self.step = self.step.min(step);
        }
        self.add(time, values);
        if self.times.len() >= self.max_len {
            self.thin();
        }
    }

    fn add(&mut self, time: f64, values: impl IntoIterator<Item = f64>) {
        self.times.push(time);
        for (column, value) in self.columns.iter_mut().zip(values) {
            column.push(value);
        }
    }

    /// Whether there are no rows.
    pub(crate) fn is_empty(&self) -> bool {
        self.times.is_empty()
    }

    /// The shortest time between two rows, s; infinite if there are fewer.
    pub(crate) fn step(&self) -> f64 {
        self.step
    }

    /// The longest time between two rows of which intermediate rows may have been dropped, s.
    pub(crate) fn max_thinned_step(&self) -> f64 {
        2.0 * self.bin_width
    }

    /// The points of a column.
    pub(crate) fn points(&self, column: usize) -> impl Iterator<Item = Point> {
        let values = self.columns[column].iter().copied();
        self.times.iter().copied().zip(values)
    }

    /// The number of rows up to a time.
    pub(crate) fn count_until(&self, time: f64) -> usize {
        self.times.partition_point(|other| *other <= time)
    }

    /// The point of a column in a row.
    pub(crate) fn point(&self, column: usize, row: usize) -> Option<Point> {
        Some((*self.times.get(row)?, *self.columns[column].get(row)?))
    }

    /// The last point of a column.
    pub(crate) fn last(&self, column: usize) -> Option<Point> {
        self.point(column, self.times.len().checked_sub(1)?)
    }

    /// Reduces the rows to at most half, widening the bins if necessary.
    fn thin(&mut self) {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        while self.bin_width * (self.max_len as f64) < last - first {
            self.bin_width *= 2.0;
        }
        // Down to half, so that thinning is rare and its cost per row is constant.
        loop {
            let kept = self.rows_to_keep();
            self.times = pick(&self.times, &kept);
            for column in &mut self.columns {
                *column = pick(column, &kept);
            }
            if self.times.len() <= self.max_len / 2 {
                break;
            }
            self.bin_width *= 2.0;
        }
    }

    /// The rows that thinning keeps.
    fn rows_to_keep(&self) -> Vec<usize> {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let end = last - END * (last - first);
        let mut kept = Vec::new();
        let mut start = 0;
        for bin in self
            .times
            .chunk_by(|a, b| self.bin(*a, end) == self.bin(*b, end))
        {
            kept.extend(self.rows_to_keep_of_bin(start..start + bin.len()));
            start += bin.len();
        }
        kept
    }

    /// The number of the bin of a time, and whether that is in the finer part, which starts at `end`.
    fn bin(&self, time: f64, end: f64) -> (bool, f64) {
        let is_end = time >= end;
        let finer = if is_end { FINER } else { 1.0 };
        (is_end, (time / self.bin_width * finer).floor())
    }

    fn rows_to_keep_of_bin(&self, rows: Range<usize>) -> Vec<usize> {
        let columns = self.columns.iter().map(|column| |row: usize| column[row]);
        let mut kept = envelope(rows.clone(), columns);
        // The envelope skips NaN, so gaps would be lost within a bin.
        let mut gaps = rows.filter(|row| self.is_gap(*row));
        kept.extend(gaps.next());
        kept.extend(gaps.next_back());
        kept.sort_unstable();
        kept.dedup();
        kept
    }

    fn is_gap(&self, row: usize) -> bool {
        self.columns.iter().all(|column| column[row].is_nan())
    }
}

fn pick(values: &[f64], rows: &[usize]) -> Vec<f64> {
    rows.iter().map(|row| values[*row]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figures::plot::decimate::by_column;
    use proptest::prelude::*;

    /// A reproducible wave: a fast oscillation on a slow one, varied by `seed`.
    fn wave(seed: u64, sample: usize) -> f64 {
        let noise = (sample as u64).wrapping_mul(6_364_136_223_846_793_005 + 2 * seed) >> 40;
        let slow = (sample as f64 / 3e5 - 0.5).abs();
        slow + 0.1 * f64::from((sample % 40) as u32) + noise as f64 / (1 << 28) as f64
    }

    #[test]
    fn keeps_few_rows_unchanged() {
        let mut rows = Rows::new(1, MAX_ROWS, true);
        let points: Vec<Point> = (0..MAX_ROWS - 1).map(|i| (i as f64, wave(0, i))).collect();
        for (time, value) in &points {
            rows.push(*time, [*value]);
        }
        assert!(rows.points(0).eq(points));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(6))]

        #[test]
        fn thinning_bounds_memory_and_keeps_envelopes(seed in 0_u64..1000, count in 200_000_usize..1_000_000) {
            let mut rows = Rows::new(2, MAX_ROWS, true);
            let points: Vec<Vec<Point>> = [seed, seed + 1]
                .map(|seed| (0..count).map(|i| (i as f64 * 1e-3, wave(seed, i))).collect())
                .into();
            for (first, second) in points[0].iter().zip(&points[1]) {
                rows.push(first.0, [first.1, second.1]);
                prop_assert!(rows.times.len() < MAX_ROWS);
            }
                prop_assert!(rows.times.is_sorted());
            let bins = count as f64 * 1e-3 / rows.bin_width;
            prop_assert!(bins > 2000.0, "{bins} bins");
            // Columns of pixels into which the bins fit: they look as if nothing had been thinned.
            let width = 4.0 * rows.bin_width;
            for (column, points) in points.iter().enumerate() {
                let thinned = by_column(rows.points(column), width);
                prop_assert!(thinned == by_column(points.iter().copied(), width));
            }
        }
    }

    #[test]
    fn thinning_keeps_gaps() {
        let mut rows = Rows::new(1, MAX_ROWS, true);
        let is_missing = |i: usize| (170_000..171_000).contains(&i) || i == 5;
        for i in (0..500_000).filter(|i| !is_missing(*i)) {
            rows.push(i as f64, [wave(0, i)]);
        }
        let gaps: Vec<f64> = rows
            .points(0)
            .filter(|(_, value)| value.is_nan())
            .map(|(time, _)| time)
            .collect();
        assert_eq!(gaps, [5.0, 170_499.5]);
    }

    #[test]
    fn thinning_keeps_the_end_finer() {
        let mut rows = Rows::new(1, MAX_ROWS, true);
        for i in 0..2_000_000 {
            rows.push(i as f64, [wave(0, i)]);
        }
        let is_end = |time: &&f64| **time >= 1_960_000.0;
        let (end, all) = (rows.times.iter().filter(is_end).count(), rows.times.len());
        assert!(end as f64 > 4.0 * END * all as f64, "{end} of {all}");
    }
}
