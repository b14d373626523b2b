//! What happened in one run: its events, its nutation cycles, its energy balance.

pub(crate) mod curve;

mod cycle;
mod event;
mod peg;
mod report;
mod swing;
mod work;

pub(crate) use self::cycle::Cycle;
pub(crate) use self::event::Event;
pub use self::peg::{Doing, PegReport};
pub(crate) use self::peg::{PegCourse, Spell};
pub use self::report::CourseReport;

use self::curve::Curve;
use self::cycle::{Ranges, THETA, THETA_DOT, widen};
use self::work::NodeWork;
use crate::archive::format::{Entries, STOP_REASON, STOP_TIME};
use crate::physics::dynamics::Model;
use crate::physics::kinematics::{Euler, Tilt};
use crate::run::simulation::{EventKind, StopReason};
use crate::telemetry::Message;
use crate::telemetry::fields::{
    CONTACT, ENERGY, EVENTS, MOMENTUM, NUTATION, STATE, TORQUE, contact, energy, events, momentum,
    nutation, state,
};

/// A cycle that begins later than another ends by this part of it or more does not follow on it: the times of both are
/// recorded to 1e-9 of some hundred of them at least.
const BROKEN: f64 = 1e-6;

/// What happened in a run, collected message by message.
#[derive(Clone, Debug, Default)]
pub(crate) struct Course {
    pub(crate) events: Vec<Event>,
    pub(crate) cycles: Vec<Cycle>,
    pub(crate) messages: u64,
    pub(crate) last_ns: u64,
    /// The entries of the end record.
    pub(crate) end: Option<Entries>,
    ranges: Ranges,
    has_just_closed: bool,
    /// The last state, with its time (ns).
    tilt: Option<(u64, Tilt)>,
    work: NodeWork,
    /// That work as the integrator summed it, where it is recorded.
    work_node: Option<[f64; 3]>,
    energy: Option<[f64; 2]>,
    imbalance: f64,
    friction_work: Option<f64>,
    momentum: Option<(f64, f64)>,
    slip_path: Option<f64>,
    /// What the peg did, if it is free.
    pub(crate) peg: Option<PegCourse>,
}

impl Course {
    /// Takes in a message of the table.
    pub(crate) fn take(&mut self, message: &Message<'_>) {
        self.messages += 1;
        self.last_ns = self.last_ns.max(message.time_ns);
        if let Some(peg) = &mut self.peg {
            peg.take(message);
        }
        match message.topic() {
            STATE => self.state(message),
            TORQUE => {
                if let Some((time_ns, tilt)) = &self.tilt
                    && *time_ns == message.time_ns
                {
                    self.work.add(message, tilt);
                }
            }
            ENERGY => self.energy(message),
            MOMENTUM => {
                let vertical = momentum::VERTICAL.of(message);
                let (first, drift) = self.momentum.get_or_insert((vertical, 0.0));
                *drift = drift.max((vertical - *first).abs());
            }
            CONTACT => self.slip_path = known(contact::SLIP_PATH.of(message)),
            NUTATION => self.cycle(message),
            EVENTS => self.event(message),
            _ => {}
        }
    }

    fn state(&mut self, message: &Message<'_>) {
        let between = self.ranges.state(message, !self.cycles.is_empty());
        if std::mem::take(&mut self.has_just_closed)
            && let Some(cycle) = self.cycles.last_mut()
        {
            // The θ̇ with which the cycle ended lies between two samples.
            for (range, [least, greatest]) in cycle.ranges.iter_mut().zip(between).skip(THETA_DOT) {
                widen(range, least);
                widen(range, greatest);
            }
        }
        let theta = state::THETA.of(message);
        let rates = Euler {
            phi: state::PHI_DOT.of(message),
            theta: state::THETA_DOT.of(message),
            psi: state::PSI_DOT.of(message),
        };
        let are_known = [theta, rates.phi, rates.theta, rates.psi].map(|value| !value.is_nan());
        if are_known == [true; 4] {
            self.tilt = Some((message.time_ns, Tilt::from_rates(theta, rates)));
        }
    }

    fn energy(&mut self, message: &Message<'_>) {
        let (total, work) = (energy::TOTAL.of(message), energy::FRICTION_WORK.of(message));
        if total.is_nan() || work.is_nan() {
            return;
        }
        let first = self.energy.map_or(total - work, |energy| energy[0]);
        self.energy = Some([first, total]);
        self.friction_work = Some(work);
        let of_axes = energy::FRICTION_WORK_NODE.of(message);
        if of_axes.iter().all(|work| work.is_finite()) {
            self.work_node = Some(of_axes.into());
        }
        self.imbalance = self.imbalance.max((total - first - work).abs());
    }

