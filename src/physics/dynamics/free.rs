//! A top with a free peg: it slides, rolls, lifts off, flies and lands.

mod state;
mod transitions;

pub use self::state::FreeRotation;
use self::state::{
    CENTER, CONTROLLED, Departure, SCALED_MOMENTUM, VELOCITY, quaternion_rate, set_vector, vector,
};
use self::transitions::{JAM_HORIZON, JAMMED};

use super::formulation::{Entered, Entry, Formulation, Guard, Started, Transition};
use super::holding::Resting;
use super::integrals::{integrals, with_integrals};
use super::lean::quaternion;
use super::model::Model;
use super::motion::{Dissipated, HELD_AGAIN, Motion, NO_SLIP, Peg, Start};
use super::reaction::{Inertia, Reaction};
use super::support::Phase;
use crate::physics::friction::{BREAKAWAY_SPEED, NO_ROLLING, Rocking};
use crate::physics::integrate::{System, Tolerances};
use crate::physics::kinematics::{
    Euler, Tilt, euler_angles, inclination, lean_to_world, world_from_body,
};
use crate::physics::math::hypot;
use nalgebra::{Unit, UnitQuaternion, Vector3};

/// Fraction of the tolerances of the motion that a step may use, because the nutation of a free top is unstable and amplifies errors.
const ERROR_SHARE: f64 = 0.02;

/// Minimum relative tolerance (rounding).
const ROUNDING: f64 = 1e-14;

impl<const N: usize> System<N> for FreeRotation {
    const CONTROLLED: usize = CONTROLLED;

    #[inline]
    fn derivative(&self, _t: f64, y: &[f64; N]) -> [f64; N] {
        let parts = self.parts(y);
        let (lean, omega) = (&parts.lean, &parts.tilt.omega_lean);
        let reaction = self.reaction(&parts);
        let torque = reaction.torque(&parts.arm) * self.inertia.per_transverse;
        let scaled_torque = lean.lean_to_world(&torque);
        let turning = quaternion_rate(&quaternion(y), &lean.lean_to_world(omega));
        let moving = lean.lean_to_world(&parts.velocity);
        let mut acceleration = lean.lean_to_world(&(reaction.force() * self.inertia.per_mass));
        acceleration.z -= self.model.top.gravity;
        let (mut rise, mut fall) = (moving.z, acceleration.z);
        if self.phase != Phase::Flying {
            // Components that follow from the inclination are not integrated.
            (rise, fall) = (0.0, 0.0);
        }
        let losses = (reaction.friction.couple + reaction.air).dot(omega);
        let first: [f64; Self::VARIABLES] = [
            turning.i,
            turning.j,
            turning.k,
            turning.w,
            scaled_torque.x,
            scaled_torque.y,
            scaled_torque.z,
            moving.x,
            moving.y,
            rise,
            acceleration.x,
            acceleration.y,
            fall,
            0.0,
            0.0,
            -losses,
        ];
        let all = N == Self::STATE_LENGTH;
        let integrands = self.integrands(&parts, &reaction, losses, all);
        with_integrals(first, &integrands)
    }
}

impl<const N: usize> Formulation<N> for FreeRotation {
    fn step_tolerances(tolerances: Tolerances) -> Tolerances {
        let Tolerances { relative, absolute } = tolerances;
        Tolerances {
            relative: (ERROR_SHARE * relative).max(relative.min(ROUNDING)),
            absolute: ERROR_SHARE * absolute,
        }
    }

    fn start(model: &Model, start: &Start) -> Started<Self, N> {
        let (angles, rates) = (start.angles, start.rates);
        let (peg_position, peg_velocity) = (start.peg_position, start.peg_velocity);
        let top = &model.top;
        let q = world_from_body(angles);
        let tilt = Tilt::from_rates(angles.theta, rates);
        let central = top.about_center();
        let momentum = tilt.node_to_lean(&central.angular_momentum_node(&tilt));
        let scaled_momentum = lean_to_world(&(momentum / central.transverse_moment), angles.phi);
        let axis = lean_to_world(&tilt.axis(), angles.phi);
        let omega = lean_to_world(&tilt.omega_lean, angles.phi);
        let center = peg_position + top.center_distance * axis;
        let velocity = peg_velocity + top.center_distance * omega.cross(&axis);
        let mut state = [0.0; N];
        state[..4].copy_from_slice(&[q.i, q.j, q.k, q.w]);
        set_vector(&mut state, SCALED_MOMENTUM, &scaled_momentum);
        set_vector(&mut state, CENTER, &center);
        set_vector(&mut state, VELOCITY, &velocity);
        // Only in flight are all components of the state used.
        let flying = Self {
            model: model.clone(),
            phase: Phase::Flying,
            departure: None,
            inertia: Inertia::new(top),
        };
        if start.is_in_flight(top.peg_radius) {
            return (flying, state, None);
        }
        let slip = flying.parts(&state).contact_velocity();
        let at_rest = hypot(slip.x, slip.y) <= NO_SLIP;
        let formulation = flying.on_table(&state, at_rest);
        // A top that pivots also rolls: the narrower transition is reported.
        let rolls = formulation.phase == Phase::Sticking;
        let transition = if formulation.is_jammed(&state) {
            Some(Transition::Jams)
        } else {
            formulation
                .stopping(&state)
                .or(rolls.then_some(Transition::Rolls))
        };
        (formulation, state, transition)
    }

