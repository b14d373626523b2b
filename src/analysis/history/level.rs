//! The time at which θ first falls to a level: that of the event, or found from the samples of a run.
//!
//! Of two runs with different `stop.theta_risen` one has no event at a level that both reach: there the crossing is found
//! between the samples. That needs samples that resolve the nutation.

use super::curve::{extreme, hermite5};
use crate::physics::integrate::zero;
use crate::run::simulation::EventKind;
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{EVENTS, STATE, events, state};

/// The event of a rise is at `stop.theta_risen` within rounding, rad: it is refined to the resolution of a step, some
/// 1e-16 s, in which θ changes by far less than this.
const SAME_LEVEL: f64 = 1e-9;

/// Samples in a nutation that are enough to interpolate between: the error is 3e-4 of the amplitude.
const SAMPLES_PER_NUTATION: f64 = 4.0;

/// Finds the first crossing of a level.
#[derive(Clone, Debug, Default)]
pub(crate) struct FirstCrossing {
    /// The level, rad.
    pub(crate) level: f64,
    /// The time of the event at the level, s.
    event: Option<f64>,
    /// The time of the first crossing between samples, s.
    between: Option<f64>,
    /// The largest time between two samples up to there, s.
    gap: f64,
    /// The last sample: time (s), θ, θ̇ and θ̈.
    last: Option<(f64, [f64; 3])>,
}

impl FirstCrossing {
    /// Looks for the first time at which θ falls to a level, rad.
    pub(super) fn at_level(level: f64) -> Self {
        Self {
            level,
            ..Self::default()
        }
    }

    /// The time of the crossing, s.
    pub(crate) fn time(&self) -> Option<f64> {
        self.event.or(self.between)
    }

    /// Whether the first crossing is known, if there is one: by an event, or because there are samples that resolve
    /// nutations of this period (s).
    pub(crate) fn is_known(&self, shortest_nutation: Option<f64>) -> bool {
        let is_resolved =
            shortest_nutation.is_some_and(|period| SAMPLES_PER_NUTATION * self.gap <= period);
        self.event.is_some() || (self.last.is_some() && is_resolved)
    }

    /// Sets the time of the end of a run that ended when θ first fell to the level, s.
    pub(crate) fn end_at(&mut self, time: f64) {
        self.event.get_or_insert(time);
    }

    /// Adds a message: a state, or the end of the run at the level, after the last sample.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        match message.topic() {
            STATE if self.between.is_none() => self.add_state(message),
            EVENTS => {
                let is_rise = events::NAME.of(message) == EventKind::Risen.name();
                let distance = (events::THETA.of(message) - self.level).abs();
                if is_rise && distance <= SAME_LEVEL {
                    self.event = Some(events::TIME.of(message));
                }
            }
            _ => {}
        }
    }

    fn add_state(&mut self, message: &Message<'_>) {
        let now = [
            state::THETA.of(message),
            state::THETA_DOT.of(message),
            state::THETA_DDOT.of(message),
        ];
        if now.iter().any(|value| !value.is_finite()) {
            return;
        }
        let time = seconds(message.time_ns);
        if let Some((before, last)) = self.last.replace((time, now)) {
            let from = [last[0] - self.level, last[1], last[2]];
            let to = [now[0] - self.level, now[1], now[2]];
            self.gap = self.gap.max(time - before);
            self.between =
                first_zero(from, to, time - before).map(|part| before + part * (time - before));
        }
    }
}

/// The fraction of the interval `h` between two samples at which a positive quantity with known first two derivatives
/// first reaches 0, if it does.
fn first_zero(from: [f64; 3], to: [f64; 3], h: f64) -> Option<f64> {
    if from[0] <= 0.0 {
        return None;
    }
    let end = if to[0] <= 0.0 {
        1.0
    } else {
        // Both are above the level: it may dip below in between.
        let lowest = extreme([from[0], from[1]], [to[0], to[1]], h)?;
        if lowest > 0.0 || from[1] >= 0.0 {
            return None;
        }
        // The slope turns from falling to rising there.
        zero(from[1], to[1], |s| slope(from, to, h, s))
    };
    let bottom = hermite5(from, to, h, end);
    if bottom > 0.0 {
        return None;
    }
    Some(end * zero(from[0], bottom, |s| hermite5(from, to, h, s * end)))
}

/// A number with the sign of the slope at the fraction `s` of the interval `h` between two samples. Only its zero is
/// used, so the shorter step at an end of the interval does no harm.
fn slope(from: [f64; 3], to: [f64; 3], h: f64, s: f64) -> f64 {
    const STEP: f64 = 1e-6;
    let before = hermite5(from, to, h, (s - STEP).max(0.0));
    let after = hermite5(from, to, h, (s + STEP).min(1.0));
    (after - before) * 1e6
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_finds_dips_between_samples() {
        // (t − 0.4)² − 0.01 between 0 and 1: above 0 at both, 0 at 0.3.
        let of = |t: f64| [(t - 0.4) * (t - 0.4) - 0.01, 2.0 * (t - 0.4), 2.0];
        let found = first_zero(of(0.0), of(1.0), 1.0).unwrap();
        assert!((found - 0.3).abs() < 1e-12, "{found}");
        let found = first_zero(of(0.0), of(0.45), 0.45).unwrap();
        assert!((0.45 * found - 0.3).abs() < 1e-12, "{found}");
        // A value below the level has crossed it before; a value that only comes close has not crossed it.
        assert_eq!(first_zero(of(0.35), of(1.0), 0.65), None);
        let above = |t: f64| [of(t)[0] + 0.02, of(t)[1], of(t)[2]];
        assert_eq!(first_zero(above(0.0), above(1.0), 1.0), None);
    }
}
