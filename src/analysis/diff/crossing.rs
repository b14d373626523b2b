//! Level crossings of the mean θ of two runs, and the effect of nutation on the first crossing.
//!
//! θ averaged over each nutation is a curve through the middles of the cycles. The crossing times of a common level
//! show which run is ahead. The first crossing of θ itself is discontinuous: it depends on which nutation minimum
//! reaches the level.

use crate::analysis::history::curve::Curve;
use crate::analysis::history::{Cycle, RunHistory};
use crate::physics::integrate::zero;
use crate::physics::math::{atan2, cos};
use std::f64::consts::{PI, TAU};

/// Required ratio of the change of the averages to their error.
const CLEAR: f64 = 10.0;
/// Number of trial levels, evenly spaced from the farthest common level to the start.
const LEVELS: u32 = 16;
/// Minimum slope at a crossing, relative to the mean slope before it.
const STEADY: f64 = 0.2;
/// Relative distance of the neighbouring levels used to estimate the uncertainty.
const NEARBY: f64 = 0.02;
/// Ratio of the leave-one-out error to the interpolation error of a cubic.
const LEFT_OUT: f64 = 4.0;

/// A level of θ that both averaged motions cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanCrossing {
    /// The level, rad.
    pub(super) level: f64,
    /// The times at which A and B cross it, s.
    pub(super) times: [f64; 2],
    /// Uncertainty of the difference of these times, s.
    pub(super) uncertainty: f64,
    /// Contribution of the integration errors, s.
    pub(super) integration_error: f64,
}

impl MeanCrossing {
    /// The farthest level that both averaged motions cross in the same direction with a known slope, if there is such a
    /// level. `integrators` are the errors of A's and B's averaged θ, rad.
    pub(super) fn find(a: &RunHistory, b: &RunHistory, integrators: [f64; 2]) -> Option<Self> {
        let histories = common([a, b]);
        (1..LEVELS).find_map(|part| {
            let part = f64::from(part) / f64::from(LEVELS);
            // Rising tops first: their θ falls.
            [1.0, -1.0]
                .into_iter()
                .find_map(|sign| Self::at_level(sign, part, histories, integrators))
        })
    }

    /// The crossing of sign · θ at a fraction of the way from the farthest common level to the start.
    fn at_level(
        sign: f64,
        part: f64,
        histories: [&RunHistory; 2],
        integrators: [f64; 2],
    ) -> Option<Self> {
        let curves = histories.map(|history| history.curve(|cycle| sign * cycle.means[0]));
        let ends = histories.map(|history| {
            let means = || {
                history
                    .successive_cycles()
                    .iter()
                    .map(|c| sign * c.means[0])
            };
            Some((means().next()?, means().reduce(f64::min)?))
        });
        let [(start_a, lowest_a), (start_b, lowest_b)] = [ends[0]?, ends[1]?];
        let (start, farthest) = (start_a.min(start_b), lowest_a.max(lowest_b));
        let descent = start - farthest;
        let level = farthest + part * descent;
        let reach = |level: f64| {
            let [a, b] = &curves;
            Some([a.first_reaches(level)?, b.first_reaches(level)?])
        };
        let times = reach(level)?;
        let (mut uncertainty, mut integration_error) = (0.0_f64, 0.0);
        for side in 0..2 {
            let (curve, time) = (&curves[side], times[side]);
            let slope = curve.slope(time)?.abs();
            let (first, _) = curve.domain()?;
            let mean_slope = (start - level) / (time - first);
            let error = integrators[side]
                + interpolation_error(curve, time)
                + averaging_error(histories[side], time);
            // Also rejects NaN.
            let crosses = slope >= STEADY * mean_slope && start - level > CLEAR * error;
            if !crosses {
                return None;
            }
            uncertainty += error / slope;
            integration_error += integrators[side] / slope;
        }
        let shift = times[1] - times[0];
        for near in [level - NEARBY * descent, level + NEARBY * descent] {
            let [a, b] = reach(near)?;
            uncertainty = uncertainty.max((b - a - shift).abs());
        }
        uncertainty.is_finite().then_some(Self {
            level: sign * level,
            times,
            uncertainty,
            integration_error,
        })
    }
}

/// Truncates both runs to their common cycles if one is a prefix of the other; later averages would change the
/// interpolation.
fn common([a, b]: [&RunHistory; 2]) -> [&RunHistory; 2] {
    let length = |history: &RunHistory| history.successive_cycles().len();
    let (short, long) = if length(a) <= length(b) {
        (a, b)
    } else {
        (b, a)
    };
    let is_same = |(x, y): (&Cycle, &Cycle)| {
        x.start == y.start && x.period == y.period && x.means[0] == y.means[0]
    };
    let mut pairs = short
        .successive_cycles()
        .iter()
        .zip(long.successive_cycles());
    if pairs.all(is_same) {
        [short, short]
    } else {
        [a, b]
    }
}

