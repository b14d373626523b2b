//! Events, and quantities that should be constant between them.

use crate::run::simulation::EventKind;

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    /// The kind; `None` for a name of another version.
    pub(crate) kind: Option<EventKind>,
    /// Time, s.
    pub(crate) time: f64,
    /// Inclination θ then, rad.
    pub(crate) theta: f64,
    /// Angular velocity about the symmetry axis then, rad/s.
    pub(crate) axial_rate: f64,
    /// The recorded description.
    pub(crate) description: String,
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
