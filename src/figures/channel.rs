//! Numbers of a channel over time, and their means over nutations.

use super::sampling::ENOUGH;
use crate::figures::plot::rows::{MOST, Rows};
use crate::figures::plot::shape::Point;
use crate::run::time::seconds;
use crate::telemetry::fields::{NUTATION, NumberField, POSE, acceleration as terms, nutation};
use crate::telemetry::{Message, Topic};
use std::collections::VecDeque;

/// Number of nutations averaged together where a nutation has too few samples. It divides the error of the integral at
/// both ends, a few hundredths of the ripple.
const TOGETHER: u32 = 50;

/// Numbers whose integrals since the start are recorded too.
const INTEGRATED: [[NumberField; 2]; 3] = [
    [terms::PHI_DDOT_GYROSCOPIC, terms::PHI_DOT_GYROSCOPIC],
    [terms::PHI_DDOT_CORIOLIS, terms::PHI_DOT_CORIOLIS],
    [terms::PHI_DDOT_FRICTIONAL, terms::PHI_DOT_FRICTIONAL],
];

/// Numbers of a channel over time, and means of some of them over each nutation, computed as samples and nutations
/// arrive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Channel {
    pub(super) topic: Topic,
    fields: Vec<NumberField>,
    /// Columns to average. Their integrals since the start are in further columns.
    averaged: Vec<usize>,
    pub(super) rows: Rows,
    /// Nutations that end after the last sample: from and to, s.
    waiting: VecDeque<(f64, f64)>,
    /// Nutations that are averaged together, and how many there are.
    group: Option<(f64, f64, u32)>,
    means: Rows,
}

impl Channel {
    pub(super) fn new(
        topic: Topic,
        mut fields: Vec<NumberField>,
        averaged: &[NumberField],
    ) -> Self {
        fields.sort_unstable_by_key(|field| field.index());
        fields.dedup();
        let is_averaged = |column: &usize| averaged.contains(&fields[*column]);
        let averaged: Vec<_> = (0..fields.len()).filter(is_averaged).collect();
        // A locus needs enough points to look smooth.
        let most = if topic == POSE { 2 * MOST } else { MOST };
        let columns = fields.len() + averaged.len();
        Self {
            rows: Rows::new(columns, most, topic != NUTATION),
            means: Rows::new(averaged.len(), MOST, false),
            topic,
            fields,
            averaged,
            waiting: VecDeque::new(),
            group: None,
        }
    }

