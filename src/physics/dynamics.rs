//! The equations of motion of a top on a table.
//!
//! A [`Model`] holds the physics that every formulation shares: the top, its friction and the [`Support`] that holds its
//! peg, with the forces, the torques and the terms of the Euler accelerations. A [`Formulation`] chooses the variables
//! in which the motion is integrated:
//!
//! * [`EulerAngles`]: the paper's equations (7) as printed, for a fixed peg; singular upright.
//! * [`BodyRotation`]: orientation and angular momentum, for a fixed peg; regular everywhere.
//! * [`FreeRotation`]: orientation, angular momentum and the motion of the centre of mass, for a free peg.
//!
//! A motion consists of phases ([`Phase`]). [`Formulation::guards`] are functions that are positive while one lasts;
//! where one of them falls to zero, [`Formulation::enter`] returns the transition.
//!
//! The function that gives the friction to the integrator, [`Friction::contact`](crate::physics::friction::Friction::contact), is the one whose
//! numbers are logged.

mod accelerations;
mod body;
mod euler;
mod fixed;
mod formulation;
mod free;
mod impact;
mod integrals;
mod lean;
mod model;
mod motion;
mod reaction;
mod support;

pub use accelerations::Accelerations;
pub use body::BodyRotation;
pub use euler::EulerAngles;
pub use formulation::{Entry, Formulation, Guard, Transition};
pub use free::FreeRotation;
pub use impact::Impact;
pub use integrals::{FEW_INTEGRALS, INTEGRALS, Integrals, TERMS_SINE, TermIntegrals};
pub use model::Model;
pub use motion::{Dissipated, Motion, Peg, Start};
pub use support::{Phase, Support};
