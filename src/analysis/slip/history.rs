//! The slip of a run, collected from its messages.

use super::speeds::VisitedSpeeds;
use crate::physics::friction::FrictionLaw;
use crate::physics::math::cos;
use crate::run::scenario::Scenario;
use crate::run::simulation::Regime;
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{contact, state};
use schemars::JsonSchema;
use serde::Serialize;

/// The slip of a run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Slip {
    /// Time during which the contact point slips, s.
    pub time: f64,
    /// The first sample that slips.
    pub start: SlipPoint,
    /// The last sample that slips.
    pub end: SlipPoint,
    /// The coefficient of friction from the fastest to the slowest slip: at both, and at each extreme between them. At
    /// these, numbers are means over the time in which the speed is within 1.6 %.
    pub path: Vec<PathPoint>,
    /// The slip speeds below which the run spends 5 %, 50 % and 95 % of that time, m/s.
    pub quantiles: [f64; 3],
    /// The mean rate about the vertical, on which some laws depend, rad/s; `None` if it is not recorded.
    pub turning_rate: Option<f64>,
    /// All slip speeds.
    #[serde(skip)]
    pub visited: VisitedSpeeds,
}

/// A sample that slips.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct SlipPoint {
    /// Time, s.
    pub time: f64,
    /// Slip speed, m/s.
    pub speed: f64,
    /// The coefficient of friction μ of the law there.
    pub coefficient: f64,
}

/// A coefficient of friction at a slip speed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PathPoint {
    /// Slip speed, m/s.
    pub speed: f64,
    /// The coefficient of friction μ.
    pub coefficient: f64,
}

/// The slip of a run so far.
#[derive(Clone, Debug)]
pub(crate) struct SlipHistory {
    law: FrictionLaw,
    /// Time of the last sample of the state, ns, and its rate about the vertical, rad/s.
    turning: Option<(u64, f64)>,
    visited: VisitedSpeeds,
    samples: Option<Samples>,
    /// The sum of the rates about the vertical, rad/s; NaN if they are not recorded.
    turning_rates: f64,
    count: u64,
}

/// Samples that slip.
#[derive(Clone, Copy, Debug)]
struct Samples {
    first: SlipPoint,
    last: SlipPoint,
    fastest: SlipPoint,
    slowest: SlipPoint,
}

impl SlipHistory {
    /// No slip of a run of this scenario yet.
    pub(crate) fn new(scenario: &Scenario) -> Self {
        Self {
            law: scenario.model.friction.law.clone(),
            turning: None,
            visited: VisitedSpeeds::new(seconds(scenario.sample_period_ns)),
            samples: None,
            turning_rates: 0.0,
            count: 0,
        }
    }

    /// Takes a sample of the state, which is recorded before that of the contact at the same time.
    pub(crate) fn take_state(&mut self, message: &Message<'_>) {
        let theta = state::THETA.of(message);
        let rate = state::PHI_DOT.of(message) + state::PSI_DOT.of(message) * cos(theta);
        self.turning = Some((message.time_ns, rate));
    }

    /// Takes a sample of the contact.
    pub(crate) fn take_contact(&mut self, message: &Message<'_>) {
        let speed = contact::SLIP_SPEED.of(message);
        // A recording of an early version has no regime. A peg in the air has a slip speed, but does not slip.
        let regime = Regime::from_code(contact::REGIME.of(message));
        let slips = regime.is_none_or(|regime| regime == Regime::Slipping) && speed > 0.0;
        let turning_rate = match self.turning {
            Some((time_ns, rate)) if time_ns == message.time_ns => rate,
            Some(_) | None => f64::NAN,
        };
        let coefficient = self.law.coefficient(speed, turning_rate);
        // Without the rate, a law that depends on it has no coefficient.
        if !slips || !coefficient.is_finite() {
            return;
        }
        let point = SlipPoint {
            time: seconds(message.time_ns),
            speed,
            coefficient,
        };
        self.visited.add(speed, coefficient);
        self.turning_rates += turning_rate;
        self.count += 1;
        let samples = self.samples.get_or_insert(Samples {
            first: point,
            last: point,
            fastest: point,
            slowest: point,
        });
        samples.last = point;
        if speed > samples.fastest.speed {
            samples.fastest = point;
        }
        if speed < samples.slowest.speed {
            samples.slowest = point;
        }
    }

