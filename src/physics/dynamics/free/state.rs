//! State components of a top with a free peg.

use crate::physics::dynamics::accelerations::accelerations_about;
use crate::physics::dynamics::holding::Resting;
use crate::physics::dynamics::integrals::{FEW_INTEGRALS, INTEGRALS, Integrals, TermIntegrals};
use crate::physics::dynamics::lean::{Lean, quaternion};
use crate::physics::dynamics::model::Model;
use crate::physics::dynamics::motion::{
    DEPARTING, Departing, HELD_AGAIN, Motion, NO_SLIP, is_departing,
};
use crate::physics::dynamics::reaction::{ContactArm, FreeBody, Inertia, Reaction};
use crate::physics::dynamics::support::Phase;
use crate::physics::friction::{
    BREAKAWAY_SPEED, Branch, FrictionLaw, NO_ROLLING, PatchDirection, Rocking, Turning,
};
use crate::physics::kinematics::Tilt;
use crate::physics::math::{atan2, hypot};
use nalgebra::{Quaternion, Vector3};

/// Rates about the vertical below this count as zero where a phase begins, rad/s.
const NO_TURNING: f64 = NO_ROLLING;

/// Rotation about the centre of mass plus translation of the centre of mass.
///
/// State: quaternion x, y, z, w (transforms body to world components); angular momentum about the centre of mass
/// divided by the transverse moment of inertia about it, world frame (rad/s, scaled like the rates so that tolerances
/// are comparable); position (m) and velocity (m/s) of the centre of mass, world frame; the energy lost in impacts and
/// other losses (J); and the running integrals.
///
/// On the table, the height of the centre of mass is computed from the inclination; while rolling, its velocity is
/// computed from the angular velocity. The corresponding components are used only in flight and sliding.
#[derive(Clone, Debug, PartialEq)]
pub struct FreeRotation {
    /// The physics.
    pub model: Model,
    /// Phase of the contact point.
    pub phase: Phase,
    /// Departure from rest, if the slip has just begun.
    pub(super) departure: Option<Departure>,
    pub(super) inertia: Inertia,
}

/// Beginning of the slip of a contact point that was at rest. At first the slip is too slow to define a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Departure {
    /// In this direction, lean frame.
    Toward(Vector3<f64>),
    /// Friction gives way gradually; the direction follows from the motion.
    Breakaway,
}

/// Index of the first component of the scaled angular momentum.
pub(super) const SCALED_MOMENTUM: usize = 4;
/// Index of the first component of the position of the centre of mass.
pub(super) const CENTER: usize = 7;
/// Index of the first component of the velocity of the centre of mass.
pub(super) const VELOCITY: usize = 10;
/// Number of components of the motion, whose error is controlled.
pub(super) const CONTROLLED: usize = 13;
/// Number of energies lost, which follow.
pub(super) const DISSIPATED: usize = 3;

/// Quantities derived from a state, in the lean frame.
pub(super) struct Parts {
    pub(super) lean: Lean,
    pub(super) tilt: Tilt,
    /// Velocity of the centre of mass, m/s.
    pub(super) velocity: Vector3<f64>,
    pub(super) arm: ContactArm,
    /// Velocity of the centre of mass for rolling, m/s.
    pub(super) rolling: Vector3<f64>,
}

impl Parts {
    /// Velocity of the contact point, m/s.
    #[inline(always)]
    pub(super) fn contact_velocity(&self) -> Vector3<f64> {
        self.velocity - self.rolling
    }
}

impl FreeRotation {
    /// Number of state components for the motion; the running integrals follow.
    pub(super) const VARIABLES: usize = CONTROLLED + DISSIPATED;
    /// State length with all running integrals.
    pub const STATE_LENGTH: usize = Self::VARIABLES + INTEGRALS;
    /// State length with only the integrals that an outcome needs.
    pub const SHORT_STATE_LENGTH: usize = Self::VARIABLES + FEW_INTEGRALS;

