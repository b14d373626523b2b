//! Impacts of a free peg on the table.
//!
//! During an impact, only velocities change. The slip evolves with the normal impulse (J.-G. Darboux, Bull. Sci. Math.
//! 4 (1880) 126; J. B. Keller, J. Appl. Mech. 53 (1986) 1): friction is proportional to the normal impulse and opposes
//! the current slip, which may stop, change direction and restart. Compression ends when the approach velocity is zero;
//! restitution ends when its work is `e²` times the work of compression (W. J. Stronge, Proc. R. Soc. Lond. A 431
//! (1990) 169). No impact gains energy.

use super::departure::departure;
use super::reaction::FreeBody;
use crate::physics::friction::Wrench;
use crate::physics::integrate::{
    Crossing, Dense, Dop853, IntegrateError, KNOTS, SignTracker, Slope, System, Tolerances,
};
use crate::physics::math::hypot;
use nalgebra::Vector3;

/// Minimum approach speed of a bounce, m/s. Ends sequences of ever smaller bounces.
const MIN_BOUNCE_SPEED: f64 = 1e-6;

/// If a bounce reduces the speed by less than this fraction, the minimum speed is increased.
const MIN_LOSS: f64 = 0.01;
/// Upper limit of that increase, m/s.
const MAX_MIN_BOUNCE_SPEED: f64 = 1e-4;

/// Minimum approach speed of a bounce for this coefficient of restitution, m/s.
fn min_bounce_speed(restitution: f64) -> f64 {
    let speed = MIN_BOUNCE_SPEED * MIN_LOSS / (1.0 - restitution);
    speed.clamp(MIN_BOUNCE_SPEED, MAX_MIN_BOUNCE_SPEED)
}

/// Rolling resistance and drilling friction are made proportional to their rates below the rates that they would stop in
/// this fraction of an impact, because a discontinuity can't be integrated.
const CREEP_SHARE: f64 = 1e-3;

/// Slip below this fraction of the impact speed counts as stopped; the rest is removed along a straight line, with a
/// quadratic error.
const SLIP_STOPPED: f64 = 1e-12;

/// Maximum number of steps per impact; exceeded only if the friction law is too steep.
const MAX_STEPS: u32 = 20_000;

/// Result of an impact. Vectors are in the lean frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Impact {
    /// Impulse of the table, N s.
    pub impulse: Vector3<f64>,
    /// Angular impulse of the contact couples, N m s.
    pub couple: Vector3<f64>,
    /// Velocity of the contact point before, m/s.
    pub before: Vector3<f64>,
    /// Velocity of the contact point after, m/s.
    pub after: Vector3<f64>,
    /// The effective coefficient of restitution; 0 if the approach is too slow for a bounce.
    pub restitution: f64,
    /// Energy lost by compression and restitution, J.
    pub normal_loss: f64,
    /// Energy lost by friction, J.
    pub friction_loss: f64,
    /// Whether the contact point no longer slips at the end.
    pub is_held: bool,
}

impl Impact {
    /// A contact without approach velocity.
    pub(super) fn without_approach(velocity: Vector3<f64>) -> Self {
        Self {
            before: velocity,
            after: velocity,
            ..Self::default()
        }
    }
}

/// State: impulses, moments, work of the normal force and energy lost by friction, scaled by the impact speed.
const SIZE: usize = 8;
/// Number of components needed for guards (all but the energy lost by friction).
const GUARD_INPUTS: usize = 7;
type ImpactVector = [f64; SIZE];

#[derive(Clone, Copy, Debug, PartialEq)]
enum ImpactStage {
    /// Slipping; with the direction if the slip has just begun.
    Slipping(Option<Vector3<f64>>),
    /// The contact point is held.
    Held,
}

#[derive(Clone, Copy)]
struct ImpactEquations<'a> {
    body: &'a FreeBody<'a>,
    before: Vector3<f64>,
    /// Approach speed before the impact, m/s; the velocity scale.
    speed: f64,
    /// Rolling resistance is reduced below this rolling rate, rad/s.
    creep: f64,
    /// Drilling friction is reduced below this rate about the vertical, rad/s.
    turning_creep: f64,
    stage: ImpactStage,
}