    fn angles(&self, y: &[f64; N], reference: Euler) -> Euler {
        euler_angles(&quaternion(y), self.lean(y).unwrap_reference(reference))
    }

    fn motion_without_turns(&self, y: &[f64; N], reference: Euler) -> Motion {
        let top = &self.model.top;
        let mut parts = self.parts(y);
        if parts.tilt.is_upright() {
            let scaled_torque = vector(&self.derivative(0.0, y), SCALED_MOMENTUM);
            let scaled_momentum = vector(y, SCALED_MOMENTUM);
            parts.tilt = parts
                .lean
                .rates_at_vertical(parts.tilt, &scaled_momentum, &scaled_torque);
        }
        let to_peg = Vector3::new(parts.arm.lean, 0.0, parts.arm.up + top.peg_radius);
        let mut position = vector(y, CENTER) + parts.lean.lean_to_world(&to_peg);
        let mut velocity_lean = parts.velocity + parts.tilt.omega_lean.cross(&to_peg);
        if self.phase != Phase::Flying {
            // The height follows from the contact; that of the state is rounded.
            position.z = top.peg_radius;
            velocity_lean.z = 0.0;
        }
        let contact_velocity = parts.contact_velocity();
        let slip = Vector3::new(contact_velocity.x, contact_velocity.y, 0.0);
        Motion {
            angles: Euler {
                theta: inclination(&quaternion(y)),
                ..reference
            },
            tilt: parts.tilt,
            peg: Peg {
                position,
                velocity_lean,
                departure: self.departing(&parts.tilt, &slip),
                dissipated: Dissipated {
                    impact_normal: y[CONTROLLED],
                    impact_friction: y[CONTROLLED + 1],
                    losses: y[CONTROLLED + 2],
                },
            },
            phase: self.phase,
            branch: self.model.friction.branch,
            integrals: integrals::<{ Self::VARIABLES }, N>(y),
        }
    }

    fn world_from_body(&self, y: &[f64; N]) -> UnitQuaternion<f64> {
        Unit::new_normalize(quaternion(y))
    }

    fn model(&self) -> &Model {
        &self.model
    }

    fn phase(&self) -> Phase {
        self.phase
    }

