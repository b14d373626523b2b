//! The interpolation polynomial of a watched function within a step.

/// The points of a step at which functions are evaluated for [`SignTracker`](super::SignTracker).
pub const KNOTS: AtKnots = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The values of a function at the [`KNOTS`].
pub type AtKnots = [f64; 5];

/// A turning point farther from zero than this fraction of the function's range in the step is assumed not to reach
/// zero. The interpolation polynomial has a much smaller error.
const GRAZING: f64 = 0.25;

/// Kind of turning point.
#[derive(Clone, Copy)]
pub(super) enum Turn {
    Minimum,
    Maximum,
}

impl Turn {
    /// The value, negated for a maximum.
    pub(super) fn oriented(self, value: f64) -> f64 {
        match self {
            Self::Minimum => value,
            Self::Maximum => -value,
        }
    }
}

/// The interpolation polynomial through the knots, used to find turning points near zero.
pub(super) struct Interpolant {
    /// Divided differences: the coefficients of Newton's form.
    coefficients: AtKnots,
    /// Largest minus smallest value at the knots.
    variation: f64,
}

impl Interpolant {
    /// The polynomial, unless it has no turning point that can reach zero.
    pub(super) fn near_zero(values: &AtKnots) -> Option<Self> {
        let (lowest, highest) = range(values);
        // The polynomial through five equidistant knots leaves the range of its values by at most 0.61 of
        // that range (their Lebesgue constant is 2.21).
        let variation = highest - lowest;
        let clear = lowest > variation || highest < -variation;
        if clear || !values.iter().all(|value| value.is_finite()) {
            return None;
        }
        let shape = Self {
            coefficients: divided_differences(values),
            variation,
        };
        (!shape.is_monotonic()).then_some(shape)
    }

    /// Whether the slopes at the knots rule out a turning point: they have one sign and a sufficient margin. (The slope
    /// is a polynomial too, and leaves their range by no more than 0.61 of it.)
    fn is_monotonic(&self) -> bool {
        let slopes = KNOTS.map(|knot| self.value_and_slope(knot).1);
        let (lowest, highest) = range(&slopes);
        let variation = highest - lowest;
        lowest > variation || highest < -variation
    }

    /// The turning point between `left` and `right`, if there is one that may reach zero.
    pub(super) fn turn(&self, left: f64, right: f64) -> Option<Turn> {
        let (start, end) = (self.value_and_slope(left), self.value_and_slope(right));
        let turn = if start.1 < 0.0 && end.1 > 0.0 {
            Turn::Minimum
        } else if start.1 > 0.0 && end.1 < 0.0 {
            Turn::Maximum
        } else {
            return None;
        };
        let clearance = GRAZING * self.variation;
        // Most turning points are far from zero: only the others are worth a search.
        let clear = turn.oriented(start.0) > clearance && turn.oriented(end.0) > clearance;
        (!clear).then_some(turn)
    }

    #[inline]
    fn value_and_slope(&self, s: f64) -> (f64, f64) {
        let (mut value, mut slope) = (0.0, 0.0);
        for (coefficient, knot) in self.coefficients.iter().zip(KNOTS).rev() {
            slope = slope * (s - knot) + value;
            value = value * (s - knot) + coefficient;
        }
        (value, slope)
    }
}

/// The extreme in the direction `sign` that a function with these values at the knots reaches in the next step, of the
/// same length, extrapolated by a parabola.
pub(super) fn farthest_ahead(values: &AtKnots, sign: f64) -> f64 {
    let shape = Interpolant {
        coefficients: divided_differences(values),
        variation: 0.0,
    };
    let [_, _, _, before, end] = KNOTS;
    let (value, slope) = shape.value_and_slope(end);
    let curvature = (slope - shape.value_and_slope(before).1) / (end - before);
    let at_next_end = value + slope + 0.5 * curvature;
    let turn = -slope / curvature;
    let at_turn = value + 0.5 * turn * slope;
    if (0.0..1.0).contains(&turn) && sign * at_turn > sign * at_next_end {
        at_turn
    } else {
        at_next_end
    }
}

/// The least and the greatest value; NaN is ignored if there are other values.
#[inline]
pub(super) fn range(values: &AtKnots) -> (f64, f64) {
    let (mut lowest, mut highest) = (values[0], values[0]);
    // Unlike `f64::min`, which has to treat NaN, these comparisons are one instruction each.
    for &value in values {
        lowest = if value < lowest { value } else { lowest };
        highest = if value > highest { value } else { highest };
    }
    (lowest, highest)
}

fn divided_differences(values: &AtKnots) -> AtKnots {
    let mut differences = *values;
    // In place, from the end: entry i needs the previous order of entry i − 1.
    for order in 1..KNOTS.len() {
        for i in (order..KNOTS.len()).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (KNOTS[i] - KNOTS[i - order]);
        }
    }
    differences
}
