//! Watched functions of the motion, whose zeros mean something.

use crate::physics::dynamics::{Formulation, Guard, Model, Motion, Phase};
use crate::physics::integrate::{KNOTS, SignTracker, Slope, zero};
use crate::physics::kinematics::Euler;
use crate::run::scenario::Stop;
use std::f64::consts::FRAC_PI_2;

/// Noise floors of θ̇ (rad/s) and θ̈ (rad/s²): smaller values are rounding, not nutation.
const NUTATION_FLOOR: (f64, f64) = (1e-10, 1e-8);

/// A function of the motion whose zeros mean something.
pub(super) struct Watch {
    /// Meaning of its zeros.
    pub meaning: Meaning,
    /// Its sign so far.
    pub tracker: SignTracker,
}

/// Meaning of a watched function's zero.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Meaning {
    /// An extreme of θ.
    Nutation,
    /// An extreme of θ̇.
    NutationRate,
    /// An extreme of φ̇ or ψ̇, for the least and greatest rates of a cycle.
    Envelope,
    /// The precession turns round.
    Precession,
    /// The spin becomes too weak, or strong enough, to hold an upright top.
    Strength,
    /// The top has risen to this inclination, rad.
    Risen(f64),
    /// The top has fallen to this inclination, rad.
    Fallen(f64),
    /// A tippe top inverts: its axis passes the horizontal.
    Inversion,
    /// The guard that ends the phase.
    Guard(Guard),
    /// A top whose contact point sticks has come to rest.
    Turning,
}

impl Meaning {
    /// The values of the watched function in motions with this sense of precession (+1 or −1). Factors of sin θ keep it
    /// regular upright.
    #[inline]
    pub fn values<F: Formulation<N>, const N: usize, const K: usize>(
        self,
        system: &F,
        sense: f64,
        motions: &[Motion; K],
    ) -> [f64; K] {
        match self {
            Self::Nutation => each(motions, |m| m.tilt.sin * m.tilt.rates.theta),
            Self::NutationRate => each(motions, |m| accelerations(system.model(), m).theta),
            // Found without a tracker.
            Self::Envelope => [f64::NAN; K],
            Self::Precession => each(motions, |m| {
                sense * m.tilt.rates.phi * m.tilt.sin * m.tilt.sin
            }),
            Self::Strength => {
                let top = system.model().nutating_top();
                each(motions, |m| top.strength_ratio(&m.tilt) - 1.0)
            }
            Self::Risen(limit) | Self::Fallen(limit) => each(motions, |m| m.angles.theta - limit),
            Self::Inversion => each(motions, |m| m.angles.theta - FRAC_PI_2),
            Self::Guard(guard) => each(motions, |m| system.guard(guard, m)),
            Self::Turning => each(motions, |m| sense * m.tilt.omega_lean.z),
        }
    }
}

/// The Euler accelerations in a motion, rad/s².
pub(super) fn accelerations(model: &Model, motion: &Motion) -> Euler {
    model.euler_accelerations(&model.contact_in(motion), motion)
}

/// A number of each motion.
#[inline]
fn each<const K: usize>(motions: &[Motion; K], of: impl Fn(&Motion) -> f64) -> [f64; K] {
    let mut numbers = [0.0; K];
    for (number, motion) in numbers.iter_mut().zip(motions) {
        *number = of(motion);
    }
    numbers
}

/// Finds the turning points of φ̇ and ψ̇ in a step: where the Euler accelerations (`at` a fraction of the step, and at the
/// knots) pass zero.
pub(super) fn envelope(
    at: impl Fn(f64) -> Euler,
    at_knots: &[Euler; 5],
    found: &mut Vec<(f64, Meaning, Slope)>,
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
                found.push((start + s * width, Meaning::Envelope, slope));
            }
        }
    }
}

/// Lets watches go on with the signs that those of the phase before have seen.
pub(super) fn keep_signs(before: &[Watch], now: &mut [Watch]) {
    for watch in now {
        let known = before.iter().find(|known| {
            known.meaning == watch.meaning && !matches!(watch.meaning, Meaning::Guard(_))
        });
        if let Some(known) = known {
            watch.tracker = known.tracker;
        }
    }
}

/// Least difference of a free peg's slip speed from that which counts as zero, m/s: half of
/// it. Slip that begins passes it within steps that each add no more than their error.
const SLIP_FLOOR: f64 = 5e-10;

/// The tracker of a guard's sign. Those of a free peg are positive when their phase begins, but the slip may begin
/// anywhere. A bounce at the slowest speed is 5e-14 m high; the gap is rounded to 1e-17 m.
fn guard_tracker(guard: Guard, is_free: bool) -> SignTracker {
    match guard {
        Guard::Gap => SignTracker::with_sign(true, 1e-16),
        Guard::Slip if is_free => SignTracker::with_floor(SLIP_FLOOR),
        Guard::Slip => SignTracker::default(),
        _ if is_free => SignTracker::with_sign(true, 0.0),
        Guard::Grip | Guard::NormalForce | Guard::Mobility | Guard::Rolling | Guard::Regular => {
            SignTracker::default()
        }
    }
}

/// Functions to watch in a phase.
pub(super) fn watches<F: Formulation<N>, const N: usize>(
    stop: &Stop,
    formulation: &F,
) -> Vec<Watch> {
    let watch = |meaning, floor| Watch {
        meaning,
        tracker: SignTracker::with_floor(floor),
    };
    let model = formulation.model();
    let is_free = model.support.is_free();
    let guards = formulation.guards().iter().map(|guard| Watch {
        meaning: Meaning::Guard(*guard),
        tracker: guard_tracker(*guard, is_free),
    });
    if formulation.phase() == Phase::Holding && !is_free {
        let mut watches = vec![watch(Meaning::Strength, 0.0)];
        watches.extend(guards);
        watches.push(watch(Meaning::Turning, 0.0));
        return watches;
    }
    let mut watches = vec![
        watch(Meaning::Nutation, NUTATION_FLOOR.0),
        watch(Meaning::NutationRate, NUTATION_FLOOR.1),
        watch(Meaning::Precession, 0.0),
    ];
    // A tippe top has no upright position to be too weak for, and inverts where another falls.
    if model.top.center_distance > 0.0 {
        let fallen = stop.theta_fallen.unwrap_or(FRAC_PI_2);
        watches.push(watch(Meaning::Strength, 0.0));
        watches.push(watch(Meaning::Fallen(fallen), 0.0));
    } else {
        watches.push(watch(Meaning::Inversion, 0.0));
    }
    watches.extend(
        stop.theta_risen
            .map(|limit| watch(Meaning::Risen(limit), 0.0)),
    );
    watches.extend(guards);
    watches
}
