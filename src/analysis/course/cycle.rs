//! Nutation cycles, and the ranges of the state within each.

use super::curve::extreme;
use crate::telemetry::Message;
use crate::telemetry::fields::{NumberField, state};

/// A least and a greatest value.
pub(super) type Range = [f64; 2];

/// The quantities whose ranges are known for each cycle, with their slopes.
const RANGED: [(NumberField, NumberField); 4] = [
    (state::THETA, state::THETA_DOT),
    (state::THETA_DOT, state::THETA_DDOT),
    (state::PHI_DOT, state::PHI_DDOT),
    (state::PSI_DOT, state::PSI_DDOT),
];

/// The places of θ and θ̇ among them.
pub(super) const THETA: usize = 0;
pub(super) const THETA_DOT: usize = 1;
/// The place of φ̇ among them.
const PHI_DOT: usize = 2;

/// A nutation cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) number: f64,
    pub(crate) start: f64,
    pub(crate) period: f64,
    /// The means of θ, θ̇, φ̇, ψ̇, rad and rad/s.
    pub(crate) means: [f64; 4],
    /// The ranges of θ, θ̇, φ̇, ψ̇; NaN where they are not known.
    pub(crate) ranges: [Range; 4],
}

impl Cycle {
    pub(crate) fn end(&self) -> f64 {
        self.start + self.period
    }

    pub(crate) fn middle(&self) -> f64 {
        self.start + 0.5 * self.period
    }

    /// Least and greatest φ̇ in it, rad/s, where they are known.
    pub(crate) fn precession_range(&self) -> Option<[f64; 2]> {
        Some(self.ranges[PHI_DOT]).filter(|range| range.iter().all(|rate| rate.is_finite()))
    }

    /// Half the range of θ̇, rad/s: unlike that of θ, it is free of the drift.
    pub(crate) fn amplitude(&self) -> f64 {
        let [least, greatest] = self.ranges[THETA_DOT];
        0.5 * (greatest - least)
    }
}

/// Finds the ranges of the states within each cycle while the states come.
#[derive(Clone, Debug)]
pub(super) struct Ranges {
    /// The last state: its time (s), and values with slopes.
    last: Option<(f64, [[f64; 2]; 4])>,
    open: [Range; 4],
}

/// Empty ranges: any value widens them.
const EMPTY: [Range; 4] = [[f64::INFINITY, f64::NEG_INFINITY]; 4];

impl Default for Ranges {
    fn default() -> Self {
        Self {
            last: None,
            open: EMPTY,
        }
    }
}

impl Ranges {
    /// Takes in a state, and returns the extremes between the last state and this one: if a cycle has ended in between,
    /// they belong to it too.
    pub(super) fn state(&mut self, message: &Message<'_>, has_cycles: bool) -> [Range; 4] {
        let time = message.time_ns as f64 / 1e9;
        let now = RANGED.map(|(value, slope)| [value.of(message), slope.of(message)]);
        let mut between = EMPTY;
        if let Some((before, last)) = &self.last {
            for (quantity, range) in between.iter_mut().enumerate() {
                let found = extreme(last[quantity], now[quantity], time - before);
                widen(range, found.unwrap_or(f64::NAN));
            }
            // The first cycle begins where θ̇ is greatest: what was before is not part of it.
            let slopes = [last[THETA_DOT][1], now[THETA_DOT][1]];
            if !has_cycles && slopes[0] > 0.0 && slopes[1] <= 0.0 {
                self.open = EMPTY;
            }
        }
        for (quantity, range) in self.open.iter_mut().enumerate() {
            for value in [now[quantity][0], between[quantity][0], between[quantity][1]] {
                widen(range, value);
            }
        }
        self.last = Some((time, now));
        between
    }

    /// The ranges since they were taken last.
    pub(super) fn take(&mut self) -> [Range; 4] {
        let ranges = std::mem::replace(&mut self.open, EMPTY);
        ranges.map(|range| {
            if range[0] <= range[1] {
                range
            } else {
                [f64::NAN; 2]
            }
        })
    }
}

/// Widens a range so that it contains a value, if that is finite.
pub(super) fn widen([least, greatest]: &mut [f64; 2], value: f64) {
    if !value.is_finite() {
        return;
    }
    if value < *least {
        *least = value;
    }
    if value > *greatest {
        *greatest = value;
    }
}
