//! Reasons why a motion can't be computed further.

use super::failure_point::FailurePoint;
use super::progress::Stall;
use crate::physics::dynamics::Guard;
use crate::physics::formula::InvalidCoefficient;
use crate::physics::integrate::IntegrateError;
use thiserror::Error;

/// Reason why a motion can't be computed further. An interrupted run is no error: it ends with
/// [`StopReason::Interrupted`](super::StopReason::Interrupted).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// The equations of motion can't be integrated.
    #[error("{} {at}: {source}; {}", failure(*guard), at.remedy())]
    Integration {
        /// The end of the last step.
        at: Box<FailurePoint>,
        /// The guard whose transition failed, [`Guard::Gap`] for an impact; `None` within a phase.
        guard: Option<Guard>,
        /// The error of the integrator. Its independent variable is time; in an impact it is the impulse, relative to that of
        /// a mass of the top's size.
        source: IntegrateError,
    },
    /// Very many steps or phases hardly advance the run.
    #[error("the simulation stalled {at}: {stall}; {}", at.remedy())]
    Stalled {
        /// The end of the last step, or the beginning of the last phase.
        at: Box<FailurePoint>,
        /// The sign of it.
        stall: Stall,
    },
    /// The formula of the friction law has no coefficient of friction at a slip speed of the motion.
    #[error("the motion can't be computed further {at}: {source}")]
    Coefficient {
        /// The end of the last step.
        at: Box<FailurePoint>,
        /// The formula, the slip speed and the coefficient.
        source: InvalidCoefficient,
    },
    /// The number of samples is limited.
    #[error(
        "the run has more than {max} samples: set a longer sampling.period or a shorter stop.duration",
        max = u32::MAX
    )]
    TooManySamples,
}

impl SimulationError {
    /// The time up to which the motion was computed, s; `None` if the motion is not the reason.
    pub fn time(&self) -> Option<f64> {
        match self {
            Self::Integration { at, .. }
            | Self::Stalled { at, .. }
            | Self::Coefficient { at, .. } => Some(at.time),
            Self::TooManySamples => None,
        }
    }
}

fn failure(guard: Option<Guard>) -> &'static str {
    match guard {
        None => "the motion can't be integrated further",
        Some(Guard::Gap) => "the impact can't be computed",
        Some(_) => "the next phase can't be computed",
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physics::dynamics::{Motion, Phase};
    use crate::run::scenario::Preset;
    use crate::run::simulation::{ContactPhase, Record, Simulation};
    use std::error::Error as _;

    /// The start of a preset, as if its run failed in this phase.
    fn failed(preset: &str, phase: Phase) -> Box<FailurePoint> {
        let scenario = Preset::find(preset).unwrap().scenario().unwrap();
        let mut records = Simulation::new(&scenario).unwrap();
        let motion = records.find_map(|record| match record.unwrap() {
            Record::Event(event) => Some(event.motion),
            Record::Sample(_) | Record::Nutation(_) | Record::Impact(_) => None,
        });
        Box::new(FailurePoint {
            time: 0.028_059_149_653_138_91,
            steps: 1234,
            motion: Motion {
                phase,
                ..motion.unwrap()
            },
            is_free: scenario.model.support.is_free(),
        })
    }

    fn stalled(at: Box<FailurePoint>) -> SimulationError {
        SimulationError::Stalled {
            at,
            stall: Stall::TinySteps {
                steps: 1_000_000,
                limit: 0.05,
            },
        }
    }

    fn integration(at: Box<FailurePoint>, guard: Option<Guard>) -> SimulationError {
        SimulationError::Integration {
            at,
            guard,
            source: IntegrateError::NonFiniteState { t: 1.5 },
        }
    }

    /// Each kind of failure: where, how many steps, the phase, and the remedy.
    #[test]
    fn errors_name_place_steps_phase_and_remedy() {
        use Phase::{Flying, Sliding, Sticking};
        let alternates = Stall::Alternates {
            contacts: [Sliding, Sticking]
                .map(|phase| ContactPhase {
                    phase,
                    is_free: true,
                })
                .to_vec(),
        };
        for (error, expected) in [
            (
                stalled(failed("contensou", Sliding)),
                "the simulation stalled at t = 0.0280591 s, after 1234 steps, while the contact point slips (θ = 0.5 rad, turning at 172 rad/s): 1000000 steps advanced it by less than 0.05 s; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                integration(failed("free-paper", Flying), Some(Guard::Gap)),
                "the impact can't be computed at t = 0.0280591 s, after 1234 steps, while the peg is in the air (θ = 0.5 rad, turning at 172 rad/s): the state or its derivative is not finite; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                SimulationError::Stalled {
                    at: failed("free-paper", Sticking),
                    stall: alternates,
                },
                "the simulation stalled at t = 0.0280591 s, after 1234 steps, while the peg rolls (θ = 0.5 rad, turning at 172 rad/s): sliding and rolling alternate without end; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                integration(failed("full-coulomb", Sliding), None),
                "the motion can't be integrated further at t = 0.0280591 s, after 1234 steps, while the contact point slips (θ = 0.5 rad, turning at 172 rad/s): the state or its derivative is not finite; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                SimulationError::TooManySamples,
                "the run has more than 4294967295 samples: set a longer sampling.period or a shorter stop.duration",
            ),
        ] {
            assert_eq!(error.to_string(), expected);
        }
    }

    #[test]
    fn failure_at_the_start_has_no_earlier_end() {
        let mut at = failed("paper", Phase::Sliding);
        at.time = 0.0;
        let text = stalled(at).to_string();
        assert!(text.contains(" at t = 0 s, "), "{text}");
        assert!(
            text.ends_with("; initial rates may be too large, or moments of inertia too small")
        );
    }

    #[test]
    fn keeps_the_error_of_the_integrator() {
        let error = integration(failed("full-coulomb", Phase::Sliding), None);
        let kept = error.source().and_then(|source| source.downcast_ref());
        assert_eq!(kept, Some(&IntegrateError::NonFiniteState { t: 1.5 }));
    }

    #[test]
    fn only_a_closing_gap_is_an_impact() {
        for (guard, is_impact) in [
            (Guard::Gap, true),
            (Guard::Slip, false),
            (Guard::Grip, false),
            (Guard::Regular, false),
        ] {
            let text = integration(failed("drop", Phase::Flying), Some(guard)).to_string();
            assert_eq!(text.contains("impact"), is_impact, "{text}");
        }
    }
}
