//! Energy and the work of friction.

use crate::telemetry::Message;
use crate::telemetry::fields::energy;

/// The energies in the samples of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct Energies {
    /// The energy at the start, J.
    first: Option<f64>,
    /// The time (s), the energy (J) and the work of friction (J) of the last sample.
    last: Option<[f64; 3]>,
    /// The largest deviation of the energy from that at the start and the work of friction, J.
    imbalance: f64,
}

impl Energies {
    /// Takes a message of `/top/energy`.
    pub(crate) fn take(&mut self, message: &Message<'_>) {
        let (energy, work) = (energy::TOTAL.of(message), energy::FRICTION_WORK.of(message));
        if !(energy.is_finite() && work.is_finite()) {
            return;
        }
        let first = *self.first.get_or_insert(energy - work);
        self.imbalance = self.imbalance.max((energy - first - work).abs());
        self.last = Some([message.time_ns as f64 / 1e9, energy, work]);
    }

    /// The energy at the start, J.
    pub(crate) fn first(&self) -> Option<f64> {
        self.first
    }

    /// Time of the last sample, s.
    pub(crate) fn until(&self) -> Option<f64> {
        self.last.map(|[time, ..]| time)
    }

    /// The energy in the last sample, J.
    pub(crate) fn last(&self) -> Option<f64> {
        self.last.map(|[_, energy, _]| energy)
    }

    /// The work of friction up to the last sample, J.
    pub(crate) fn work(&self) -> Option<f64> {
        self.last.map(|[.., work]| work)
    }

    /// The energy lost up to the last sample, J.
    pub(crate) fn lost(&self) -> Option<f64> {
        Some(self.first? - self.last()?)
    }

    /// The largest deviation of the energy from that at the start and the work of friction, J.
    pub(crate) fn imbalance(&self) -> Option<f64> {
        self.first.map(|_| self.imbalance)
    }
}