    fn guards(&self) -> Vec<Guard> {
        let mut guards = match self.phase {
            Phase::Flying => return vec![Guard::Gap],
            // A non-positive normal force also ends sticking.
            Phase::Sticking => vec![Guard::Grip],
            Phase::Sliding => sliding_guards(&self.model),
        };
        if self.departure == Some(Departure::Breakaway) {
            guards.push(Guard::Departure);
        }
        let held = self.held();
        if self.model.friction.rolling_arm() > 0.0 {
            guards.push(if held.rocking {
                Guard::RollingGrip
            } else {
                Guard::Rolling
            });
        }
        if self.model.friction.drilling_bound(1.0, false) > 0.0 {
            guards.push(if held.turning {
                Guard::TurningGrip
            } else {
                Guard::Turning
            });
        }
        guards
    }

    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        let top = &self.model.top;
        let slip = motion.slip_velocity(top);
        match guard {
            // A point that friction can't hold slips, even if it starts slowly.
            Guard::Slip if motion.peg.departure.is_some() => NO_SLIP,
            Guard::Slip => {
                let friction = &self.model.friction;
                friction.patch_speed(slip.norm(), motion.tilt.omega_lean.z) - NO_SLIP
            }
            Guard::Grip => self.grip(&self.reaction_in(motion)),
            Guard::Departure => {
                let friction = &self.model.friction;
                BREAKAWAY_SPEED - friction.patch_speed(slip.norm(), motion.tilt.omega_lean.z)
            }
            Guard::NormalForce => self.reaction_in(motion).normal,
            Guard::Gap => motion.peg.position.z - top.peg_radius,
            Guard::Mobility => {
                let body = self.body_in(motion);
                body.mobility(&motion.law_slip(&slip)) - JAMMED
            }
            Guard::Rolling => self.rolling_guard(motion),
            Guard::RollingGrip => {
                let Reaction {
                    normal, friction, ..
                } = self.reaction_in(motion);
                let torque = hypot(friction.couple.x, friction.couple.y);
                self.model.friction.rolling_arm() * normal - torque
            }
            Guard::Turning => {
                let turning = self.model.friction.branch.turning;
                turning.along(motion.tilt.omega_lean.z)
            }
            Guard::TurningGrip => {
                let Reaction {
                    normal, friction, ..
                } = self.reaction_in(motion);
                self.model.friction.drilling_bound(normal, false) - friction.couple.z.abs()
            }
            // These variables are regular everywhere.
            Guard::Regular => f64::NAN,
        }
    }

    fn enter(&self, guard: Guard, y: &[f64; N], reference: Euler) -> Entered<Self, N> {
        let (mut delay, mut state) = (0.0, self.completed(y));
        let mut impact = None;
        let (formulation, transition) = match guard {
            Guard::Slip => {
                // The guard is zero just before the slip is.
                (state, delay) = self.at_rest(y);
                let resting = Resting {
                    slip: true,
                    ..self.held()
                };
                let next = self.settled(&state, resting);
                let transition = match next.phase {
                    Phase::Sticking => next.stopping(&state).unwrap_or(Transition::Rolls),
                    Phase::Sliding => Transition::SlipStops,
                    Phase::Flying => Transition::LiftsOff,
                };
                (next, transition)
            }
            Guard::Grip => {
                let next = self.after_release(&state);
                let transition = match next.phase {
                    Phase::Flying => Transition::LiftsOff,
                    Phase::Sliding | Phase::Sticking => Transition::RollEnds,
                };
                (next, transition)
            }
            Guard::Departure => {
                // The slip is fast enough for the law to give the direction of friction.
                let departed = Self {
                    departure: None,
                    ..self.clone()
                };
                (departed, Transition::Departs)
            }
            Guard::NormalForce => (self.with_phase(Phase::Flying), Transition::LiftsOff),
            Guard::Gap => {
                let contact = self.after_contact(&state)?;
                (state, impact) = (contact.state, contact.impact);
                (contact.formulation, contact.transition)
            }
            Guard::Mobility => (self.clone(), Transition::Jams),
            Guard::Rolling => {
                let resting = Resting {
                    rocking: true,
                    ..self.held()
                };
                let next = self.settled(&state, resting);
                let transition = if next.held().rocking {
                    next.pivoting(&state)
                } else {
                    Transition::RockingResumes
                };
                (next, transition)
            }
            Guard::RollingGrip => (self.rocking_again(), Transition::RockingResumes),
            Guard::Turning => {
                let resting = Resting {
                    turning: true,
                    ..self.held()
                };
                let next = self.settled(&state, resting);
                let transition = if next.is_motionless(&state) {
                    Transition::Rests
                } else if next.held().turning {
                    Transition::TurningStops
                } else {
                    Transition::TurningResumes
                };
                (next, transition)
            }
            Guard::TurningGrip => (self.turning_again(&state), Transition::TurningResumes),
            Guard::Regular => (self.clone(), Transition::BecomesSingular),
        };
        let transition = if formulation.is_jammed(&state) {
            Transition::Jams
        } else {
            transition
        };
        Ok(Entry {
            state,
            delay,
            transition,
            impact,
            motion: formulation.motion(&state, reference),
            first_step: formulation.first_step(&state),
            formulation,
        })
    }

    fn singularity(&self, y: &[f64; N]) -> Option<Transition> {
        (self.time_to_jam(y)? < JAM_HORIZON).then_some(Transition::Jams)
    }
}

impl FreeRotation {
    /// The contact forces in a motion of this phase.
    #[inline]
    fn reaction_in(&self, motion: &Motion) -> Reaction {
        let slip = motion.slip_velocity(&self.model.top);
        self.body_in(motion)
            .reaction(self.phase, &motion.law_slip(&slip))
    }

    /// The guard of rocking: the horizontal angular velocity above [`NO_ROLLING`], rad/s. It is open while rocking
    /// begins, until the friction of its direction slows it down again.
    fn rolling_guard(&self, motion: &Motion) -> f64 {
        let rate = hypot(motion.tilt.omega_lean.x, motion.tilt.omega_lean.y);
        if rate >= NO_ROLLING {
            return rate - NO_ROLLING;
        }
        let body = self.body(motion.tilt);
        let beginning = match self.model.friction.branch.rocking {
            Rocking::Starting(direction) => Some(direction),
            Rocking::Breakaway => {
                let slip = motion.law_slip(&motion.slip_velocity(&self.model.top));
                Some(body.rocking_direction(self.phase, &slip))
            }
            Rocking::Any | Rocking::Along(_) | Rocking::Held => None,
        };
        if let Some(direction) = beginning {
            let reaction = self.reaction_in(motion);
            let acceleration = body.turning_for(&reaction);
            let friction = self.model.friction.rolling_arm() * reaction.normal;
            let strongest = friction * self.inertia.per_transverse;
            if acceleration.dot(&direction) >= -HELD_AGAIN * strongest {
                return NO_ROLLING;
            }
        }
        rate - NO_ROLLING
    }
}

/// Guards that end sliding, without rolling resistance.
fn sliding_guards(model: &Model) -> Vec<Guard> {
    let Model { top, friction, .. } = model;
    // No normal force can jam the peg if k (R + |l|) + δ < 2 √(A/M), whatever the inclination.
    let reach = top.peg_radius + top.center_distance.abs();
    let lever = friction.law.largest_coefficient() * reach + friction.rolling_arm();
    let jams = lever >= 2.0 * (top.central_moment() / top.mass).sqrt();
    let mut guards = Vec::new();
    if friction.holds_slip() {
        guards.push(Guard::Slip);
    }
    guards.push(Guard::NormalForce);
    if jams {
        guards.push(Guard::Mobility);
    }
    guards
}
