//! The simulation loop: take a step, locate events, yield records in time order.

mod phases;
mod sampling;
mod unfinished;
mod zeros;

use super::error::SimulationError;
use super::event::{Consequences, EventKind, StopReason, consequences};
use super::failure_point::{ContactPhase, FailurePoint};
use super::nutation::NutationTracker;
use super::progress::Progress;
use super::queue::{Queue, TimedMotion};
use super::record::{Record, RunEnd};
use super::sample::Sample;
use super::tally::Tally;
use super::watch::{WatchedFunction, watched_functions};
use crate::physics::dynamics::{Entry, Formulation, Model, Motion, Phase, Transition};
use crate::physics::friction::FrictionLaw;
use crate::physics::integrate::{Dense, Dop853, IntegrateError, Tolerances};
use crate::physics::kinematics::Euler;
use crate::run::scenario::{Scenario, Stop};
use crate::run::time::{nanoseconds, seconds};

/// A run in any formulation.
pub(super) trait RecordStream {
    /// The next record. `None` after the last, or if `carry_on`, which is called before each step, returns false.
    fn next_record(
        &mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Record>, SimulationError>;

    /// State of the run so far.
    fn end(&self) -> RunEnd;
}

/// Level of detail of a run. It does not affect steps or events.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// All that is recorded.
    All,
    /// Only events and nutations, as needed for an outcome.
    Outcome,
    /// Only the motion: no events but those that end a phase or the run.
    Motion,
}

impl Detail {
    /// The functions that are watched in a phase.
    fn watched_functions<F: Formulation<N>, const N: usize>(
        self,
        stop: &Stop,
        system: &F,
    ) -> Vec<WatchedFunction> {
        let mut watched = watched_functions(stop, system);
        match self {
            Self::All | Self::Outcome => {}
            Self::Motion => watched.retain(|function| function.kind.may_end(stop)),
        }
        watched
    }
}

/// A run in one formulation.
pub(super) struct Runner<F, const N: usize> {
    integrator: Dop853<F, N>,
    detail: Detail,
    period_ns: u64,
    stop: Stop,
    /// Tolerances of the motion; those of the steps may be stricter.
    tolerances: Tolerances,
    /// The sense of the precession: +1 or −1.
    sense: f64,
    /// Whether the precession has turned backward, and not forward again.
    is_looping: bool,
    watched: Vec<WatchedFunction>,
    nutation: NutationTracker,
    /// The current step; `None` before the first.
    dense: Option<Dense<N>>,
    /// Euler angles at the start of that step.
    reference: Euler,
    /// Pending events of that step.
    queue: Queue,
    next_sample: u32,
    progress: Progress,
    energy_at_start: f64,
    /// The early end of that step, if it has one.
    early_end: Option<EarlyEnd<F, N>>,
    /// The motion at the last record.
    last: TimedMotion,
    /// Set when the run has ended.
    stopped: Option<StopReason>,
}

/// The early end of a step.
#[derive(Clone, Debug, PartialEq)]
struct EarlyEnd<F, const N: usize> {
    /// Time, s.
    time: f64,
    action: Action<F, N>,
}

/// Consequence of the early end of a step.
#[derive(Clone, Debug, PartialEq)]
enum Action<F, const N: usize> {
    /// The run ends.
    Stop {
        reason: StopReason,
        /// The motion after a change such as an impact; otherwise it follows from the step.
        after: Option<Motion>,
    },
    /// The next phase begins.
    Enter(Entry<F, N>),
}

