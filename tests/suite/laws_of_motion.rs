//! The laws that a simulated motion must keep, judged from its messages alone.
//!
//! Identities between quantities hold up to rounding: their tolerances count the roundings in units of
//! the last place, ε, of what is summed, which may be far more than the sum. Quantities that are computed from
//! angles inherit the rounding of the angles, which grows with the turns: a factor 1 + |φ| + |ψ|.
//!
//! Balances hold up to the integrator's error: each step and the dense output err by the tolerances, times how much
//! an energy or a momentum changes with the state, times the number of steps.

use nalgebra::{UnitQuaternion, Vector3};
use toprise::physics::dynamics::Model;
use toprise::physics::friction::{
    Air, Dissipation, Drilling, Friction, FrictionLaw, drilling_torque,
};
use toprise::physics::integrate::Tolerances;
use toprise::physics::kinematics::{Euler, Tilt};
use toprise::physics::math;
use toprise::physics::top::Top;
use toprise::run::scenario::{FormulationKind, Scenario};
use toprise::telemetry::fields::{
    NumberField, VectorField, acceleration, center_of_mass, contact, energy, free_peg, impacts,
    momentum, pose, precession, state, torque,
};
use toprise::telemetry::{Message, Numbers, Topic, channels};

const EPS: f64 = f64::EPSILON;
/// The integrator takes at most this many steps per radian of the fastest rate, where friction needs no shorter ones.
/// The end record contains their number.
const STEPS_PER_RADIAN: f64 = 5.0;
/// One component may err by this many tolerances: the error norm is the mean over at most seven components, √7 < 3.
const PER_COMPONENT: f64 = 3.0;
/// The dense output errs by at most as much as this many steps: see `Dop853::step_densely`.
const STEPS_OF_DENSE: f64 = 10.0;

