//! Events.

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