/// Interpolation error of a curve near a time, by leave-one-out.
fn interpolation_error(curve: &Curve, time: f64) -> f64 {
    curve
        .left_out(time)
        .map_or(0.0, |error| error.abs() / LEFT_OUT)
}

/// Averaging error of the mean over a nutation, rad: if the amplitude changes by ΔA per cycle, the mean of A cos 2πs is
/// off by up to ΔA/2π.
fn averaging_error(history: &RunHistory, time: f64) -> f64 {
    let amplitude = history.curve(amplitude);
    let Some((first, last)) = amplitude.domain() else {
        return 0.0;
    };
    let period = history.curve(|cycle| cycle.period).at(time);
    let period = period.unwrap_or_default().min(last - first);
    // Equal ends may differ by rounding.
    let end = time.max(first + 0.5 * period).min(last - 0.5 * period);
    let at = |time: f64| amplitude.at(time).unwrap_or_default();
    (at(end + 0.5 * period) - at(end - 0.5 * period)).abs() / TAU
}

/// The amplitude of θ in a nutation, rad: that of θ̇ over the frequency.
fn amplitude(cycle: &Cycle) -> f64 {
    cycle.amplitude() * cycle.period / TAU
}

/// Range of the delay of the first crossing of θ relative to its mean, s (negative: earlier), over all nutation phases;
/// `None` if the nutation is unknown.
///
/// Amplitude and drift are evaluated at the first crossing, because they can change during a large lead.
pub(super) fn ripple(history: &RunHistory, time: f64) -> Option<[f64; 2]> {
    let of_theta = history.curve(amplitude);
    let of_rate = history.curve(Cycle::amplitude);
    let (first, last) = of_rate.domain()?;
    let crossing = time.clamp(first, last);
    let mean = history.curve(|cycle| cycle.means[0]);
    let earlier = |time: f64| Some(of_theta.at(time)? / mean.slope(time)?.abs());
    let later = |time: f64| {
        let ratio = of_rate.at(time)? / mean.slope(time)?.abs();
        Some(earlier(time)? * latest(ratio))
    };
    let since = crossing - earlier(crossing)?;
    let middles = history.successive_cycles().iter().map(Cycle::middle);
    let times = middles.filter(|middle| (since..crossing).contains(middle));
    let mut range = [0.0_f64, f64::NEG_INFINITY];
    for time in times.chain([crossing]) {
        range = [range[0].min(-earlier(time)?), range[1].max(later(time)?)];
    }
    range.iter().all(|time| time.is_finite()).then_some(range)
}

/// Latest first crossing of a level by θ = −x + r cos x, relative to r (amplitude of θ̇ over its mean).
///
/// For r ≤ 1, θ is monotonic and the crossing is up to r later. For r > 1, a minimum just above the level delays the
/// crossing to the next descent.
fn latest(ratio: f64) -> f64 {
    if ratio <= 1.0 {
        return 1.0;
    }
    let theta = |x: f64| ratio * cos(x) - x;
    // θ is least in a dip where −1 − r sin x = 0, and greatest before the next descent.
    let angle = atan2(1.0, (ratio * ratio - 1.0).sqrt());
    let (dip, top) = (PI + angle, TAU - angle);
    let lowest = theta(dip);
    let above = |s: f64| theta(top + s * (dip + TAU - top)) - lowest;
    let part = zero(above(0.0), above(1.0), above);
    let begin = top + part * (dip + TAU - top);
    if begin <= TAU {
        1.0
    } else {
        cos(begin).max(cos(dip))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against a search over all phases.
    #[test]
    fn val_first_touches_lie_between_the_earliest_and_the_latest() {
        for ratio in [0.2, 0.99, 1.01, 1.5, 3.4, 20.0] {
            let theta = |x: f64| ratio * cos(x) - x;
            let (mut lowest, mut earliest, mut last) = (f64::INFINITY, 0.0_f64, -1.0_f64);
            for i in 0..400_000_u32 {
                // Long enough for the start to have no effect.
                let x = f64::from(i) * 1e-4 * (1.0 + ratio);
                let y = theta(x);
                if y < lowest {
                    lowest = y;
                    // The average is at this level when −x is y.
                    if x > 3.0 * TAU * (1.0 + ratio / TAU) {
                        earliest = earliest.min((x + y) / ratio);
                        last = last.max((x + y) / ratio);
                    }
                }
            }
            assert!((earliest + 1.0).abs() < 1e-5, "{ratio}: {earliest}");
            assert!((last - latest(ratio)).abs() < 1e-3, "{ratio}: {last}");
        }
    }
}
