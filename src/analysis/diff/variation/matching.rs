//! The value of a key with which A comes closest to B.

use crate::physics::math::{exp, ln};
use crate::run::outcome;
use crate::run::scenario::{Scenario, find_key};
use crate::run::simulation::sample_at;
use crate::words::{Piece, Sentence, sentence};
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

/// Number of times at which θ is compared.
const TIMES: u32 = 2000;
/// Values that are tried first: by factors of √2 down to an eighth and up to eight times the own one.
const STEPS: i32 = 6;
/// Relative width of the interval of the value at the end.
const PRECISION: f64 = 1e-5;
/// Motions look the same as long as θ differs by less, rad: by half a degree, which a camera shows.
const VISIBLE: f64 = 0.01;

/// A with the value of a key with which it comes closest to B.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Match {
    /// The key.
    pub key: String,
    /// The unit, empty for pure numbers.
    pub unit: String,
    /// The value of A.
    pub own: f64,
    /// The value with which A comes closest to B.
    pub value: f64,
    /// Whether it is at the end of the values that were tried, an eighth or eight times the own one.
    pub is_at_bound: bool,
    /// RMS difference of θ with the own and with this value, rad. θ is compared at equal times over the run of B; a run that
    /// has ended keeps its last.
    pub rms: [f64; 2],
    /// The time until which θ differs by less than 0.01 rad, s; absent if it does to the end.
    pub until: Option<f64>,
    /// The largest difference of θ, rad.
    pub largest: f64,
    /// Time of the largest, s.
    pub at: f64,
}

/// The reason why a key can't be matched.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum MatchError {
    /// A has no positive number for the key.
    #[error("{key} can't be matched: A has no positive number for it")]
    NoNumber {
        /// The key.
        key: String,
    },
    /// A motion can't be computed.
    #[error("the motions can't be computed for a match")]
    NoMotion,
}

/// The search for the value.
struct Search<'s> {
    a: Scenario,
    key: &'s str,
    times: Vec<f64>,
    theta_b: Vec<f64>,
}

/// Finds the value of a key of A with which it comes closest to B. `count` is called after each simulation.
///
/// # Errors
/// [`MatchError`] if A has no positive number for the key, or a motion can't be computed.
pub fn find_match(
    a: &Scenario,
    b: &Scenario,
    key: &str,
    count: &dyn Fn(),
) -> Result<Match, MatchError> {
    let (unit, own) = positive_number(a, key).ok_or_else(|| MatchError::NoNumber {
        key: key.to_owned(),
    })?;
    let search = Search::new(a, b, key).ok_or(MatchError::NoMotion)?;
    let rms = |exponent: f64| {
        count();
        search.rms(own * exp(exponent))
    };
    let best = closest(&rms);
    let value = own * exp(best);
    let thetas = search.theta_of_a(value).ok_or(MatchError::NoMotion)?;
    let mut found = Match {
        key: key.to_owned(),
        unit: unit.to_owned(),
        own,
        value,
        is_at_bound: best.abs() > (f64::from(STEPS) - 0.5) * step(),
        rms: [search.rms(own), search.rms(value)],
        until: None,
        largest: 0.0,
        at: 0.0,
    };
    for ((time, a), b) in search.times.iter().zip(thetas).zip(&search.theta_b) {
        let distance = (b - a).abs();
        if distance > VISIBLE {
            found.until.get_or_insert(*time);
        }
        if distance > found.largest {
            (found.largest, found.at) = (distance, *time);
        }
    }
    Ok(found)
}

/// The unit and the number of a key of a scenario, if it has a positive one.
fn positive_number(scenario: &Scenario, key: &str) -> Option<(&'static str, f64)> {
    let number = scenario.number(key).filter(|number| *number > 0.0)?;
    Some((find_key(key).ok()?.unit, number))
}

/// The logarithm of the factor between two values that are tried first.
fn step() -> f64 {
    0.5 * ln(2.0)
}

