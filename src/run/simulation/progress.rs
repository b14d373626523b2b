//! Detects stalled runs.

use super::failure_point::ContactPhase;

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

/// What shows that a run no longer advances.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stall {
    /// Very many steps hardly advance it.
    TinySteps {
        /// Number of steps.
        steps: u32,
        /// The time that they should have advanced it, s.
        limit: f64,
        /// The mean step, s.
        mean_step: f64,
    },
    /// Very many phases hardly advance it.
    Alternates {
        /// The different contacts of these phases.
        contacts: Vec<ContactPhase>,
    },
}

/// A number of steps or phases since a time.
#[derive(Default)]
struct CountSince {
    count: u32,
    /// The time, s.
    time: f64,
}

impl Progress {
    /// Records a step to a time, s; fails if the run has stalled.
    pub(super) fn record_step(&mut self, time: f64) -> Result<(), Stall> {
        self.steps.count += 1;
        // Checked rarely: a stiff but short interval is no stall.
        if self.steps.count < STALLED_STEPS {
            return Ok(());
        }
        let advance = time - self.steps.time;
        if advance < STALLED_TIME {
            return Err(Stall::TinySteps {
                steps: STALLED_STEPS,
                limit: STALLED_TIME,
                mean_step: advance / f64::from(STALLED_STEPS),
            });
        }
        self.steps = CountSince { count: 0, time };
        Ok(())
    }

    /// Records the start of a phase at a time, s. Returns the number of phases started within [`CHATTER_TIME`]; fails
    /// if the run has stalled.
    pub(super) fn record_phase(&mut self, time: f64, contact: ContactPhase) -> Result<u32, Stall> {
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
            Err(Stall::Alternates {
                contacts: std::mem::take(&mut self.contacts),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The stall of a run in steps of this length, s.
    fn stall(step: f64) -> Option<Stall> {
        let mut progress = Progress::default();
        (1..=STALLED_STEPS).find_map(|count| progress.record_step(step * f64::from(count)).err())
    }

    #[test]
    fn a_million_tiny_steps_are_a_stall() {
        let Some(Stall::TinySteps {
            steps, mean_step, ..
        }) = stall(4e-8)
        else {
            panic!("no stall");
        };
        assert_eq!(steps, STALLED_STEPS);
        assert!((mean_step / 4e-8 - 1.0).abs() < 1e-9, "{mean_step}");
        assert_eq!(stall(6e-8), None);
    }
}