/// The violation of a law at an instant, and how much is allowed there.
type Judge = Box<dyn Fn(&Instant<'_>, &History) -> (f64, f64)>;

/// A law, and how well it has been kept.
struct PhysicalLaw {
    name: &'static str,
    unit: &'static str,
    judge: Judge,
    /// The first instant at which more was off than is allowed.
    broken: Option<Worst>,
}

/// A violation, what was allowed, and when, ns.
#[derive(Clone, Copy, Default)]
struct Worst {
    violation: f64,
    allowed: f64,
    time_ns: u64,
}

/// Watches over all laws that a scenario's motion must keep.
pub struct LawsOfMotion {
    laws: Vec<PhysicalLaw>,
    /// For each channel of the table its numbers at this instant.
    rows: Vec<Option<Vec<f64>>>,
    time_ns: u64,
    history: Option<History>,
    accepted: f64,
    scenario: Scenario,
}

/// What must be remembered of earlier instants.
struct History {
    /// Energy, work of friction and momenta when they were first recorded; NaN until then.
    energy: f64,
    work: f64,
    vertical: f64,
    axial: f64,
    top: Top,
    formulation: FormulationKind,
    tolerances: Tolerances,
    /// Steps of the whole run according to the end record.
    accepted: f64,
    /// Fastest angular velocity so far, rad/s; at least a pendulum's.
    fastest: f64,
    /// Largest angular momentum so far, summed from the parts that the integrator's state gives, kg m²/s.
    momentum: f64,
    /// Largest angular velocity so far, summed likewise, rad/s.
    rates: f64,
    /// Jellett's integral when it was first recorded, kg m³/s.
    jellett: f64,
    /// Routh's integral where the peg last began to roll, kg m²/s; NaN where it doesn't.
    routh: f64,
    /// Angular momentum about the centre of mass and velocity of it where the last flight began; NaN on the table.
    flight: (Vector3<f64>, Vector3<f64>),
}

impl LawsOfMotion {
    /// `accepted` is the number of the integrator's steps.
    pub fn new(scenario: &Scenario, accepted: u64) -> Self {
        Self {
            laws: laws(scenario),
            accepted: accepted as f64,
            rows: vec![None; channels().len()],
            time_ns: 0,
            history: None,
            scenario: scenario.clone(),
        }
    }

    /// Takes a message; those of one instant come one after the other.
    pub fn take(&mut self, message: &Message<'_>) {
        if message.time_ns != self.time_ns {
            self.judge();
            self.time_ns = message.time_ns;
        }
        let row = self.rows[message.channel].get_or_insert_default();
        row.clear();
        row.extend_from_slice(message.numbers);
    }

    /// Judges the instant whose messages have been taken.
    fn judge(&mut self) {
        if self.rows.iter().all(Option::is_none) {
            return;
        }
        let instant = Instant {
            rows: &self.rows,
            time: self.time_ns as f64 / 1e9,
        };
        let history = match &mut self.history {
            Some(history) => {
                history.take(&instant);
                history
            }
            none => none.insert(History::new(&instant, &self.scenario, self.accepted)),
        };
        for law in &mut self.laws {
            let (violation, allowed) = (law.judge)(&instant, history);
            // Quantities that are not recorded make it NaN: there is nothing to judge.
            if violation.is_nan() || allowed.is_nan() {
                continue;
            }
            if violation > allowed && law.broken.is_none() {
                law.broken = Some(Worst {
                    violation,
                    allowed,
                    time_ns: self.time_ns,
                });
            }
        }
        self.rows.iter_mut().for_each(|row| *row = None);
    }

    /// The laws that are broken, in a sentence each.
    pub fn broken(mut self) -> Vec<String> {
        self.judge();
        self.laws.iter().filter_map(PhysicalLaw::finding).collect()
    }
}

impl PhysicalLaw {
    fn finding(&self) -> Option<String> {
        let broken = self.broken.as_ref()?;
        Some(format!(
            "{}: off by {:.1e} {} at t = {} s, where {:.1e} is allowed",
            self.name,
            broken.violation,
            self.unit,
            broken.time_ns as f64 / 1e9,
            broken.allowed
        ))
    }
}

impl History {
    fn new(now: &Instant<'_>, scenario: &Scenario, accepted: f64) -> Self {
        let top = scenario.model.top;
        let tilt = Tilt::from_rates(scenario.angles.theta, scenario.rates);
        let mut history = Self {
            energy: f64::NAN,
            work: f64::NAN,
            vertical: f64::NAN,
            axial: f64::NAN,
            top,
            formulation: scenario.formulation,
            tolerances: scenario.tolerances,
            accepted,
            // A top that doesn't turn is a pendulum.
            fastest: (top.gravity_moment().abs() / top.transverse_moment).sqrt(),
            momentum: 0.0,
            rates: 0.0,
            jellett: f64::NAN,
            routh: f64::NAN,
            flight: (Vector3::repeat(f64::NAN), Vector3::repeat(f64::NAN)),
        };
        let momentum = top.angular_momentum_node(&tilt).norm();
        history.widen(&tilt.rates, tilt.omega_lean.norm(), momentum);
        history.take(now);
        history
    }

    fn take(&mut self, now: &Instant<'_>) {
        let remember = |first: &mut f64, field: NumberField| {
            if first.is_nan() {
                *first = field.of(now);
            }
        };
        remember(&mut self.energy, energy::TOTAL);
        remember(&mut self.work, energy::FRICTION_WORK);
        remember(&mut self.vertical, momentum::VERTICAL);
        remember(&mut self.axial, momentum::AXIAL);
        remember(&mut self.jellett, free_peg::JELLETT);
        self.take_phase(now);
        let rates = Euler {
            phi: state::PHI_DOT.of(now),
            theta: state::THETA_DOT.of(now),
            psi: state::PSI_DOT.of(now),
        };
        let omega = pose::OMEGA_WORLD.of(now).norm();
        self.widen(&rates, omega, momentum::WORLD.of(now).norm());
    }

    /// Takes the quantities that are constant during a phase. A phase that seems to last from one instant to the next may
    /// be two, which only the table of impacts shows: an impact between them starts a new phase.
    fn take_phase(&mut self, now: &Instant<'_>) {
        let regime = contact::REGIME.of(now);
        let has_landed = impacts::TIME.of(now).is_finite();
        if regime != 0.0 || has_landed {
            self.routh = f64::NAN;
        } else if self.routh.is_nan() {
            self.routh = free_peg::ROUTH.of(now);
        }
        if regime != 2.0 || has_landed {
            self.flight = (Vector3::repeat(f64::NAN), Vector3::repeat(f64::NAN));
        } else if self.flight.0.x.is_nan() {
            let momentum = center_of_mass::ANGULAR_MOMENTUM.of(now);
            self.flight = (momentum, center_of_mass::VELOCITY.of(now));
        }
    }

    /// Takes the sizes of an instant. What is not a number, because it is not recorded, is left out by `f64::max`.
    fn widen(&mut self, rates: &Euler, omega: f64, momentum: f64) {
        self.fastest = self.fastest.max(omega);
        let (momentum, rates) = match self.formulation {
            FormulationKind::Euler => {
                let [phi, theta, psi] = [rates.phi, rates.theta, rates.psi].map(f64::abs);
                let transverse = self.top.transverse_moment * (phi + theta);
                let axial = self.top.axial_moment * (phi + psi);
                (transverse + axial, phi + theta + psi)
            }
            FormulationKind::Body => (momentum, omega),
        };
        self.momentum = self.momentum.max(momentum);
        self.rates = self.rates.max(rates);
    }

    /// By how many tolerances a component of the integrator's state may be off at an instant.
    fn tolerances_used(&self, now: &Instant<'_>) -> f64 {
        let smooth = 1.0 + STEPS_PER_RADIAN * self.fastest * now.time;
        PER_COMPONENT * (smooth.max(self.accepted) + STEPS_OF_DENSE)
    }

    /// The integrator's relative tolerance, not less than the rounding of a step.
    fn relative(&self) -> f64 {
        self.tolerances.relative.max(8.0 * EPS)
    }

    /// The error of an angular momentum that the integrator may have made up to an instant, kg m²/s.
    ///
    /// A state whose parts are off by a part δ of themselves has a momentum that is off by at most 8 δ of its summands:
    /// once for rates or momentum, 2π times for θ, twice for the quaternion. A rate, or momentum, that is off by δ
    /// itself gives it with the moment of inertia, or directly.
    fn momentum_error(&self, now: &Instant<'_>) -> f64 {
        let unit = match self.formulation {
            FormulationKind::Euler => self.top.transverse_moment + self.top.axial_moment,
            FormulationKind::Body => 1.0,
        };
        let absolute = self.tolerances.absolute;
        let error = (self.relative() + absolute) * 8.0 * self.momentum + absolute * unit;
        self.tolerances_used(now) * error
    }

    /// The error of a force at the contact that the integrator may have made up to an instant, N: a force is made of the
    /// weight and of centrifugal ones, which are quadratic in the rates.
    fn force_error(&self, now: &Instant<'_>) -> f64 {
        let arm = self.top.center_distance.abs() + self.top.peg_radius;
        let size = self.top.weight() + self.top.mass * arm * self.rates * self.rates;
        let relative = self.relative() + self.tolerances.absolute;
        8.0 * self.tolerances_used(now) * relative * size
    }

    /// The error of the energy that the integrator may have made up to an instant, J.
    ///
    /// Likewise: ∂T/∂n = (1/I_z − 1/I_x)(L·n) L is at most 3 |ω| |L|, and n moves by twice what the quaternion does; in
    /// Euler angles ∂T/∂θ is at most the summands of φ̇ L, and θ at most π.
    fn energy_error(&self, now: &Instant<'_>) -> f64 {
        let unit = match self.formulation {
            FormulationKind::Euler => self.momentum,
            FormulationKind::Body => self.rates,
        };
        let size = 7.0 * self.momentum * self.rates + 4.0 * self.top.gravity_moment().abs();
        let absolute = self.tolerances.absolute;
        self.tolerances_used(now) * ((self.relative() + absolute) * size + absolute * unit)
    }
}

/// The numbers of all channels at one instant.
struct Instant<'a> {
    rows: &'a [Option<Vec<f64>>],
    /// Seconds.
    time: f64,
}

