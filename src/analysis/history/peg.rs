//! The phases of a free peg (sliding, rolling, flight), its impacts, and the energy dissipated in each.

use super::event::Event;
use super::extent::Extent;
use crate::physics::math::hypot;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, Regime};
use crate::telemetry::Message;
use crate::telemetry::fields::{
    CENTER_OF_MASS, CONTACT, FREE_PEG, IMPACTS, MOMENTUM, STATE, center_of_mass, contact, free_peg,
    impacts, momentum,
};
use schemars::JsonSchema;
use serde::Serialize;

/// A phase of the peg's motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PegPhase {
    /// It slides over the table.
    Sliding,
    /// It rolls: the contact point does not slip.
    Rolling,
    /// It is in the air, or touches the table in impacts only.
    Flying,
}

/// An interval in which the peg is in one phase.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Interval {
    pub(crate) phase: PegPhase,
    /// Times of its beginning and its end, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Inclination θ when it begins, rad; NaN at the start of the run.
    pub(crate) theta: f64,
}

impl Interval {
    pub(crate) fn duration(&self) -> f64 {
        self.to - self.from
    }
}

/// A change of phase.
#[derive(Clone, Copy, Debug)]
struct PhaseChange {
    /// The new phase.
    phase: PegPhase,
    /// Time, s.
    time: f64,
    /// Inclination θ then, rad; NaN if it is not known.
    theta: f64,
}

/// The largest distance of the contact point from where it started.
#[derive(Clone, Copy, Debug)]
struct Travel {
    /// The contact point in the first sample, m.
    start: [f64; 2],
    /// The largest distance from there, m.
    farthest: f64,
}

/// The history of a free peg.
#[derive(Clone, Debug, Default)]
pub(crate) struct PegHistory {
    /// Distance of the centre of mass from the centre of the sphere, and its radius, m.
    center_distance: f64,
    peg_radius: f64,
    changes: Vec<PhaseChange>,
    /// Whether it flies at first: it starts in the air, or lifts off at once.
    flies_at_first: bool,
    /// Whether there are events: without them the phases are not known.
    has_events: bool,
    impacts: u64,
    /// The impacts after the last sample.
    impacts_after_samples: u64,
    /// The energy that all impacts took, J.
    impact_loss: f64,
    /// Height above the table in the highest sample, m; 0 if no sample is in the air.
    highest: f64,
    /// The angular momentum about the symmetry axis in the last sample, kg m²/s.
    axial: Option<f64>,
    /// Jellett's integral, kg m³/s.
    jellett: Option<Extent>,
    /// The largest sum of the magnitudes of its terms, |l L_n| + |R L_z′|, kg m³/s, which may cancel.
    jellett_terms: f64,
    /// Energy dissipated by sliding, other losses, restitution and friction in impacts, J.
    lost: Option<[f64; 4]>,
    /// None before the first sample.
    travel: Option<Travel>,
}

impl PegHistory {
    pub(super) fn new(scenario: &Scenario) -> Self {
        let top = &scenario.model.top;
        Self {
            center_distance: top.center_distance,
            peg_radius: top.peg_radius,
            // From the scenario, because the topics that show it may not be recorded.
            flies_at_first: scenario.start().is_in_flight(top.peg_radius),
            ..Self::default()
        }
    }

    /// Whether the centre of mass is below the centre of the sphere when the axis is upright.
    pub(crate) fn is_tippe(&self) -> bool {
        self.center_distance < 0.0
    }

    /// Jellett's integral at the start, and its largest deviation, kg m³/s.
    pub(crate) fn jellett(&self) -> Option<Extent> {
        self.jellett
    }

    /// Number of impacts after the last sample.
    pub(crate) fn impacts_after_samples(&self) -> u64 {
        self.impacts_after_samples
    }

    pub(super) fn take(&mut self, message: &Message<'_>) {
        match message.topic() {
            STATE => self.impacts_after_samples = 0,
            CONTACT => self.add_contact(message),
            MOMENTUM => self.axial = Some(momentum::AXIAL.of(message)),
            CENTER_OF_MASS => {
                let vertical = center_of_mass::ANGULAR_MOMENTUM.of(message).z;
                let of_axis = self.center_distance * self.axial.unwrap_or(f64::NAN);
                let size = of_axis.abs() + (self.peg_radius * vertical).abs();
                self.jellett_terms = self.jellett_terms.max(size);
            }
            FREE_PEG => self.add_free_peg(message),
            IMPACTS => {
                self.impacts += 1;
                self.impacts_after_samples += 1;
                self.impact_loss +=
                    impacts::LOST_RESTITUTION.of(message) + impacts::LOST_FRICTION.of(message);
            }
            _ => {}
        }
    }

    pub(super) fn add_event(&mut self, event: &Event) {
        self.has_events = true;
        let phase = match event.kind {
            Some(EventKind::LiftOff) => PegPhase::Flying,
            Some(EventKind::Landing | EventKind::RollEnds) => PegPhase::Sliding,
            Some(EventKind::RollBegins) => PegPhase::Rolling,
            _ => return,
        };
        // Only a peg in flight can land.
        if self.changes.is_empty() {
            self.flies_at_first |= event.kind == Some(EventKind::Landing);
        }
        self.changes.push(PhaseChange {
            phase,
            time: event.time,
            theta: event.state.theta,
        });
    }

    fn add_contact(&mut self, message: &Message<'_>) {
        // A peg that lifts off at once starts at the height of the table, but in flight.
        let regime = Regime::from_code(contact::REGIME.of(message));
        self.flies_at_first |= self.travel.is_none() && regime == Some(Regime::Flying);
        let point = contact::CONTACT_POINT.of(message);
        let travel = self.travel.get_or_insert(Travel {
            start: [point.x, point.y],
            farthest: 0.0,
        });
        let distance = hypot(point.x - travel.start[0], point.y - travel.start[1]);
        travel.farthest = travel.farthest.max(distance);
    }

