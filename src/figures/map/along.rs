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

/// Values along an axis, as they are drawn: logarithms if `is_log`.
pub(super) struct Along {
    pub(super) quantity: Quantity,
    is_log: bool,
    /// Each different value once, in order.
    pub(super) values: Vec<f64>,
}

impl Along {
    /// Values along an axis of a plot: logarithms of those of a grid if these are spaced evenly, of others if they differ
    /// widely.
    pub(super) fn new(axis: &MapAxis, values: Vec<f64>) -> Self {
        Self::of(axis, values, |values| {
            if is_even(values) {
                return false;
            }
            is_spread(values, LOGARITHMIC)
                || values[0] > 0.0 && is_even(&values.iter().map(|v| log10(*v)).collect::<Vec<_>>())
        })
    }

    /// Values on the colour scale.
    pub(super) fn of_colours(axis: &MapAxis, values: Vec<f64>) -> Self {
        Self::of(axis, values, |values| {
            is_spread(values, LOGARITHMIC_COLOURS)
        })
    }

    fn of(axis: &MapAxis, mut values: Vec<f64>, is_log: impl Fn(&[f64]) -> bool) -> Self {
        values.retain(|value| value.is_finite());
        values.sort_by(f64::total_cmp);
        values.dedup();
        Self {
            quantity: axis.quantity(),
            is_log: !values.is_empty() && is_log(&values),
            values,
        }
    }

    /// The place of a value in the drawing.
    pub(super) fn place(&self, value: f64) -> f64 {
        if self.is_log { log10(value) } else { value }
    }

    /// The drawn range.
    pub(super) fn range(&self) -> (f64, f64) {
        extremes(self.values.iter().map(|value| self.place(*value)))
    }

    /// The cell boundaries, halfway between neighbouring values; a single value gets a tenth of it on both sides.
    pub(super) fn edges(&self) -> Vec<f64> {
        let places: Vec<_> = self.values.iter().map(|value| self.place(*value)).collect();
        let (Some(first), Some(last)) = (places.first(), places.last()) else {
            return Vec::new();
        };
        let pairs = places.windows(2);
        let mut edges: Vec<_> = pairs.map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        let alone = if *first == 0.0 {
            1.0
        } else {
            0.1 * first.abs()
        };
        let low = first - edges.first().map_or(alone, |edge| edge - first);
        let high = last + edges.last().map_or(alone, |edge| last - edge);
        edges.insert(0, low);
        edges.push(high);
        edges
    }

    /// Index of a value among the distinct values.
    pub(super) fn index(&self, value: f64) -> Option<usize> {
        let index = self.values.partition_point(|other| *other < value);
        (self.values.get(index) == Some(&value)).then_some(index)
    }

    /// A scale with at most `most` numbers.
    pub(super) fn scale(&self, (low, high): (f64, f64), most: usize) -> Scale {
        if self.is_log {
            Scale::of_logarithms(low, high, most)
        } else {
            Scale::new(low, high, most)
        }
    }
}

/// Whether the ratio of the last to the first of ordered values is at least this.
fn is_spread(values: &[f64], times: f64) -> bool {
    values[0] > 0.0 && values[values.len() - 1] / values[0] >= times
}

/// Whether ordered values are those of a grid.
fn is_even(values: &[f64]) -> bool {
    let (least, greatest) = extremes(values.windows(2).map(|pair| pair[1] - pair[0]));
    values.len() > 2 && least > 0.0 && greatest - least <= EVEN * greatest
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn widely_spread_values_are_drawn_over_their_logarithms() {
        let axis = MapAxis::default();
        let is_log = |values: Vec<f64>| {
            [
                Along::new(&axis, values.clone()),
                Along::of_colours(&axis, values),
            ]
            .map(|along| along.is_log)
        };
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
            assert_eq!(is_log(values.clone()), expected, "{values:?}");
        }
    }

    #[test]
    fn a_single_value_is_in_the_middle_of_an_axis_of_its_size() {
        let edges = |values: &[f64]| Along::new(&MapAxis::default(), values.to_vec()).edges();
        assert_eq!(edges(&[0.5]), [0.45, 0.55]);
        assert_eq!(edges(&[-20.0]), [-22.0, -18.0]);
        assert_eq!(edges(&[0.0]), [-1.0, 1.0]);
        assert_eq!(edges(&[1.0, 2.0]), [0.5, 1.5, 2.5]);
    }

    #[test]
    fn values_that_hardly_differ_are_different() {
        let axis = MapAxis::default();
        let near = [1e15, 1.0000000000000002e15, 1.0000000000000004e15];
        assert!(!Along::new(&axis, near.to_vec()).is_log);
        let wide = Along::new(&axis, vec![near[0], near[1], 1e20]);
        assert!(wide.is_log);
        assert_eq!(wide.index(near[1]), Some(1));
    }
}
