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
    /// Records a step to a time, s; fails if the run has stalled. `turning_rate` computes the angular speed of the top
    /// now, rad/s.
    pub(super) fn record_step(
        &mut self,
        time: f64,
        contact: ContactPhase,
        turning_rate: impl FnOnce() -> f64,
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
                turn: turning_rate() * (time - *since) / f64::from(STALLED_STEPS),
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::dynamics::Phase;

    #[test]
    fn stalls_state_what_was_measured() {
        let contact = ContactPhase {
            phase: Phase::Sliding,
            is_free: false,
        };
        // Steps of 40 ns at 1e6 rad/s turn the top by 0.04 rad each.
        let mut progress = Progress::default();
        let stalled = (1..=STALLED_STEPS).find_map(|step| {
            let time = 4e-8 * f64::from(step);
            progress.record_step(time, contact, || 1e6).err()
        });
        let message = stalled.unwrap().to_string();
        assert!(
            message.ends_with("turned the top by 4.0e-2 rad each"),
            "{message}"
        );
        assert!(!message.contains("friction"), "{message}");
    }
}
