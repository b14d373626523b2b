//! Values along an axis.

use super::runs::MapAxis;
use crate::figures::plot::frame::Quantity;
use crate::figures::plot::range::extremes;
use crate::figures::plot::ticks::Scale;
use crate::physics::math::log10;

/// Range ratio from which an axis is logarithmic, unless the spacing is linear.
const LOGARITHMIC: f64 = 30.0;

/// Range ratio from which the colour scale is logarithmic.
const LOGARITHMIC_COLOURS: f64 = 10.0;

/// Spacings that differ by less than this fraction are equal.
const EVEN: f64 = 1e-6;

/// Values along an axis, which may be logarithmic.
pub(super) struct AxisValues {
    pub(super) quantity: Quantity,
    is_log: bool,
    /// Each different value once, in order.
    pub(super) values: Vec<f64>,
}

impl AxisValues {
    /// Values along an axis of a plot. It is logarithmic if they form a grid with evenly spaced logarithms, or no grid
    /// and differ widely.
    pub(super) fn new(axis: &MapAxis, values: Vec<f64>) -> Self {
        let values = sorted(values);
        Self {
            quantity: axis.quantity(),
            is_log: !is_even(&values) && (is_spread(&values, LOGARITHMIC) || is_log_even(&values)),
            values,
        }
    }

    /// Values on the colour scale.
    pub(super) fn for_colours(axis: &MapAxis, values: Vec<f64>) -> Self {
        let values = sorted(values);
        Self {
            quantity: axis.quantity(),
            is_log: is_spread(&values, LOGARITHMIC_COLOURS),
            values,
        }
    }

    /// The position of a value on the axis: its logarithm if the axis is logarithmic.
    pub(super) fn position(&self, value: f64) -> f64 {
        if self.is_log { log10(value) } else { value }
    }

    /// The range of positions.
    pub(super) fn range(&self) -> (f64, f64) {
        extremes(self.values.iter().map(|value| self.position(*value)))
    }

    /// The positions of the cell boundaries, halfway between neighbouring values; a single value gets a tenth of it on
    /// both sides.
    pub(super) fn edges(&self) -> Vec<f64> {
        let positions: Vec<f64> = self
            .values
            .iter()
            .map(|value| self.position(*value))
            .collect();
        let (Some(first), Some(last)) = (positions.first(), positions.last()) else {
            return Vec::new();
        };
        let between: Vec<f64> = positions
            .windows(2)
            .map(|pair| f64::midpoint(pair[0], pair[1]))
            .collect();
        // The cell of a single value has no neighbours that could give it a size.
        let margin = if *first == 0.0 {
            1.0
        } else {
            0.1 * first.abs()
        };
        let low = first - between.first().map_or(margin, |edge| edge - first);
        let high = last + between.last().map_or(margin, |edge| last - edge);
        [vec![low], between, vec![high]].concat()
    }

    /// Index of a value among the distinct values.
    pub(super) fn index(&self, value: f64) -> Option<usize> {
        let index = self.values.partition_point(|other| *other < value);
        (self.values.get(index) == Some(&value)).then_some(index)
    }

    /// A scale of positions with at most `max_labels` labels.
    pub(super) fn scale(&self, (low, high): (f64, f64), max_labels: usize) -> Scale {
        if self.is_log {
            Scale::logarithmic(low, high, max_labels)
        } else {
            Scale::new(low, high, max_labels)
        }
    }
}

/// The finite values, each once, in order.
fn sorted(mut values: Vec<f64>) -> Vec<f64> {
    values.retain(|value| value.is_finite());
    values.sort_by(f64::total_cmp);
    values.dedup();
    values
}

/// Whether the ratio of the last to the first of ordered values is at least this.
fn is_spread(values: &[f64], ratio: f64) -> bool {
    match values {
        [first, .., last] => *first > 0.0 && last / first >= ratio,
        _ => false,
    }
}

/// Whether ordered values are those of a grid.
fn is_even(values: &[f64]) -> bool {
    let (least, greatest) = extremes(values.windows(2).map(|pair| pair[1] - pair[0]));
    values.len() > 2 && least > 0.0 && greatest - least <= EVEN * greatest
}

/// Whether the logarithms of ordered values are those of a grid.
fn is_log_even(values: &[f64]) -> bool {
    if values.first().is_none_or(|first| *first <= 0.0) {
        return false;
    }
    let logarithms: Vec<f64> = values.iter().map(|value| log10(*value)).collect();
    is_even(&logarithms)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widely_spread_values_have_a_logarithmic_axis() {
        let axis = MapAxis::default();
        // From a ratio of 30 along axes and of 10 in colours; never with zeros or negative numbers.
        for (values, expected) in [
            (vec![1.0, 4.0, 9.0], [false, false]),
            (vec![1.0, 4.0, f64::NAN, 10.0], [false, true]),
            (vec![1.0, 4.0, 30.0], [true, true]),
            (vec![0.0, 4.0, 100.0], [false, false]),
            (vec![-1.0, 4.0, 100.0], [false, false]),
            // A grid shows its spacing.
            (vec![1.0, 2.0, 4.0], [true, false]),
            (vec![1.0, 20.5, 40.0], [false, true]),
            (vec![f64::NAN], [false, false]),
        ] {
            let along_axis = AxisValues::new(&axis, values.clone());
            let colours = AxisValues::for_colours(&axis, values.clone());
            assert_eq!([along_axis.is_log, colours.is_log], expected, "{values:?}");
        }
    }

    #[test]
    fn single_value_is_centred() {
        for (value, expected) in [
            (0.5, [0.45, 0.55]),
            (-20.0, [-22.0, -18.0]),
            (0.0, [-1.0, 1.0]),
        ] {
            let values = AxisValues::new(&MapAxis::default(), vec![value]);
            assert_eq!(values.edges(), expected);
        }
    }

    #[test]
    fn cells_meet_halfway_between_values() {
        let values = AxisValues::new(&MapAxis::default(), vec![1.0, 2.0]);
        assert_eq!(values.edges(), [0.5, 1.5, 2.5]);
    }

    #[test]
    fn distinguishes_adjacent_floats() {
        let axis = MapAxis::default();
        let near = [1e15, 1.0000000000000002e15, 1.0000000000000004e15];
        assert!(!AxisValues::new(&axis, near.to_vec()).is_log);
        let wide = AxisValues::new(&axis, vec![near[0], near[1], 1e20]);
        assert!(wide.is_log);
        assert_eq!(wide.index(near[1]), Some(1));
    }
}
