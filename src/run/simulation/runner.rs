//! The simulation loop: take a step, locate events, yield records in time order.

mod sampling;
mod unfinished;

use super::error::{ContactPhase, SimulationError};
use super::event::{EventKind, StopReason, UPRIGHT, consequences};
use super::free::ImpactRecord;
use super::nutation::NutationTracker;
use super::progress::Progress;
use super::queue::{Queue, event_at};
use super::record::{Record, RunEnd};
use super::sample::Sample;
use super::tally::Tally;
use super::watch::{
    Watch, ZeroKind, accelerations, copy_signs, envelope, precession_floor, watches,
};
use crate::physics::dynamics::{Entry, Formulation, Guard, Model, Motion, Phase, Transition};
use crate::physics::friction::Dissipation;
use crate::physics::integrate::{
    Crossing, Dense, Dop853, IntegrateError, KNOTS, Slope, Tolerances,
};
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
    fn watches<F: Formulation<N>, const N: usize>(self, stop: &Stop, system: &F) -> Vec<Watch> {
        let mut watches = watches(stop, system);
        match self {
            Self::All | Self::Outcome => {}
            Self::Motion => watches.retain(|watch| watch.kind.may_end(stop)),
        }
        watches
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
    watches: Vec<Watch>,
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
    /// The time at which the step ends early, if it does, and why.
    end: Option<(f64, EarlyEnd<F, N>)>,
    /// Time and motion of the last record.
    last: (f64, Motion),
    /// Set when the run has ended.
    stopped: Option<StopReason>,
}

