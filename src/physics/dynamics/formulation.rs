//! The interface of a choice of variables: equations, phases, and transitions between them.

use super::impact::Impact;
use super::model::Model;
use super::motion::{Motion, Start};
use super::support::Phase;
use crate::physics::integrate::{IntegrateError, System, Tolerances};
use crate::physics::kinematics::Euler;
use nalgebra::UnitQuaternion;

/// A function of the motion that is positive while a phase lasts. Where it falls to zero, another begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// The contact point slips.
    Slip,
    /// Friction is strong enough to hold the contact point.
    Grip,
    /// The table pushes.
    NormalForce,
    /// There is a gap between peg and table.
    Gap,
    /// The peg can get out of the table's way.
    Mobility,
    /// The top rolls rather than pivots.
    Rolling,
    /// The variables are regular.
    Regular,
}

/// Transition at the end of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// The contact point stops slipping, but nothing holds it.
    SlipStops,
    /// The contact point is held.
    Holds,
    /// The contact point slips again.
    SlipResumes,
    /// The peg of a free top begins to roll.
    Rolls,
    /// The peg of a free top no longer rolls, but slides.
    RollEnds,
    /// The peg leaves the table.
    LiftsOff,
    /// The peg hits the table and bounces.
    Bounces(Impact),
    /// The peg hits the table and stays there.
    Lands(Impact),
    /// The peg jams: no normal force keeps it out of the table.
    Jams,
    /// The top stands on its peg and turns about the vertical only, held by rolling resistance.
    Pivots,
    /// The variables become singular.
    BecomesSingular,
}

/// The beginning of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Entry<F, const N: usize> {
    /// The equations of the phase.
    pub formulation: F,
    /// The state at its beginning.
    pub state: [f64; N],
    /// Time after the end of the phase before, s: the short time until the contact point rests.
    pub delay: f64,
    /// The transition.
    pub transition: Transition,
    /// The motion that goes with that.
    pub motion: Motion,
    /// The first step is not longer than this, s.
    pub first_step: f64,
}

/// A choice of variables for the equations of motion, with `N` numbers as state; the last are the running
/// integrals: all [`INTEGRALS`](super::INTEGRALS), or only [`FEW_INTEGRALS`](super::FEW_INTEGRALS).
pub trait Formulation<const N: usize>: System<N> + Copy {
    /// By how much each step may err, if the motion is to have these tolerances.
    #[must_use]
    fn step_tolerances(tolerances: Tolerances) -> Tolerances {
        tolerances
    }

    /// The equations, the state and what happens where the motion starts. Only if `may_hold` friction can hold the peg of
    /// a top that turns as a whole from the start.
    fn start(model: &Model, start: &Start, may_hold: bool) -> (Self, [f64; N], Option<Transition>);

    /// The motion that a state describes. `reference` are Euler angles of a moment ago, from which φ
    /// and ψ go on without jumps of whole turns.
    fn motion(&self, state: &[f64; N], reference: Euler) -> Motion {
        Motion {
            angles: self.angles(state, reference),
            ..self.motion_without_turns(state, reference)
        }
    }

    /// [`Formulation::motion`] for those to whom φ and ψ don't matter: they may be left as they were in `reference`, which
    /// is cheaper.
    fn motion_without_turns(&self, state: &[f64; N], reference: Euler) -> Motion;

    /// The Euler angles of [`Formulation::motion`].
    fn angles(&self, state: &[f64; N], reference: Euler) -> Euler;

    /// The orientation in a state: turns body components into world components.
    fn world_from_body(&self, state: &[f64; N]) -> UnitQuaternion<f64>;

    /// The physics.
    fn model(&self) -> &Model;

    /// Phase of the contact point.
    fn phase(&self) -> Phase;

    /// The guard that ends the phase.
    fn guards(&self) -> &'static [Guard];

    /// The value of a guard.
    fn guard(&self, guard: Guard, motion: &Motion) -> f64;

    /// The transition where a guard has fallen to zero. `reference` as for [`Formulation::motion`].
    ///
    /// # Errors
    /// If an impact can't be computed.
    fn enter(
        &self,
        guard: Guard,
        state: &[f64; N],
        reference: Euler,
    ) -> Result<Entry<Self, N>, IntegrateError>;
}
