//! The equations of motion of a top on a table.
//!
//! A [`Model`] holds the physics shared by all formulations: the top, its friction and its [`Support`]. It computes
//! forces, torques and the terms of the Euler accelerations. A [`Formulation`] defines the integration variables:
//!
//! * [`EulerAngles`]: the paper's equations (7) as printed, for a fixed peg; singular upright.
//! * [`BodyRotation`]: orientation and angular momentum, for a fixed peg; regular everywhere.
//! * [`FreeRotation`]: orientation, angular momentum and the motion of the centre of mass, for a free peg.
//!
//! A motion consists of phases ([`Phase`]). [`Formulation::guards`] are positive during a phase; at a zero,
//! [`Formulation::enter`] starts the next one.
//!
//! The recorded friction is computed by the same function as that of the integrator:
//! [`Friction::contact`](crate::physics::friction::Friction::contact) for a fixed peg, `FreeBody::reaction` for a free
//! one.

mod accelerations;
mod body;
mod departure;
mod euler;
mod fixed;
mod formulation;
mod free;
mod holding;
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
pub use formulation::{Entered, Entry, Formulation, Guard, Started, Transition};
pub use free::FreeRotation;
pub use impact::Impact;
pub use integrals::{FEW_INTEGRALS, INTEGRALS, Integrals, TERMS_SINE, TermIntegrals};
pub use model::Model;
pub(crate) use motion::NO_SLIP;
pub use motion::{Departing, Dissipated, Motion, Peg, Start};
pub use support::{Phase, Support};
