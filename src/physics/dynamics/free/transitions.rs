//! Transitions of a free peg between rolling, sliding and flight.

use super::state::{CENTER, CONTROLLED, Departure, FreeRotation, SCALED_MOMENTUM, VELOCITY};
use crate::physics::dynamics::departure::departure;
use crate::physics::dynamics::formulation::Transition;
use crate::physics::dynamics::holding::Resting;
use crate::physics::dynamics::impact::{Impact, impact};
use crate::physics::dynamics::motion::{DEPARTING, NO_SLIP};
use crate::physics::dynamics::reaction::Reaction;
use crate::physics::dynamics::support::{Phase, Support};
use crate::physics::friction::{Branch, Rocking, Turning};
use crate::physics::integrate::{IntegrateError, System as _};
use crate::physics::math::hypot;
use nalgebra::Vector3;

/// Maximum rotation in the first step after lift-off, rad; in such a short step the dense output is exact up to
/// rounding.
const FIRST_TURN: f64 = 0.01;

/// A peg jams when its mobility (see [`Guard::Mobility`](super::Guard::Mobility)) falls to this value; the normal force is
/// then a million times the frictionless one.
pub(super) const JAMMED: f64 = 1e-6;

/// Where the equations can't be integrated further, a jam is the reason if it is this near, s: the resolution of times in
/// recordings.
pub(super) const JAM_HORIZON: f64 = 1e-9;

/// Part of the time in which the slip would stop, for the rate at which its direction changes.
const PROBED_PART: f64 = 1e-4;

/// The beginning of a phase after a flying peg has come down to the table.
pub(super) struct Landing<const N: usize> {
    pub(super) formulation: FreeRotation,
    pub(super) state: [f64; N],
    pub(super) transition: Transition,
    /// The impact; none if the peg flies on.
    pub(super) impact: Option<Impact>,
}

impl FreeRotation {
    /// The next phase after friction releases a rolling peg: sliding or flight.
    pub(super) fn after_release<const N: usize>(&self, y: &[f64; N]) -> Self {
        let parts = self.parts(y);
        let reaction = self.reaction(&parts);
        let sliding = Self {
            departure: Some(Departure::Breakaway),
            ..self.slipping()
        };
        if reaction.normal > 0.0 {
            sliding.slides_or_flies(y)
        } else {
            self.with_phase(Phase::Flying)
        }
    }

    /// These equations of sliding, or those of flight if the table would have to pull the peg.
    ///
    /// A peg that [jams](Self::is_jammed) can do neither, and keeps the equations of sliding.
    fn slides_or_flies<const N: usize>(&self, y: &[f64; N]) -> Self {
        let flying = self.with_phase(Phase::Flying);
        let slides = if self.is_jamming(y) {
            // A normal force that pulls the peg into the table is positive where the peg would rise without it. The peg
            // then rises, because the smallest disturbance of that force grows.
            self.body(self.parts(y).tilt).flying_acceleration().z < 0.0
        } else {
            self.reaction(&self.parts(y)).normal > 0.0
        };
        if slides { self.clone() } else { flying }
    }

    /// Whether friction that slides turns every normal force into one that pulls the peg into the table.
    fn is_jamming<const N: usize>(&self, y: &[f64; N]) -> bool {
        let parts = self.parts(y);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let departing = self.departing(&parts.tilt, &slip);
        let body = self.body(parts.tilt).departing(departing.as_ref());
        body.mobility(&departing.map_or(slip, |departing| departing.slip)) <= JAMMED
    }

    /// Whether a peg that has begun to slide is jammed: it presses on the table, and no normal force can keep it out.
    pub(super) fn is_jammed<const N: usize>(&self, y: &[f64; N]) -> bool {
        self.phase == Phase::Sliding && self.is_jamming(y)
    }

    /// The phase of a peg on the table whose contact point slips or is `at_rest`.
    pub(super) fn on_table<const N: usize>(&self, y: &[f64; N], at_rest: bool) -> Self {
        self.settled(y, self.resting(y, at_rest))
    }

