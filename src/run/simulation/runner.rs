//! The loop: step, look for events, hand out records in the order of their times.

use super::event::{Event, EventKind, StopReason, UPRIGHT};
use super::free::Landing;
use super::nutation::{NutationCycle, NutationTracker};
use super::record::{Record, RunEnd, SimulationError};
use super::sample::Sample;
use super::tally::Tally;
use super::watch::{
    Meaning, Watch, accelerations, envelope, is_steady_at_knots, keep_signs, watches,
};
use crate::physics::dynamics::{
    Entry, EulerBounds, Formulation, Guard, Model, Motion, Passage, Phase,
};
use crate::physics::integrate::{Crossing, Dense, Direction, Dop853, KNOTS, Slope};
use crate::physics::kinematics::Euler;
use crate::run::scenario::{OnStick, Scenario, Stop};
use std::collections::VecDeque;

/// A run, whatever its formulation.
pub(super) trait RecordStream {
    /// The next record; `None` after the last, or once `carry_on`, which is asked before each step, says no.
    fn next_record(
        &mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<Option<Record>, SimulationError>;

    /// Takes each stretch from one maximum of θ̇ to the next for a nutation, and checks no step.
    fn go_by_first_rules(&mut self);

    /// What has happened so far.
    fn end(&self) -> RunEnd;
}

/// A run has stalled if this many steps advance it by less than [`STALLED_TIME`]: a torque that jumps changes its
/// sign with each of them.
const STALLED_STEPS: u32 = 1_000_000;
/// The time that a run which has not stalled takes at least for [`STALLED_STEPS`], s.
const STALLED_TIME: f64 = 0.05;

/// A run has stalled too if this many phases take it no farther than [`CHATTER_TIME`]: the slowest bounce takes 2e-7 s.
const CHATTER_PHASES: u32 = 1000;
/// The time that a run which has not stalled takes at least for [`CHATTER_PHASES`], s.
const CHATTER_TIME: f64 = 1e-9;

/// How much of a run is looked at. It never changes the steps, nor what happens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Detail {
    /// Everything that is recorded.
    All,
    /// What an outcome counts: events and nutations.
    Outcome,
}

/// A run in one formulation.
pub(super) struct Runner<F, const N: usize> {
    integrator: Dop853<F, N>,
    settings: LoopSettings,
    detail: Detail,
    watches: Vec<Watch>,
    nutation: NutationTracker,
    /// The step that records are being read from; none before the first.
    dense: Option<Dense<N>>,
    /// Euler angles at the start of that step.
    reference: Euler,
    /// Events and cycles within that step that have not been handed out.
    pending: VecDeque<Pending>,
    next_sample: u32,
    events: u32,
    /// Nutation cycles that have been handed out.
    cycles: u32,
    /// Impacts that have been handed out.
    impacts: u32,
    /// Impacts since the peg was last on the table.
    bounces: u32,
    /// Steps since it was last checked that the run advances, and the time of that check, s.
    since_check: (u32, f64),
    /// Phases entered since the run last advanced by [`CHATTER_TIME`], and the time then, s.
    since_phase: (u32, f64),
    energy_at_start: f64,
    /// Where the step is left before its end, once that is known.
    end: Option<(f64, End<F, N>)>,
    /// The time up to which records have been handed out, and the motion there.
    last: (f64, Motion),
    /// Set once nothing more will come.
    stopped: Option<StopReason>,
}

/// What the loop needs of a scenario.
struct LoopSettings {
    period_ns: u64,
    stop: Stop,
    /// The sense of the precession: +1 or −1.
    sense: f64,
}

/// Why a step is left before its end.
#[derive(Clone, Copy, Debug, PartialEq)]
enum End<F, const N: usize> {
    /// The run is over. After an impact this is the motion then; otherwise it is that which the step has there.
    Stop(StopReason, Option<Motion>),
    /// Another phase begins.
    Enter(Entry<F, N>),
}

enum Pending {
    Event(EventKind, f64, Motion),
    /// The peg is on the table again, after this many impacts.
    Landing(u32, f64, Motion),
    Nutation(NutationCycle),
    Impact(Landing),
}

impl Pending {
    fn time_ns(&self) -> u64 {
        match self {
            Self::Event(_, time, _) | Self::Landing(_, time, _) => to_nanoseconds(*time),
            Self::Nutation(cycle) => cycle.time_ns,
            Self::Impact(landing) => landing.time_ns,
        }
    }
}

