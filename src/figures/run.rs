//! Data of a run for figures.

use super::channel::Channel;
use super::sampling;
use crate::analysis::subject::Subject;
use crate::figures::plot::shape::Point;
use crate::telemetry::fields::{NUTATING, NUTATION, NumberField, nutation};
use crate::telemetry::{Topic, Topics};

/// Largest gap between two nutations attributed to rounding, relative to the period.
const GAP: f64 = 0.01;

/// The data of a run for some figures, from a recording or a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The name in legends.
    pub name: String,
    /// Missing parts, in sentences: the run was interrupted, or parts of the file can't be read.
    pub losses: Vec<String>,
    /// Whether the peg is free.
    pub(super) has_free_peg: bool,
    channels: Vec<Channel>,
}

impl Run {
    /// Reads some fields of a recording or a simulation in one pass, with means of some of them.
    pub(super) fn collect(
        subject: Subject<'_>,
        name: &str,
        mut fields: Vec<NumberField>,
        averaged: &[NumberField],
        progress: &dyn Fn(u64),
    ) -> Self {
        fields.retain(|field| subject.has_topic(field.topic()));
        let mut run = Self::new(name, &fields, averaged);
        run.has_free_peg = subject.is_of_free_peg();
        let topics: Vec<_> = run.channels.iter().map(|channel| channel.topic).collect();
        if !topics.is_empty() {
            let fine = match subject {
                Subject::Scenario(scenario) => Some(sampling::finely_sampled(scenario)),
                Subject::Recording(_) => None,
            };
            let source = fine.as_ref().map_or(subject, Subject::Scenario);
            let ended = source.read(&Topics::Only(topics), &mut |message, bytes| {
                progress(bytes);
                run.channels
                    .iter_mut()
                    .for_each(|channel| channel.take(message));
                true
            });
            run.losses = ended.losses;
            run.channels.iter_mut().for_each(Channel::finish);
        }
        run
    }

    fn new(name: &str, fields: &[NumberField], averaged: &[NumberField]) -> Self {
        let channel = |topic| {
            let of_topic = fields.iter().filter(|field| field.topic() == topic);
            let fields: Vec<_> = of_topic.copied().collect();
            (!fields.is_empty()).then(|| Channel::new(topic, fields, averaged))
        };
        Self {
            name: name.to_owned(),
            losses: Vec::new(),
            has_free_peg: false,
            channels: Topic::all().filter_map(channel).collect(),
        }
    }

    /// The missing part of a field: the channel, its messages or the field.
    pub(super) fn missing(&self, field: NumberField) -> Option<String> {
        let topic = field.topic();
        match self.channel(topic) {
            None => Some(topic.to_string()),
            Some(channel) if channel.rows.is_empty() => Some(format!("messages of {topic}")),
            Some(channel) => {
                let points = channel.series(field);
                let is_there = points.iter().any(|(_, value)| value.is_finite());
                (!is_there).then(|| field.to_string())
            }
        }
    }

    fn channel(&self, topic: Topic) -> Option<&Channel> {
        self.channels.iter().find(|channel| channel.topic == topic)
    }

    /// A number over time; empty if it is not recorded. Gaps are NaN points.
    pub(super) fn series(&self, field: NumberField) -> Vec<Point> {
        let channel = self.channel(field.topic());
        channel.map_or_else(Vec::new, |channel| channel.series(field))
    }

    /// The mean over each nutation of a number that was sampled, in the middle of the nutation.
    pub(super) fn means(&self, field: NumberField) -> Vec<Point> {
        let channel = self.channel(field.topic());
        channel.map_or_else(Vec::new, |channel| channel.means(field))
    }

