//! What the terms of φ̈ and friction's term in ψ̈ added up to, and the shares of time.

use crate::analysis::course::curve::Integral;
use crate::physics::kinematics::{Euler, Tilt};
use crate::physics::top::Top;
use crate::run::simulation::UPRIGHT;
use crate::telemetry::Message;
use crate::telemetry::fields::{acceleration, contact, state};
use std::f64::consts::PI;

/// Whether the axis is so near the vertical, upright or hanging, that precession and spin can hardly be told apart: their
/// rates and terms grow like 1/sin² θ.
pub(super) fn is_vertical(theta: f64) -> bool {
    theta < UPRIGHT || PI - theta < UPRIGHT
}

/// The rates and the running integrals at one instant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Sums {
    /// Time, s.
    pub(super) time: f64,
    /// φ̇ and ψ̇, rad/s.
    pub(super) rates: [f64; 2],
    /// ∫ of the gyroscopic, Coriolis and frictional terms of φ̈ and of the frictional one of ψ̈, rad/s; NaN where they are
    /// not recorded.
    pub(super) terms: [f64; 4],
}

/// Why the sums end before the run does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Until {
    /// The axis came near the vertical, where precession and spin can hardly be told apart, because their terms explode.
    Vertical,
    /// The contact point stuck: other torques act then than those of the terms.
    Stick,
}

/// Collects the sums up to where they end.
#[derive(Clone, Debug, Default)]
pub(super) struct Totals {
    pub(super) first: Option<Sums>,
    pub(super) last: Option<Sums>,
    pub(super) until: Option<(Until, f64)>,
    /// ∫ of the frictional terms of φ̈ and ψ̈ from the samples, for recordings that have no integrals.
    sampled: [Integral; 2],
    /// The time between the first two samples, ns, and whether it is the same between all.
    step: Option<u64>,
    is_uneven: bool,
    last_ns: Option<u64>,
    /// Samples with real rates of regular precession; of them, those with φ̇ above the slow rate, those with φ̇ above the
    /// fast one, and those with θ̈ < 0.
    pub(super) rooted: u64,
    pub(super) above: [u64; 2],
    pub(super) rising: u64,
    /// Work of the friction force along the slipped path, J.
    pub(super) slip_work: Option<f64>,
}

impl Totals {
    /// Takes in a state, before the other messages of its time.
    pub(super) fn state(&mut self, message: &Message<'_>, top: &Top, sticks: bool, time: f64) {
        let fields = [
            state::THETA,
            state::PHI_DOT,
            state::PSI_DOT,
            state::THETA_DOT,
        ];
        let [theta, phi, psi, rate] = fields.map(|field| field.of(message));
        if let Some(last) = self.last_ns.replace(message.time_ns) {
            let step = message.time_ns.saturating_sub(last);
            self.is_uneven |= *self.step.get_or_insert(step) != step;
        }
        if self.until.is_none() {
            if sticks {
                self.until = Some((Until::Stick, time));
            } else if is_vertical(theta) {
                self.until = Some((Until::Vertical, time));
            }
        }
        if self.until.is_some() {
            return;
        }
        let sums = Sums {
            time,
            rates: [phi, psi],
            terms: [f64::NAN; 4],
        };
        self.first.get_or_insert(sums);
        self.last = Some(sums);
        let tilt = Tilt::from_rates(
            theta,
            Euler {
                phi,
                theta: rate,
                psi,
            },
        );
        if let Some(roots) = top.precession_roots(&tilt) {
            self.rooted += 1;
            self.above[0] += u64::from(phi > roots.slow);
            self.above[1] += u64::from(phi > roots.fast);
            self.rising += u64::from(state::THETA_DDOT.of(message) < 0.0);
        }
    }

    /// Takes in the terms at the time of the last state.
    pub(super) fn acceleration(&mut self, message: &Message<'_>) {
        if self.until.is_some() {
            return;
        }
        let terms = [
            acceleration::PHI_DOT_GYROSCOPIC,
            acceleration::PHI_DOT_CORIOLIS,
            acceleration::PHI_DOT_FRICTIONAL,
            acceleration::PSI_DOT_FRICTIONAL,
        ];
        let terms = terms.map(|term| term.of(message));
        let time = message.time_ns as f64 / 1e9;
        for sums in [&mut self.first, &mut self.last].into_iter().flatten() {
            if sums.time == time {
                sums.terms = terms;
            }
        }
        let friction = [
            acceleration::PHI_DDOT_FRICTIONAL,
            acceleration::PSI_DDOT_FRICTIONAL,
        ];
        for (integral, term) in self.sampled.iter_mut().zip(friction) {
            integral.add(term.of(message));
        }
    }

    pub(super) fn contact(&mut self, message: &Message<'_>) {
        self.slip_work = Some(contact::SLIP_WORK.of(message)).filter(|work| work.is_finite());
    }

    /// What the gyroscopic, Coriolis and frictional terms of φ̈ and the frictional one of ψ̈ changed the rates by; the
    /// first two are none in recordings of the first version, where what friction did is summed over the samples.
    pub(super) fn changes(&self) -> Option<([Option<f64>; 2], [f64; 2])> {
        let (first, last) = (self.first?, self.last?);
        let change = |term: usize| last.terms[term] - first.terms[term];
        if (0..4).all(|term| change(term).is_finite()) {
            return Some(([Some(change(0)), Some(change(1))], [change(2), change(3)]));
        }
        let step = self.step.filter(|_| !self.is_uneven)? as f64 / 1e9;
        let friction = self.sampled.map(|integral| integral.over(step));
        let is_known = friction.iter().all(|sum| sum.is_finite());
        is_known.then_some(([None; 2], friction))
    }

    /// The time between samples, s.
    pub(super) fn step(&self) -> Option<f64> {
        Some(self.step? as f64 / 1e9)
    }
}
