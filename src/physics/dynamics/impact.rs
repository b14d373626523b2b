//! Impacts of a free peg on the table.
//!
//! During an impact, only velocities change. The slip evolves with the normal impulse (J.-G. Darboux, Bull. Sci. Math.
//! 4 (1880) 126; J. B. Keller, J. Appl. Mech. 53 (1986) 1): friction is proportional to the normal impulse and opposes
//! the current slip, which may stop, change direction and restart. Compression ends when the approach velocity is zero;
//! restitution ends when its work is `e²` times the work of compression (W. J. Stronge, Proc. R. Soc. Lond. A 431
//! (1990) 169). No impact gains energy.

use super::reaction::FreeBody;
use crate::physics::friction::Wrench;
use crate::physics::integrate::{
    Crossing, Dense, Direction, Dop853, IntegrateError, KNOTS, SignTracker, Slope, System,
    Tolerances,
};
use crate::physics::math::hypot;
use nalgebra::Vector3;

/// Minimum approach speed of a bounce, m/s. Ends sequences of ever smaller bounces.
const SLOWEST_BOUNCE: f64 = 1e-6;

/// If a bounce reduces the speed by less than this fraction, the minimum speed is increased.
const LEAST_LOSS: f64 = 0.01;
/// Upper limit of that increase, m/s.
const SLOWEST_ELASTIC_BOUNCE: f64 = 1e-4;

/// Minimum approach speed of a bounce for this coefficient of restitution, m/s.
fn slowest_bounce(restitution: f64) -> f64 {
    let loss = 1.0 - restitution;
    if loss >= LEAST_LOSS {
        SLOWEST_BOUNCE
    } else if loss * SLOWEST_ELASTIC_BOUNCE > LEAST_LOSS * SLOWEST_BOUNCE {
        SLOWEST_BOUNCE * LEAST_LOSS / loss
    } else {
        SLOWEST_ELASTIC_BOUNCE
    }
}

/// Rolling resistance is made proportional to the rolling rate below the rate that it would stop in this fraction of an
/// impact, because a discontinuity can't be integrated.
const CREEP_SHARE: f64 = 1e-3;

/// Slip below this fraction of the impact speed counts as stopped; the rest is removed along a straight line, with a
/// quadratic error.
const SLIP_STOPPED: f64 = 1e-12;

/// Maximum number of steps per impact; exceeded only if the friction law is too steep.
const MOST_STEPS: u32 = 20_000;

/// Result of an impact. Vectors are in the lean frame.
#[derive(Clone, Copy, Debug, PartialEq)]
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
            impulse: Vector3::zeros(),
            couple: Vector3::zeros(),
            before: velocity,
            after: velocity,
            restitution: 0.0,
            normal_loss: 0.0,
            friction_loss: 0.0,
            is_held: false,
        }
    }
}

/// State: impulses, moments, work of the normal force and energy lost by friction, scaled by the impact speed.
const SIZE: usize = 8;
/// Number of components needed for guards (all but the energy lost by friction).
const NEEDED: usize = 7;
type State = [f64; SIZE];

#[derive(Clone, Copy, Debug, PartialEq)]
enum Stage {
    /// Slipping; with the direction if the slip has just begun.
    Slipping(Option<Vector3<f64>>),
    /// The contact point is held.
    Held,
}

#[derive(Clone, Copy)]
struct Process<'a> {
    body: &'a FreeBody<'a>,
    before: Vector3<f64>,
    /// Approach speed before the impact, m/s; the velocity scale.
    speed: f64,
    /// Rolling resistance is reduced below this rolling rate, rad/s.
    creep: f64,
    stage: Stage,
}

/// State of the impact.
struct Progress {
    impulse: Vector3<f64>,
    couple: Vector3<f64>,
    velocity: Vector3<f64>,
    omega: Vector3<f64>,
}