impl<F, const N: usize> EarlyEnd<F, N> {
    /// The end of the run with the motion of the step.
    fn stop(time: f64, reason: StopReason) -> Self {
        Self {
            time,
            action: Action::Stop {
                reason,
                after: None,
            },
        }
    }
}

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    pub(super) fn new(scenario: &Scenario, detail: Detail) -> Result<Self, SimulationError> {
        let (formulation, state, transition) = F::start(&scenario.model, &scenario.start());
        let motion = formulation.motion(&state, scenario.angles);
        let mut queue = Queue::default();
        queue.push_event(EventKind::Start, 0.0, motion);
        let Consequences { event, mut stop } = transition.map(consequences).unwrap_or_default();
        let rests = transition == Some(Transition::Rests);
        let sticks = motion.phase == Phase::Sticking && scenario.model.support.is_free();
        if sticks && !rests {
            queue.push_event(EventKind::RollBegins, 0.0, motion);
        }
        // A top that pivots rolls already.
        if let Some(kind) = event {
            queue.push_event(kind, 0.0, motion);
        }
        if sticks && !scenario.stop.may_stick {
            stop = stop.or(Some(StopReason::SlipStopped));
        }
        let tolerances = F::step_tolerances(scenario.tolerances);
        let at = failure_point(&formulation, 0, 0.0, motion);
        let integrator = Dop853::new(formulation, 0.0, state, tolerances).map_err(|source| {
            SimulationError::Integration {
                at,
                guard: None,
                source,
            }
        })?;
        let energy_at_start = scenario.model.energy(&motion);
        // Slow regular precession has the sense of the rotation about the axis.
        let sense = if motion.tilt.axial_rate() < 0.0 {
            -1.0
        } else {
            1.0
        };
        Ok(Self {
            watched: detail.watched_functions(&scenario.stop, integrator.system()),
            integrator,
            detail,
            period_ns: scenario.sample_period_ns,
            stop: scenario.stop,
            tolerances: scenario.tolerances,
            sense,
            is_looping: false,
            nutation: NutationTracker::new(scenario.model.clone(), 0.0, motion),
            dense: None,
            reference: scenario.angles,
            queue,
            next_sample: 0,
            progress: Progress::default(),
            energy_at_start,
            early_end: stop.map(|reason| EarlyEnd::stop(0.0, reason)),
            last: TimedMotion { time: 0.0, motion },
            stopped: None,
        })
    }

    fn model(&self) -> &Model {
        self.integrator.system().model()
    }

    /// Takes a step and queues its events.
    fn step(&mut self) -> Result<(), SimulationError> {
        let (system, state) = (self.integrator.system(), self.integrator.y());
        self.reference = system.angles(state, self.reference);
        // Densely, because events and samples are read from the dense output, whose error has to be controlled as well.
        if let Err(source) = self.integrator.step_densely() {
            return self.end_at_singularity(source);
        }
        let time = self.integrator.t();
        if let Err(stall) = self.progress.record_step(time) {
            let system = self.integrator.system();
            let motion = system.motion(self.integrator.y(), self.reference);
            let at = failure_point(system, self.steps(), time, motion);
            return Err(SimulationError::Stalled { at, stall });
        }
        self.check_formula()?;
        let dense = self.integrator.dense();
        let mut zeros = self.find_zeros(&dense);
        self.discard_unfinished_turns(&dense, &mut zeros);
        let mut remaining = zeros.into_iter();
        for zero in remaining.by_ref() {
            if let Err(error) = self.handle_zero(&dense, zero) {
                let time = dense.t0 + zero.s * dense.h;
                // What can't be computed is no reason to fail if the run ends before.
                if self.stop.duration.is_some_and(|duration| duration < time) {
                    break;
                }
                return Err(error);
            }
            if self.early_end.is_some() {
                break;
            }
        }
        // The next step starts where this one ends: what lies behind that has not happened.
        self.reset_trackers(remaining);
        self.end_at_duration(&dense);
        self.dense = Some(dense);
        Ok(())
    }

    /// Checks a friction law that is a formula at the end of the step: only a person knows what it was meant for.
    fn check_formula(&self) -> Result<(), SimulationError> {
        let system = self.integrator.system();
        let model = system.model();
        let is_formula = matches!(model.friction.law, FrictionLaw::Formula { .. });
        if !is_formula || system.phase() != Phase::Sliding {
            return Ok(());
        }
        let motion = system.motion_without_turns(self.integrator.y(), self.reference);
        let speed = motion.slip_velocity(&model.top).norm();
        model.friction.law.check(speed).map_err(|source| {
            let (time, steps) = (self.integrator.t(), self.steps());
            SimulationError::Coefficient {
                at: failure_point(system, steps, time, motion),
                source,
            }
        })
    }

    /// Number of steps so far.
    fn steps(&self) -> u64 {
        self.integrator.statistics().accepted
    }

    /// Ends the run where no further step is possible, if the singularity is that of a transition.
    #[cold]
    fn end_at_singularity(&mut self, source: IntegrateError) -> Result<(), SimulationError> {
        let (time, state) = (self.integrator.t(), *self.integrator.y());
        let system = self.integrator.system();
        let end = system.singularity(&state).map(consequences);
        let motion = system.motion(&state, self.reference);
        let Some(Consequences {
            event,
            stop: Some(reason),
        }) = end
        else {
            return Err(SimulationError::Integration {
                at: failure_point(system, self.steps(), time, motion),
                guard: None,
                source,
            });
        };
        if let Some(kind) = event {
            self.queue.push_event(kind, time, motion);
        }
        let action = Action::Stop {
            reason,
            after: Some(motion),
        };
        self.early_end = Some(EarlyEnd { time, action });
        // The last step has been sampled, and doesn't reach a sample that only rounding puts before the end.
        self.dense = None;
        Ok(())
    }

    /// Ends the run if `stop.duration` lies within this step.
    fn end_at_duration(&mut self, dense: &Dense<N>) {
        let Some(duration) = self.stop.duration else {
            return;
        };
        let step_end = dense.t0 + dense.h;
        // What ends the step earlier also ends its equations.
        let earliest = self.early_end.as_ref().map_or(step_end, |end| end.time);
        if duration <= earliest {
            let after = self
                .early_end
                .as_ref()
                .filter(|end| end.time <= duration)
                .and_then(|end| match &end.action {
                    Action::Enter(entry) => motion_after_change(entry),
                    Action::Stop { after, .. } => *after,
                });
            self.early_end = Some(EarlyEnd {
                time: duration,
                action: Action::Stop {
                    reason: StopReason::Duration,
                    after,
                },
            });
            self.queue.discard_after(duration);
        }
    }

    /// The motion without integrals (0) and without unwrapping φ and ψ; sufficient for event location.
    #[inline]
    fn motion_without_integrals(&self, dense: &Dense<N>, s: f64) -> Motion {
        let state = dense.first_at(F::CONTROLLED, s);
        let system = self.integrator.system();
        system.motion_without_turns(&state, self.reference)
    }

    #[inline]
    fn motion(&self, dense: &Dense<N>, s: f64) -> Motion {
        self.integrator
            .system()
            .motion(&dense.at(s), self.reference)
    }

    /// The time of the next sample, if it has been integrated and is not after the end.
    fn next_sample_time(&self) -> Option<u64> {
        let time_ns = u64::from(self.next_sample) * self.period_ns;
        let reached = match (&self.early_end, &self.dense) {
            (Some(end), _) => time_ns <= nanoseconds(end.time),
            (None, Some(dense)) => seconds(time_ns) <= dense.t0 + dense.h,
            (None, None) => seconds(time_ns) <= self.integrator.t(),
        };
        reached.then_some(time_ns)
    }

    fn sample(&mut self, time_ns: u64) -> Result<Record, SimulationError> {
        let time = seconds(time_ns);
        let (sample, motion) = self.sample_at(time, self.next_sample, time_ns);
        self.next_sample = self
            .next_sample
            .checked_add(1)
            .ok_or(SimulationError::TooManySamples)?;
        self.last = TimedMotion { time, motion };
        Ok(Record::Sample(Box::new(sample)))
    }

    /// The sample and the motion at a time in the last step, s; the sample gets this index and this time, ns.
    fn sample_at(&self, time: f64, index: u32, time_ns: u64) -> (Sample, Motion) {
        let state = match &self.dense {
            Some(dense) => dense.at((time - dense.t0) / dense.h),
            None => *self.integrator.y(),
        };
        let system = self.integrator.system();
        let motion = system.motion(&state, self.reference);
        let rotation = system.world_from_body(&state);
        let sample = Sample::new(index, time_ns, system.model(), &motion, rotation);
        (sample, motion)
    }

    /// Continues when all records of a step are emitted: stops, enters the next phase, or takes a step. Returns false
    /// if `carry_on` does.
    fn advance(&mut self, carry_on: &mut dyn FnMut() -> bool) -> Result<bool, SimulationError> {
        let advanced = match self.early_end.take() {
            Some(EarlyEnd { time, action }) => match action {
                Action::Stop { reason, after } => {
                    self.stop(time, reason, after);
                    Ok(())
                }
                Action::Enter(entry) => self.enter(time, &entry),
            },
            None if carry_on() => self.step(),
            None => return Ok(false),
        };
        if let Err(error) = advanced {
            self.stopped = Some(StopReason::Failed);
            self.last = error.time().map_or(self.last, |time| self.failure_at(time));
            return Err(error);
        }
        Ok(true)
    }

    /// A time in the last step at which the run failed, and the motion then.
    #[cold]
    fn failure_at(&mut self, time: f64) -> TimedMotion {
        let dense = self.integrator.dense();
        let motion = if time < self.integrator.t() {
            self.motion(&dense, (time - dense.t0) / dense.h)
        } else {
            let system = self.integrator.system();
            system.motion(self.integrator.y(), self.reference)
        };
        TimedMotion { time, motion }
    }

    /// Runs to the end. Returns the end and the event counts.
    pub(super) fn run_without_samples(
        mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<(RunEnd, Tally), SimulationError> {
        let mut tally = Tally::default();
        loop {
            // Events need not wait for the samples before them.
            self.last = self.queue.count_all(&mut tally).unwrap_or(self.last);
            if self.stopped.is_some() || !self.advance(carry_on)? {
                return Ok((RecordStream::end(&self), tally));
            }
        }
    }

    /// Ends the run after all records were emitted.
    fn stop(&mut self, time: f64, reason: StopReason, after: Option<Motion>) {
        let motion = match (after, &self.dense) {
            (Some(after), _) => Some(after),
            (None, Some(dense)) => Some(self.motion(dense, (time - dense.t0) / dense.h)),
            // A run that ends at its start has no step.
            (None, None) => None,
        };
        if let Some(motion) = motion {
            self.last = TimedMotion { time, motion };
        }
        self.stopped = Some(reason);
    }
}

