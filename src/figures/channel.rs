//! Numbers of a channel over time, and their means over nutations.

use super::sampling::MIN_PER_NUTATION;
use crate::figures::plot::rows::{MAX_ROWS, Rows};
use crate::figures::plot::shape::Point;
use crate::run::time::seconds;
use crate::telemetry::fields::{NUTATION, NumberField, POSE, acceleration as terms, nutation};
use crate::telemetry::{Message, Topic};
use std::collections::VecDeque;

/// Number of nutations averaged together where a nutation has too few samples. It divides the error of the integral at
/// both ends, a few hundredths of the ripple.
const MAX_GROUP: u32 = 50;

/// Numbers whose integrals since the start are recorded too.
const INTEGRATED: [[NumberField; 2]; 3] = [
    [terms::PHI_DDOT_GYROSCOPIC, terms::PHI_DOT_GYROSCOPIC],
    [terms::PHI_DDOT_CORIOLIS, terms::PHI_DOT_CORIOLIS],
    [terms::PHI_DDOT_FRICTIONAL, terms::PHI_DOT_FRICTIONAL],
];

/// The field with the recorded integral of another.
fn recorded_integral(field: NumberField) -> Option<NumberField> {
    INTEGRATED
        .iter()
        .find(|[integrand, _]| *integrand == field)
        .map(|[_, integral]| *integral)
}

/// Numbers of a channel over time, and means of some of them over each nutation, computed as samples and nutations
/// arrive.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct ChannelData {
    pub(super) topic: Topic,
    fields: Vec<NumberField>,
    /// Columns to average. Their integrals since the start are in further columns.
    averaged: Vec<usize>,
    pub(super) rows: Rows,
    /// Nutations that end after the last sample: from and to, s.
    pending: VecDeque<(f64, f64)>,
    group: Option<AveragedNutations>,
    means: Rows,
}

/// Consecutive nutations that are averaged together.
#[derive(Clone, Copy, Debug, PartialEq)]
struct AveragedNutations {
    /// The start of the first, s.
    from: f64,
    /// The end of the last, s.
    to: f64,
    count: u32,
}

/// An averaged number and its integral since the start, at a sample.
struct IntegralSample {
    time: f64,
    value: f64,
    integral: f64,
}

impl ChannelData {
    pub(super) fn new(
        topic: Topic,
        mut fields: Vec<NumberField>,
        averaged: &[NumberField],
    ) -> Self {
        // Several figures need the same fields.
        fields.sort_unstable_by_key(|field| field.index());
        fields.dedup();
        let averaged: Vec<usize> = (0..fields.len())
            .filter(|column| averaged.contains(&fields[*column]))
            .collect();
        // A locus needs enough points to look smooth.
        let max_rows = if topic == POSE {
            2 * MAX_ROWS
        } else {
            MAX_ROWS
        };
        Self {
            rows: Rows::new(fields.len() + averaged.len(), max_rows, topic != NUTATION),
            means: Rows::new(averaged.len(), MAX_ROWS, false),
            topic,
            fields,
            averaged,
            pending: VecDeque::new(),
            group: None,
        }
    }

    /// Adds a message of any channel.
    pub(super) fn add(&mut self, message: &Message<'_>) {
        if message.topic() == self.topic {
            let values = self.fields.iter().map(|field| field.of(message)).collect();
            let time = seconds(message.time_ns);
            self.push(time, values, |field| field.of(message));
        } else if message.topic() == NUTATION && !self.averaged.is_empty() {
            let start = nutation::START.of(message);
            let end = start + nutation::PERIOD.of(message);
            // NaN if a recording lacks the fields.
            if end.is_finite() {
                self.pending.push_back((start, end));
            }
        }
    }

    /// Adds the values of the fields at a time, with their integrals. `recorded` returns the value of another field.
    fn push(&mut self, time: f64, mut values: Vec<f64>, recorded: impl Fn(NumberField) -> f64) {
        for index in 0..self.averaged.len() {
            let integral = recorded_integral(self.fields[self.averaged[index]])
                .map(&recorded)
                .filter(|integral| integral.is_finite())
                .unwrap_or_else(|| self.next_integral(index, time, &values));
            values.push(integral);
        }
        self.rows.push(time, values);
        self.average_completed(|end| end < time);
    }

    /// The integral of an averaged number up to the next sample, along straight lines between the samples.
    fn next_integral(&self, index: usize, time: f64, values: &[f64]) -> f64 {
        let column = self.averaged[index];
        let last = self.rows.last(column);
        let last_integral = self.rows.last(self.integral_column(index));
        let (Some((last_time, last_value)), Some((_, integral))) = (last, last_integral) else {
            return 0.0;
        };
        integral + (time - last_time) * f64::midpoint(last_value, values[column])
    }

    fn integral_column(&self, index: usize) -> usize {
        self.fields.len() + index
    }

