//! Location of sign changes within a step.

/// The points of a step at which functions are evaluated for [`SignTracker`].
pub const KNOTS: AtKnots = [0.0, 0.25, 0.5, 0.75, 1.0];

/// The values of a function at the [`KNOTS`].
pub type AtKnots = [f64; 5];

/// Maximum number of evaluations per search for a root or a turning point.
const MAX_EVALUATIONS: usize = 100;

/// Number of subintervals between knots that are searched for turning points.
const PIECES: u8 = 4;

/// The pieces overlap by this fraction of their width, because the turning points of the interpolation
/// polynomial are not quite those of the function.
const OVERLAP: f64 = 0.2;

/// A turning point farther from zero than this fraction of the function's range in the step is assumed not to reach
/// zero. The interpolation polynomial has a much smaller error.
const GRAZING: f64 = 0.25;

/// Resolution of turning points; the value there varies quadratically, below rounding.
const TURN_RESOLUTION: f64 = 1e-8;

/// The direction in which a function passes zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Slope {
    /// From negative to positive.
    Rising,
    /// From positive to negative.
    Falling,
}

/// A sign change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crossing {
    /// The fraction of the step at which it happens, accurate to about one ulp of 1. The function has its new sign
    /// there, or is zero.
    pub s: f64,
    /// Its direction.
    pub slope: Slope,
}

/// Tracks the sign of a function from step to step and finds its changes.
///
/// Each sign change is found exactly once. A zero at the end of a step is reported in the next step if it is a
/// crossing. Touching zero is not a crossing. From exactly zero, the first sign is not a crossing. NaN
/// has no sign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignTracker {
    /// Noise floor: values up to this magnitude have no sign.
    floor: f64,
    /// Whether a crossing is reported before the function has left the noise, if it will do so in the next step.
    looks_ahead: bool,
    /// The last sign.
    positive: Option<bool>,
}

/// A value of the watched function.
#[derive(Clone, Copy)]
struct Point {
    s: f64,
    g: f64,
}

/// The points known to enclose the next sign change.
#[derive(Clone, Copy)]
struct Bracket {
    /// The last point known to precede it.
    from: Point,
    /// The first point within the noise, but beyond zero; only for a tracker that looks ahead.
    beyond: Option<Point>,
}

impl From<Point> for Bracket {
    fn from(from: Point) -> Self {
        let beyond = None;
        Self { from, beyond }
    }
}

impl SignTracker {
    /// A tracker that treats values within ±`floor` (in the unit of the function) as noise: a crossing counts only if
    /// the function leaves the noise on the other side. Its position is still that of the zero, or the start of the step
    /// in which the function leaves the noise. [`SignTracker::default`] has no noise floor.
    pub fn with_floor(floor: f64) -> Self {
        Self {
            floor,
            ..Self::default()
        }
    }

    /// A tracker whose noise floor is set before each step, see [`SignTracker::set_floor`]. If the function is within
    /// the noise at the end of a step, it is extrapolated over a step of the same length: a crossing is reported if it
    /// leaves the noise there. So its position is that of the zero even if the noise spans the end of a step.
    pub fn looking_ahead() -> Self {
        Self {
            looks_ahead: true,
            ..Self::default()
        }
    }

    /// A tracker for a function with this initial sign, even if it starts at zero.
    pub fn with_sign(positive: bool, floor: f64) -> Self {
        Self {
            floor,
            positive: Some(positive),
            ..Self::default()
        }
    }

    /// Changes the noise floor; the sign remains.
    pub fn set_floor(&mut self, floor: f64) {
        self.floor = floor;
    }

    /// The noise floor, in the unit of the function.
    pub fn floor(&self) -> f64 {
        self.floor
    }

    /// This tracker with the sign before a crossing.
    pub fn before(self, slope: Slope) -> Self {
        Self {
            positive: Some(slope == Slope::Falling),
            ..self
        }
    }

    /// Appends to `found` the sign changes of `g` within a step, in the order of `s`.
    ///
    /// `values` are those of `g` at the [`KNOTS`]. Several crossings between adjacent knots are found if the interpolation
    /// polynomial has the turning points between them. Each search for a root or a turning point evaluates `g` at most
    /// 100 times; it is skipped if `g` is far from zero.
    #[inline]
    pub fn scan(
        &mut self,
        values: &AtKnots,
        mut g: impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        if !self.stays_clear(values) {
            self.search(values, &mut g, found);
        }
    }

    /// Whether a function with these values at the knots keeps its sign with enough margin that no turning point
    /// reaches zero.
    #[inline]
    fn stays_clear(&self, values: &AtKnots) -> bool {
        let (lowest, highest) = range(values);
        let variation = highest - lowest;
        match self.positive {
            Some(true) => lowest > self.floor && lowest > variation,
            Some(false) => highest < -self.floor && highest < -variation,
            None => false,
        }
    }

