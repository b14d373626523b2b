//! The events of a run, as a log of sentences.

use rerun::{Color, TextLog};

use super::entity;
use super::look::Look;
use super::outlet::Outlet;
use super::track::{Collect, Flush, Texts, Track};
use crate::physics::top::Top;
use crate::run::simulation::EventKind;
use crate::telemetry::Message;
use crate::telemetry::fields::{EVENTS, events};

/// The logs of a run's events: one in which repetitions are one line, one with each event, and one of the nutation
/// extremes, which are hundreds.
pub(super) struct Events {
    summary: Track<Texts>,
    each: Track<Texts>,
    nutation: Track<Texts>,
    kinds: Vec<Repeated>,
    top: Top,
}

/// Repetitions of a kind of event.
struct Repeated {
    kind: EventKind,
    more: u32,
    again_ns: Option<u64>,
    last_ns: u64,
}

impl Events {
    /// Opens empty logs. Where two runs are compared, each entry's "level" is the name of its run.
    pub(super) fn new(top: Top, look: &Look, outlet: &mut Outlet) -> Self {
        let mut open = |entity| {
            let entity = look.entity(entity);
            if let Look::Compared(_, run) = look {
                let mark = TextLog::update_fields()
                    .with_level(run.as_str())
                    .with_color(Color::from_u32(look.color(u32::MAX, 0)));
                outlet.send_static(entity.as_str(), &mark);
            }
            Track::new(entity, Texts::default())
        };
        Self {
            summary: open(entity::EVENTS),
            each: open(entity::EACH_EVENT),
            nutation: open(entity::NUTATION_EVENTS),
            kinds: Vec::new(),
            top,
        }
    }

    /// Takes the event from a message, if it is one.
    pub(super) fn write(&mut self, message: &Message<'_>, outlet: &mut Outlet) {
        if message.topic() != EVENTS {
            return;
        }
        let time_ns = message.time_ns;
        let text = format!(
            "{:.6} s: {}",
            events::TIME.of(message),
            events::DESCRIPTION.of(message)
        );
        let kind = EventKind::find(events::NAME.of(message));
        if kind.is_some_and(EventKind::is_of_nutation) {
            self.nutation.push(outlet, time_ns, |rows| rows.push(text));
            return;
        }
        if kind.is_none_or(|kind| self.is_first(kind, time_ns)) {
            let text = text.clone();
            self.summary.push(outlet, time_ns, |rows| rows.push(text));
        }
        self.each.push(outlet, time_ns, |rows| rows.push(text));
    }

    /// Counts an event. Returns whether it is the first of its kind.
    fn is_first(&mut self, kind: EventKind, time_ns: u64) -> bool {
        let known = self.kinds.iter_mut().find(|known| known.kind == kind);
        let is_first = known.is_none();
        if let Some(known) = known {
            known.again_ns.get_or_insert(time_ns);
            known.last_ns = time_ns;
            known.more += 1;
        } else {
            self.kinds.push(Repeated {
                kind,
                more: 0,
                again_ns: None,
                last_ns: time_ns,
            });
        }
        is_first
    }

    /// Adds a line for each kind that happened more than once.
    fn summarize(&mut self, outlet: &mut Outlet) {
        for repeated in self.kinds.drain(..) {
            let plural = repeated.kind.plural(&self.top);
            if let (Some(time_ns), Some(plural)) = (repeated.again_ns, plural) {
                let [again, last] = [time_ns, repeated.last_ns].map(|ns| ns as f64 * 1e-9);
                let text = format!(
                    "{again:.6} s: {} more {plural} until {last:.6} s",
                    repeated.more
                );
                self.summary.push(outlet, time_ns, |rows| rows.push(text));
            }
        }
    }
}

impl Collect for Events {
    fn flush(&mut self, outlet: &mut Outlet, flush: Flush) {
        if let Flush::All = flush {
            self.summarize(outlet);
        }
        self.summary.flush(outlet, flush);
        self.each.flush(outlet, flush);
        self.nutation.flush(outlet, flush);
    }
}
