//! The numbers of a run that figures need.

use super::means::Means;
use super::need::{Missing, Need};
use super::sampling;
use crate::analysis::plot::rows::{MOST, Rows};
use crate::analysis::plot::shape::Point;
use crate::analysis::subject::Subject;
use crate::archive::recording::Condition;
use crate::run::scenario::Scenario;
use crate::telemetry::fields::{NUTATING, NUTATION, NumberField, POSE, nutation};
use crate::telemetry::{Message, Topic, Topics};
use std::ops::ControlFlow;

/// Largest ratio of a nutation's period to that of the one before. The period changes by some hundredths from one to the
/// next; in recordings of the first version a fall, which isn't a nutation, ends the last cycle.
const LONGEST: f64 = 2.0;

/// The longest time between two nutations that is rounding, as a part of the period.
const GAP: f64 = 0.01;

/// A nutation cycle.
struct Cycle {
    start: f64,
    period: f64,
    is_nutation: bool,
}

/// The numbers of a run that some figures need, from a recording or a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// The name in legends.
    pub name: String,
    /// Missing parts, in sentences: the run was interrupted, or parts of the file can't be read.
    pub losses: Vec<String>,
    /// Whether the peg is free.
    pub(super) has_free_peg: bool,
    tracks: Vec<Track>,
    means: Vec<Means>,
}

/// Numbers of a channel over time.
#[derive(Clone, Debug, PartialEq)]
struct Track {
    topic: Topic,
    fields: Vec<NumberField>,
    rows: Rows,
}

