//! DOP853: step control, the stages and the dense output.

use super::coefficients::{
    ALL_STAGES, DENSE, ERROR_3, ERROR_5, NODES, SOLUTION, STAGE_1, STAGE_2, STAGE_3, STAGE_4,
    STAGE_5, STAGE_6, STAGE_7, STAGE_8, STAGE_9, STAGE_10, STAGE_11, STAGE_13, STAGE_14, STAGE_15,
    STAGES, StageWeights,
};
use super::dense::Dense;
use super::problem::{IntegrateError, Statistics, System, Tolerances};
use crate::physics::math::array;

// Step control: the default values of `dop853.f`.
/// A step aims at this fraction of the length that the error estimate allows.
const SAFETY: f64 = 0.9;
/// A step is at least this multiple of the one before.
const MIN_STEP_FACTOR: f64 = 0.333;
/// A step is at most this multiple of the one before.
const MAX_STEP_FACTOR: f64 = 6.0;
/// Weight of the third-order error estimate (squared) relative to the fifth-order one.
const WEIGHT_OF_THIRD: f64 = 0.01;

/// Allowed error of the dense output, as a multiple of the step tolerance.
///
/// Step errors accumulate, dense output errors don't. A smaller multiple would shorten every step, because the dense
/// output is one order less accurate than the steps.
const DENSE_ALLOWANCE: f64 = 10.0;

/// Fraction of the step at which the dense output is checked, near the stage at 7/9.
const CHECKED_AT: f64 = 0.8;

/// Typical ratio of the defect at [`CHECKED_AT`] to the maximum error of the dense output (tested). Too small for a
/// pure quadrature.
const DEFECT_PER_ERROR: f64 = 2.64;

/// Minimum step length relative to |t|.
const SHORTEST_STEP: f64 = 10.0 * f64::EPSILON;

/// The explicit Runge–Kutta method of order 8(5,3) of Dormand and Prince, advanced one accepted step at a
/// time.
///
/// The steps don't depend on the end time: a shorter run is an exact prefix of a longer one. [`Dop853::dense`]
/// interpolates between steps and never alters them; use [`Dop853::step_densely`] to control its error.
///
/// ```
/// use toprise::physics::integrate::{Dop853, System, Tolerances};
///
/// struct Decay;
/// impl System<1> for Decay {
///     fn derivative(&self, _: f64, y: &[f64; 1]) -> [f64; 1] {
///         [-y[0]]
///     }
/// }
///
/// let tolerances = Tolerances { relative: 1e-10, absolute: 1e-10 };
/// let mut decay = Dop853::new(Decay, 0.0, [1.0], tolerances)?;
/// while decay.t() < 1.0 {
///     decay.step()?;
/// }
/// let step = decay.dense();
/// let [y] = step.at((1.0 - step.t0) / step.h);
/// assert!((y - 0.367_879_441_171).abs() < 1e-9);
/// # Ok::<(), toprise::physics::integrate::IntegrateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct Dop853<S, const N: usize> {
    system: S,
    tolerances: Tolerances,
    /// The last accepted step; of length zero before the first.
    last: TrialStep<N>,
    /// The step to try next.
    next_h: f64,
    /// The dense output of the last step, if computed and not yet taken.
    dense: Option<Dense<N>>,
    /// Whether the dense output check limits the step length.
    dense_limits: bool,
    statistics: Statistics,
}

/// A step: start, end and stages.
#[derive(Clone, Debug)]
struct TrialStep<const N: usize> {
    t: f64,
    h: f64,
    y: [f64; N],
    k: Stages<N>,
    end: f64,
    end_y: [f64; N],
    end_dy: [f64; N],
}

/// The derivatives at the stages of a step.
type Stages<const N: usize> = [[f64; N]; STAGES];

