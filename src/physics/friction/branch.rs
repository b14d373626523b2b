//! Branches of set-valued friction.

use nalgebra::Vector3;

/// The branches of the set-valued torques in a phase of the motion.
///
/// A torque such as that of drilling is constant while the top turns, reverses with it, and takes any value up to a
/// bound while it doesn't turn. Within a phase the branch is fixed, so that the equations of motion stay smooth across
/// the zero that ends it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Branch {
    /// Branch of drilling friction.
    pub turning: Turning,
    /// Branch of the rolling resistance of a free peg, and of the slip of a fixed peg, which is rocking.
    pub rocking: Rocking,
}

/// Rotation about the vertical: `ω_z′`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turning {
    /// As the rate in the state says.
    #[default]
    Any,
    /// Positive.
    Forward,
    /// Negative.
    Backward,
    /// Zero, held by friction.
    Held,
}

/// Rotation about horizontal axes: `ω_⊥`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Rocking {
    /// As the rate in the state says.
    #[default]
    Any,
    /// Starting from zero, about this horizontal unit vector (lean frame).
    Starting(Vector3<f64>),
    /// Slow, resisted about this horizontal unit vector (lean frame).
    Along(Vector3<f64>),
    /// Starting from zero where friction gives way gradually: against the torque that would still hold the top.
    Breakaway,
    /// Zero, held by friction.
    Held,
}

impl Branch {
    /// Whether friction holds a rotation.
    #[inline]
    pub fn is_held(&self) -> bool {
        self.turning == Turning::Held || self.rocking == Rocking::Held
    }
}

impl Turning {
    /// The branch of a rate that is not zero, rad/s.
    pub fn from_rate(rate: f64) -> Self {
        if rate < 0.0 {
            Self::Backward
        } else {
            Self::Forward
        }
    }

    /// A rate (rad/s) in the sense of the branch: positive while the branch lasts.
    #[inline]
    pub fn along(self, rate: f64) -> f64 {
        match self {
            Self::Forward => rate,
            Self::Backward => -rate,
            // These branches last whatever the rate is; NaN has no sign to change.
            Self::Any | Self::Held => f64::NAN,
        }
    }

    /// A rate on this branch, for torques that depend on its sign only. `rate` is that of the state, rad/s.
    #[inline]
    pub(super) fn rate_of(self, rate: f64) -> f64 {
        match self {
            Self::Any => rate,
            Self::Forward => 1.0,
            Self::Backward => -1.0,
            Self::Held => 0.0,
        }
    }
}
