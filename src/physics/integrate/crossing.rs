//! Location of sign changes within a step.

use super::interpolant::{AtKnots, Interpolant, KNOTS, farthest_ahead, range};
use super::search::{Evaluation, extreme_point, root};

/// Number of subintervals between knots that are searched for turning points.
const PIECES: u8 = 4;

/// The pieces overlap by this fraction of their width, because the turning points of the interpolation
/// polynomial are not quite those of the function.
const OVERLAP: f64 = 0.2;

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
    /// Direction of the change.
    pub slope: Slope,
}

/// Tracks the sign of a function from step to step and finds its changes.
///
/// Each sign change is found exactly once. A zero at the end of a step is reported in the next step if it is a
/// crossing. Touching zero is not a crossing. From exactly zero, the first sign is not a crossing. NaN
/// has no sign.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SignTracker {
    /// Noise level: values up to this magnitude have no sign.
    noise_level: f64,
    /// Whether a crossing is reported before the function has left the noise, if it will do so in the next step.
    looks_ahead: bool,
    /// The last sign.
    positive: Option<bool>,
}

/// The points known to enclose the next sign change.
#[derive(Clone, Copy)]
struct Bracket {
    /// The last point known to precede it.
    from: Evaluation,
    /// The first point within the noise, but beyond zero; only for a tracker that looks ahead.
    beyond: Option<Evaluation>,
}

impl From<Evaluation> for Bracket {
    fn from(from: Evaluation) -> Self {
        let beyond = None;
        Self { from, beyond }
    }
}

impl SignTracker {
    /// A tracker that treats values within ±`noise_level` (in the unit of the function) as noise: a crossing counts only if
    /// the function leaves the noise on the other side. The crossing is still at the zero, or the start of the step
    /// in which the function leaves the noise. [`SignTracker::default`] has no noise level.
    pub fn with_noise_level(noise_level: f64) -> Self {
        Self {
            noise_level,
            ..Self::default()
        }
    }

    /// A tracker whose noise level is set before each step, see [`SignTracker::set_noise_level`]. If the function is within
    /// the noise at the end of a step, it is extrapolated over a step of the same length: a crossing is reported if it
    /// leaves the noise there. So its position is that of the zero even if the noise spans the end of a step.
    pub fn looking_ahead() -> Self {
        Self {
            looks_ahead: true,
            ..Self::default()
        }
    }

    /// A tracker for a function with this initial sign, even if it starts at zero.
    pub fn with_sign(positive: bool, noise_level: f64) -> Self {
        Self {
            noise_level,
            positive: Some(positive),
            ..Self::default()
        }
    }

    /// Changes the noise level; the sign remains.
    pub fn set_noise_level(&mut self, noise_level: f64) {
        self.noise_level = noise_level;
    }

    /// The noise level, in the unit of the function.
    pub fn noise_level(&self) -> f64 {
        self.noise_level
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
            Some(true) => lowest > self.noise_level && lowest > variation,
            Some(false) => highest < -self.noise_level && highest < -variation,
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
        let shape = Interpolant::near_zero(values);
        let start = knot_point(values, 0);
        let mut bracket = Bracket::from(start);
        // A crossing at the very end of the last step is reported here.
        self.advance(&mut bracket, start, &mut g, found);
        for i in 1..KNOTS.len() {
            if let Some(shape) = &shape {
                let between = (KNOTS[i - 1], KNOTS[i]);
                self.advance_over_turns(&mut bracket, between, shape, &mut g, found);
            }
            self.advance(&mut bracket, knot_point(values, i), &mut g, found);
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
        let end = Evaluation {
            s: 1.0,
            g: values[KNOTS.len() - 1],
        };
        let (new_sign, slope) = match self.positive {
            Some(true) if end.g < 0.0 => (-1.0, Slope::Falling),
            Some(false) if end.g > 0.0 => (1.0, Slope::Rising),
            Some(_) | None => return,
        };
        if new_sign * farthest_ahead(values, new_sign) > self.noise_level {
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
            let point = extreme_point(left, right, turn, self.noise_level, g);
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
        to: Evaluation,
        g: &mut impl FnMut(f64) -> f64,
        found: &mut Vec<Crossing>,
    ) {
        let (positive, negative) = (to.g > self.noise_level, to.g < -self.noise_level);
        if !positive && !negative {
            // Within the noise, a value of the known sign narrows the bracket; one beyond zero is no crossing yet.
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
            // The same bracket as without a noise level gives the same zero, to the last bit.
            let s = root(bracket.from, bracket.beyond.unwrap_or(to), new_sign, g);
            found.push(Crossing { s, slope });
        }
        self.positive = Some(positive);
        *bracket = Bracket::from(to);
    }
}

/// The point of a function with these values at a knot.
#[inline]
fn knot_point(values: &AtKnots, i: usize) -> Evaluation {
    Evaluation {
        s: KNOTS[i],
        g: values[i],
    }
}