impl<S: System<N>, const N: usize> Dop853<S, N> {
    /// Starts at (`t0`, `y0`) and chooses a first step from the sizes of the state and its first two
    /// derivatives, as `dop853.f` does.
    ///
    /// # Errors
    /// [`IntegrateError::NonFiniteState`] if `t0`, `y0` or the derivative there is not finite.
    pub fn new(
        system: S,
        t0: f64,
        y0: [f64; N],
        tolerances: Tolerances,
    ) -> Result<Self, IntegrateError> {
        const {
            assert!(S::CONTROLLED >= 1 && S::CONTROLLED <= N);
        }
        let dy = system.derivative(t0, &y0);
        if !(t0.is_finite() && all_finite(&y0) && all_finite(&dy)) {
            return Err(IntegrateError::NonFiniteState { t: t0 });
        }
        let mut integrator = Self {
            system,
            tolerances,
            // Before the first step the dense output is the constant y0.
            last: TrialStep {
                t: t0,
                h: 0.0,
                y: y0,
                k: [[0.0; N]; STAGES],
                end: t0,
                end_y: y0,
                end_dy: dy,
            },
            next_h: 0.0,
            dense: None,
            dense_limits: false,
            statistics: Statistics {
                evaluations: 1,
                ..Statistics::default()
            },
        };
        integrator.next_h = integrator.first_step();
        Ok(integrator)
    }

    /// Restarts from (`t`, `y`) with another system, e.g. after an impact. Statistics continue.
    ///
    /// # Errors
    /// As [`Dop853::new`]; the integrator is unchanged in this case.
    pub fn restart(&mut self, system: S, t: f64, y: [f64; N]) -> Result<(), IntegrateError> {
        let before = self.statistics;
        *self = Self::new(system, t, y, self.tolerances)?;
        let evaluations = before.evaluations + self.statistics.evaluations;
        self.statistics = Statistics {
            evaluations,
            ..before
        };
        Ok(())
    }

    /// Limits the length of the next step.
    pub fn limit_next_step(&mut self, longest: f64) {
        self.next_h = smaller(longest, self.next_h);
    }

    /// The system that is integrated.
    pub fn system(&self) -> &S {
        &self.system
    }

    /// The end of the last accepted step, or the start.
    #[expect(clippy::misnamed_getters, reason = "the last step has its own start")]
    pub fn t(&self) -> f64 {
        self.last.end
    }

    /// The state at [`Dop853::t`].
    #[expect(clippy::misnamed_getters, reason = "the last step has its own start")]
    pub fn y(&self) -> &[f64; N] {
        &self.last.end_y
    }

    /// The derivative at [`Dop853::t`], exactly as used by the next step.
    pub fn dy(&self) -> &[f64; N] {
        &self.last.end_dy
    }

    /// Statistics so far.
    pub fn statistics(&self) -> &Statistics {
        &self.statistics
    }

    /// Advances by one accepted step.
    ///
    /// A rejected step (error too large or values not finite) is retried with a shorter length.
    ///
    /// # Errors
    /// [`IntegrateError::StepSizeUnderflow`] if no step that t can resolve succeeds, and
    /// [`IntegrateError::NonFiniteState`] if one succeeds, but it ends where a quadrature or a derivative is
    /// not finite. The state and the dense output are then still those of the last accepted step.
    pub fn step(&mut self) -> Result<(), IntegrateError> {
        let (step, factor) = self.try_steps(MAX_STEP_FACTOR)?;
        self.next_h = step.h * factor;
        self.accept(step, None);
        Ok(())
    }

    /// Advances by one step and also controls the error of its [dense output](Dop853::dense), to about ten times the
    /// step tolerance. Slightly slower than [`Dop853::step`].
    ///
    /// # Errors
    /// As [`Dop853::step`].
    pub fn step_densely(&mut self) -> Result<(), IntegrateError> {
        let mut growth_limit = MAX_STEP_FACTOR;
        loop {
            let (step, factor) = self.try_steps(growth_limit)?;
            self.statistics.evaluations += 3;
            let dense = self.dense_of(&step);
            let error = self.dense_error(&step, &dense);
            let dense_factor = step_factor(error, growth_limit);
            if error <= 1.0 {
                self.dense_limits &= dense_factor < factor;
                let factor = if self.dense_limits {
                    dense_factor
                } else {
                    factor
                };
                self.next_h = step.h * factor;
                self.accept(step, Some(dense));
                return Ok(());
            }
            self.reject(step.h, error);
            // From now on the dense output determines the steps, until their own error demands shorter ones.
            self.dense_limits = true;
            growth_limit = 1.0;
        }
    }

