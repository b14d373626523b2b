//! Counts of a run's events.

use super::event::EventKind;
use schemars::JsonSchema;
use serde::Serialize;

/// Number of events of a kind.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventCount {
    /// The kind.
    pub name: EventKind,
    /// Number of times.
    pub count: u64,
    /// Time of the first, s.
    pub first_time: f64,
    /// Time of the last, s.
    pub last_time: f64,
}

/// Number of events of each kind, in the order of their first times.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Tally(Vec<EventCount>);

impl Tally {
    /// Adds an event at this time, s.
    pub fn record(&mut self, kind: EventKind, time: f64) {
        // Searched rather than hashed: there are about twenty kinds, and their order is that of the first times.
        match self.0.iter_mut().find(|known| known.name == kind) {
            Some(known) => {
                known.count += 1;
                known.last_time = time;
            }
            None => self.0.push(EventCount {
                name: kind,
                count: 1,
                first_time: time,
                last_time: time,
            }),
        }
    }

    /// The event kinds that occurred, with counts.
    pub fn counts(&self) -> &[EventCount] {
        &self.0
    }

    /// Number of events of this kind.
    pub fn count_of(&self, kind: EventKind) -> u64 {
        self.find(kind).map_or(0, |known| known.count)
    }

    /// Time of the first event of this kind, s, if any.
    pub fn first(&self, kind: EventKind) -> Option<f64> {
        self.find(kind).map(|known| known.first_time)
    }

    fn find(&self, kind: EventKind) -> Option<&EventCount> {
        self.0.iter().find(|known| known.name == kind)
    }
}
