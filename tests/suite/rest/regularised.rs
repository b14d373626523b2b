//! An independent model of a top at the table whose set-valued friction is smoothed, integrated by another program's
//! implicit method.

use ivp::prelude::{FirstOrderSystem, Ivp, Method};
use nalgebra::{Matrix3, Vector3};
use std::f64::consts::PI;
use toprise::physics::dynamics::Model;
use toprise::physics::friction::FrictionLaw;
use toprise::physics::kinematics::Tilt;
use toprise::physics::top::Top;

/// What of a motion does not depend on directions in the table.
#[derive(Clone, Copy, Debug)]
pub struct Kinetics {
    /// θ, rad.
    theta: f64,
    /// |ω_⊥| and ω_z, rad/s.
    rocking: f64,
    turning: f64,
    /// Slip speed, m/s.
    slip: f64,
}

impl Kinetics {
    pub fn new(theta: f64, tilt: &Tilt, slip: f64) -> Self {
        Self {
            theta,
            rocking: tilt.omega_lean.xy().norm(),
            turning: tilt.omega_lean.z,
            slip,
        }
    }

    /// The largest difference, with rates relative to 1 rad/s or their size.
    pub fn distance(&self, other: &Self) -> f64 {
        let scale = 1.0 + other.rocking + other.turning.abs();
        [
            self.theta - other.theta,
            (self.rocking - other.rocking) / scale,
            (self.turning - other.turning) / scale,
            self.slip - other.slip,
        ]
        .into_iter()
        .fold(0.0, |largest, gap| gap.abs().max(largest))
    }
}

/// The top with friction that is smoothed below a slip speed.
pub struct Regularised<'a> {
    model: &'a Model,
    /// The smoothing speed, m/s; rates are smoothed below a hundred times this many rad/s.
    speed: f64,
}

/// Friction per newton of normal force, and the torque of neither.
struct PerNewton {
    force: Vector3<f64>,
    couple: Vector3<f64>,
}

impl<'a> Regularised<'a> {
    pub fn new(model: &'a Model, speed: f64) -> Self {
        Self { model, speed }
    }

    /// The motion after `duration`, from rest of the peg at φ = 0, θ and the rates of a lean frame. `None` if it can't be
    /// integrated.
    pub fn run(
        &self,
        theta: f64,
        start: &Tilt,
        peg: Vector3<f64>,
        duration: f64,
    ) -> Option<Kinetics> {
        let top = &self.model.top;
        let axis = Vector3::new(libm::sin(theta), 0.0, libm::cos(theta));
        let omega = start.omega_lean;
        // φ = 0 tilts the top towards −y: the lean frame is turned by that.
        let peg = Vector3::new(-peg.y, peg.x, 0.0);
        let velocity = peg + top.center_distance * omega.cross(&axis);
        let first = [
            axis.x, axis.y, axis.z, omega.x, omega.y, omega.z, velocity.x, velocity.y,
        ];
        let solution = Ivp::first_order(self, 0.0, duration, &first)
            .method(Method::BDF)
            .rtol(1e-10)
            .atol(1e-12)
            .max_steps(200_000)
            .solve()
            .ok()?;
        if (solution.t.last()? - duration).abs() > 1e-9 {
            return None;
        }
        let state = State::new(solution.y.last()?);
        let theta = libm::atan2(libm::hypot(state.axis.x, state.axis.y), state.axis.z);
        Some(Kinetics {
            theta,
            rocking: libm::hypot(state.omega.x, state.omega.y),
            turning: state.omega.z,
            slip: self.slip(&state).norm(),
        })
    }

    fn is_free(&self) -> bool {
        self.model.support.is_free()
    }

    /// From the reference point (centre of mass, or of a fixed peg) to the contact, m.
    fn arm(&self, axis: &Vector3<f64>) -> Vector3<f64> {
        let to_peg = if self.is_free() {
            -self.model.top.center_distance * axis
        } else {
            Vector3::zeros()
        };
        to_peg - Vector3::new(0.0, 0.0, self.model.top.peg_radius)
    }

    fn slip(&self, state: &State) -> Vector3<f64> {
        let mut slip = state.omega.cross(&self.arm(&state.axis));
        if self.is_free() {
            slip += state.velocity;
        }
        Vector3::new(slip.x, slip.y, 0.0)
    }

