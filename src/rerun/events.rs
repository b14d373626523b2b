//! The events of a run, as a log of sentences.

use rerun::{Color, TextLog};

use super::entity;
use super::look::Look;
use super::outlet::Outlet;
use super::track::{Collect, Flush, Texts, Track};
use crate::run::simulation::EventKind;
use crate::telemetry::Message;
use crate::telemetry::fields::{EVENTS, events};

/// The logs of a run's events. Nutation extremes have a log of their own: there are hundreds, which would bury the
/// other events.
pub(super) struct Events {
    notable: Track<Texts>,
    nutation: Track<Texts>,
}

impl Events {
    /// Opens empty logs. Where two runs are compared, each entry's "level" is the name of its run.
    pub(super) fn new(look: &Look, outlet: &mut Outlet) -> Self {
        let [notable, nutation] = [entity::EVENTS, entity::NUTATION_EVENTS].map(|e| look.entity(e));
        if let Look::Compared(_, run) = look {
            let mark = TextLog::update_fields()
                .with_level(run.as_str())
                .with_color(Color::from_u32(look.color(u32::MAX, 0)));
            outlet.send_static(notable.as_str(), &mark);
            outlet.send_static(nutation.as_str(), &mark);
        }
        Self {
            notable: Track::new(notable, Texts::default()),
            nutation: Track::new(nutation, Texts::default()),
        }
    }

    /// Takes the event from a message, if it is one.
    pub(super) fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        if message.topic() != EVENTS {
            return;
        }
        let kind = EventKind::find(events::NAME.of(message));
        let track = if kind.is_some_and(EventKind::is_of_nutation) {
            &mut self.nutation
        } else {
            &mut self.notable
        };
        let description = events::DESCRIPTION.of(message).to_owned();
        track.push(outlet, message.time_ns, |rows| rows.push(description));
    }
}

impl Collect for Events {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        self.notable.flush(outlet, flush);
        self.nutation.flush(outlet, flush);
    }
}