/// Reason for ending a step early.
#[derive(Clone, Copy, Debug, PartialEq)]
enum EarlyEnd<F, const N: usize> {
    /// The run ends. The motion is given after an impact; otherwise it follows from the step.
    Stop(StopReason, Option<Motion>),
    /// The next phase begins.
    Enter(Entry<F, N>),
}

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    pub(super) fn new(scenario: &Scenario, detail: Detail) -> Result<Self, SimulationError> {
        let (formulation, state, transition) = F::start(&scenario.model, &scenario.start());
        let motion = formulation.motion(&state, scenario.angles);
        let mut queue = Queue::default();
        queue.push(event_at(EventKind::Start, 0.0, motion));
        let (kind, mut stop) = transition.map_or((None, None), consequences);
        let rests = transition == Some(Transition::Rests);
        let sticks = motion.phase == Phase::Sticking && scenario.model.support.is_free();
        if sticks && !rests {
            queue.push(event_at(EventKind::RollBegins, 0.0, motion));
        }
        // A top that pivots rolls already.
        queue.extend(kind.map(|kind| event_at(kind, 0.0, motion)));
        if sticks && !scenario.stop.may_stick {
            stop = stop.or(Some(StopReason::SlipStopped));
        }
        let end = stop.map(|reason| (0.0, EarlyEnd::Stop(reason, None)));
        let tolerances = F::step_tolerances(scenario.tolerances);
        let integrator = Dop853::new(formulation, 0.0, state, tolerances)
            .map_err(|source| integration_error(&formulation, 0.0, source))?;
        let energy_at_start = scenario.model.energy(&motion);
        let sense = if motion.tilt.axial_rate() < 0.0 {
            -1.0
        } else {
            1.0
        };
        Ok(Self {
            watches: detail.watches(&scenario.stop, integrator.system()),
            integrator,
            detail,
            period_ns: scenario.sample_period_ns,
            stop: scenario.stop,
            tolerances: scenario.tolerances,
            sense,
            is_looping: false,
            nutation: NutationTracker::new(scenario.model, 0.0, motion),
            dense: None,
            reference: scenario.angles,
            queue,
            next_sample: 0,
            progress: Progress::default(),
            energy_at_start,
            end,
            last: (0.0, motion),
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
        let contact = contact_phase(system);
        let stepped = self.integrator.step_densely();
        let time = self.integrator.t();
        stepped.map_err(|source| integration_error(self.integrator.system(), time, source))?;
        let system = self.integrator.system();
        let turning_rate = || {
            let state = self.integrator.y();
            let motion = system.motion_without_turns(state, self.reference);
            motion.tilt.omega_lean.norm()
        };
        self.progress.record_step(time, contact, turning_rate)?;
        let dense = self.integrator.dense();
        let mut crossings = self.crossings(&dense);
        self.discard_unfinished_turns(&dense, &mut crossings);
        let mut crossings = crossings.into_iter();
        for (s, kind, slope) in crossings.by_ref() {
            self.handle_zero(&dense, s, kind, slope)?;
            if self.end.is_some() {
                break;
            }
        }
        self.reset_trackers(crossings);
        self.end_at_duration(&dense);
        self.dense = Some(dense);
        Ok(())
    }

    /// All zeros of the watched functions in a step, in time order.
    fn crossings(&mut self, dense: &Dense<N>) -> Vec<(f64, ZeroKind, Slope)> {
        let (system, sense) = (self.integrator.system(), self.sense);
        let motions = self.motions_at_knots(dense);
        let mut watches = std::mem::take(&mut self.watches);
        let mut found: Vec<Crossing> = Vec::new();
        let mut all = Vec::new();
        for Watch { kind, tracker } in &mut watches {
            let kind = *kind;
            if kind == ZeroKind::Precession {
                let steps = self.integrator.statistics().accepted;
                tracker.set_noise_level(precession_floor(&self.tolerances, steps, &motions));
            }
            let looks_closer = kind == ZeroKind::NutationRate && self.detail == Detail::All;
            let values = if looks_closer {
                let of = |motion: &Motion| accelerations(system.model(), motion);
                let at_knots = motions.each_ref().map(of);
                envelope(
                    |s| of(&self.motion_without_integrals(dense, s)),
                    &at_knots,
                    &mut all,
                );
                at_knots.each_ref().map(|acceleration| acceleration.theta)
            } else {
                kind.values(system, sense, &motions)
            };
            tracker.scan(
                &values,
                |s| {
                    let [value] =
                        kind.values(system, sense, &[self.motion_without_integrals(dense, s)]);
                    value
                },
                &mut found,
            );
            if !found.is_empty() {
                all.extend(found.drain(..).map(|c| (c.s, kind, c.slope)));
            }
        }
        self.watches = watches;
        // Stable: simultaneous events keep the order of the watches.
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// The motions at the [`KNOTS`] of a step.
    fn motions_at_knots(&self, dense: &Dense<N>) -> [Motion; 5] {
        // `map` would move each motion several times.
        let [a, b, c, d, e] = KNOTS;
        let at = |s| self.motion_without_integrals(dense, s);
        [at(a), at(b), at(c), at(d), at(e)]
    }

    /// Handles a zero of a watched function.
    fn handle_zero(
        &mut self,
        dense: &Dense<N>,
        s: f64,
        kind: ZeroKind,
        slope: Slope,
    ) -> Result<(), SimulationError> {
        let motion = self.motion(dense, s);
        let time = dense.t0 + s * dense.h;
        let mut event = |kind| self.queue.push(event_at(kind, time, motion));
        match (kind, slope) {
            (ZeroKind::Nutation, slope) => {
                let is_of_nutation = self.nutation.record_extreme(time, &motion);
                match slope {
                    Slope::Rising if motion.angles.theta < UPRIGHT => {
                        event(EventKind::UprightPassage);
                    }
                    Slope::Rising if is_of_nutation => event(EventKind::NutationMinimum),
                    Slope::Falling if is_of_nutation => event(EventKind::NutationMaximum),
                    Slope::Rising | Slope::Falling => {}
                }
            }
            (ZeroKind::NutationRate, Slope::Rising) | (ZeroKind::Envelope, _) => {
                self.nutation.record_rates(&motion);
            }
            (ZeroKind::NutationRate, Slope::Falling) => {
                let cycle = self.nutation.end_cycle(time, nanoseconds(time), motion);
                self.queue
                    .extend(cycle.map(|cycle| Record::Nutation(Box::new(cycle))));
            }
            (ZeroKind::Precession, Slope::Falling) => {
                self.is_looping = true;
                event(EventKind::LoopingBegins);
            }
            (ZeroKind::Precession, Slope::Rising) => {
                // A precession that starts backward has not begun a loop.
                if std::mem::take(&mut self.is_looping) {
                    event(EventKind::LoopingEnds);
                }
            }
            (ZeroKind::Strength, Slope::Falling) => event(EventKind::WeakTop),
            (ZeroKind::Strength, Slope::Rising) => event(EventKind::StrongTop),
            (ZeroKind::Risen(_), Slope::Falling) => {
                event(EventKind::Risen);
                self.end = Some((time, EarlyEnd::Stop(StopReason::Risen, None)));
            }
            (ZeroKind::Fallen(_), Slope::Rising) => {
                event(EventKind::Fallen);
                if self.stop.theta_fallen.is_some() {
                    self.end = Some((time, EarlyEnd::Stop(StopReason::Fallen, None)));
                }
            }
            (ZeroKind::Guard(guard), Slope::Falling) => {
                return self.end_phase(guard, time, &dense.at(s), motion);
            }
            (ZeroKind::Inversion, Slope::Rising) => event(EventKind::Inverts),
            (ZeroKind::Risen(_) | ZeroKind::Guard(_), Slope::Rising)
            | (ZeroKind::Fallen(_) | ZeroKind::Inversion, Slope::Falling) => {}
        }
        Ok(())
    }

    /// Handles the end of a phase: starts the next phase or ends the run.
    fn end_phase(
        &mut self,
        guard: Guard,
        time: f64,
        state: &[f64; N],
        motion: Motion,
    ) -> Result<(), SimulationError> {
        let stops_at_rest = !self.stop.may_stick;
        let system = *self.integrator.system();
        let entered = system.enter(guard, state, self.reference);
        let entry = entered.map_err(|reason| SimulationError::Transition {
            time,
            guard,
            reason,
        })?;
        if guard == Guard::Slip && stops_at_rest && stops_slip(&entry) {
            self.queue
                .push(event_at(EventKind::SlipStops, time, motion));
            self.end = Some((time, EarlyEnd::Stop(StopReason::SlipStopped, None)));
            return Ok(());
        }
        // Rates may jump here: both sides are candidates for their extremes.
        self.nutation.record_rates(&motion);
        let at = time + entry.delay;
        self.queue_entry_events(&entry, system.phase(), at);
        let sticks = entry.formulation.phase() == Phase::Sticking;
        let stop = consequences(entry.transition).1;
        let end = match stop.or((stops_at_rest && sticks).then_some(StopReason::SlipStopped)) {
            None => EarlyEnd::Enter(entry),
            Some(reason) => EarlyEnd::Stop(reason, after_impact(&entry)),
        };
        self.end = Some((at, end));
        Ok(())
    }

    /// Queues the events at the start of a phase.
    fn queue_entry_events(&mut self, entry: &Entry<F, N>, before: Phase, time: f64) {
        let motion = entry.motion;
        let event = |kind| event_at(kind, time, motion);
        let kind = consequences(entry.transition).0;
        // A peg lands, or rolls already, before it rests or pivots.
        let is_last = matches!(
            entry.transition,
            Transition::Pivots { .. } | Transition::Rests
        );
        if !is_last {
            self.queue.extend(kind.map(event));
        }
        if !self.model().support.is_free() {
            if is_last {
                self.queue.extend(kind.map(event));
            }
            return;
        }
        let after = entry.formulation.phase();
        if before == Phase::Sticking && after != Phase::Sticking {
            self.queue.push(event(EventKind::RollEnds));
        }
        if before != Phase::Flying && after == Phase::Flying {
            self.queue.push(event(EventKind::LiftOff));
        }
        if let Some(hit) = &entry.impact {
            let impact = ImpactRecord::new(hit, &motion, time, nanoseconds(time));
            self.queue.push(Record::Impact(Box::new(impact)));
        }
        if before == Phase::Flying && after != Phase::Flying {
            self.queue.push(event(EventKind::Landing));
        }
        let rests = entry.transition == Transition::Rests;
        if before != Phase::Sticking && after == Phase::Sticking && !rests {
            self.queue.push(event(EventKind::RollBegins));
        }
        if is_last {
            self.queue.extend(kind.map(event));
        }
    }

    /// Ends the run if `stop.duration` lies within this step.
    fn end_at_duration(&mut self, dense: &Dense<N>) {
        let Some(duration) = self.stop.duration else {
            return;
        };
        let step_end = dense.t0 + dense.h;
        // What ends the step earlier also ends its equations.
        let earliest = self.end.map_or(step_end, |(time, _)| time);
        if duration <= earliest {
            let after = match &self.end {
                Some((time, EarlyEnd::Enter(entry))) if *time <= duration => after_impact(entry),
                Some((time, EarlyEnd::Stop(_, after))) if *time <= duration => *after,
                _ => None,
            };
            self.end = Some((duration, EarlyEnd::Stop(StopReason::Duration, after)));
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
        let reached = match (self.end, &self.dense) {
            (Some((end, _)), _) => time_ns <= nanoseconds(end),
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
        self.last = (time, motion);
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

    /// Starts another phase within the last step.
    #[cold]
    fn enter(&mut self, time: f64, entry: &Entry<F, N>) -> Result<(), SimulationError> {
        let phases = self
            .progress
            .record_phase(time, contact_phase(&entry.formulation))?;
        // Samples up to here have been taken from the dense output.
        self.dense = None;
        let phase = self.integrator.system().phase();
        let system = entry.formulation;
        self.reference = system.angles(&entry.state, self.reference);
        self.integrator
            .restart(system, time, entry.state)
            .map_err(|source| integration_error(&system, time, source))?;
        // If phases repeat immediately, limit the step.
        let quarters = 4_u32.pow((phases - 1).min(10));
        self.integrator
            .limit_next_step(entry.first_step / f64::from(quarters));
        let next = self.detail.watches(&self.stop, &system);
        let before = std::mem::replace(&mut self.watches, next);
        let motion = system.motion(&entry.state, self.reference);
        if self.model().support.is_free() || system.phase() == phase {
            self.nutation.record_impact(time, &motion);
            copy_signs(&before, &mut self.watches);
        } else {
            self.nutation.restart(time, motion);
        }
        self.end = None;
        Ok(())
    }

    /// Continues when all records of a step are emitted: stops, enters the next phase, or takes a step. Returns false
    /// if `carry_on` does.
    fn advance(&mut self, carry_on: &mut dyn FnMut() -> bool) -> Result<bool, SimulationError> {
        let advanced = match self.end {
            Some((time, EarlyEnd::Stop(reason, after))) => {
                self.stop(time, reason, after);
                Ok(())
            }
            Some((time, EarlyEnd::Enter(entry))) => self.enter(time, &entry),
            None if carry_on() => self.step(),
            None => return Ok(false),
        };
        if let Err(error) = advanced {
            self.stopped = Some(StopReason::Failed);
            return Err(error);
        }
        Ok(true)
    }

    /// Runs to the end. Returns the end and the event counts.
    pub(super) fn run_without_samples(
        mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<(RunEnd, Tally), SimulationError> {
        let mut tally = Tally::default();
        loop {
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
            self.last = (time, motion);
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
                    self.last = (event.time, event.motion);
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
        let (time, motion) = self.last;
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

fn integration_error<F: Formulation<N>, const N: usize>(
    system: &F,
    time: f64,
    source: IntegrateError,
) -> SimulationError {
    SimulationError::Integration {
        time,
        contact: contact_phase(system),
        source,
    }
}

/// The motion after an impact or after coming to rest; `None` if the phase begins without a change.
fn after_impact<F, const N: usize>(entry: &Entry<F, N>) -> Option<Motion> {
    let is_changed = entry.impact.is_some() || entry.transition == Transition::Rests;
    is_changed.then_some(entry.motion)
}

/// Whether a run with `stop.on_stick = "stop"` ends where its contact point stops slipping: friction holds the point, or
/// the equations leave out a part of friction and don't say how the motion goes on.
fn stops_slip<F: Formulation<N>, const N: usize>(entry: &Entry<F, N>) -> bool {
    let sticks = entry.formulation.phase() == Phase::Sticking;
    let is_complete = entry.formulation.model().friction.dissipation == Dissipation::Full;
    (sticks && entry.transition != Transition::Rests) || !is_complete
}
