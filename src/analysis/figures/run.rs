//! What figures need of a run: some of its numbers over time.

use super::need::{NUTATION, Need};
use crate::analysis::plot::shape::Point;
use crate::analysis::subject::Subject;
use crate::archive::recording::Condition;
use crate::telemetry::{Message, Topic, Topics, channel_index, channels};
use std::ops::ControlFlow;

/// Some numbers of a run, from a recording or a simulation.
#[derive(Clone, Debug, PartialEq)]
pub struct Run {
    /// What it is called in legends.
    pub name: String,
    /// What is not there, in sentences: the run was interrupted, or parts of the file can't be read.
    pub losses: Vec<String>,
    tracks: Vec<Track>,
}

/// A channel's numbers, as far as they are needed.
#[derive(Clone, Debug, PartialEq)]
struct Track {
    topic: &'static str,
    /// Index in the table of channels.
    channel: usize,
    /// Times, s.
    times: Vec<f64>,
    columns: Vec<Column>,
}

/// A number of a channel over time.
#[derive(Clone, Debug, PartialEq)]
struct Column {
    field: &'static str,
    /// Where it stands in a message.
    index: usize,
    values: Vec<f64>,
}

impl Run {
    /// Reads what is needed of a recording or a simulation.
    pub(super) fn collect<'n>(
        subject: Subject<'_>,
        name: &str,
        needs: impl Iterator<Item = &'n Need>,
        progress: &dyn Fn(u64),
    ) -> Self {
        let mut run = Self::new(name, needs);
        run.tracks
            .retain(|track| Topic::find(track.topic).is_some_and(|topic| subject.has_topic(topic)));
        let topics: Vec<_> = run
            .tracks
            .iter()
            .filter_map(|t| Topic::find(t.topic))
            .collect();
        if !topics.is_empty() {
            let ended = subject.read(&Topics::Only(topics), &mut |message, bytes| {
                progress(bytes);
                run.take(message);
                ControlFlow::Continue(())
            });
            run.losses.extend(ended.losses);
        }
        if let Subject::Recording(recording) = subject {
            match recording.condition() {
                Condition::Interrupted => run.lose("the run was cut off: its end is missing"),
                Condition::Recovered => run.lose("it was recovered: parts may be missing"),
                Condition::Damaged => {
                    let losses = recording.losses().iter();
                    run.losses.extend(losses.map(ToString::to_string));
                }
                Condition::Whole | Condition::Foreign => {}
            }
        }
        run
    }

    fn new<'n>(name: &str, needs: impl Iterator<Item = &'n Need>) -> Self {
        let mut tracks: Vec<Track> = Vec::new();
        for need in needs {
            let Some(channel) = channel_index(need.topic) else {
                continue;
            };
            let known = tracks.iter().position(|track| track.channel == channel);
            let at = known.unwrap_or_else(|| {
                tracks.push(Track {
                    topic: need.topic,
                    channel,
                    times: Vec::new(),
                    columns: Vec::new(),
                });
                tracks.len() - 1
            });
            tracks[at].want(need.fields);
        }
        Self {
            name: name.to_owned(),
            losses: Vec::new(),
            tracks,
        }
    }

    fn lose(&mut self, what: &str) {
        self.losses.push(what.to_owned());
    }

    fn take(&mut self, message: &Message<'_>) {
        let tracks = &mut self.tracks;
        if let Some(track) = tracks.iter_mut().find(|t| t.channel == message.channel) {
            track.times.push(message.time_ns as f64 / 1e9);
            for column in &mut track.columns {
                column.values.push(message.numbers[column.index]);
            }
        }
    }

    /// The channel or field that is needed and missing, if one is.
    pub(super) fn missing(&self, need: &Need) -> Option<String> {
        let Some(track) = self.track(need.topic) else {
            return Some(need.topic.to_owned());
        };
        let is_absent = |field: &&&str| {
            let values = track.values(field);
            !values.iter().any(|value| value.is_finite())
        };
        let field = need.fields.iter().find(is_absent)?;
        Some(if track.times.is_empty() {
            format!("messages of {}", need.topic)
        } else {
            format!("{}.{field}", need.topic)
        })
    }

    fn track(&self, topic: &str) -> Option<&Track> {
        self.tracks.iter().find(|track| track.topic == topic)
    }

    /// A number over time; nothing if the run doesn't have it. Where samples are missing it has a point that
    /// is not a number.
    pub(super) fn series(&self, topic: &str, field: &str) -> Vec<Point> {
        let points = self.points(topic, field);
        let steps = points.windows(2).map(|pair| pair[1].0 - pair[0].0);
        let step = steps.fold(f64::INFINITY, f64::min);
        let mut series = Vec::with_capacity(points.len());
        for point in points {
            match series.last() {
                Some((before, _)) if point.0 - before > 1.5 * step => {
                    series.push((f64::midpoint(*before, point.0), f64::NAN));
                }
                _ => {}
            }
            series.push(point);
        }
        series
    }

    /// The numbers of the messages, with their times.
    fn points(&self, topic: &str, field: &str) -> Vec<Point> {
        self.track(topic).map_or_else(Vec::new, |track| {
            let values = track.values(field).iter().copied();
            track.times.iter().copied().zip(values).collect()
        })
    }

    /// A mean over each nutation, as it was recorded, at the middle of the nutation.
    pub(super) fn averages(&self, field: &str) -> Vec<Point> {
        let means = self.points(NUTATION, field);
        self.cycles()
            .zip(means)
            .map(|((from, to), (_, mean))| (f64::midpoint(from, to), mean))
            .collect()
    }

    /// The mean over each nutation of a number that was sampled.
    pub(super) fn means(&self, topic: &str, field: &str) -> Vec<Point> {
        let integral = Integral::of(self.points(topic, field));
        self.cycles()
            .filter_map(|(from, to)| {
                let mean = (integral.at(to)? - integral.at(from)?) / (to - from);
                Some((f64::midpoint(from, to), mean))
            })
            .collect()
    }

    /// When each nutation began and ended, s.
    fn cycles(&self) -> impl Iterator<Item = (f64, f64)> {
        let starts = self.points(NUTATION, "start");
        let periods = self.points(NUTATION, "period");
        starts
            .into_iter()
            .zip(periods)
            .map(|((_, start), (_, period))| (start, start + period))
    }
}

