//! A top whose peg is free: it slides and rolls over the table, lifts off, flies and lands.

#![allow(
    clippy::inline_always,
    reason = "with hints alone little of this is unrolled into the derivative, and runs take half as long again"
)]

use super::accelerations::accelerations_about;
use super::fixed::NO_SLIP;
use super::formulation::{Entry, Formulation, Guard, Passage};
use super::impact::{Impact, impact};
use super::integrals::{
    FEW_INTEGRALS, INTEGRALS, Integrals, TermIntegrals, integrals, with_integrals,
};
use super::lean::Lean;
use super::model::Model;
use super::motion::{Dissipated, Motion, Peg, Start, is_departing, slip_of_law};
use super::reaction::{Arm, FreeBody, Inertia, Reaction};
use super::support::{Phase, Support};
use crate::physics::integrate::{IntegrateError, System, Tolerances};
use crate::physics::kinematics::{
    Euler, Tilt, euler_angles, inclination, lean_to_world, world_from_body,
};
use crate::physics::math::{atan2, hypot};
use nalgebra::{Quaternion, Unit, UnitQuaternion, Vector3};

/// A peg whose mobility (see [`Guard::Mobility`]) has fallen to this jams. The table's force has then grown to a million
/// times what it would be without friction.
const JAMMED: f64 = 1e-6;

/// A top that turns about a horizontal axis more slowly than this doesn't roll but pivot, rad/s.
const NO_ROLLING: f64 = 1e-9;

/// A peg that lifts off is followed, at first, for no longer than the top takes to turn by this, rad. In so short a step
/// the dense output errs by rounding only, whatever the tolerances.
const FIRST_TURN: f64 = 0.01;

/// The motion as a rotation of the body about its centre of mass, which moves.
///
/// State: quaternion x, y, z, w (turns body components into world components), angular momentum about the centre of mass
/// over the transverse moment of inertia about it in world components (rad/s: of the size of the rates, so that the
/// tolerances mean the same for each), position (m) and velocity (m/s) of the centre of mass in the world; then what
/// impacts and losses have taken (J), and the running integrals.
///
/// On the table the height of the centre of mass follows from the inclination, and so never drifts; where the peg rolls
/// the velocity follows from the angular velocity. The components for them are looked at in flight and in sliding only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeRotation {
    /// The physics.
    pub model: Model,
    /// What the contact point does.
    pub phase: Phase,
    /// How the contact point began to slip, if it was at rest before.
    departure: Option<Departure>,
    inertia: Inertia,
    sliding_guards: &'static [Guard],
}

/// How a contact point that was at rest begins to slip. Its slip is too slow at first to have a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Departure {
    /// In this direction, in the lean frame.
    Toward(Vector3<f64>),
    /// Where the friction that held it gives way. It grows too weak by ever more, from nothing, so that the direction
    /// follows the motion from the start.
    GivingWay,
}

/// The part of the tolerances by which a step may err: the nutation of a top with a free peg grows by itself, and errors
/// with it.
const ERROR_SHARE: f64 = 0.02;

/// A relative error below this would be less than the rounding.
const ROUNDING: f64 = 1e-14;

/// A contact point that has begun to slip comes to rest, instead of beginning again, where friction could hold it with
/// this part of its strength left: far more than rounding, far less than it is ever left with for long.
const HELD_AGAIN: f64 = 1e-6;

const CONTROLLED: usize = 13;
const DISSIPATED: usize = 3;

/// A state taken apart, in the lean frame.
struct Parts {
    lean: Lean,
    tilt: Tilt,
    /// Velocity of the centre of mass, m/s.
    velocity: Vector3<f64>,
    arm: Arm,
    /// The velocity that the centre of mass would have if the peg rolled, m/s.
    rolling: Vector3<f64>,
}

impl Parts {
    /// Velocity of the contact point, m/s.
    #[inline(always)]
    fn contact_velocity(&self) -> Vector3<f64> {
        self.velocity - self.rolling
    }
}