    /// Computes the remaining means after the last sample.
    pub(super) fn finish(&mut self) {
        if let Some((last, _)) = self.rows.last(0) {
            self.average_completed(|end| end <= last);
        }
        if let Some(group) = self.group.take() {
            self.push_means(group);
        }
    }

    /// Computes the means of nutations that have ended.
    fn average_completed(&mut self, has_ended: impl Fn(f64) -> bool) {
        while let Some((from, to)) = self.pending.pop_front_if(|(_, to)| has_ended(*to)) {
            let group = match self.group.take() {
                Some(group) if from - group.to < 0.5 * (to - from) => AveragedNutations {
                    to,
                    count: group.count + 1,
                    ..group
                },
                // Nutation was interrupted: the earlier group is too short for a mean.
                _ => AveragedNutations { from, to, count: 1 },
            };
            let period = (group.to - group.from) / f64::from(group.count);
            // The shortest step so far is that of the samples; a single sample has none.
            let is_fine = period >= MIN_PER_NUTATION * self.rows.step();
            if is_fine || group.count >= MAX_GROUP {
                self.push_means(group);
            } else {
                self.group = Some(group);
            }
        }
    }

    /// Adds the means over a group of nutations, unless samples are missing.
    fn push_means(&mut self, AveragedNutations { from, to, .. }: AveragedNutations) {
        let mut means = Vec::new();
        for index in 0..self.averaged.len() {
            let ends = self.integral(index, to).zip(self.integral(index, from));
            let Some((after, before)) = ends else {
                return;
            };
            means.push((after - before) / (to - from));
        }
        self.means.push(f64::midpoint(from, to), means);
    }

    /// The integral of an averaged number up to a time; `None` if that isn't between samples.
    ///
    /// Between two samples it is the cubic with the integrals and the numbers at both as values and slopes.
    fn integral(&self, index: usize, time: f64) -> Option<f64> {
        let next = self.rows.count_until(time);
        let start = self.integral_sample(index, next.checked_sub(1)?)?;
        let Some(end) = self.integral_sample(index, next) else {
            return (time == start.time).then_some(start.integral);
        };
        let duration = end.time - start.time;
        let part = (time - start.time) / duration;
        let rise = end.integral - start.integral;
        let [first, last] = [start.value, end.value].map(|value| duration * value - rise);
        let bend = part * (1.0 - part) * ((1.0 - part) * first - part * last);
        Some(start.integral + part * rise + bend)
    }

    fn integral_sample(&self, index: usize, row: usize) -> Option<IntegralSample> {
        let (time, value) = self.rows.point(self.averaged[index], row)?;
        let (_, integral) = self.rows.point(self.integral_column(index), row)?;
        Some(IntegralSample {
            time,
            value,
            integral,
        })
    }

    /// A number over time. Missing samples are NaN points.
    pub(super) fn series(&self, field: NumberField) -> Vec<Point> {
        self.fields
            .iter()
            .position(|known| *known == field)
            .map_or_else(Vec::new, |column| self.rows.points(column).collect())
    }

    /// The mean over each nutation of a number, in the middle of the nutation.
    pub(super) fn means(&self, field: NumberField) -> Vec<Point> {
        self.averaged
            .iter()
            .position(|column| self.fields[*column] == field)
            .map_or_else(Vec::new, |index| self.means.points(index).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FIELD: NumberField = terms::PHI_DDOT_CORIOLIS;

    /// A channel with one number, averaged over some nutations.
    fn channel(nutations: impl IntoIterator<Item = (f64, f64)>) -> ChannelData {
        let mut channel = ChannelData::new(FIELD.topic(), vec![FIELD], &[FIELD]);
        channel.pending.extend(nutations);
        channel
    }

    #[test]
    fn integrates_straight_lines_exactly() {
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
    fn means_wait_for_the_sample_after_a_nutation() {
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
    fn skips_means_where_samples_are_missing() {
        let mut channel = channel((0..4).map(f64::from).map(|start| (start, start + 1.0)));
        for time in (0..=100).map(|step| f64::from(step) / 25.0) {
            if time <= 1.5 || time >= 2.5 {
                channel.push(time, vec![1.0], |_| f64::NAN);
            }
        }
        channel.finish();
        let means = channel.means(FIELD).into_iter();
        let is_there: Vec<_> = means.map(|(_, mean)| mean.is_finite()).collect();
        assert_eq!(is_there, [true, false, false, true]);
    }

    #[test]
    fn averages_coarse_nutations_in_groups() {
        let mut channel = channel((0..120).map(f64::from).map(|start| (start, start + 1.0)));
        for time in (0..=480).map(|step| f64::from(step) / 4.0) {
            channel.push(time, vec![2.0 * time], |_| f64::NAN);
        }
        channel.finish();
        let found = channel.means(FIELD);
        assert_eq!(found, [(25.0, 50.0), (75.0, 150.0), (110.0, 220.0)]);
    }

    #[test]
    fn prefers_recorded_integrals() {
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
    fn thinning_keeps_means_accurate() {
        let count = 5 * u32::try_from(MAX_ROWS).unwrap();
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
