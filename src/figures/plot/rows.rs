//! Time series with automatic decimation, so that memory is bounded by the display resolution, not the run length.

use super::decimate::envelope;
use super::shape::Point;
use std::iter;

/// Maximum number of rows kept for curves over time: enough for several bins per pixel column.
pub(crate) const MOST: usize = 1 << 17;

/// The last part of the time that is kept finer, so that it can be drawn magnified.
pub(crate) const END: f64 = 0.02;

/// The number of bins in the last part for a bin of the same width elsewhere. Means of nutations that have just ended need
/// it, too.
const FINER: f64 = 16.0;

/// The width of the narrowest bins, s: a nanosecond, rounded down to a power of two.
const NARROWEST: f64 = 1.0 / (1_u64 << 30) as f64;

/// Maximum step between two samples, as a multiple of the shortest step; a longer step is a gap.
const LONGEST_STEP: f64 = 1.5;

/// Columns of numbers with a common time.
///
/// When there are too many rows, time is divided into bins. Each bin keeps its first and its last row, and for each
/// column the rows with the least and the greatest value, so that envelopes survive. Bin widths are powers of two, so
/// repeated thinning equals thinning once.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Rows {
    times: Vec<f64>,
    columns: Vec<Vec<f64>>,
    /// Maximum number of rows.
    most: usize,
    /// Whether the rows are equally spaced samples, so that a longer step is a gap.
    are_samples: bool,
    /// The shortest step between two rows, s.
    step: f64,
    /// The width of bins, s.
    width: f64,
}

impl Rows {
    /// An empty table with this number of columns, which keeps at most this number of rows.
    pub(crate) fn new(columns: usize, most: usize, are_samples: bool) -> Self {
        Self {
            most,
            times: Vec::new(),
            columns: vec![Vec::new(); columns],
            are_samples,
            step: f64::INFINITY,
            width: NARROWEST,
        }
    }

    /// Adds a row. Times increase from row to row. Missing samples are rows of NaN.
    pub(crate) fn push(&mut self, time: f64, values: impl IntoIterator<Item = f64>) {
        if let Some(last) = self.times.last().copied() {
            let step = time - last;
            if self.are_samples && step > LONGEST_STEP * self.step {
                self.add(f64::midpoint(last, time), iter::repeat(f64::NAN));
            }
            self.step = self.step.min(step);
        }
        self.add(time, values);
        if self.times.len() >= self.most {
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
    pub(crate) fn coarseness(&self) -> f64 {
        2.0 * self.width
    }

    /// The points of a column.
    pub(crate) fn points(&self, column: usize) -> impl Iterator<Item = Point> {
        let values = self.columns[column].iter().copied();
        self.times.iter().copied().zip(values)
    }

    /// The number of rows up to a time.
    pub(crate) fn until(&self, time: f64) -> usize {
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
        while self.width * (self.most as f64) < last - first {
            self.width *= 2.0;
        }
        loop {
            let kept = self.kept();
            let pick =
                |values: &mut Vec<f64>| *values = kept.iter().map(|row| values[*row]).collect();
            pick(&mut self.times);
            self.columns.iter_mut().for_each(pick);
            if self.times.len() <= self.most / 2 {
                break;
            }
            self.width *= 2.0;
        }
    }

    /// The rows to keep.
    fn kept(&self) -> Vec<usize> {
        let (first, last) = (self.times[0], self.times[self.times.len() - 1]);
        let end = last - END * (last - first);
        let bin = |time: f64| {
            let is_end = time >= end;
            let bins = if is_end { FINER } else { 1.0 };
            (is_end, (time / self.width * bins).floor())
        };
        let is_gap = |row: &usize| self.columns.iter().all(|column| column[*row].is_nan());
        let mut kept = Vec::new();
        let mut from = 0;
        for bin in self.times.chunk_by(|a, b| bin(*a) == bin(*b)) {
            let rows = from..from + bin.len();
            let columns = self.columns.iter().map(|column| |row: usize| column[row]);
            let mut of_bin = envelope(rows.clone(), columns);
            let mut gaps = rows.filter(is_gap);
            of_bin.extend(gaps.next().into_iter().chain(gaps.next_back()));
            of_bin.sort_unstable();
            of_bin.dedup();
            kept.extend(of_bin);
            from += bin.len();
        }
        kept
    }
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
    fn few_rows_stay_as_they_are() {
        let mut rows = Rows::new(1, MOST, true);
        let points: Vec<Point> = (0..MOST - 1).map(|i| (i as f64, wave(0, i))).collect();
        for (time, value) in &points {
            rows.push(*time, [*value]);
        }
        assert!(rows.points(0).eq(points));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(6))]

        #[test]
        fn memory_is_bounded_and_envelopes_survive(seed in 0_u64..1000, count in 200_000_usize..1_000_000) {
            let mut rows = Rows::new(2, MOST, true);
            let points: Vec<Vec<Point>> = [seed, seed + 1]
                .map(|seed| (0..count).map(|i| (i as f64 * 1e-3, wave(seed, i))).collect())
                .into();
            for (first, second) in points[0].iter().zip(&points[1]) {
                rows.push(first.0, [first.1, second.1]);
                prop_assert!(rows.times.len() < MOST);
            }
                prop_assert!(rows.times.is_sorted());
            let bins = count as f64 * 1e-3 / rows.width;
            prop_assert!(bins > 2000.0, "{bins} bins");
            // Columns of pixels into which the bins fit: they look as if nothing had been thinned.
            let width = 4.0 * rows.width;
            for (column, points) in points.iter().enumerate() {
                let thinned = by_column(rows.points(column), width);
                prop_assert!(thinned == by_column(points.iter().copied(), width));
            }
        }
    }

    #[test]
    fn gaps_stay() {
        let mut rows = Rows::new(1, MOST, true);
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
    fn the_end_stays_finer() {
        let mut rows = Rows::new(1, MOST, true);
        for i in 0..2_000_000 {
            rows.push(i as f64, [wave(0, i)]);
        }
        let is_end = |time: &&f64| **time >= 1_960_000.0;
        let (end, all) = (rows.times.iter().filter(is_end).count(), rows.times.len());
        assert!(end as f64 > 4.0 * END * all as f64, "{end} of {all}");
    }
}
