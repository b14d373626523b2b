//! Plots: every number of every message, as curves.

use super::look::Look;
use super::outlet::Outlet;
use super::style;
use super::track::{Collect, Flush, Numbers, Track};
use crate::telemetry::fields::{NumberField, Plot};
use crate::telemetry::{Message, Topic};

/// The plots of each channel, in table order.
pub(super) struct Plots(Vec<Vec<PlotTrack>>);

/// One plot of a channel.
struct PlotTrack {
    numbers: Vec<NumberField>,
    track: Track<Numbers>,
}

impl Plots {
    /// Opens the plots that are `wanted`, and sends their names and colours.
    pub(super) fn new(wanted: impl Fn(Plot) -> bool, look: &Look, outlet: &mut Outlet) -> Self {
        let mut open = |plot: Plot| {
            let entity = look.entity(&plot.to_string());
            let numbers: Vec<_> = plot.numbers().collect();
            outlet.send_static(entity.as_str(), &*style::of(&numbers, look));
            let track = Track::new(entity, Numbers::new(numbers.len()));
            PlotTrack { numbers, track }
        };
        let plots = Topic::all().map(|topic| {
            let plots = Plot::all(topic).into_iter();
            plots.filter(|plot| wanted(*plot)).map(&mut open).collect()
        });
        Self(plots.collect())
    }

    /// Adds a row of what `value` makes of the numbers of a message, unless it makes nothing of one of them.
    pub(super) fn write(
        &mut self,
        message: &Message<'_>,
        value: impl Fn(f64) -> Option<f64>,
        outlet: &mut Outlet,
    ) {
        for plot in &mut self.0[message.channel] {
            let row = || plot.numbers.iter().map(|number| value(number.of(message)));
            if row().all(|value| value.is_some()) {
                let fill = |rows: &mut Numbers| rows.extend(row().flatten());
                plot.track.push(outlet, message.time_ns, fill);
            }
        }
    }
}

impl Collect for Plots {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.0.flush(outlet, flush);
    }
}

impl Collect for PlotTrack {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.track.flush(outlet, flush);
    }
}
