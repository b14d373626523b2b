//! Zeros of the watched functions in a step, and what follows from them.

use super::{Detail, EarlyEnd, Runner, SimulationError};
use crate::physics::dynamics::{Formulation, Motion};
use crate::physics::integrate::{Crossing, Dense, KNOTS, Slope};
use crate::run::simulation::event::{EventKind, StopReason, UPRIGHT};
use crate::run::simulation::record::Record;
use crate::run::simulation::watch::{
    WatchedFunction, Zero, ZeroKind, accelerations, envelope, precession_noise,
};
use crate::run::time::nanoseconds;

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    /// All zeros of the watched functions in a step, in time order.
    pub(super) fn find_zeros(&mut self, dense: &Dense<N>) -> Vec<Zero> {
        let (system, sense) = (self.integrator.system(), self.sense);
        let motions = self.motions_at_knots(dense);
        // Taken out, because the trackers change while the motions are computed.
        let mut watched = std::mem::take(&mut self.watched);
        let mut crossings: Vec<Crossing> = Vec::new();
        let mut zeros = Vec::new();
        for WatchedFunction { kind, tracker } in &mut watched {
            let kind = *kind;
            if kind == ZeroKind::Precession {
                let steps = self.integrator.statistics().accepted;
                tracker.set_noise_level(precession_noise(&self.tolerances, steps, &motions));
            }
            let values = if kind == ZeroKind::NutationRate && self.detail == Detail::All {
                // Only recordings have the extremes of φ̇ and ψ̇. The accelerations give them along with those of θ̇.
                let at_knots = motions
                    .each_ref()
                    .map(|motion| accelerations(system.model(), motion));
                envelope(
                    |s| accelerations(system.model(), &self.motion_without_integrals(dense, s)),
                    &at_knots,
                    &mut zeros,
                );
                at_knots.each_ref().map(|acceleration| acceleration.theta)
            } else {
                kind.values(system, sense, &motions)
            };
            tracker.scan(
                &values,
                |s| {
                    let [value] =
                        kind.values(system, sense, &[self.motion_without_integrals(dense, s)]);
                    value
                },
                &mut crossings,
            );
            for Crossing { s, slope } in crossings.drain(..) {
                zeros.push(Zero { s, kind, slope });
            }
        }
        self.watched = watched;
        // Stable: simultaneous events keep the order of the watched functions.
        zeros.sort_by(|a, b| a.s.total_cmp(&b.s));
        zeros
    }

    /// The motions at the [`KNOTS`] of a step.
    fn motions_at_knots(&self, dense: &Dense<N>) -> [Motion; KNOTS.len()] {
        // `map` would move each motion several times.
        let [a, b, c, d, e] = KNOTS;
        [
            self.motion_without_integrals(dense, a),
            self.motion_without_integrals(dense, b),
            self.motion_without_integrals(dense, c),
            self.motion_without_integrals(dense, d),
            self.motion_without_integrals(dense, e),
        ]
    }

    /// Handles a zero of a watched function: queues its event, if any, and ends the step where the phase or run ends.
    pub(super) fn handle_zero(
        &mut self,
        dense: &Dense<N>,
        zero: Zero,
    ) -> Result<(), SimulationError> {
        let motion = self.motion(dense, zero.s);
        let time = dense.t0 + zero.s * dense.h;
        let event = match (zero.kind, zero.slope) {
            (ZeroKind::Nutation, slope) => {
                let is_of_nutation = self.nutation.record_extreme(time, &motion);
                match slope {
                    Slope::Rising if motion.angles.theta < UPRIGHT => {
                        Some(EventKind::UprightPassage)
                    }
                    Slope::Rising if is_of_nutation => Some(EventKind::NutationMinimum),
                    Slope::Falling if is_of_nutation => Some(EventKind::NutationMaximum),
                    Slope::Rising | Slope::Falling => None,
                }
            }
            (ZeroKind::NutationRate, Slope::Rising) | (ZeroKind::Envelope, _) => {
                self.nutation.record_rates(&motion);
                None
            }
            (ZeroKind::NutationRate, Slope::Falling) => {
                if let Some(cycle) = self.nutation.end_cycle(time, nanoseconds(time), motion) {
                    self.queue.push(Record::Nutation(Box::new(cycle)));
                }
                None
            }
            (ZeroKind::Precession, Slope::Falling) => {
                self.is_looping = true;
                Some(EventKind::LoopingBegins)
            }
            // A precession that starts backward has not begun a loop.
            (ZeroKind::Precession, Slope::Rising) => {
                std::mem::take(&mut self.is_looping).then_some(EventKind::LoopingEnds)
            }
            (ZeroKind::Strength, Slope::Falling) => Some(EventKind::WeakTop),
            (ZeroKind::Strength, Slope::Rising) => Some(EventKind::StrongTop),
            (ZeroKind::Risen(_), Slope::Falling) => {
                self.early_end = Some(EarlyEnd::stop(time, StopReason::Risen));
                Some(EventKind::Risen)
            }
            (ZeroKind::Fallen(_), Slope::Rising) => {
                // Without this stop condition, the horizontal is an event only.
                if self.stop.theta_fallen.is_some() {
                    self.early_end = Some(EarlyEnd::stop(time, StopReason::Fallen));
                }
                Some(EventKind::Fallen)
            }
            (ZeroKind::Guard(guard), Slope::Falling) => {
                return self.end_phase(guard, time, &dense.at(zero.s), motion);
            }
            (ZeroKind::Inversion, Slope::Rising) => Some(EventKind::Inverts),
            (ZeroKind::Risen(_) | ZeroKind::Guard(_), Slope::Rising)
            | (ZeroKind::Fallen(_) | ZeroKind::Inversion, Slope::Falling) => None,
        };
        if let Some(kind) = event {
            self.queue.push_event(kind, time, motion);
        }
        Ok(())
    }
}
