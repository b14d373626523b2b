//! Two models at the same states: what the one would have done along the motion of the other.

use super::report::{Discrepancy, Residual};
use crate::physics::dynamics::Model;
use crate::physics::kinematics::{Euler, Tilt};
use nalgebra::Vector3;

/// The quantities: names and units. First the torque of friction, then accelerations.
const QUANTITIES: [(&str, &str); 10] = [
    ("friction torque", "N m"),
    ("about the line of nodes", "N m"),
    ("about n × e_N", "N m"),
    ("about the symmetry axis", "N m"),
    ("frictional theta_ddot", "rad/s²"),
    ("frictional phi_ddot", "rad/s²"),
    ("frictional psi_ddot", "rad/s²"),
    ("theta_ddot", "rad/s²"),
    ("phi_ddot", "rad/s²"),
    ("psi_ddot", "rad/s²"),
];

/// Collects the differences of two models.
#[derive(Clone, Debug)]
pub(super) struct Residuals {
    models: [Model; 2],
    states: u64,
    tallies: [Tally; QUANTITIES.len()],
}

#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    largest: f64,
    at_ns: u64,
    squares: f64,
    squares_a: f64,
}

/// What a model does in a state.
struct Action {
    /// Torque of friction in the node frame, N m.
    torque: Vector3<f64>,
    frictional: Euler,
    total: Euler,
}

impl Action {
    fn of(model: &Model, tilt: &Tilt) -> Self {
        let contact = model.contact(tilt);
        let accelerations = model.accelerations(&contact, tilt);
        Self {
            torque: tilt.lean_to_node(&model.friction_torque(&contact, tilt)),
            frictional: accelerations.frictional,
            total: accelerations.total(),
        }
    }

    fn values(&self) -> [f64; QUANTITIES.len()] {
        let Self {
            torque,
            frictional,
            total,
        } = self;
        [
            torque.norm(),
            torque.x,
            torque.y,
            torque.z,
            frictional.theta,
            frictional.phi,
            frictional.psi,
            total.theta,
            total.phi,
            total.psi,
        ]
    }

    fn less(&self, other: &Self) -> Self {
        let less = |x: &Euler, y: &Euler| Euler {
            phi: x.phi - y.phi,
            theta: x.theta - y.theta,
            psi: x.psi - y.psi,
        };
        Self {
            torque: self.torque - other.torque,
            frictional: less(&self.frictional, &other.frictional),
            total: less(&self.total, &other.total),
        }
    }
}

impl Residuals {
    pub(super) fn new(a: Model, b: Model) -> Self {
        Self {
            models: [a, b],
            states: 0,
            tallies: [Tally::default(); QUANTITIES.len()],
        }
    }

    /// Takes in a state of A.
    pub(super) fn add(&mut self, time_ns: u64, tilt: &Tilt) {
        let [a, b] = self.models.map(|model| Action::of(&model, tilt));
        let differences = b.less(&a).values();
        self.states += 1;
        for ((tally, difference), a) in self.tallies.iter_mut().zip(differences).zip(a.values()) {
            if difference.abs() > tally.largest {
                (tally.largest, tally.at_ns) = (difference.abs(), time_ns);
            }
            tally.squares += difference * difference;
            tally.squares_a += a * a;
        }
    }

    pub(super) fn report(&self) -> Option<Discrepancy> {
        let count = self.states.max(1) as f64;
        let residual = |((quantity, unit), tally): (&(&str, &str), &Tally)| Residual {
            quantity: (*quantity).to_owned(),
            unit: (*unit).to_owned(),
            largest: tally.largest,
            at: tally.at_ns as f64 / 1e9,
            rms: (tally.squares / count).sqrt(),
            rms_a: (tally.squares_a / count).sqrt(),
        };
        (self.states > 0).then(|| Discrepancy {
            states: self.states,
            quantities: QUANTITIES.iter().zip(&self.tallies).map(residual).collect(),
        })
    }
}
