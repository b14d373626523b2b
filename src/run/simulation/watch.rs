//! Functions whose zeros are events.

use crate::physics::dynamics::{Formulation, Guard, Model, Motion, NO_SLIP, Phase};
use crate::physics::integrate::{KNOTS, SignTracker, Slope, Tolerances, zero};
use crate::physics::kinematics::Euler;
use crate::run::scenario::Stop;
use std::f64::consts::FRAC_PI_2;

/// Noise level of θ̇, rad/s; smaller values are rounding errors.
const NUTATION_NOISE: f64 = 1e-10;
/// Noise level of θ̈, rad/s²; smaller values are rounding errors.
const NUTATION_RATE_NOISE: f64 = 1e-8;

/// A reversal of the precession, or an extreme of θ at the end of a phase, counts only beyond this many standard
/// deviations of the integration error.
const REVERSAL_DEVIATIONS: f64 = 3.0;

/// Noise level of φ̇ sin² θ after a number of steps, rad/s: a multiple of the integration error that may have accumulated
/// by then.
///
/// φ̇ sin² θ is the angular velocity, multiplied by a vector of length sin θ that depends on the axis. A step adds an
/// error within the tolerances to the angular velocity ω (absolute + relative · |ω|) and to the direction of the axis
/// (absolute + relative), which turns ω. The errors of the steps add like independent ones: with the square root of
/// their number.
pub(super) fn precession_noise(tolerances: &Tolerances, steps: u64, motions: &[Motion]) -> f64 {
    let Tolerances { relative, absolute } = *tolerances;
    let mut largest = 0.0;
    for motion in motions {
        let omega = motion.tilt.omega_lean.norm();
        let error = motion.tilt.sin * (absolute + relative * omega + (absolute + relative) * omega);
        largest = if error > largest { error } else { largest };
    }
    REVERSAL_DEVIATIONS * (steps as f64).sqrt() * largest
}

/// Noise level of θ after a number of steps, rad: a multiple of the integration error of the direction of the axis that
/// may have accumulated by then, as in [`precession_noise`].
pub(super) fn inclination_noise(tolerances: &Tolerances, steps: u64) -> f64 {
    REVERSAL_DEVIATIONS * (steps as f64).sqrt() * (tolerances.absolute + tolerances.relative)
}

/// A function of the motion whose zeros are events.
pub(super) struct WatchedFunction {
    /// Kind of the zeros.
    pub kind: ZeroKind,
    /// Sign of the function so far.
    pub tracker: SignTracker,
}

impl WatchedFunction {
    fn new(kind: ZeroKind, noise_level: f64) -> Self {
        Self {
            kind,
            tracker: SignTracker::with_noise_level(noise_level),
        }
    }
}

/// A zero of a watched function in a step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Zero {
    /// Fraction of the step at which it happens.
    pub s: f64,
    /// Kind of the zero.
    pub kind: ZeroKind,
    /// Direction in which the function passes zero.
    pub slope: Slope,
}

impl Zero {
    /// Whether the zero ends the phase.
    pub fn ends_phase(&self) -> bool {
        matches!(self.kind, ZeroKind::Guard(_)) && self.slope == Slope::Falling
    }
}

/// Kind of a zero of a watched function.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum ZeroKind {
    /// An extreme of θ.
    Nutation,
    /// An extreme of θ̇.
    NutationRate,
    /// An extreme of φ̇ or ψ̇, for the least and greatest rates of a cycle.
    Envelope,
    /// The precession reverses.
    Precession,
    /// The top becomes weak or strong.
    Strength,
    /// θ decreases to this angle, rad.
    Risen(f64),
    /// θ increases to this angle, rad.
    Fallen(f64),
    /// The axis of a tippe top passes the horizontal.
    Inversion,
    /// The guard that ends the phase.
    Guard(Guard),
}

impl ZeroKind {
    /// Whether such a zero can end the phase or, with these stop conditions, the run.
    pub fn may_end(self, stop: &Stop) -> bool {
        match self {
            Self::Guard(_) | Self::Risen(_) => true,
            Self::Fallen(_) => stop.theta_fallen.is_some(),
            Self::Nutation
            | Self::NutationRate
            | Self::Envelope
            | Self::Precession
            | Self::Strength
            | Self::Inversion => false,
        }
    }

    /// The values of the watched function in motions with this sense of precession (+1 or −1). Factors of sin θ make it
    /// regular upright.
    #[inline]
    pub fn values<F: Formulation<N>, const N: usize, const K: usize>(
        self,
        system: &F,
        sense: f64,
        motions: &[Motion; K],
    ) -> [f64; K] {
        match self {
            Self::Nutation => map_motions(motions, |m| m.tilt.sin * m.tilt.rates.theta),
            Self::NutationRate => map_motions(motions, |m| accelerations(system.model(), m).theta),
            // Located by `envelope`, without a tracker.
            Self::Envelope => [f64::NAN; K],
            Self::Precession => map_motions(motions, |m| {
                sense * m.tilt.rates.phi * m.tilt.sin * m.tilt.sin
            }),
            Self::Strength => {
                let top = system.model().nutating_top();
                map_motions(motions, |m| top.strength_ratio(&m.tilt) - 1.0)
            }
            Self::Risen(limit) | Self::Fallen(limit) => {
                map_motions(motions, |m| m.angles.theta - limit)
            }
            Self::Inversion => map_motions(motions, |m| m.angles.theta - FRAC_PI_2),
            Self::Guard(guard) => map_motions(motions, |m| system.guard(guard, m)),
        }
    }
}

