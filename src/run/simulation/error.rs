//! Reasons why a motion can't be computed further.

use super::failure_point::{ContactPhase, FailurePoint, short};
use crate::physics::dynamics::{Guard, Phase};
use crate::physics::integrate::{IntegrateError, Tolerances};
use thiserror::Error;

/// Reason why a motion can't be computed further. An interrupted run is no error: it ends with
/// [`StopReason::Interrupted`](super::StopReason::Interrupted).
#[derive(Clone, Debug, PartialEq, Error)]
pub enum SimulationError {
    /// The equations of motion can't be integrated.
    #[error(
        "the motion can't be integrated further at {at}: {source}; {}, or initial rates may be too large{}",
        at.suspects(),
        at.earlier_end()
    )]
    Integration {
        /// The end of the last step.
        at: Box<FailurePoint>,
        /// The error of the integrator.
        source: IntegrateError,
    },
    /// The next phase of the motion can't be computed.
    #[error(
        "{} can't be computed at {at}: {reason}; {}{}",
        transition_name(*guard),
        // Friction acts in an impact, too.
        at.suspects_of(true),
        at.earlier_end()
    )]
    Transition {
        /// The end of the phase.
        at: Box<FailurePoint>,
        /// The guard that ended the phase: [`Guard::Gap`] for an impact.
        guard: Guard,
        /// The error of the integrator. Its independent variable is the impulse of the impact, relative to that of a mass
        /// of the top's size.
        reason: IntegrateError,
    },
    /// Very many steps hardly advance the run.
    #[error(
        "the simulation stalled at {at}: {steps} steps advanced it by less than {advance} s and turned the top by {} rad each; {}{}",
        short(*turn, 1),
        cause_of_stall(at, *turn),
        at.earlier_end()
    )]
    TinySteps {
        /// The end of the last step.
        at: Box<FailurePoint>,
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
        "the simulation stalled at {at}: {} without end; {}{}",
        alternation(contacts),
        cause_of_alternation(at, contacts, *tolerances),
        at.earlier_end()
    )]
    Alternates {
        /// The beginning of the last phase.
        at: Box<FailurePoint>,
        /// The different contacts of these phases.
        contacts: Vec<ContactPhase>,
        /// The tolerances of the run.
        tolerances: Tolerances,
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
            | Self::Transition { at, .. }
            | Self::TinySteps { at, .. }
            | Self::Alternates { at, .. } => Some(at.time),
            Self::TooManySamples => None,
        }
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
fn cause_of_stall(at: &FailurePoint, turn: f64) -> String {
    if turn >= TURN_OF_FAST_ROTATION {
        "the rotation needs them: initial rates may be too large, or moments of inertia too small"
            .to_owned()
    } else {
        format!(
            "the forces change much faster than the top moves: {}",
            at.suspects()
        )
    }
}

/// Tolerance above which a contact may chatter because of the integration error alone.
const CHATTERING_TOLERANCE: f64 = 1e-9;