impl<F: Formulation<N>, const N: usize> Runner<F, N> {
    pub(super) fn new(scenario: &Scenario, detail: Detail) -> Result<Self, SimulationError> {
        let may_hold = scenario.stop.on_stick == OnStick::Continue;
        let (formulation, state, passage) = F::start(&scenario.model, &scenario.start(), may_hold);
        let motion = formulation.motion(&state, scenario.angles);
        let mut pending = VecDeque::from([Pending::Event(EventKind::Start, 0.0, motion)]);
        let kind = passage.and_then(|passage| kind_of(&passage));
        pending.extend(kind.map(|kind| Pending::Event(kind, 0.0, motion)));
        let mut end = None;
        if motion.phase == Phase::Holding && scenario.model.support.is_free() {
            pending.push_back(Pending::Event(EventKind::RollBegins, 0.0, motion));
            end = (!may_hold).then_some((0.0, End::Stop(StopReason::SlipStopped, None)));
        }
        let integrator = Dop853::new(
            formulation,
            0.0,
            state,
            F::step_tolerances(scenario.tolerances),
            Direction::Forward,
        )?;
        let energy_at_start = scenario.model.energy(&motion);
        let sense = if motion.tilt.axial_rate() < 0.0 {
            -1.0
        } else {
            1.0
        };
        let settings = LoopSettings {
            period_ns: scenario.sample_period_ns,
            stop: scenario.stop,
            sense,
        };
        Ok(Self {
            watches: watches(&settings.stop, integrator.system()),
            integrator,
            settings,
            detail,
            nutation: NutationTracker::new(scenario.model, 0.0, motion),
            dense: None,
            reference: scenario.angles,
            pending,
            next_sample: 0,
            events: 0,
            cycles: 0,
            impacts: 0,
            bounces: 0,
            since_check: (0, 0.0),
            since_phase: (0, 0.0),
            energy_at_start,
            end,
            last: (0.0, motion),
            stopped: None,
        })
    }

    fn model(&self) -> &Model {
        self.integrator.system().model()
    }

    /// Takes a step and finds what happens in it.
    fn step(&mut self) -> Result<(), SimulationError> {
        let (system, state) = (self.integrator.system(), self.integrator.y());
        self.reference = system.angles(state, self.reference);
        self.integrator.step_densely()?;
        self.check_advance(self.integrator.t())?;
        let outline = self.integrator.outline();
        let outline = outline.and_then(|outline| self.integrator.system().bounds(&outline));
        if self.detail == Detail::Outcome && outline.is_some_and(|outline| self.is_idle(&outline)) {
            self.dense = None;
            return Ok(());
        }
        let dense = self.integrator.dense();
        let mut crossings = self.crossings(&dense, outline.as_ref()).into_iter();
        for (s, meaning, slope) in crossings.by_ref() {
            self.note(&dense, s, meaning, slope)?;
            if self.end.is_some() {
                break;
            }
        }
        self.take_back(crossings);
        self.end_at_duration(&dense);
        self.dense = Some(dense);
        Ok(())
    }

    /// Whether bounds show that nothing happens in the last step, and that the run goes on after it.
    fn is_idle(&self, bounds: &EulerBounds) -> bool {
        let is_over = |duration| duration <= self.integrator.t();
        !self.settings.stop.duration.is_some_and(is_over)
            && self
                .watches
                .iter()
                .all(|watch| self.is_quiet(watch, bounds))
    }

    /// Whether bounds show that a watched function keeps its sign throughout a step.
    #[inline]
    fn is_quiet(&self, watch: &Watch, bounds: &EulerBounds) -> bool {
        let (system, sense) = (self.integrator.system(), self.settings.sense);
        let keeps = |positive| watch.meaning.keeps_sign(positive, system, sense, bounds);
        watch.tracker.sign().is_some_and(keeps)
    }

    /// Gives watches back the signs that they had where a step is left, before these crossings, which never come.
    fn take_back(&mut self, crossings: impl DoubleEndedIterator<Item = (f64, Meaning, Slope)>) {
        // From the last to the first: what holds is the sign before the first.
        for (_, meaning, slope) in crossings.rev() {
            let watch = self
                .watches
                .iter_mut()
                .find(|watch| watch.meaning == meaning);
            if let Some(watch) = watch {
                watch.tracker = watch.tracker.before(slope);
            }
        }
    }

