//! The law by which a difference grows.
//!
//! Only the largest differences in each of some hundred windows of time are kept. Through their logarithms, over
//! the time and over its logarithm, straight lines are laid: the one that explains more tells whether the difference
//! grows exponentially or as a power of time, unless it hardly grows at all.

use crate::physics::math::ln;
use schemars::JsonSchema;
use serde::Serialize;

/// Most windows that are kept.
const WINDOWS: usize = 256;
/// With fewer windows than this, nothing can be said: two laws with two parameters each fit a few points about equally.
const FEWEST: usize = 8;
/// A power law with a smaller exponent is none: over the two or three decades of time from the first nutation of a run to
/// its end the difference would grow by a factor of 2.5 to 4, as the beat of two nutations can.
const SMALLEST_EXPONENT: f64 = 0.2;
/// A law is named if it leaves no more than this part of the variance that the other one leaves. With a hundred windows,
/// a third of which are independent, that is a likelihood ratio of 2^(33/2), 1e5; and a constant leaves all of it.
const CLEARLY: f64 = 0.5;

/// The law by which a difference grew.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Growth {
    /// The field.
    pub field: String,
    /// The law.
    pub law: GrowthLaw,
    /// The law's parameter: the exponent p of t^p, or the rate in 1/s of an exponential; 0 if bounded.
    pub parameter: f64,
    /// The part of the variance of the logarithm that the law explains (R²); a bounded difference has a constant
    /// logarithm, which explains none of it: 0.
    pub quality: f64,
}

/// Laws of growth.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum GrowthLaw {
    /// The difference doesn't grow.
    Bounded,
    /// The difference grows as a power of time.
    Power,
    /// The difference grows exponentially.
    Exponential,
}

/// The largest difference in each of some hundred windows of equal length. The windows get longer with the run.
#[derive(Clone, Debug, Default)]
pub(super) struct Envelope {
    /// The length of a window, ns.
    window: u64,
    /// The window, when the difference was largest in it (s), and how large.
    peaks: Vec<(u64, f64, f64)>,
}

impl Envelope {
    /// Takes in a difference.
    pub(super) fn add(&mut self, time_ns: u64, difference: f64) {
        let size = difference.abs();
        if time_ns == 0 || !size.is_finite() || size == 0.0 {
            return;
        }
        if self.window == 0 {
            self.window = 1_000_000;
        }
        let time = time_ns as f64 / 1e9;
        let window = time_ns / self.window;
        match self.peaks.last_mut() {
            Some((last, at, peak)) if *last == window => {
                if size > *peak {
                    (*at, *peak) = (time, size);
                }
            }
            _ => self.peaks.push((window, time, size)),
        }
        if self.peaks.len() > WINDOWS {
            self.merge();
        }
    }

    /// Makes the windows twice as long.
    fn merge(&mut self) {
        self.window = self.window.saturating_mul(2);
        let mut merged: Vec<(u64, f64, f64)> = Vec::with_capacity(WINDOWS);
        for (window, at, peak) in self.peaks.drain(..) {
            match merged.last_mut() {
                Some((last, time, highest)) if *last == window / 2 => {
                    if peak > *highest {
                        (*time, *highest) = (at, peak);
                    }
                }
                _ => merged.push((window / 2, at, peak)),
            }
        }
        self.peaks = merged;
    }

    /// The law by which the differences beyond their errors grow, if one fits clearly better than the others.
    pub(super) fn law(&self, field: String, errors: f64) -> Option<Growth> {
        let peaks: Vec<_> = self.peaks.iter().filter(|peak| peak.2 > errors).collect();
        if peaks.len() < FEWEST {
            return None;
        }
        let logarithms: Vec<f64> = peaks.iter().map(|peak| ln(peak.2)).collect();
        let power = Line::through(peaks.iter().map(|peak| ln(peak.1)), &logarithms);
        let exponential = Line::through(peaks.iter().map(|peak| peak.1), &logarithms);
        if power.slope.abs() < SMALLEST_EXPONENT {
            return Some(Growth {
                field,
                law: GrowthLaw::Bounded,
                parameter: 0.0,
                quality: 0.0,
            });
        }
        let (law, best, other) = if power.explained >= exponential.explained {
            (GrowthLaw::Power, power, exponential)
        } else {
            (GrowthLaw::Exponential, exponential, power)
        };
        let is_clear = 1.0 - best.explained < CLEARLY * (1.0 - other.explained);
        is_clear.then_some(Growth {
            field,
            law,
            parameter: best.slope,
            quality: best.explained,
        })
    }
}

/// A straight line of least squares.
struct Line {
    slope: f64,
    /// The part of the variance of y that it explains.
    explained: f64,
}

impl Line {
    fn through(x: impl Iterator<Item = f64>, y: &[f64]) -> Self {
        let x: Vec<f64> = x.collect();
        let count = y.len() as f64;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / count;
        let (mean_x, mean_y) = (mean(&x), mean(y));
        let (mut xx, mut xy, mut yy) = (0.0, 0.0, 0.0);
        for (x, y) in x.iter().zip(y) {
            let (x, y) = (x - mean_x, y - mean_y);
            xx += x * x;
            xy += x * y;
            yy += y * y;
        }
        Self {
            slope: if xx > 0.0 { xy / xx } else { 0.0 },
            explained: if xx > 0.0 && yy > 0.0 {
                xy * xy / (xx * yy)
            } else {
                0.0
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::math::{exp, sin};

    fn law(difference: impl Fn(f64) -> f64) -> Growth {
        let mut envelope = Envelope::default();
        for i in 0..20_000_u64 {
            envelope.add(i * 1_000_000, difference(i as f64 / 1e3));
        }
        envelope.law("x".to_owned(), 0.0).unwrap()
    }

    #[test]
    fn val_known_laws_are_recognised() {
        let linear = law(|t| 1e-6 * t * (1.0 + 0.5 * sin(140.0 * t)));
        assert_eq!(linear.law, GrowthLaw::Power);
        assert!((linear.parameter - 1.0).abs() < 0.02, "{linear:?}");
        let square = law(|t| -3e-4 * t * t);
        assert_eq!(square.law, GrowthLaw::Power);
        assert!(
            (square.parameter - 2.0).abs() < 1e-9 && square.quality > 0.999_999,
            "{square:?}"
        );
        let exponential = law(|t| 1e-9 * exp(0.7 * t) * sin(140.0 * t));
        assert_eq!(exponential.law, GrowthLaw::Exponential);
        assert!(
            (exponential.parameter - 0.7).abs() < 0.01,
            "{exponential:?}"
        );
        assert_eq!(law(|t| 1e-3 * sin(140.0 * t)).law, GrowthLaw::Bounded);
    }

    #[test]
    fn nothing_is_said_of_no_difference() {
        let mut envelope = Envelope::default();
        envelope.add(5, 0.0);
        assert_eq!(envelope.law("x".to_owned(), 0.0), None);
    }
}