    /// Adds a message of any channel.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        if message.topic() == self.topic {
            let values = self.fields.iter().map(|field| field.of(message));
            let values = values.collect();
            let time = seconds(message.time_ns);
            self.push(time, values, |field| field.of(message));
        } else if message.topic() == NUTATION && !self.averaged.is_empty() {
            let start = nutation::START.of(message);
            let end = start + nutation::PERIOD.of(message);
            if end.is_finite() {
                self.waiting.push_back((start, end));
            }
        }
    }

    /// Adds the values of the fields at a time, with integrals: those that are recorded, or of straight lines between
    /// the samples.
    fn push(&mut self, time: f64, mut values: Vec<f64>, recorded: impl Fn(NumberField) -> f64) {
        for (index, column) in self.averaged.iter().enumerate() {
            let known = INTEGRATED
                .iter()
                .find(|known| known[0] == self.fields[*column]);
            let known = known.map(|[_, integral]| recorded(*integral));
            let [value, sum] = [*column, self.fields.len() + index].map(|at| self.rows.last(at));
            let ahead = value.zip(sum).map(|((before, value), (_, sum))| {
                sum + (time - before) * f64::midpoint(value, values[*column])
            });
            let known = known.filter(|integral| integral.is_finite());
            values.push(known.or(ahead).unwrap_or(0.0));
        }
        self.rows.push(time, values);
        self.close(|end| end < time);
    }

    /// Computes the remaining means after the last sample.
    pub(super) fn finish(&mut self) {
        if let Some((last, _)) = self.rows.last(0) {
            self.close(|end| end <= last);
        }
        if let Some((from, to, _)) = self.group.take() {
            self.mean(from, to);
        }
    }

    /// Computes the means of the completed nutations.
    fn close(&mut self, has_ended: impl Fn(f64) -> bool) {
        while let Some((from, to)) = self.waiting.pop_front_if(|(_, to)| has_ended(*to)) {
            let (from, to, count) = match self.group.take() {
                Some((start, end, count)) if from - end < 0.5 * (to - from) => {
                    (start, to, count + 1)
                }
                _ => (from, to, 1),
            };
            let is_fine = (to - from) / f64::from(count) >= ENOUGH * self.rows.step();
            if is_fine || count >= TOGETHER {
                self.mean(from, to);
            } else {
                self.group = Some((from, to, count));
            }
        }
    }

    /// Computes the means over a time interval.
    fn mean(&mut self, from: f64, to: f64) {
        let mean =
            |index| Some((self.integral(index, to)? - self.integral(index, from)?) / (to - from));
        let means: Option<Vec<f64>> = (0..self.averaged.len()).map(mean).collect();
        if let Some(means) = means {
            self.means.push(f64::midpoint(from, to), means);
        }
    }

    /// The integral of an averaged number up to a time; `None` if that isn't between samples.
    ///
    /// Between two samples it is the cubic with the integrals and the numbers at both as values and slopes.
    fn integral(&self, index: usize, time: f64) -> Option<f64> {
        let after = self.rows.until(time);
        let sample = |row: usize| {
            let (time, value) = self.rows.point(self.averaged[index], row)?;
            let (_, integral) = self.rows.point(self.fields.len() + index, row)?;
            Some((time, value, integral))
        };
        let (start, first, before) = sample(after.checked_sub(1)?)?;
        let Some((end, last, after)) = sample(after) else {
            return (time == start).then_some(before);
        };
        let part = (time - start) / (end - start);
        let rise = after - before;
        let [first, last] = [first, last].map(|value| (end - start) * value - rise);
        let bend = part * (1.0 - part) * ((1.0 - part) * first - part * last);
        Some(before + part * rise + bend)
    }

    /// A number over time. Missing samples are NaN points.
    pub(super) fn series(&self, field: NumberField) -> Vec<Point> {
        let column = self.fields.iter().position(|known| *known == field);
        column.map_or_else(Vec::new, |column| self.rows.points(column).collect())
    }

    /// The mean over each nutation of a number, in the middle of the nutation.
    pub(super) fn means(&self, field: NumberField) -> Vec<Point> {
        let mut averaged = self.averaged.iter();
        let index = averaged.position(|column| self.fields[*column] == field);
        index.map_or_else(Vec::new, |index| self.means.points(index).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: NumberField = terms::PHI_DDOT_CORIOLIS;

    /// A channel with one number, averaged over some nutations.
    fn channel(nutations: impl IntoIterator<Item = (f64, f64)>) -> Channel {
        let mut channel = Channel::new(FIELD.topic(), vec![FIELD], &[FIELD]);
        channel.waiting.extend(nutations);
        channel
    }

    #[test]
    fn integrals_are_those_of_straight_lines() {
        let mut channel = channel([]);
        for (time, value) in [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)] {
            channel.push(time, vec![value], |_| f64::NAN);
        }
        let found = [0.0, 0.5, 1.0, 1.5, 2.0].map(|time| channel.integral(0, time));
        assert_eq!(found, [0.0, 0.25, 1.0, 2.0, 3.0].map(Some));
        let outside = [-0.1, 2.1].map(|time| channel.integral(0, time));
        assert_eq!(outside, [None, None]);
    }

    #[test]
    fn a_mean_waits_for_the_sample_after_its_nutation() {
        let mut channel = channel([(0.0, 1.5), (1.5, 3.0)]);
        for time in (0..=48).map(|step| f64::from(step) / 16.0) {
            channel.push(time, vec![2.0 * time], |_| f64::NAN);
            assert_eq!(channel.means(FIELD).is_empty(), time <= 1.5);
        }
        assert_eq!(channel.means(FIELD), [(0.75, 1.5)]);
        channel.finish();
        assert_eq!(channel.means(FIELD), [(0.75, 1.5), (2.25, 4.5)]);
    }

    #[test]
    fn there_is_no_mean_where_samples_are_missing() {
        let mut channel = channel((0..4).map(f64::from).map(|start| (start, start + 1.0)));
        let is_missing = |time: &f64| *time > 1.5 && *time < 2.5;
        let times = (0..=100).map(|step| f64::from(step) / 25.0);
        for time in times.filter(|time| !is_missing(time)) {
            channel.push(time, vec![1.0], |_| f64::NAN);
        }
        channel.finish();
        let means = channel.means(FIELD).into_iter();
        let is_there: Vec<_> = means.map(|(_, mean)| mean.is_finite()).collect();
        assert_eq!(is_there, [true, false, false, true]);
    }

    #[test]
    fn nutations_with_few_samples_are_averaged_together() {
        let mut channel = channel((0..120).map(f64::from).map(|start| (start, start + 1.0)));
        for time in (0..=480).map(|step| f64::from(step) / 4.0) {
            channel.push(time, vec![2.0 * time], |_| f64::NAN);
        }
        channel.finish();
        let found = channel.means(FIELD);
        assert_eq!(found, [(25.0, 50.0), (75.0, 150.0), (110.0, 220.0)]);
    }

    #[test]
    fn recorded_integrals_are_taken_for_those_of_the_samples() {
        let mut channel = channel([]);
        // The integral of sin t from 0 is 1 − cos t, regardless of missing samples.
        for time in (0..8).map(f64::from) {
            let (sin, cos) = crate::physics::math::sin_cos(time);
            channel.push(time, vec![sin], |_| 1.0 - cos);
        }
        let (_, cos) = crate::physics::math::sin_cos(2.5);
        let found = channel.integral(0, 2.5).unwrap();
        assert!((found - (1.0 - cos)).abs() < 0.003, "{found}");
    }

    #[test]
    fn means_of_runs_with_many_samples_are_as_exact() {
        let count = 5 * u32::try_from(MOST).unwrap();
        let nutations = (0..count / 40).map(|start| 2.5 * f64::from(start) + 0.125);
        let mut channel = channel(nutations.map(|start| (start, start + 2.5)));
        let middle = |step: u32| 1.0 + f64::from(step / 40);
        for step in 0..=count {
            // A wave around a staircase; each nutation begins in the middle of a step.
            let wave = 1e3
                * crate::physics::math::sin_cos(
                    0.8 * std::f64::consts::PI * f64::from(step) / 16.0,
                )
                .0;
            channel.push(f64::from(step) / 16.0, vec![middle(step) + wave], |_| {
                f64::NAN
            });
        }
        channel.finish();
        let means = channel.means(FIELD);
        for pair in means.windows(2) {
            let slope = (pair[1].1 - pair[0].1) / (pair[1].0 - pair[0].0);
            assert!((slope - 0.4).abs() < 0.2, "{pair:?}");
        }
    }
}