/// A clause that names what may make phases alternate, and the keys that change it.
fn cause_of_alternation(
    at: &FailurePoint,
    contacts: &[ContactPhase],
    tolerances: Tolerances,
) -> String {
    let mut causes = Vec::new();
    if tolerances.relative.max(tolerances.absolute) > CHATTERING_TOLERANCE {
        causes.push("tolerances below 1e-9 (integrator.absolute_tolerance and integrator.relative_tolerance) may resolve it".to_owned());
    }
    if contacts
        .iter()
        .any(|contact| contact.phase == Phase::Flying)
    {
        // A fast rotation presses the peg onto the table, so that bounces take hardly any time.
        causes.push("initial rates may be too large".to_owned());
    }
    causes.push(at.suspects());
    causes.join("; ")
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
    use crate::physics::dynamics::Motion;
    use crate::run::scenario::{Preset, Scenario};
    use crate::run::simulation::{Record, Simulation};
    use std::error::Error as _;

    /// The start of a preset with some keys set otherwise, as if its run failed in this phase.
    fn failed(preset: &str, keys: &[(&str, &str)], phase: Phase) -> Box<FailurePoint> {
        let mut values = Preset::find(preset).unwrap().values().unwrap();
        for (key, value) in keys {
            values.set(key, value).unwrap();
        }
        let scenario = Scenario::new(values).unwrap();
        let mut records = Simulation::new(&scenario).unwrap();
        let motion = records.find_map(|record| match record.unwrap() {
            Record::Event(event) => Some(event.motion),
            Record::Sample(_) | Record::Nutation(_) | Record::Impact(_) => None,
        });
        Box::new(FailurePoint {
            time: 0.028_059_149_653_138_91,
            motion: Motion {
                phase,
                ..motion.unwrap()
            },
            model: scenario.model,
        })
    }

    fn stalled(at: Box<FailurePoint>, turn: f64) -> SimulationError {
        SimulationError::TinySteps {
            at,
            steps: 1_000_000,
            advance: 0.05,
            turn,
        }
    }

    fn impact(at: Box<FailurePoint>) -> SimulationError {
        SimulationError::Transition {
            at,
            guard: Guard::Gap,
            reason: IntegrateError::StepSizeUnderflow {
                t: 0.006_344_444_064_771,
                step: 1e-19,
            },
        }
    }

    fn alternating(
        at: Box<FailurePoint>,
        is_free: bool,
        phases: &[Phase],
        tolerance: f64,
    ) -> SimulationError {
        SimulationError::Alternates {
            at,
            contacts: contacts(is_free, phases),
            tolerances: Tolerances {
                relative: tolerance,
                absolute: tolerance,
            },
        }
    }

    fn contacts(is_free: bool, phases: &[Phase]) -> Vec<ContactPhase> {
        let contact = |&phase| ContactPhase { phase, is_free };
        phases.iter().map(contact).collect()
    }

    /// Each kind of failure: what, when, the motion, and the keys that act in the phase.
    #[test]
    fn errors_name_what_acts_and_what_to_change() {
        use Phase::{Flying, Sliding, Sticking};
        let tanh = [
            ("friction.law", "coulomb-tanh"),
            ("friction.smoothing_speed", "1e-8"),
        ];
        let air = [("air.axial", "1e-2")];
        let rolling = [
            ("rolling.arm", "1e-4"),
            ("friction.law", "none"),
            ("friction.k", ""),
            ("friction.dissipation", ""),
        ];
        for (name, error, expected) in [
            (
                "stall under Contensou friction",
                stalled(failed("contensou", &[], Sliding), 2e-8),
                "the simulation stalled at t = 0.0280591 s, while the contact point slips (θ = 0.5 rad, turning at 172 rad/s, contact point moving at 0.571 m/s): 1000000 steps advanced it by less than 0.05 s and turned the top by 2e-8 rad each; the forces change much faster than the top moves: friction.patch_radius or moments of inertia may be too small, or friction.k too large; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                "stall under viscous friction",
                stalled(failed("viscous", &[], Sliding), 2e-8),
                "friction.viscous_speed or moments of inertia may be too small, or friction.k too large",
            ),
            (
                "stall under Stribeck friction",
                stalled(failed("stribeck", &[], Sliding), 2e-8),
                "friction.stribeck_speed or moments of inertia may be too small, or friction.static_k too large",
            ),
            (
                "stall in the air",
                stalled(failed("free-paper", &air, Flying), 2e-8),
                "top moves: moments of inertia may be too small, or air.axial too large; a stop",
            ),
            (
                "stall by losses",
                stalled(failed("free-paper", &rolling, Sliding), 2e-8),
                "top moves: moments of inertia may be too small, or rolling.arm too large; a stop",
            ),
            (
                "stall of a fast rotation",
                stalled(failed("paper", &[], Sliding), 0.04),
                "turned the top by 0.04 rad each; the rotation needs them: initial rates may be too large, or moments of inertia too small; a stop",
            ),
            (
                "impact",
                impact(failed("free-paper", &tanh, Flying)),
                "the impact can't be computed at t = 0.0280591 s, while the peg is in the air (θ = 0.5 rad, turning at 172 rad/s, contact point moving at 0.571 m/s): the solution is singular, discontinuous or too steep (step size underflow); friction.smoothing_speed or moments of inertia may be too small, or friction.k too large; a stop.duration of at most 0.0280591 s ends the run before",
            ),
            (
                "flights",
                alternating(failed("drop", &[], Flying), true, &[Flying], 1e-12),
                "phases of flight alternate without end; initial rates may be too large; moments of inertia may be too small; a stop",
            ),
            (
                "slip and roll",
                alternating(
                    failed("free-paper", &[], Sticking),
                    true,
                    &[Sliding, Sticking],
                    1e-4,
                ),
                "while the peg rolls (θ = 0.5 rad, turning at 172 rad/s): sliding and rolling alternate without end; tolerances below 1e-9 (integrator.absolute_tolerance and integrator.relative_tolerance) may resolve it; moments",
            ),
            (
                "integration",
                SimulationError::Integration {
                    at: failed("full-coulomb", &[], Sliding),
                    source: IntegrateError::NonFiniteState { t: 1.5 },
                },
                "the motion can't be integrated further at t = 0.0280591 s, while the contact point slips (θ = 0.5 rad, turning at 172 rad/s, contact point moving at 0.571 m/s): the state or its derivative is not finite; moments of inertia may be too small, or friction.k too large, or initial rates may be too large; a stop",
            ),
            (
                "samples",
                SimulationError::TooManySamples,
                "the run has more than 4294967295 samples: set a longer sampling.period or a shorter stop.duration",
            ),
        ] {
            let text = error.to_string();
            assert!(text.contains(expected), "{name}: {text}");
            let is_of_motion = error.time().is_some();
            assert_eq!(
                is_of_motion,
                text.matches("t = ").count() == 1,
                "{name}: {text}"
            );
        }
    }

    #[test]
    fn failure_at_the_start_has_no_earlier_end() {
        let mut at = failed("paper", &[], Phase::Sliding);
        at.time = 0.0;
        let text = stalled(at, 2e-8).to_string();
        assert!(text.contains("at t = 0 s, "), "{text}");
        assert!(!text.contains("stop.duration"), "{text}");
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
            at: failed("paper", &[], Phase::Sliding),
            source,
        };
        let kept = error.source().and_then(|source| source.downcast_ref());
        assert_eq!(kept, Some(&source));
    }

    #[test]
    fn only_a_closing_gap_is_an_impact() {
        let error = |guard| SimulationError::Transition {
            at: failed("drop", &[], Phase::Flying),
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
