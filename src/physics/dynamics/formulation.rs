//! What a choice of variables has to offer, and the motion that a state means.

use super::integrals::Integrals;
use super::model::Model;
use crate::physics::integrate::System;
use crate::physics::kinematics::{Euler, Tilt};
use nalgebra::UnitQuaternion;

/// What the contact point does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum Regime {
    /// Slips, or would: no friction holds it.
    #[default]
    Slipping,
    /// Stays at rest, while the top turns about the vertical as a whole.
    Sticking,
}

/// The motion at one instant, whatever the formulation that computed it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    /// Euler angles, rad; φ and ψ unwrapped.
    pub angles: Euler,
    /// Inclination and angular velocity.
    pub tilt: Tilt,
    /// Integrals since the start.
    pub integrals: Integrals,
}

/// A choice of variables for the equations of motion, with `N` numbers as state, of which the last
/// [`INTEGRALS`](super::INTEGRALS) are the running integrals.
pub trait Formulation<const N: usize>: System<N> + Copy {
    /// The state at the start from Euler angles (rad) and rates (rad/s).
    fn state(angles: Euler, rates: Euler, model: &Model) -> [f64; N];

    /// The motion that a state describes. `reference` are Euler angles of a moment ago, from which φ
    /// and ψ go on without jumps of whole turns.
    fn motion(&self, state: &[f64; N], reference: Euler) -> Motion;

    /// The orientation in a state: turns body components into world components.
    fn world_from_body(&self, state: &[f64; N]) -> UnitQuaternion<f64>;

    /// The physics.
    fn model(&self) -> &Model;

    /// What the contact point does.
    fn regime(&self) -> Regime;

    /// These equations in another regime.
    #[must_use]
    fn in_regime(self, regime: Regime) -> Self;

    /// The state with the contact point brought to rest at the same angular momentum about the vertical.
    fn brought_to_rest(&self, state: &[f64; N]) -> [f64; N];
}
