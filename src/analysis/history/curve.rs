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

/// The cubic through two points `h` apart with given slopes, at the fraction `s` of the interval.
pub(crate) fn hermite3([y0, d0]: [f64; 2], [y1, d1]: [f64; 2], h: f64, s: f64) -> f64 {
    let r = 1.0 - s;
    y0 + s * s * (3.0 - 2.0 * s) * (y1 - y0) + h * s * r * (r * d0 - s * d1)
}

/// The quintic through two points `h` apart with given first and second derivatives, at the
/// fraction `s` of the interval.
pub(crate) fn hermite5([y0, d0, c0]: [f64; 3], [y1, d1, c1]: [f64; 3], h: f64, s: f64) -> f64 {
    let r = 1.0 - s;
    let step = s * s * s * (10.0 - 15.0 * s + 6.0 * s * s);
    y0 + step * (y1 - y0)
        + h * s * (r * r * r * (1.0 + 3.0 * s) * d0 - s * s * r * (1.0 + 3.0 * r) * d1)
        + 0.5 * h * h * s * s * r * r * (r * c0 + s * c1)
}

/// The extreme value of the cubic through two points `h` apart with given slopes, if it lies between them.
pub(crate) fn extreme([y0, d0]: [f64; 2], [y1, d1]: [f64; 2], h: f64) -> Option<f64> {
    let changes_sign = d0 * d1 < 0.0;
    if !changes_sign {
        return None;
    }
    // The slope, a parabola in s, changes sign between 0 and 1.
    let rise = (y1 - y0) / h;
    let at = zero(d0, d1, |s| {
        d0 + s * (6.0 * rise - 4.0 * d0 - 2.0 * d1) + 3.0 * s * s * (d0 + d1 - 2.0 * rise)
    });
    Some(hermite3([y0, d0], [y1, d1], h, at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::math::{cos, sin};

    #[test]
    fn val_interpolates_cubics_exactly() {
        let f = |x: f64| 1.0 + x * (2.0 - x * (0.5 - 0.25 * x));
        let curve = CubicCurve::new([0.0, 0.7, 1.5, 2.0, 3.5, 4.0].map(|x| (x, f(x))));
        for x in [0.0, 0.1, 0.7, 1.0, 1.9, 2.5, 3.9, 4.0] {
            assert!((curve.at(x).unwrap() - f(x)).abs() < 1e-14, "{x}");
        }
        assert_eq!(curve.at(-0.1), None);
        assert_eq!(curve.at(4.1), None);
        let d = |x: f64| 2.0 - x * (1.0 - 0.75 * x);
        let c = |x: f64| -1.0 + 1.5 * x;
        for s in [0.0, 0.3, 1.0] {
            let x = 1.0 + 0.5 * s;
            let three = hermite3([f(1.0), d(1.0)], [f(1.5), d(1.5)], 0.5, s);
            let ends = [[f(1.0), d(1.0), c(1.0)], [f(1.5), d(1.5), c(1.5)]];
            let five = hermite5(ends[0], ends[1], 0.5, s);
            assert!(
                (three - f(x)).abs() < 1e-15 && (five - f(x)).abs() < 1e-15,
                "{s}"
            );
        }
    }

    #[test]
    fn val_interpolates_quintics_exactly() {
        let f = |x: f64| [x * x * x * x * x, 5.0 * x * x * x * x, 20.0 * x * x * x];
        for s in [0.2, 0.5, 0.9] {
            let found = hermite5(f(1.0), f(3.0), 2.0, s);
            let x: f64 = 1.0 + 2.0 * s;
            assert!((found - f(x)[0]).abs() < 1e-12, "{s}: {found}");
        }
    }

    #[test]
    fn levels_are_reached_once() {
        let falling = CubicCurve::new([(0.0, 5.0), (1.0, 4.0), (2.0, 2.0), (3.0, 3.0)]);
        assert!((falling.first_reaches(4.0).unwrap() - 1.0).abs() < 1e-15);
        assert_eq!(falling.first_reaches(1.0), None);
    }

    #[test]
    fn val_finds_the_extreme_of_a_sine() {
        let h = 0.1;
        let points: Vec<f64> = (0..=100).map(|i| f64::from(i) * h).collect();
        let found = points
            .windows(2)
            .find_map(|x| extreme([sin(x[0]), cos(x[0])], [sin(x[1]), cos(x[1])], h));
        // The cubic's error is h⁴/384 at most.
        assert!((found.unwrap() - 1.0).abs() < 1e-4 / 384.0);
    }
}