/// State of the impact.
struct ImpactState {
    impulse: Vector3<f64>,
    couple: Vector3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
}

impl ImpactEquations<'_> {
    #[inline]
    fn impact_state(&self, y: &ImpactVector) -> ImpactState {
        let top = self.body.top;
        let unit = top.mass * self.speed;
        let impulse = unit * Vector3::new(y[0], y[1], y[2]);
        let couple = unit * top.peg_radius * Vector3::new(y[3], y[4], y[5]);
        let turned = self
            .body
            .angular_acceleration(&(self.body.arm.cross(&impulse) + couple));
        ImpactState {
            impulse,
            couple,
            velocity: self.before
                + self.body.inverse_mass.velocity_change(&impulse)
                + self.body.acceleration_per_couple(&couple),
            omega: self.body.tilt.omega_lean + turned,
        }
    }

    /// Friction per normal impulse for a slip velocity (m/s) and an angular velocity (rad/s).
    #[inline]
    fn per_impulse(&self, slip: &Vector3<f64>, omega: &Vector3<f64>) -> Wrench {
        let mut wrench = self.body.friction.per_normal_force(slip, omega);
        let rate = hypot(omega.x, omega.y);
        if rate < self.creep {
            wrench.couple.x *= rate / self.creep;
            wrench.couple.y *= rate / self.creep;
        }
        if omega.z.abs() < self.turning_creep {
            wrench.couple.z *= omega.z.abs() / self.turning_creep;
        }
        wrench
    }

    #[inline]
    fn slip(velocity: &Vector3<f64>) -> Vector3<f64> {
        Vector3::new(velocity.x, velocity.y, 0.0)
    }

    /// Friction per newton second of normal impulse, and the factor by which the independent variable is slowed near
    /// zero slip.
    #[inline]
    fn friction(&self, now: &ImpactState) -> (Wrench, f64) {
        let slip = Self::slip(&now.velocity);
        let friction = self.body.friction;
        match self.stage {
            ImpactStage::Held => (self.holding(now), 1.0),
            ImpactStage::Slipping(start) => {
                let speed = slip.norm();
                let resolution = SLIP_STOPPED * self.scale();
                let (slip, speed) = match start {
                    Some(direction) if speed < resolution => (resolution * direction, resolution),
                    _ => (slip, speed),
                };
                // Near the end of slip its direction changes ever faster.
                let pace = if friction.is_set_valued_at_rest() {
                    speed / (speed + self.speed)
                } else {
                    1.0
                };
                (self.per_impulse(&slip, &now.omega), pace)
            }
        }
    }

    /// The velocity scale of this impact, m/s.
    fn scale(&self) -> f64 {
        self.speed + hypot(self.before.x, self.before.y)
    }

    /// The friction that keeps the contact point at rest, per newton second of normal impulse.
    fn holding(&self, now: &ImpactState) -> Wrench {
        let couple = self.per_impulse(&Vector3::zeros(), &now.omega).couple;
        let by_couple = self.body.acceleration_per_couple(&couple);
        let inverse_mass = &self.body.inverse_mass;
        Wrench {
            force: Vector3::new(
                -(inverse_mass.coupling + by_couple.x) / inverse_mass.lean,
                -by_couple.y / inverse_mass.node,
                0.0,
            ),
            couple,
        }
    }

    /// The phase after the contact point has stopped slipping.
    fn stopped(&self, y: &ImpactVector) -> ImpactStage {
        let now = self.impact_state(y);
        let bound = self.body.friction.law.static_bound(1.0);
        if self.holding(&now).force.norm() <= bound {
            return ImpactStage::Held;
        }
        let slowly = SLIP_STOPPED * self.scale();
        match departure(|direction| {
            let friction = self.per_impulse(&(slowly * direction), &now.omega);
            self.body.acceleration_per_normal_force(&friction)
        }) {
            Some(direction) => ImpactStage::Slipping(Some(direction)),
            None => ImpactStage::Held,
        }
    }
}

