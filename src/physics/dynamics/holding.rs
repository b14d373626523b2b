//! Contact forces on a free peg where friction holds components of the motion at zero.
//!
//! The contact has six velocities: those of the contact point (slip, and its vertical velocity, which is zero) and the
//! angular velocity (rocking about horizontal axes, turning about the vertical). Their accelerations are `b + W λ` with
//! the wrench `λ` of the contact. A component that moves has a friction proportional to the normal force. A component
//! that is held has no acceleration, and its friction follows from that.

use super::motion::HELD_AGAIN;
use super::reaction::{FreeBody, Reaction};
use super::support::Phase;
use crate::physics::friction::{Branch, Rocking, Turning, Wrench};
use crate::physics::math::hypot;
use nalgebra::{Matrix6, Vector3, Vector6};
use std::ops::Range;

/// Index of the vertical component of a [`Vector6`] of contact forces, or of accelerations.
const NORMAL: usize = 2;
/// Index of the torque about the vertical.
const TURNING: usize = 5;

/// Maximum number of iterations for the friction of a contact at rest.
const MAX_ITERATIONS: u32 = 20_000;
/// Relative change of the forces at which the iteration has converged.
const CONVERGED: f64 = 1e-14;

/// Rocking rate at which the breakaway of rolling resistance ends and its direction is that of the law, rad/s.
///
/// Below it, the law would turn the rotation into the direction of the load within a time proportional to the rate, which
/// an explicit method has to resolve, as for [`BREAKAWAY_SPEED`](crate::physics::friction::BREAKAWAY_SPEED); this is the rate at
/// which a peg of 1 cm slips at that speed.
const BREAKAWAY_RATE: f64 = 1e-5;

/// Components of the contact's motion that are zero at an instant, and have set-valued friction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Resting {
    /// The slip velocity.
    pub slip: bool,
    /// The horizontal angular velocity.
    pub rocking: bool,
    /// The angular velocity about the vertical.
    pub turning: bool,
}

/// The components at rest that begin to move, and the forces then.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Release {
    /// Normal force, N.
    pub normal: f64,
    /// Direction in which the slip begins; `None` if it is held.
    pub slip: Option<Vector3<f64>>,
    /// Direction in which rocking begins; `None` if it is held.
    pub rocking: Option<Vector3<f64>>,
    /// The angular acceleration about the vertical, rad/s²; `None` if turning is held.
    pub turning: Option<f64>,
}

/// The accelerations `b + W λ`.
struct Response {
    free: Vector6<f64>,
    per_force: Matrix6<f64>,
}

/// A component of the contact's motion with set-valued friction.
#[derive(Clone, Copy)]
enum Component {
    Slip,
    Rocking,
    Turning,
}

impl Component {
    /// The rows of its friction in a wrench, and of its acceleration.
    fn rows(self) -> Range<usize> {
        match self {
            Self::Slip => 0..2,
            Self::Rocking => 3..5,
            Self::Turning => TURNING..TURNING + 1,
        }
    }
}

/// The bound of the friction that can hold a component: a disc of forces or couples, or an interval.
struct Bound {
    component: Component,
    /// Largest friction per normal force, dimensionless or m.
    coefficient: f64,
}

