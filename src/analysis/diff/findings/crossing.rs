//! Level crossings of the mean θ of two runs, and the effect of nutation on the first crossing.
//!
//! θ averaged over each nutation is a curve through the middles of the cycles. The crossing times of a common level
//! show which run is ahead. The first crossing of θ itself is discontinuous: it depends on which nutation minimum
//! reaches the level.

use crate::analysis::history::curve::CubicCurve;
use crate::analysis::history::{Cycle, RunHistory};
use std::f64::consts::TAU;

/// Required ratio of the change of the averages to their error.
const MIN_CHANGE: f64 = 10.0;
/// Number of trial levels, evenly spaced from the farthest common level to the start.
const LEVELS: u32 = 16;
/// Minimum slope at a crossing, relative to the mean slope before it.
const MIN_SLOPE: f64 = 0.2;
/// Distance of the lower level that shows the dependence on the level, relative to it.
const LOWER: f64 = 0.02;
/// Ratio of the leave-one-out error to the interpolation error of a cubic.
const LEFT_OUT_RATIO: f64 = 4.0;

/// A level of θ that both averaged motions cross.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct MeanCrossing {
    /// The level, rad.
    pub(super) level: f64,
    /// The times at which A and B cross it, s.
    pub(super) times: [f64; 2],
    /// The farthest averaged θ that both come to, rad.
    pub(super) farthest: f64,
    /// Error of the difference of these times by the integrations, s.
    pub(super) integration_error: f64,
    /// The largest change of the difference by what the averages keep of the nutation, s.
    pub(super) ripple: f64,
    /// A lower level, relative to the level, and the change of the difference there, s.
    pub(super) lower: [f64; 2],
}

impl MeanCrossing {
    /// The farthest level that both averaged motions cross in the same direction with a known slope, if there is such a
    /// level. `integrators` are the errors of A's and B's averaged θ, rad.
    pub(super) fn find(a: &RunHistory, b: &RunHistory, integrators: [f64; 2]) -> Option<Self> {
        // Equal motions must cross at equal times, even if one run goes on for longer.
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
        // With the sign −1, a fall looks like a rise: both look for the least value.
        let curves = histories.map(|history| history.curve(|cycle| sign * cycle.means[0]));
        let (start_a, lowest_a) = start_and_least(histories[0], sign)?;
        let (start_b, lowest_b) = start_and_least(histories[1], sign)?;
        let (start, farthest) = (start_a.min(start_b), lowest_a.max(lowest_b));
        let descent = start - farthest;
        let level = farthest + part * descent;
        let times = first_crossings(&curves, level)?;
        let (mut ripple, mut integration_error) = (0.0_f64, 0.0);
        for side in 0..2 {
            let (curve, time) = (&curves[side], times[side]);
            let slope = curve.slope(time)?.abs();
            let (first, _) = curve.domain()?;
            let mean_slope = (start - level) / (time - first);
            let remainder =
                interpolation_error(curve, time) + averaging_error(histories[side], time);
            // Also rejects NaN.
            let crosses = slope >= MIN_SLOPE * mean_slope
                && start - level > MIN_CHANGE * (integrators[side] + remainder);
            if !crosses {
                return None;
            }
            ripple += remainder / slope;
            integration_error += integrators[side] / slope;
        }
        // No farther than halfway to the ends of what both cross.
        let step = (LOWER * level.abs()).min(0.5 * part.min(1.0 - part) * descent);
        let [a, b] = first_crossings(&curves, level - sign * step)?;
        let change = (b - a) - (times[1] - times[0]);
        let is_finite = ripple.is_finite() && change.is_finite();
        is_finite.then_some(Self {
            level: sign * level,
            farthest: sign * farthest,
            times,
            integration_error,
            ripple,
            lower: [-step / level.abs(), change],
        })
    }
}

/// The first and the least of sign · mean θ.
fn start_and_least(history: &RunHistory, sign: f64) -> Option<(f64, f64)> {
    let cycles = history.successive_cycles();
    let start = sign * cycles.first()?.means[0];
    let mut least = start;
    for cycle in cycles {
        least = least.min(sign * cycle.means[0]);
    }
    Some((start, least))
}

/// The times at which both curves first cross a level, s.
fn first_crossings([a, b]: &[CubicCurve; 2], level: f64) -> Option<[f64; 2]> {
    Some([a.first_reaches(level)?, b.first_reaches(level)?])
}

/// Truncates both runs to their common cycles if one is a prefix of the other; later averages would change the
/// interpolation.
fn common([a, b]: [&RunHistory; 2]) -> [&RunHistory; 2] {
    let (short, long) = if a.successive_cycles().len() <= b.successive_cycles().len() {
        (a, b)
    } else {
        (b, a)
    };
    let mut pairs = short
        .successive_cycles()
        .iter()
        .zip(long.successive_cycles());
    let is_prefix =
        pairs.all(|(x, y)| x.start == y.start && x.period == y.period && x.means[0] == y.means[0]);
    if is_prefix { [short, short] } else { [a, b] }
}

/// Interpolation error of a curve near a time, by leave-one-out.
fn interpolation_error(curve: &CubicCurve, time: f64) -> f64 {
    curve
        .left_out(time)
        .map_or(0.0, |error| error.abs() / LEFT_OUT_RATIO)
}

/// Averaging error of the mean over a nutation, rad: if the amplitude changes by ΔA per cycle, the mean of A cos 2πs is
/// off by up to ΔA/2π.
fn averaging_error(history: &RunHistory, time: f64) -> f64 {
    let amplitude = history.curve(Cycle::amplitude_of_theta);
    let Some((first, last)) = amplitude.domain() else {
        return 0.0;
    };
    let period = history
        .curve(|cycle| cycle.period)
        .at(time)
        .unwrap_or_default()
        .min(last - first);
    // Equal ends may differ by rounding.
    let end = time.max(first + 0.5 * period).min(last - 0.5 * period);
    let [before, after] =
        [end - 0.5 * period, end + 0.5 * period].map(|time| amplitude.at(time).unwrap_or_default());
    (after - before).abs() / TAU
}

/// The largest shift of the first crossing of θ from that of its mean, s, over all nutation phases; `None` if the nutation
/// is unknown. A first crossing can be earlier than that of the mean by the whole amplitude, and is never later by more.
///
/// Amplitude and drift are evaluated at the first crossing, because they can change during a large lead.
pub(super) fn ripple(history: &RunHistory, time: f64) -> Option<f64> {
    let amplitude = history.curve(Cycle::amplitude_of_theta);
    let mean = history.curve(|cycle| cycle.means[0]);
    let (first, last) = amplitude.domain()?;
    let crossing = time.clamp(first, last);
    let mut largest = shift(&amplitude, &mean, crossing)?;
    // Only nutations from here on can dip to the level.
    let since = crossing - largest;
    for cycle in history.successive_cycles() {
        if (since..crossing).contains(&cycle.middle()) {
            largest = largest.max(shift(&amplitude, &mean, cycle.middle())?);
        }
    }
    largest.is_finite().then_some(largest)
}

/// By how much a first crossing at a time, s, can precede that of the mean, s: the drift takes that long for the amplitude.
fn shift(amplitude: &CubicCurve, mean: &CubicCurve, time: f64) -> Option<f64> {
    Some(amplitude.at(time)? / mean.slope(time)?.abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::math::cos;

    /// θ = −x + r cos x falls by 1 in a radian of the nutation. Against a search over all phases.
    #[test]
    fn val_first_crossings_are_within_the_ripple() {
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
            assert!(last <= 1.0, "{ratio}: {last}");
        }
    }
}