impl System<SIZE> for ImpactEquations<'_> {
    const CONTROLLED: usize = 6;

    fn derivative(&self, _: f64, y: &ImpactVector) -> ImpactVector {
        let now = self.impact_state(y);
        let (friction, pace) = self.friction(&now);
        let Wrench { force, couple } = friction;
        let radius = self.body.top.peg_radius;
        let power = force.dot(&now.velocity) + couple.dot(&now.omega);
        [
            pace * force.x,
            pace * force.y,
            pace,
            pace * couple.x / radius,
            pace * couple.y / radius,
            pace * couple.z / radius,
            pace * now.velocity.z / self.speed,
            -pace * power / self.speed,
        ]
    }
}

/// Events of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum ImpactEvent {
    Compressed,
    Restituted,
    SlipStopped,
}

/// An impact of a body whose contact point has the velocity `before` (m/s, lean frame), downward.
///
/// # Errors
/// If the friction law is too steep.
pub(super) fn impact(
    body: &FreeBody<'_>,
    before: Vector3<f64>,
    restitution: f64,
) -> Result<Impact, IntegrateError> {
    let mut collision = Collision::new(body, before, restitution)?;
    for _ in 0..MAX_STEPS {
        if let Some(end) = collision.step()? {
            return Ok(end);
        }
    }
    let t = collision.integrator.t();
    Err(IntegrateError::StepSizeUnderflow { t, step: 0.0 })
}

struct Collision<'a> {
    integrator: Dop853<ImpactEquations<'a>, SIZE>,
    restitution: f64,
    /// The (negative) work of compression, once it has ended.
    compression: Option<f64>,
    watches: Vec<(ImpactEvent, SignTracker)>,
}

impl<'a> Collision<'a> {
    fn new(
        body: &'a FreeBody<'a>,
        before: Vector3<f64>,
        restitution: f64,
    ) -> Result<Self, IntegrateError> {
        let speed = -before.z;
        let per_arm = CREEP_SHARE * body.top.mass * speed / body.top.least_moment();
        let mut equations = ImpactEquations {
            body,
            before,
            speed,
            creep: per_arm * body.friction.rolling_arm(),
            turning_creep: per_arm * body.friction.drilling_bound(1.0, false),
            stage: ImpactStage::Slipping(None),
        };
        let start = [0.0; SIZE];
        if hypot(before.x, before.y) <= SLIP_STOPPED * equations.scale()
            && body.friction.is_set_valued_at_rest()
        {
            equations.stage = equations.stopped(&start);
        }
        let tolerances = Tolerances {
            relative: 1e-14,
            absolute: 1e-15,
        };
        let mut collision = Self {
            integrator: Dop853::new(equations, 0.0, start, tolerances)?,
            restitution: if speed < min_bounce_speed(restitution) {
                0.0
            } else {
                restitution
            },
            compression: None,
            watches: Vec::new(),
        };
        collision.watch();
        Ok(collision)
    }

    /// Selects the guards to watch.
    fn watch(&mut self) {
        let equations = self.integrator.system();
        let normal = match self.compression {
            Some(_) => ImpactEvent::Restituted,
            None => ImpactEvent::Compressed,
        };
        self.watches = vec![(normal, SignTracker::with_sign(false, 0.0))];
        if equations.stage != ImpactStage::Held && equations.body.friction.is_set_valued_at_rest() {
            self.watches
                .push((ImpactEvent::SlipStopped, SignTracker::default()));
        }
    }

    /// The value of the watched function of an event.
    #[inline]
    fn event_value(&self, event: ImpactEvent, y: &ImpactVector) -> f64 {
        let equations = self.integrator.system();
        match event {
            ImpactEvent::Compressed => equations.impact_state(y).velocity.z / equations.speed,
            ImpactEvent::Restituted => {
                let restitution_squared = self.restitution * self.restitution;
                y[6] - self.compression.unwrap_or_default() * (1.0 - restitution_squared)
            }
            ImpactEvent::SlipStopped => {
                let slip = ImpactEquations::slip(&equations.impact_state(y).velocity);
                slip.norm() / equations.scale() - SLIP_STOPPED
            }
        }
    }

