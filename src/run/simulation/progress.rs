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
    /// Steps since it was last checked that the run advances.
    steps: CountSince,
    /// Phases entered since the run last advanced by [`CHATTER_TIME`].
    phases: CountSince,
    /// The different contacts of these phases.
    contacts: Vec<ContactPhase>,
}

/// A number of steps or phases since a time.
#[derive(Default)]
struct CountSince {
    count: u32,
    /// The time, s.
    time: f64,
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
        self.steps.count += 1;
        // Checked rarely: a stiff but short interval is no stall.
        if self.steps.count < STALLED_STEPS {
            return Ok(());
        }
        let advance = time - self.steps.time;
        if advance < STALLED_TIME {
            return Err(SimulationError::TinySteps {
                time,
                contact,
                steps: STALLED_STEPS,
                advance: STALLED_TIME,
                turn: turning_rate() * advance / f64::from(STALLED_STEPS),
            });
        }
        self.steps = CountSince { count: 0, time };
        Ok(())
    }

    /// Records the start of a phase at a time, s. Returns the number of phases started within [`CHATTER_TIME`]; fails
    /// if the run has stalled.
    pub(super) fn record_phase(
        &mut self,
        time: f64,
        contact: ContactPhase,
    ) -> Result<u32, SimulationError> {
        if time - self.phases.time >= CHATTER_TIME {
            self.phases = CountSince { count: 0, time };
            self.contacts.clear();
        }
        if !self.contacts.contains(&contact) {
            self.contacts.push(contact);
        }
        self.phases.count += 1;
        if self.phases.count < CHATTER_PHASES {
            Ok(self.phases.count)
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

    /// The message of a run that stalls in steps of 40 ns at an angular speed, rad/s.
    fn message_of_stall(speed: f64) -> String {
        let contact = ContactPhase {
            phase: Phase::Sliding,
            is_free: false,
        };
        let mut progress = Progress::default();
        let stalled = (1..=STALLED_STEPS).find_map(|step| {
            let time = 4e-8 * f64::from(step);
            progress.record_step(time, contact, || speed).err()
        });
        stalled.unwrap().to_string()
    }

    #[test]
    fn stalls_state_what_was_measured() {
        // Steps of 40 ns at 1e6 rad/s turn the top by 0.04 rad each.
        let message = message_of_stall(1e6);
        assert!(
            message.contains("turned the top by 4.0e-2 rad each"),
            "{message}"
        );
        assert!(!message.contains("friction"), "{message}");
    }

    #[test]
    fn stalls_advise_by_what_limits_the_steps() {
        for (speed, advice) in [(1e6, "initial rates"), (10.0, "friction.viscous_speed")] {
            let message = message_of_stall(speed);
            assert!(message.contains(advice), "{message}");
            // A million steps of 40 ns.
            let earlier = "a stop.duration of at most 0.04 s ends the run before";
            assert!(message.ends_with(earlier), "{message}");
        }
    }
}