    fn cycle(&mut self, message: &Message<'_>) {
        let mut ranges = self.ranges.take();
        // The integrator knew these exactly.
        ranges[THETA] = [nutation::THETA_MIN, nutation::THETA_MAX].map(|field| field.of(message));
        let recorded = [
            [nutation::THETA_DOT_MIN, nutation::THETA_DOT_MAX],
            [nutation::PHI_DOT_MIN, nutation::PHI_DOT_MAX],
            [nutation::PSI_DOT_MIN, nutation::PSI_DOT_MAX],
        ];
        let recorded = recorded.map(|range| range.map(|field| field.of(message)));
        let is_recorded = recorded.iter().flatten().all(|value| value.is_finite());
        if is_recorded {
            ranges[THETA_DOT..].copy_from_slice(&recorded);
        }
        let means = [
            nutation::THETA_MEAN,
            nutation::THETA_DOT_MEAN,
            nutation::PHI_DOT_MEAN,
            nutation::PSI_DOT_MEAN,
        ];
        self.cycles.push(Cycle {
            number: nutation::CYCLE.of(message),
            start: nutation::START.of(message),
            period: nutation::PERIOD.of(message),
            means: means.map(|field| field.of(message)),
            ranges,
        });
        self.has_just_closed = !is_recorded;
    }

    fn event(&mut self, message: &Message<'_>) {
        let event = Event {
            name: events::NAME.of(message).to_owned(),
            description: events::DESCRIPTION.of(message).to_owned(),
            time: events::TIME.of(message),
            theta: events::THETA.of(message),
            rates: [events::PHI_DOT, events::PSI_DOT].map(|field| field.of(message)),
        };
        if let Some(peg) = &mut self.peg {
            peg.event(&event);
        }
        self.events.push(event);
    }

    /// The course of a run of this model, if that is known.
    pub(crate) fn of(model: Option<Model>) -> Self {
        let free = model.filter(|model| model.support.is_free());
        Self {
            peg: free.map(PegCourse::new),
            ..Self::default()
        }
    }

    /// Takes in the end of the run.
    pub(crate) fn finish(&mut self, end: Option<Entries>) {
        self.end = end;
        if let Some(peg) = &mut self.peg {
            peg.finish();
        }
    }

    /// When the run stopped, or the time of its last message if that isn't known, s.
    pub(crate) fn stop_time(&self) -> f64 {
        let entry = self.end.as_ref().and_then(|end| end.get(STOP_TIME));
        let known = entry.and_then(|time| time.parse::<f64>().ok());
        known.unwrap_or(self.last_ns as f64 / 1e9)
    }

    /// The number of nutations that there have been, over the times (s) at which they end.
    pub(crate) fn phase(&self) -> Curve {
        // Where the next cycle begins later than one ends, nothing counts in between.
        let cycles = self.cycles.iter().enumerate();
        let broken_off = cycles.filter(|(index, _)| !self.goes_on_after(*index));
        let ends = broken_off.map(|(_, cycle)| (cycle.end(), cycle.number + 1.0));
        let starts = self.cycles.iter().map(|cycle| (cycle.start, cycle.number));
        let mut points: Vec<_> = starts.chain(ends).collect();
        points.sort_by(|one, other| one.0.total_cmp(&other.0));
        Curve::new(points)
    }

    /// Whether the next cycle follows on one.
    fn goes_on_after(&self, index: usize) -> bool {
        let cycle = &self.cycles[index];
        let next = self.cycles.get(index + 1);
        next.is_some_and(|next| (next.start - cycle.end()).abs() < BROKEN * cycle.period)
    }

    /// The end of the cycles that follow one on another, s: how many nutations there have been is not known beyond.
    pub(crate) fn unbroken_until(&self) -> Option<f64> {
        let last = (0..self.cycles.len()).find(|index| !self.goes_on_after(*index))?;
        Some(self.cycles[last].end())
    }

    /// A quantity of the cycles, over the times of their middles (s).
    pub(crate) fn of_cycles(&self, quantity: impl Fn(&Cycle) -> f64) -> Curve {
        let points = self
            .cycles
            .iter()
            .map(|cycle| (cycle.middle(), quantity(cycle)));
        Curve::new(points.filter(|(_, value)| !value.is_nan()))
    }

    /// The first event of a kind.
    fn first(&self, kind: EventKind) -> Option<&Event> {
        self.events.iter().find(|event| event.name == kind.name())
    }

    /// A rate in the last sample, if the run stopped there.
    fn rate_at(&self, stop_time: Option<f64>, rate: impl Fn(&Euler) -> f64) -> Option<f64> {
        let (time_ns, tilt) = self.tilt.as_ref()?;
        let is_end = (stop_time? - *time_ns as f64 / 1e9).abs() < 1e-9;
        is_end.then(|| rate(&tilt.rates))
    }