    /// All zeros of the watched functions in a step, in the order of time. What its outline settles is settled, for
    /// recordings as for outcomes, which may look no further.
    fn crossings(
        &mut self,
        dense: &Dense<N>,
        outline: Option<&EulerBounds>,
    ) -> Vec<(f64, Meaning, Slope)> {
        let (system, sense) = (self.integrator.system(), self.settings.sense);
        let bounds = system.bounds(dense);
        let mut motions = None;
        let mut watches = std::mem::take(&mut self.watches);
        let mut found: Vec<Crossing> = Vec::new();
        let mut all = Vec::new();
        for watch in &mut watches {
            let looks_closer = watch.meaning == Meaning::NutationRate && self.detail == Detail::All;
            let is_quiet = |bounds| self.is_quiet(watch, bounds);
            let is_settled = outline.is_some_and(is_quiet);
            if !looks_closer && (is_settled || bounds.as_ref().is_some_and(is_quiet)) {
                continue;
            }
            let Watch { meaning, tracker } = watch;
            let meaning = *meaning;
            let motions = motions.get_or_insert_with(|| self.motions_at_knots(dense));
            let values = if looks_closer {
                let accelerations = motions
                    .each_ref()
                    .map(|motion| accelerations(system.model(), motion));
                envelope(dense.h, motions, &accelerations, &mut all);
                if is_settled {
                    continue;
                }
                accelerations
                    .each_ref()
                    .map(|acceleration| acceleration.theta)
            } else if meaning == Meaning::NutationRate
                && is_steady_at_knots(dense.h, motions, tracker.sign())
            {
                continue;
            } else {
                meaning.values(system, sense, motions)
            };
            tracker.scan(
                &KNOTS,
                &values,
                |s| {
                    let [value] = meaning.values(system, sense, &[self.motion_alone(dense, s)]);
                    value
                },
                &mut found,
            );
            if !found.is_empty() {
                all.extend(found.drain(..).map(|c| (c.s, meaning, c.slope)));
            }
        }
        self.watches = watches;
        // Stable: simultaneous events keep the order of the watches.
        all.sort_by(|a, b| a.0.total_cmp(&b.0));
        all
    }

    /// The motions at the [`KNOTS`] of a step.
    fn motions_at_knots(&self, dense: &Dense<N>) -> [Motion; 5] {
        // Not `map`, which would move each motion several times.
        let [a, b, c, d, e] = KNOTS;
        let at = |s| self.motion_alone(dense, s);
        [at(a), at(b), at(c), at(d), at(e)]
    }

    /// Turns a zero of a watched function into what it means.
    fn note(
        &mut self,
        dense: &Dense<N>,
        s: f64,
        meaning: Meaning,
        slope: Slope,
    ) -> Result<(), SimulationError> {
        let motion = self.motion(dense, s);
        let time = dense.t0 + s * dense.h;
        let mut event = |kind| self.pending.push_back(Pending::Event(kind, time, motion));
        match (meaning, slope) {
            (Meaning::Nutation, slope) => {
                let is_of_nutation = self.nutation.extreme(time, &motion);
                match slope {
                    Slope::Rising if motion.angles.theta < UPRIGHT => {
                        event(EventKind::UprightPassage);
                    }
                    Slope::Rising if is_of_nutation => event(EventKind::NutationMinimum),
                    Slope::Falling if is_of_nutation => event(EventKind::NutationMaximum),
                    _ => {}
                }
            }
            (Meaning::NutationRate, Slope::Rising) | (Meaning::Envelope, _) => {
                self.nutation.rates(&motion);
            }
            (Meaning::NutationRate, Slope::Falling) => {
                let cycle = self.nutation.boundary(time, to_nanoseconds(time), motion);
                self.pending.extend(cycle.map(Pending::Nutation));
            }
            (Meaning::Precession, Slope::Falling) => event(EventKind::LoopingBegins),
            (Meaning::Precession, Slope::Rising) => event(EventKind::LoopingEnds),
            (Meaning::Strength, Slope::Falling) => event(EventKind::WeakTop),
            (Meaning::Strength, Slope::Rising) => event(EventKind::StrongTop),
            (Meaning::Risen(_), Slope::Falling) => {
                event(EventKind::Risen);
                self.end = Some((time, End::Stop(StopReason::Risen, None)));
            }
            (Meaning::Fallen(_), Slope::Rising) => {
                event(EventKind::Fallen);
                if self.settings.stop.theta_fallen.is_some() {
                    self.end = Some((time, End::Stop(StopReason::Fallen, None)));
                }
            }
            (Meaning::Guard(guard), Slope::Falling) => {
                return self.end_phase(guard, time, &dense.at(s), motion);
            }
            (Meaning::Turning, Slope::Falling) => {
                event(EventKind::Rest);
                self.end = Some((time, End::Stop(StopReason::Rest, None)));
            }
            (Meaning::Risen(_) | Meaning::Guard(_) | Meaning::Turning, Slope::Rising)
            | (Meaning::Fallen(_), Slope::Falling) => {}
        }
        Ok(())
    }

