//! Section e of a report: what B's model would have done along A's motion.
//!
//! Both models are given the states that A went through, and their torques and accelerations there are compared, by
//! the functions that the integrator calls. So the difference of the models shows by itself, free of the phase and the
//! drift that it causes.

use super::moments::Moments;
use crate::physics::dynamics::Model;
use crate::physics::kinematics::Tilt;
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

/// Names and units of the quantities: first the torque of friction, then accelerations.
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

/// Section e: what B's model does at the states that A went through, less what A's model does there.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Discrepancy {
    /// Number of states.
    pub states: u64,
    /// Components and magnitude of the torque of friction in the node frame, N m; frictional and whole
    /// accelerations, rad/s².
    pub quantities: Vec<Residual>,
}

/// A difference between two models along one motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Residual {
    /// The quantity.
    pub quantity: String,
    /// Its unit.
    pub unit: String,
    /// The largest magnitude of the difference.
    pub largest: f64,
    /// When it was largest, s.
    pub at: f64,
    /// Root of the mean square of the difference.
    pub rms: f64,
    /// Root of the mean square of the quantity itself, by A's model.
    pub rms_a: f64,
}

/// The differences of two models along A's motion so far.
#[derive(Clone, Debug)]
pub(super) struct Residuals {
    models: [Model; 2],
    states: u64,
    tallies: [ResidualSums; QUANTITIES.len()],
}

/// What is known of the differences in a quantity.
#[derive(Clone, Copy, Debug, Default)]
struct ResidualSums {
    largest: f64,
    at_ns: u64,
    differences: Moments,
    own: Moments,
}

/// What a model does in a state: the torque of friction in the node frame (N m), the frictional and the whole
/// accelerations (rad/s²).
fn action(model: &Model, tilt: &Tilt) -> [f64; QUANTITIES.len() - 1] {
    let contact = model.contact(tilt);
    let torque = tilt.lean_to_node(&model.friction_torque(&contact, tilt));
    let accelerations = model.accelerations(&contact, tilt);
    let (frictional, total) = (accelerations.frictional, accelerations.total());
    [
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

/// The quantities of an action, or of the difference of two: the magnitude of the torque comes first.
fn quantities(action: [f64; QUANTITIES.len() - 1]) -> [f64; QUANTITIES.len()] {
    let magnitude = Vector3::new(action[0], action[1], action[2]).norm();
    std::array::from_fn(|i| i.checked_sub(1).map_or(magnitude, |i| action[i]))
}

impl Residuals {
    pub(super) fn new(a: Model, b: Model) -> Self {
        Self {
            models: [a, b],
            states: 0,
            tallies: [ResidualSums::default(); QUANTITIES.len()],
        }
    }

    /// Takes in a state of A.
    pub(super) fn add(&mut self, time_ns: u64, tilt: &Tilt) {
        let [a, b] = self.models.map(|model| action(&model, tilt));
        let differences = quantities(std::array::from_fn(|i| b[i] - a[i]));
        self.states += 1;
        for ((tally, difference), a) in self.tallies.iter_mut().zip(differences).zip(quantities(a))
        {
            if difference.abs() > tally.largest {
                (tally.largest, tally.at_ns) = (difference.abs(), time_ns);
            }
            tally.differences.add(difference);
            tally.own.add(a);
        }
    }

    /// What was found, if any state was.
    pub(super) fn report(&self) -> Option<Discrepancy> {
        let residual = |((quantity, unit), tally): (&(&str, &str), &ResidualSums)| Residual {
            quantity: (*quantity).to_owned(),
            unit: (*unit).to_owned(),
            largest: tally.largest,
            at: tally.at_ns as f64 / 1e9,
            rms: tally.differences.rms(self.states),
            rms_a: tally.own.rms(self.states),
        };
        (self.states > 0).then(|| Discrepancy {
            states: self.states,
            quantities: QUANTITIES.iter().zip(&self.tallies).map(residual).collect(),
        })
    }
}
