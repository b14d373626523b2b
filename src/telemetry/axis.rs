//! Ranges of axes that don't magnify rounding errors until they fill the picture.

/// The shortest axis, relative to the magnitude of its values.
const MIN_SPAN: f64 = 0.01;

/// A range of an axis that contains these values: from the least to the greatest, or around them a range of 1 % of their
/// magnitude, or of `least`, if that is longer.
pub(crate) fn range_of_values([low, high]: [f64; 2], least: f64) -> [f64; 2] {
    let span = least.max(MIN_SPAN * low.abs().max(high.abs()));
    if high - low >= span {
        return [low, high];
    }
    let middle = f64::midpoint(low, high);
    [middle - 0.5 * span, middle + 0.5 * span]
}

#[cfg(test)]
mod tests {
    use super::*;

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