impl Numbers for Instant<'_> {
    fn numbers(&self, topic: Topic) -> Option<&[f64]> {
        self.rows[topic.index()].as_deref()
    }
}

fn law(
    name: &'static str,
    unit: &'static str,
    judge: impl Fn(&Instant<'_>, &History) -> (f64, f64) + 'static,
) -> PhysicalLaw {
    PhysicalLaw {
        name,
        unit,
        judge: Box::new(judge),
        broken: None,
    }
}

/// All laws that hold in a scenario.
fn laws(scenario: &Scenario) -> Vec<PhysicalLaw> {
    if scenario.model.support.is_free() {
        return laws_of_free_peg(scenario);
    }
    let friction = &scenario.model.friction;
    let mut laws = vec![
        orientation(),
        slip(scenario),
        sum_of_torques(),
        sum_of_accelerations(),
        energies_and_momenta(),
        regular_precession(scenario),
        bound_of_force(scenario),
    ];
    if !friction.dissipation.drops_euler_terms() {
        laws.push(torque_of_friction(scenario));
    }
    if friction.dissipation.is_of_force() {
        laws.push(only_takes(scenario));
    }
    laws.push(energy_balance());
    if !friction.turns_about_vertical() || scenario.is_frictionless() {
        let first = |history: &History| history.vertical;
        laws.push(constant("vertical momentum", momentum::VERTICAL, first));
    }
    let tilts_only = friction.dissipation == Dissipation::TiltTorqueOnly;
    if scenario.is_frictionless() || (tilts_only && !friction.has_losses()) {
        let first = |history: &History| history.axial;
        laws.push(constant("axial momentum", momentum::AXIAL, first));
    }
    laws
}

/// Friction never adds energy, up to rounding for torques that mix directions, such as air drag.
fn only_takes(scenario: &Scenario) -> PhysicalLaw {
    let Model { top, friction, .. } = scenario.model.clone();
    law("friction only takes", "W", move |now, _| {
        let power = energy::FRICTION_POWER.of(now);
        if !friction.has_losses() {
            return (power, 0.0);
        }
        let omega = pose::OMEGA_WORLD.of(now).norm();
        let size = size_of_torques(&top, &friction, now) * omega;
        (power, 8.0 * EPS * size)
    })
}

/// A momentum stays what it was.
fn constant(name: &'static str, field: NumberField, first: fn(&History) -> f64) -> PhysicalLaw {
    law(name, "kg m²/s", move |now, history| {
        let error = (field.of(now) - first(history)).abs();
        (error, history.momentum_error(now))
    })
}

/// The torque of friction is that of the force, as far as it acts, and of what acts beside it.
fn torque_of_friction(scenario: &Scenario) -> PhysicalLaw {
    let friction = &scenario.model.friction;
    if friction.dissipation.is_of_force() && !friction.has_losses() {
        torque_of_force(scenario)
    } else {
        torque_of_parts(scenario)
    }
}

/// How the rounding of the angles grows with their turns.
fn turns(now: &Instant<'_>) -> f64 {
    1.0 + state::PHI.of(now).abs() + state::PSI.of(now).abs()
}

/// The quaternion is a rotation, and turns body components of axis and rates into those in the world.
fn orientation() -> PhysicalLaw {
    law("orientation", "", |now, _| {
        let quaternion = pose::ORIENTATION.of(now);
        let rotation = UnitQuaternion::new_unchecked(quaternion);
        let length = (quaternion.norm() - 1.0).abs();
        let axis = (rotation * Vector3::z() - pose::AXIS.of(now)).norm();
        let omega_world = pose::OMEGA_WORLD.of(now);
        let omega = rotation * pose::OMEGA_BODY.of(now) - omega_world;
        let rates = omega.norm() / omega_world.norm().max(f64::MIN_POSITIVE);
        (length + axis + rates, 16.0 * EPS * turns(now))
    })
}

/// The contact point slips at ω × r with r = −R z′.
fn slip(scenario: &Scenario) -> PhysicalLaw {
    let radius = scenario.model.top.peg_radius;
    law("slip velocity", "m/s", move |now, _| {
        let omega = pose::OMEGA_WORLD.of(now);
        let slip = contact::SLIP_WORLD.of(now);
        let error = radius * Vector3::new(-omega.y, omega.x, 0.0) - slip;
        let of_speed = (slip.norm() - contact::SLIP_SPEED.of(now)).abs();
        let allowed = 16.0 * EPS * turns(now) * radius * omega.norm();
        (error.norm() + of_speed, allowed)
    })
}

/// The torques add up in each frame. Turning a vector into the body frame rounds it twelve times.
fn sum_of_torques() -> PhysicalLaw {
    use torque::{
        FRICTION_BODY, FRICTION_NODE, GRAVITY_BODY, GRAVITY_NODE, TOTAL_BODY, TOTAL_NODE,
    };
    law("sum of torques", "N m", |now, _| {
        let sum = |[gravity, friction, total]: [VectorField; 3]| {
            let (gravity, friction) = (gravity.of(now), friction.of(now));
            let error = (gravity + friction - total.of(now)).norm();
            (error, gravity.norm() + friction.norm())
        };
        let (body, _) = sum([GRAVITY_BODY, FRICTION_BODY, TOTAL_BODY]);
        let (node, size) = sum([GRAVITY_NODE, FRICTION_NODE, TOTAL_NODE]);
        (body + node, 32.0 * EPS * size)
    })
}

/// r × f has the length R |f| in every frame.
fn torque_of_force(scenario: &Scenario) -> PhysicalLaw {
    let radius = scenario.model.top.peg_radius;
    law("torque of the force", "N m", move |now, _| {
        let expected = radius * contact::FRICTION_FORCE.of(now).norm();
        let error = [torque::FRICTION_BODY, torque::FRICTION_NODE]
            .map(|torque| (torque.of(now).norm() - expected).abs());
        (error[0] + error[1], 32.0 * EPS * expected)
    })
}

/// Parts of r × f, and the torques beside it that follow from rates and slip speed.
fn torque_of_parts(scenario: &Scenario) -> PhysicalLaw {
    let Model { top, friction, .. } = scenario.model.clone();
    law("torque of friction", "N m", move |now, _| {
        let (normal, axis) = (contact::NORMAL_FORCE.of(now), pose::AXIS.of(now));
        let slip_speed = contact::SLIP_WORLD.of(now).norm();
        let force = contact::FRICTION_FORCE.of(now);
        let of_force = top.peg_radius * Vector3::new(force.y, -force.x, 0.0);
        let sliding = kept(friction.dissipation, &of_force, &axis);
        let losses = friction
            .torque_of_losses(slip_speed, normal, pose::OMEGA_WORLD.of(now), axis)
            .unwrap_or_default();
        // Friction of what doesn't move is what it has to be, up to its bound in either sense; its sign is that of the phase
        // where the motion is slower than `DEPARTING`.
        let omega = pose::OMEGA_WORLD.of(now);
        let mut unknown = 0.0;
        if slip_speed == 0.0 || omega.xy().norm() < DEPARTING {
            unknown += 2.0 * friction.rolling_arm() * normal;
        }
        if omega.z.abs() < DEPARTING {
            unknown += 2.0 * friction.drilling_bound(normal, slip_speed == 0.0);
        }
        let rotation = UnitQuaternion::new_unchecked(pose::ORIENTATION.of(now));
        let torque = rotation * torque::FRICTION_BODY.of(now);
        let error = (torque - sliding - losses).norm();
        let of_node = (torque::FRICTION_NODE.of(now).norm() - torque.norm()).abs();
        let size = size_of_torques(&top, &friction, now) + unknown;
        (error + of_node, unknown + 32.0 * EPS * turns(now) * size)
    })
}

/// The sizes of the torques that the torque of friction is summed from, N m. They may cancel: the drag of the air along
/// the axis is computed by taking that across it from the whole.
fn size_of_torques(top: &Top, friction: &Friction, now: &Instant<'_>) -> f64 {
    let normal = contact::NORMAL_FORCE.of(now);
    let omega = pose::OMEGA_WORLD.of(now).norm();
    let of_force = top.peg_radius * contact::FRICTION_FORCE.of(now).norm();
    let losses = friction.losses.unwrap_or_default();
    let Air {
        axial,
        transverse,
        disc,
    } = losses.air;
    // The disc's drag grows with the power 3/2 of the rate, and so does its rounding.
    let drag = (2.0 * transverse + axial + 1.5 * disc * omega.sqrt()) * omega;
    let Drilling { k, patch_radius } = losses.drilling;
    let mut of_patch = drilling_torque(k, patch_radius, normal, 0.0, -1.0);
    if let FrictionLaw::Contensou { k, patch_radius } = friction.law {
        of_patch += drilling_torque(k, patch_radius, normal, 0.0, -1.0);
    }
    of_force + drag + losses.rolling_arm * normal + of_patch
}

/// The components of a torque of sliding that act, in the world.
fn kept(part: Dissipation, torque: &Vector3<f64>, axis: &Vector3<f64>) -> Vector3<f64> {
    let perpendicular = axis.cross(&Vector3::z().cross(axis));
    let kept = match part {
        Dissipation::TiltTorqueOnly => perpendicular,
        Dissipation::SpinTorqueOnly => *axis,
        Dissipation::Full
        | Dissipation::WithoutNutationPart
        | Dissipation::PrecessionTermOnly
        | Dissipation::SpinTermOnly => return *torque,
    };
    let direction = kept.try_normalize(0.0).unwrap_or_default();
    direction * direction.dot(torque)
}

/// The accelerations, each with its terms.
const ACCELERATIONS: [(NumberField, &[NumberField]); 3] = {
    use acceleration::*;
    [
        (
            state::THETA_DDOT,
            &[
                THETA_DDOT_GYROSCOPIC,
                THETA_DDOT_CENTRIFUGAL,
                THETA_DDOT_GRAVITATIONAL,
                THETA_DDOT_FRICTIONAL,
            ],
        ),
        (
            state::PHI_DDOT,
            &[PHI_DDOT_GYROSCOPIC, PHI_DDOT_CORIOLIS, PHI_DDOT_FRICTIONAL],
        ),
        (
            state::PSI_DDOT,
            &[PSI_DDOT_GYROSCOPIC, PSI_DDOT_CORIOLIS, PSI_DDOT_FRICTIONAL],
        ),
    ]
};

/// The sum of terms, and of their magnitudes.
fn sum_of<'a>(terms: impl Iterator<Item = &'a NumberField>, now: &Instant<'_>) -> (f64, f64) {
    let terms = terms.map(|term| term.of(now));
    terms.fold((0.0, 0.0), |(s, a), t| (s + t, a + t.abs()))
}

