//! Phases of a top with a fixed peg: sliding, or sticking and turning about the vertical.
//!
//! Friction can hold two parts of the motion: slip, which is rocking (ω_⊥ = 0), and turning about the vertical (ω_z′ = 0).
//! Each is held while the torque that holds it is within its bound; the other part, gravity and the gyroscopic torques
//! enter that torque. Where both are held, the top rests for ever, because nothing changes any more.

use super::formulation::{Entry, Formulation, Guard, Started, Transition};
use super::model::Model;
use super::motion::{Motion, NO_SLIP, Start};
use super::support::Phase;
use crate::physics::friction::{BREAKAWAY_SPEED, Branch, NO_ROLLING, Rocking, Turning};
use crate::physics::kinematics::{Euler, Tilt};

/// Euler angles are singular within this distance of θ = 0 and θ = π, rad.
const SINGULAR: f64 = 1e-6;

/// Equations of a top with a fixed peg.
pub(super) trait FixedPeg<const N: usize>: Formulation<N> {
    /// These equations with another model, in another phase.
    fn with_model(&self, model: Model, phase: Phase) -> Self;

    /// These equations in another phase and on other branches of friction.
    fn in_phase(&self, phase: Phase, branch: Branch) -> Self {
        let model = self.model();
        let model = Model {
            friction: model.friction.on_branch(branch),
            ..*model
        };
        self.with_model(model, phase)
    }

    /// The state after the contact point comes to rest. The vertical angular momentum is conserved if the top still
    /// `turns`.
    fn at_rest(&self, state: &[f64; N], turns: bool) -> [f64; N];

    /// The state after the top stops turning about the vertical.
    fn without_turning(&self, state: &[f64; N]) -> [f64; N];
}

impl Model {
    /// The same model on another branch of drilling friction. The branch belongs to the model, because forces and torques
    /// that are computed from it have to be those of the phase.
    pub(super) fn with_turning(&self, turning: Turning) -> Self {
        let branch = Branch {
            turning,
            ..self.friction.branch
        };
        Self {
            friction: self.friction.on_branch(branch),
            ..*self
        }
    }
}

/// Start of the motion: see [`Formulation::start`].
pub(super) fn start<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    state: [f64; N],
    start: &Start,
) -> Started<F, N> {
    let model = formulation.model();
    let tilt = Tilt::from_rates(start.angles.theta, start.rates);
    let rate = tilt.omega_lean.z;
    // Drilling friction stops a rate below the threshold; without it, such a rate lasts.
    let drills = model.friction.drilling_bound(1.0, true) > 0.0;
    let turning = if rate == 0.0 || (drills && rate.abs() < NO_ROLLING) {
        Turning::Held
    } else {
        Turning::from_rate(rate)
    };
    // An ablation of the paper's equations says nothing about rest.
    let at_rest = model.friction.can_stick() && model.top.slip_speed(&tilt) <= NO_SLIP;
    let (next, settled) = settle(formulation, &state, at_rest, turning, start.angles);
    let transition = (next.phase() == Phase::Sticking).then(|| transition_to_rest(&next, &settled));
    // Rates that are not zero are kept as they were given.
    let is_changed = next.phase() == Phase::Sticking || next.model().holds_turning();
    let state = if is_changed { settled } else { state };
    (next, state, transition)
}

/// The guards of a phase, for variables that are regular everywhere.
pub(super) fn guards(model: &Model, phase: Phase) -> Vec<Guard> {
    let is_at_rest = phase != Phase::Sliding;
    let mut guards = Vec::new();
    if model.friction.branch.rocking == Rocking::Breakaway {
        guards.push(Guard::Departure);
    }
    if is_at_rest {
        guards.push(Guard::Grip);
    } else if model.friction.is_set_valued() {
        guards.push(Guard::Slip);
        // Rolling resistance also jumps where only the slip is zero, but not the rate about the vertical.
        if model.friction.rests_as_a_whole() && model.friction.rolling_arm() > 0.0 {
            guards.push(Guard::Rolling);
        }
    }
    if model.friction.drilling_bound(1.0, is_at_rest) > 0.0 {
        guards.push(if model.holds_turning() {
            Guard::TurningGrip
        } else {
            Guard::Turning
        });
    }
    guards
}

/// The value of a guard: see [`Formulation::guard`].
pub(super) fn guard(model: &Model, guard: Guard, tilt: &Tilt) -> f64 {
    let rate = tilt.omega_lean.z;
    match guard {
        Guard::Slip => {
            let speed = model.top.slip_speed(tilt);
            model.friction.patch_speed(speed, rate) - NO_SLIP
        }
        Guard::Rolling => model.top.slip_speed(tilt) - NO_SLIP,
        Guard::Grip => model.grip(tilt).margin(),
        Guard::Departure => BREAKAWAY_SPEED - model.top.slip_speed(tilt),
        Guard::Turning => model.friction.branch.turning.along(rate),
        Guard::TurningGrip => model.turning_margin(tilt),
        Guard::Regular => tilt.sin - SINGULAR,
        // Not applicable to a fixed peg.
        Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::RollingGrip => f64::NAN,
    }
}

