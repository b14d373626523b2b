//! Events, and quantities that should be constant between them.

use crate::physics::math::cos;
use crate::run::simulation::{EventKind, EventState};

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    /// The kind; `None` for a name of another version.
    pub(crate) kind: Option<EventKind>,
    /// Time, s.
    pub(crate) time: f64,
    /// The state then.
    pub(crate) state: EventState,
}

impl Event {
    /// Angular velocity about the symmetry axis then, rad/s.
    pub(crate) fn axial_rate(&self) -> f64 {
        self.state.psi_dot + self.state.phi_dot * cos(self.state.theta)
    }
}

/// A quantity that should be constant: its first value, and the largest deviation from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Constancy {
    pub(crate) first: f64,
    pub(crate) deviation: f64,
}

impl Constancy {
    /// Takes the next value; NaN is not recorded.
    pub(crate) fn take(constancy: &mut Option<Self>, value: f64) {
        if value.is_nan() {
            return;
        }
        let known = constancy.get_or_insert(Self {
            first: value,
            deviation: 0.0,
        });
        known.deviation = known.deviation.max((value - known.first).abs());
    }
}