impl FreeBody<'_> {
    /// The reaction in a phase in which friction prevents rocking or turning.
    #[cold]
    pub(super) fn holding_reaction(&self, phase: Phase, slip: &Vector3<f64>) -> Reaction {
        let branch = &self.friction.branch;
        let is_held = [
            phase == Phase::Sticking,
            phase == Phase::Sticking,
            true,
            branch.rocking == Rocking::Held,
            branch.rocking == Rocking::Held,
            branch.turning == Turning::Held,
        ];
        let moving = self.moving_friction(phase, slip);
        let Response { free, per_force } = self.response();
        let mut equations = Matrix6::identity();
        let mut right = Vector6::zeros();
        for row in 0..6 {
            if is_held[row] {
                // What is held has no acceleration; the vertical is always among it.
                equations.set_row(row, &per_force.row(row));
                right[row] = -free[row];
            } else {
                equations[(row, NORMAL)] = -moving[row];
            }
        }
        // Singular only if friction is held by two rows that depend on each other, e.g. without a moment of inertia.
        let solution = equations.lu().solve(&right);
        let wrench = solution.unwrap_or_else(Vector6::zeros);
        Reaction {
            normal: wrench[NORMAL],
            friction: Wrench {
                force: Vector3::new(wrench[0], wrench[1], 0.0),
                couple: Vector3::new(wrench[3], wrench[4], wrench[TURNING]),
            },
            air: self.air(),
        }
    }

    /// Whether rolling resistance has given way, but the top rocks too slowly for the law to give its direction.
    #[inline(always)]
    pub(super) fn begins_to_rock(&self) -> bool {
        let omega = &self.tilt.omega_lean;
        self.friction.branch.rocking == Rocking::Breakaway
            && hypot(omega.x, omega.y) < BREAKAWAY_RATE
    }

    /// The direction of rocking that rolling resistance opposes where it gives way, lean frame: that of the rotation,
    /// turned against the torque that would hold the top, the more the slower the rotation is.
    pub(super) fn rocking_direction(&self, phase: Phase, slip: &Vector3<f64>) -> Vector3<f64> {
        let held = self.rocking_as(Rocking::Held, phase, slip);
        let couple = Vector3::new(held.friction.couple.x, held.friction.couple.y, 0.0);
        let omega = Vector3::new(self.tilt.omega_lean.x, self.tilt.omega_lean.y, 0.0);
        let (strength, rate) = (couple.norm(), omega.norm());
        let bound = self.friction.rolling_arm() * held.normal;
        if rate > 0.0 && strength < bound * (1.0 - HELD_AGAIN) {
            // Friction in the direction of the load would push the top backward.
            return omega / rate;
        }
        let load = -couple / strength;
        if rate == 0.0 {
            return load;
        }
        // From the direction of the load at rest to that of the rotation at the breakaway rate.
        let share = rate / BREAKAWAY_RATE;
        ((1.0 - share) * load + share / rate * omega).normalize()
    }

    /// The reaction on a top that begins to rock.
    #[cold]
    pub(super) fn rocking_reaction(&self, phase: Phase, slip: &Vector3<f64>) -> Reaction {
        let direction = self.rocking_direction(phase, slip);
        self.rocking_as(Rocking::Along(direction), phase, slip)
    }

    /// The reaction on another branch of rolling resistance.
    fn rocking_as(&self, rocking: Rocking, phase: Phase, slip: &Vector3<f64>) -> Reaction {
        let branch = Branch {
            rocking,
            ..self.friction.branch
        };
        let friction = self.friction.on_branch(branch);
        let body = FreeBody {
            friction: &friction,
            ..*self
        };
        body.reaction(phase, slip)
    }

    /// Friction of the moving components per normal force; 0 for the others and for the normal force.
    fn moving_friction(&self, phase: Phase, slip: &Vector3<f64>) -> Vector6<f64> {
        let still = Vector3::zeros();
        let slip = if phase == Phase::Sticking {
            &still
        } else {
            slip
        };
        let Wrench { force, couple } = self.friction.per_normal_force(slip, &self.law_omega());
        Vector6::new(force.x, force.y, 0.0, couple.x, couple.y, couple.z)
    }

    /// The accelerations of the contact.
    fn response(&self) -> Response {
        let air = self.air();
        let (linear, angular) = (self.free_acceleration(&air), self.free_turning(&air));
        let mut per_force = Matrix6::zeros();
        for column in 0..3 {
            let mut force = Vector3::zeros();
            force[column] = 1.0;
            let by_force = self.inverse_mass.velocity_change(&force);
            let turned = self.angular_acceleration(&self.arm.cross(&force));
            set_column(&mut per_force, column, &by_force, &turned);
            let by_couple = self.acceleration_per_couple(&force);
            let turned = self.angular_acceleration(&force);
            set_column(&mut per_force, column + 3, &by_couple, &turned);
        }
        Response {
            free: Vector6::new(
                linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
            ),
            per_force,
        }
    }

    /// The release of the components at rest: friction holds each of them if it can, and otherwise resists the
    /// acceleration as much as it can (Gauss's principle: the accelerations differ as little as possible from those
    /// without friction).
    ///
    /// The forces are found by projection: each is changed until its component no longer accelerates, but not beyond its
    /// bound. `slip` is the slip velocity, if it isn't at rest (m/s).
    #[cold]
    pub(super) fn released(&self, resting: Resting, slip: &Vector3<f64>) -> Release {
        let friction = self
            .friction
            .on_branch(resting.branch(&self.friction.branch));
        let body = FreeBody {
            friction: &friction,
            ..*self
        };
        let phase = if resting.slip {
            Phase::Sticking
        } else {
            Phase::Sliding
        };
        let mut moving = body.moving_friction(phase, slip);
        moving[NORMAL] = 1.0;
        let bounds = resting.bounds(&body);
        let Response { free, per_force } = body.response();
        // Friction that moves acts with the normal force.
        let mobility = (per_force * moving)[NORMAL];
        // The friction of the components at rest; that of the others follows from the normal force.
        let mut at_rest = Vector6::zeros();
        let mut normal = 0.0;
        let mut wrench = Vector6::zeros();
        for _ in 0..MAX_ITERATIONS {
            let before = wrench;
            let load = (free + per_force * at_rest)[NORMAL];
            normal = (-load / mobility).max(0.0);
            for bound in &bounds {
                wrench = at_rest + normal * moving;
                bound.project(
                    &mut at_rest,
                    &(free + per_force * wrench),
                    &per_force,
                    normal,
                );
            }
            // The other bounds may have changed the forces since.
            wrench = at_rest + normal * moving;
            if bounds_converged(&bounds, &before, &wrench, normal) {
                break;
            }
        }
        let acceleration = free + per_force * wrench;
        let mut release = Release {
            normal,
            slip: None,
            rocking: None,
            turning: None,
        };
        for bound in &bounds {
            if bound.holds(&at_rest, normal) {
                continue;
            }
            match bound.component {
                Component::Slip => release.slip = Some(bound.beginning_motion(&at_rest)),
                Component::Rocking => release.rocking = Some(bound.beginning_motion(&at_rest)),
                Component::Turning => release.turning = Some(acceleration[TURNING]),
            }
        }
        release
    }
}

