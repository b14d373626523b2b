//! Run history, collected in one pass: events, nutation cycles, energy, momentum, phases of a free peg. Used by diff
//! and explain.

pub(crate) mod curve;
mod cycle;
pub(crate) mod energy;
mod event;
mod extent;
mod peg;
mod summary;

pub(crate) use self::cycle::Cycle;
pub(crate) use self::event::Event;
pub(crate) use self::extent::Extent;
pub(crate) use self::peg::{Interval, PegHistory, in_phase};
pub use self::peg::{PegPhase, PegSummary};
pub use self::summary::RunSummary;

use self::curve::CubicCurve;
use self::energy::Energies;
use crate::analysis::slip::SlipHistory;
use crate::archive::format::{Entries, INVERSION_TIME, SAMPLE_COUNT, STOP_REASON, STOP_TIME};
use crate::archive::recording::Missing;
use crate::physics::kinematics::Euler;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, StopReason};
use crate::run::time::seconds;
use crate::telemetry::fields::{
    ACCELERATION, CONTACT, ENERGY, EVENTS, IMPACTS, MOMENTUM, NUTATION, STATE, acceleration,
    contact, events, momentum, nutation, state,
};
use crate::telemetry::{Message, Topic, event_state};

use std::f64::consts::FRAC_PI_2;

/// Maximum gap between consecutive cycles, relative to the period; a larger gap interrupts the nutation.
const MAX_CYCLE_GAP: f64 = 1e-6;

/// A sample of the motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct State {
    /// Time, s.
    pub(crate) time: f64,
    /// Inclination θ, rad.
    pub(crate) theta: f64,
    /// Euler rates, rad/s.
    pub(crate) rates: Euler,
    /// Integrals of the terms of φ̈ since the start, rad/s: gyroscopic, Coriolis, frictional; NaN if not recorded.
    pub(crate) terms: [f64; 3],
}

/// The history of a run.
#[derive(Clone, Debug, Default)]
pub(crate) struct RunHistory {
    /// Events, in the order of time.
    pub(crate) events: Vec<Event>,
    /// Nutation cycles, in the order of time.
    pub(crate) cycles: Vec<Cycle>,
    /// Whether samples are missing.
    pub(crate) has_gaps: bool,
    /// Messages that the recording lacks, according to the end record.
    missing: Vec<Missing>,
    /// Time between samples, ns, if the scenario is known.
    sample_period_ns: Option<u64>,
    /// Time of the last sample, ns.
    last_sample_ns: Option<u64>,
    /// The first and the last sample.
    pub(crate) states: Option<[State; 2]>,
    pub(crate) energies: Option<Energies>,
    /// The angular momentum about the vertical, kg m²/s.
    pub(crate) vertical_momentum: Option<Extent>,
    /// Length of the path slipped, m.
    pub(crate) slip_path: Option<f64>,
    /// The slip, if the scenario is known.
    pub(crate) slip: Option<SlipHistory>,
    /// The normal force, if it is recorded.
    pub(crate) normal_force: Option<Extent>,
    /// The phases of a free peg.
    pub(crate) peg: Option<PegHistory>,
    /// The end record; `None` if the run did not end.
    pub(crate) end: Option<Entries>,
    /// Number of messages.
    pub(crate) messages: u64,
    /// Time of the last message, ns.
    pub(crate) last_ns: Option<u64>,
}

impl RunHistory {
    /// Creates an empty history; `scenario` is set if known.
    pub(crate) fn new(scenario: Option<&Scenario>) -> Self {
        Self {
            peg: scenario
                .filter(|scenario| scenario.model.support.is_free())
                .map(PegHistory::new),
            slip: scenario.map(SlipHistory::new),
            sample_period_ns: scenario.map(|scenario| scenario.sample_period_ns),
            ..Self::default()
        }
    }

    /// Adds a message of the run.
    pub(crate) fn take(&mut self, message: &Message<'_>) {
        self.messages += 1;
        self.last_ns = self.last_ns.max(Some(message.time_ns));
        if let Some(peg) = &mut self.peg {
            peg.take(message);
        }
        match message.topic() {
            STATE => self.add_state(message),
            ACCELERATION => self.add_terms(message),
            ENERGY => Energies::take(&mut self.energies, message),
            MOMENTUM => {
                let vertical = momentum::VERTICAL.of(message);
                Extent::take(&mut self.vertical_momentum, vertical);
            }
            CONTACT => {
                if let Some(slip) = &mut self.slip {
                    slip.take_contact(message);
                }
                Extent::take(&mut self.normal_force, contact::NORMAL_FORCE.of(message));
                self.slip_path = Some(contact::SLIP_PATH.of(message)).filter(|p| !p.is_nan());
            }
            NUTATION => self.cycles.push(Cycle::from_message(message)),
            EVENTS => self.add_event(message),
            _ => {}
        }
    }