impl FreeRotation {
    /// How many numbers of a state describe the motion; the running integrals come behind them.
    const VARIABLES: usize = CONTROLLED + DISSIPATED;
    /// The length of a state that carries all running integrals.
    pub const STATE_LENGTH: usize = Self::VARIABLES + INTEGRALS;
    /// The length of a state that carries only those which an outcome needs.
    pub const SHORT_STATE_LENGTH: usize = Self::VARIABLES + FEW_INTEGRALS;

    #[inline(always)]
    fn body(&self, tilt: Tilt) -> FreeBody<'_> {
        FreeBody::new(&self.model.top, &self.model.friction, &self.inertia, tilt)
    }

    #[inline(always)]
    fn parts<const N: usize>(&self, y: &[f64; N]) -> Parts {
        let top = &self.model.top;
        let lean = self.lean(y);
        let turning = lean.of_world(&vector(y, 4));
        let axial = lean.sin * turning.x + lean.cos * turning.z;
        let excess = axial * (self.inertia.transverse * self.inertia.per_axial - 1.0);
        let omega = turning + excess * Vector3::new(lean.sin, 0.0, lean.cos);
        let tilt = Tilt::from_omega(lean.sin, lean.cos, omega);
        let arm = Arm::of(top, lean.sin, lean.cos);
        let rolling = arm.cross(&tilt.omega_lean);
        let velocity = match self.phase {
            Phase::Flying => lean.of_world(&vector(y, 10)),
            Phase::Holding => rolling,
            Phase::Sliding => {
                let own = lean.of_world(&vector(y, 10));
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

    /// The lean. Friction turns a vertical axis that rests about the horizontal direction across the slip.
    #[inline(always)]
    fn lean<const N: usize>(&self, y: &[f64; N]) -> Lean {
        let top = &self.model.top;
        Lean::of(&quaternion(y), |cos| {
            let turning = vector(y, 4);
            if turning.x != 0.0 || turning.y != 0.0 || self.phase == Phase::Holding {
                turning
            } else {
                Arm::of(top, 0.0, cos).up * Vector3::new(y[11], -y[10], 0.0)
            }
        })
    }

    #[inline(always)]
    fn reaction(&self, parts: &Parts) -> Reaction {
        let body = self.body(parts.tilt);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let departure = self.departure_of(&parts.tilt, &slip);
        body.reaction(self.phase, &slip_of_law(&slip, departure.as_ref()))
    }

    /// The direction in which the contact point begins to slip, in the lean frame, while it has hardly begun. None where
    /// friction could hold it again: then it comes to rest.
    #[inline(always)]
    fn departure_of(&self, tilt: &Tilt, slip: &Vector3<f64>) -> Option<Vector3<f64>> {
        let departure = self.departure.filter(|_| is_departing(slip))?;
        let body = self.body(*tilt);
        let held = body.holding();
        let strongest = self.model.friction.law.static_bound(held.normal);
        if self.grip(&held) > HELD_AGAIN * strongest {
            return None;
        }
        Some(match departure {
            Departure::Toward(direction) => direction,
            Departure::GivingWay => body.giving_way(),
        })
    }

    /// What the running integrals, all or few, grow by per second, where the losses have this power, W.
    #[inline(always)]
    fn integrands(&self, parts: &Parts, reaction: &Reaction, losses: f64, all: bool) -> Integrals {
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
        // About the peg's centre, as for a fixed peg.
        let to_contact = Vector3::new(0.0, 0.0, -top.peg_radius);
        let friction =
            to_contact.cross(&reaction.friction.force) + reaction.friction.couple + reaction.air;
        let torque = tilt.lean_to_node(&friction);
        Integrals {
            theta: atan2(lean.sin, lean.cos),
            work_node: torque.component_mul(&tilt.omega_node()),
            slip_work,
            terms: TermIntegrals::of(&accelerations_about(top, &torque, tilt), tilt),
            ..few
        }
    }

    fn in_phase(&self, phase: Phase) -> Self {
        Self {
            phase,
            departure: None,
            ..*self
        }
    }

    /// The state with the components that don't count in this phase as they would be if they did.
    fn completed<const N: usize>(&self, y: &[f64; N]) -> [f64; N] {
        let parts = self.parts(y);
        let mut state = *y;
        put(&mut state, 10, &parts.lean.in_world(&parts.velocity));
        if self.phase != Phase::Flying {
            state[9] = -parts.arm.up;
        }
        state
    }

    /// How the motion goes on from a peg that has rolled and is held no longer.
    fn departing<const N: usize>(&self, y: &[f64; N]) -> Self {
        let parts = self.parts(y);
        let reaction = self.reaction(&parts);
        let sliding = Self {
            departure: Some(Departure::GivingWay),
            ..self.in_phase(Phase::Sliding)
        };
        if reaction.normal > 0.0 && sliding.reaction(&sliding.parts(y)).normal > 0.0 {
            sliding
        } else {
            self.in_phase(Phase::Flying)
        }
    }

    /// How the motion goes on from a peg on the table whose contact point slips, or is `at_rest`.
    fn on_table<const N: usize>(&self, y: &[f64; N], at_rest: bool) -> Self {
        let mut sliding = self.in_phase(Phase::Sliding);
        let parts = sliding.parts(y);
        if at_rest && self.model.friction.is_set_valued_at_rest() {
            let holding = self.in_phase(Phase::Holding);
            if holding.is_held(y) {
                return holding;
            }
            let body = self.body(parts.tilt);
            let accelerated = |direction: &_| body.slip_acceleration(&(NO_SLIP * direction));
            let Some(direction) = FreeBody::departure(accelerated) else {
                // Friction is too weak by rounding only.
                return holding.departing(y);
            };
            sliding.departure = Some(Departure::Toward(direction));
        }
        if sliding.reaction(&parts).normal > 0.0 {
            sliding
        } else {
            self.in_phase(Phase::Flying)
        }
    }

    /// Whether friction holds the contact point of a peg that rolls.
    fn is_held<const N: usize>(&self, y: &[f64; N]) -> bool {
        let reaction = self.reaction(&self.parts(y));
        reaction.normal > 0.0 && self.grip(&reaction) >= 0.0
    }

    /// How much stronger friction could be than it has to be to hold the contact point, N.
    fn grip(&self, reaction: &Reaction) -> f64 {
        let force = reaction.friction.force;
        self.model.friction.law.static_bound(reaction.normal) - hypot(force.x, force.y)
    }

    /// The state with the contact point brought to rest, and how long that takes, s.
    fn rested<const N: usize>(&self, y: &[f64; N]) -> ([f64; N], f64) {
        let parts = self.parts(y);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let body = self.body(parts.tilt);
        let slowing = -body.slip_acceleration(&slip).dot(&slip);
        let delay = slip.norm_squared() / slowing;
        let delay = if delay > 0.0 && delay < 1e-3 {
            delay
        } else {
            0.0
        };
        let slope = self.derivative(0.0, y);
        let state: [f64; N] = std::array::from_fn(|i| y[i] + delay * slope[i]);
        (self.in_phase(Phase::Holding).completed(&state), delay)
    }

    /// The state after an impact, and how the motion goes on.
    fn after_impact<const N: usize>(
        &self,
        y: &[f64; N],
    ) -> Result<(Self, [f64; N], Passage), IntegrateError> {
        let Support::FreePeg { restitution } = self.model.support else {
            return Ok((*self, *y, Passage::LiftsOff));
        };
        let parts = self.parts(y);
        let body = self.body(parts.tilt);
        let before = parts.contact_velocity();
        if before.z >= 0.0 {
            return Ok(self.after_touch(y, before));
        }
        let hit = impact(&body, before, restitution)?;
        let mut state = *y;
        let moment = parts.arm.cross(&hit.impulse) + hit.couple;
        let turned = parts.lean.in_world(&(moment * self.inertia.per_transverse));
        let pushed = parts.lean.in_world(&(hit.impulse * self.inertia.per_mass));
        for i in 0..3 {
            state[4 + i] += turned[i];
            state[10 + i] += pushed[i];
        }
        state[9] = -parts.arm.up;
        state[Self::VARIABLES] -= hit.normal_loss + hit.friction_loss;
        state[CONTROLLED] += hit.normal_loss;
        state[CONTROLLED + 1] += hit.friction_loss;
        let flying = self.in_phase(Phase::Flying);
        if hit.after.z > 0.0 {
            return Ok((flying, state, Passage::Bounces(hit)));
        }
        let next = self.on_table(&state, hit.is_held);
        let passage = if next.phase == Phase::Flying {
            Passage::Bounces(hit)
        } else {
            Passage::Lands(hit)
        };
        let landed = if hit.is_held {
            Phase::Holding
        } else {
            Phase::Sliding
        };
        Ok((next, self.in_phase(landed).completed(&state), passage))
    }

    /// The state after the peg has touched the table without approaching it, and how the motion goes on. Where it flies on,
    /// only an error of the dense output has touched the table, and nothing has happened.
    fn after_touch<const N: usize>(
        &self,
        y: &[f64; N],
        velocity: Vector3<f64>,
    ) -> (Self, [f64; N], Passage) {
        let next = if velocity.z > 0.0 {
            *self
        } else {
            self.on_table(y, false)
        };
        let passage = if next.phase == Phase::Flying {
            Passage::LiftsOff
        } else {
            Passage::Lands(Impact::without_approach(velocity))
        };
        let mut state = next.completed(y);
        state[9] = -self.parts(y).arm.up;
        (next, state, passage)
    }

    /// The longest that the first step in flight may be, s: about as long as the flight, if the peg falls back at once. A
    /// peg that lifts off has no speed at first, and hardly any height: less than a long step errs by.
    fn first_step<const N: usize>(&self, y: &[f64; N]) -> f64 {
        if self.phase != Phase::Flying {
            return f64::INFINITY;
        }
        let parts = self.parts(y);
        let rise = parts.contact_velocity().z;
        let body = self.body(parts.tilt);
        let fall = -body.flying_acceleration().z;
        if rise > 0.0 && fall > 0.0 {
            4.0 * rise / fall
        } else {
            FIRST_TURN / parts.tilt.omega_lean.norm()
        }
    }
}

impl<const N: usize> System<N> for FreeRotation {
    const CONTROLLED: usize = CONTROLLED;

    #[inline]
    fn derivative(&self, _t: f64, y: &[f64; N]) -> [f64; N] {
        let parts = self.parts(y);
        let Parts {
            lean,
            tilt,
            velocity,
            arm,
            ..
        } = &parts;
        let top = &self.model.top;
        let reaction = self.reaction(&parts);
        let torque = lean.in_world(&(reaction.torque(arm) * self.inertia.per_transverse));
        let turning = turning(&quaternion(y), &lean.in_world(&tilt.omega_lean));
        let moving = lean.in_world(velocity);
        let mut acceleration = lean.in_world(&(reaction.force() * self.inertia.per_mass));
        acceleration.z -= top.gravity;
        let (mut rise, mut fall) = (moving.z, acceleration.z);
        if self.phase != Phase::Flying {
            // What follows from the inclination is not integrated.
            (rise, fall) = (0.0, 0.0);
        }
        let losses = (reaction.friction.couple + reaction.air).dot(&tilt.omega_lean);
        let first: [f64; Self::VARIABLES] = [
            turning.i,
            turning.j,
            turning.k,
            turning.w,
            torque.x,
            torque.y,
            torque.z,
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

    fn start(model: &Model, start: &Start, _may_hold: bool) -> (Self, [f64; N], Option<Passage>) {
        let Start {
            angles,
            rates,
            peg_position,
            peg_velocity,
        } = *start;
        let top = &model.top;
        let q = world_from_body(angles);
        let tilt = Tilt::from_rates(angles.theta, rates);
        let central = top.about_center();
        let momentum = tilt.node_to_lean(&central.angular_momentum_node(&tilt));
        let turning = lean_to_world(&(momentum / central.transverse_moment), angles.phi);
        let axis = lean_to_world(&tilt.axis(), angles.phi);
        let omega = lean_to_world(&tilt.omega_lean, angles.phi);
        let center = peg_position + top.center_distance * axis;
        let velocity = peg_velocity + top.center_distance * omega.cross(&axis);
        let mut state = [0.0; N];
        state[..4].copy_from_slice(&[q.i, q.j, q.k, q.w]);
        put(&mut state, 4, &turning);
        put(&mut state, 7, &center);
        put(&mut state, 10, &velocity);
        let flying = Self {
            model: *model,
            phase: Phase::Flying,
            departure: None,
            inertia: Inertia::of(top),
            sliding_guards: sliding_guards(model),
        };
        if peg_position.z > top.peg_radius || peg_velocity.z != 0.0 {
            return (flying, state, None);
        }
        let slip = flying.parts(&state).contact_velocity();
        let at_rest = hypot(slip.x, slip.y) <= NO_SLIP;
        let formulation = flying.on_table(&state, at_rest);
        let passage = (formulation.phase == Phase::Holding).then_some(Passage::Rolls);
        (formulation, state, passage)
    }

    fn angles(&self, y: &[f64; N], reference: Euler) -> Euler {
        euler_angles(&quaternion(y), self.lean(y).reference(reference))
    }

    fn motion_without_turns(&self, y: &[f64; N], reference: Euler) -> Motion {
        let top = &self.model.top;
        let mut parts = self.parts(y);
        if parts.tilt.is_upright() {
            let torque = vector(&self.derivative(0.0, y), 4);
            parts.tilt = parts.lean.going_on(parts.tilt, &vector(y, 4), &torque);
        }
        let Parts {
            lean,
            tilt,
            velocity,
            arm,
            ..
        } = &parts;
        let to_peg = Vector3::new(arm.lean, 0.0, arm.up + top.peg_radius);
        let mut position = vector(y, 7) + lean.in_world(&to_peg);
        let mut velocity_lean = velocity + tilt.omega_lean.cross(&to_peg);
        if self.phase != Phase::Flying {
            position.z = top.peg_radius;
            velocity_lean.z = 0.0;
        }
        let slip = parts.contact_velocity();
        let slip = Vector3::new(slip.x, slip.y, 0.0);
        Motion {
            angles: Euler {
                theta: inclination(&quaternion(y)),
                ..reference
            },
            tilt: *tilt,
            peg: Peg {
                position,
                velocity_lean,
                departure: self.departure_of(tilt, &slip),
                dissipated: Dissipated {
                    impact_normal: y[CONTROLLED],
                    impact_friction: y[CONTROLLED + 1],
                    losses: y[CONTROLLED + 2],
                },
            },
            phase: self.phase,
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

    fn guards(&self) -> &'static [Guard] {
        let rolls = self.model.friction.rolling_arm() > 0.0;
        match self.phase {
            Phase::Flying => &[Guard::Gap],
            // Where the table would have to pull, friction could not hold the point either.
            Phase::Holding if rolls => &[Guard::Grip, Guard::Rolling],
            Phase::Holding => &[Guard::Grip],
            Phase::Sliding => self.sliding_guards,
        }
    }

    fn guard(&self, guard: Guard, motion: &Motion) -> f64 {
        let top = &self.model.top;
        let slip = motion.slip_velocity(top);
        let reaction = || {
            self.body(motion.tilt)
                .reaction(self.phase, &motion.law_slip(&slip))
        };
        match guard {
            // What friction can't hold slips, however slowly it begins.
            Guard::Slip if motion.peg.departure.is_some() => NO_SLIP,
            Guard::Slip => slip.norm() - NO_SLIP,
            Guard::Grip => self.grip(&reaction()),
            Guard::NormalForce => reaction().normal,
            Guard::Gap => motion.peg.position.z - top.peg_radius,
            Guard::Mobility => {
                let body = self.body(motion.tilt);
                body.mobility(&motion.law_slip(&slip)) - JAMMED
            }
            Guard::Rolling => {
                hypot(motion.tilt.omega_lean.x, motion.tilt.omega_lean.y) - NO_ROLLING
            }
            // These variables are regular everywhere.
            Guard::Regular => f64::NAN,
        }
    }

    fn enter(
        &self,
        guard: Guard,
        y: &[f64; N],
        reference: Euler,
    ) -> Result<Entry<Self, N>, IntegrateError> {
        let (mut delay, mut state) = (0.0, self.completed(y));
        let (formulation, passage) = match guard {
            Guard::Slip => {
                (state, delay) = self.rested(y);
                let next = self.on_table(&state, true);
                let passage = match next.phase {
                    Phase::Holding => Passage::Rolls,
                    Phase::Sliding => Passage::SlipStops,
                    Phase::Flying => Passage::LiftsOff,
                };
                (next, passage)
            }
            Guard::Grip => {
                let next = self.departing(&state);
                let passage = match next.phase {
                    Phase::Flying => Passage::LiftsOff,
                    Phase::Sliding | Phase::Holding => Passage::RollEnds,
                };
                (next, passage)
            }
            Guard::NormalForce => (self.in_phase(Phase::Flying), Passage::LiftsOff),
            Guard::Gap => {
                let (next, after, passage) = self.after_impact(&state)?;
                state = after;
                (next, passage)
            }
            Guard::Mobility => (*self, Passage::Jams),
            Guard::Rolling => (*self, Passage::Pivots),
            Guard::Regular => (*self, Passage::BecomesSingular),
        };
        Ok(Entry {
            formulation,
            state,
            delay,
            passage,
            motion: formulation.motion(&state, reference),
            first_step: formulation.first_step(&state),
        })
    }
}

/// What ends a phase of sliding.
fn sliding_guards(model: &Model) -> &'static [Guard] {
    use Guard::{Mobility, NormalForce, Rolling, Slip};
    let Model { top, friction, .. } = model;
    // No normal force can jam the peg if k (R + |l|) + δ < 2 √(A/M), whatever the inclination.
    let reach = top.peg_radius + top.center_distance.abs();
    let lever = friction.law.largest_coefficient() * reach + friction.rolling_arm();
    let jams = lever >= 2.0 * (top.central_moment() / top.mass).sqrt();
    let rolls = friction.rolling_arm() > 0.0;
    match (friction.is_set_valued_at_rest(), jams, rolls) {
        (true, false, false) => &[Slip, NormalForce],
        (true, false, true) => &[Slip, NormalForce, Rolling],
        (true, true, false) => &[Slip, NormalForce, Mobility],
        (true, true, true) => &[Slip, NormalForce, Mobility, Rolling],
        (false, false, false) => &[NormalForce],
        (false, false, true) => &[NormalForce, Rolling],
        (false, true, false) => &[NormalForce, Mobility],
        (false, true, true) => &[NormalForce, Mobility, Rolling],
    }
}

#[inline]
fn quaternion<const N: usize>(y: &[f64; N]) -> Quaternion<f64> {
    Quaternion::new(y[3], y[0], y[1], y[2])
}

/// How fast a quaternion changes, 1/s, while the body turns with `omega` (rad/s, world): half their product.
#[inline]
fn turning(q: &Quaternion<f64>, omega: &Vector3<f64>) -> Quaternion<f64> {
    let half = 0.5 * omega;
    Quaternion::new(
        -(half.x * q.i + half.y * q.j + half.z * q.k),
        half.x * q.w + half.y * q.k - half.z * q.j,
        half.y * q.w + half.z * q.i - half.x * q.k,
        half.z * q.w + half.x * q.j - half.y * q.i,
    )
}

#[inline]
fn vector<const N: usize>(y: &[f64; N], at: usize) -> Vector3<f64> {
    Vector3::new(y[at], y[at + 1], y[at + 2])
}

fn put<const N: usize>(y: &mut [f64; N], at: usize, v: &Vector3<f64>) {
    y[at..at + 3].copy_from_slice(v.as_slice());
}