    /// Notes what ends a phase, and what follows: another one, or nothing.
    fn end_phase(
        &mut self,
        guard: Guard,
        time: f64,
        state: &[f64; N],
        motion: Motion,
    ) -> Result<(), SimulationError> {
        if guard == Guard::Slip && self.settings.stop.on_stick == OnStick::Stop {
            self.pending
                .push_back(Pending::Event(EventKind::SlipStops, time, motion));
            self.end = Some((time, End::Stop(StopReason::SlipStopped, None)));
            return Ok(());
        }
        let system = *self.integrator.system();
        let entry = system.enter(guard, state, self.reference)?;
        let at = time + entry.delay;
        self.tell(&entry, system.phase(), at);
        let stop = match entry.passage {
            Passage::BecomesSingular => Some(StopReason::Singular),
            Passage::Jams => Some(StopReason::Jam),
            Passage::Pivots => Some(StopReason::Pivot),
            _ if entry.formulation.phase() == Phase::Holding
                && self.settings.stop.on_stick == OnStick::Stop =>
            {
                Some(StopReason::SlipStopped)
            }
            _ => None,
        };
        let end = match stop {
            None => End::Enter(entry),
            Some(reason) => End::Stop(reason, after_impact(&entry)),
        };
        self.end = Some((at, end));
        Ok(())
    }

    /// Notes what happens where a phase begins.
    fn tell(&mut self, entry: &Entry<F, N>, before: Phase, time: f64) {
        let motion = entry.motion;
        let event = |kind| Pending::Event(kind, time, motion);
        self.pending.extend(kind_of(&entry.passage).map(event));
        if !self.model().support.is_free() {
            return;
        }
        let after = entry.formulation.phase();
        if before == Phase::Holding && after != Phase::Holding {
            self.pending.push_back(event(EventKind::RollEnds));
        }
        if before != Phase::Flying && after == Phase::Flying {
            self.pending.push_back(event(EventKind::LiftOff));
        }
        if let Passage::Bounces(hit) | Passage::Lands(hit) = &entry.passage {
            self.bounces += 1;
            let landing = Landing {
                bounce: self.bounces,
                ..Landing::new(hit, &motion, time, to_nanoseconds(time))
            };
            self.pending.push_back(Pending::Impact(landing));
        }
        if before == Phase::Flying && after != Phase::Flying {
            let bounces = std::mem::take(&mut self.bounces);
            self.pending
                .push_back(Pending::Landing(bounces, time, motion));
        }
        if before != Phase::Holding && after == Phase::Holding {
            self.pending.push_back(event(EventKind::RollBegins));
        }
    }

    /// Gives up where steps have become so short that the run would never end.
    fn check_advance(&mut self, time: f64) -> Result<(), SimulationError> {
        let (steps, since) = &mut self.since_check;
        *steps += 1;
        if *steps < STALLED_STEPS {
            return Ok(());
        }
        if time - *since < STALLED_TIME {
            return Err(SimulationError::Stalled { time });
        }
        self.since_check = (0, time);
        Ok(())
    }

    /// Gives up where phases have become so short that the run would never end.
    fn check_phases(&mut self, time: f64) -> Result<(), SimulationError> {
        let (phases, since) = &mut self.since_phase;
        if time - *since >= CHATTER_TIME {
            (*phases, *since) = (0, time);
        }
        *phases += 1;
        if *phases < CHATTER_PHASES {
            Ok(())
        } else {
            Err(SimulationError::Chatters { time })
        }
    }