/// The exponent with the least distance: the best of a few, then by golden sections between its neighbours.
fn closest(rms: &dyn Fn(f64) -> f64) -> f64 {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut best = (f64::INFINITY, 0.0);
    for at in -STEPS..=STEPS {
        let exponent = f64::from(at) * step();
        let distance = rms(exponent);
        if distance < best.0 {
            best = (distance, exponent);
        }
    }
    let (mut low, mut high) = (best.1 - step(), best.1 + step());
    let inner = |low: f64, high: f64| [high - GOLDEN * (high - low), low + GOLDEN * (high - low)];
    let [mut one, mut other] = inner(low, high);
    let (mut at_one, mut at_other) = (rms(one), rms(other));
    while high - low > PRECISION {
        if at_one <= at_other {
            (high, other, at_other) = (other, one, at_one);
            one = inner(low, high)[0];
            at_one = rms(one);
        } else {
            (low, one, at_one) = (one, other, at_other);
            other = inner(low, high)[1];
            at_other = rms(other);
        }
    }
    if at_one.min(at_other) < best.0 {
        0.5 * (low + high)
    } else {
        best.1
    }
}

impl<'s> Search<'s> {
    fn new(a: &Scenario, b: &Scenario, key: &'s str) -> Option<Self> {
        let end = outcome(b, || true).ok()?.end.time;
        let times: Vec<_> = (0..=TIMES)
            .map(|at| end * f64::from(at) / f64::from(TIMES))
            .collect();
        let lasts = a.stop.duration.is_none_or(|duration| duration >= end);
        let a = if lasts {
            a.clone()
        } else {
            a.with([("stop.duration", end.into())]).ok()?
        };
        Some(Self {
            theta_b: theta(b, &times)?,
            a,
            key,
            times,
        })
    }

    fn theta_of_a(&self, value: f64) -> Option<Vec<f64>> {
        let a = self.a.with([(self.key, value.into())]).ok()?;
        theta(&a, &self.times)
    }

    /// RMS difference of θ; infinite where A can't have the value.
    fn rms(&self, value: f64) -> f64 {
        let Some(thetas) = self.theta_of_a(value) else {
            return f64::INFINITY;
        };
        let mut squares = 0.0;
        for (a, b) in thetas.iter().zip(&self.theta_b) {
            squares += (b - a) * (b - a);
        }
        (squares / thetas.len() as f64).sqrt()
    }
}

/// θ at these times; a run that has ended keeps its last.
fn theta(scenario: &Scenario, times: &[f64]) -> Option<Vec<f64>> {
    let mut found = Vec::with_capacity(times.len());
    sample_at(scenario, times, &mut |_, sample| {
        found.push(sample.angles.theta);
    })
    .ok()?;
    let last = *found.last()?;
    found.resize(times.len(), last);
    Some(found)
}

impl Match {
    /// The value, and what it leaves.
    pub fn sentence(&self) -> Sentence {
        let closest = sentence!(
            "With {} = {} instead of {}, A comes closest to B: the RMS difference of θ is {} instead of {}{}.",
            Piece::key(self.key.clone()),
            Piece::number(self.value, 4, self.unit.clone()),
            Piece::rounded(self.own, 4, self.unit.clone()),
            Piece::number(self.rms[1], 2, "rad"),
            Piece::number(self.rms[0], 2, "rad"),
            if self.is_at_bound {
                ", at the end of the values that were tried"
            } else {
                ""
            }
        );
        let largest = Piece::number(self.largest, 2, "rad");
        let remains = match self.until {
            None => sentence!(
                "It looks like B to the end: θ differs by at most {}, at {}.",
                largest,
                Piece::time(self.at)
            ),
            Some(until) => sentence!(
                "Until {} it looks like B, with θ within {}; then θ differs by up to {}, at {}.",
                Piece::time(until),
                Piece::rounded(VISIBLE, 1, "rad"),
                largest,
                Piece::time(self.at)
            ),
        };
        sentence!("{} {}", closest, remains)
    }
}
