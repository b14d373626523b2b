//! When θ first reaches a level, found from the samples of a run.
//!
//! Runs with different `stop.theta_risen` or `stop.theta_fallen`, or without, have no event at a level of both: there
//! the crossing is looked for between the samples.

use crate::analysis::course::curve::{extreme, hermite5};
use crate::analysis::subject::Subject;
use crate::physics::integrate::zero;
use crate::run::simulation::EventKind;
use crate::telemetry::Message;
use crate::telemetry::fields::{EVENTS, STATE, events, state};

/// Events meet `stop.theta_risen` and `stop.theta_fallen` to within rounding, rad: they are refined to the resolution of
/// a step, some 1e-16 s, at which θ changes by far less than this.
pub(super) const SAME_LEVEL: f64 = 1e-9;

/// The level at which θ counts as risen and the one at which it counts as fallen, rad; none where neither run has one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Levels {
    pub(super) risen: Option<f64>,
    pub(super) fallen: Option<f64>,
}

/// The levels of two runs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CommonLevels {
    /// The levels that both reach if they reach their own: the higher one of the risen, the lower one of the fallen.
    pub(super) common: Levels,
    /// The levels of A's and B's own scenario.
    pub(super) own: [Levels; 2],
}

impl CommonLevels {
    pub(super) fn of(runs: [Subject<'_>; 2]) -> Self {
        let own = runs.map(stops);
        let both = |of: fn(&Levels) -> Option<f64>, choose: fn(f64, f64) -> f64| {
            own.iter().filter_map(of).reduce(choose)
        };
        Self {
            common: Levels {
                risen: both(|levels| levels.risen, f64::max),
                fallen: both(|levels| levels.fallen, f64::min),
            },
            own,
        }
    }
}

/// Where a run stops, also one of another version.
fn stops(run: Subject<'_>) -> Levels {
    let text = match run {
        Subject::Scenario(scenario) => Some(scenario.to_toml()),
        Subject::Recording(recording) => recording.scenario_text().ok(),
    };
    let table = text.and_then(|text| text.parse::<toml::Table>().ok());
    let level = |key: &str| table.as_ref()?.get("stop")?.get(key)?.as_float();
    Levels {
        risen: level("theta_risen"),
        fallen: level("theta_fallen"),
    }
}

/// What θ has done so far.
#[derive(Clone, Debug, Default)]
pub(super) struct Touches {
    levels: Levels,
    /// When θ first was at the level of the risen, s.
    risen: Option<f64>,
    /// When θ first was at the level of the fallen, s.
    fallen: Option<f64>,
    /// θ in the first and the last sample, rad.
    ends: Option<[f64; 2]>,
    /// The last sample: its time (s), θ, θ̇ and θ̈.
    last: Option<(f64, [f64; 3])>,
}

impl Touches {
    pub(super) fn new(levels: Levels) -> Self {
        Self {
            levels,
            ..Self::default()
        }
    }

    /// When θ first was at the level of the risen, s.
    pub(super) fn risen(&self) -> Option<f64> {
        self.risen
    }

    /// When θ first was at the level of the fallen, s.
    pub(super) fn fallen(&self) -> Option<f64> {
        self.fallen
    }

    /// θ in the first and the last sample, rad.
    pub(super) fn ends(&self) -> Option<[f64; 2]> {
        self.ends
    }

    /// Takes in a message: a state, or the end of the run at one of the levels, which lies behind the last sample.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        match message.topic() {
            STATE => self.state(message),
            EVENTS => self.event(message),
            _ => {}
        }
    }

    fn event(&mut self, message: &Message<'_>) {
        let (time, theta) = (events::TIME.of(message), events::THETA.of(message));
        let is_at =
            |level: Option<f64>| level.is_some_and(|level| (theta - level).abs() <= SAME_LEVEL);
        match EventKind::find(events::NAME.of(message)) {
            Some(EventKind::Risen) if is_at(self.levels.risen) => self.risen = Some(time),
            Some(EventKind::Fallen) if is_at(self.levels.fallen) => self.fallen = Some(time),
            _ => {}
        }
    }

    fn state(&mut self, message: &Message<'_>) {
        let now = [state::THETA, state::THETA_DOT, state::THETA_DDOT].map(|f| f.of(message));
        if now.iter().any(|value| !value.is_finite()) {
            return;
        }
        let time = message.time_ns as f64 / 1e9;
        if let Some((before, last)) = self.last.replace((time, now)) {
            let reached = |level: Option<f64>, sign: f64| {
                let level = level?;
                let oriented = |of: [f64; 3]| [sign * (of[0] - level), sign * of[1], sign * of[2]];
                Some(
                    before
                        + (time - before)
                            * first_zero(oriented(last), oriented(now), time - before)?,
                )
            };
            self.risen = self.risen.or_else(|| reached(self.levels.risen, 1.0));
            self.fallen = self.fallen.or_else(|| reached(self.levels.fallen, -1.0));
        }
        let first = self.ends.map_or(now[0], |[first, _]| first);
        self.ends = Some([first, now[0]]);
    }
}

/// The part of the way between two samples, `h` apart, at which a positive quantity with its first two derivatives
/// first is 0, if it is.
fn first_zero(from: [f64; 3], to: [f64; 3], h: f64) -> Option<f64> {
    if from[0] <= 0.0 {
        return None;
    }
    let at = |s: f64| hermite5(from, to, h, s);
    let end = if to[0] <= 0.0 {
        1.0
    } else {
        // Both are above the level: it may dip below in between.
        let lowest = extreme([from[0], from[1]], [to[0], to[1]], h)?;
        if lowest > 0.0 || from[1] >= 0.0 {
            return None;
        }
        // The slope turns from falling to rising there.
        let slope = |s: f64| (at((s + 1e-6).min(1.0)) - at((s - 1e-6).max(0.0))) * 1e6;
        zero(from[1], to[1], slope)
    };
    let bottom = at(end);
    if bottom > 0.0 {
        return None;
    }
    Some(end * zero(from[0], bottom, |s| at(s * end)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_dips_between_samples_are_found() {
        // (t − 0.4)² − 0.01 between 0 and 1: above 0 at both, 0 at 0.3.
        let of = |t: f64| [(t - 0.4) * (t - 0.4) - 0.01, 2.0 * (t - 0.4), 2.0];
        let found = first_zero(of(0.0), of(1.0), 1.0).unwrap();
        assert!((found - 0.3).abs() < 1e-12, "{found}");
        let found = first_zero(of(0.0), of(0.45), 0.45).unwrap();
        assert!((0.45 * found - 0.3).abs() < 1e-12, "{found}");
        // What was below has been there before, and what only comes near is not there.
        assert_eq!(first_zero(of(0.35), of(1.0), 0.65), None);
        let above = |t: f64| [of(t)[0] + 0.02, of(t)[1], of(t)[2]];
        assert_eq!(first_zero(above(0.0), above(1.0), 1.0), None);
    }
}
