//! Contact forces on a free peg: normal force and friction.
//!
//! All vectors are in the lean frame (x tilt direction, y line of nodes, z up), torques and moments of inertia are
//! about the centre of mass. `ρ` is the vector from the centre of mass to the contact point.

use super::motion::Departing;
use super::support::Phase;
use crate::physics::friction::{Friction, Rocking, Wrench};
use crate::physics::kinematics::Tilt;
use crate::physics::top::Top;
use nalgebra::Vector3;

/// A top with a free peg at one inclination.
#[derive(Clone, Copy, Debug)]
pub(super) struct FreeBody<'a> {
    pub(super) top: &'a Top,
    pub(super) friction: &'a Friction,
    pub(super) tilt: Tilt,
    /// Rate about the vertical in the friction law, rad/s.
    pub(super) law_rate: f64,
    pub(super) arm: ContactArm,
    pub(super) inertia: Inertia,
    pub(super) inverse_mass: InverseMass,
}

/// The vector ρ from the centre of mass to the contact point, m; in the vertical plane of the axis.
#[derive(Clone, Copy, Debug)]
pub(super) struct ContactArm {
    /// In the tilt direction.
    pub(super) lean: f64,
    /// Upward component; negative.
    pub(super) up: f64,
}

impl ContactArm {
    #[inline(always)]
    pub(super) fn new(top: &Top, sin: f64, cos: f64) -> Self {
        Self {
            lean: -top.center_distance * sin,
            up: -(top.peg_radius + top.center_distance * cos),
        }
    }

    /// The vector product of this and another vector.
    #[inline(always)]
    pub(super) fn cross(&self, v: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            -self.up * v.y,
            self.up * v.x - self.lean * v.z,
            self.lean * v.y,
        )
    }
}

/// Moments of inertia about the centre of mass, and their inverses: divisions are slow in the inner loop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Inertia {
    /// 1/kg.
    pub(super) per_mass: f64,
    /// Moment of inertia across the symmetry axis, kg m².
    pub(super) transverse: f64,
    /// 1/(kg m²).
    pub(super) per_transverse: f64,
    /// The inverse of the moment about the symmetry axis, 1/(kg m²).
    pub(super) per_axial: f64,
}

impl Inertia {
    pub(super) fn new(top: &Top) -> Self {
        let transverse = top.central_moment();
        Self {
            per_mass: 1.0 / top.mass,
            transverse,
            per_transverse: 1.0 / transverse,
            per_axial: 1.0 / top.axial_moment,
        }
    }
}

/// Inverse of the effective mass matrix at the contact point, 1/kg (velocity change per impulse).
#[derive(Clone, Copy, Debug)]
pub(super) struct InverseMass {
    /// Along the line of nodes.
    pub(super) node: f64,
    /// In the tilt direction.
    pub(super) lean: f64,
    /// Upward.
    pub(super) up: f64,
    /// Coupling between the vertical and the tilt direction.
    pub(super) coupling: f64,
}

impl InverseMass {
    /// The velocity change (m/s) for an impulse (N s), or the acceleration for a force.
    #[inline(always)]
    pub(super) fn velocity_change(&self, impulse: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(
            self.lean * impulse.x + self.coupling * impulse.z,
            self.node * impulse.y,
            self.coupling * impulse.x + self.up * impulse.z,
        )
    }
}

/// All forces on the top except its weight.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reaction {
    /// Normal force, N. Negative if contact would require tension.
    pub(super) normal: f64,
    /// Friction force and couple of the contact, N and N m.
    pub(super) friction: Wrench,
    /// Torque of the air, N m.
    pub(super) air: Vector3<f64>,
}

impl Reaction {
    /// Torque about the centre of mass, N m.
    #[inline(always)]
    pub(super) fn torque(&self, arm: &ContactArm) -> Vector3<f64> {
        arm.cross(&self.force()) + self.friction.couple + self.air
    }

    /// Force of the table, N.
    #[inline(always)]
    pub(super) fn force(&self) -> Vector3<f64> {
        Vector3::new(self.friction.force.x, self.friction.force.y, self.normal)
    }
}