impl Track {
    fn want(&mut self, fields: &'static [&'static str]) {
        for field in fields {
            let known = self.columns.iter().any(|column| column.field == *field);
            let index = channels()[self.channel].number_index(field);
            if let (false, Some(index)) = (known, index) {
                self.columns.push(Column {
                    field,
                    index,
                    values: Vec::new(),
                });
            }
        }
    }

    fn values(&self, field: &str) -> &[f64] {
        let column = self.columns.iter().find(|column| column.field == field);
        column.map_or(&[], |column| &column.values)
    }
}

/// The integral of samples from the first on, with straight lines between them.
struct Integral {
    points: Vec<Point>,
    sums: Vec<f64>,
}

impl Integral {
    fn of(points: Vec<Point>) -> Self {
        let mut sum = 0.0;
        let mut sums = vec![0.0];
        for pair in points.windows(2) {
            sum += (pair[1].0 - pair[0].0) * f64::midpoint(pair[0].1, pair[1].1);
            sums.push(sum);
        }
        Self { points, sums }
    }

    fn at(&self, time: f64) -> Option<f64> {
        let after = self.points.partition_point(|(t, _)| *t <= time);
        let before = after.checked_sub(1)?;
        let (t0, y0) = *self.points.get(before)?;
        let Some((t1, y1)) = self.points.get(after) else {
            return (time == t0).then_some(self.sums[before]);
        };
        let part = (time - t0) / (t1 - t0);
        let y = y0 + part * (y1 - y0);
        Some(self.sums[before] + (time - t0) * f64::midpoint(y0, y))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SLIP: Need = Need {
        topic: "/top/contact",
        fields: &["slip_speed", "slip_path"],
    };

    fn run(times: &[f64], values: &[f64]) -> Run {
        let mut run = Run::new("run", [&SLIP].into_iter());
        run.tracks[0].times = times.to_vec();
        run.tracks[0].columns[0].values = values.to_vec();
        run
    }

    #[test]
    fn missing_samples_are_a_gap() {
        let run = run(&[0.0, 1.0, 2.0, 5.0], &[4.0, 5.0, 6.0, 7.0]);
        let series = run.series("/top/contact", "slip_speed");
        assert_eq!(series.len(), 5);
        assert!(series[3].0 == 3.5 && series[3].1.is_nan());
    }

    #[test]
    fn integrals_are_those_of_straight_lines() {
        let integral = Integral::of(vec![(0.0, 0.0), (1.0, 2.0), (2.0, 2.0)]);
        let found = [0.0, 0.5, 1.0, 1.5, 2.0].map(|time| integral.at(time));
        assert_eq!(found, [0.0, 0.25, 1.0, 2.0, 3.0].map(Some));
        assert_eq!((integral.at(-0.1), integral.at(2.1)), (None, None));
    }

    #[test]
    fn what_is_missing_is_named() {
        let missing = |run: &Run| run.missing(&SLIP);
        let none = Run {
            tracks: Vec::new(),
            ..run(&[], &[])
        };
        assert_eq!(missing(&none).as_deref(), Some("/top/contact"));
        assert_eq!(
            missing(&run(&[], &[])).as_deref(),
            Some("messages of /top/contact")
        );
        let found = missing(&run(&[0.0], &[f64::NAN]));
        assert_eq!(found.as_deref(), Some("/top/contact.slip_speed"));
    }
}
