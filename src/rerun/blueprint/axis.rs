//! Ranges of value axes: their ticks are labelled, and rounding errors don't fill them.

use crate::physics::math;
use crate::rerun::identity::magnitude::Magnitudes;
use crate::rerun::plots::Plots;
use crate::rerun::plots::curves::Curves;
use crate::telemetry::arrows::scale::power_of_ten;

/// Shortest value axis, relative to the typical magnitude of its quantity.
pub(in crate::rerun) const MIN_SPAN: f64 = 1e-6;

/// Maximum length of an axis relative to the range of its values, for three labelled ticks instead of two.
const MAX_STRETCH: f64 = 1.6;

/// The range of an axis for the values of these curves in some runs, at least `least` times as long as the quantity's typical
/// magnitude. None if the viewer's choice, the range of the values, is as good.
pub(in crate::rerun) fn axis_range(
    curves: &[Curves],
    runs: &[&Plots],
    magnitudes: &Magnitudes,
    least: f64,
) -> Option<[f64; 2]> {
    let mut values = [f64::INFINITY, f64::NEG_INFINITY];
    let mut typical = 0.0_f64;
    for run in runs {
        for (quantity, range) in curves.iter().flat_map(|curves| run.ranges(*curves)) {
            values = [values[0].min(range[0]), values[1].max(range[1])];
            typical = typical.max(magnitudes.typical(quantity));
        }
    }
    if curves.iter().any(|curves| curves.includes_zero()) {
        values = [values[0].min(0.0), values[1].max(0.0)];
    }
    let shown = range_of_values(values, least * typical);
    let range = value_range(shown)?;
    (values != range).then_some(range)
}

/// A range that contains these values, with three labelled ticks if they are near, otherwise with two; `None` if the values
/// are equal.
pub(in crate::rerun) fn value_range(values: [f64; 2]) -> Option<[f64; 2]> {
    let [first, last] = with_ticks(values, 3.0)?;
    if last - first <= MAX_STRETCH * (values[1] - values[0]) {
        Some([first, last])
    } else {
        with_ticks(values, 2.0)
    }
}

/// The shortest axis, relative to the magnitude of its values.
const MIN_RELATIVE_SPAN: f64 = 0.01;

/// A range of an axis that contains these values: from the least to the greatest, or around them a range of 1 % of their
/// magnitude, or of `least`, if that is longer.
fn range_of_values([low, high]: [f64; 2], least: f64) -> [f64; 2] {
    let span = least.max(MIN_RELATIVE_SPAN * low.abs().max(high.abs()));
    if high - low >= span {
        return [low, high];
    }
    let middle = f64::midpoint(low, high);
    [middle - 0.5 * span, middle + 0.5 * span]
}

/// Maximum number of labelled ticks of a chart in four rows, in a window of 1366 × 768 points: the viewer labels powers of ten
/// if they are at least 20 points apart, and the chart is 129 points high, of which the padding takes a tenth.
const MAX_TICKS: f64 = 5.8;

/// Ranges below this fraction of the values are rounding errors.
const ROUNDING: f64 = 1e-12;

/// A range that contains these values and at least `least_ticks` labelled ticks; `None` if the values are equal.
fn with_ticks([low, high]: [f64; 2], least_ticks: f64) -> Option<[f64; 2]> {
    let size = high - low;
    let is_rounding = size <= ROUNDING * low.abs().max(high.abs());
    if is_rounding || !size.is_finite() {
        return None;
    }
    let step = power_of_ten(math::log10(size / MAX_TICKS).ceil());
    let [mut first, mut last] = [(low / step).ceil(), (high / step).floor()];
    while last - first < least_ticks - 1.0 {
        if high / step - last > first - low / step {
            last += 1.0;
        } else {
            first -= 1.0;
        }
    }
    let [least, most] = [(first * step).min(low), (last * step).max(high)];
    // The curve should not touch the frame, and a label at the frame would be cut off.
    let padding = 0.05 * (most - least);
    Some([least - padding, most + padding])
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_range_has_two_ticks(low in -1e3..1e3, size in 1e-9..1e3) {
            let [least, most] = value_range([low, low + size]).unwrap();
            prop_assert!(least <= low && low + size <= most);
            let step = power_of_ten(math::log10(size / MAX_TICKS).ceil());
            let ticks = (most / step).floor() - (least / step).ceil() + 1.0;
            prop_assert!((2.0..=MAX_TICKS + 3.0).contains(&ticks), "{ticks} from {least} to {most}");
            // At worst, a tick is in the middle of values that span a tenth of `MAX_TICKS` steps, so that the next tick is
            // a whole step away from it: half of the values and a step, and 5 % at both ends.
            let longest = 1.1 * (0.5 + 10.0 / MAX_TICKS) * size;
            prop_assert!(most - least <= 1.001 * longest, "{least} to {most}");
        }
    }

    #[test]
    fn equal_values_have_no_range() {
        assert_eq!(value_range([1.0, 1.0]), None);
        assert_eq!(value_range([1.0, 1.0_f64.next_up()]), None);
        assert_eq!(value_range([0.0, 0.0]), None);
        assert_eq!(value_range([f64::INFINITY, f64::NEG_INFINITY]), None);
    }

    #[test]
    fn noise_is_not_magnified() {
        let [low, high] = range_of_values([1.0856, 1.0856 + 1e-14], 0.0);
        assert!(low < 1.0803 && high > 1.0909, "{low} to {high}");
        assert_eq!(range_of_values([-1e-17, 1e-17], 2.0), [-1.0, 1.0]);
    }

    #[test]
    fn variations_keep_their_range() {
        assert_eq!(range_of_values([1.0, 1.02], 0.0), [1.0, 1.02]);
        assert_eq!(range_of_values([-3.0, 5.0], 1.0), [-3.0, 5.0]);
        assert_eq!(range_of_values([0.0, 0.0], 0.0), [0.0, 0.0]);
    }
}
