//! Quantities of a run that only an explanation needs.

use super::momentum::{MomentumHistory, MomentumSpan};
use crate::analysis::history::Extent;
use crate::physics::dynamics::Model;
use crate::run::simulation::{EventKind, Regime};
use crate::run::time::seconds;
use crate::telemetry::Message;
use crate::telemetry::fields::{
    CENTER_OF_MASS, CONTACT, ENERGY, EVENTS, IMPACTS, NUTATION, STATE, center_of_mass, contact,
    energy, events, state,
};

/// The samples since the contact point stopped slipping.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct GripSpan {
    /// Time at which it stopped slipping, s.
    pub(super) from: f64,
    /// Inclination then, rad.
    pub(super) theta_at_start: f64,
    /// The motion before.
    pub(super) before: Passage,
    /// Inclination in the samples since then, rad; absent if there are none.
    pub(super) theta: Option<Extent>,
    /// Energy in these samples, J.
    pub(super) energy: Option<Extent>,
}

/// The motion since the end of the last nutation, or since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Passage {
    /// Angular momenta in its complete samples; absent without one.
    pub(super) span: Option<MomentumSpan>,
    /// Number of impacts in the run up to its end.
    pub(super) impacts: u64,
}

/// The times of the impacts.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ImpactTimes {
    /// Number of impacts.
    pub(super) count: u64,
    /// Time of the last impact, s.
    pub(super) last: f64,
    /// The longest time between successive impacts, s; 0 if there is only one.
    pub(super) longest_gap: f64,
}

impl ImpactTimes {
    fn take(times: &mut Option<Self>, time: f64) {
        let longest_gap = times.map_or(0.0, |known| known.longest_gap.max(time - known.last));
        *times = Some(Self {
            count: times.map_or(1, |known| known.count + 1),
            last: time,
            longest_gap,
        });
    }
}

/// What is observed of a run in one pass.
#[derive(Clone, Debug, Default)]
pub(super) struct Observations {
    pub(super) momentum: MomentumHistory,
    /// The motion in each nutation; the first one begins with the run.
    pub(super) nutations: Vec<Passage>,
    /// Kinetic energy, J.
    pub(super) kinetic: Option<Extent>,
    /// Height of a free top's centre of mass above the table, m.
    pub(super) center_height: Option<Extent>,
    /// The samples since the contact point stopped slipping; absent if it slips or is in the air at the end.
    pub(super) grip: Option<GripSpan>,
    pub(super) impacts: Option<ImpactTimes>,
    /// Slip speed in the last sample, m/s; absent if the contact point does not slip then.
    pub(super) slip_speed: Option<f64>,
}

impl Observations {
    /// Creates the observations of a run of this model.
    pub(super) fn new(model: &Model) -> Self {
        Self {
            momentum: MomentumHistory::new(model),
            ..Self::default()
        }
    }

    pub(super) fn take(&mut self, message: &Message<'_>) {
        self.momentum.take(message);
        match message.topic() {
            STATE => {
                if let Some(grip) = &mut self.grip {
                    Extent::take(&mut grip.theta, state::THETA.of(message));
                }
            }
            ENERGY => {
                Extent::take(&mut self.kinetic, energy::KINETIC.of(message));
                if let Some(grip) = &mut self.grip {
                    Extent::take(&mut grip.energy, energy::TOTAL.of(message));
                }
            }
            CENTER_OF_MASS => {
                let height = center_of_mass::POSITION.z().of(message);
                Extent::take(&mut self.center_height, height);
            }
            NUTATION => {
                let nutation = self.latest();
                self.nutations.push(nutation);
                self.momentum.mark();
            }
            CONTACT => {
                let regime = Regime::from_code(contact::REGIME.of(message));
                let speed = contact::SLIP_SPEED.of(message);
                // That of a peg in the air is no slip.
                self.slip_speed =
                    Some(speed).filter(|speed| regime == Some(Regime::Slipping) && *speed > 0.0);
            }
            EVENTS => self.take_event(message),
            IMPACTS => ImpactTimes::take(&mut self.impacts, seconds(message.time_ns)),
            _ => {}
        }
    }

    /// The motion since the last nutation.
    pub(super) fn latest(&self) -> Passage {
        Passage {
            span: self.momentum.since_mark,
            impacts: self.impacts.map_or(0, |impacts| impacts.count),
        }
    }

    fn take_event(&mut self, message: &Message<'_>) {
        match EventKind::find(events::NAME.of(message)) {
            Some(EventKind::Stick | EventKind::SlipStops | EventKind::RollBegins) => {
                self.grip = Some(GripSpan {
                    from: events::TIME.of(message),
                    theta_at_start: events::THETA.of(message),
                    before: self.latest(),
                    ..GripSpan::default()
                });
            }
            Some(EventKind::SlipResumes | EventKind::RollEnds | EventKind::LiftOff) => {
                self.grip = None;
            }
            _ => {}
        }
    }

    /// Completes what is pending after the last message.
    pub(super) fn finish(&mut self) {
        self.momentum.finish_sample();
    }
}