impl<F: Formulation<N>, const N: usize> RecordStream for Runner<F, N> {
    fn next_record(
        &mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Record>, SimulationError> {
        while self.stopped.is_none() {
            let sample = self.next_sample_time();
            let event = self.queue.next_time_ns();
            // A sample precedes an event of the same nanosecond: it shows the motion before it.
            if let Some(time_ns) = sample
                && event.is_none_or(|event| time_ns <= event)
            {
                return self.sample(time_ns).map(Some);
            }
            if let Some(record) = self.queue.pop() {
                if let Record::Event(event) = &record {
                    self.last = TimedMotion {
                        time: event.time,
                        motion: event.motion,
                    };
                }
                return Ok(Some(record));
            }
            if !self.advance(carry_on)? {
                return Ok(None);
            }
        }
        Ok(None)
    }

    fn end(&self) -> RunEnd {
        let TimedMotion { time, motion } = self.last;
        RunEnd {
            stop: self.stopped.unwrap_or(StopReason::Interrupted),
            time,
            motion,
            energy: self.model().energy(&motion),
            energy_at_start: self.energy_at_start,
            samples: u64::from(self.next_sample),
            events: u64::from(self.queue.events),
            nutations: u64::from(self.queue.cycles),
            impacts: u64::from(self.queue.impacts),
            inversion_time: self.queue.inversion,
            statistics: *self.integrator.statistics(),
        }
    }
}

fn contact_phase<F: Formulation<N>, const N: usize>(system: &F) -> ContactPhase {
    ContactPhase {
        phase: system.phase(),
        is_free: system.model().support.is_free(),
    }
}

fn failure_point<F: Formulation<N>, const N: usize>(
    system: &F,
    steps: u64,
    time: f64,
    motion: Motion,
) -> Box<FailurePoint> {
    Box::new(FailurePoint {
        time,
        steps,
        motion,
        is_free: system.model().support.is_free(),
    })
}

/// The motion after an impact or after coming to rest; `None` if the phase begins without a change.
fn motion_after_change<F, const N: usize>(entry: &Entry<F, N>) -> Option<Motion> {
    let is_changed = entry.impact.is_some() || entry.transition == Transition::Rests;
    is_changed.then_some(entry.motion)
}
