//! Interpolated curves.

use crate::physics::integrate::zero;

/// A curve through points: between them the cubic through the four nearest.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct CubicCurve {
    /// The abscissas, strictly increasing.
    x: Vec<f64>,
    y: Vec<f64>,
}

impl CubicCurve {
    /// A curve through points in the order of x; points that don't increase x are left out.
    pub(crate) fn new(points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut curve = Self::default();
        for (x, y) in points {
            if curve.x.last().is_none_or(|last| *last < x) {
                curve.x.push(x);
                curve.y.push(y);
            }
        }
        curve
    }

    /// The first and the last x.
    pub(crate) fn domain(&self) -> Option<(f64, f64)> {
        Some((*self.x.first()?, *self.x.last()?))
    }

    /// The value at x, if x lies between the first and the last point.
    pub(crate) fn at(&self, x: f64) -> Option<f64> {
        let (first, last) = self.domain()?;
        if !(first <= x && x <= last) {
            return None;
        }
        // The points around x, two on each side where there are enough.
        let above = self.x.partition_point(|known| *known <= x);
        if self.x[above - 1] == x {
            return Some(self.y[above - 1]);
        }
        let count = self.x.len().min(4);
        let start = above.saturating_sub(2).min(self.x.len() - count);
        let range = start..start + count;
        Some(
            lagrange(&self.x[range.clone()], x)
                .zip(&self.y[range])
                .map(|(w, y)| w * y)
                .sum(),
        )
    }

    /// The slope at x, if x lies between the first and the last point.
    pub(crate) fn slope(&self, x: f64) -> Option<f64> {
        let (first, last) = self.domain()?;
        // So small that the cubic is a straight line, and so large that rounding does not matter: 1e-3 of the distance of
        // two points.
        let step = 1e-3 * (last - first) / (self.x.len() - 1).max(1) as f64;
        let (from, to) = ((x - step).max(first), (x + step).min(last));
        let slope = (self.at(to)? - self.at(from)?) / (to - from);
        (self.at(x).is_some() && slope.is_finite()).then_some(slope)
    }

    /// Distance of the point nearest to x that has two neighbours on each side from the cubic through them.
    pub(crate) fn left_out(&self, x: f64) -> Option<f64> {
        let count = self.x.len();
        if count < 5 {
            return None;
        }
        let at = self
            .x
            .partition_point(|known| *known <= x)
            .clamp(2, count - 3);
        let others = [at - 2, at - 1, at + 1, at + 2];
        let nodes = others.map(|i| self.x[i]);
        let value: f64 = lagrange(&nodes, self.x[at])
            .zip(others)
            .map(|(weight, i)| weight * self.y[i])
            .sum();
        Some(value - self.y[at])
    }

    /// The x at which y first passes a level.
    pub(crate) fn first_reaches(&self, level: f64) -> Option<f64> {
        let at = self
            .y
            .windows(2)
            .position(|pair| (pair[0] > level) != (pair[1] > level))?;
        let (start, width) = (self.x[at], self.x[at + 1] - self.x[at]);
        let part = zero(self.y[at] - level, self.y[at + 1] - level, |s| {
            self.at(start + s * width).map_or(f64::NAN, |y| y - level)
        });
        Some(start + part * width)
    }
}

/// The weights with which the values at points enter Lagrange's interpolation at x.
pub(crate) fn lagrange(points: &[f64], x: f64) -> impl Iterator<Item = f64> + '_ {
    points.iter().enumerate().map(move |(i, point)| {
        let mut weight = 1.0;
        for (j, other) in points.iter().enumerate() {
            if j != i {
                weight *= (x - other) / (point - other);
            }
        }
        weight
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn val_interpolates_cubics_exactly() {
        let f = |x: f64| 1.0 + x * (2.0 - x * (0.5 - 0.25 * x));
        let curve = CubicCurve::new([0.0, 0.7, 1.5, 2.0, 3.5, 4.0].map(|x| (x, f(x))));
        for x in [0.0, 0.1, 0.7, 1.0, 1.9, 2.5, 3.9, 4.0] {
            assert!((curve.at(x).unwrap() - f(x)).abs() < 1e-14, "{x}");
        }
        assert_eq!(curve.at(-0.1), None);
        assert_eq!(curve.at(4.1), None);
    }

    #[test]
    fn levels_are_reached_once() {
        let falling = CubicCurve::new([(0.0, 5.0), (1.0, 4.0), (2.0, 2.0), (3.0, 3.0)]);
        assert!((falling.first_reaches(4.0).unwrap() - 1.0).abs() < 1e-15);
        assert_eq!(falling.first_reaches(1.0), None);
    }
}
