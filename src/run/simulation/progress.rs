//! Detects stalled runs.

use super::error::{ContactPhase, SimulationError};

/// A run has stalled if this many steps advance it by less than [`STALLED_TIME`].
const STALLED_STEPS: u32 = 1_000_000;
/// Minimum simulated time of [`STALLED_STEPS`] steps, s.
const STALLED_TIME: f64 = 0.05;

/// A run has also stalled if this many phases advance it by no more than [`CHATTER_TIME`].
const CHATTER_PHASES: u32 = 1000;
/// Minimum simulated time of [`CHATTER_PHASES`] phases, s.
const CHATTER_TIME: f64 = 1e-9;

/// Detects a run that no longer advances.
#[derive(Default)]
pub(super) struct Progress {
    /// Steps since it was last checked that the run advances, and the time of that check, s.
    steps: (u32, f64),
    /// Phases entered since the run last advanced by [`CHATTER_TIME`], and the time of that, s.
    phases: (u32, f64),
    /// The different contacts of these phases.
    contacts: Vec<ContactPhase>,
}

impl Progress {
    /// Records a step to a time, s; fails if the run has stalled.
    pub(super) fn record_step(
        &mut self,
        time: f64,
        contact: ContactPhase,
    ) -> Result<(), SimulationError> {
        let (steps, since) = &mut self.steps;
        *steps += 1;
        // Checked rarely: a stiff but short interval is no stall.
        if *steps < STALLED_STEPS {
            return Ok(());
        }
        if time - *since < STALLED_TIME {
            return Err(SimulationError::TinySteps {
                time,
                contact,
                steps: STALLED_STEPS,
                advance: STALLED_TIME,
            });
        }
        self.steps = (0, time);
        Ok(())
    }

    /// Records the start of a phase at a time, s. Returns the number of phases started within [`CHATTER_TIME`]; fails
    /// if the run has stalled.
    pub(super) fn record_phase(
        &mut self,
        time: f64,
        contact: ContactPhase,
    ) -> Result<u32, SimulationError> {
        let (phases, since) = &mut self.phases;
        if time - *since >= CHATTER_TIME {
            (*phases, *since) = (0, time);
            self.contacts.clear();
        }
        if !self.contacts.contains(&contact) {
            self.contacts.push(contact);
        }
        *phases += 1;
        if *phases < CHATTER_PHASES {
            Ok(*phases)
        } else {
            Err(SimulationError::Alternates {
                time,
                contacts: std::mem::take(&mut self.contacts),
            })
        }
    }
}