impl Process<'_> {
    #[inline]
    fn progress(&self, y: &State) -> Progress {
        let top = self.body.top;
        let unit = top.mass * self.speed;
        let impulse = unit * Vector3::new(y[0], y[1], y[2]);
        let couple = unit * top.peg_radius * Vector3::new(y[3], y[4], y[5]);
        let turned = self
            .body
            .turned_by(&(self.body.arm.cross(&impulse) + couple));
        Progress {
            impulse,
            couple,
            velocity: self.before
                + self.body.response.to(&impulse)
                + self.body.answer_to_couple(&couple),
            omega: self.body.tilt.omega_lean + turned,
        }
    }

    /// Friction per normal impulse for a slip velocity (m/s) and an angular velocity (rad/s).
    #[inline]
    fn per_newton(&self, slip: &Vector3<f64>, omega: &Vector3<f64>) -> Wrench {
        let mut wrench = self.body.friction.per_newton(slip, omega);
        let rate = hypot(omega.x, omega.y);
        if rate < self.creep {
            wrench.couple.x *= rate / self.creep;
            wrench.couple.y *= rate / self.creep;
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
    fn friction(&self, now: &Progress) -> (Wrench, f64) {
        let slip = Self::slip(&now.velocity);
        let friction = self.body.friction;
        match self.stage {
            Stage::Held => (self.holding(now), 1.0),
            Stage::Slipping(start) => {
                let speed = slip.norm();
                let resolution = SLIP_STOPPED * self.scale();
                match start {
                    Some(direction) if speed < resolution => {
                        let slip = resolution * direction;
                        let pace = if friction.is_set_valued_at_rest() {
                            resolution / (resolution + self.speed)
                        } else {
                            1.0
                        };
                        (self.per_newton(&slip, &now.omega), pace)
                    }
                    _ => {
                        // Near the end of slip its direction changes ever faster.
                        let pace = if friction.is_set_valued_at_rest() {
                            speed / (speed + self.speed)
                        } else {
                            1.0
                        };
                        (self.per_newton(&slip, &now.omega), pace)
                    }
                }
            }
        }
    }

    /// The velocity scale of this impact, m/s.
    fn scale(&self) -> f64 {
        self.speed + hypot(self.before.x, self.before.y)
    }

    /// The friction that keeps the contact point at rest, per newton second of normal impulse.
    fn holding(&self, now: &Progress) -> Wrench {
        let couple = self.per_newton(&Vector3::zeros(), &now.omega).couple;
        let by_couple = self.body.answer_to_couple(&couple);
        let response = &self.body.response;
        Wrench {
            force: Vector3::new(
                -(response.coupling + by_couple.x) / response.lean,
                -by_couple.y / response.node,
                0.0,
            ),
            couple,
        }
    }

    /// The phase after the contact point has stopped slipping.
    fn stopped(&self, y: &State) -> Stage {
        let now = self.progress(y);
        let bound = self.body.friction.law.static_bound(1.0);
        if self.holding(&now).force.norm() <= bound {
            return Stage::Held;
        }
        let slowly = SLIP_STOPPED * self.scale();
        let answer = |direction: &Vector3<f64>| {
            let friction = self.per_newton(&(slowly * direction), &now.omega);
            self.body.answer_per_newton(&friction)
        };
        match FreeBody::departure(answer) {
            Some(direction) => Stage::Slipping(Some(direction)),
            None => Stage::Held,
        }
    }
}

impl System<SIZE> for Process<'_> {
    const CONTROLLED: usize = 6;

    fn derivative(&self, _: f64, y: &State) -> State {
        let now = self.progress(y);
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

/// Guards of an impact.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Mark {
    Compressed,
    Restituted,
    SlipStopped,
}

/// The watched values.
struct Marks {
    compressed: f64,
    restituted: f64,
    slip_stopped: f64,
}

impl Marks {
    fn of(&self, mark: Mark) -> f64 {
        match mark {
            Mark::Compressed => self.compressed,
            Mark::Restituted => self.restituted,
            Mark::SlipStopped => self.slip_stopped,
        }
    }
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
    for _ in 0..MOST_STEPS {
        if let Some(end) = collision.step()? {
            return Ok(end);
        }
    }
    let t = collision.integrator.t();
    Err(IntegrateError::StepSizeUnderflow { t, step: 0.0 })
}

struct Collision<'a> {
    integrator: Dop853<Process<'a>, SIZE>,
    restitution: f64,
    /// The (negative) work of compression, once it has ended.
    compression: Option<f64>,
    watches: Vec<(Mark, SignTracker)>,
}