impl<'a> FreeBody<'a> {
    #[inline(always)]
    pub(super) fn new(top: &'a Top, friction: &'a Friction, inertia: &Inertia, tilt: Tilt) -> Self {
        let (l, radius) = (top.center_distance, top.peg_radius);
        let (sin, cos) = (tilt.sin, tilt.cos);
        let height = radius + l * cos;
        let (reach, lever) = (l + radius * cos, l * sin);
        let (per_mass, per_transverse) = (inertia.per_mass, inertia.per_transverse);
        Self {
            top,
            friction,
            tilt,
            law_rate: tilt.omega_lean.z,
            arm: ContactArm::new(top, sin, cos),
            inertia: *inertia,
            inverse_mass: InverseMass {
                node: per_mass
                    + reach * reach * per_transverse
                    + radius * radius * sin * sin * inertia.per_axial,
                lean: per_mass + height * height * per_transverse,
                up: per_mass + lever * lever * per_transverse,
                coupling: -lever * height * per_transverse,
            },
        }
    }

    /// The same body with the friction of a contact that begins to slip.
    #[inline(always)]
    pub(super) fn departing(self, departing: Option<&Departing>) -> Self {
        let law_rate = departing.map_or(self.law_rate, |departing| departing.turning_rate);
        Self { law_rate, ..self }
    }

    /// The angular velocity in the friction law, rad/s.
    #[inline(always)]
    pub(super) fn law_omega(&self) -> Vector3<f64> {
        let omega = &self.tilt.omega_lean;
        Vector3::new(omega.x, omega.y, self.law_rate)
    }

    /// The angular acceleration (rad/s²) for a torque (N m), or the change of angular velocity for an angular impulse.
    #[inline(always)]
    pub(super) fn angular_acceleration(&self, torque: &Vector3<f64>) -> Vector3<f64> {
        let (sin, cos) = (self.tilt.sin, self.tilt.cos);
        let per_transverse = self.inertia.per_transverse;
        let excess = self.inertia.per_axial - per_transverse;
        let axial = (sin * torque.x + cos * torque.z) * excess;
        Vector3::new(
            torque.x * per_transverse + axial * sin,
            torque.y * per_transverse,
            torque.z * per_transverse + axial * cos,
        )
    }

    /// The acceleration of the contact point without contact forces, m/s².
    ///
    /// The axis rotates with `ω × n`. The gyroscopic angular acceleration perpendicular to it is
    /// `(A − I_z) ω_n (ω × n) / A`, because `ω × L = (I_z − A) ω_n (ω × n)`.
    #[inline(always)]
    pub(super) fn free_acceleration(&self, air: &Vector3<f64>) -> Vector3<f64> {
        let angular = self.free_turning(air);
        let turning = self.tilt.omega_lean.cross(&self.axis_velocity());
        let mut acceleration = -self.arm.cross(&angular) - self.top.center_distance * turning;
        acceleration.z -= self.top.gravity;
        acceleration
    }

    /// The angular acceleration without contact forces, rad/s².
    #[inline(always)]
    pub(super) fn free_turning(&self, air: &Vector3<f64>) -> Vector3<f64> {
        let inertia = &self.inertia;
        let excess = (inertia.transverse - self.top.axial_moment) * self.tilt.axial_rate();
        let mut angular = self.axis_velocity() * (excess * inertia.per_transverse);
        if self.friction.has_losses() {
            angular += self.angular_acceleration(air);
        }
        angular
    }

    /// The angular acceleration with a reaction, rad/s².
    pub(super) fn turning_for(&self, reaction: &Reaction) -> Vector3<f64> {
        let torque = self.arm.cross(&reaction.force()) + reaction.friction.couple;
        self.free_turning(&reaction.air) + self.angular_acceleration(&torque)
    }

    /// The velocity of the tip of the symmetry axis, `ω × n`, 1/s.
    #[inline(always)]
    fn axis_velocity(&self) -> Vector3<f64> {
        let omega = self.tilt.omega_lean;
        let (sin, cos) = (self.tilt.sin, self.tilt.cos);
        Vector3::new(omega.y * cos, omega.z * sin - omega.x * cos, -omega.y * sin)
    }

    /// Acceleration of the contact point for a couple (N m) at the contact, m/s².
    #[inline(always)]
    pub(super) fn acceleration_per_couple(&self, couple: &Vector3<f64>) -> Vector3<f64> {
        -self.arm.cross(&self.angular_acceleration(couple))
    }

