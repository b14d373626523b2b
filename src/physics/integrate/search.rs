//! Searches for the root and for the extreme of a function in an interval.

use super::interpolant::Turn;

/// Maximum number of evaluations per search for a root or a turning point.
const MAX_EVALUATIONS: usize = 100;

/// Resolution of turning points; the value there varies quadratically, below rounding.
const TURN_RESOLUTION: f64 = 1e-8;

/// A value `g` of a function at the fraction `s` of a step.
#[derive(Clone, Copy)]
pub(super) struct Evaluation {
    pub(super) s: f64,
    pub(super) g: f64,
}

impl Evaluation {
    /// The point with its value multiplied by a sign.
    fn times(self, sign: f64) -> Self {
        Self {
            s: self.s,
            g: sign * self.g,
        }
    }
}

/// The turning point of `g` between `left` and `right` (golden-section search), or the first point beyond zero found on
/// the way, which suffices to separate two crossings.
pub(super) fn extreme_point(
    mut left: f64,
    mut right: f64,
    turn: Turn,
    noise_level: f64,
    g: &mut impl FnMut(f64) -> f64,
) -> Evaluation {
    /// (√5 − 1) / 2
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    let mut near_left = oriented_point(right - GOLDEN * (right - left), turn, g);
    let mut near_right = oriented_point(left + GOLDEN * (right - left), turn, g);
    // The two points above are the first evaluations.
    for _ in 2..MAX_EVALUATIONS {
        if near_left.g < -noise_level
            || near_right.g < -noise_level
            || right - left <= TURN_RESOLUTION
        {
            break;
        }
        if near_left.g < near_right.g {
            right = near_right.s;
            near_right = near_left;
            near_left = oriented_point(right - GOLDEN * (right - left), turn, g);
        } else {
            left = near_left.s;
            near_left = near_right;
            near_right = oriented_point(left + GOLDEN * (right - left), turn, g);
        }
    }
    let best = if near_left.g < near_right.g {
        near_left
    } else {
        near_right
    };
    Evaluation {
        s: best.s,
        g: turn.oriented(best.g),
    }
}

/// The point at `s`, with the value of `g` negated for a maximum, so that the search is always for a minimum.
fn oriented_point(s: f64, turn: Turn, g: &mut impl FnMut(f64) -> f64) -> Evaluation {
    Evaluation {
        s,
        g: turn.oriented(g(s)),
    }
}

/// The point between 0 and 1 at which `g` changes its sign, given its values there: one is positive, the other is not.
pub fn zero(start: f64, end: f64, mut g: impl FnMut(f64) -> f64) -> f64 {
    let (from, to) = (
        Evaluation { s: 0.0, g: start },
        Evaluation { s: 1.0, g: end },
    );
    let new_sign = if end > 0.0 { 1.0 } else { -1.0 };
    root(from, to, new_sign, &mut g)
}

/// The point between two others at which `g` gets the sign `new_sign` (±1); `to` has it.
///
/// The ITP method (I. F. D. Oliveira, R. H. C. Takahashi, *An enhancement of the bisection method average
/// performance preserving minmax optimality*, ACM Trans. Math. Softw. 47 (2021) 5): superlinear on smooth
/// functions, and never more than one evaluation worse than bisection. The method's constants are κ₁ = 0.2
/// divided by the width, κ₂ = 2 and n₀ = 1.
pub(super) fn root(
    from: Evaluation,
    to: Evaluation,
    new_sign: f64,
    g: &mut impl FnMut(f64) -> f64,
) -> f64 {
    let (mut a, mut b) = (from.times(new_sign), to.times(new_sign));
    // Negated, so that NaN, which has no sign, ends here too.
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
        let point = Evaluation { s, g: g(s) }.times(new_sign);
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
fn itp_point(a: Evaluation, b: Evaluation, nudge: f64, allowed_width: f64) -> f64 {
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