impl<'a> Collision<'a> {
    fn new(
        body: &'a FreeBody<'a>,
        before: Vector3<f64>,
        restitution: f64,
    ) -> Result<Self, IntegrateError> {
        let speed = -before.z;
        let mut process = Process {
            body,
            before,
            speed,
            creep: CREEP_SHARE * body.friction.rolling_arm() * body.top.mass * speed
                / body.top.least_moment(),
            stage: Stage::Slipping(None),
        };
        let start = [0.0; SIZE];
        if hypot(before.x, before.y) <= SLIP_STOPPED * process.scale()
            && body.friction.is_set_valued_at_rest()
        {
            process.stage = process.stopped(&start);
        }
        let tolerances = Tolerances {
            relative: 1e-14,
            absolute: 1e-15,
        };
        let mut collision = Self {
            integrator: Dop853::new(process, 0.0, start, tolerances, Direction::Forward)?,
            restitution: if speed < slowest_bounce(restitution) {
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
        let process = self.integrator.system();
        let normal = if self.compression.is_some() {
            (Mark::Restituted, SignTracker::with_sign(false, 0.0))
        } else {
            (Mark::Compressed, SignTracker::with_sign(false, 0.0))
        };
        self.watches = vec![normal];
        if process.stage != Stage::Held && process.body.friction.is_set_valued_at_rest() {
            self.watches
                .push((Mark::SlipStopped, SignTracker::default()));
        }
    }

    /// The values of the watched functions.
    #[inline]
    fn marks(&self, y: &State) -> Marks {
        let process = self.integrator.system();
        let velocity = process.progress(y).velocity;
        let given_back = self.restitution * self.restitution;
        Marks {
            compressed: velocity.z / process.speed,
            restituted: y[6] - self.compression.unwrap_or_default() * (1.0 - given_back),
            slip_stopped: Process::slip(&velocity).norm() / process.scale() - SLIP_STOPPED,
        }
    }

    /// Takes a step. Returns the impact if it ends in this step.
    fn step(&mut self) -> Result<Option<Impact>, IntegrateError> {
        self.integrator.step_densely()?;
        let dense = self.integrator.dense();
        let Some((s, mark)) = self.first_mark(&dense) else {
            return Ok(None);
        };
        let (t, y) = (dense.t0 + s * dense.h, dense.at(s));
        match mark {
            Mark::Compressed => {
                self.compression = Some(y[6]);
                if self.restitution == 0.0 {
                    return Ok(Some(self.end(&y)));
                }
                let process = *self.integrator.system();
                self.restart(process, t, y)?;
            }
            Mark::Restituted => return Ok(Some(self.end(&y))),
            Mark::SlipStopped => {
                let y = self.without_rest_of_slip(t, y);
                let mut process = *self.integrator.system();
                process.stage = process.stopped(&y);
                self.restart(process, t, y)?;
            }
        }
        Ok(None)
    }

    fn restart(&mut self, process: Process<'a>, t: f64, y: State) -> Result<(), IntegrateError> {
        self.integrator.restart(process, t, y, Direction::Forward)?;
        self.watch();
        Ok(())
    }

    /// Extrapolates linearly to zero slip.
    fn without_rest_of_slip(&self, t: f64, y: State) -> State {
        let process = self.integrator.system();
        let slope = process.derivative(t, &y);
        let slip = Process::slip(&process.progress(&y).velocity);
        let ahead: State = std::array::from_fn(|i| y[i] + slope[i]);
        let change = Process::slip(&process.progress(&ahead).velocity) - slip;
        let span = slip.norm_squared() / -change.dot(&slip);
        if span > 0.0 && span.is_finite() {
            std::array::from_fn(|i| y[i] + span * slope[i])
        } else {
            y
        }
    }

    fn first_mark(&mut self, dense: &Dense<SIZE>) -> Option<(f64, Mark)> {
        let mut watches = std::mem::take(&mut self.watches);
        let state = |s| dense.first_at(NEEDED, s);
        let at = |s| self.marks(&state(s));
        // `map` would move everything several times.
        let [a, b, c, d, e] = KNOTS;
        let marks = [at(a), at(b), at(c), at(d), at(e)];
        let mut first: Option<(f64, Mark)> = None;
        for (mark, tracker) in &mut watches {
            let values = marks.each_ref().map(|marks| marks.of(*mark));
            let wanted = match mark {
                Mark::SlipStopped => Slope::Falling,
                Mark::Compressed | Mark::Restituted => Slope::Rising,
            };
            let mut found: Vec<Crossing> = Vec::new();
            tracker.scan(&KNOTS, &values, |s| at(s).of(*mark), &mut found);
            let crossing = found.iter().find(|crossing| crossing.slope == wanted);
            if let Some(crossing) = crossing
                && first.is_none_or(|(s, _)| crossing.s < s)
            {
                first = Some((crossing.s, *mark));
            }
        }
        self.watches = watches;
        first
    }

    fn end(&self, y: &State) -> Impact {
        let process = self.integrator.system();
        let now = process.progress(y);
        let unit = process.body.top.mass * process.speed * process.speed;
        let is_held = process.stage == Stage::Held;
        let mut after = now.velocity;
        if self.restitution == 0.0 {
            after.z = 0.0;
        }
        if is_held {
            (after.x, after.y) = (0.0, 0.0);
        }
        let given_back = 1.0 - self.restitution * self.restitution;
        Impact {
            impulse: now.impulse,
            couple: now.couple,
            before: process.before,
            after,
            restitution: self.restitution,
            normal_loss: -unit * given_back * self.compression.unwrap_or_default(),
            friction_loss: unit * y[7],
            is_held,
        }
    }
}