    /// The contact forces in a phase, for the slip velocity `slip` (m/s).
    #[inline(always)]
    pub(super) fn reaction(&self, phase: Phase, slip: &Vector3<f64>) -> Reaction {
        match phase {
            Phase::Sliding | Phase::Sticking if self.begins_to_rock() => {
                self.rocking_reaction(phase, slip)
            }
            Phase::Sliding | Phase::Sticking if self.friction.branch.is_held() => {
                self.holding_reaction(phase, slip)
            }
            Phase::Sliding => self.sliding(slip),
            Phase::Sticking => self.holding(),
            Phase::Flying => Reaction {
                normal: 0.0,
                friction: Wrench::default(),
                air: self.air(),
            },
        }
    }

    /// The acceleration of the contact point in flight, m/s².
    pub(super) fn flying_acceleration(&self) -> Vector3<f64> {
        self.free_acceleration(&self.air())
    }

    #[inline(always)]
    pub(super) fn air(&self) -> Vector3<f64> {
        let axis = self.tilt.axis();
        self.friction.torque_of_air(&self.tilt.omega_lean, &axis)
    }

    /// The normal force that prevents vertical motion of the contact point, with the corresponding friction.
    #[inline(always)]
    fn sliding(&self, slip: &Vector3<f64>) -> Reaction {
        let air = self.air();
        let per_normal_force = self.friction.per_normal_force(slip, &self.law_omega());
        let acceleration = self.acceleration_per_normal_force(&per_normal_force);
        let normal = -self.free_acceleration(&air).z / acceleration.z;
        Reaction {
            normal,
            friction: per_normal_force * normal,
            air,
        }
    }

    /// Vertical acceleration of the contact point per normal force including friction, relative to that without
    /// friction. If it is not positive, the peg jams (P. Painlevé, C. R. Acad. Sci. 121 (1895) 112).
    #[inline(always)]
    pub(super) fn mobility(&self, slip: &Vector3<f64>) -> f64 {
        if self.friction.branch.rocking == Rocking::Held {
            // A body that can't rock yields to a normal force as a mass does.
            return self.inertia.per_mass / self.inverse_mass.up;
        }
        let friction = self.friction.per_normal_force(slip, &self.law_omega());
        self.acceleration_per_normal_force(&friction).z / self.inverse_mass.up
    }

    /// The acceleration of the contact point per normal force, including friction.
    #[inline(always)]
    pub(super) fn acceleration_per_normal_force(&self, friction: &Wrench) -> Vector3<f64> {
        let force = Vector3::new(friction.force.x, friction.force.y, 1.0);
        let acceleration = self.inverse_mass.velocity_change(&force);
        if self.friction.has_losses() {
            acceleration + self.acceleration_per_couple(&friction.couple)
        } else {
            acceleration
        }
    }

    /// The forces that keep the contact point at rest.
    #[inline(always)]
    fn holding(&self) -> Reaction {
        let inverse_mass = &self.inverse_mass;
        let (lean, coupling) = (inverse_mass.lean, inverse_mass.coupling);
        let air = self.air();
        let couple = self
            .friction
            .per_normal_force(&Vector3::zeros(), &self.law_omega())
            .couple;
        let loose = self.free_acceleration(&air);
        let by_couple = self.acceleration_per_couple(&couple);
        let drive = (coupling + by_couple.x) / lean;
        let resistance = inverse_mass.up + by_couple.z - coupling * drive;
        let normal = (coupling / lean * loose.x - loose.z) / resistance;
        let force = Vector3::new(
            -loose.x / lean - drive * normal,
            -(loose.y + by_couple.y * normal) / inverse_mass.node,
            0.0,
        );
        Reaction {
            normal,
            friction: Wrench {
                force,
                couple: couple * normal,
            },
            air,
        }
    }

    /// The forces that keep the contact point at rest, whatever else friction holds.
    pub(super) fn held(&self) -> Reaction {
        self.reaction(Phase::Sticking, &Vector3::zeros())
    }

    /// The acceleration of the slip while sliding, m/s².
    pub(super) fn slip_acceleration(&self, slip: &Vector3<f64>) -> Vector3<f64> {
        let reaction = self.reaction(Phase::Sliding, slip);
        self.free_acceleration(&reaction.air)
            + self.inverse_mass.velocity_change(&reaction.force())
            + self.acceleration_per_couple(&reaction.friction.couple)
    }
}
