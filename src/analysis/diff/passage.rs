//! By how much the averaged motion of B is shifted against A's, and what the nutation does to the first touch.
//!
//! θ averaged over each nutation is a curve through the middles of the cycles. Where two tops rise (or fall), the
//! times at which both curves pass a common level tell which is ahead. When θ itself first touches a level is a
//! staircase beside that: it depends on which dip of the nutation reaches the level.

use crate::analysis::course::curve::Curve;
use crate::analysis::course::{Course, Cycle};
use crate::physics::integrate::zero;
use crate::physics::math::{atan2, cos};
use std::f64::consts::{PI, TAU};

/// A motion goes somewhere if its averages change by so many times their errors: the errors are estimates, which may
/// miss by a factor of a few ([`averaging_error`] is that of one phase), and less may be nothing but errors.
const CLEAR: f64 = 10.0;
/// So many levels are tried, evenly from the farthest to the start: a shift that is only clear between two of them is
/// not clear over a sixteenth of the way.
const LEVELS: u32 = 16;
/// How much smaller the error of a cubic between four points is than where the middle one of five is left out: the
/// products of the distances are 4 and at most 0.94 (between the last two points).
const LEFT_OUT: f64 = 4.0;

/// How two averaged motions pass a level of θ.
#[derive(Clone, Debug)]
pub(super) struct LevelPassage {
    /// The level, rad.
    pub(super) level: f64,
    /// When A and B pass it, s.
    pub(super) times: [f64; 2],
    /// How exactly the shift is known, s.
    pub(super) uncertainty: f64,
    /// A's averaged θ over time, times −1 where the tops fall; and the time over B's.
    from: Curve,
    to: Curve,
    /// How long a nutation takes there, s.
    period: f64,
}

/// Which way averaged motions go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Rising,
    Falling,
}

impl Way {
    /// What θ is multiplied by so that it falls.
    fn sign(self) -> f64 {
        match self {
            Self::Rising => 1.0,
            Self::Falling => -1.0,
        }
    }
}

impl LevelPassage {
    /// Finds how both averaged motions pass the farthest level that both reach, if they go anywhere, and the same way.
    /// `integrators` are the errors of A's and B's averaged θ, rad.
    pub(super) fn find(a: &Course, b: &Course, integrators: [f64; 2]) -> Option<Self> {
        let courses = common([a, b]);
        [Way::Rising, Way::Falling]
            .into_iter()
            .find_map(|way| Self::on_the_way(way, courses, integrators))
    }

    /// The passage of the farthest level at which the shift is larger than its uncertainty, or of the farthest. There a
    /// motion may come to rest, as one that has risen to upright does, and the time at which it passes a level is not known.
    fn on_the_way(way: Way, courses: [&Course; 2], integrators: [f64; 2]) -> Option<Self> {
        let parts = (0..LEVELS).map(|part| f64::from(part) / f64::from(LEVELS));
        let mut passages = parts.filter_map(|part| Self::at_level(way, part, courses, integrators));
        let farthest = passages.next()?;
        if farthest.is_clear() {
            return Some(farthest);
        }
        Some(passages.find(Self::is_clear).unwrap_or(farthest))
    }

    fn is_clear(&self) -> bool {
        self.shift().abs() > self.uncertainty
    }

    /// The passage of a level: a `part` of the way back from the farthest that both reach to where they start.
    fn at_level(way: Way, part: f64, courses: [&Course; 2], integrators: [f64; 2]) -> Option<Self> {
        let sign = way.sign();
        let means = |course: &Course| -> Vec<f64> {
            course.cycles.iter().map(|c| sign * c.means[0]).collect()
        };
        let [a, b] = courses.map(means);
        let lowest = |means: &[f64]| means.iter().copied().reduce(f64::min);
        let farthest = lowest(&a)?.max(lowest(&b)?);
        let start = a.first()?.min(*b.first()?);
        let level = farthest + part * (start - farthest);
        let curves = courses.map(|course| course.of_cycles(|cycle| sign * cycle.means[0]));
        let [from, to] = curves;
        let times = [from.first_reaches(level)?, to.first_reaches(level)?];
        let mut uncertainty = 0.0;
        for (side, curve) in [&from, &to].into_iter().enumerate() {
            let course = courses[side];
            let drift = curve.slope(times[side])?;
            let error = integrators[side]
                + interpolation_error(curve, times[side])
                + averaging_error(course, times[side]);
            let descent = start - level;
            // A descent that isn't a number is none.
            if descent.is_nan() || descent <= CLEAR * error {
                return None;
            }
            uncertainty += error / drift.abs();
        }
        let period = courses[1].of_cycles(|cycle| cycle.period).at(times[1])?;
        uncertainty.is_finite().then(|| Self {
            level: sign * level,
            times,
            uncertainty,
            from,
            to: to.inverse(),
            period,
        })
    }

    /// By how much B passes the level later, s.
    pub(super) fn shift(&self) -> f64 {
        self.times[1] - self.times[0]
    }