    /// The phase of a peg on the table some components of whose motion are at rest: friction holds each, or it begins
    /// to move.
    pub(super) fn settled<const N: usize>(&self, y: &[f64; N], resting: Resting) -> Self {
        let rate = self.parts(y).tilt.omega_lean.z;
        let turning = if self.model.friction.drilling_bound(1.0, false) > 0.0 {
            Turning::from_rate(rate)
        } else {
            Turning::Any
        };
        let moving = Branch {
            turning,
            rocking: Rocking::Any,
        };
        let sliding = self.with_branch(Phase::Sliding, moving);
        let rests_as_a_whole = resting.slip && self.model.friction.rests_as_a_whole();
        if rests_as_a_whole && resting.rocking {
            sliding.released_patch(y)
        } else if resting.rocking || (resting.turning && !rests_as_a_whole) {
            sliding.released(y, resting)
        } else {
            sliding.released_slip(y, resting.slip)
        }
    }

    /// The phase after components that include a rotation have come to rest.
    fn released<const N: usize>(&self, y: &[f64; N], resting: Resting) -> Self {
        let parts = self.parts(y);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let release = self.body(parts.tilt).released(resting, &slip);
        if release.normal <= 0.0 {
            // Without a load, friction holds nothing.
            return self.slides_or_flies(y);
        }
        let branch = self.model.friction.branch;
        let branch = Branch {
            turning: match release.turning {
                Some(acceleration) => Turning::from_rate(acceleration),
                None if resting.turning => Turning::Held,
                None => branch.turning,
            },
            rocking: match release.rocking {
                Some(direction) => Rocking::Starting(direction),
                None if resting.rocking => Rocking::Held,
                None => branch.rocking,
            },
        };
        if resting.slip && release.slip.is_none() {
            return self.with_branch(Phase::Sticking, branch);
        }
        Self {
            departure: release.slip.map(Departure::Toward),
            ..self.with_branch(Phase::Sliding, branch)
        }
    }

    /// The phase after a contact patch that rests as a whole, and rocking, have come to rest.
    fn released_patch<const N: usize>(&self, y: &[f64; N]) -> Self {
        let all = Resting {
            slip: true,
            rocking: true,
            turning: true,
        };
        let next = self.released(y, all);
        // The bounds of force and torque together are narrower than each alone.
        if next.phase != Phase::Sticking || next.is_held(y) {
            return next;
        }
        let rocking = Resting {
            rocking: true,
            ..Resting::default()
        };
        Self {
            departure: Some(Departure::Breakaway),
            ..self.released(y, rocking)
        }
    }

    /// The phase of a peg whose contact point slips or is `at_rest`, on the branches of these equations.
    fn released_slip<const N: usize>(&self, y: &[f64; N], at_rest: bool) -> Self {
        let mut sliding = self.with_phase(Phase::Sliding);
        let parts = sliding.parts(y);
        if at_rest {
            let holding = self.holding();
            if holding.is_held(y) {
                return holding;
            }
            let body = self.body(parts.tilt);
            let Some(direction) =
                departure(|direction| body.slip_acceleration(&(DEPARTING * direction)))
            else {
                // Friction is only too weak because of rounding.
                return holding.after_release(y);
            };
            sliding.departure = Some(Departure::Toward(direction));
        }
        sliding.slides_or_flies(y)
    }

    /// The phase after rolling resistance has given way to the torque that held the top.
    pub(super) fn rocking_again(&self) -> Self {
        let branch = Branch {
            rocking: Rocking::Breakaway,
            ..self.model.friction.branch
        };
        self.with_branch(self.phase, branch)
    }

    /// The phase after drilling friction has given way to the torque that held the top.
    pub(super) fn turning_again<const N: usize>(&self, y: &[f64; N]) -> Self {
        let couple = self.reaction(&self.parts(y)).friction.couple;
        let branch = Branch {
            turning: Turning::from_rate(-couple.z),
            ..self.model.friction.branch
        };
        self.with_branch(self.phase, branch)
    }

    /// Whether the contact point neither slips nor begins to. Friction need not hold it: a frictionless one may be at rest.
    fn has_contact_at_rest<const N: usize>(&self, y: &[f64; N]) -> bool {
        let slip = self.parts(y).contact_velocity();
        match self.phase {
            Phase::Sticking => true,
            Phase::Sliding => self.departure.is_none() && hypot(slip.x, slip.y) <= NO_SLIP,
            Phase::Flying => false,
        }
    }

