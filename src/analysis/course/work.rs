//! The work of friction about each axis of the node frame.

use super::curve::Integral;
use crate::physics::kinematics::Tilt;
use crate::telemetry::Message;
use crate::telemetry::fields::torque;

/// Integrates the power of friction about each axis, from the torques and rates of the samples.
#[derive(Clone, Debug)]
pub(super) struct NodeWork {
    integrals: [Integral; 3],
    /// The time of the last sample and the step to it, ns.
    last: Option<u64>,
    step: u64,
    is_even: bool,
}

impl Default for NodeWork {
    fn default() -> Self {
        Self {
            integrals: [Integral::default(); 3],
            last: None,
            step: 0,
            is_even: true,
        }
    }
}

impl NodeWork {
    /// Adds a sample of the torque in a state.
    pub(super) fn add(&mut self, message: &Message<'_>, tilt: &Tilt) {
        let power = torque::FRICTION_NODE
            .of(message)
            .component_mul(&tilt.omega_node());
        for (integral, power) in self.integrals.iter_mut().zip(power.iter()) {
            integral.add(*power);
        }
        if let Some(last) = self.last.replace(message.time_ns) {
            let step = message.time_ns.saturating_sub(last);
            self.is_even &= step > 0 && (self.step == 0 || self.step == step);
            self.step = step;
        }
    }

    /// The work, J; none if samples are missing in between.
    pub(super) fn work(&self) -> Option<[f64; 3]> {
        let work = self
            .integrals
            .map(|integral| integral.over(self.step as f64 / 1e9));
        let is_known = self.last.is_some() && self.is_even && work.iter().all(|w| w.is_finite());
        is_known.then_some(work)
    }
}
