//! Energy, and the work of friction, air drag and impacts.

use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::energy;

/// The energies in the samples of a run.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Energies {
    /// The energy at the start, J.
    pub(crate) first: f64,
    /// The energy in the last sample, J.
    pub(crate) last: f64,
    /// Time of the last sample, s.
    pub(crate) until: f64,
    /// The work of friction, air drag and impacts up to the last sample, J.
    pub(crate) work: f64,
    /// The largest deviation of the energy from that at the start and this work, J.
    pub(crate) imbalance: f64,
    /// The largest sum of the sizes of kinetic and potential energy, J: that of both may be zero.
    pub(crate) size: f64,
}

impl Energies {
    /// Takes a message of `/top/energy`.
    pub(crate) fn take(energies: &mut Option<Self>, message: &Message<'_>) {
        let (last, work) = (energy::TOTAL.of(message), energy::FRICTION_WORK.of(message));
        if !(last.is_finite() && work.is_finite()) {
            return;
        }
        let known = energies.as_ref();
        // The work is counted from the start of the run, which a recording need not have.
        let first = known.map_or(last - work, |known| known.first);
        let imbalance = known.map_or(0.0, |known| known.imbalance);
        let size = energy::KINETIC.of(message).abs() + energy::POTENTIAL.of(message).abs();
        *energies = Some(Self {
            size: known.map_or(size, |known| known.size.max(size)),
            first,
            last,
            until: seconds(message.time_ns),
            work,
            imbalance: imbalance.max((last - first - work).abs()),
        });
    }
}
