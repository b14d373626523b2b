//! What figures need of a run: some of its numbers over time.

use super::drawing::Point;
use super::{Figure, Need};
use crate::recording::{Condition, Reader, Recording, Selection};
use crate::scenario::Scenario;
use crate::simulation::Simulation;
use crate::telemetry::{Message, Telemetry, TelemetryError, channel_index, channels};

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
    /// Reads from a recording what some figures need.
    ///
    /// `progress` is told how many more bytes have been read.
    #[must_use]
    pub fn read(
        recording: &Recording,
        name: &str,
        figures: &[&Figure],
        progress: &dyn Fn(u64),
    ) -> Self {
        let mut run = Self::new(name, figures);
        run.tracks.retain(|track| recording.has(track.channel));
        let topics = run.tracks.iter().map(|track| track.topic.to_owned());
        let selection = Selection {
            topics: topics.collect(),
            ..Selection::default()
        };
        // No topics would mean all.
        if !selection.topics.is_empty() {
            run.take_all(recording.reader(selection).in_order_of_time(), progress);
        }
        if recording.condition() == Condition::Interrupted {
            run.losses
                .push("the run was interrupted: its end is missing".to_owned());
        }
        run
    }

    /// Simulates a run and keeps what some figures need.
    #[must_use]
    pub fn simulate(scenario: &Scenario, figures: &[&Figure]) -> Self {
        let mut run = Self::new(scenario.name(), figures);
        if let Err(reason) = run.take_simulation(scenario) {
            run.losses.push(reason);
        }
        run
    }

    fn new(name: &str, figures: &[&Figure]) -> Self {
        let mut tracks: Vec<Track> = Vec::new();
        for need in figures.iter().flat_map(|figure| figure.all_needs()) {
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

    fn take_all(&mut self, mut reader: Reader<'_>, progress: &dyn Fn(u64)) {
        let mut undecodable = 0_u64;
        while let Some(message) = reader.next() {
            match message {
                Ok(message) => self.take(&message),
                Err(error) => {
                    if undecodable == 0 {
                        self.losses.push(error.to_string());
                    }
                    undecodable += 1;
                }
            }
            progress(reader.progress());
        }
        if undecodable > 1 {
            self.losses
                .push(format!("{undecodable} messages can't be decoded"));
        }
        let lost = reader.losses().iter().map(ToString::to_string);
        self.losses.extend(lost);
    }

    fn take_simulation(&mut self, scenario: &Scenario) -> Result<(), String> {
        let topics: Vec<_> = self.tracks.iter().map(|t| t.topic.to_owned()).collect();
        let told = |error: &dyn std::error::Error| error.to_string();
        let mut telemetry = Telemetry::with_topics(&topics).map_err(|error| told(&error))?;
        let mut simulation = Simulation::new(scenario).map_err(|error| told(&error))?;
        for record in simulation.by_ref() {
            let record = record.map_err(|error| told(&error))?;
            telemetry
                .messages(&record, |message| {
                    self.take(message);
                    Ok::<(), TelemetryError>(())
                })
                .map_err(|error| told(&error))?;
        }
        Ok(())
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

    /// A number over time; nothing where the run doesn't have it.
    pub(super) fn series(&self, topic: &str, field: &str) -> Vec<Point> {
        self.track(topic).map_or_else(Vec::new, |track| {
            let values = track.values(field).iter().copied();
            track.times.iter().copied().zip(values).collect()
        })
    }

    /// A mean over each nutation, as it was recorded, at the middle of the nutation.
    pub(super) fn averages(&self, field: &str) -> Vec<Point> {
        let means = self.series(NUTATION, field);
        self.cycles()
            .zip(means)
            .map(|((from, to), (_, mean))| (f64::midpoint(from, to), mean))
            .collect()
    }

    /// The mean over each nutation of a number that was sampled.
    pub(super) fn means(&self, topic: &str, field: &str) -> Vec<Point> {
        let integral = Integral::of(&self.series(topic, field));
        self.cycles()
            .filter_map(|(from, to)| {
                let mean = (integral.at(to)? - integral.at(from)?) / (to - from);
                Some((f64::midpoint(from, to), mean))
            })
            .collect()
    }

    /// When each nutation began and ended, s.
    fn cycles(&self) -> impl Iterator<Item = (f64, f64)> {
        let starts = self.series(NUTATION, "start");
        let periods = self.series(NUTATION, "period");
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

/// The channel of nutation averages.
pub(super) const NUTATION: &str = "/top/nutation";

/// The integral of samples from the first on, with straight lines between them.
struct Integral {
    points: Vec<Point>,
    sums: Vec<f64>,
}

impl Integral {
    fn of(points: &[Point]) -> Self {
        let points: Vec<_> = points.to_vec();
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