/// The transition at a zero of a guard; see [`Formulation::enter`].
pub(super) fn enter<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    guard: Guard,
    state: &[f64; N],
    reference: Euler,
) -> Entry<F, N> {
    let motion: Motion = formulation.motion(state, reference);
    let model = formulation.model();
    let (turning, phase) = (model.friction.branch.turning, formulation.phase());
    let (next, state) = match guard {
        Guard::Slip | Guard::Rolling | Guard::Turning => {
            let as_a_whole = guard == Guard::Slip && model.friction.rests_as_a_whole();
            // A contact patch that no longer slips doesn't turn either.
            let turning = if guard == Guard::Turning || as_a_whole {
                Turning::Held
            } else {
                turning
            };
            let at_rest = guard != Guard::Turning || phase == Phase::Sticking;
            settle(formulation, state, at_rest, turning, reference)
        }
        Guard::TurningGrip => {
            let rate = model.turning_acceleration(&motion.tilt);
            let branch = Branch {
                turning: Turning::from_rate(rate),
                ..model.friction.branch
            };
            let held = formulation.without_turning(state);
            (formulation.in_phase(phase, branch), held)
        }
        Guard::Departure => (sliding(formulation, turning, Rocking::Any), *state),
        Guard::Grip => (
            sliding(formulation, turning, Rocking::Breakaway),
            formulation.at_rest(state, true),
        ),
        Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::RollingGrip | Guard::Regular => {
            (
                sliding(formulation, turning, Rocking::Any),
                formulation.at_rest(state, true),
            )
        }
    };
    let transition = match guard {
        _ if next.phase() == Phase::Sticking => transition_to_rest(&next, &state),
        Guard::Slip | Guard::Rolling => Transition::SlipStops,
        Guard::Turning if next.model().holds_turning() => Transition::TurningStops,
        Guard::Turning | Guard::TurningGrip => Transition::TurningResumes,
        Guard::Departure => Transition::Departs,
        Guard::Regular => Transition::BecomesSingular,
        Guard::Grip | Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::RollingGrip => {
            Transition::SlipResumes
        }
    };
    let motion = if transition == Transition::Rests {
        next.motion(&state, reference)
    } else {
        motion
    };
    Entry {
        formulation: next,
        state,
        delay: 0.0,
        transition,
        impact: None,
        motion,
        first_step: f64::INFINITY,
    }
}

/// The phase and state of a top whose contact point is at rest or slips, and which turns about the vertical, or doesn't
/// ([`Turning::Held`]; whether friction really holds it is found here).
fn settle<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    state: &[f64; N],
    at_rest: bool,
    turning: Turning,
    reference: Euler,
) -> (F, [f64; N]) {
    let turns = turning != Turning::Held;
    let friction = &formulation.model().friction;
    let mut rested = *state;
    let mut rocking = friction.branch.rocking;
    if at_rest {
        // Friction that gave way has come to rest with the contact point.
        rocking = Rocking::Any;
        rested = formulation.at_rest(state, turns);
        let sticking = sticking(formulation, &rested, turning, reference);
        let tilt = sticking.motion(&rested, reference).tilt;
        if friction.can_stick() && sticking.model().grip(&tilt).holds() {
            return (sticking, rested);
        }
    }
    let sliding = sliding(formulation, turning, rocking);
    if sliding.model().friction.branch.turning != Turning::Held {
        return (sliding, rested);
    }
    let held = sliding.without_turning(&rested);
    let now = sliding.motion(&held, reference).tilt;
    if sliding.model().turning_margin(&now) >= 0.0 {
        return (sliding, held);
    }
    // The torque exceeds what drilling friction can hold: the top turns in the sense of that torque.
    let turning = Turning::from_rate(sliding.model().turning_acceleration(&now));
    let branch = Branch { turning, rocking };
    (formulation.in_phase(Phase::Sliding, branch), rested)
}

/// The equations of a top that slides. Only drilling friction that is set-valued has branches.
fn sliding<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    turning: Turning,
    rocking: Rocking,
) -> F {
    let drills = formulation.model().friction.drilling_bound(1.0, false) > 0.0;
    let branch = Branch {
        turning: if drills { turning } else { Turning::Any },
        rocking,
    };
    formulation.in_phase(Phase::Sliding, branch)
}

/// The equations of a top whose contact point is at rest. Coulomb–Contensou friction has branches only there.
fn sticking<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    rested: &[f64; N],
    turning: Turning,
    reference: Euler,
) -> F {
    let branch = Branch {
        turning,
        rocking: Rocking::Any,
    };
    let sticking = formulation.in_phase(Phase::Sticking, branch);
    if turning != Turning::Any || sticking.model().friction.drilling_bound(1.0, true) == 0.0 {
        return sticking;
    }
    let rate = sticking.motion(rested, reference).tilt.omega_lean.z;
    let branch = Branch {
        turning: Turning::from_rate(rate),
        ..branch
    };
    formulation.in_phase(Phase::Sticking, branch)
}

/// The transition to sticking: the top rests if it doesn't turn about the vertical either.
fn transition_to_rest<F: FixedPeg<N>, const N: usize>(
    sticking: &F,
    state: &[f64; N],
) -> Transition {
    let motion = sticking.motion(state, Euler::default());
    if motion.tilt.omega_lean.z == 0.0 {
        Transition::Rests
    } else {
        Transition::Sticks
    }
}