/// The accelerations are the sums of their terms.
fn sum_of_accelerations() -> PhysicalLaw {
    law("sum of accelerations", "of the terms", |now, _| {
        let error = |(total, terms): &(NumberField, &[NumberField])| {
            let (sum, size) = sum_of(terms.iter(), now);
            (sum - total.of(now)).abs() / f64::max(size, f64::MIN_POSITIVE)
        };
        (ACCELERATIONS.iter().map(error).sum(), 16.0 * EPS)
    })
}

/// Kinetic and potential energy add up; the kinetic is ω·L/2, whose summands may cancel; the momenta are components of L.
fn energies_and_momenta() -> PhysicalLaw {
    law("energies and momenta", "of their size", |now, _| {
        let (kinetic, potential) = (energy::KINETIC.of(now), energy::POTENTIAL.of(now));
        let (momentum, omega) = (momentum::WORLD.of(now), pose::OMEGA_WORLD.of(now));
        let of_size = |error: f64, size: f64| error.abs() / size.max(f64::MIN_POSITIVE);
        let size = kinetic.abs() + potential.abs();
        let sum = of_size(kinetic + potential - energy::TOTAL.of(now), size);
        let of_rates = kinetic - 0.5 * momentum.dot(&omega);
        let of_rates = of_size(of_rates, momentum.norm() * omega.norm());
        let vertical = of_size(momentum.z - momentum::VERTICAL.of(now), momentum.norm());
        let axial = momentum.dot(&pose::AXIS.of(now)) - momentum::AXIAL.of(now);
        let axial = of_size(axial, momentum.norm());
        (sum + of_rates + vertical + axial, 32.0 * EPS * turns(now))
    })
}