    /// A number that was recorded of each nutation, in the middle of the nutation. Interruptions of the nutation are
    /// NaN points.
    pub(super) fn averages(&self, field: NumberField) -> Vec<Point> {
        let mut points: Vec<Point> = Vec::new();
        let channel = self.channel(NUTATION);
        let left_out = channel.map_or(0.0, |channel| channel.rows.coarseness());
        let mut last_end = f64::NAN;
        for ((start, period), (_, value)) in self.cycles().zip(self.series(field)) {
            let gap = start - last_end;
            if gap > left_out + GAP * period {
                points.push((last_end + 0.5 * gap, f64::NAN));
            }
            points.push((start + 0.5 * period, value));
            last_end = start + period;
        }
        points
    }

    /// The least and the greatest values of a quantity of the state in each nutation, if they are recorded.
    pub(super) fn envelope(&self, field: NumberField) -> Option<[Vec<Point>; 2]> {
        let [_, least, greatest] = NUTATING.iter().find(|[known, ..]| *known == field)?;
        let envelope = [least, greatest].map(|field| self.averages(*field));
        let is_there = |(_, value): &Point| value.is_finite();
        let is_recorded = envelope.iter().all(|line| line.iter().any(is_there));
        is_recorded.then_some(envelope)
    }

    /// The minimum number of samples per nutation, if too small to show the envelope.
    pub(super) fn coarseness(&self) -> Option<f64> {
        let channels = self.channels.iter();
        let sampled = channels.filter(|channel| channel.topic != NUTATION);
        let step = sampled.map(|channel| channel.rows.step());
        let step = step.reduce(f64::min)?;
        let shortest = self.cycles().map(|(_, period)| period).reduce(f64::min)?;
        Some(shortest / step).filter(|samples| *samples < sampling::ENOUGH)
    }

    /// The starts and periods of nutations.
    fn cycles(&self) -> impl Iterator<Item = (f64, f64)> {
        let fields = [nutation::START, nutation::PERIOD];
        let [starts, periods] = fields.map(|field| self.series(field).into_iter());
        starts
            .zip(periods)
            .map(|(start, period)| (start.1, period.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::contact;

    const SLIP: [NumberField; 2] = [contact::SLIP_SPEED, contact::SLIP_PATH];

    fn run(times: &[f64], values: &[f64]) -> Run {
        let mut run = Run::new("run", &SLIP, &[]);
        for (time, value) in times.iter().zip(values) {
            run.channels[0].rows.push(*time, [*value, *value]);
        }
        run.channels.iter_mut().for_each(Channel::finish);
        run
    }

    #[test]
    fn missing_samples_are_a_gap() {
        let run = run(&[0.0, 1.0, 2.0, 5.0], &[4.0, 5.0, 6.0, 7.0]);
        let series = run.series(contact::SLIP_SPEED);
        assert_eq!(series.len(), 5);
        assert!(series[3].0 == 3.5 && series[3].1.is_nan());
    }

    /// The means of θ of nutations with these starts and periods.
    fn averages(cycles: &[[f64; 2]]) -> Vec<Point> {
        let fields = [nutation::START, nutation::PERIOD, nutation::THETA_MEAN];
        let mut run = Run::new("run", &fields, &[]);
        for [start, period] in cycles {
            run.channels[0]
                .rows
                .push(start + period, [*start, *period, 0.1]);
        }
        run.channels.iter_mut().for_each(Channel::finish);
        run.averages(nutation::THETA_MEAN)
    }

    #[test]
    fn averages_are_apart_where_there_was_no_nutation() {
        let found = averages(&[[0.0, 0.25], [0.25, 0.25], [1.0, 0.25]]);
        let is_gap: Vec<_> = found.iter().map(|(_, value)| value.is_nan()).collect();
        assert_eq!(is_gap, [false, false, true, false]);
    }

    #[test]
    fn what_is_missing_is_named() {
        let missing = |run: &Run| run.missing(contact::SLIP_SPEED);
        assert_eq!(
            missing(&Run::new("none", &[], &[])).as_deref(),
            Some("/top/contact")
        );
        assert_eq!(
            missing(&run(&[], &[])).as_deref(),
            Some("messages of /top/contact")
        );
        let found = missing(&run(&[0.0], &[f64::NAN]));
        assert_eq!(found.as_deref(), Some("/top/contact.slip_speed"));
    }
}
