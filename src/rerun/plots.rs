//! Plots: every number of every message, as curves.

pub(super) mod outline;

use rerun::Scalars;

use self::outline::Outline;
use super::output::track::Track;
use super::output::{ComponentColumns, Output};
use super::role::Role;
use super::style;
use crate::telemetry::fields::{NumberField, Plot};
use crate::telemetry::{Message, Topic};

/// The range before the first value.
const NO_VALUES: [f64; 2] = [f64::INFINITY, f64::NEG_INFINITY];

/// The plots of each channel, in table order.
pub(super) struct Plots(Vec<Vec<PlotTrack>>);

/// One plot of a channel.
struct PlotTrack {
    plot: Plot,
    numbers: Vec<NumberField>,
    track: Track<f64>,
    /// The least and the greatest value of each number; reversed infinite bounds before the first.
    ranges: Vec<[f64; 2]>,
    /// The course of all numbers together.
    outline: Outline,
    /// Time of the last row, ns.
    end_ns: u64,
}

impl Plots {
    /// Opens the `wanted` plots, and sends their names and colours.
    pub(super) fn new(wanted: impl Fn(Plot) -> bool, role: &Role, output: &mut Output) -> Self {
        let mut plots = Vec::new();
        for topic in Topic::all() {
            let mut tracks = Vec::new();
            for plot in Plot::all(topic) {
                if wanted(plot) {
                    tracks.push(PlotTrack::new(plot, role, output));
                }
            }
            plots.push(tracks);
        }
        Self(plots)
    }

    /// The numbers of a plot that have values, each with its least and its greatest value.
    pub(super) fn ranges(&self, plot: Plot) -> impl Iterator<Item = (NumberField, [f64; 2])> {
        self.0[plot.topic().index()]
            .iter()
            .filter(move |track| track.plot == plot)
            .flat_map(|track| {
                track
                    .numbers
                    .iter()
                    .copied()
                    .zip(track.ranges.iter().copied())
            })
            .filter(|(_, range)| *range != NO_VALUES)
    }

    /// The outline of a plot, if it is one of these.
    pub(super) fn outline(&self, plot: Plot) -> Option<&Outline> {
        let mut tracks = self.0[plot.topic().index()].iter();
        let track = tracks.find(|track| track.plot == plot)?;
        Some(&track.outline)
    }

    /// Adds a row without values to plots that end before this time, so that time axes extend to it.
    pub(super) fn extend_to(&mut self, time_ns: u64, output: &mut Output) {
        let plots = self.0.iter_mut().flatten();
        for plot in plots.filter(|plot| plot.end_ns < time_ns) {
            // NaN is not drawn.
            let missing = std::iter::repeat_n(f64::NAN, plot.numbers.len());
            plot.track.push(output, time_ns, missing);
        }
    }

    /// Adds a row of the numbers of a message, mapped by `value`; skipped if it returns `None` for any.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        output: &mut Output,
    ) {
        for plot in &mut self.0[message.channel] {
            plot.write(message, &value, output);
        }
    }
}

impl PlotTrack {
    /// An empty plot; sends names and colours.
    fn new(plot: Plot, role: &Role, output: &mut Output) -> Self {
        let entity = role.entity(&plot.to_string());
        let numbers: Vec<_> = plot.numbers().collect();
        let width = numbers.len();
        output.send_static(entity.as_str(), &*style::series(&numbers, role));
        Self {
            plot,
            numbers,
            track: Track::new(entity, move |rows| columns(rows, width), output),
            ranges: vec![NO_VALUES; width],
            outline: Outline::new(),
            end_ns: 0,
        }
    }

    fn write(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        output: &mut Output,
    ) {
        let mut row = Vec::with_capacity(self.numbers.len());
        for number in &self.numbers {
            let Some(number) = value(number.of(message)) else {
                return;
            };
            row.push(number);
        }
        for (range, number) in self.ranges.iter_mut().zip(&row) {
            *range = [range[0].min(*number), range[1].max(*number)];
            self.outline.add(message.time_ns, *number);
        }
        self.track.push(output, message.time_ns, row);
        self.end_ns = message.time_ns;
    }
}

fn columns(numbers: &[f64], width: usize) -> ComponentColumns {
    let lengths = std::iter::repeat_n(width, numbers.len() / width);
    let scalars = Scalars::new(numbers.iter().copied());
    Ok(scalars.columns(lengths)?.collect())
}