    fn add_free_peg(&mut self, message: &Message<'_>) {
        let gap = free_peg::GAP.of(message);
        self.highest = self.highest.max(gap);
        Extent::take(&mut self.jellett, free_peg::JELLETT.of(message));
        let lost = [
            free_peg::LOST_SLIDING,
            free_peg::LOST_LOSSES,
            free_peg::LOST_RESTITUTION,
            free_peg::LOST_IMPACT_FRICTION,
        ];
        self.lost = Some(lost.map(|field| field.of(message)));
    }

    /// The intervals of the phases, to the end of the run (s); empty if there are no events.
    pub(crate) fn intervals(&self, end: f64) -> Vec<Interval> {
        if !self.has_events {
            return Vec::new();
        }
        // Events are changes, so none of them says how the run begins.
        let first = if self.flies_at_first {
            PegPhase::Flying
        } else {
            PegPhase::Sliding
        };
        let mut starts = vec![PhaseChange {
            phase: first,
            time: 0.0,
            theta: f64::NAN,
        }];
        starts.extend_from_slice(&self.changes);
        let mut intervals: Vec<Interval> = Vec::new();
        for (index, start) in starts.iter().enumerate() {
            let to = starts.get(index + 1).map_or(end, |next| next.time);
            // A phase that begins and ends at the same time is not a real phase.
            if to <= start.time {
                continue;
            }
            match intervals.last_mut() {
                Some(last) if last.phase == start.phase => last.to = to,
                _ => intervals.push(Interval {
                    phase: start.phase,
                    from: start.time,
                    to,
                    theta: start.theta,
                }),
            }
        }
        intervals
    }

    pub(super) fn summary(&self, intervals: &[Interval]) -> PegSummary {
        let is_known = self.has_events;
        // A recording without their channel may have lost energy in impacts.
        let is_free_of_impacts = self.lost.is_some_and(|lost| lost[2..] == [0.0; 2]);
        let knows_impacts = self.impacts > 0 || is_free_of_impacts;
        // Rolling may end at the very end of the run, so that no interval follows it.
        let ends_otherwise = self
            .changes
            .last()
            .is_some_and(|change| change.phase != PegPhase::Rolling);
        let last_roll = intervals
            .last()
            .filter(|last| last.phase == PegPhase::Rolling && !ends_otherwise);
        let flights = in_phase(intervals, PegPhase::Flying);
        let rolls = in_phase(intervals, PegPhase::Rolling);
        PegSummary {
            hops: is_known.then_some(flights.len() as u64),
            impacts: knows_impacts.then_some(self.impacts),
            impact_loss: (knows_impacts && self.impact_loss.is_finite())
                .then_some(self.impact_loss),
            first_flight: flights.first().map(|flight| flight.from),
            time_in_air: is_known.then(|| total_duration(&flights)),
            highest: Some(self.highest).filter(|height| *height > 0.0),
            first_roll: rolls.first().map(|roll| roll.from),
            time_rolling: is_known.then(|| total_duration(&rolls)),
            rolls_to_end_from: last_roll.map(|roll| roll.from),
            rolls_to_end_at: last_roll.map(|roll| roll.theta),
            lost: self.lost,
            jellett: self.jellett.map(|jellett| jellett.first),
            jellett_deviation: self
                .jellett
                .map(|jellett| jellett.deviation() / self.jellett_terms.max(jellett.first.abs())),
            farthest: self.travel.map(|travel| travel.farthest),
        }
    }
}

/// The intervals of a phase.
pub(crate) fn in_phase(intervals: &[Interval], phase: PegPhase) -> Vec<Interval> {
    let mut found = intervals.to_vec();
    found.retain(|interval| interval.phase == phase);
    found
}

/// Total duration, s.
fn total_duration(intervals: &[Interval]) -> f64 {
    let mut total = 0.0;
    // Not `sum`, which is −0 of nothing.
    for interval in intervals {
        total += interval.duration();
    }
    total
}

/// A summary of the motion of a free peg. Values derived from events are absent in recordings without events.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PegSummary {
    /// Number of hops, from lift-off to landing; bounces in between don't count.
    pub hops: Option<u64>,
    /// Number of impacts; absent if they were not recorded.
    pub impacts: Option<u64>,
    /// The energy that these took, J.
    pub impact_loss: Option<f64>,
    /// Time at which the peg was first in the air, s; 0 if the run starts in the air.
    pub first_flight: Option<f64>,
    /// Time in the air, impacts between bounces included, s.
    pub time_in_air: Option<f64>,
    /// Height above the table of the highest sample, m.
    pub highest: Option<f64>,
    /// Time at which the peg first rolled, s.
    pub first_roll: Option<f64>,
    /// Time in which the peg rolled, s.
    pub time_rolling: Option<f64>,
    /// Start of rolling that lasts to the end of the run, s; absent if the peg does not roll at the end.
    pub rolls_to_end_from: Option<f64>,
    /// Inclination θ at that moment, rad.
    pub rolls_to_end_at: Option<f64>,
    /// Energy dissipated by sliding, other losses, restitution and friction in impacts, J.
    pub lost: Option<[f64; 4]>,
    /// Jellett's integral at the start, kg m³/s.
    pub jellett: Option<f64>,
    /// The largest deviation of Jellett's integral, relative to the sum of its terms.
    pub jellett_deviation: Option<f64>,
    /// The largest distance of the contact point from its start among the samples, m.
    pub farthest: Option<f64>,
}