/// The Euler accelerations in a motion, rad/s².
pub(super) fn accelerations(model: &Model, motion: &Motion) -> Euler {
    model.euler_accelerations(&model.contact_in(motion), motion)
}

/// Maps each motion to a number.
#[inline]
fn map_motions<const K: usize>(
    motions: &[Motion; K],
    function: impl Fn(&Motion) -> f64,
) -> [f64; K] {
    let mut numbers = [0.0; K];
    for (number, motion) in numbers.iter_mut().zip(motions) {
        *number = function(motion);
    }
    numbers
}

/// Finds the extremes of φ̇ and ψ̇ in a step, i.e. zeros of the Euler accelerations (`at` a fraction of the step, and
/// at the knots).
pub(super) fn envelope(
    at: impl Fn(f64) -> Euler,
    at_knots: &[Euler; KNOTS.len()],
    found: &mut Vec<Zero>,
) {
    for component in [|a: &Euler| a.phi, |a: &Euler| a.psi] {
        for i in 1..KNOTS.len() {
            let [before, after] = [i - 1, i].map(|i| component(&at_knots[i]));
            if before * after < 0.0 {
                let (start, width) = (KNOTS[i - 1], KNOTS[i] - KNOTS[i - 1]);
                let s = zero(before, after, |s| component(&at(start + s * width)));
                let slope = if after > 0.0 {
                    Slope::Rising
                } else {
                    Slope::Falling
                };
                found.push(Zero {
                    s: start + s * width,
                    kind: ZeroKind::Envelope,
                    slope,
                });
            }
        }
    }
}

/// Copies tracker signs from the previous phase.
pub(super) fn copy_signs(before: &[WatchedFunction], now: &mut [WatchedFunction]) {
    for function in now {
        // Guards of different phases have nothing in common but their names.
        let known = before.iter().find(|known| {
            known.kind == function.kind && !matches!(function.kind, ZeroKind::Guard(_))
        });
        if let Some(known) = known {
            function.tracker = known.tracker;
        }
    }
}

/// Noise level of the slip guard of a free peg, m/s. A starting slip passes it in steps that add no more than their error.
const SLIP_NOISE: f64 = 0.5 * NO_SLIP;

/// Noise level of a rate about the vertical, rad/s: it may start at zero.
const TURNING_NOISE: f64 = 1e-12;

/// The tracker of a guard's sign. For a free peg, guards are positive when a phase begins, except slip, which may start
/// anywhere. A bounce at the slowest speed is 5e-14 m high; the gap is rounded to 1e-17 m.
fn guard_tracker(guard: Guard, is_free: bool) -> SignTracker {
    match guard {
        Guard::Gap => SignTracker::with_sign(true, 1e-16),
        Guard::Slip if is_free => SignTracker::with_noise_level(SLIP_NOISE),
        Guard::Slip => SignTracker::default(),
        Guard::Turning => SignTracker::with_sign(true, TURNING_NOISE),
        Guard::TurningGrip | Guard::Departure => SignTracker::with_sign(true, 0.0),
        Guard::Grip
        | Guard::NormalForce
        | Guard::Mobility
        | Guard::Rolling
        | Guard::RollingGrip
        | Guard::Regular => {
            if is_free {
                SignTracker::with_sign(true, 0.0)
            } else {
                SignTracker::default()
            }
        }
    }
}

/// Functions to watch in a phase.
pub(super) fn watched_functions<F: Formulation<N>, const N: usize>(
    stop: &Stop,
    formulation: &F,
) -> Vec<WatchedFunction> {
    let model = formulation.model();
    let is_free = model.support.is_free();
    // The order of simultaneous events: guards last, because they end the phase.
    let guards = formulation
        .guards()
        .into_iter()
        .map(|guard| WatchedFunction {
            kind: ZeroKind::Guard(guard),
            tracker: guard_tracker(guard, is_free),
        });
    // A fixed peg that sticks has constant θ: nothing else can happen.
    if formulation.phase() == Phase::Sticking && !is_free {
        let mut watched = vec![WatchedFunction::new(ZeroKind::Strength, 0.0)];
        watched.extend(guards);
        return watched;
    }
    let mut watched = vec![
        WatchedFunction::new(ZeroKind::Nutation, NUTATION_NOISE),
        WatchedFunction::new(ZeroKind::NutationRate, NUTATION_RATE_NOISE),
        // The noise level grows with the steps: see `precession_noise`.
        WatchedFunction {
            kind: ZeroKind::Precession,
            tracker: SignTracker::looking_ahead(),
        },
    ];
    // A tippe top has no strength event, and `Inversion` replaces `Fallen`.
    if model.top.center_distance > 0.0 {
        let fallen = stop.theta_fallen.unwrap_or(FRAC_PI_2);
        watched.push(WatchedFunction::new(ZeroKind::Strength, 0.0));
        watched.push(WatchedFunction::new(ZeroKind::Fallen(fallen), 0.0));
    } else {
        watched.push(WatchedFunction::new(ZeroKind::Inversion, 0.0));
    }
    if let Some(limit) = stop.theta_risen {
        watched.push(WatchedFunction::new(ZeroKind::Risen(limit), 0.0));
    }
    watched.extend(guards);
    watched
}
