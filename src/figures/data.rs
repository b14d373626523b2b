//! Data of a run for figures.

use super::channel::ChannelData;
use super::sampling;
use crate::analysis::subject::Subject;
use crate::figures::plot::shape::Point;
use crate::telemetry::fields::{NUTATING, NUTATION, NumberField, nutation};
use crate::telemetry::{Topic, Topics};
use std::fmt;

/// Largest gap between two nutations attributed to rounding, relative to the period.
const ROUNDING_GAP: f64 = 0.01;

/// The data of a run for some figures, from a recording or a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct RunData {
    /// The name in legends.
    pub name: String,
    /// Missing parts, in sentences: the run was interrupted, or parts of the file can't be read.
    pub losses: Vec<String>,
    /// Whether the peg is free.
    pub(super) has_free_peg: bool,
    channels: Vec<ChannelData>,
}

/// Data that a figure needs and a run lacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MissingData {
    /// The channel.
    Channel(Topic),
    /// All messages of the channel.
    Messages(Topic),
    /// All values of a field of the channel.
    Field(NumberField),
}

impl fmt::Display for MissingData {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Channel(topic) => write!(f, "{topic}"),
            Self::Messages(topic) => write!(f, "messages of {topic}"),
            Self::Field(field) => write!(f, "{field}"),
        }
    }
}

impl RunData {
    /// Reads some fields of a recording or a simulation in one pass, with means of some of them.
    pub(super) fn collect(
        subject: Subject<'_>,
        name: &str,
        mut fields: Vec<NumberField>,
        averaged: &[NumberField],
        progress: &dyn Fn(u64),
    ) -> Self {
        // Channels that the run lacks are missing, rather than empty.
        fields.retain(|field| subject.has_topic(field.topic()));
        let mut run = Self::new(name, &fields, averaged);
        run.has_free_peg = subject.has_free_peg();
        // Without a channel there is nothing to read, and a scenario would be simulated twice for nothing.
        if run.channels.is_empty() {
            return run;
        }
        match subject {
            Subject::Scenario(scenario) => {
                let fine = sampling::finely_sampled(scenario);
                let topics = run.channels.iter().map(|channel| channel.topic).collect();
                run.fill(Subject::Scenario(&fine), &Topics::Only(topics), progress);
            }
            // All of it, because only its digest shows that a recording was altered.
            Subject::Recording(_) => run.fill(subject, &Topics::All, progress),
        }
        run
    }

    fn new(name: &str, fields: &[NumberField], averaged: &[NumberField]) -> Self {
        let mut channels = Vec::new();
        for topic in Topic::all() {
            let fields_of_topic: Vec<NumberField> = fields
                .iter()
                .copied()
                .filter(|field| field.topic() == topic)
                .collect();
            if !fields_of_topic.is_empty() {
                channels.push(ChannelData::new(topic, fields_of_topic, averaged));
            }
        }
        Self {
            name: name.to_owned(),
            losses: Vec::new(),
            has_free_peg: false,
            channels,
        }
    }

    /// Reads the messages of some topics, among them all channels.
    fn fill(&mut self, subject: Subject<'_>, topics: &Topics, progress: &dyn Fn(u64)) {
        let ended = subject.read(topics, &mut |message, bytes| {
            progress(bytes);
            for channel in &mut self.channels {
                channel.add(message);
            }
            true
        });
        // A figure shows its gaps, so what is missing is no reason to draw nothing.
        self.losses = ended.losses;
        for channel in &mut self.channels {
            channel.finish();
        }
    }

    /// The part of a field that is missing, if any.
    pub(super) fn missing(&self, field: NumberField) -> Option<MissingData> {
        let topic = field.topic();
        let Some(channel) = self.channel(topic) else {
            return Some(MissingData::Channel(topic));
        };
        if channel.rows.is_empty() {
            return Some(MissingData::Messages(topic));
        }
        if has_values(&channel.series(field)) {
            None
        } else {
            Some(MissingData::Field(field))
        }
    }

    fn channel(&self, topic: Topic) -> Option<&ChannelData> {
        self.channels.iter().find(|channel| channel.topic == topic)
    }

    /// A number over time; empty if it is not recorded. Gaps are NaN points.
    pub(super) fn series(&self, field: NumberField) -> Vec<Point> {
        self.channel(field.topic())
            .map_or_else(Vec::new, |channel| channel.series(field))
    }