    /// When B's averaged motion is where A's is at a time (s), and how long a nutation takes there, s; none where B's
    /// never is.
    pub(super) fn counterpart(&self, time: f64) -> Option<(f64, f64)> {
        let level = extended(&self.from, time, self.period)?;
        let (lowest, highest) = self.to.domain()?;
        // As far beyond its first and last average as it goes in a nutation.
        let (first, last) = (self.to.at(highest)?, self.to.at(lowest)?);
        let reach = (highest - lowest) * self.period / (last - first);
        let counterpart = extended(&self.to, level, reach)?;
        Some((counterpart, self.period))
    }
}

/// Two runs; where one is the beginning of the other only that: the averages that follow would bend the curve through the
/// last of those that both have, as if they were shifted.
fn common([a, b]: [&Course; 2]) -> [&Course; 2] {
    let (short, long) = if a.cycles.len() <= b.cycles.len() {
        (a, b)
    } else {
        (b, a)
    };
    let is_same = |(x, y): (&Cycle, &Cycle)| {
        x.start == y.start && x.period == y.period && x.means[0] == y.means[0]
    };
    if short.cycles.iter().zip(&long.cycles).all(is_same) {
        [short, short]
    } else {
        [a, b]
    }
}

/// A curve, continued on straight lines for some way beyond its ends.
fn extended(curve: &Curve, x: f64, beyond: f64) -> Option<f64> {
    let (first, last) = curve.domain()?;
    if let Some(y) = curve.at(x) {
        return Some(y);
    }
    if !(first - beyond <= x && x <= last + beyond) {
        return None;
    }
    let end = if x < first { first } else { last };
    let step = (1e-3 * (last - first)).copysign(0.5 * (first + last) - end);
    let slope = (curve.at(end + step)? - curve.at(end)?) / step;
    Some(curve.at(end)? + slope * (x - end))
}

/// How far the cubic between averages can be off at a time, rad: as far as it is at the next average if that is left
/// out, but for the distance.
fn interpolation_error(curve: &Curve, time: f64) -> f64 {
    curve
        .left_out(time)
        .map_or(0.0, |error| error.abs() / LEFT_OUT)
}

/// What an average over a nutation keeps of it, rad: where the amplitude A changes by ΔA from one to the next, the
/// mean of A cos 2πs over a turn is up to ΔA/2π, depending on where the turn begins.
fn averaging_error(course: &Course, time: f64) -> f64 {
    let amplitude = course.of_cycles(amplitude);
    let Some((first, last)) = amplitude.domain() else {
        return 0.0;
    };
    let period = course.of_cycles(|cycle| cycle.period).at(time);
    let period = period.unwrap_or_default().min(last - first);
    // Where both ends are one, they may be a rounding apart, in either order.
    let end = time.max(first + 0.5 * period).min(last - 0.5 * period);
    let at = |time: f64| amplitude.at(time).unwrap_or_default();
    (at(end + 0.5 * period) - at(end - 0.5 * period)).abs() / TAU
}

/// The amplitude of θ in a nutation, rad: that of θ̇ over the frequency.
fn amplitude(cycle: &Cycle) -> f64 {
    cycle.amplitude() * cycle.period / TAU
}

/// How much earlier (negative) and later θ can first touch a level than its average does, s, depending on the phase of
/// the nutation there; none where the nutation isn't known.
///
/// Amplitude and drift are taken at the touch and over the time by which it is early, for which a large nutation
/// changes both.
pub(super) fn ripple(course: &Course, time: f64) -> Option<[f64; 2]> {
    let (first, last) = course.of_cycles(Cycle::amplitude).domain()?;
    let touch = time.clamp(first, last);
    let (of_theta, of_rate) = (
        course.of_cycles(amplitude),
        course.of_cycles(Cycle::amplitude),
    );
    let mean = course.of_cycles(|cycle| cycle.means[0]);
    let earlier = |time: f64| Some(of_theta.at(time)? / mean.slope(time)?.abs());
    let later = |time: f64| {
        let ratio = of_rate.at(time)? / mean.slope(time)?.abs();
        Some(earlier(time)? * latest(ratio))
    };
    let since = touch - earlier(touch)?;
    let middles = course.cycles.iter().map(Cycle::middle);
    let times = middles
        .filter(|middle| (since..touch).contains(middle))
        .chain([touch]);
    let mut range = [0.0_f64, f64::NEG_INFINITY];
    for time in times {
        range = [range[0].min(-earlier(time)?), range[1].max(later(time)?)];
    }
    range.iter().all(|time| time.is_finite()).then_some(range)
}

/// How late θ = −x + r cos x can first be at a level, as a part of r, where r is the amplitude of θ̇ over its mean.
///
/// Where θ falls all the time (r ≤ 1), a level is touched once, up to r later than by the average. Where it doesn't, a
/// dip that ends just above the level leaves it to the next descent, which is early if the dips are deep.
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
                // Long enough to forget the start.
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