    fn add_state(&mut self, message: &Message<'_>) {
        self.find_gap(message.time_ns);
        if let Some(slip) = &mut self.slip {
            slip.take_state(message);
        }
        let rates = Euler {
            phi: state::PHI_DOT.of(message),
            theta: state::THETA_DOT.of(message),
            psi: state::PSI_DOT.of(message),
        };
        let now = State {
            time: seconds(message.time_ns),
            theta: state::THETA.of(message),
            rates,
            terms: [f64::NAN; 3],
        };
        let first = self.states.map_or(now, |[first, _]| first);
        self.states = Some([first, now]);
    }

    /// Looks for a gap before a sample. Samples are at the multiples of the sampling period; their sequence numbers
    /// don't show gaps, because other software may number messages anew.
    fn find_gap(&mut self, time_ns: u64) {
        if let Some(period) = self.sample_period_ns {
            let expected = self.last_sample_ns.map_or(0, |last| last + period);
            self.has_gaps |= time_ns > expected;
        }
        self.last_sample_ns = Some(time_ns);
    }

    /// Adds the integrals of the terms of φ̈ to the state of the same time, which is recorded before them.
    fn add_terms(&mut self, message: &Message<'_>) {
        let terms = [
            acceleration::PHI_DOT_GYROSCOPIC.of(message),
            acceleration::PHI_DOT_CORIOLIS.of(message),
            acceleration::PHI_DOT_FRICTIONAL.of(message),
        ];
        let time = seconds(message.time_ns);
        for state in self.states.iter_mut().flatten() {
            if state.time == time {
                state.terms = terms;
            }
        }
    }

    fn add_event(&mut self, message: &Message<'_>) {
        let event = Event {
            kind: EventKind::find(events::NAME.of(message)),
            time: events::TIME.of(message),
            state: event_state(message),
        };
        if let Some(peg) = &mut self.peg {
            peg.add_event(&event);
        }
        self.events.push(event);
    }

    /// Sets the end of the run, and the messages that its recording lacks.
    pub(crate) fn finish(&mut self, end: Option<Entries>, missing: Vec<Missing>) {
        self.end = end;
        self.missing = missing;
        self.has_gaps |= self.lacks(STATE);
    }

    /// Whether messages of a topic are missing, so that their number is not that of the run.
    pub(crate) fn lacks(&self, topic: Topic) -> bool {
        self.missing.iter().any(|missing| missing.is_of(topic))
    }

    /// The cycles that follow each other, so that their averages form a curve. For a fixed peg they end where the next
    /// cycle does not start near the end of the last one, or lasts more than twice or less than half as long.
    pub(crate) fn successive_cycles(&self) -> &[Cycle] {
        const RATIO: f64 = 2.0;
        // A free peg may interrupt its nutation anywhere.
        if self.peg.is_some() {
            return &self.cycles;
        }
        let broken = self.cycles.windows(2).position(|pair| {
            let ratio = pair[1].period / pair[0].period;
            let gap = pair[1].start - pair[0].end();
            !(1.0 / RATIO..=RATIO).contains(&ratio) || gap.abs() > 0.5 * pair[0].period
        });
        &self.cycles[..broken.map_or(self.cycles.len(), |last| last + 1)]
    }

    /// The reason for the end of the run, if it is recorded.
    pub(crate) fn stop_reason(&self) -> Option<StopReason> {
        StopReason::find(self.end_entry(STOP_REASON)?)
    }

    /// An entry of the end record.
    pub(crate) fn end_entry(&self, key: &str) -> Option<&str> {
        self.end.as_ref()?.get(key).map(String::as_str)
    }

    /// A number of the end record.
    fn end_number(&self, key: &str) -> Option<f64> {
        let number: f64 = self.end_entry(key)?.parse().ok()?;
        number.is_finite().then_some(number)
    }

    /// The first time at which the axis of a tippe top passes the horizontal downwards, s.
    pub(crate) fn inverted(&self) -> Option<f64> {
        let first = self.first(EventKind::Inverts).map(|event| event.time);
        self.end_number(INVERSION_TIME).or(first)
    }

    /// Whether the recorded samples go to the end of the run.
    pub(crate) fn is_recorded_to_end(&self) -> bool {
        let (Some(count), Some(period), Some(last)) = (
            self.end_number(SAMPLE_COUNT),
            self.sample_period_ns,
            self.last_sample_ns,
        ) else {
            return !self.has_gaps;
        };
        // The first sample is at 0.
        (last / period + 1) as f64 >= count
    }

    /// Time at which the run or its recording ended, s: from the end record, or the last message.
    pub(crate) fn stop_time(&self) -> Option<f64> {
        // Other software may have cut the recording and copied the end record.
        self.end_number(STOP_TIME)
            .filter(|_| self.is_recorded_to_end())
            .or_else(|| self.last_ns.map(seconds))
    }

    /// Time at which the top had risen, s: of the event, or of the end if that is all that is recorded of it.
    pub(crate) fn rise_time(&self) -> Option<f64> {
        let is_rise = self.stop_reason() == Some(StopReason::Risen);
        let end = self.end_number(STOP_TIME).filter(|_| is_rise);
        self.first(EventKind::Risen).map(|event| event.time).or(end)
    }