    /// The slip of the run; `None` if it does not slip, or did not record it.
    pub(crate) fn slip(&self) -> Option<Slip> {
        let samples = self.samples?;
        let turning_rate = self.turning_rates / self.count as f64;
        Some(Slip {
            time: self.visited.time(),
            start: samples.first,
            end: samples.last,
            path: extremes(&self.coefficients(samples)),
            quantiles: QUANTILES.map(|part| self.visited.quantile(part).unwrap_or_default()),
            turning_rate: Some(turning_rate).filter(|rate| rate.is_finite()),
            visited: self.visited.clone(),
        })
    }

    /// The coefficients of friction from the fastest to the slowest slip.
    fn coefficients(&self, samples: Samples) -> Vec<PathPoint> {
        let mut path = vec![samples.fastest.on_path()];
        for bin in self.visited.bins().rev() {
            path.push(PathPoint {
                speed: f64::midpoint(bin.from, bin.to),
                coefficient: bin.coefficient,
            });
        }
        path.push(samples.slowest.on_path());
        path
    }
}

impl SlipPoint {
    fn on_path(self) -> PathPoint {
        PathPoint {
            speed: self.speed,
            coefficient: self.coefficient,
        }
    }
}

/// The ends of a path, and its extremes between them that stand out from it.
fn extremes(path: &[PathPoint]) -> Vec<PathPoint> {
    let [first, .., last] = path else {
        return path.to_vec();
    };
    let mut extremes = vec![*first];
    // The farthest point since the last extreme.
    let (mut known, mut farthest) = (*first, *first);
    for point in path {
        let way = farthest.coefficient - known.coefficient;
        let step = point.coefficient - farthest.coefficient;
        if way * step >= 0.0 {
            farthest = *point;
        } else if stand_apart(farthest.coefficient, point.coefficient) {
            // The path has turned; if it did at once, in the direction that it has.
            if stand_apart(known.coefficient, farthest.coefficient) {
                extremes.push(farthest);
                known = farthest;
            }
            farthest = *point;
        }
    }
    extremes.push(*last);
    extremes
}

/// Whether two coefficients differ by more than means in bins of speeds do at random.
pub(super) fn stand_apart(a: f64, b: f64) -> bool {
    (a - b).abs() > CONSTANT * a.max(b)
}

/// A coefficient that changes by no more than this part stays the same.
const CONSTANT: f64 = 5e-3;

/// The parts of the time of slip for which there is a quantile.
const QUANTILES: [f64; 3] = [0.05, 0.5, 0.95];

#[cfg(test)]
mod tests {
    use super::*;

    fn path(coefficients: &[f64]) -> Vec<f64> {
        let mut points = Vec::new();
        for (index, coefficient) in coefficients.iter().enumerate() {
            points.push(PathPoint {
                speed: 1.0 / (index + 1) as f64,
                coefficient: *coefficient,
            });
        }
        extremes(&points)
            .iter()
            .map(|point| point.coefficient)
            .collect()
    }

    #[test]
    fn paths_have_their_extremes_without_noise() {
        for (coefficients, expected) in [
            (&[0.03, 0.03][..], &[0.03, 0.03][..]),
            (&[0.03, 0.030_01, 0.029_99, 0.03], &[0.03, 0.03]),
            (&[0.03, 0.02, 0.01], &[0.03, 0.01]),
            (&[0.03, 0.030_01, 0.02, 0.020_01, 0.01], &[0.03, 0.01]),
            (&[0.03, 0.02, 0.04], &[0.03, 0.02, 0.04]),
            (&[0.03, 0.05, 0.02, 0.04], &[0.03, 0.05, 0.02, 0.04]),
            (&[0.0, 0.0], &[0.0, 0.0]),
        ] {
            assert_eq!(path(coefficients), expected, "{coefficients:?}");
        }
    }
}