/// The slow root solves (I_x − I_z) cos θ φ̇² − I_z ψ̇ φ̇ + M g l = 0. cos θ is rounded relative to 1.
fn regular_precession(scenario: &Scenario) -> PhysicalLaw {
    let top = scenario.model.nutating_top();
    law("regular precession", "of the terms", move |now, _| {
        let slow = precession::SLOW_ROOT.of(now);
        (regular_excess(&top, [0.0; 2], slow, now), 32.0 * EPS)
    })
}

/// The slow root of a top that rolls solves the same equation with the moments of inertia of a centre of mass that goes round
/// too. A contact point that slides may have no slip at an instant, and doesn't roll. In the air there is no constant term:
/// the slow root is 0, and the fast root solves the rest.
fn regular_precession_of_free_peg(scenario: &Scenario) -> PhysicalLaw {
    let (model, central) = (scenario.model.clone(), scenario.model.nutating_top());
    let weightless = Top {
        gravity: 0.0,
        ..central
    };
    law("regular precession", "of the terms", move |now, _| {
        let slow = precession::SLOW_ROOT.of(now);
        let sliding = regular_excess(&central, [0.0; 2], slow, now);
        let top = &model.top;
        let height = top.peg_radius + top.center_distance * math::cos(state::THETA.of(now));
        let moved = [top.center_distance, top.peg_radius].map(|arm| top.mass * arm * height);
        let rolling = regular_excess(&central, moved, slow, now);
        let fast = precession::FAST_ROOT.of(now);
        let flying = slow.abs() + regular_excess(&weightless, [0.0; 2], fast, now);
        let excess = match contact::REGIME.of(now) {
            0.0 => rolling.min(sliding),
            2.0 => flying,
            regime if regime.is_nan() => f64::NAN,
            _ => sliding,
        };
        (excess, 32.0 * EPS)
    })
}

