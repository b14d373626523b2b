//! The end of a phase and the beginning of the next.

use super::{
    Action, EarlyEnd, Runner, SimulationError, contact_phase, failure_point, motion_after_change,
};
use crate::physics::dynamics::{Entry, Formulation, Guard, Motion, Phase, Transition};
use crate::physics::friction::Dissipation;
use crate::run::simulation::event::{EventKind, StopReason, consequences};
use crate::run::simulation::free::ImpactRecord;
use crate::run::simulation::record::Record;
use crate::run::simulation::watch::copy_signs;
use crate::run::time::nanoseconds;

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    /// Handles the end of a phase: starts the next phase or ends the run.
    pub(super) fn end_phase(
        &mut self,
        guard: Guard,
        time: f64,
        state: &[f64; N],
        motion: Motion,
    ) -> Result<(), SimulationError> {
        let stops_at_rest = !self.stop.may_stick;
        let system = self.integrator.system();
        let entry = system
            .enter(guard, state, self.reference)
            .map_err(|source| SimulationError::Integration {
                at: failure_point(system, self.steps(), time, motion),
                guard: Some(guard),
                source,
            })?;
        if guard == Guard::Slip && stops_at_rest && stops_slip(&entry) {
            self.queue.push_event(EventKind::SlipStops, time, motion);
            self.early_end = Some(EarlyEnd::stop(time, StopReason::SlipStopped));
            return Ok(());
        }
        // Rates may jump here: both sides are candidates for their extremes.
        self.nutation.record_rates(&motion);
        let at = time + entry.delay;
        self.queue_entry_events(&entry, system.phase(), at);
        let sticks = entry.formulation.phase() == Phase::Sticking;
        let stop = consequences(entry.transition)
            .stop
            .or((stops_at_rest && sticks).then_some(StopReason::SlipStopped));
        let action = match stop {
            None => Action::Enter(entry),
            Some(reason) => Action::Stop {
                reason,
                after: motion_after_change(&entry),
            },
        };
        self.early_end = Some(EarlyEnd { time: at, action });
        Ok(())
    }

    /// Queues the events at the start of a phase.
    fn queue_entry_events(&mut self, entry: &Entry<F, N>, before: Phase, time: f64) {
        let motion = entry.motion;
        let transition_event = consequences(entry.transition).event;
        // A peg lands, or rolls already, before it rests or pivots.
        let is_last = matches!(
            entry.transition,
            Transition::Pivots { .. } | Transition::Rests
        );
        if let Some(kind) = transition_event
            && !is_last
        {
            self.queue.push_event(kind, time, motion);
        }
        if self.model().support.is_free() {
            self.queue_contact_events(entry, before, time);
        }
        if let Some(kind) = transition_event
            && is_last
        {
            self.queue.push_event(kind, time, motion);
        }
    }

    /// Queues the events of a free peg where its contact changes: rolling, lift-off, impact and landing.
    fn queue_contact_events(&mut self, entry: &Entry<F, N>, before: Phase, time: f64) {
        let motion = entry.motion;
        let after = entry.formulation.phase();
        if before == Phase::Sticking && after != Phase::Sticking {
            self.queue.push_event(EventKind::RollEnds, time, motion);
        }
        if before != Phase::Flying && after == Phase::Flying {
            self.queue.push_event(EventKind::LiftOff, time, motion);
        }
        if let Some(hit) = &entry.impact {
            let impact = ImpactRecord::new(hit, &motion, time, nanoseconds(time));
            self.queue.push(Record::Impact(Box::new(impact)));
        }
        if before == Phase::Flying && after != Phase::Flying {
            self.queue.push_event(EventKind::Landing, time, motion);
        }
        let rests = entry.transition == Transition::Rests;
        if before != Phase::Sticking && after == Phase::Sticking && !rests {
            self.queue.push_event(EventKind::RollBegins, time, motion);
        }
    }

    /// Starts another phase within the last step.
    #[cold]
    pub(super) fn enter(&mut self, time: f64, entry: &Entry<F, N>) -> Result<(), SimulationError> {
        let contact = contact_phase(&entry.formulation);
        let phases = match self.progress.record_phase(time, contact) {
            Ok(phases) => phases,
            Err(stall) => {
                let at = failure_point(&entry.formulation, self.steps(), time, entry.motion);
                return Err(SimulationError::Stalled { at, stall });
            }
        };
        // Samples up to here have been taken from the dense output.
        self.dense = None;
        let phase = self.integrator.system().phase();
        let system = &entry.formulation;
        let steps = self.steps();
        self.reference = system.angles(&entry.state, self.reference);
        self.integrator
            .restart(system.clone(), time, entry.state)
            .map_err(|source| SimulationError::Integration {
                at: failure_point(system, steps, time, entry.motion),
                guard: None,
                source,
            })?;
        // If phases repeat immediately, limit the step.
        let quarters = 4_u32.pow((phases - 1).min(10));
        self.integrator
            .limit_next_step(entry.first_step / f64::from(quarters));
        let next = self.detail.watched_functions(&self.stop, system);
        let before = std::mem::replace(&mut self.watched, next);
        let motion = system.motion(&entry.state, self.reference);
        // A fixed peg that sticks has no nutation; a free one goes on nutating in every phase.
        if self.model().support.is_free() || system.phase() == phase {
            self.nutation.record_impact(time, &motion);
            copy_signs(&before, &mut self.watched);
        } else {
            self.nutation.restart(time, motion);
        }
        self.early_end = None;
        Ok(())
    }
}

/// Whether a run with `stop.on_stick = "stop"` ends where its contact point stops slipping: friction holds the point, or
/// the equations leave out a part of friction and don't say how the motion goes on.
fn stops_slip<F: Formulation<N>, const N: usize>(entry: &Entry<F, N>) -> bool {
    let sticks = entry.formulation.phase() == Phase::Sticking;
    let is_complete = entry.formulation.model().friction.dissipation == Dissipation::Full;
    (sticks && entry.transition != Transition::Rests) || !is_complete
}