    /// [`SignTracker::scan`] for a function that may reach zero.
    fn search(
        &mut self,
        values: &AtKnots,
        mut g: impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        let knot = |i: usize| Point {
            s: KNOTS[i],
            g: values[i],
        };
        let shape = Interpolant::near_zero(values);
        let mut bracket = Bracket::from(knot(0));
        self.advance(&mut bracket, knot(0), &mut g, found);
        for i in 1..KNOTS.len() {
            if let Some(shape) = &shape {
                let between = (KNOTS[i - 1], KNOTS[i]);
                self.advance_over_turns(&mut bracket, between, shape, &mut g, found);
            }
            self.advance(&mut bracket, knot(i), &mut g, found);
        }
        if self.looks_ahead {
            self.look_ahead(bracket, values, &mut g, found);
        }
    }

    /// Records a zero that `g` has passed in this step, if it leaves the noise only in the next.
    fn look_ahead(
        &mut self,
        bracket: Bracket,
        values: &AtKnots,
        g: &mut impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        let end = Point {
            s: 1.0,
            g: values[KNOTS.len() - 1],
        };
        let (new_sign, slope) = match self.positive {
            Some(true) if end.g < 0.0 => (-1.0, Slope::Falling),
            Some(false) if end.g > 0.0 => (1.0, Slope::Rising),
            Some(_) | None => return,
        };
        if new_sign * farthest_ahead(values, new_sign) > self.floor {
            let s = root(bracket.from, bracket.beyond.unwrap_or(end), new_sign, g);
            found.push(Crossing { s, slope });
            self.positive = Some(new_sign > 0.0);
        }
    }

    /// Processes the turning points between two knots.
    fn advance_over_turns(
        &mut self,
        bracket: &mut Bracket,
        (start, end): (f64, f64),
        shape: &Interpolant,
        g: &mut impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        let width = (end - start) / f64::from(PIECES);
        let overlap = OVERLAP * width;
        let mut last = start;
        for piece in 0..PIECES {
            let left = start + f64::from(piece) * width - overlap;
            let right = start + f64::from(piece + 1) * width + overlap;
            let Some(turn) = shape.turn(left, right) else {
                continue;
            };
            // The watched function need not be defined outside the step, nor the points be sorted.
            let left = if left < start { start } else { left };
            let right = if right > end { end } else { right };
            let point = extreme_point(left, right, turn, self.floor, g);
            if point.s > last && point.s < end {
                self.advance(bracket, point, g, found);
                last = point.s;
            }
        }
    }

    /// Advances to the point `to` and records a sign change, if any.
    fn advance(
        &mut self,
        bracket: &mut Bracket,
        to: Point,
        g: &mut impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        let (positive, negative) = (to.g > self.floor, to.g < -self.floor);
        if !positive && !negative {
            let not_changed = match self.positive {
                Some(true) => to.g > 0.0,
                Some(false) => to.g < 0.0,
                None => false,
            };
            if not_changed || (to.g == 0.0 && bracket.from.g != 0.0) {
                *bracket = Bracket::from(to);
            } else if self.looks_ahead {
                bracket.beyond = bracket.beyond.or(Some(to));
            }
            return;
        }
        if self.positive == Some(!positive) {
            let (new_sign, slope) = if positive {
                (1.0, Slope::Rising)
            } else {
                (-1.0, Slope::Falling)
            };
            // The same bracket as without a noise floor gives the same zero, to the last bit.
            let s = root(bracket.from, bracket.beyond.unwrap_or(to), new_sign, g);
            found.push(Crossing { s, slope });
        }
        self.positive = Some(positive);
        *bracket = Bracket::from(to);
    }
}

/// Kind of turning point.
#[derive(Clone, Copy)]
enum Turn {
    Minimum,
    Maximum,
}

impl Turn {
    /// The value, negated for a maximum.
    fn oriented(self, value: f64) -> f64 {
        match self {
            Self::Minimum => value,
            Self::Maximum => -value,
        }
    }
}

/// The interpolation polynomial through the knots, used to find turning points near zero.
struct Interpolant {
    /// Divided differences: the coefficients of Newton's form.
    coefficients: AtKnots,
    /// Largest minus smallest value at the knots.
    variation: f64,
}