/// Residual of ((I_x − I_z) cos θ + a) φ̇² − (I_z + b) ψ̇ φ̇ + M g l at a root, relative to its terms.
fn regular_excess(top: &Top, [a, b]: [f64; 2], root: f64, now: &Instant<'_>) -> f64 {
    let cos = math::cos(state::THETA.of(now));
    let square = (top.transverse_moment - top.axial_moment) * root * root;
    let linear = -(top.axial_moment + b) * state::PSI_DOT.of(now) * root;
    let (constant, moved) = (top.gravity_moment(), a * root * root);
    let size = square.abs() + linear.abs() + constant.abs() + moved.abs();
    (square * cos + moved + linear + constant).abs() / size
}

/// The friction force is no larger than the law's, and doesn't push along the slip.
fn bound_of_force(scenario: &Scenario) -> PhysicalLaw {
    let friction_law = scenario.model.friction.law.clone();
    law("bound of the force", "of the force", move |now, _| {
        let force = contact::FRICTION_FORCE.of(now);
        let slip = contact::SLIP_WORLD.of(now);
        let bound = friction_law.bound(contact::SLIP_SPEED.of(now), contact::NORMAL_FORCE.of(now));
        // Not `f64::max`, which would ignore values that are not recorded.
        let of_size = |error: f64, size: f64| match error {
            ..=0.0 => 0.0,
            error => error / size.max(f64::MIN_POSITIVE),
        };
        let excess = of_size(force.norm() - bound, bound);
        let along = of_size(force.dot(&slip), force.norm() * slip.norm());
        (excess + along, 16.0 * EPS)
    })
}

/// The change of energy is the work of friction.
fn energy_balance() -> PhysicalLaw {
    law("energy balance", "J", |now, history| {
        let change = energy::TOTAL.of(now) - history.energy;
        let allowed = 2.0 * history.energy_error(now);
        let work = energy::FRICTION_WORK.of(now) - history.work;
        ((change - work).abs(), allowed)
    })
}

