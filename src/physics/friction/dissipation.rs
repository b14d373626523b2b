//! The parts of sliding friction that enter the equations of motion.

use super::{Contact, Friction};
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use nalgebra::Vector3;

/// Parts of the sliding friction torque included in the equations of motion. [`Losses`](super::Losses) are always included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dissipation {
    /// All of it: the paper's equation (4).
    Full,
    /// All but the component about the line of nodes (opposite to θ̇): the paper's equations (6) and (7). The slip
    /// speed in its denominator keeps its θ̇.
    WithoutNutationPart,
    /// Only the term in φ̈ of (7): the paper's figure 4a. Not the torque of a force.
    PrecessionTermOnly,
    /// Only the term in ψ̈ of (7): the paper's figure 4b. Not the torque of a force.
    SpinTermOnly,
    /// The component `τ_2` of the torque of (6) about `n × e_N`, which tilts the axis; the torque counterpart of figure
    /// 4a. `L_n` stays constant.
    TiltTorqueOnly,
    /// The component `τ_3` of the torque of (6) about the symmetry axis, which reduces the spin; the torque counterpart
    /// of figure 4b.
    SpinTorqueOnly,
}

impl Dissipation {
    /// Whether terms of the Euler-angle equations are dropped, which divides by sin θ.
    pub fn drops_euler_terms(self) -> bool {
        matches!(self, Self::PrecessionTermOnly | Self::SpinTermOnly)
    }

    /// Whether the torque is that of a force at the contact point, i.e. has no vertical component and never adds
    /// energy.
    pub fn is_of_force(self) -> bool {
        matches!(self, Self::Full | Self::WithoutNutationPart)
    }
}

impl Friction {
    /// Torque of friction about the peg's centre that enters the motion, in the lean frame, N m.
    ///
    /// For the two ablations of the paper: the torque equivalent to the retained acceleration terms.
    #[inline(always)]
    pub fn torque(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        let sliding = self.torque_of_sliding(top, contact, tilt);
        match contact.losses {
            None => sliding,
            Some(losses) => sliding + losses,
        }
    }

    /// The terms that friction adds to θ̈, φ̈ and ψ̈, rad/s² (the last terms of the paper's equation (7)).
    ///
    /// They diverge towards the vertical. Upright, only their sum about the vertical is defined, and φ̈ is taken as 0,
    /// as for the rates.
    #[inline(always)]
    pub fn euler_accelerations(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Euler {
        let sliding = self.accelerations_of_sliding(top, contact, tilt);
        match contact.losses {
            None => sliding,
            Some(losses) => sliding + top.euler_accelerations(&tilt.lean_to_node(&losses), tilt),
        }
    }

    /// Torque of the sliding friction in the lean frame, N m: of the retained part.
    #[inline(always)]
    fn torque_of_sliding(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        if self.dissipation.is_of_force() || tilt.is_upright() {
            return contact_torque(top, contact);
        }
        if !self.dissipation.drops_euler_terms() {
            return tilt.node_to_lean(&self.kept_torque(top, contact, tilt));
        }
        // The ablations drop terms of (7), which are no components of a torque: this is the torque that would have the
        // remaining terms.
        let kept = self.accelerations_of_sliding(top, contact, tilt);
        let (transverse, axial) = (top.transverse_moment, top.axial_moment);
        let (sin, cos) = (tilt.sin, tilt.cos);
        // 𝕀 α with α = φ̈ z′ + ψ̈ n, in lean components.
        Vector3::new(
            sin * ((axial - transverse) * cos * kept.phi + axial * kept.psi),
            0.0,
            (transverse * sin * sin + axial * cos * cos) * kept.phi + axial * cos * kept.psi,
        )
    }

    /// The retained components of the friction torque in the node frame, N m.
    #[inline(always)]
    fn kept_torque(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        let torque = tilt.lean_to_node(&contact_torque(top, contact));
        match self.dissipation {
            Dissipation::TiltTorqueOnly => Vector3::new(0.0, torque.y, 0.0),
            Dissipation::SpinTorqueOnly => Vector3::new(0.0, 0.0, torque.z),
            Dissipation::Full
            | Dissipation::WithoutNutationPart
            | Dissipation::PrecessionTermOnly
            | Dissipation::SpinTermOnly => torque,
        }
    }

    /// The terms that the retained sliding friction adds to the Euler accelerations, rad/s².
    #[inline(always)]
    fn accelerations_of_sliding(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Euler {
        let mut kept = top.euler_accelerations(&self.kept_torque(top, contact, tilt), tilt);
        match self.dissipation {
            Dissipation::PrecessionTermOnly => kept.psi = 0.0,
            Dissipation::SpinTermOnly => kept.phi = 0.0,
            Dissipation::Full
            | Dissipation::WithoutNutationPart
            | Dissipation::TiltTorqueOnly
            | Dissipation::SpinTorqueOnly => {}
        }
        kept
    }
}

/// Torque of the contact force about the peg's centre in the lean frame, N m: `r × f`, `r = −R z′`.
#[inline]
fn contact_torque(top: &Top, contact: &Contact) -> Vector3<f64> {
    Vector3::new(
        top.peg_radius * contact.force.y,
        -top.peg_radius * contact.force.x,
        0.0,
    )
}
