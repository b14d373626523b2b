//! The phases of a top whose peg's centre stays in place: it slides, or turns about the vertical as a whole.

use super::formulation::{Entry, Formulation, Guard, Transition};
use super::model::Model;
use super::motion::{Motion, Start};
use super::support::Phase;
use crate::physics::kinematics::{Euler, Tilt};

/// A contact point that slips more slowly than this has stopped, m/s: on the scale of a top a nanometre per second.
pub(super) const NO_SLIP: f64 = 1e-9;

/// Angles nearer than this to θ = 0 or θ = π can't be integrated as Euler angles, rad.
const SINGULAR: f64 = 1e-6;

/// Equations of a top with a fixed peg.
pub(super) trait FixedPeg<const N: usize>: Formulation<N> {
    /// These equations in another phase.
    fn in_phase(self, phase: Phase) -> Self;

    /// The state with the contact point brought to rest at the same angular momentum about the vertical.
    fn rested(&self, state: &[f64; N]) -> [f64; N];
}

/// Start of the motion: see [`Formulation::start`].
pub(super) fn start<F: FixedPeg<N>, const N: usize>(
    formulation: F,
    state: [f64; N],
    start: &Start,
    may_hold: bool,
) -> (F, [f64; N], Option<Transition>) {
    let model = formulation.model();
    let tilt = Tilt::from_rates(start.angles.theta, start.rates);
    let at_rest = may_hold && model.contact(&tilt).slip_speed == 0.0;
    let motion = formulation.motion(&state, start.angles);
    if at_rest && model.grip(&motion.tilt).holds() {
        (
            formulation.in_phase(Phase::Holding),
            state,
            Some(Transition::Holds),
        )
    } else {
        (formulation, state, None)
    }
}

/// The value of a guard: see [`Formulation::guard`].
pub(super) fn guard(model: &Model, guard: Guard, tilt: &Tilt) -> f64 {
    match guard {
        Guard::Slip => model.top.slip_speed(tilt) - NO_SLIP,
        Guard::Grip => model.grip(tilt).margin(),
        Guard::Regular => tilt.sin - SINGULAR,
        // What a fixed peg does not do.
        Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::Rolling => f64::NAN,
    }
}

/// The transition where a guard has fallen to zero: see [`Formulation::enter`].
pub(super) fn enter<F: FixedPeg<N>, const N: usize>(
    formulation: &F,
    guard: Guard,
    state: &[f64; N],
    reference: Euler,
) -> Entry<F, N> {
    let motion: Motion = formulation.motion(state, reference);
    let (transition, phase) = match guard {
        Guard::Slip if formulation.model().grip(&motion.tilt).holds() => {
            (Transition::Holds, Phase::Holding)
        }
        Guard::Slip => (Transition::SlipStops, Phase::Sliding),
        Guard::Regular => (Transition::BecomesSingular, Phase::Sliding),
        Guard::Grip | Guard::NormalForce | Guard::Gap | Guard::Mobility | Guard::Rolling => {
            (Transition::SlipResumes, Phase::Sliding)
        }
    };
    let formulation = formulation.in_phase(phase);
    Entry {
        formulation,
        state: formulation.rested(state),
        delay: 0.0,
        transition,
        motion,
        first_step: f64::INFINITY,
    }
}