    #[inline(always)]
    pub(super) fn body(&self, tilt: Tilt) -> FreeBody<'_> {
        FreeBody::new(&self.model.top, &self.model.friction, &self.inertia, tilt)
    }

    /// The body in a motion, with the friction of a beginning slip.
    #[inline(always)]
    pub(super) fn body_in(&self, motion: &Motion) -> FreeBody<'_> {
        self.body(motion.tilt)
            .departing(motion.peg.departure.as_ref())
    }

    #[inline(always)]
    pub(super) fn parts<const N: usize>(&self, y: &[f64; N]) -> Parts {
        let top = &self.model.top;
        let lean = self.lean(y);
        let scaled = lean.world_to_lean(&vector(y, SCALED_MOMENTUM));
        let axial = lean.sin * scaled.x + lean.cos * scaled.z;
        let excess = axial * (self.inertia.transverse * self.inertia.per_axial - 1.0);
        // ω = L/A + (1/I_z − 1/A)(L·n) n, with L already divided by A.
        let mut omega = scaled + excess * Vector3::new(lean.sin, 0.0, lean.cos);
        if self.model.friction.branch.is_held() {
            omega = self.held_rotation(&lean, &scaled);
        }
        let tilt = Tilt::from_omega(lean.sin, lean.cos, omega);
        let arm = ContactArm::new(top, lean.sin, lean.cos);
        let rolling = arm.cross(&tilt.omega_lean);
        let velocity = match self.phase {
            Phase::Flying => lean.world_to_lean(&vector(y, VELOCITY)),
            Phase::Sticking => rolling,
            Phase::Sliding => {
                let own = lean.world_to_lean(&vector(y, VELOCITY));
                // The peg stays on the table.
                Vector3::new(own.x, own.y, rolling.z)
            }
        };
        Parts {
            lean,
            tilt,
            velocity,
            arm,
            rolling,
        }
    }

    /// The angular velocity while friction prevents rocking or turning about the vertical, rad/s, lean frame: from the
    /// components of the scaled angular momentum that it leaves.
    #[cold]
    fn held_rotation(&self, lean: &Lean, scaled: &Vector3<f64>) -> Vector3<f64> {
        let central = self.model.top.about_center();
        let momentum = central.transverse_moment * scaled;
        let Branch { turning, rocking } = self.model.friction.branch;
        match (rocking, turning) {
            (Rocking::Held, Turning::Held) => Vector3::zeros(),
            (Rocking::Held, _) => {
                let rate = momentum.z / central.vertical_moment(lean.sin, lean.cos);
                Vector3::new(0.0, 0.0, rate)
            }
            (Rocking::Any | Rocking::Starting(_) | Rocking::Along(_) | Rocking::Breakaway, _) => {
                central.rocking_rate(&momentum, lean.sin, lean.cos)
            }
        }
    }

    /// The tilt direction. If the axis is vertical and at rest, friction tilts it about the horizontal direction
    /// perpendicular to the slip.
    #[inline(always)]
    pub(super) fn lean<const N: usize>(&self, y: &[f64; N]) -> Lean {
        let top = &self.model.top;
        Lean::new(&quaternion(y), |cos| {
            let momentum = vector(y, SCALED_MOMENTUM);
            if momentum.x != 0.0 || momentum.y != 0.0 || self.phase == Phase::Sticking {
                momentum
            } else {
                let velocity = vector(y, VELOCITY);
                ContactArm::new(top, 0.0, cos).up * Vector3::new(velocity.y, -velocity.x, 0.0)
            }
        })
    }

    #[inline(always)]
    pub(super) fn reaction(&self, parts: &Parts) -> Reaction {
        let body = self.body(parts.tilt);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        match self.departing(&parts.tilt, &slip) {
            Some(departing) => body
                .departing(Some(&departing))
                .reaction(self.phase, &departing.slip),
            None => body.reaction(self.phase, &slip),
        }
    }

    /// The motion that a beginning slip has for the friction law; `None` if it is fast enough to define its direction, or
    /// friction can hold the contact again.
    #[inline(always)]
    pub(super) fn departing(&self, tilt: &Tilt, slip: &Vector3<f64>) -> Option<Departing> {
        let departure = self.departure?;
        let friction = &self.model.friction;
        if matches!(departure, Departure::Toward(_)) && !is_departing(slip) {
            return None;
        }
        let holding = self.holding();
        let body = holding.body(*tilt);
        let held = body.held();
        // Friction that can hold the contact again ends the departure; the margin prevents alternation by rounding.
        let strongest = friction.law.static_bound_at(held.normal, 0.0);
        if self.grip(&held) > HELD_AGAIN * strongest {
            return None;
        }
        match departure {
            Departure::Breakaway => Some(self.breaking_away(tilt, slip, &held)),
            Departure::Toward(direction) => Some(Departing {
                slip: DEPARTING * direction,
                turning_rate: tilt.omega_lean.z,
            }),
        }
    }

    /// The motion of a contact that gives way to the load that would still hold it: turned towards the direction in which
    /// the load moves it, the more the slower it is.
    #[cold]
    fn breaking_away(&self, tilt: &Tilt, slip: &Vector3<f64>, held: &Reaction) -> Departing {
        let friction = &self.model.friction;
        let force = Vector3::new(held.friction.force.x, held.friction.force.y, 0.0);
        let torque = held.friction.couple.z;
        let strength = hypot(force.x, force.y);
        let along = force / strength.max(f64::MIN_POSITIVE);
        let rate = tilt.omega_lean.z;
        match friction.law {
            FrictionLaw::Contensou { patch_radius, .. } => {
                let bound = friction.law.static_bound_at(held.normal, 0.0);
                let torque_bound = friction.drilling_bound(held.normal, true);
                let direction =
                    PatchDirection::under_load(strength / bound, torque.abs() / torque_bound);
                // The friction of a patch depends on the direction of its motion only.
                let share = friction.patch_speed(slip.norm(), rate) / BREAKAWAY_SPEED;
                let speed = (1.0 - share) * BREAKAWAY_SPEED;
                let rim = direction.rim.copysign(-torque);
                Departing {
                    slip: slip - speed * direction.slip * along,
                    turning_rate: rate + speed * rim / patch_radius,
                }
            }
            // Only the first two hold a contact point, which then gives way.
            FrictionLaw::Coulomb { .. }
            | FrictionLaw::Formula { .. }
            | FrictionLaw::Stribeck { .. }
            | FrictionLaw::None
            | FrictionLaw::Regularised { .. }
            | FrictionLaw::Viscous { .. } => {
                let speed = slip.norm();
                let direction = slip - (BREAKAWAY_SPEED - speed) * along;
                Departing {
                    // Stribeck's friction depends on the speed, too.
                    slip: speed.max(DEPARTING) * direction.normalize(),
                    turning_rate: rate,
                }
            }
        }
    }

    /// Rates of change of the running integrals (all or few); `losses` is the power of the losses, W.
    #[inline(always)]
    pub(super) fn integrands(
        &self,
        parts: &Parts,
        reaction: &Reaction,
        losses: f64,
        all: bool,
    ) -> Integrals {
        let Parts { lean, tilt, .. } = parts;
        let top = &self.model.top;
        let (mut slip_path, mut slip_work) = (0.0, 0.0);
        if self.phase == Phase::Sliding {
            let slip = parts.contact_velocity();
            slip_path = hypot(slip.x, slip.y);
            slip_work = reaction.friction.force.dot(&slip);
        }
        let few = Integrals {
            friction_work: slip_work + losses,
            slip_path,
            ..Integrals::default()
        };
        if !all {
            return few;
        }
        // About the centre of the peg, as for a fixed peg.
        let to_contact = Vector3::new(0.0, 0.0, -top.peg_radius);
        let friction =
            to_contact.cross(&reaction.friction.force) + reaction.friction.couple + reaction.air;
        let torque = tilt.lean_to_node(&friction);
        Integrals {
            theta: atan2(lean.sin, lean.cos),
            work_node: torque.component_mul(&tilt.omega_node()),
            slip_work,
            terms: TermIntegrals::rates(&accelerations_about(top, &torque, tilt), tilt),
            ..few
        }
    }

    /// These equations in another phase, on the same branches of friction; in flight there is none.
    pub(super) fn with_phase(&self, phase: Phase) -> Self {
        let branch = match phase {
            Phase::Flying => Branch::default(),
            Phase::Sliding | Phase::Sticking => self.model.friction.branch,
        };
        self.with_branch(phase, branch)
    }

    pub(super) fn with_branch(&self, phase: Phase, branch: Branch) -> Self {
        let friction = self.model.friction.on_branch(branch);
        Self {
            model: Model {
                friction,
                ..self.model
            },
            phase,
            departure: None,
            ..*self
        }
    }

    /// The phase in which friction holds the contact point, on the same branches as here. A contact patch that rests as a
    /// whole doesn't turn either.
    pub(super) fn holding(&self) -> Self {
        let branch = self.model.friction.branch;
        if self.model.friction.rests_as_a_whole() {
            let turning = Turning::Held;
            self.with_branch(Phase::Sticking, Branch { turning, ..branch })
        } else {
            self.with_branch(Phase::Sticking, branch)
        }
    }

    /// The phase in which the contact point slips, on the same branches as here. A contact patch that rests as a whole
    /// also turns again.
    pub(super) fn slipping(&self) -> Self {
        let branch = self.model.friction.branch;
        if self.model.friction.rests_as_a_whole() {
            let turning = Turning::Any;
            self.with_branch(Phase::Sliding, Branch { turning, ..branch })
        } else {
            self.with_branch(Phase::Sliding, branch)
        }
    }

    /// The components of the contact's motion that are at rest in a state, besides the slip.
    pub(super) fn resting<const N: usize>(&self, y: &[f64; N], slip: bool) -> Resting {
        let friction = &self.model.friction;
        let omega = self.parts(y).tilt.omega_lean;
        let patch_rests = friction.patch_speed(0.0, omega.z) <= NO_SLIP;
        Resting {
            slip: slip && friction.holds_slip() && patch_rests,
            rocking: friction.rolling_arm() > 0.0 && hypot(omega.x, omega.y) < NO_ROLLING,
            turning: friction.drilling_bound(1.0, false) > 0.0 && omega.z.abs() < NO_TURNING,
        }
    }

    /// The components that friction holds at rest in this phase.
    pub(super) fn held(&self) -> Resting {
        let branch = self.model.friction.branch;
        Resting {
            slip: self.phase == Phase::Sticking,
            rocking: branch.rocking == Rocking::Held,
            turning: branch.turning == Turning::Held,
        }
    }

    /// The state with the unused components of this phase filled in.
    pub(super) fn completed<const N: usize>(&self, y: &[f64; N]) -> [f64; N] {
        let parts = self.parts(y);
        let mut state = *y;
        set_vector(
            &mut state,
            VELOCITY,
            &parts.lean.lean_to_world(&parts.velocity),
        );
        if self.model.friction.branch.is_held() {
            let central = self.model.top.about_center();
            let momentum = parts
                .tilt
                .node_to_lean(&central.angular_momentum_node(&parts.tilt));
            let scaled = momentum * self.inertia.per_transverse;
            set_vector(
                &mut state,
                SCALED_MOMENTUM,
                &parts.lean.lean_to_world(&scaled),
            );
        }
        if self.phase != Phase::Flying {
            state[CENTER + 2] = -parts.arm.up;
        }
        state
    }
}

/// Rate of change of a quaternion, 1/s, while the body turns with `omega` (rad/s, world): half their product.
#[inline]
pub(super) fn quaternion_rate(q: &Quaternion<f64>, omega: &Vector3<f64>) -> Quaternion<f64> {
    let half = 0.5 * omega;
    Quaternion::new(
        -(half.x * q.i + half.y * q.j + half.z * q.k),
        half.x * q.w + half.y * q.k - half.z * q.j,
        half.y * q.w + half.z * q.i - half.x * q.k,
        half.z * q.w + half.x * q.j - half.y * q.i,
    )
}

/// The vector whose first component is `y[at]`.
#[inline]
pub(super) fn vector<const N: usize>(y: &[f64; N], at: usize) -> Vector3<f64> {
    Vector3::new(y[at], y[at + 1], y[at + 2])
}

/// Sets the vector whose first component is `y[at]`.
pub(super) fn set_vector<const N: usize>(y: &mut [f64; N], at: usize, v: &Vector3<f64>) {
    y[at..at + 3].copy_from_slice(v.as_slice());
}