    /// The solution within the last accepted step.
    ///
    /// Costs three evaluations of the derivative, unless [`Dop853::step_densely`] has already computed it. Constant
    /// before the first step.
    pub fn dense(&mut self) -> Dense<N> {
        if let Some(dense) = self.dense.take() {
            dense
        } else {
            self.statistics.evaluations += 3;
            self.dense_of(&self.last)
        }
    }

    /// Tries steps until one has a small enough error. Returns that step, and the length of the next relative to it.
    #[inline]
    fn try_steps(&mut self, mut growth_limit: f64) -> Result<(TrialStep<N>, f64), IntegrateError> {
        loop {
            let h = self.resolvable_step()?;
            let k = self.stages(h);
            let y = advance(self.y(), h, &combine(&SOLUTION, &k));
            self.statistics.evaluations += 11;
            let error = self.error(h, &y, &k);
            if error <= 1.0 && all_finite(&y[..S::CONTROLLED]) {
                let step = self.ended(h, y, k)?;
                return Ok((step, step_factor(error, growth_limit)));
            }
            self.reject(h, error);
            // Don't grow right after a rejection.
            growth_limit = 1.0;
        }
    }

    /// Rejects a step.
    fn reject(&mut self, h: f64, error: f64) {
        self.statistics.rejected += 1;
        self.next_h = h * if error > 1.0 {
            step_factor(error, 1.0)
        } else {
            MIN_STEP_FACTOR
        };
    }

    /// The solution within a step.
    fn dense_of(&self, step: &TrialStep<N>) -> Dense<N> {
        let TrialStep { t, h, .. } = *step;
        let k = self.all_stages(step);
        // The cubic with the values and slopes of both ends.
        let rise = difference(&step.end_y, &step.y);
        let start_bend: [f64; N] = array(|i| h * step.k[0][i] - rise[i]);
        let end_bend: [f64; N] = array(|i| rise[i] - h * step.end_dy[i]);
        // The rest of the polynomial of degree 7, zero at both ends in value and slope.
        let coefficients = [
            step.y,
            rise,
            start_bend,
            difference(&end_bend, &start_bend),
            scaled(h, &combine(&DENSE[0], &k)),
            scaled(h, &combine(&DENSE[1], &k)),
            scaled(h, &combine(&DENSE[2], &k)),
            scaled(h, &combine(&DENSE[3], &k)),
        ];
        Dense {
            t0: t,
            h,
            coefficients,
        }
    }

    /// Estimated error of the dense output relative to its tolerance, from its defect (slope minus derivative).
    #[inline]
    fn dense_error(&self, step: &TrialStep<N>, dense: &Dense<N>) -> f64 {
        let (t, h) = (step.t + CHECKED_AT * step.h, step.h);
        let slope = dense.slope(CHECKED_AT);
        let state = dense.first_at(S::CONTROLLED, CHECKED_AT);
        let dy = self.system.derivative(t, &state);
        let mut squared = 0.0;
        for i in 0..S::CONTROLLED {
            let scale = self.scale(larger(step.y[i].abs(), step.end_y[i].abs()));
            squared += square((slope[i] - h * dy[i]) / scale);
        }
        (squared / Self::controlled()).sqrt() / (DEFECT_PER_ERROR * DENSE_ALLOWANCE)
    }

    /// The step to try, rounded so that t + h is exact; without that, t and the state would drift
    /// apart by half an ulp of t per step.
    fn resolvable_step(&self) -> Result<f64, IntegrateError> {
        let (t, step) = (self.t(), self.next_h);
        // False also for NaN, e.g. where both tolerances are zero.
        let resolvable = step > SHORTEST_STEP * t.abs();
        if !resolvable {
            return Err(IntegrateError::StepSizeUnderflow { t, step });
        }
        let end = t + step;
        if !end.is_finite() {
            return Err(IntegrateError::NonFiniteState { t: end });
        }
        Ok(end - t)
    }