    /// Takes a step. Returns the impact if it ends in this step.
    fn step(&mut self) -> Result<Option<Impact>, IntegrateError> {
        self.integrator.step_densely()?;
        let dense = self.integrator.dense();
        let Some((s, event)) = self.first_event(&dense) else {
            return Ok(None);
        };
        let (t, y) = (dense.t0 + s * dense.h, dense.at(s));
        match event {
            ImpactEvent::Compressed => {
                self.compression = Some(y[6]);
                if self.restitution == 0.0 {
                    return Ok(Some(self.end(&y)));
                }
                let equations = *self.integrator.system();
                self.restart(equations, t, y)?;
            }
            ImpactEvent::Restituted => return Ok(Some(self.end(&y))),
            ImpactEvent::SlipStopped => {
                let y = self.extrapolate_to_zero_slip(t, y);
                let mut equations = *self.integrator.system();
                equations.stage = equations.stopped(&y);
                self.restart(equations, t, y)?;
            }
        }
        Ok(None)
    }

    fn restart(
        &mut self,
        equations: ImpactEquations<'a>,
        t: f64,
        y: ImpactVector,
    ) -> Result<(), IntegrateError> {
        self.integrator.restart(equations, t, y)?;
        self.watch();
        Ok(())
    }

    /// Extrapolates linearly to zero slip.
    fn extrapolate_to_zero_slip(&self, t: f64, y: ImpactVector) -> ImpactVector {
        let equations = self.integrator.system();
        let slope = equations.derivative(t, &y);
        let slip = ImpactEquations::slip(&equations.impact_state(&y).velocity);
        let ahead: ImpactVector = std::array::from_fn(|i| y[i] + slope[i]);
        let change = ImpactEquations::slip(&equations.impact_state(&ahead).velocity) - slip;
        let span = slip.norm_squared() / -change.dot(&slip);
        if span > 0.0 && span.is_finite() {
            std::array::from_fn(|i| y[i] + span * slope[i])
        } else {
            y
        }
    }

    fn first_event(&mut self, dense: &Dense<SIZE>) -> Option<(f64, ImpactEvent)> {
        let mut watches = std::mem::take(&mut self.watches);
        let at_knots = KNOTS.map(|s| dense.first_at(GUARD_INPUTS, s));
        let mut first: Option<(f64, ImpactEvent)> = None;
        for (event, tracker) in &mut watches {
            let values = at_knots.each_ref().map(|y| self.event_value(*event, y));
            let wanted = match event {
                ImpactEvent::SlipStopped => Slope::Falling,
                ImpactEvent::Compressed | ImpactEvent::Restituted => Slope::Rising,
            };
            let mut found: Vec<Crossing> = Vec::new();
            tracker.scan(
                &values,
                |s| self.event_value(*event, &dense.first_at(GUARD_INPUTS, s)),
                &mut found,
            );
            let crossing = found.iter().find(|crossing| crossing.slope == wanted);
            if let Some(crossing) = crossing
                && first.is_none_or(|(s, _)| crossing.s < s)
            {
                first = Some((crossing.s, *event));
            }
        }
        self.watches = watches;
        first
    }

    fn end(&self, y: &ImpactVector) -> Impact {
        let equations = self.integrator.system();
        let now = equations.impact_state(y);
        let unit = equations.body.top.mass * equations.speed * equations.speed;
        let is_held = equations.stage == ImpactStage::Held;
        let mut after = now.velocity;
        if self.restitution == 0.0 {
            after.z = 0.0;
        }
        if is_held {
            (after.x, after.y) = (0.0, 0.0);
        }
        // Stronge: restitution returns e² of the work of compression.
        let lost_share = 1.0 - self.restitution * self.restitution;
        Impact {
            impulse: now.impulse,
            couple: now.couple,
            before: equations.before,
            after,
            restitution: self.restitution,
            normal_loss: -unit * lost_share * self.compression.unwrap_or_default(),
            friction_loss: unit * y[7],
            is_held,
        }
    }
}