    /// Ends the run within this step if its duration is over in it.
    fn end_at_duration(&mut self, dense: &Dense<N>) {
        let Some(duration) = self.settings.stop.duration else {
            return;
        };
        let step_end = dense.t0 + dense.h;
        let earliest = self.end.map_or(step_end, |(time, _)| time);
        if duration <= earliest {
            let after = match &self.end {
                Some((time, End::Enter(entry))) if *time <= duration => after_impact(entry),
                Some((time, End::Stop(_, after))) if *time <= duration => *after,
                _ => None,
            };
            self.end = Some((duration, End::Stop(StopReason::Duration, after)));
            let limit = to_nanoseconds(duration);
            self.pending.retain(|record| record.time_ns() <= limit);
        }
    }

    /// The motion without the integrals over it, which are 0, and without the turns of φ and ψ: what events are looked
    /// for in.
    #[inline]
    fn motion_alone(&self, dense: &Dense<N>, s: f64) -> Motion {
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

    /// The time of the next sample, if it lies within what has been integrated and before the end.
    fn next_sample_time(&self) -> Option<u64> {
        let time_ns = u64::from(self.next_sample) * self.settings.period_ns;
        let reached = match (self.end, &self.dense) {
            (Some((end, _)), _) => time_ns <= to_nanoseconds(end),
            (None, Some(dense)) => to_seconds(time_ns) <= dense.t0 + dense.h,
            (None, None) => to_seconds(time_ns) <= self.integrator.t(),
        };
        reached.then_some(time_ns)
    }

    fn sample(&mut self, time_ns: u64) -> Record {
        let time = to_seconds(time_ns);
        let state = match &self.dense {
            Some(dense) => dense.at((time - dense.t0) / dense.h),
            None => *self.integrator.y(),
        };
        let system = self.integrator.system();
        let motion = system.motion(&state, self.reference);
        let sample = Sample::new(
            self.next_sample,
            time_ns,
            system.model(),
            &motion,
            system.world_from_body(&state),
        );
        self.next_sample += 1;
        self.last = (time, motion);
        Record::Sample(Box::new(sample))
    }

    fn event(&mut self, kind: EventKind, time: f64, motion: Motion, sentence: String) -> Record {
        let event = Event {
            kind,
            time,
            time_ns: to_nanoseconds(time),
            index: self.events,
            motion,
            description: sentence,
        };
        self.events += 1;
        self.last = (time, motion);
        Record::Event(Box::new(event))
    }

    fn hand_out(&mut self, pending: Pending) -> Record {
        match pending {
            Pending::Event(kind, time, motion) => {
                let sentence = kind.describe(&self.model().top, &motion);
                self.event(kind, time, motion, sentence)
            }
            Pending::Landing(bounces, time, motion) => {
                let described = EventKind::Landing.describe(&self.model().top, &motion);
                let counted = match bounces {
                    1 => "1 impact".to_owned(),
                    bounces => format!("{bounces} impacts"),
                };
                let sentence = format!("{described} After {counted}.");
                self.event(EventKind::Landing, time, motion, sentence)
            }
            Pending::Impact(landing) => {
                let index = self.impacts;
                self.impacts += 1;
                Record::Impact(Box::new(Landing { index, ..landing }))
            }
            Pending::Nutation(cycle) => {
                self.cycles += 1;
                Record::Nutation(Box::new(cycle))
            }
        }
    }

    /// Goes on from within the last step with another phase.
    #[cold]
    fn enter(&mut self, time: f64, entry: &Entry<F, N>) -> Result<(), SimulationError> {
        self.check_phases(time)?;
        self.dense = None;
        let system = entry.formulation;
        self.reference = system.angles(&entry.state, self.reference);
        self.integrator
            .restart(system, time, entry.state, Direction::Forward)?;
        // Where phases repeat at once, the step is too long for what happens in it.
        let (phases, _) = self.since_phase;
        let quarters = 4_u32.pow((phases - 1).min(10));
        self.integrator
            .limit_next_step(entry.first_step / f64::from(quarters));
        let before = std::mem::replace(&mut self.watches, watches(&self.settings.stop, &system));
        let motion = system.motion(&entry.state, self.reference);
        if self.model().support.is_free() {
            // Nutation goes on; what an impact changes at once has changed since the last step.
            self.nutation.rates(&motion);
            keep_signs(&before, &mut self.watches);
        } else {
            self.nutation.interrupt(time, motion);
        }
        self.end = None;
        Ok(())
    }

    /// Goes on after all records of a step have been handed out: stops, enters another phase, or takes a step. False if
    /// `carry_on` says no.
    fn advance(&mut self, carry_on: &mut dyn FnMut() -> bool) -> Result<bool, SimulationError> {
        let went_on = match self.end {
            Some((time, End::Stop(reason, after))) => {
                self.stop(time, reason, after);
                Ok(())
            }
            Some((time, End::Enter(entry))) => self.enter(time, &entry),
            None if carry_on() => self.step(),
            None => return Ok(false),
        };
        if let Err(error) = went_on {
            self.stopped = Some(StopReason::Failed);
            return Err(error);
        }
        Ok(true)
    }

    /// Runs to the end, and tells how it ended and what happened.
    pub(super) fn tallied(
        mut self,
        carry_on: &mut dyn FnMut() -> bool,
    ) -> Result<(RunEnd, Tally), SimulationError> {
        let mut tally = Tally::default();
        loop {
            while let Some(pending) = self.pending.pop_front() {
                self.take_in(&pending, &mut tally);
            }
            if self.stopped.is_some() || !self.advance(carry_on)? {
                return Ok((RecordStream::end(&self), tally));
            }
        }
    }

    /// Counts what has happened.
    fn take_in(&mut self, pending: &Pending, tally: &mut Tally) {
        let (kind, time, motion) = match *pending {
            Pending::Event(kind, time, motion) => (kind, time, motion),
            Pending::Landing(_, time, motion) => (EventKind::Landing, time, motion),
            Pending::Nutation(_) => {
                self.cycles += 1;
                return;
            }
            Pending::Impact(_) => {
                self.impacts += 1;
                return;
            }
        };
        self.events += 1;
        self.last = (time, motion);
        tally.count(kind, time);
    }

    /// Ends the run: everything before its end has been handed out.
    fn stop(&mut self, time: f64, reason: StopReason, after: Option<Motion>) {
        let in_step = |dense: &Dense<N>| self.motion(dense, (time - dense.t0) / dense.h);
        if let Some(motion) = after.or_else(|| self.dense.as_ref().map(in_step)) {
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
            let event = self.pending.front().map(Pending::time_ns);
            if let Some(time_ns) = sample
                && event.is_none_or(|event| time_ns <= event)
            {
                return Ok(Some(self.sample(time_ns)));
            }
            if let Some(pending) = self.pending.pop_front() {
                return Ok(Some(self.hand_out(pending)));
            }
            if !self.advance(carry_on)? {
                return Ok(None);
            }
        }
        Ok(None)
    }

    fn go_by_first_rules(&mut self) {
        self.nutation.take_all();
        self.integrator.leave_out_checks();
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
            events: u64::from(self.events),
            nutations: u64::from(self.cycles),
            impacts: u64::from(self.impacts),
            statistics: *self.integrator.statistics(),
        }
    }
}