    pub(crate) fn report(&self) -> CourseReport {
        let entry = |key: &str| self.end.as_ref()?.get(key);
        let stop_time = entry(STOP_TIME).and_then(|time| time.parse::<f64>().ok());
        // The last event is the end of the run, unless its duration was over.
        let last = self
            .events
            .last()
            .filter(|event| Some(event.time) == stop_time);
        let is_rise = entry(STOP_REASON).is_some_and(|reason| reason == StopReason::Risen.name());
        let risen = self.first(EventKind::Risen).map(|event| event.time);
        CourseReport {
            stop_reason: entry(STOP_REASON).cloned(),
            stop_time,
            rise_time: risen.or(stop_time.filter(|_| is_rise)),
            nutations: (!self.cycles.is_empty()).then_some(self.cycles.len() as u64),
            energy_first: self.energy.map(|energy| energy[0]),
            energy_last: self.energy.map(|energy| energy[1]),
            friction_work: self.friction_work,
            // Beside what it does about these axes, friction moves a free peg.
            friction_work_node: self
                .work_node
                .or(self.work.work())
                .filter(|_| self.peg.is_none()),
            slip_path: self.slip_path,
            spin_rate_last: last
                .map_or_else(|| self.rate_at(stop_time, |r| r.psi), |e| Some(e.rates[1])),
            precession_rate_last: last
                .map_or_else(|| self.rate_at(stop_time, |r| r.phi), |e| Some(e.rates[0])),
            last_sample: self.tilt.as_ref().map(|(time_ns, _)| *time_ns as f64 / 1e9),
            // Friction turns a top whose peg is free about the vertical too.
            vertical_momentum_drift: self
                .momentum
                .filter(|_| self.peg.is_none())
                .map(|(first, drift)| drift / first.abs()),
            energy_imbalance: self.energy.map(|_| self.imbalance),
            peg: self.peg.as_ref().map(|peg| peg.report(self.stop_time())),
        }
    }
}

/// A value, if it was recorded.
fn known(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::analysis::subject::Subject;
    use crate::run::scenario::{Preset, Scenario};
    use crate::telemetry::Topics;
    use std::ops::ControlFlow;

    /// A run that starts short behind a greatest θ̇: almost a nutation passes before the first cycle begins.
    fn late() -> Scenario {
        let mut values = Preset::find("full-coulomb").unwrap().values().unwrap();
        for (key, value) in [
            ("friction.k", "0.3"),
            ("initial.theta_dot", "0.5"),
            ("initial.phi_dot", "2.5"),
            ("stop.duration", "0.5"),
        ] {
            values.set(key, value).unwrap();
        }
        Scenario::new(values).unwrap()
    }

    fn each(scenario: &Scenario, mut take: impl FnMut(&Message<'_>)) {
        Subject::from(scenario).read(&Topics::All, &mut |message, _| {
            take(message);
            ControlFlow::Continue(())
        });
    }

    /// Recordings of the first version lack the extremes of the rates.
    #[test]
    fn val_ranges_found_between_samples_are_those_of_the_integrator() {
        let (mut exact, mut found) = (Course::default(), Course::default());
        each(&late(), |message| {
            exact.take(message);
            let mut numbers = message.numbers.to_vec();
            if message.topic() == NUTATION {
                numbers[nutation::PHI_DOT_MIN.index()] = f64::NAN;
            }
            found.take(&Message {
                numbers: &numbers,
                ..*message
            });
        });
        assert!(exact.cycles.len() > 5);
        for (exact, found) in exact.cycles.iter().zip(&found.cycles) {
            for (exact, found) in exact.ranges.iter().zip(found.ranges) {
                // Of 45 samples in a nutation the cubics between them err by (2π/45)⁴/384 of the amplitude, 5e-7 of the
                // range; overtones have a part in it too.
                let allowed = 2e-6 * (exact[1] - exact[0]);
                for (exact, found) in exact.iter().zip(found) {
                    assert!((exact - found).abs() <= allowed, "{exact} {found}");
                }
            }
        }
    }

    #[test]
    fn the_energy_of_the_start_follows_from_any_part_of_a_run() {
        let (mut whole, mut part) = (Course::default(), Course::default());
        each(&late(), |message| {
            whole.take(message);
            if message.time_ns >= 250_000_000 {
                part.take(message);
            }
        });
        let [whole, part] = [whole, part].map(|course| course.report().energy_first.unwrap());
        // The integrator sums the work of friction to 1e-12 of it.
        assert!((whole - part).abs() <= 1e-12 * whole, "{whole} {part}");
    }

    fn take_energy(course: &mut Course, total: f64, work: f64) {
        let mut numbers = vec![0.0; ENERGY.info().numbers.len()];
        numbers[energy::TOTAL.index()] = total;
        numbers[energy::FRICTION_WORK.index()] = work;
        course.take(&Message {
            channel: ENERGY.index(),
            sequence: 0,
            time_ns: 0,
            numbers: &numbers,
            texts: &[],
        });
    }

    /// What friction has done before the first message belongs to the energy at the start.
    #[test]
    fn the_balance_of_energy_begins_with_the_run() {
        let mut course = Course::default();
        take_energy(&mut course, f64::NAN, -1.0);
        take_energy(&mut course, 6.0, f64::NAN);
        take_energy(&mut course, 5.0, -2.0);
        take_energy(&mut course, 4.0, -3.0);
        assert_eq!((course.energy, course.imbalance), (Some([7.0, 4.0]), 0.0));
        take_energy(&mut course, 3.5, -3.0);
        take_energy(&mut course, 3.0, -4.0);
        assert_eq!((course.energy, course.imbalance), (Some([7.0, 3.0]), 0.5));
    }
}