    /// Whether the whole top no longer moves, not only its contact point: friction holds it, or it stands upright without
    /// motion and needs no holding.
    pub(super) fn is_motionless<const N: usize>(&self, y: &[f64; N]) -> bool {
        if !self.has_contact_at_rest(y) {
            return false;
        }
        if self.held().rocking {
            // Only turning about the vertical is left.
            return self.parts(y).tilt.omega_lean.z == 0.0;
        }
        self.derivative(0.0, y)[..CONTROLLED]
            .iter()
            .all(|rate| *rate == 0.0)
    }

    /// The time until the peg jams, s; `None` if it slips freely, or the mobility doesn't decrease.
    ///
    /// Where a slow slip turns its direction, the mobility `D` vanishes although the inclination hardly changes. The normal
    /// force, and with it the rate of that turn, is proportional to `1/D`. So `D` vanishes as `√(t₁ − t)`, and
    /// `t₁ − t = −D/2Ḋ`. The slower the slip, the later it reaches [`JAMMED`]: at last too late for a step to resolve it.
    pub(super) fn time_to_jam<const N: usize>(&self, y: &[f64; N]) -> Option<f64> {
        if self.phase != Phase::Sliding {
            return None;
        }
        let parts = self.parts(y);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let body = self.body(parts.tilt);
        let acceleration = body.slip_acceleration(&slip);
        let (speed, strength) = (slip.norm(), hypot(acceleration.x, acceleration.y));
        if speed == 0.0 || strength == 0.0 {
            return None;
        }
        let interval = PROBED_PART * speed / strength;
        let later = slip + interval * Vector3::new(acceleration.x, acceleration.y, 0.0);
        let mobility = body.mobility(&slip);
        let rate = (body.mobility(&later) - mobility) / interval;
        (mobility > 0.0 && rate < 0.0).then(|| -0.5 * mobility / rate)
    }

    /// The transition to a phase in which the top doesn't rock: it rests or pivots. `None` if it rocks.
    pub(super) fn stopping<const N: usize>(&self, y: &[f64; N]) -> Option<Transition> {
        (self.held().rocking || self.is_motionless(y)).then(|| self.pivoting(y))
    }

    /// The transition to a phase in which friction holds a top that doesn't rock.
    pub(super) fn pivoting<const N: usize>(&self, y: &[f64; N]) -> Transition {
        if self.is_motionless(y) {
            Transition::Rests
        } else if !self.has_contact_at_rest(y) {
            Transition::RockingStops
        } else {
            Transition::Pivots {
                is_final: self.phase == Phase::Sticking
                    && !self.model.friction.turns_about_vertical(),
            }
        }
    }

    /// Whether friction holds the contact point of a peg that rolls.
    pub(super) fn is_held<const N: usize>(&self, y: &[f64; N]) -> bool {
        let reaction = self.reaction(&self.parts(y));
        reaction.normal > 0.0 && self.grip(&reaction) >= 0.0
    }

    /// Margin of the friction that holds the contact point, N.
    pub(super) fn grip(&self, reaction: &Reaction) -> f64 {
        let (force, couple) = (reaction.friction.force, reaction.friction.couple);
        let law = &self.model.friction.law;
        law.holding_margin(reaction.normal, hypot(force.x, force.y), couple.z)
    }

    /// The state after the contact point comes to rest, and the time needed, s.
    pub(super) fn at_rest<const N: usize>(&self, y: &[f64; N]) -> ([f64; N], f64) {
        let parts = self.parts(y);
        let velocity = parts.contact_velocity();
        let slip = Vector3::new(velocity.x, velocity.y, 0.0);
        let body = self.body(parts.tilt);
        let slowing = -body.slip_acceleration(&slip).dot(&slip);
        let delay = slip.norm_squared() / slowing;
        // A slip that grows, or hardly slows down, does not come to rest in this way.
        let delay = if delay > 0.0 && delay < 1e-3 {
            delay
        } else {
            0.0
        };
        // The slip is 1e-9 m/s, so this is normally less than a nanosecond: one Euler step suffices.
        let slope = self.derivative(0.0, y);
        let state: [f64; N] = std::array::from_fn(|i| y[i] + delay * slope[i]);
        (self.with_phase(Phase::Sticking).completed(&state), delay)
    }