/// The motion that an impact leaves behind; none where a phase begins without one.
fn after_impact<F, const N: usize>(entry: &Entry<F, N>) -> Option<Motion> {
    matches!(entry.passage, Passage::Bounces(_) | Passage::Lands(_)).then_some(entry.motion)
}

/// The event that a passage is; none where the phases tell it.
fn kind_of(passage: &Passage) -> Option<EventKind> {
    match passage {
        Passage::Holds => Some(EventKind::Stick),
        Passage::SlipStops => Some(EventKind::SlipStops),
        Passage::SlipResumes => Some(EventKind::SlipResumes),
        Passage::BecomesSingular => Some(EventKind::Singular),
        Passage::Jams => Some(EventKind::Jam),
        Passage::Pivots => Some(EventKind::Pivot),
        Passage::Rolls
        | Passage::RollEnds
        | Passage::LiftsOff
        | Passage::Bounces(_)
        | Passage::Lands(_) => None,
    }
}

/// Seconds of whole nanoseconds: correctly rounded.
fn to_seconds(time_ns: u64) -> f64 {
    time_ns as f64 / 1e9
}

/// The nearest whole number of nanoseconds to a time that is not negative.
fn to_nanoseconds(time: f64) -> u64 {
    (time * 1e9).round() as u64
}
