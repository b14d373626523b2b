//! The clock that two runs are put on, so that their times can be compared.

use super::options::Offset;
use crate::analysis::phrase::{counts_from_1970, date};
use crate::telemetry::side::Side;
use schemars::JsonSchema;
use serde::Serialize;

/// The clock of a comparison: A's, from an origin on that keeps times exact in s.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Clock {
    /// The origin on A's clock, ns.
    origin: i128,
    /// What is added to B's times to get those of A's clock, ns.
    offset: i128,
}

/// How the times of a report are to be read.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, JsonSchema)]
pub struct ClockReport {
    /// The moment from which all times of the report are counted, on A's clock, ns.
    pub origin_ns: i64,
    /// That moment as UTC, if A's clock counts from 1970.
    pub origin: Option<String>,
    /// What was added to B's times, ns.
    pub offset_ns: i64,
}

impl Clock {
    /// A clock for two runs with messages from these times on.
    pub(super) fn new(first: [Option<u64>; 2], offset: Offset) -> Self {
        let [a, b] = first.map(|first| first.map(i128::from));
        let offset = match (offset, a, b) {
            (Offset::By(ns), ..) => ns.into(),
            (Offset::Start, Some(a), Some(b)) => a - b,
            (Offset::Start, ..) => 0,
        };
        let start = a.into_iter().chain(b.map(|b| b + offset)).min();
        let start = start.unwrap_or(0);
        let is_far = u64::try_from(start).map_or(true, counts_from_1970);
        Self {
            origin: if is_far { start } else { 0 },
            offset,
        }
    }

    /// The time of a run's message on this clock, ns.
    pub(super) fn time(self, side: Side, time_ns: u64) -> u64 {
        let shift = match side {
            Side::A => 0,
            Side::B => self.offset,
        };
        let time = i128::from(time_ns) + shift - self.origin;
        time.clamp(0, u64::MAX.into()) as u64
    }

    /// Whether B's clock is put forward or back.
    pub(super) fn is_shifted(self) -> bool {
        self.offset != 0
    }

    /// How the report's times are to be read, unless they are those of both files.
    pub(super) fn report(self) -> Option<ClockReport> {
        if self == Self::default() {
            return None;
        }
        let short = |ns: i128| ns.clamp(i64::MIN.into(), i64::MAX.into()) as i64;
        let origin = u64::try_from(self.origin).ok();
        Some(ClockReport {
            origin_ns: short(self.origin),
            origin: origin.filter(|ns| counts_from_1970(*ns)).map(date),
            offset_ns: short(self.offset),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_since_1970_keep_their_nanoseconds() {
        let first = 1_700_000_000_123_456_789;
        let clock = Clock::new([Some(first), Some(first + 5)], Offset::default());
        assert_eq!(clock.time(Side::A, first), 0);
        assert_eq!(clock.time(Side::B, first + 1_000_000_001), 1_000_000_001);
        let report = clock.report().unwrap();
        assert_eq!(
            report.origin.as_deref(),
            Some("2023-11-14T22:13:20.123456789Z")
        );
        assert_eq!(report.origin_ns, first as i64);
        // A clock that begins with the run is left as it is.
        assert_eq!(
            Clock::new([Some(5), Some(7)], Offset::default()).report(),
            None
        );
    }

    #[test]
    fn one_clock_is_shifted() {
        let start = Clock::new([Some(10), Some(1_000)], Offset::Start);
        assert_eq!(start.time(Side::B, 1_000), start.time(Side::A, 10));
        let back = Clock::new([Some(0), Some(0)], Offset::By(-500));
        assert_eq!((back.time(Side::A, 0), back.time(Side::B, 0)), (500, 0));
        assert_eq!(back.report().unwrap().offset_ns, -500);
    }
}