    /// The mean over each nutation of a number that was sampled, in the middle of the nutation.
    pub(super) fn means(&self, field: NumberField) -> Vec<Point> {
        self.channel(field.topic())
            .map_or_else(Vec::new, |channel| channel.means(field))
    }

    /// A number that was recorded of each nutation, in the middle of the nutation. Interruptions of the nutation are
    /// NaN points.
    pub(super) fn averages(&self, field: NumberField) -> Vec<Point> {
        // Where rows were dropped to save memory, nutations are missing although nothing was interrupted.
        let thinned = self
            .channel(NUTATION)
            .map_or(0.0, |channel| channel.rows.max_thinned_step());
        let mut points: Vec<Point> = Vec::new();
        let mut last_end = f64::NAN;
        for ((start, period), (_, value)) in self.cycles().zip(self.series(field)) {
            let gap = start - last_end;
            if gap > thinned + ROUNDING_GAP * period {
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
        let envelope = [self.averages(*least), self.averages(*greatest)];
        let is_recorded = envelope.iter().all(|line| has_values(line));
        is_recorded.then_some(envelope)
    }

    /// The minimum number of samples per nutation, if too small to show the envelope.
    pub(super) fn coarse_samples_per_nutation(&self) -> Option<f64> {
        let step = self
            .channels
            .iter()
            .filter(|channel| channel.topic != NUTATION)
            .map(|channel| channel.rows.step())
            .reduce(f64::min)?;
        let shortest = self.cycles().map(|(_, period)| period).reduce(f64::min)?;
        Some(shortest / step).filter(|samples| *samples < sampling::MIN_PER_NUTATION)
    }

    /// The starts and periods of nutations, s.
    fn cycles(&self) -> impl Iterator<Item = (f64, f64)> {
        let starts = self.series(nutation::START);
        let periods = self.series(nutation::PERIOD);
        starts
            .into_iter()
            .zip(periods)
            .map(|(start, period)| (start.1, period.1))
    }
}

fn has_values(points: &[Point]) -> bool {
    points.iter().any(|(_, value)| value.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::contact;

    const SLIP: [NumberField; 2] = [contact::SLIP_SPEED, contact::SLIP_PATH];

    fn run(times: &[f64], values: &[f64]) -> RunData {
        let mut run = RunData::new("run", &SLIP, &[]);
        for (time, value) in times.iter().zip(values) {
            run.channels[0].rows.push(*time, [*value, *value]);
        }
        run.channels.iter_mut().for_each(ChannelData::finish);
        run
    }

    #[test]
    fn missing_samples_leave_a_gap() {
        let run = run(&[0.0, 1.0, 2.0, 5.0], &[4.0, 5.0, 6.0, 7.0]);
        let series = run.series(contact::SLIP_SPEED);
        assert_eq!(series.len(), 5);
        assert!(series[3].0 == 3.5 && series[3].1.is_nan());
    }

    /// The means of θ of nutations with these starts and periods.
    fn averages(cycles: &[[f64; 2]]) -> Vec<Point> {
        let fields = [nutation::START, nutation::PERIOD, nutation::THETA_MEAN];
        let mut run = RunData::new("run", &fields, &[]);
        for [start, period] in cycles {
            run.channels[0]
                .rows
                .push(start + period, [*start, *period, 0.1]);
        }
        run.channels.iter_mut().for_each(ChannelData::finish);
        run.averages(nutation::THETA_MEAN)
    }

    #[test]
    fn averages_have_gaps_between_nutations() {
        let found = averages(&[[0.0, 0.25], [0.25, 0.25], [1.0, 0.25]]);
        let is_gap: Vec<_> = found.iter().map(|(_, value)| value.is_nan()).collect();
        assert_eq!(is_gap, [false, false, true, false]);
    }

    #[test]
    fn names_missing_channel_messages_or_field() {
        for (run, expected) in [
            (RunData::new("none", &[], &[]), "/top/contact"),
            (run(&[], &[]), "messages of /top/contact"),
            (run(&[0.0], &[f64::NAN]), "/top/contact.slip_speed"),
        ] {
            let missing = run.missing(contact::SLIP_SPEED).unwrap();
            assert_eq!(missing.to_string(), expected);
        }
        assert_eq!(run(&[0.0], &[1.0]).missing(contact::SLIP_SPEED), None);
    }
}
