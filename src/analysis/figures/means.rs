//! Means of sampled numbers over each nutation.

use super::need::Missing;
use crate::analysis::plot::rows::{self, Rows};
use crate::analysis::plot::shape::Point;
use crate::telemetry::Message;
use crate::telemetry::fields::{NUTATION, NumberField, nutation};
use std::collections::VecDeque;

/// The most samples that are kept for the nutation that has not ended yet; when there are more, every other is dropped.
const MOST: usize = 1 << 16;

/// Means of some numbers of a channel, formed while the samples and the nutations come.
///
/// The numbers are integrated with straight lines between the samples. Only the samples of the nutation that has not ended
/// yet are kept.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Means {
    fields: &'static [NumberField],
    samples: VecDeque<Sample>,
    /// Nutations that end after the last sample: from and to, s.
    waiting: VecDeque<(f64, f64)>,
    means: Rows,
}

/// A sample of each number, and its integral up to there.
#[derive(Clone, Debug, PartialEq)]
struct Sample {
    time: f64,
    values: Vec<f64>,
    integrals: Vec<f64>,
}

impl Means {
    /// Means of numbers of one channel.
    pub(super) fn new(fields: &'static [NumberField]) -> Self {
        Self {
            fields,
            samples: VecDeque::new(),
            waiting: VecDeque::new(),
            means: Rows::new(fields.len(), rows::MOST, false),
        }
    }

    /// The numbers whose means are formed.
    pub(super) fn fields(&self) -> &'static [NumberField] {
        self.fields
    }

    /// Takes a message of any channel.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        if message.topic() == NUTATION {
            let start = nutation::START.of(message);
            let end = start + nutation::PERIOD.of(message);
            if end.is_finite() {
                self.waiting.push_back((start, end));
            }
        } else if self
            .fields
            .first()
            .is_some_and(|field| field.topic() == message.topic())
        {
            let values = self.fields.iter().map(|field| field.of(message));
            self.sample(message.time_ns as f64 / 1e9, values.collect());
            self.close(|end, time| end < time);
        }
    }

    /// Forms the means that still can be formed when no more samples come.
    pub(super) fn finish(&mut self) {
        self.close(|end, time| end <= time);
    }

    fn sample(&mut self, time: f64, values: Vec<f64>) {
        let integrals = match self.samples.back() {
            None => vec![0.0; values.len()],
            Some(last) => {
                let both = last.values.iter().zip(&values);
                let areas = both.map(|(a, b)| (time - last.time) * f64::midpoint(*a, *b));
                last.integrals
                    .iter()
                    .zip(areas)
                    .map(|(sum, area)| sum + area)
                    .collect()
            }
        };
        self.samples.push_back(Sample {
            time,
            values,
            integrals,
        });
        if self.samples.len() > MOST {
            let mut is_kept = false;
            self.samples.retain(|_| {
                is_kept = !is_kept;
                is_kept
            });
        }
    }

    /// Forms the means of the nutations that have ended at the last sample.
    fn close(&mut self, has_ended: impl Fn(f64, f64) -> bool) {
        while let (Some((from, to)), Some(last)) =
            (self.waiting.front().copied(), self.samples.back())
            && has_ended(to, last.time)
        {
            self.waiting.pop_front();
            let columns = 0..self.fields.len();
            let mean = |column| {
                Some((self.integral(column, to)? - self.integral(column, from)?) / (to - from))
            };
            let means: Option<Vec<f64>> = columns.map(mean).collect();
            if let Some(means) = means {
                self.means.push(f64::midpoint(from, to), means);
            }
            // The next nutation begins where this one ends, but for rounding.
            while self.samples.get(2).is_some_and(|sample| sample.time < to) {
                self.samples.pop_front();
            }
        }
    }

    /// The integral of a number from the first sample to a time; none if it isn't between samples.
    fn integral(&self, column: usize, time: f64) -> Option<f64> {
        let after = self.samples.partition_point(|sample| sample.time <= time);
        let start = self.samples.get(after.checked_sub(1)?)?;
        let (y0, integral) = (start.values[column], start.integrals[column]);
        let Some(end) = self.samples.get(after) else {
            return (time == start.time).then_some(integral);
        };
        let part = (time - start.time) / (end.time - start.time);
        let y = y0 + part * (end.values[column] - y0);
        Some(integral + (time - start.time) * f64::midpoint(y0, y))
    }

    /// What the run lacks, if anything.
    pub(super) fn missing(&self) -> Option<Missing> {
        let Some(last) = self.samples.back() else {
            return Some(Missing::Messages);
        };
        let mut fields = self.fields.iter().zip(&last.values);
        let absent = fields.find(|(_, value)| !value.is_finite());
        absent.map(|(field, _)| Missing::Field(*field))
    }

    /// The means of a number, in the middle of each nutation.
    pub(super) fn points(&self, field: NumberField) -> Vec<Point> {
        let column = self.fields.iter().position(|known| *known == field);
        column.map_or_else(Vec::new, |column| self.means.points(column).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_those_of_straight_lines() {
        let mut means = Means::new(&[nutation::CYCLE]);
        for (time, value) in [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)] {
            means.sample(time, vec![value]);
        }
        let found = [0.0, 0.5, 1.0, 1.5, 2.0].map(|time| means.integral(0, time));
        assert_eq!(found, [0.0, 0.25, 1.0, 2.0, 3.0].map(Some));
        let outside = [-0.1, 2.1].map(|time| means.integral(0, time));
        assert_eq!(outside, [None, None]);
    }

    #[test]
    fn a_mean_waits_for_the_sample_after_its_nutation() {
        let mut means = Means::new(&[nutation::CYCLE]);
        means.sample(0.0, vec![0.0]);
        means.waiting.extend([(0.0, 1.5), (1.5, 3.0)]);
        let is_over = |end: f64, time: f64| end < time;
        means.sample(1.0, vec![2.0]);
        means.close(is_over);
        assert!(means.means.is_empty());
        means.sample(2.0, vec![4.0]);
        means.sample(3.0, vec![6.0]);
        means.close(is_over);
        // The value is twice the time.
        assert_eq!(means.points(nutation::CYCLE), [(0.75, 1.5)]);
        means.finish();
        assert_eq!(means.points(nutation::CYCLE), [(0.75, 1.5), (2.25, 4.5)]);
    }

    #[test]
    fn samples_without_nutations_don_t_fill_memory() {
        let mut means = Means::new(&[nutation::CYCLE]);
        for time in 0..5 * MOST {
            means.sample(time as f64, vec![1.0]);
            assert!(means.samples.len() <= MOST + 1);
        }
        means.waiting.push_back((10.25, 1000.5));
        means.finish();
        assert_eq!(means.points(nutation::CYCLE), [(505.375, 1.0)]);
    }
}
