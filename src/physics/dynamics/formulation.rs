//! The trait of formulations: equations, phases and transitions.

use super::impact::Impact;
use super::model::Model;
use super::motion::{Motion, Start};
use super::support::Phase;
use crate::physics::integrate::{IntegrateError, System, Tolerances};
use crate::physics::kinematics::Euler;
use nalgebra::UnitQuaternion;

/// A function of the motion that is positive during a phase; its zero ends the phase.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Guard {
    /// The contact point slips.
    Slip,
    /// Friction can hold the contact point.
    Grip,
    /// The normal force is positive.
    NormalForce,
    /// The gap between peg and table is open.
    Gap,
    /// The peg is not jammed (Painlevé).
    Mobility,
    /// The top rocks, i.e. turns about a horizontal axis.
    Rolling,
    /// Rolling resistance can hold a top that doesn't rock.
    RollingGrip,
    /// The top turns about the vertical.
    Turning,
    /// Drilling friction can hold a top that doesn't turn about the vertical.
    TurningGrip,
    /// A contact that has given way slips too slowly to define a direction.
    Departure,
    /// The variables are regular.
    Regular,
}

/// Transition at the end of a phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Transition {
    /// The contact point stops slipping, but friction can't hold it.
    SlipStops,
    /// Friction holds the contact point.
    Sticks,
    /// The contact point slips again.
    SlipResumes,
    /// The slip of a contact that has given way defines the direction of friction from now on.
    Departs,
    /// The peg of a free top begins to roll.
    Rolls,
    /// The peg of a free top no longer rolls, but slides.
    RollEnds,
    /// The peg leaves the table.
    LiftsOff,
    /// The peg hits the table and bounces.
    Bounces,
    /// The peg hits the table and stays there. What else friction holds then is the transition instead of this one.
    Lands,
    /// The peg jams: no normal force can keep it out of the table.
    Jams,
    /// Rolling resistance holds a top that has stopped rocking: it turns about the vertical only.
    Pivots {
        /// Whether nothing changes any more: the contact point is at rest, and no torque slows the rotation.
        is_final: bool,
    },
    /// Rolling resistance holds a top that has stopped rocking, and whose contact point slips.
    RockingStops,
    /// The top rocks on after an instant without rocking, or rocks again.
    RockingResumes,
    /// Drilling friction holds a top that has stopped turning about the vertical.
    TurningStops,
    /// The top turns on about the vertical, in the other sense, or turns again.
    TurningResumes,
    /// Friction holds a top that has come to rest.
    Rests,
    /// The variables become singular.
    BecomesSingular,
}

/// The beginning of a phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry<F, const N: usize> {
    /// The equations of the phase.
    pub formulation: F,
    /// The state at its beginning.
    pub state: [f64; N],
    /// Delay after the previous phase, s: the short time until the contact point is at rest.
    pub delay: f64,
    /// The transition.
    pub transition: Transition,
    /// The impact with which the phase begins.
    pub impact: Option<Impact>,
    /// The motion at its beginning.
    pub motion: Motion,
    /// Maximum length of the first step, s.
    pub first_step: f64,
}

/// The equations, state and transition at the start of a motion.
pub type Started<F, const N: usize> = (F, [f64; N], Option<Transition>);

/// The beginning of a phase, or the error of an impact that can't be computed.
pub type Entered<F, const N: usize> = Result<Entry<F, N>, IntegrateError>;

/// The equations of motion in some set of variables, with `N` state components. The last components are the running
/// integrals: all [`INTEGRALS`](super::INTEGRALS), or only [`FEW_INTEGRALS`](super::FEW_INTEGRALS).
pub trait Formulation<const N: usize>: System<N> + Clone {
    /// Tolerances per step for these tolerances of the motion.
    fn step_tolerances(tolerances: Tolerances) -> Tolerances {
        tolerances
    }

    /// The equations, state and transition at the start.
    fn start(model: &Model, start: &Start) -> Started<Self, N>;

    /// The motion of a state. φ and ψ are unwrapped to be continuous with `reference`.
    fn motion(&self, state: &[f64; N], reference: Euler) -> Motion {
        Motion {
            angles: self.angles(state, reference),
            ..self.motion_without_turns(state, reference)
        }
    }

    /// Like [`Formulation::motion`], but φ and ψ may be copied from `reference`, which is cheaper.
    fn motion_without_turns(&self, state: &[f64; N], reference: Euler) -> Motion;

    /// The Euler angles of [`Formulation::motion`].
    fn angles(&self, state: &[f64; N], reference: Euler) -> Euler;

    /// The orientation in a state: transforms body to world components.
    fn world_from_body(&self, state: &[f64; N]) -> UnitQuaternion<f64>;

    /// The physics.
    fn model(&self) -> &Model;

    /// Phase of the contact point.
    fn phase(&self) -> Phase;

    /// The guards of the phase.
    fn guards(&self) -> Vec<Guard>;

    /// The value of a guard.
    fn guard(&self, guard: Guard, motion: &Motion) -> f64;

    /// The transition at a zero of a guard. `reference` as for [`Formulation::motion`].
    ///
    /// # Errors
    /// If an impact can't be computed.
    fn enter(&self, guard: Guard, state: &[f64; N], reference: Euler) -> Entered<Self, N>;

    /// The transition at a singularity just after a state, beyond which no step leads; `None` if none is known there.
    fn singularity(&self, _state: &[f64; N]) -> Option<Transition> {
        None
    }
}
