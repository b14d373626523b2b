//! Comparison of the models along A's motion.
//!
//! Evaluates the torques and accelerations of both models at the states of A. This shows the difference of the models,
//! independent of phase and drift. For a free peg only sliding states are used.

use super::topic::field::rms;
use crate::physics::dynamics::{Integrals, Model, Motion, Peg, Phase};
use crate::physics::friction::Branch;
use crate::physics::kinematics::{Euler, Tilt, world_to_lean};
use crate::run::simulation::Regime;
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{CONTACT, FREE_PEG, STATE, contact, free_peg, state};
use nalgebra::Vector3;
use schemars::JsonSchema;
use serde::Serialize;

/// Names and units of the quantities: first the torque of friction (with losses and air drag), then accelerations.
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

/// Differences B − A of the models, evaluated at states of A.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Discrepancy {
    /// Number of states.
    pub states: u64,
    /// Components and magnitude of the torque of friction, losses and air drag in the node frame, N m; frictional and whole
    /// accelerations, rad/s².
    pub quantities: Vec<Residual>,
}

/// A difference between two models along one motion.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct Residual {
    /// The quantity.
    pub quantity: String,
    /// The unit.
    pub unit: String,
    /// The largest magnitude of the difference.
    pub largest: f64,
    /// Time of the largest, s.
    pub at: f64,
    /// Root mean square of the difference.
    pub rms: f64,
    /// Root mean square of the quantity itself, by A's model.
    pub rms_a: f64,
}

/// The differences of two models along A's motion so far.
#[derive(Clone, Debug)]
pub(super) struct Residuals {
    models: [Model; 2],
    /// A's last known state, with its time (ns).
    motion: Option<(u64, Motion)>,
    /// Whether the contact point of the last sample slips.
    slides: bool,
    states: u64,
    sums: [Sums; QUANTITIES.len()],
}

/// Sums of one quantity so far.
#[derive(Clone, Copy, Debug, Default)]
struct Sums {
    /// The largest magnitude of the difference.
    largest: f64,
    /// Time of the largest, ns.
    at_ns: u64,
    /// Sum of the squares of the difference.
    difference: f64,
    /// Sum of the squares of the quantity by A's model.
    a: f64,
}

/// Output of a model for a state: friction torque about the peg's centre (node frame, N m), frictional and total
/// accelerations (rad/s²).
fn action(model: &Model, motion: &Motion) -> [f64; QUANTITIES.len() - 1] {
    let tilt = &motion.tilt;
    let contact = model.contact_in(motion);
    let torque = tilt.lean_to_node(&model.friction_torque(&contact, tilt));
    let frictional = model.accelerations(&contact, tilt).frictional;
    let total = model.euler_accelerations(&contact, motion);
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

/// The motion of a top whose peg is at rest in the state of a message.
fn motion(message: &Message<'_>, radius: f64) -> Option<Motion> {
    let angles = Euler {
        phi: state::PHI.of(message),
        theta: state::THETA.of(message),
        psi: state::PSI.of(message),
    };
    let rates = Euler {
        phi: state::PHI_DOT.of(message),
        theta: state::THETA_DOT.of(message),
        psi: state::PSI_DOT.of(message),
    };
    let has_rates = ![rates.phi, rates.theta, rates.psi]
        .iter()
        .any(|rate| rate.is_nan());
    (angles.theta.is_finite() && has_rates).then(|| Motion {
        angles,
        tilt: Tilt::from_rates(angles.theta, rates),
        peg: Peg::fixed(radius),
        phase: Phase::Sliding,
        branch: Branch::default(),
        integrals: Integrals::default(),
    })
}

/// The quantities of a model's output, or of the difference of two: the magnitude of the torque comes first.
fn quantities(action: [f64; QUANTITIES.len() - 1]) -> [f64; QUANTITIES.len()] {
    let mut quantities = [0.0; QUANTITIES.len()];
    quantities[0] = Vector3::new(action[0], action[1], action[2]).norm();
    quantities[1..].copy_from_slice(&action);
    quantities
}

impl Residuals {
    /// `None` if B's model does not apply to A's states (B fixed, A free).
    pub(super) fn new(a: Model, b: Model) -> Option<Self> {
        // A model with a fixed peg has no forces for a peg that moves.
        let is_defined = b.support.is_free() || !a.support.is_free();
        is_defined.then(|| Self {
            models: [a, b],
            motion: None,
            slides: false,
            states: 0,
            sums: Default::default(),
        })
    }

    /// Adds a message of A.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        let is_free = self.models[0].support.is_free();
        match message.topic() {
            STATE => {
                self.motion = motion(message, self.models[0].top.peg_radius)
                    .map(|motion| (message.time_ns, motion));
                if let Some((_, motion)) = self.motion.filter(|_| !is_free) {
                    self.add(message.time_ns, &motion);
                }
            }
            CONTACT => {
                let regime = Regime::from_code(contact::REGIME.of(message));
                self.slides = regime == Some(Regime::Slipping);
            }
            // In each sample, `/top/contact` comes before `/top/free_peg`.
            FREE_PEG if self.slides => {
                if let Some((time_ns, mut motion)) = self.motion
                    && time_ns == message.time_ns
                {
                    let velocity = free_peg::VELOCITY.of(message);
                    motion.peg.velocity_lean = world_to_lean(&velocity, motion.angles.phi);
                    self.add(time_ns, &motion);
                }
            }
            _ => {}
        }
    }

    fn add(&mut self, time_ns: u64, motion: &Motion) {
        let [a, b] = self.models.each_ref().map(|model| action(model, motion));
        let differences = quantities(std::array::from_fn(|i| b[i] - a[i]));
        self.states += 1;
        for ((sums, difference), a) in self.sums.iter_mut().zip(differences).zip(quantities(a)) {
            if difference.abs() > sums.largest {
                (sums.largest, sums.at_ns) = (difference.abs(), time_ns);
            }
            sums.difference += difference * difference;
            sums.a += a * a;
        }
    }

    /// The result, if there was any state.
    pub(super) fn report(&self) -> Option<Discrepancy> {
        if self.states == 0 {
            return None;
        }
        let mut quantities = Vec::new();
        for ((quantity, unit), sums) in QUANTITIES.into_iter().zip(self.sums) {
            quantities.push(Residual {
                quantity: quantity.to_owned(),
                unit: unit.to_owned(),
                largest: sums.largest,
                at: seconds(sums.at_ns),
                rms: rms(sums.difference, self.states),
                rms_a: rms(sums.a, self.states),
            });
        }
        Some(Discrepancy {
            states: self.states,
            quantities,
        })
    }
}