/// The laws that hold for a top whose peg is free.
fn laws_of_free_peg(scenario: &Scenario) -> Vec<PhysicalLaw> {
    let friction = &scenario.model.friction;
    let mut laws = vec![
        orientation(),
        slip_of_free_peg(scenario),
        sum_of_torques(),
        sum_of_driven_accelerations(),
        energies_of_free_peg(),
        regular_precession_of_free_peg(scenario),
        bound_of_free_force(scenario),
        torque_of_friction(scenario),
        energy_balance(),
        losses_add_up(),
        newton(scenario),
        contact_of_free_peg(scenario),
        impacts_lose(),
    ];
    let has_couples = friction.has_losses();
    let has_air = friction
        .losses
        .is_some_and(|losses| losses.air != Air::default());
    if !has_couples {
        laws.push(jellett(scenario));
        laws.push(routh(scenario));
    }
    if !has_air {
        laws.push(free_flight());
    }
    laws
}

/// The contact point slips at v + ω × r with the velocity v of the peg's centre and r = −R z′; not at all where it
/// doesn't slip.
fn slip_of_free_peg(scenario: &Scenario) -> PhysicalLaw {
    let top = &scenario.model.top;
    let radius = top.peg_radius;
    // The peg's velocity is that of the centre of mass and of the turning about it.
    let reach = radius + top.center_distance.abs();
    law("slip velocity", "m/s", move |now, _| {
        let (omega, peg) = (pose::OMEGA_WORLD.of(now), free_peg::VELOCITY.of(now));
        let slip = contact::SLIP_WORLD.of(now);
        let expected = Vector3::new(peg.x - radius * omega.y, peg.y + radius * omega.x, 0.0);
        let of_speed = (slip.norm() - contact::SLIP_SPEED.of(now)).abs();
        let size = reach * omega.norm() + peg.norm();
        let error = (expected - slip).norm() + of_speed;
        (error, 32.0 * EPS * turns(now) * size)
    })
}

/// The accelerations are the sums of their terms and of what the acceleration of the peg adds, of which rounding is that
/// of the largest term.
fn sum_of_driven_accelerations() -> PhysicalLaw {
    let driven = [
        free_peg::DRIVEN_THETA_DDOT,
        free_peg::DRIVEN_PHI_DDOT,
        free_peg::DRIVEN_PSI_DDOT,
    ];
    law("sum of accelerations", "of the terms", move |now, _| {
        let errors = ACCELERATIONS.iter().zip(&driven);
        let errors = errors.map(|((total, terms), driven)| {
            let (sum, size) = sum_of(terms.iter().chain([driven]), now);
            (sum - total.of(now)).abs() / f64::max(size + total.of(now).abs(), f64::MIN_POSITIVE)
        });
        (errors.sum(), 32.0 * EPS)
    })
}

/// Kinetic and potential energy add up; the kinetic is that of the centre of mass and of the rotation about it.
fn energies_of_free_peg() -> PhysicalLaw {
    law("energies and momenta", "of their size", |now, _| {
        let (kinetic, potential) = (energy::KINETIC.of(now), energy::POTENTIAL.of(now));
        let translational = free_peg::TRANSLATIONAL.of(now);
        let momentum = center_of_mass::ANGULAR_MOMENTUM.of(now);
        let omega = pose::OMEGA_WORLD.of(now);
        let of_size = |error: f64, size: f64| error.abs() / size.max(f64::MIN_POSITIVE);
        let size = kinetic.abs() + potential.abs();
        let sum = of_size(kinetic + potential - energy::TOTAL.of(now), size);
        let rotational = 0.5 * momentum.dot(&omega);
        let size = momentum.norm() * omega.norm() + translational;
        let of_rates = of_size(kinetic - translational - rotational, size);
        (sum + of_rates, 64.0 * EPS * turns(now))
    })
}

/// The friction force is no larger than the law's, and doesn't push along the slip. Where rolling ends, the force is the
/// largest there is, up to the error of the integrator; where it began, the slip is too slow to have a direction.
fn bound_of_free_force(scenario: &Scenario) -> PhysicalLaw {
    let friction_law = scenario.model.friction.law.clone();
    law("bound of the force", "N", move |now, history| {
        let force = contact::FRICTION_FORCE.of(now);
        let (slip, normal) = (contact::SLIP_WORLD.of(now), contact::NORMAL_FORCE.of(now));
        let bound = friction_law.bound(contact::SLIP_SPEED.of(now), normal.abs());
        // Not `f64::max`, which would ignore values that are not recorded.
        let positive = |error: f64| if error <= 0.0 { 0.0 } else { error };
        let along = force.dot(&slip) / slip.norm().max(DEPARTING);
        let along = if slip.norm() < DEPARTING { 0.0 } else { along };
        let error = positive(force.norm() - bound) + positive(along);
        (error, history.force_error(now) + 32.0 * EPS * bound)
    })
}

