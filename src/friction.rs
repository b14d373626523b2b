//! Friction at the point of contact: which force answers a slip velocity, and which parts of its
//! torque enter the motion.

use crate::kinematics::{Euler, Tilt};
use crate::top::Top;
use nalgebra::Vector3;

/// A law of dry contact: the friction force as a function of slip velocity and normal force.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FrictionLaw {
    /// No friction at all.
    None,
    /// Coulomb's law `f = −k N v / |v|` (the paper, section 2).
    Coulomb {
        /// Coefficient of friction `k`, dimensionless.
        k: f64,
    },
}

/// Which parts of the friction torque enter the equations of motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dissipation {
    /// All of it: the paper's equation (4).
    Full,
    /// Without the part that opposes the nutation θ̇: the paper's equations (6) and (7). The slip speed
    /// in its denominator keeps its θ̇.
    WithoutNutationPart,
    /// Of (7), the term in φ̈ alone: the paper's figure 4a. Not a torque of any force.
    PrecessionTermOnly,
    /// Of (7), the term in ψ̈ alone: the paper's figure 4b. Not a torque of any force.
    SpinTermOnly,
}

impl Dissipation {
    /// Whether terms of the Euler-angle equations are dropped, which divides by sin θ.
    #[must_use]
    pub fn drops_euler_terms(self) -> bool {
        matches!(self, Self::PrecessionTermOnly | Self::SpinTermOnly)
    }
}

/// What happens at the point of contact. Vectors are in the lean frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Contact {
    /// Slip velocity of the contact point over the table, m/s.
    pub slip: Vector3<f64>,
    /// Its magnitude, m/s.
    pub slip_speed: f64,
    /// Normal force, N.
    pub normal_force: f64,
    /// Friction force of the law, N (without the nutation part if the model leaves it out).
    pub force: Vector3<f64>,
}

/// A friction law together with the parts of it that act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Friction {
    /// The law.
    pub law: FrictionLaw,
    /// The parts that act.
    pub dissipation: Dissipation,
}

impl Friction {
    /// The contact of `top` in the state `tilt` under the normal force `normal_force` (N).
    #[must_use]
    #[inline]
    pub fn contact(&self, top: &Top, normal_force: f64, tilt: &Tilt) -> Contact {
        let slip = tilt.slip_velocity(top.peg_radius);
        let slip_speed = (slip.x * slip.x + slip.y * slip.y).sqrt();
        let resistance = self.law.resistance(slip_speed, normal_force);
        let mut force = -resistance * slip;
        // Upright there is no line of nodes, so no part along it that could be left out.
        if self.dissipation != Dissipation::Full && !tilt.is_upright() {
            force.x = 0.0;
        }
        Contact {
            slip,
            slip_speed,
            normal_force,
            force,
        }
    }

    /// Torque of friction about the peg's centre that enters the motion, in the lean frame, N m.
    ///
    /// For the two ablations it is the torque that would produce the accelerations that are kept.
    #[must_use]
    #[inline]
    pub fn torque(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Vector3<f64> {
        if !self.dissipation.drops_euler_terms() || tilt.is_upright() {
            return contact_torque(top, contact);
        }
        let kept = self.euler_accelerations(top, contact, tilt);
        let (transverse, axial) = (top.transverse_moment, top.axial_moment);
        let (sin, cos) = (tilt.sin, tilt.cos);
        // 𝕀 α with α = φ̈ z′ + ψ̈ n, in lean components.
        Vector3::new(
            sin * ((axial - transverse) * cos * kept.phi + axial * kept.psi),
            0.0,
            (transverse * sin * sin + axial * cos * cos) * kept.phi + axial * cos * kept.psi,
        )
    }

    /// The terms that friction adds to θ̈, φ̈ and ψ̈, rad/s² (the last terms of the paper's equation (7)).
    ///
    /// They grow without bound toward upright; upright itself only their sum about the vertical has
    /// a meaning and φ̈ is taken as 0, as for the rates.
    #[must_use]
    #[inline]
    pub fn euler_accelerations(&self, top: &Top, contact: &Contact, tilt: &Tilt) -> Euler {
        let torque = tilt.lean_to_node(&contact_torque(top, contact));
        let phi = if tilt.is_upright() {
            0.0
        } else {
            torque.y / (top.transverse_moment * tilt.sin)
        };
        let psi = torque.z / top.axial_moment - phi * tilt.cos;
        let theta = torque.x / top.transverse_moment;
        match self.dissipation {
            Dissipation::Full | Dissipation::WithoutNutationPart => Euler { phi, theta, psi },
            Dissipation::PrecessionTermOnly => Euler {
                phi,
                theta,
                psi: 0.0,
            },
            Dissipation::SpinTermOnly => Euler {
                phi: 0.0,
                theta,
                psi,
            },
        }
    }
}

impl FrictionLaw {
    /// Friction force per slip velocity, N s/m: `|f| / |v|`. Without slip it is 0.
    #[must_use]
    #[inline]
    fn resistance(&self, slip_speed: f64, normal_force: f64) -> f64 {
        match *self {
            Self::Coulomb { k } if slip_speed > 0.0 => k * normal_force / slip_speed,
            Self::Coulomb { .. } | Self::None => 0.0,
        }
    }

    /// Largest friction force of the law under a normal force, N: the scale for drawing it.
    #[must_use]
    pub fn force_scale(&self, normal_force: f64) -> f64 {
        match *self {
            Self::None => 0.0,
            Self::Coulomb { k } => k * normal_force,
        }
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
