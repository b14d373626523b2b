//! Whether a run gets on.

use super::record::SimulationError;

/// A run has stalled if this many steps advance it by less than [`STALLED_TIME`]: a torque that jumps changes its
/// sign with each of them.
const STALLED_STEPS: u32 = 1_000_000;
/// The time that a run which has not stalled takes at least for [`STALLED_STEPS`], s.
const STALLED_TIME: f64 = 0.05;

/// A run has stalled too if this many phases take it no farther than [`CHATTER_TIME`]: the slowest bounce takes 2e-7 s.
const CHATTER_PHASES: u32 = 1000;
/// The time that a run which has not stalled takes at least for [`CHATTER_PHASES`], s.
const CHATTER_TIME: f64 = 1e-9;

/// Distinguishes a run that makes progress from one that would never end.
#[derive(Default)]
pub(super) struct Progress {
    /// Steps since it was last checked that the run advances, and the time of that check, s.
    steps: (u32, f64),
    /// Phases entered since the run last advanced by [`CHATTER_TIME`], and the time then, s.
    phases: (u32, f64),
}

impl Progress {
    /// Notes a step to a time, s; gives up where steps have become too short.
    pub(super) fn step_to(&mut self, time: f64) -> Result<(), SimulationError> {
        let (steps, since) = &mut self.steps;
        *steps += 1;
        if *steps < STALLED_STEPS {
            return Ok(());
        }
        if time - *since < STALLED_TIME {
            return Err(SimulationError::Stalled { time });
        }
        self.steps = (0, time);
        Ok(())
    }

    /// Notes that a phase begins at a time, s, and counts those that have begun within [`CHATTER_TIME`]; gives up where
    /// phases have become too short.
    pub(super) fn enter_phase(&mut self, time: f64) -> Result<u32, SimulationError> {
        let (phases, since) = &mut self.phases;
        if time - *since >= CHATTER_TIME {
            (*phases, *since) = (0, time);
        }
        *phases += 1;
        if *phases < CHATTER_PHASES {
            Ok(*phases)
        } else {
            Err(SimulationError::Chatters { time })
        }
    }
}