/// What slips or turns more slowly after it was at rest has no direction yet, m/s or rad/s.
const DEPARTING: f64 = 1e-9;

/// The work of friction is the energy that sliding, losses and impacts took.
fn losses_add_up() -> PhysicalLaw {
    law("losses", "J", |now, history| {
        let lost = free_peg::LOST_SLIDING.of(now)
            + free_peg::LOST_LOSSES.of(now)
            + free_peg::LOST_RESTITUTION.of(now)
            + free_peg::LOST_IMPACT_FRICTION.of(now);
        let work = energy::FRICTION_WORK.of(now);
        // Each step and each impact rounds the sums once.
        let roundings = 8.0 + history.tolerances_used(now);
        ((work + lost).abs(), roundings * EPS * lost.abs())
    })
}

/// The centre of mass accelerates by the forces of table and gravity.
fn newton(scenario: &Scenario) -> PhysicalLaw {
    let top = scenario.model.top;
    let name = "acceleration of the centre of mass";
    law(name, "m/s²", move |now, _| {
        let normal = contact::NORMAL_FORCE.of(now);
        let force = contact::FRICTION_FORCE.of(now) + Vector3::new(0.0, 0.0, normal);
        let expected = force / top.mass - Vector3::new(0.0, 0.0, top.gravity);
        let error = center_of_mass::ACCELERATION.of(now) - expected;
        let size = force.norm() / top.mass + top.gravity;
        (error.norm(), 32.0 * EPS * turns(now) * size)
    })
}

/// The table only pushes, where there is no gap; the peg is never below it.
fn contact_of_free_peg(scenario: &Scenario) -> PhysicalLaw {
    let radius = scenario.model.top.peg_radius;
    law("contact with the table", "N", move |now, history| {
        let (normal, gap) = (contact::NORMAL_FORCE.of(now), free_peg::GAP.of(now));
        let pulls = if normal < 0.0 { -normal } else { 0.0 };
        let below = if gap < 0.0 { -gap / radius } else { 0.0 };
        let is_one_zero = gap * normal == 0.0;
        let apart = if is_one_zero { 0.0 } else { normal.abs() };
        // A gap in flight is that of the dense output, which errs by what a state may.
        let weight = history.top.weight();
        let allowed = history.force_error(now);
        (pulls + apart + below * weight, allowed)
    })
}

/// No impact gives energy, and the table only pushes.
fn impacts_lose() -> PhysicalLaw {
    law("impacts lose energy", "J", |now, _| {
        let normal = impacts::LOST_RESTITUTION.of(now);
        let friction = impacts::LOST_FRICTION.of(now);
        let gained = |lost: f64| if lost < 0.0 { -lost } else { 0.0 * lost };
        let impulse = impacts::IMPULSE.of(now);
        let pulls = if impulse.z < 0.0 { f64::INFINITY } else { 0.0 };
        let size =
            impulse.norm() * (impacts::BEFORE.of(now).norm() + impacts::AFTER.of(now).norm());
        (gained(normal) + gained(friction) + pulls, 1e3 * EPS * size)
    })
}

/// Jellett's integral stays what it was through sliding, rolling, flight and impacts.
fn jellett(scenario: &Scenario) -> PhysicalLaw {
    let top = scenario.model.top;
    law("Jellett's integral", "kg m³/s", move |now, history| {
        let error = (free_peg::JELLETT.of(now) - history.jellett).abs();
        let lever = top.peg_radius + top.center_distance.abs();
        (error, lever * history.momentum_error(now))
    })
}

/// Routh's integral is constant as long as the peg rolls. It is at most the angular momentum times the ratio of the root of
/// its moments to the axial one.
fn routh(scenario: &Scenario) -> PhysicalLaw {
    let top = scenario.model.top;
    let lever = top.peg_radius + top.center_distance.abs();
    let whole = top.central_moment() + top.axial_moment + top.mass * lever * lever;
    let factor = whole / top.axial_moment;
    let name = "Routh's integral while rolling";
    law(name, "kg m²/s", move |now, history| {
        let error = (free_peg::ROUTH.of(now) - history.routh).abs();
        (error, 2.0 * factor * history.momentum_error(now))
    })
}

/// In flight nothing changes the angular momentum about the centre of mass, nor its horizontal velocity.
fn free_flight() -> PhysicalLaw {
    law("free flight", "kg m²/s", |now, history| {
        let (momentum, velocity) = &history.flight;
        let turned = (center_of_mass::ANGULAR_MOMENTUM.of(now) - momentum).norm();
        let pushed = center_of_mass::VELOCITY.of(now) - velocity;
        let pushed = history.top.mass * pushed.xy().norm() * history.top.peg_radius;
        (turned + pushed, history.momentum_error(now))
    })
}