    /// Stages 0 to 11 of a step of length `h`.
    #[inline]
    fn stages(&self, h: f64) -> Stages<N> {
        let mut k = [[0.0; N]; STAGES];
        let start = (self.t(), self.y());
        k[0] = *self.dy();
        k[1] = self.stage(start, h, NODES[1], &STAGE_1, &k);
        k[2] = self.stage(start, h, NODES[2], &STAGE_2, &k);
        k[3] = self.stage(start, h, NODES[3], &STAGE_3, &k);
        k[4] = self.stage(start, h, NODES[4], &STAGE_4, &k);
        k[5] = self.stage(start, h, NODES[5], &STAGE_5, &k);
        k[6] = self.stage(start, h, NODES[6], &STAGE_6, &k);
        k[7] = self.stage(start, h, NODES[7], &STAGE_7, &k);
        k[8] = self.stage(start, h, NODES[8], &STAGE_8, &k);
        k[9] = self.stage(start, h, NODES[9], &STAGE_9, &k);
        k[10] = self.stage(start, h, NODES[10], &STAGE_10, &k);
        k[11] = self.stage(start, h, NODES[11], &STAGE_11, &k);
        k
    }

    /// The derivative at one stage of a step of length `h` from the state `y` at `t`.
    #[inline(always)]
    fn stage<const M: usize, const K: usize>(
        &self,
        (t, y): (f64, &[f64; N]),
        h: f64,
        node: f64,
        row: &StageWeights<M>,
        k: &[[f64; N]; K],
    ) -> [f64; N] {
        // Quadratures stay 0 in the stages: no derivative depends on them.
        let slope = combine_controlled::<S, N, M, K>(row, k);
        let mut state = [0.0; N];
        for i in 0..S::CONTROLLED {
            state[i] = y[i] + h * slope[i];
        }
        self.system.derivative(t + node * h, &state)
    }

    /// The stages of a step with those that only the dense output needs.
    fn all_stages(&self, step: &TrialStep<N>) -> [[f64; N]; ALL_STAGES] {
        let mut k = [[0.0; N]; ALL_STAGES];
        k[..STAGES].copy_from_slice(&step.k);
        k[12] = step.end_dy;
        let start = (step.t, &step.y);
        k[13] = self.stage(start, step.h, NODES[13], &STAGE_13, &k);
        k[14] = self.stage(start, step.h, NODES[14], &STAGE_14, &k);
        k[15] = self.stage(start, step.h, NODES[15], &STAGE_15, &k);
        k
    }

    /// The local error of a trial step relative to the tolerances: at most 1 if acceptable, NaN if not finite. Combines
    /// the fifth- and third-order estimates (book, II.10).
    #[inline]
    fn error(&self, h: f64, y: &[f64; N], k: &Stages<N>) -> f64 {
        let third = combine_controlled::<S, N, _, STAGES>(&ERROR_3, k);
        let fifth = combine_controlled::<S, N, _, STAGES>(&ERROR_5, k);
        let (mut third_squared, mut fifth_squared) = (0.0, 0.0);
        for i in 0..S::CONTROLLED {
            let scale = self.scale(larger(self.y()[i].abs(), y[i].abs()));
            third_squared += square(third[i] / scale);
            fifth_squared += square(fifth[i] / scale);
        }
        let damped = fifth_squared + WEIGHT_OF_THIRD * third_squared;
        // Both estimates vanish, e.g. for a top at rest.
        if damped == 0.0 {
            return 0.0;
        }
        h * fifth_squared / (Self::controlled() * damped).sqrt()
    }

    /// A step of length `h` to `y`, if its values are finite.
    #[inline]
    fn ended(&mut self, h: f64, y: [f64; N], k: Stages<N>) -> Result<TrialStep<N>, IntegrateError> {
        let end = self.t() + h;
        let dy = self.system.derivative(end, &y);
        self.statistics.evaluations += 1;
        if !(all_finite(&y) && all_finite(&dy)) {
            return Err(IntegrateError::NonFiniteState { t: end });
        }
        Ok(TrialStep {
            t: self.t(),
            h,
            y: *self.y(),
            k,
            end,
            end_y: y,
            end_dy: dy,
        })
    }

    /// Accepts a step, with its dense output if computed.
    #[inline]
    fn accept(&mut self, step: TrialStep<N>, dense: Option<Dense<N>>) {
        self.statistics.count_step(step.h);
        self.last = step;
        self.dense = dense;
    }

