//! Phases of a top with a fixed peg: sliding, or sticking and turning about the vertical.

use super::formulation::{Entry, Formulation, Guard, Started, Transition};
use super::model::Model;
use super::motion::{Motion, NO_SLIP, Start};
use super::support::Phase;
use crate::physics::kinematics::{Euler, Tilt};

/// Euler angles are singular within this distance of θ = 0 and θ = π, rad.
const SINGULAR: f64 = 1e-6;

/// Equations of a top with a fixed peg.
pub(super) trait FixedPeg<const N: usize>: Formulation<N> {
    /// These equations in another phase.
    fn with_phase(self, phase: Phase) -> Self;

    /// The state after the contact point comes to rest, with the vertical angular momentum conserved.
    fn at_rest(&self, state: &[f64; N]) -> [f64; N];
}

/// Start of the motion: see [`Formulation::start`].
pub(super) fn start<F: FixedPeg<N>, const N: usize>(
    formulation: F,
    state: [f64; N],
    start: &Start,
    may_stick: bool,
) -> Started<F, N> {
    let model = formulation.model();
    let tilt = Tilt::from_rates(start.angles.theta, start.rates);
    let at_rest = may_stick && model.contact(&tilt).slip_speed == 0.0;
    let motion = formulation.motion(&state, start.angles);
    if at_rest && model.grip(&motion.tilt).holds() {
        let sticking = formulation.with_phase(Phase::Sticking);
        (sticking, state, Some(Transition::Sticks))
    } else {
        (formulation, state, None)
    }
}

/// The guards of a phase, for variables that are regular everywhere.
pub(super) fn guards(model: &Model, phase: Phase) -> Vec<Guard> {
    match phase {
        Phase::Sliding if model.friction.is_set_valued() => vec![Guard::Slip],
        Phase::Sliding => Vec::new(),
        Phase::Sticking | Phase::Flying => vec![Guard::Grip],
    }
}

/// The value of a guard: see [`Formulation::guard`].
pub(super) fn guard(model: &Model, guard: Guard, tilt: &Tilt) -> f64 {
    match guard {
        Guard::Slip => model.top.slip_speed(tilt) - NO_SLIP,
        Guard::Grip => model.grip(tilt).margin(),
        Guard::Regular => tilt.sin - SINGULAR,
        // Not applicable to a fixed peg.
        Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::Rolling => f64::NAN,
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
    let (transition, phase) = match guard {
        Guard::Slip if formulation.model().grip(&motion.tilt).holds() => {
            (Transition::Sticks, Phase::Sticking)
        }
        Guard::Slip => (Transition::SlipStops, Phase::Sliding),
        Guard::Regular => (Transition::BecomesSingular, Phase::Sliding),
        Guard::Grip | Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::Rolling => {
            (Transition::SlipResumes, Phase::Sliding)
        }
    };
    let formulation = formulation.with_phase(phase);
    Entry {
        formulation,
        state: formulation.at_rest(state),
        delay: 0.0,
        transition,
        motion,
        first_step: f64::INFINITY,
    }
}
