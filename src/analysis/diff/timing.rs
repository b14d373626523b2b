//! Which time of B is compared with a time of A.

use crate::analysis::course::curve::Curve;

/// A time in ns, finer than whole ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instant {
    pub(super) ns: u64,
    /// The part of a nanosecond beyond, from 0 to 1.
    pub(super) rest: f64,
}

/// From A's time to B's.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TimeMap {
    /// The same.
    Same,
    /// B is where it is at the same phase: A's time (s) to the phase, the phase to B's time (s).
    Through(Curve, Curve),
}

impl TimeMap {
    /// B's time for one of A's; none where B has none.
    pub(super) fn target(&self, time_ns: u64) -> Option<Instant> {
        let Self::Through(phase, time) = self else {
            return Some(Instant {
                ns: time_ns,
                rest: 0.0,
            });
        };
        let seconds = time.at(phase.at(time_ns as f64 / 1e9)?)?;
        let nanoseconds = seconds * 1e9;
        (nanoseconds >= 0.0).then(|| Instant {
            ns: nanoseconds as u64,
            rest: nanoseconds - nanoseconds.floor(),
        })
    }
}