    /// The initial step size, from an estimate of the Taylor terms (book, II.4; `hinit` of `dop853.f`).
    fn first_step(&mut self) -> f64 {
        let (size, speed) = (self.size(self.y()), self.size(self.dy()));
        let guess = if size <= 1e-5 || speed <= 1e-5 {
            1e-6
        } else {
            0.01 * (size / speed)
        };
        let probe = advance(self.y(), guess, self.dy());
        let dy = self.system.derivative(self.t() + guess, &probe);
        self.statistics.evaluations += 1;
        let curvature = self.size(&difference(&dy, self.dy())) / guess;
        let steepest = larger(curvature, speed);
        let careful = if !curvature.is_finite() {
            // The probe left the domain of the equations.
            1e-3 * guess
        } else if steepest <= 1e-15 {
            larger(1e-6, 1e-3 * guess)
        } else {
            eighth_root(0.01 / steepest)
        };
        smaller(100.0 * guess, careful)
    }

    /// Length of the controlled part of a vector in units of the tolerances at the current state.
    fn size(&self, v: &[f64; N]) -> f64 {
        let mut squared = 0.0;
        for (v, y) in v.iter().zip(self.y()).take(S::CONTROLLED) {
            squared += square(v / self.scale(y.abs()));
        }
        squared.sqrt()
    }

    /// The error allowed to a component of this magnitude.
    #[inline]
    fn scale(&self, magnitude: f64) -> f64 {
        self.tolerances.absolute + self.tolerances.relative * magnitude
    }

    fn controlled() -> f64 {
        S::CONTROLLED as f64
    }
}

impl Statistics {
    fn count_step(&mut self, length: f64) {
        if self.accepted == 0 || length < self.smallest_step {
            self.smallest_step = length;
        }
        self.largest_step = larger(self.largest_step, length);
        self.accepted += 1;
    }
}

/// The linear combination of stages that `row` describes, summed in the order of the stages.
#[inline(always)]
fn combine<const N: usize, const M: usize, const K: usize>(
    row: &StageWeights<M>,
    k: &[[f64; N]; K],
) -> [f64; N] {
    let (first, a) = row[0];
    let mut sum: [f64; N] = array(|i| a * k[first][i]);
    for &(stage, a) in &row[1..] {
        for i in 0..N {
            sum[i] += a * k[stage][i];
        }
    }
    sum
}

/// The controlled components of [`combine`]; 0 for the quadratures.
#[inline(always)]
fn combine_controlled<S: System<N>, const N: usize, const M: usize, const K: usize>(
    row: &StageWeights<M>,
    k: &[[f64; N]; K],
) -> [f64; N] {
    let mut sum = [0.0; N];
    let (first, a) = row[0];
    for i in 0..S::CONTROLLED {
        sum[i] = a * k[first][i];
    }
    for &(stage, a) in &row[1..] {
        for i in 0..S::CONTROLLED {
            sum[i] += a * k[stage][i];
        }
    }
    sum
}

/// y + h y′.
#[inline]
fn advance<const N: usize>(y: &[f64; N], h: f64, dy: &[f64; N]) -> [f64; N] {
    array(|i| y[i] + h * dy[i])
}

/// h y′.
#[inline]
fn scaled<const N: usize>(h: f64, dy: &[f64; N]) -> [f64; N] {
    array(|i| h * dy[i])
}

#[inline]
fn difference<const N: usize>(a: &[f64; N], b: &[f64; N]) -> [f64; N] {
    array(|i| a[i] - b[i])
}

/// TrialStep size factor for this error.
#[inline]
fn step_factor(error: f64, growth_limit: f64) -> f64 {
    // An error of 0 gives infinity, which is clamped.
    let factor = SAFETY / eighth_root(error);
    larger(MIN_STEP_FACTOR, smaller(growth_limit, factor))
}

/// The eighth root as three square roots, which are exactly rounded (`powf` is not portable).
#[inline]
fn eighth_root(x: f64) -> f64 {
    x.sqrt().sqrt().sqrt()
}

#[inline]
fn square(x: f64) -> f64 {
    x * x
}

/// The larger number; unlike [`f64::max`] it is defined for zeros of both signs: `b`, unless `a` is larger.
#[inline]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller number; `b`, unless `a` is smaller.
#[inline]
fn smaller(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

#[inline]
fn all_finite(values: &[f64]) -> bool {
    values.iter().all(|value| value.is_finite())
}
