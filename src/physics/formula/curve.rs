//! The curve through measured points.

/// The monotone cubic through points, constant outside them (F. N. Fritsch, R. E. Carlson, SIAM J. Numer. Anal. 17
/// (1980) 238): where the points rise or fall, it does, too, and overshoots none of them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct MonotoneCubic {
    points: Vec<Knot>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct Knot {
    speed: f64,
    value: f64,
    slope: f64,
}

impl MonotoneCubic {
    /// The curve through points of increasing speed; `None` if they don't increase.
    pub(super) fn new(coordinates: &[[f64; 2]]) -> Option<Self> {
        // Written so that what isn't a number is refused, too.
        let increases = coordinates.windows(2).all(|pair| pair[0][0] < pair[1][0]);
        if !increases
            || !coordinates
                .iter()
                .flatten()
                .all(|number| number.is_finite())
        {
            return None;
        }
        let mut points = Vec::with_capacity(coordinates.len());
        for [speed, value] in coordinates {
            points.push(Knot {
                speed: *speed,
                value: *value,
                slope: 0.0,
            });
        }
        set_slopes(&mut points);
        Some(Self { points })
    }

    /// The value at a speed.
    pub(super) fn at(&self, speed: f64) -> f64 {
        let after = self.points.partition_point(|point| point.speed <= speed);
        let (first, last) = (&self.points[0], &self.points[self.points.len() - 1]);
        if speed.is_nan() {
            speed
        } else if after == 0 {
            first.value
        } else if after == self.points.len() {
            last.value
        } else {
            between(&self.points[after - 1], &self.points[after], speed)
        }
    }
}

/// The cubic between two points with their slopes.
fn between(left: &Knot, right: &Knot, speed: f64) -> f64 {
    let width = right.speed - left.speed;
    let s = (speed - left.speed) / width;
    let rest = 1.0 - s;
    let blend = s * s * (3.0 - 2.0 * s);
    let bends = width * s * rest * (rest * left.slope - s * right.slope);
    left.value + (right.value - left.value) * blend + bends
}

/// Sets the slopes: means of the neighbouring secants, 0 at extrema, then reduced so that each piece is monotone.
fn set_slopes(points: &mut [Knot]) {
    let mut secants = Vec::new();
    for pair in points.windows(2) {
        secants.push((pair[1].value - pair[0].value) / (pair[1].speed - pair[0].speed));
    }
    let (Some(first), Some(last)) = (secants.first(), secants.last()) else {
        return;
    };
    points[0].slope = *first;
    points[secants.len()].slope = *last;
    for (index, pair) in secants.windows(2).enumerate() {
        points[index + 1].slope = if pair[0] * pair[1] > 0.0 {
            f64::midpoint(pair[0], pair[1])
        } else {
            0.0
        };
    }
    for (index, secant) in secants.iter().enumerate() {
        if *secant == 0.0 {
            (points[index].slope, points[index + 1].slope) = (0.0, 0.0);
            continue;
        }
        let (left, right) = (
            points[index].slope / secant,
            points[index + 1].slope / secant,
        );
        // Inside this circle the piece is monotone (their region S₁).
        let radius = (left * left + right * right).sqrt();
        if radius > 3.0 {
            points[index].slope = 3.0 / radius * left * secant;
            points[index + 1].slope = 3.0 / radius * right * secant;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn passes_through_the_points_and_overshoots_none() {
        let points = [
            [0.01, 0.3],
            [0.05, 0.31],
            [0.1, 0.08],
            [0.4, 0.05],
            [0.5, 0.05],
        ];
        let curve = MonotoneCubic::new(&points).unwrap();
        for [speed, value] in points {
            assert_eq!(curve.at(speed), value);
        }
        assert_eq!((curve.at(0.0), curve.at(9.0)), (0.3, 0.05));
        for pair in points.windows(2) {
            let [[from, before], [to, after]] = [pair[0], pair[1]];
            let mut last = before;
            for i in 1..=100 {
                let value = curve.at(from + (to - from) * f64::from(i) / 100.0);
                // Each value is rounded a few times.
                assert!(
                    (value - last) * (after - before).signum() >= -1e-16,
                    "{value} after {last}"
                );
                last = value;
            }
        }
    }

    #[test]
    fn reproduces_a_straight_line() {
        let curve = MonotoneCubic::new(&[[0.0, 0.1], [0.2, 0.3], [1.0, 1.1]]).unwrap();
        for speed in [0.0, 0.05, 0.3, 0.77] {
            assert!((curve.at(speed) - (0.1 + speed)).abs() < 1e-15);
        }
    }

    #[test]
    fn refuses_speeds_that_do_not_increase() {
        for points in [
            [[0.1, 1.0], [0.1, 1.0]],
            [[0.2, 1.0], [0.1, 1.0]],
            [[f64::NAN, 1.0], [0.1, 1.0]],
        ] {
            assert_eq!(MonotoneCubic::new(&points), None);
        }
    }
}