    fn friction(&self, state: &State) -> PerNewton {
        let slip = self.slip(state);
        let (eps, slow) = (self.speed, 100.0 * self.speed);
        let omega = state.omega;
        let speed = (slip.norm_squared() + eps * eps).sqrt();
        let mut couple = Vector3::zeros();
        let force = match &self.model.friction.law {
            FrictionLaw::None => Vector3::zeros(),
            FrictionLaw::Coulomb { k } => -*k / speed * slip,
            FrictionLaw::Viscous { k, speed } => -*k / *speed * slip,
            FrictionLaw::Contensou { k, patch_radius } => {
                let (k, a) = (*k, *patch_radius);
                // Force and torque are smoothed together. Smoothed one by one, they would hold loads beyond the limit of
                // slow motion by creeping.
                let (sliding, rim) = (slip.norm(), (a * omega.z).abs());
                let size = libm::hypot(sliding, rim);
                let share = k * size / libm::hypot(size, eps);
                let nonzero = |speed: f64| speed.max(f64::MIN_POSITIVE);
                couple.z -= 3.0 * PI / 16.0 * share * a * (a * omega.z)
                    / nonzero(rim + 15.0 * PI / 16.0 * sliding);
                -share / nonzero(sliding + 8.0 / (3.0 * PI) * rim) * slip
            }
            other => panic!("{other:?}"),
        };
        if let Some(losses) = self.model.friction.losses {
            let rocking = Vector3::new(omega.x, omega.y, 0.0);
            couple -= losses.rolling_arm / (rocking.norm_squared() + slow * slow).sqrt() * rocking;
            let (k, a) = (losses.drilling.k, losses.drilling.patch_radius);
            couple.z -=
                3.0 * PI / 16.0 * k * a * omega.z / (omega.z * omega.z + slow * slow).sqrt();
        }
        PerNewton { force, couple }
    }

    /// The angular acceleration for a torque, rad/s², and that of the axis.
    fn turned(&self, state: &State, torque: &Vector3<f64>) -> Vector3<f64> {
        let top = self.inertia();
        let outer = state.axis * state.axis.transpose();
        let (across, along) = (top.transverse_moment, top.axial_moment);
        let inertia = across * (Matrix3::identity() - outer) + along * outer;
        let inverse = (Matrix3::identity() - outer) / across + outer / along;
        inverse * (torque - state.omega.cross(&(inertia * state.omega)))
    }

    fn inertia(&self) -> Top {
        if self.is_free() {
            self.model.top.about_center()
        } else {
            self.model.top
        }
    }

    /// Accelerations for a normal force on a free peg: of the contact point upwards, and angular.
    fn pressed(&self, state: &State, friction: &PerNewton, normal: f64) -> (f64, Vector3<f64>) {
        let force = normal * (friction.force + Vector3::z());
        let arm = self.arm(&state.axis);
        let angular = self.turned(state, &(arm.cross(&force) + normal * friction.couple));
        let arm_turns = -self.model.top.center_distance * state.omega.cross(&state.axis);
        let at_contact = angular.cross(&arm) + state.omega.cross(&arm_turns);
        let (top, weight) = (&self.model.top, self.model.top.weight());
        ((force.z - weight) / top.mass + at_contact.z, angular)
    }
}

struct State {
    axis: Vector3<f64>,
    omega: Vector3<f64>,
    /// Velocity of the centre of mass, m/s.
    velocity: Vector3<f64>,
}

impl State {
    fn new(y: &[f64]) -> Self {
        Self {
            axis: Vector3::new(y[0], y[1], y[2]).normalize(),
            omega: Vector3::new(y[3], y[4], y[5]),
            velocity: Vector3::new(y[6], y[7], 0.0),
        }
    }
}

impl FirstOrderSystem for Regularised<'_> {
    fn derivative(&self, _: f64, y: &[f64], dy: &mut [f64]) {
        let state = State::new(y);
        let friction = self.friction(&state);
        let top = &self.model.top;
        let (angular, pushed) = if self.is_free() {
            let [without, with] =
                [0.0, 1.0].map(|normal| self.pressed(&state, &friction, normal).0);
            let normal = -without / (with - without);
            let (_, angular) = self.pressed(&state, &friction, normal);
            (angular, normal / top.mass * friction.force)
        } else {
            let gravity = -top.weight() * top.center_distance * state.axis.cross(&Vector3::z());
            let force = top.weight() * friction.force;
            let torque =
                gravity + self.arm(&state.axis).cross(&force) + top.weight() * friction.couple;
            (self.turned(&state, &torque), Vector3::zeros())
        };
        let moved = state.omega.cross(&state.axis);
        dy.copy_from_slice(&[
            moved.x, moved.y, moved.z, angular.x, angular.y, angular.z, pushed.x, pushed.y,
        ]);
    }
}
