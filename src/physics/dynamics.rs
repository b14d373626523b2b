//! The equations of motion of a top whose peg's centre stays in place.
//!
//! A [`Model`] holds the physics that every formulation shares: the forces, the torques and the
//! terms of the Euler accelerations. A [`Formulation`] chooses the variables in which the motion is
//! integrated:
//!
//! * [`EulerAngles`]: the paper's equations (7) as printed; singular upright.
//! * [`BodyRotation`]: orientation and angular momentum; regular everywhere.
//!
//! The function that gives the friction to the integrator, [`Friction::contact`](crate::physics::friction::Friction::contact), is the one whose
//! numbers are logged.

mod body;
mod euler;
mod formulation;
mod integrals;
mod model;

pub use body::BodyRotation;
pub use euler::EulerAngles;
pub use formulation::{Formulation, Motion, Regime};
pub use integrals::{INTEGRALS, Integrals, TERMS_SINE, TermIntegrals};
pub use model::{Accelerations, Model};
