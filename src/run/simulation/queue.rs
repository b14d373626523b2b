//! Queue of the events of a step, in time order.

use super::event::{Event, EventKind};
use super::free::ImpactRecord;
use super::nutation::NutationCycle;
use super::record::Record;
use super::tally::Tally;
use crate::physics::dynamics::Motion;
use crate::physics::top::Top;
use std::collections::VecDeque;

/// A pending record; times in s.
pub(super) enum Pending {
    Event(EventKind, f64, Motion),
    /// The peg is on the table again, after this many impacts.
    Landing(u32, f64, Motion),
    Nutation(NutationCycle),
    Impact(ImpactRecord),
}

impl Pending {
    fn time_ns(&self) -> u64 {
        match self {
            Self::Event(_, time, _) | Self::Landing(_, time, _) => to_nanoseconds(*time),
            Self::Nutation(cycle) => cycle.time_ns,
            Self::Impact(landing) => landing.time_ns,
        }
    }
}

/// Pending records in time order, with counts of the emitted ones.
#[derive(Default)]
pub(super) struct Queue {
    pending: VecDeque<Pending>,
    /// Number of emitted events.
    pub(super) events: u32,
    /// Number of emitted nutation cycles.
    pub(super) cycles: u32,
    /// Number of emitted impacts.
    pub(super) impacts: u32,
    /// Time at which a tippe top inverted, s.
    pub(super) inversion: Option<f64>,
}

impl Queue {
    pub(super) fn push(&mut self, pending: Pending) {
        self.pending.push_back(pending);
    }

    pub(super) fn extend(&mut self, pending: impl IntoIterator<Item = Pending>) {
        self.pending.extend(pending);
    }

    /// Records the first inversion of a tippe top, at this time, s.
    pub(super) fn record_inversion(&mut self, time: f64) {
        self.inversion.get_or_insert(time);
    }

    /// Discards records after a time, s.
    pub(super) fn discard_after(&mut self, time: f64) {
        let limit = to_nanoseconds(time);
        self.pending.retain(|pending| pending.time_ns() <= limit);
    }

    /// Time of the next record, ns.
    pub(super) fn next_time_ns(&self) -> Option<u64> {
        self.pending.front().map(Pending::time_ns)
    }

    /// Removes and returns the next record.
    pub(super) fn pop(&mut self, top: &Top) -> Option<Record> {
        Some(match self.pending.pop_front()? {
            Pending::Event(kind, time, motion) => {
                self.event(kind, time, motion, kind.describe(top, &motion))
            }
            Pending::Landing(bounces, time, motion) => {
                let described = EventKind::Landing.describe(top, &motion);
                let counted = match bounces {
                    1 => "1 impact".to_owned(),
                    bounces => format!("{bounces} impacts"),
                };
                let sentence = format!("{described} After {counted}.");
                self.event(EventKind::Landing, time, motion, sentence)
            }
            Pending::Impact(landing) => {
                let index = self.impacts;
                self.impacts += 1;
                Record::Impact(Box::new(ImpactRecord { index, ..landing }))
            }
            Pending::Nutation(cycle) => {
                self.cycles += 1;
                Record::Nutation(Box::new(cycle))
            }
        })
    }

    fn event(&mut self, kind: EventKind, time: f64, motion: Motion, sentence: String) -> Record {
        let event = Event {
            kind,
            time,
            time_ns: to_nanoseconds(time),
            index: self.events,
            motion,
            description: sentence,
        };
        self.events += 1;
        Record::Event(Box::new(event))
    }

    /// Counts all records without emitting them. Returns the time, s, and the motion of the last event.
    pub(super) fn count_all(&mut self, tally: &mut Tally) -> Option<(f64, Motion)> {
        let mut last = None;
        for pending in self.pending.drain(..) {
            let (kind, time, motion) = match pending {
                Pending::Event(kind, time, motion) => (kind, time, motion),
                Pending::Landing(_, time, motion) => (EventKind::Landing, time, motion),
                Pending::Nutation(_) => {
                    self.cycles += 1;
                    continue;
                }
                Pending::Impact(_) => {
                    self.impacts += 1;
                    continue;
                }
            };
            self.events += 1;
            tally.count(kind, time);
            last = Some((time, motion));
        }
        last
    }
}

/// The nearest whole number of nanoseconds to a time that is not negative.
pub(super) fn to_nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}