impl Interpolant {
    /// The polynomial, unless it has no turning point that can reach zero.
    fn near_zero(values: &AtKnots) -> Option<Self> {
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
    fn turn(&self, left: f64, right: f64) -> Option<Turn> {
        let (start, end) = (self.value_and_slope(left), self.value_and_slope(right));
        let turn = if start.1 < 0.0 && end.1 > 0.0 {
            Turn::Minimum
        } else if start.1 > 0.0 && end.1 < 0.0 {
            Turn::Maximum
        } else {
            return None;
        };
        let clearance = GRAZING * self.variation;
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
fn farthest_ahead(values: &AtKnots, sign: f64) -> f64 {
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
fn range(values: &AtKnots) -> (f64, f64) {
    let (mut lowest, mut highest) = (values[0], values[0]);
    for &value in values {
        lowest = if value < lowest { value } else { lowest };
        highest = if value > highest { value } else { highest };
    }
    (lowest, highest)
}

fn divided_differences(values: &AtKnots) -> AtKnots {
    let mut differences = *values;
    for order in 1..KNOTS.len() {
        for i in (order..KNOTS.len()).rev() {
            differences[i] = (differences[i] - differences[i - 1]) / (KNOTS[i] - KNOTS[i - order]);
        }
    }
    differences
}

/// The turning point of `g` between `left` and `right` (golden-section search), or the first point beyond zero found on
/// the way, which suffices to separate two crossings.
fn extreme_point(
    mut left: f64,
    mut right: f64,
    turn: Turn,
    floor: f64,
    g: &mut impl FnMut(f64) -> f64,
) -> Point {
    /// (√5 − 1) / 2
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut evaluate = |s: f64| Point {
        s,
        g: turn.oriented(g(s)),
    };
    let mut near_left = evaluate(right - GOLDEN * (right - left));
    let mut near_right = evaluate(left + GOLDEN * (right - left));
    for _ in 2..MAX_EVALUATIONS {
        if near_left.g < -floor || near_right.g < -floor || right - left <= TURN_RESOLUTION {
            break;
        }
        if near_left.g < near_right.g {
            right = near_right.s;
            near_right = near_left;
            near_left = evaluate(right - GOLDEN * (right - left));
        } else {
            left = near_left.s;
            near_left = near_right;
            near_right = evaluate(left + GOLDEN * (right - left));
        }
    }
    let best = if near_left.g < near_right.g {
        near_left
    } else {
        near_right
    };
    Point {
        s: best.s,
        g: turn.oriented(best.g),
    }
}

/// The point between 0 and 1 at which `g` changes its sign, given its values there: one is positive, the other is not.
pub fn zero(start: f64, end: f64, mut g: impl FnMut(f64) -> f64) -> f64 {
    let (from, to) = (Point { s: 0.0, g: start }, Point { s: 1.0, g: end });
    let new_sign = if end > 0.0 { 1.0 } else { -1.0 };
    root(from, to, new_sign, &mut g)
}

/// The point between two others at which `g` gets the sign `new_sign` (±1); `to` has it.
///
/// The ITP method (I. F. D. Oliveira, R. H. C. Takahashi, *An enhancement of the bisection method average
/// performance preserving minmax optimality*, ACM Trans. Math. Softw. 47 (2021) 5): superlinear on smooth
/// functions, and never more than one evaluation worse than bisection. The method's constants are κ₁ = 0.2
/// divided by the width, κ₂ = 2 and n₀ = 1.
fn root(from: Point, to: Point, new_sign: f64, g: &mut impl FnMut(f64) -> f64) -> f64 {
    let oriented = |point: Point| Point {
        s: point.s,
        g: new_sign * point.g,
    };
    let (mut a, mut b) = (oriented(from), oriented(to));
    let old_sign = a.g < 0.0;
    if !old_sign {
        // No sign change after `from`.
        return a.s;
    }
    let nudge = 0.2 / (b.s - a.s);
    let mut allowed_width = b.s - a.s;
    for _ in 0..MAX_EVALUATIONS {
        if b.s - a.s <= f64::EPSILON || b.g == 0.0 {
            break;
        }
        let s = itp_point(a, b, nudge, allowed_width);
        let point = oriented(Point { s, g: g(s) });
        if point.g < 0.0 {
            a = point;
        } else {
            b = point;
        }
        allowed_width *= 0.5;
    }
    b.s
}

/// The next ITP point of a bracket: the secant zero, moved towards the midpoint and limited so that the bracket becomes
/// narrower than `allowed_width`.
fn itp_point(a: Point, b: Point, nudge: f64, allowed_width: f64) -> f64 {
    let width = b.s - a.s;
    let middle = a.s + 0.5 * width;
    let secant = (b.g * a.s - a.g * b.s) / (b.g - a.g);
    let toward_middle = if secant < middle { 1.0 } else { -1.0 };
    let shift = nudge * (width * width);
    let nudged = if shift < (middle - secant).abs() {
        secant + toward_middle * shift
    } else {
        middle
    };
    let reach = allowed_width - 0.5 * width;
    let s = if (nudged - middle).abs() <= reach {
        nudged
    } else {
        middle - toward_middle * reach
    };
    // Infinite values, NaN and rounding end up here.
    if s > a.s && s < b.s { s } else { middle }
}