    /// The next phase after a flying peg has come down to the table.
    pub(super) fn after_contact<const N: usize>(
        &self,
        y: &[f64; N],
    ) -> Result<Landing<N>, IntegrateError> {
        let Support::FreePeg { restitution } = self.model.support else {
            // A fixed peg has other equations.
            return Ok(Landing {
                formulation: self.clone(),
                state: *y,
                transition: Transition::LiftsOff,
                impact: None,
            });
        };
        let parts = self.parts(y);
        let body = self.body(parts.tilt);
        let before = parts.contact_velocity();
        if before.z >= 0.0 {
            return Ok(self.after_grazing_contact(y, before));
        }
        let hit = impact(&body, before, restitution)?;
        let mut state = *y;
        // Positions don't change in an impact; momentum and velocity jump.
        let moment = parts.arm.cross(&hit.impulse) + hit.couple;
        let turned = parts
            .lean
            .lean_to_world(&(moment * self.inertia.per_transverse));
        let pushed = parts
            .lean
            .lean_to_world(&(hit.impulse * self.inertia.per_mass));
        for i in 0..3 {
            state[SCALED_MOMENTUM + i] += turned[i];
            state[VELOCITY + i] += pushed[i];
        }
        state[CENTER + 2] = -parts.arm.up;
        // The work of friction and impacts is the first integral.
        state[Self::VARIABLES] -= hit.normal_loss + hit.friction_loss;
        state[CONTROLLED] += hit.normal_loss;
        state[CONTROLLED + 1] += hit.friction_loss;
        let flying = self.with_phase(Phase::Flying);
        if hit.after.z > 0.0 {
            return Ok(Landing {
                formulation: flying,
                state,
                transition: Transition::Bounces,
                impact: Some(hit),
            });
        }
        // The peg stays down, unless the table would have to pull it.
        let next = self.on_table(&state, hit.is_held);
        // The state is completed for the impact's own result: the next phase may be flight.
        let landed = if hit.is_held {
            Phase::Sticking
        } else {
            Phase::Sliding
        };
        let state = self.with_phase(landed).completed(&state);
        let transition = if next.phase == Phase::Flying {
            Transition::Bounces
        } else {
            next.landing(&state)
        };
        Ok(Landing {
            formulation: next,
            state,
            transition,
            impact: Some(hit),
        })
    }

    /// The transition to a phase on the table.
    fn landing<const N: usize>(&self, y: &[f64; N]) -> Transition {
        self.stopping(y).unwrap_or(Transition::Lands)
    }

    /// The beginning of the next phase after a contact without approach velocity: on the table, or in flight again if the
    /// contact was an error of the dense output.
    fn after_grazing_contact<const N: usize>(
        &self,
        y: &[f64; N],
        velocity: Vector3<f64>,
    ) -> Landing<N> {
        let next = if velocity.z > 0.0 {
            self.clone()
        } else {
            self.on_table(y, false)
        };
        let mut state = next.completed(y);
        state[CENTER + 2] = -self.parts(y).arm.up;
        let (transition, impact) = if next.phase == Phase::Flying {
            (Transition::LiftsOff, None)
        } else {
            let impact = Impact::without_approach(velocity);
            (next.landing(&state), Some(impact))
        };
        Landing {
            formulation: next,
            state,
            transition,
            impact,
        }
    }

    /// Maximum length of the first step in flight, s: about the duration of the shortest flight. A long step's error
    /// would exceed the initial height of the peg.
    pub(super) fn first_step<const N: usize>(&self, y: &[f64; N]) -> f64 {
        if self.phase != Phase::Flying {
            return f64::INFINITY;
        }
        let parts = self.parts(y);
        let rise = parts.contact_velocity().z;
        let body = self.body(parts.tilt);
        let fall = -body.flying_acceleration().z;
        // The flight of a point that is thrown up takes twice the time of its rise.
        if rise > 0.0 && fall > 0.0 {
            4.0 * rise / fall
        } else {
            FIRST_TURN / parts.tilt.omega_lean.norm()
        }
    }
}
