//! Means of sampled numbers over each nutation.

use super::need::Missing;
use super::sampling::ENOUGH;
use crate::analysis::plot::rows::{self, Rows};
use crate::analysis::plot::shape::Point;
use crate::telemetry::Message;
use crate::telemetry::fields::{NUTATION, NumberField, acceleration, nutation};
use std::collections::VecDeque;

/// The most samples that are kept for the nutation that has not ended yet; when there are more, every other is dropped.
const MOST: usize = 1 << 16;

/// The number of nutations over which means are formed where a nutation has too few samples: what the integral errs by at
/// both ends, some hundredths of the ripple, is divided by them.
const TOGETHER: u32 = 50;

/// Numbers whose integrals since the start are recorded too.
const INTEGRATED: [(NumberField, NumberField); 3] = [
    (
        acceleration::PHI_DDOT_GYROSCOPIC,
        acceleration::PHI_DOT_GYROSCOPIC,
    ),
    (
        acceleration::PHI_DDOT_CORIOLIS,
        acceleration::PHI_DOT_CORIOLIS,
    ),
    (
        acceleration::PHI_DDOT_FRICTIONAL,
        acceleration::PHI_DOT_FRICTIONAL,
    ),
];

/// Means of some numbers of a channel, formed while the samples and the nutations come.
///
/// Numbers whose integrals are not recorded are integrated with straight lines between the samples. Only the samples of the nutation that has not ended
/// yet are kept.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Means {
    fields: &'static [NumberField],
    samples: VecDeque<Sample>,
    /// Nutations that end after the last sample: from and to, s.
    waiting: VecDeque<(f64, f64)>,
    /// Nutations that are averaged together, and how many there are.
    group: Option<(f64, f64, u32)>,
    finished: Rows,
    /// The shortest time between two samples, s.
    step: f64,
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
            group: None,
            finished: Rows::new(fields.len(), rows::MOST, false),
            step: f64::INFINITY,
        }
    }

    /// The shortest time between two samples, s; infinite if there are fewer.
    pub(super) fn step(&self) -> f64 {
        self.step
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
            let recorded = self.fields.iter().map(|field| {
                let known = INTEGRATED.iter().find(|(known, _)| known == field);
                known.map_or(f64::NAN, |(_, integral)| integral.of(message))
            });
            let time = message.time_ns as f64 / 1e9;
            self.sample(time, values.collect(), recorded.collect());
            self.close(|end, time| end < time);
        }
    }

    /// Forms the means that still can be formed when no more samples come.
    pub(super) fn finish(&mut self) {
        self.close(|end, time| end <= time);
        if let Some((from, to, _)) = self.group.take() {
            self.mean(from, to);
        }
    }

    /// Takes a sample, with the integrals that are recorded; the others are not numbers.
    fn sample(&mut self, time: f64, values: Vec<f64>, recorded: Vec<f64>) {
        let mut integrals = recorded;
        for (column, integral) in integrals.iter_mut().enumerate() {
            if integral.is_finite() {
                continue;
            }
            *integral = self.samples.back().map_or(0.0, |last| {
                let mean = f64::midpoint(last.values[column], values[column]);
                last.integrals[column] + (time - last.time) * mean
            });
        }
        if let Some(last) = self.samples.back() {
            self.step = self.step.min(time - last.time);
        }
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
            let (from, to, count) = match self.group.take() {
                Some((start, end, count)) if from - end < 0.5 * (to - from) => {
                    (start, to, count + 1)
                }
                _ => (from, to, 1),
            };
            let is_fine = (to - from) / f64::from(count) >= ENOUGH * self.step;
            if is_fine || count >= TOGETHER {
                self.mean(from, to);
            } else {
                self.group = Some((from, to, count));
            }
            // The next nutation begins where this one ends, but for rounding.
            let from = self.group.map_or(to, |(from, ..)| from);
            while self.samples.get(2).is_some_and(|sample| sample.time < from) {
                self.samples.pop_front();
            }
        }
    }

    /// Forms the means from one time to another.
    fn mean(&mut self, from: f64, to: f64) {
        let mean = |column| {
            Some((self.integral(column, to)? - self.integral(column, from)?) / (to - from))
        };
        let means: Option<Vec<f64>> = (0..self.fields.len()).map(mean).collect();
        if let Some(means) = means {
            self.finished.push(f64::midpoint(from, to), means);
        }
    }

    /// The integral of a number up to a time; none if that isn't between samples.
    ///
    /// Between two samples it is the cubic with the integrals and the numbers at both as values and slopes.
    fn integral(&self, column: usize, time: f64) -> Option<f64> {
        let after = self.samples.partition_point(|sample| sample.time <= time);
        let start = self.samples.get(after.checked_sub(1)?)?;
        let Some(end) = self.samples.get(after) else {
            return (time == start.time).then_some(start.integrals[column]);
        };
        let length = end.time - start.time;
        let part = (time - start.time) / length;
        let rise = end.integrals[column] - start.integrals[column];
        let [first, last] = [start, end].map(|sample| length * sample.values[column] - rise);
        let bend = part * (1.0 - part) * ((1.0 - part) * first - part * last);
        Some(start.integrals[column] + part * rise + bend)
    }

    /// Missing messages or fields, if any.
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
        column.map_or_else(Vec::new, |column| self.finished.points(column).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn integrals_are_those_of_straight_lines() {
        let mut means = Means::new(&[nutation::CYCLE]);
        for (time, value) in [(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)] {
            means.sample(time, vec![value], vec![f64::NAN]);
        }
        let found = [0.0, 0.5, 1.0, 1.5, 2.0].map(|time| means.integral(0, time));
        assert_eq!(found, [0.0, 0.25, 1.0, 2.0, 3.0].map(Some));
        let outside = [-0.1, 2.1].map(|time| means.integral(0, time));
        assert_eq!(outside, [None, None]);
    }

    #[test]
    fn a_mean_waits_for_the_sample_after_its_nutation() {
        let mut means = Means::new(&[nutation::CYCLE]);
        means.waiting.extend([(0.0, 1.5), (1.5, 3.0)]);
        let is_over = |end: f64, time: f64| end < time;
        for time in (0..=48).map(|step| f64::from(step) / 16.0) {
            means.sample(time, vec![2.0 * time], vec![f64::NAN]);
            means.close(is_over);
            assert_eq!(means.finished.is_empty(), time <= 1.5);
        }
        assert_eq!(means.points(nutation::CYCLE), [(0.75, 1.5)]);
        means.finish();
        assert_eq!(means.points(nutation::CYCLE), [(0.75, 1.5), (2.25, 4.5)]);
    }

    #[test]
    fn nutations_with_few_samples_are_averaged_together() {
        let mut means = Means::new(&[nutation::CYCLE]);
        let starts = (0..120).map(f64::from);
        means
            .waiting
            .extend(starts.map(|start| (start, start + 1.0)));
        for time in (0..=480).map(|step| f64::from(step) / 4.0) {
            means.sample(time, vec![2.0 * time], vec![f64::NAN]);
        }
        means.finish();
        let found = means.points(nutation::CYCLE);
        assert_eq!(found, [(25.0, 50.0), (75.0, 150.0), (110.0, 220.0)]);
    }

    #[test]
    fn recorded_integrals_are_taken_for_those_of_the_samples() {
        let mut means = Means::new(&[nutation::CYCLE]);
        // The integral of sin t from 0 on is 1 − cos t, whatever the samples miss.
        for time in (0..8).map(f64::from) {
            let (sin, cos) = crate::physics::math::sin_cos(time);
            means.sample(time, vec![sin], vec![1.0 - cos]);
        }
        let (_, cos) = crate::physics::math::sin_cos(2.5);
        let found = means.integral(0, 2.5).unwrap();
        assert!((found - (1.0 - cos)).abs() < 0.003, "{found}");
    }

    #[test]
    fn samples_without_nutations_don_t_fill_memory() {
        let mut means = Means::new(&[nutation::CYCLE]);
        for time in 0..5 * MOST {
            means.sample(time as f64, vec![1.0], vec![f64::NAN]);
            assert!(means.samples.len() <= MOST + 1);
        }
        means.waiting.push_back((10.25, 1000.5));
        means.finish();
        assert_eq!(means.points(nutation::CYCLE), [(505.375, 1.0)]);
    }
}
