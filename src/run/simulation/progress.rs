//! Detects stalled runs.

use super::failure_point::ContactPhase;
use std::fmt::{self, Display, Formatter};

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

/// The sign that a run no longer advances.
#[derive(Clone, Debug, PartialEq)]
pub enum Stall {
    /// Very many steps hardly advance it.
    TinySteps {
        /// Number of steps.
        steps: u32,
        /// The time that they should have advanced it, s.
        limit: f64,
    },
    /// Very many phases hardly advance it.
    Alternates {
        /// The different contacts of these phases.
        contacts: Vec<ContactPhase>,
    },
}

/// A clause such as "sliding and rolling alternate without end".
impl Display for Stall {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        match self {
            Self::TinySteps { steps, limit } => {
                write!(f, "{steps} steps advanced it by less than {limit} s")
            }
            Self::Alternates { contacts } => write!(f, "{} without end", alternation(contacts)),
        }
    }
}

/// A clause such as "sliding and rolling alternate".
fn alternation(contacts: &[ContactPhase]) -> String {
    let nouns: Vec<&str> = contacts.iter().map(|contact| contact.noun()).collect();
    match nouns.as_slice() {
        // The rotations that friction holds change.
        [only] => format!("phases of {only} alternate"),
        [first @ .., last] => format!("{} and {last} alternate", first.join(", ")),
        [] => "phases alternate".to_owned(),
    }
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
        if time - self.steps.time < STALLED_TIME {
            return Err(Stall::TinySteps {
                steps: STALLED_STEPS,
                limit: STALLED_TIME,
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
    use crate::physics::dynamics::Phase;

    /// The stall of a run in steps of this length, s.
    fn stall(step: f64) -> Option<Stall> {
        let mut progress = Progress::default();
        (1..=STALLED_STEPS).find_map(|count| progress.record_step(step * f64::from(count)).err())
    }

    #[test]
    fn detects_a_million_tiny_steps() {
        let expected = Stall::TinySteps {
            steps: STALLED_STEPS,
            limit: STALLED_TIME,
        };
        assert_eq!(stall(4e-8), Some(expected));
        assert_eq!(stall(6e-8), None);
    }

    #[test]
    fn alternation_names_the_phases_that_occur() {
        use Phase::{Flying, Sliding, Sticking};
        for (is_free, phases, expected) in [
            (false, &[Sliding][..], "phases of sliding alternate"),
            (
                false,
                &[Sliding, Sticking],
                "sliding and sticking alternate",
            ),
            (
                true,
                &[Flying, Sliding, Sticking],
                "flight, sliding and rolling alternate",
            ),
        ] {
            let mut contacts = Vec::new();
            for &phase in phases {
                contacts.push(ContactPhase { phase, is_free });
            }
            assert_eq!(alternation(&contacts), expected);
        }
    }
}
