//! Ranges of values that axes show.

use super::shape::Point;

/// Number of time intervals into which a curve is divided to find spikes.
const INTERVALS: usize = 256;

/// Curves with fewer non-empty intervals have no spikes, because one interval is too large a fraction.
const MIN_INTERVALS: usize = 40;

/// Maximum fraction of the time occupied by a spike, upward or downward.
const SPIKE_TIME: f64 = 0.1;

/// With a spike, the rest of the curve occupies less than this fraction of the axis.
const FLAT: f64 = 0.1;

/// Padding of the axis where it clips a spike, relative to the range of the rest of the curve.
const SPIKE_PADDING: f64 = 0.5;

/// The shortest axis, relative to the magnitude of its values.
const MIN_SPAN: f64 = 0.01;

/// The empty range, contained in any other.
pub(crate) const EMPTY: (f64, f64) = (f64::INFINITY, f64::NEG_INFINITY);

/// The least and the greatest of the numbers that are finite.
pub(crate) fn extremes(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values
        .filter(|value| value.is_finite())
        .fold(EMPTY, |range, value| union(range, (value, value)))
}

/// The smallest range that contains two others.
pub(crate) fn union(one: (f64, f64), other: (f64, f64)) -> (f64, f64) {
    (one.0.min(other.0), one.1.max(other.1))
}

/// The range, or one with the same middle that is 1 % of its magnitude long, or `least`, if that is longer. A shorter axis
/// would magnify rounding errors.
pub(crate) fn widened((low, high): (f64, f64), least: f64) -> (f64, f64) {
    let span = least.max(MIN_SPAN * low.abs().max(high.abs()));
    if high - low >= span {
        return (low, high);
    }
    let middle = f64::midpoint(low, high);
    (middle - 0.5 * span, middle + 0.5 * span)
}

/// Whether two ranges have values in common.
pub(crate) fn overlap(one: (f64, f64), other: (f64, f64)) -> bool {
    one.0 <= other.1 && other.0 <= one.1
}

/// The range of a curve; if brief spikes would flatten the rest, the range of the rest with padding.
pub(crate) fn without_spikes(points: &[Point]) -> (f64, f64) {
    let all = extremes(points.iter().map(|point| point.1));
    let (mut lows, mut highs) = extremes_of_intervals(points);
    if lows.len() < MIN_INTERVALS {
        return all;
    }
    lows.sort_unstable_by(f64::total_cmp);
    highs.sort_unstable_by(|one, other| other.total_cmp(one));
    // A spike lasts at most this many intervals, so the next lowest and highest ones belong to the rest.
    let spike = (SPIKE_TIME * lows.len() as f64) as usize;
    let (low, high) = (lows[spike], highs[spike]);
    let rest = (high - low).max(0.0);
    if rest >= FLAT * (all.1 - all.0) {
        return all;
    }
    let padding = SPIKE_PADDING * rest;
    (all.0.max(low - padding), all.1.min(high + padding))
}

/// The least and the greatest values of a curve in the time intervals that have values.
fn extremes_of_intervals(points: &[Point]) -> (Vec<f64>, Vec<f64>) {
    let (first, last) = extremes(points.iter().map(|point| point.0));
    let width = (last - first) / INTERVALS as f64;
    let finite: Vec<Point> = points
        .iter()
        .copied()
        .filter(|point| point.1.is_finite())
        .collect();
    finite
        .chunk_by(|a, b| ((a.0 - first) / width).floor() == ((b.0 - first) / width).floor())
        .map(|interval| extremes(interval.iter().map(|point| point.1)))
        .unzip()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve(value: impl Fn(f64) -> f64) -> Vec<Point> {
        let times = (0..=10_000).map(|i| f64::from(i) * 1e-3);
        times.map(|time| (time, value(time))).collect()
    }

    #[test]
    fn clips_brief_spikes() {
        // From −1 to 1 and back, every two seconds.
        let spike = |t: f64| {
            1.0 - 2.0 * (t % 2.0 - 1.0).abs()
                + if (5.0..5.1).contains(&t) {
                    -4000.0
                } else {
                    0.0
                }
        };
        let (low, high) = without_spikes(&curve(spike));
        assert!(
            (-2.5..=-1.0).contains(&low) && (0.99..=1.0).contains(&high),
            "{low} {high}"
        );
    }

    #[test]
    fn clips_poles() {
        let (low, high) = without_spikes(&curve(|t| 1.0 / (10.000_001 - t)));
        assert!(low == 1.0 / 10.000_001 && high < 5.0, "{low} {high}");
    }

    #[test]
    fn keeps_steady_growth() {
        for value in [
            |t: f64| t,
            |t: f64| t * t * t * t,
            |t: f64| 1.0 / (10.5 - t),
        ] {
            let points = curve(value);
            let all = extremes(points.iter().map(|point| point.1));
            assert_eq!(without_spikes(&points), all);
        }
    }

    #[test]
    fn keeps_all_of_few_points() {
        let points = [(0.0, 1.0), (1.0, 1.0), (2.0, 1e6), (3.0, 1.0)];
        assert_eq!(without_spikes(&points), (1.0, 1e6));
        assert_eq!(without_spikes(&[]), EMPTY);
    }

    #[test]
    fn noise_is_not_magnified() {
        let (low, high) = widened((1.0856, 1.0856 + 1e-14), 0.0);
        assert!(low < 1.0803 && high > 1.0909, "{low} to {high}");
        assert_eq!(widened((-1e-17, 1e-17), 2.0), (-1.0, 1.0));
        assert_eq!(widened((1.0, 1.02), 0.0), (1.0, 1.02));
        assert_eq!(widened((0.0, 0.0), 0.0), (0.0, 0.0));
    }

    #[test]
    fn touching_ranges_overlap() {
        assert!(overlap((0.0, 1.0), (1.0, 2.0)) && overlap((0.0, 9.0), (1.0, 2.0)));
        assert!(!overlap((0.0, 1.0), (1.5, 2.0)) && !overlap((0.0, 1.0), EMPTY));
    }
}