impl Resting {
    /// The branches on which the components at rest are held.
    fn branch(self, moving: &Branch) -> Branch {
        Branch {
            turning: if self.turning {
                Turning::Held
            } else {
                moving.turning
            },
            rocking: if self.rocking {
                Rocking::Held
            } else {
                moving.rocking
            },
        }
    }

    fn bounds(self, body: &FreeBody<'_>) -> Vec<Bound> {
        let friction = body.friction;
        let mut bounds = Vec::new();
        if self.slip {
            bounds.push(Bound {
                component: Component::Slip,
                coefficient: friction.law.static_bound_at(1.0, 0.0),
            });
        }
        if self.rocking {
            bounds.push(Bound {
                component: Component::Rocking,
                coefficient: friction.rolling_arm(),
            });
        }
        if self.turning {
            bounds.push(Bound {
                component: Component::Turning,
                coefficient: friction.drilling_bound(1.0, self.slip),
            });
        }
        bounds
    }
}

impl Bound {
    /// The magnitude of this friction in a wrench, N or N m.
    fn size(&self, wrench: &Vector6<f64>) -> f64 {
        self.component
            .rows()
            .fold(0.0, |size, row| hypot(size, wrench[row]))
    }

    /// The direction of the motion that begins against the largest friction of a disc, a horizontal unit vector.
    fn beginning_motion(&self, wrench: &Vector6<f64>) -> Vector3<f64> {
        let (first, size) = (self.component.rows().start, self.size(wrench));
        Vector3::new(-wrench[first] / size, -wrench[first + 1] / size, 0.0)
    }

    /// Changes the friction against the acceleration of its component, within its bound.
    fn project(
        &self,
        wrench: &mut Vector6<f64>,
        acceleration: &Vector6<f64>,
        per_force: &Matrix6<f64>,
        normal: f64,
    ) {
        // One factor for all rows keeps the direction; the largest doesn't overshoot in any row.
        let largest = self
            .component
            .rows()
            .fold(0.0_f64, |largest, row| largest.max(per_force[(row, row)]));
        for row in self.component.rows() {
            wrench[row] -= acceleration[row] / largest;
        }
        let (size, bound) = (self.size(wrench), self.coefficient * normal);
        if size > bound {
            for row in self.component.rows() {
                wrench[row] *= bound / size;
            }
        }
    }

    /// Whether this friction is within its bound.
    fn holds(&self, wrench: &Vector6<f64>, normal: f64) -> bool {
        // The projection onto the bound is rounded, so friction on the bound may seem to be a little within.
        self.size(wrench) < self.coefficient * normal * (1.0 - 1e-12)
    }
}

/// Whether the frictions have stopped changing, relative to their bounds.
fn bounds_converged(
    bounds: &[Bound],
    before: &Vector6<f64>,
    now: &Vector6<f64>,
    normal: f64,
) -> bool {
    let change = now - before;
    change[NORMAL].abs() <= CONVERGED * normal
        && bounds
            .iter()
            .all(|bound| bound.size(&change) <= CONVERGED * bound.coefficient * normal)
}

fn set_column(
    matrix: &mut Matrix6<f64>,
    column: usize,
    linear: &Vector3<f64>,
    angular: &Vector3<f64>,
) {
    let both = Vector6::new(
        linear.x, linear.y, linear.z, angular.x, angular.y, angular.z,
    );
    matrix.set_column(column, &both);
}