impl Run {
    /// Reads what is needed of a recording or a simulation, in one pass.
    pub(super) fn collect<'n>(
        subject: Subject<'_>,
        name: &str,
        needs: impl Iterator<Item = &'n Need>,
        progress: &dyn Fn(u64),
    ) -> Self {
        let needs: Vec<_> = needs
            .filter(|need| subject.has_topic(need.topic()))
            .collect();
        let mut run = Self {
            has_free_peg: subject.is_of_free_peg(),
            ..Self::new(name, &needs)
        };
        let mut topics: Vec<_> = needs.iter().map(|need| need.topic()).collect();
        topics.sort_unstable();
        topics.dedup();
        if !topics.is_empty() {
            let fine: Scenario;
            let source = match subject {
                Subject::Scenario(scenario) => {
                    fine = sampling::finely_sampled(scenario);
                    Subject::Scenario(&fine)
                }
                recording @ Subject::Recording(_) => recording,
            };
            let ended = source.read(&Topics::Only(topics), &mut |message, bytes| {
                progress(bytes);
                run.take(message);
                ControlFlow::Continue(())
            });
            run.losses.extend(ended.losses);
            run.finish();
        }
        if let Subject::Recording(recording) = subject {
            match recording.condition() {
                Condition::Interrupted => run.lose("the run was cut off: its end is missing"),
                Condition::Damaged => {
                    let losses = recording.losses().iter();
                    run.losses.extend(losses.map(ToString::to_string));
                }
                Condition::Whole | Condition::Foreign => {}
            }
        }
        run
    }

    fn new(name: &str, needs: &[&Need]) -> Self {
        let mut run = Self {
            name: name.to_owned(),
            losses: Vec::new(),
            has_free_peg: false,
            tracks: Vec::new(),
            means: Vec::new(),
        };
        for need in needs.iter().filter(|need| need.are_means) {
            run.means.push(Means::new(need.fields));
        }
        for topic in Topic::all() {
            let of_topic = needs
                .iter()
                .filter(|need| !need.are_means && need.topic() == topic);
            let mut fields: Vec<_> = of_topic.flat_map(|need| need.fields).copied().collect();
            fields.sort_unstable_by_key(|field| field.index());
            fields.dedup();
            if !fields.is_empty() {
                // The locus goes round and round, and too few chords of a circle show.
                let most = if topic == POSE { 2 * MOST } else { MOST };
                let rows = Rows::new(fields.len(), most, topic != NUTATION);
                run.tracks.push(Track {
                    topic,
                    fields,
                    rows,
                });
            }
        }
        run
    }

    fn lose(&mut self, what: &str) {
        self.losses.push(what.to_owned());
    }

    fn take(&mut self, message: &Message<'_>) {
        for means in &mut self.means {
            means.take(message);
        }
        let topic = message.topic();
        if let Some(track) = self.tracks.iter_mut().find(|track| track.topic == topic) {
            let time = message.time_ns as f64 / 1e9;
            let values = track.fields.iter().map(|field| field.of(message));
            track.rows.push(time, values);
        }
    }

    fn finish(&mut self) {
        for means in &mut self.means {
            means.finish();
        }
        for track in &mut self.tracks {
            track.rows.mark_gaps();
        }
    }

    /// Missing part of a need: the channel, its messages or a field.
    pub(super) fn missing(&self, need: &Need) -> Option<String> {
        let topic = need.topic();
        let absent = if need.are_means {
            self.means_of(need.fields[0]).map(Means::missing)
        } else {
            self.track(topic).map(|track| track.missing(need.fields))
        };
        let Some(absent) = absent else {
            return Some(topic.name().to_owned());
        };
        Some(match absent? {
            Missing::Messages => format!("messages of {topic}"),
            Missing::Field(field) => field.to_string(),
        })
    }

    fn track(&self, topic: Topic) -> Option<&Track> {
        self.tracks.iter().find(|track| track.topic == topic)
    }

    fn means_of(&self, field: NumberField) -> Option<&Means> {
        self.means
            .iter()
            .find(|means| means.fields().contains(&field))
    }

    /// A number over time; nothing if the run doesn't have it. Where samples are missing there is a point that is not
    /// a number.
    pub(super) fn series(&self, field: NumberField) -> Vec<Point> {
        let points = self
            .track(field.topic())
            .and_then(|track| track.points(field));
        points.map_or_else(Vec::new, Iterator::collect)
    }

    /// A number that was recorded of each nutation, in the middle of the nutation. Where the motion between two
    /// nutations is none there is a point that is not a number.
    pub(super) fn averages(&self, field: NumberField) -> Vec<Point> {
        let mut points: Vec<Point> = Vec::new();
        let left_out = self
            .track(NUTATION)
            .map_or(0.0, |track| track.rows.coarseness());
        let mut last_end = f64::NAN;
        for (cycle, (_, value)) in self.cycles().zip(self.series(field)) {
            if !cycle.is_nutation {
                continue;
            }
            let gap = cycle.start - last_end;
            if gap > left_out + GAP * cycle.period {
                points.push((last_end + 0.5 * gap, f64::NAN));
            }
            points.push((cycle.start + 0.5 * cycle.period, value));
            last_end = cycle.start + cycle.period;
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

    /// The least number of samples in a nutation; none if there is no nutation or no sample.
    fn samples_per_nutation(&self) -> Option<f64> {
        let samples = self.tracks.iter().filter(|track| track.topic != NUTATION);
        let steps = samples.map(|track| track.rows.step());
        let step = steps
            .chain(self.means.iter().map(Means::step))
            .reduce(f64::min)?;
        let nutations = self.cycles().filter(|cycle| cycle.is_nutation);
        let shortest = nutations.map(|cycle| cycle.period).reduce(f64::min)?;
        Some(shortest / step)
    }

    /// The least number of samples in a nutation, if it is too small to show the envelope.
    pub(super) fn coarseness(&self) -> Option<f64> {
        self.samples_per_nutation()
            .filter(|samples| *samples < sampling::ENOUGH)
    }

    /// The nutation cycles.
    fn cycles(&self) -> impl Iterator<Item = Cycle> {
        let [starts, periods] = [nutation::START, nutation::PERIOD].map(|field| self.series(field));
        let mut before = f64::INFINITY;
        starts
            .into_iter()
            .zip(periods)
            .map(move |((_, start), (_, period))| Cycle {
                start,
                period,
                // That of a free peg takes longer from where it rolls.
                is_nutation: self.has_free_peg
                    || period <= LONGEST * std::mem::replace(&mut before, period),
            })
    }

    /// The mean over each nutation of a number that was sampled, in the middle of the nutation.
    pub(super) fn means(&self, field: NumberField) -> Vec<Point> {
        self.means_of(field)
            .map_or_else(Vec::new, |means| means.points(field))
    }
}

impl Track {
    fn points(&self, field: NumberField) -> Option<impl Iterator<Item = Point>> {
        let column = self.fields.iter().position(|known| *known == field)?;
        Some(self.rows.points(column))
    }

    /// First missing field or missing messages, if any.
    fn missing(&self, fields: &[NumberField]) -> Option<Missing> {
        if self.rows.is_empty() {
            return Some(Missing::Messages);
        }
        let is_absent = |field: &&NumberField| {
            let mut points = self.points(**field).into_iter().flatten();
            !points.any(|(_, value)| value.is_finite())
        };
        fields.iter().find(is_absent).copied().map(Missing::Field)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::telemetry::fields::contact;

    const SLIP: Need = Need {
        fields: &[contact::SLIP_SPEED, contact::SLIP_PATH],
        are_means: false,
    };

    fn run(times: &[f64], values: &[f64]) -> Run {
        let mut run = Run::new("run", &[&SLIP]);
        for (time, value) in times.iter().zip(values) {
            run.tracks[0].rows.push(*time, [*value, *value]);
        }
        run.finish();
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
        const THETA: Need = Need {
            fields: &[nutation::START, nutation::PERIOD, nutation::THETA_MEAN],
            are_means: false,
        };
        let mut run = Run::new("run", &[&THETA]);
        for [start, period] in cycles {
            run.tracks[0]
                .rows
                .push(start + period, [*start, *period, 0.1]);
        }
        run.finish();
        run.averages(nutation::THETA_MEAN)
    }

    #[test]
    fn a_fall_is_no_nutation() {
        let found = averages(&[[0.0, 0.25], [0.25, 0.25], [0.5, 18.5]]);
        assert_eq!(found, [(0.125, 0.1), (0.375, 0.1)]);
    }

    #[test]
    fn averages_are_apart_where_there_was_no_nutation() {
        let found = averages(&[[0.0, 0.25], [0.25, 0.25], [1.0, 0.25]]);
        let is_gap: Vec<_> = found.iter().map(|(_, value)| value.is_nan()).collect();
        assert_eq!(is_gap, [false, false, true, false]);
    }

    #[test]
    fn what_is_missing_is_named() {
        let missing = |run: &Run| run.missing(&SLIP);
        assert_eq!(
            missing(&Run::new("none", &[])).as_deref(),
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