    /// The first event of a kind.
    pub(crate) fn first(&self, kind: EventKind) -> Option<&Event> {
        self.events_of(kind).next()
    }

    /// The events of a kind.
    pub(crate) fn events_of(&self, kind: EventKind) -> impl Iterator<Item = &Event> {
        self.events
            .iter()
            .filter(move |event| event.kind == Some(kind))
    }

    /// The nutation phase (number of cycles) over time. Interruptions are not counted.
    pub(crate) fn phase(&self) -> CubicCurve {
        let mut points = Vec::new();
        for (index, cycle) in self.successive_cycles().iter().enumerate() {
            let number = cycle.field(nutation::CYCLE);
            points.push((cycle.start, number));
            if !self.goes_on_after(index) {
                points.push((cycle.end(), number + 1.0));
            }
        }
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        CubicCurve::new(points)
    }

    fn goes_on_after(&self, index: usize) -> bool {
        let cycle = &self.cycles[index];
        self.cycles
            .get(index + 1)
            .is_some_and(|next| (next.start - cycle.end()).abs() < MAX_CYCLE_GAP * cycle.period)
    }

    /// End of the uninterrupted nutations, s.
    pub(crate) fn unbroken_until(&self) -> Option<f64> {
        let last = (0..self.cycles.len()).find(|index| !self.goes_on_after(*index))?;
        Some(self.cycles[last].end())
    }

    /// A quantity of the successive cycles: a curve through their middles. NaN is left out.
    pub(crate) fn curve(&self, quantity: impl Fn(&Cycle) -> f64) -> CubicCurve {
        let mut points = Vec::new();
        for cycle in self.successive_cycles() {
            points.push((cycle.middle(), quantity(cycle)));
        }
        points.retain(|(_, value)| !value.is_nan());
        CubicCurve::new(points)
    }

    /// Whether the axis is beyond the horizontal in the last sample, and has not come back before in its last nutation: a
    /// tippe top that has inverted, and stays so.
    pub(crate) fn is_inverted_at_end(&self) -> bool {
        let Some([_, last]) = self.states else {
            return false;
        };
        let comes_back = self.events_of(EventKind::Inverts).count() > 1
            && self.cycles.last().is_some_and(|cycle| {
                !cycle.is_last_before(last.time) && cycle.field(nutation::THETA_MIN) < FRAC_PI_2
            });
        last.theta >= FRAC_PI_2 && !comes_back
    }

    /// The last time at which the axis passes the horizontal downwards, s.
    pub(crate) fn last_inversion(&self) -> Option<f64> {
        let last = self.events_of(EventKind::Inverts).last();
        last.map(|event| event.time).or(self.inverted())
    }

    /// The phases of a free peg to the end of the run; empty if they are not known, as after a gap.
    pub(crate) fn peg_intervals(&self) -> Vec<Interval> {
        match (&self.peg, self.stop_time()) {
            (Some(peg), Some(end)) if !self.has_gaps && !self.lacks(EVENTS) => peg.intervals(end),
            _ => Vec::new(),
        }
    }

    /// Whether the top is a tippe top.
    pub(crate) fn is_tippe_top(&self) -> bool {
        self.peg.as_ref().is_some_and(PegHistory::is_tippe)
    }

    /// A summary.
    pub(crate) fn summary(&self) -> RunSummary {
        // It is constant about a fixed point. Under a free peg, friction has a torque about the vertical through the
        // centre of mass.
        let momentum = self.vertical_momentum.filter(|_| self.peg.is_none());
        RunSummary {
            rise_time: self.rise_time(),
            stop_reason: self.end_entry(STOP_REASON).map(str::to_owned),
            stop_time: self.end_number(STOP_TIME),
            nutations: (!self.cycles.is_empty() && !self.has_gaps && !self.lacks(NUTATION))
                .then_some(self.cycles.len() as u64),
            energy_first: self.energies.map(|energies| energies.first),
            energy_last: self.energies.map(|energies| energies.last),
            friction_work: self.energies.map(|energies| energies.work),
            energy_imbalance: self.energies.map(|energies| energies.imbalance),
            slip_path: self.slip_path,
            vertical_momentum_deviation: momentum
                .map(|momentum| momentum.deviation() / momentum.first.abs())
                .filter(|deviation| deviation.is_finite()),
            peg: self.peg.as_ref().map(|peg| self.peg_summary(peg)),
        }
    }

    fn peg_summary(&self, peg: &PegHistory) -> PegSummary {
        let mut summary = peg.summary(&self.peg_intervals());
        // Where samples are missing, events and impacts may be, too.
        if self.has_gaps || self.lacks(EVENTS) {
            (summary.hops, summary.time_in_air, summary.time_rolling) = (None, None, None);
        }
        if self.has_gaps || self.lacks(IMPACTS) {
            (summary.impacts, summary.impact_loss) = (None, None);
        }
        if self.end.is_none() {
            // What the peg does after the end of a file that was cut off is not known.
            (summary.rolls_to_end_from, summary.rolls_to_end_at) = (None, None);
        }
        summary
    }
}
