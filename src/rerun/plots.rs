//! Plots: every number of every message, as curves.

use rerun::Scalars;

use super::look::Look;
use super::outlet::{Columns, Outlet};
use super::style;
use super::track::Track;
use crate::telemetry::fields::{NumberField, Plot};
use crate::telemetry::{Message, Topic};

/// The plots of all channels, in table order.
pub(super) struct Plots(Vec<PlotTrack>);

/// One plot of a channel.
struct PlotTrack {
    plot: Plot,
    numbers: Vec<NumberField>,
    track: Track<Vec<f64>>,
    /// The least and the greatest number.
    range: [f64; 2],
    /// Time of the last row, ns.
    end_ns: u64,
}

impl Plots {
    /// Opens the plots that are `wanted`, and sends their names and colours.
    pub(super) fn new(wanted: impl Fn(Plot) -> bool, look: &Look, outlet: &mut Outlet) -> Self {
        let mut open = |plot: Plot| {
            let entity = look.entity(&plot.to_string());
            let numbers: Vec<_> = plot.numbers().collect();
            outlet.send_static(entity.as_str(), &*style::of(&numbers, look));
            PlotTrack {
                plot,
                numbers,
                track: Track::new(entity, columns, outlet),
                range: [f64::INFINITY, f64::NEG_INFINITY],
                end_ns: 0,
            }
        };
        let plots = Topic::all().flat_map(Plot::all);
        Self(plots.filter(|plot| wanted(*plot)).map(&mut open).collect())
    }

    /// The least and the greatest number of a plot; the former is the larger one if there is none.
    pub(super) fn range(&self, plot: Plot) -> [f64; 2] {
        let track = self.0.iter().find(|track| track.plot == plot);
        track.map_or([f64::INFINITY, f64::NEG_INFINITY], |track| track.range)
    }

    /// Adds a row without values to plots that end before this time, so that a viewer's time axes reach until then.
    pub(super) fn reach(&mut self, time_ns: u64, outlet: &mut Outlet) {
        for plot in self.0.iter_mut().filter(|plot| plot.end_ns < time_ns) {
            let missing = vec![f64::NAN; plot.numbers.len()];
            plot.track.push(outlet, time_ns, missing);
        }
    }

    /// Adds a row of what `value` makes of the numbers of a message, unless it makes nothing of one of them.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        outlet: &mut Outlet,
    ) {
        let is_of_channel = |plot: &&mut PlotTrack| plot.plot.topic() == message.topic();
        for plot in self.0.iter_mut().filter(is_of_channel) {
            let row = plot.numbers.iter().map(|number| value(number.of(message)));
            let Some(row) = row.collect::<Option<Vec<_>>>() else {
                continue;
            };
            let [least, greatest] = &mut plot.range;
            for number in &row {
                *least = least.min(*number);
                *greatest = greatest.max(*number);
            }
            plot.track.push(outlet, message.time_ns, row);
            plot.end_ns = message.time_ns;
        }
    }
}

fn columns(rows: &[Vec<f64>]) -> Columns {
    let scalars = Scalars::new(rows.iter().flatten().copied());
    Ok(scalars.columns(rows.iter().map(Vec::len))?.collect())
}
