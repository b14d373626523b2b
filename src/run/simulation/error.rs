//! Reasons why a motion can't be computed further.

use crate::physics::dynamics::{Guard, Phase};
use crate::physics::integrate::IntegrateError;
use std::fmt::{self, Display, Formatter};
use thiserror::Error;

/// Reason why a motion can't be computed further. An interrupted run is no error: it ends with
/// [`StopReason::Interrupted`](super::StopReason::Interrupted).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// The equations of motion can't be integrated.
    #[error("the motion can't be integrated further {contact}: {source}")]
    Integration {
        /// Time at the end of the last step, s.
        time: f64,
        /// The contact in the step.
        contact: ContactPhase,
        /// The error of the integrator.
        source: IntegrateError,
    },
    /// The next phase of the motion can't be computed.
    #[error("{} at t = {time:?} s can't be computed: {reason}", transition_name(*guard))]
    Transition {
        /// Time, s.
        time: f64,
        /// The guard that ended the phase: [`Guard::Gap`] for an impact.
        guard: Guard,
        /// The error of the integrator. Its independent variable is the impulse of the impact, relative to that of a mass
        /// of the top's size.
        reason: IntegrateError,
    },
    /// Very many steps hardly advance the run.
    #[error(
        "the simulation stalled at t = {time:?} s, {contact}: {steps} steps advanced it by less than {advance} s and turned the top by {turn:.1e} rad each; {}; a stop.duration of at most {time:?} s ends the run before",
        cause_of_stall(*turn)
    )]
    TinySteps {
        /// Time, s.
        time: f64,
        /// The contact in the steps.
        contact: ContactPhase,
        /// Number of steps.
        steps: u32,
        /// The time that they should have advanced the run, s.
        advance: f64,
        /// The angle by which a step turned the top on average, rad. It is large where the motion is fast, and small where
        /// the forces change much faster than the top moves.
        turn: f64,
    },
    /// Very many phases hardly advance the run.
    #[error(
        "the simulation stalled at t = {time:?} s: {} without end (tolerances below 1e-9, \
         integrator.absolute_tolerance and integrator.relative_tolerance, may resolve it)",
        alternation(contacts)
    )]
    Alternates {
        /// Time, s.
        time: f64,
        /// The different contacts of these phases.
        contacts: Vec<ContactPhase>,
    },
    /// The number of samples is limited.
    #[error("more than {max} samples: sampling.period must be larger", max = u32::MAX)]
    TooManySamples,
}

impl SimulationError {
    /// The time up to which the motion was computed, s; `None` if the motion is not the reason.
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::Integration { time, .. }
            | Self::Transition { time, .. }
            | Self::TinySteps { time, .. }
            | Self::Alternates { time, .. } => Some(*time),
            Self::TooManySamples => None,
        }
    }
}

/// The phase of the contact between a fixed or a free peg and the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ContactPhase {
    /// The phase.
    pub phase: Phase,
    /// Whether the peg is free.
    pub is_free: bool,
}

impl ContactPhase {
    fn noun(self) -> &'static str {
        match self.phase {
            Phase::Sliding => "sliding",
            Phase::Sticking if self.is_free => "rolling",
            Phase::Sticking => "sticking",
            Phase::Flying => "flight",
        }
    }
}

/// A clause such as "while the contact point slips".
impl Display for ContactPhase {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        f.write_str(match self.phase {
            Phase::Sliding => "while the contact point slips",
            Phase::Sticking if self.is_free => "while the peg rolls",
            Phase::Sticking => "while the contact point sticks",
            Phase::Flying => "while the peg is in the air",
        })
    }
}

fn transition_name(guard: Guard) -> &'static str {
    match guard {
        Guard::Gap => "the impact",
        Guard::Slip => "the end of slip",
        Guard::Grip => "the beginning of slip",
        Guard::NormalForce => "the lift-off",
        Guard::Rolling | Guard::Turning => "the end of a rotation",
        Guard::RollingGrip | Guard::TurningGrip => "the beginning of a rotation",
        Guard::Departure | Guard::Mobility | Guard::Regular => "the end of the phase",
    }
}

/// Angle per step above which the rotation itself needs the steps, rad. Where only the motion limits steps, they turn the
/// top by 0.01 rad or more, even at the strictest tolerances.
const TURN_OF_FAST_ROTATION: f64 = 1e-3;

/// A clause that names what limits the steps of a stalled run, and the keys that change it. `turn` is the angle by which a
/// step turned the top, rad.
fn cause_of_stall(turn: f64) -> &'static str {
    if turn >= TURN_OF_FAST_ROTATION {
        "the rotation needs them: initial rates may be too large, or moments of inertia too small"
    } else {
        "the forces change much faster than the top moves: friction.viscous_speed, friction.smoothing_speed or moments \
         of inertia may be too small, or air drag or friction.k too large"
    }
}

/// A clause such as "sliding and rolling alternate".
fn alternation(contacts: &[ContactPhase]) -> String {
    let nouns: Vec<&str> = contacts.iter().map(|contact| contact.noun()).collect();
    match nouns.as_slice() {
        [] => "phases alternate".to_owned(),
        // The rotations that friction holds change.
        [only] => format!("phases of {only} alternate"),
        [first @ .., last] => format!("{} and {last} alternate", first.join(", ")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::error::Error as _;

    const SLIDING: ContactPhase = ContactPhase {
        phase: Phase::Sliding,
        is_free: false,
    };

    fn contacts(is_free: bool, phases: &[Phase]) -> Vec<ContactPhase> {
        let contact = |&phase| ContactPhase { phase, is_free };
        phases.iter().map(contact).collect()
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
            assert_eq!(alternation(&contacts(is_free, phases)), expected);
        }
    }

    #[test]
    fn keeps_the_error_of_the_integrator() {
        let source = IntegrateError::NonFiniteState { t: 1.5 };
        let error = SimulationError::Integration {
            time: 1.5,
            contact: SLIDING,
            source,
        };
        let kept = error.source().and_then(|source| source.downcast_ref());
        assert_eq!(kept, Some(&source));
        assert!(error.to_string().contains("while the contact point slips"));
    }

    #[test]
    fn only_a_closing_gap_is_an_impact() {
        let error = |guard| SimulationError::Transition {
            time: 0.5,
            guard,
            reason: IntegrateError::NonFiniteState { t: 0.0 },
        };
        for (guard, is_impact) in [
            (Guard::Gap, true),
            (Guard::Slip, false),
            (Guard::Grip, false),
            (Guard::Regular, false),
        ] {
            let text = error(guard).to_string();
            assert_eq!(text.contains("impact"), is_impact, "{text}");
        }
    }
}
