//! What a free peg did: where it slid, rolled and flew, how it landed, and what it lost.

use super::event::Event;
use super::swing::swing;
use crate::physics::dynamics::Model;
use crate::physics::kinematics::Euler;
use crate::run::simulation::EventKind;
use crate::telemetry::Message;
use crate::telemetry::fields::{
    CENTER_OF_MASS, CONTACT, ENERGY, FREE_PEG, IMPACTS, MOMENTUM, STATE, center_of_mass, contact,
    energy, free_peg, impacts, momentum, state,
};
use schemars::JsonSchema;
use serde::Serialize;

/// What a peg does for a while.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Doing {
    /// Slides over the table.
    Slides,
    /// Rolls on it: the contact point does not slip.
    Rolls,
    /// Is in the air, or touches the table in impacts only.
    Flies,
}

/// A time in which a peg does one thing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spell {
    pub(crate) doing: Doing,
    /// When it begins and ends, s.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// Inclination θ when it begins, rad.
    pub(crate) theta: f64,
    /// φ̇ and ψ̇ then, rad/s.
    pub(crate) rates: [f64; 2],
}

impl Spell {
    pub(crate) fn duration(&self) -> f64 {
        self.to - self.from
    }
}

/// An impact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Impact {
    /// When, s.
    pub(crate) time: f64,
    /// How fast the peg came down, m/s.
    pub(crate) speed: f64,
}

/// What is recorded while a peg rolls, from the first sample in which it does to the last.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rolled {
    /// The time of the first and the last sample, s.
    pub(crate) span: [f64; 2],
    /// Least and greatest θ in samples, rad.
    pub(crate) thetas: [f64; 2],
    /// Least and greatest θ that the integrals of rolling allow, rad; none where something brakes a rolling top, or nothing
    /// bounds it.
    pub(crate) swing: Option<[f64; 2]>,
    /// Energy in the first and the last sample, J.
    pub(crate) energies: [f64; 2],
    /// Routh's integral in the first sample, and how far it was from that at most, kg m²/s.
    pub(crate) routh: [f64; 2],
    /// The greatest friction force in samples as a part of the normal force; NaN where it is not recorded.
    pub(crate) grip: f64,
}

/// The regime of a peg in the air, as `/top/contact` has it.
const FLYING: f64 = 2.0;

/// The greater of two numbers; NaN if one is, so that what was not recorded once is not known.
fn greater(one: f64, other: f64) -> f64 {
    if one > other || one.is_nan() {
        one
    } else {
        other
    }
}

/// What a free peg did, collected message by message.
#[derive(Clone, Debug)]
pub(crate) struct PegCourse {
    model: Model,
    /// What it does from some time on.
    turns: Vec<(Doing, Event)>,
    pub(crate) impacts: Vec<Impact>,
    /// The height above the table of the highest sample in each flight from impact to impact (m), with its time (s).
    pub(crate) peaks: Vec<(f64, f64)>,
    flies_at_first: bool,
    has_begun: bool,
    /// Whether there are events: without them nothing is known of what it does.
    has_events: bool,
    /// Of the last sample: inclination (rad) and rates (rad/s), the energy (J), the friction force as a part of the normal
    /// force, and the angular momentum about the axis (kg m²/s).
    leaning: (f64, Euler),
    energy: f64,
    grip: f64,
    axial: f64,
    rolling: Option<Rolled>,
    rolls: bool,
    pub(crate) rolled: Vec<Rolled>,
    /// Jellett's integral in the first sample, and how far it was from that at most, kg m³/s.
    pub(crate) jellett: Option<[f64; 2]>,
    /// The greatest sum of the magnitudes of its two terms, |l L_n| + |R L_z′|, kg m³/s: what its errors are to be compared
    /// with. Zero where the terms are not recorded.
    jellett_terms: f64,
    /// What sliding, other losses, restitution and friction in impacts have taken, J.
    pub(crate) lost: Option<[f64; 4]>,
    /// Kinetic energy of the centre of mass in the first and the last sample, J.
    pub(crate) translational: Option<[f64; 2]>,
    /// The contact point in the first sample, and how far it has been from there at most, m.
    pub(crate) travelled: Option<([f64; 2], f64)>,
}

impl PegCourse {
    pub(super) fn new(model: Model) -> Self {
        Self {
            model,
            turns: Vec::new(),
            impacts: Vec::new(),
            peaks: Vec::new(),
            flies_at_first: false,
            has_begun: false,
            has_events: false,
            leaning: (f64::NAN, Euler::default()),
            energy: f64::NAN,
            grip: f64::NAN,
            axial: f64::NAN,
            rolling: None,
            rolls: false,
            rolled: Vec::new(),
            jellett: None,
            jellett_terms: 0.0,
            lost: None,
            translational: None,
            travelled: None,
        }
    }

    /// Takes in a message of the table.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        let time = message.time_ns as f64 / 1e9;
        match message.topic() {
            STATE => self.state(message),
            ENERGY => self.energy = energy::TOTAL.of(message),
            CONTACT => self.contact(message),
            MOMENTUM => self.axial = momentum::AXIAL.of(message),
            CENTER_OF_MASS => {
                let vertical = center_of_mass::ANGULAR_MOMENTUM.of(message).z;
                let top = &self.model.top;
                let terms = [top.center_distance * self.axial, top.peg_radius * vertical];
                let size = terms.iter().map(|term| term.abs()).sum();
                self.jellett_terms = self.jellett_terms.max(size);
            }
            FREE_PEG => self.free_peg(message, time),
            IMPACTS => {
                self.impacts.push(Impact {
                    time: impacts::TIME.of(message),
                    speed: -impacts::BEFORE.of(message).z,
                });
                self.peaks.push((f64::NEG_INFINITY, f64::NAN));
            }
            _ => {}
        }
    }

    /// Takes in an event.
    pub(super) fn event(&mut self, event: &Event) {
        self.has_events = true;
        let doing = match EventKind::find(&event.name) {
            Some(EventKind::LiftOff) => Doing::Flies,
            Some(EventKind::Landing | EventKind::RollEnds) => Doing::Slides,
            Some(EventKind::RollBegins) => Doing::Rolls,
            _ => return,
        };
        if self.turns.is_empty() {
            self.flies_at_first |= event.name == EventKind::Landing.name();
        }
        if doing == Doing::Flies {
            self.peaks.push((f64::NEG_INFINITY, f64::NAN));
        }
        self.rolls = doing == Doing::Rolls;
        self.rolled.extend(self.rolling.take());
        self.turns.push((doing, event.clone()));
    }

    fn state(&mut self, message: &Message<'_>) {
        let rates = [state::PHI_DOT, state::THETA_DOT, state::PSI_DOT];
        let [phi, theta, psi] = rates.map(|field| field.of(message));
        self.leaning = (state::THETA.of(message), Euler { phi, theta, psi });
        // What isn't recorded of this sample isn't known.
        (self.energy, self.grip) = (f64::NAN, f64::NAN);
    }

    fn contact(&mut self, message: &Message<'_>) {
        // A peg that is thrown up begins at the table, but in the air.
        self.flies_at_first |= self.travelled.is_none() && contact::REGIME.of(message) == FLYING;
        let point = contact::CONTACT_POINT.of(message);
        let (first, farthest) = self.travelled.get_or_insert(([point.x, point.y], 0.0));
        let away = crate::physics::math::hypot(point.x - first[0], point.y - first[1]);
        *farthest = farthest.max(away);
        self.grip = contact::FRICTION_FORCE.of(message).norm() / contact::NORMAL_FORCE.of(message);
    }

    fn free_peg(&mut self, message: &Message<'_>, time: f64) {
        let gap = free_peg::GAP.of(message);
        if !self.has_begun {
            self.has_begun = true;
            self.flies_at_first |= gap > 0.0;
        }
        if gap > 0.0 {
            if self.peaks.is_empty() {
                self.peaks.push((f64::NEG_INFINITY, f64::NAN));
            }
            if let Some(peak) = self.peaks.last_mut().filter(|(peak, _)| gap > *peak) {
                *peak = (gap, time);
            }
        }
        let jellett = free_peg::JELLETT.of(message);
        let [first, drift] = self.jellett.get_or_insert([jellett, 0.0]);
        *drift = drift.max((jellett - *first).abs());
        let translational = free_peg::TRANSLATIONAL.of(message);
        let [_, last] = self.translational.get_or_insert([translational; 2]);
        *last = translational;
        let lost = [
            free_peg::LOST_SLIDING,
            free_peg::LOST_LOSSES,
            free_peg::LOST_RESTITUTION,
            free_peg::LOST_IMPACT_FRICTION,
        ];
        self.lost = Some(lost.map(|field| field.of(message)));
        self.roll(free_peg::ROUTH.of(message), time);
    }

    fn roll(&mut self, routh: f64, time: f64) {
        if !self.rolls {
            return;
        }
        let (theta, rates) = self.leaning;
        let is_lossless = !self.model.friction.has_losses();
        let rolling = self.rolling.get_or_insert_with(|| Rolled {
            span: [time; 2],
            thetas: [theta; 2],
            swing: swing(&self.model, theta, rates).filter(|_| is_lossless),
            energies: [self.energy; 2],
            routh: [routh, 0.0],
            grip: self.grip,
        });
        rolling.span[1] = time;
        super::cycle::widen(&mut rolling.thetas, theta);
        rolling.energies[1] = self.energy;
        rolling.grip = greater(rolling.grip, self.grip);
        let drift = (routh - rolling.routh[0]).abs();
        rolling.routh[1] = rolling.routh[1].max(drift);
    }

    /// What the errors of Jellett's integral are to be compared with, kg m³/s.
    pub(crate) fn jellett_size(&self) -> f64 {
        let value = self.jellett.map_or(0.0, |[first, _]| first.abs());
        self.jellett_terms.max(value)
    }

    /// The impacts, if they are recorded.
    pub(crate) fn known_impacts(&self) -> Option<&[Impact]> {
        let landing = EventKind::Landing.name();
        let has_landed = self.turns.iter().any(|(_, event)| event.name == landing);
        (!has_landed || !self.impacts.is_empty()).then_some(&self.impacts)
    }

    /// Takes in the end of the run.
    pub(super) fn finish(&mut self) {
        self.rolled.extend(self.rolling.take());
        self.peaks.retain(|(height, _)| height.is_finite());
    }

    /// What the peg did from the start to `end`, s, one thing after the other.
    pub(crate) fn spells(&self, end: f64) -> Vec<Spell> {
        let first = if self.flies_at_first {
            Doing::Flies
        } else {
            Doing::Slides
        };
        let mut spells = vec![Spell {
            doing: first,
            from: 0.0,
            to: end,
            theta: f64::NAN,
            rates: [f64::NAN; 2],
        }];
        for (doing, event) in &self.turns {
            if let Some(last) = spells.last_mut() {
                last.to = event.time;
            }
            spells.push(Spell {
                doing: *doing,
                from: event.time,
                to: end,
                theta: event.theta,
                rates: event.rates,
            });
        }
        // What begins and ends at one moment was a name for it only.
        spells.retain(|spell| spell.to > spell.from);
        let mut joined: Vec<Spell> = Vec::new();
        for spell in spells {
            match joined.last_mut() {
                Some(last) if last.doing == spell.doing => last.to = spell.to,
                _ => joined.push(spell),
            }
        }
        joined
    }

    pub(super) fn report(&self, end: f64) -> PegReport {
        let spells = self.spells(end);
        let of = |doing: Doing| spells.iter().filter(move |spell| spell.doing == doing);
        let is_known = self.has_events;
        // Not summed: the sum of nothing is −0.
        let time_of = |doing: Doing| {
            let time = of(doing)
                .map(Spell::duration)
                .fold(0.0, |all, one| all + one);
            is_known.then_some(time)
        };
        let last = spells.last();
        let highest = self.peaks.iter().map(|(height, _)| *height);
        let last = last.filter(|_| is_known);
        let rolls = last.filter(|spell| spell.doing == Doing::Rolls);
        let rolled = rolls.and(self.rolled.last());
        let [sliding, losses, restitution, friction] = self
            .lost
            .map_or([None; 4], |lost| lost.map(|lost| Some(lost + 0.0)));
        PegReport {
            is_tippe: self.model.top.center_distance < 0.0,
            flights: is_known.then(|| of(Doing::Flies).count() as u64),
            first_flight: of(Doing::Flies).next().map(|spell| spell.from),
            time_in_air: time_of(Doing::Flies),
            time_rolling: time_of(Doing::Rolls),
            time_sliding: time_of(Doing::Slides),
            highest: highest.fold(None, |most: Option<f64>, height| {
                Some(most.map_or(height, |most| most.max(height)))
            }),
            impacts: self.known_impacts().map(|impacts| impacts.len() as u64),
            first_roll: of(Doing::Rolls).next().map(|spell| spell.from),
            doing_last: last.map(|spell| spell.doing),
            rolls_from: rolls.map(|spell| spell.from),
            rolls_at: rolls.map(|spell| spell.theta),
            rolling_theta: rolled.map(|rolled| rolled.thetas),
            rolling_swing: rolled.and_then(|rolled| rolled.swing),
            lost_sliding: sliding,
            lost_losses: losses,
            lost_restitution: restitution,
            lost_impact_friction: friction,
            jellett: self.jellett.map(|[first, _]| first),
            jellett_drift: self.jellett.map(|[_, drift]| drift),
            jellett_terms: self.jellett.map(|_| self.jellett_size()),
            farthest: self.travelled.map(|(_, farthest)| farthest),
        }
    }
}

/// What a free peg did in one run.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct PegReport {
    /// Whether the centre of mass is below the centre of the sphere when the axis is upright: a tippe top.
    pub is_tippe: bool,
    /// How many times the peg was in the air, bounces not counted; none without events, like all that follows from them.
    pub flights: Option<u64>,
    /// When the peg was first in the air, s; 0 if the run begins so.
    pub first_flight: Option<f64>,
    /// Time in the air, impacts between bounces included, s.
    pub time_in_air: Option<f64>,
    /// Time in which the peg rolled, s.
    pub time_rolling: Option<f64>,
    /// Time in which the peg slid, s.
    pub time_sliding: Option<f64>,
    /// Height above the table of the highest sample, m.
    pub highest: Option<f64>,
    /// Number of impacts; none if they were not recorded.
    pub impacts: Option<u64>,
    /// When the peg first rolled, s.
    pub first_roll: Option<f64>,
    /// What the peg did at the end of the run.
    pub doing_last: Option<Doing>,
    /// From when on the peg rolled to the end of the run, s; none if it did something else then.
    pub rolls_from: Option<f64>,
    /// Inclination θ at that moment, rad.
    pub rolls_at: Option<f64>,
    /// Least and greatest θ in the samples since then, rad.
    pub rolling_theta: Option<[f64; 2]>,
    /// Least and greatest θ that energy, Jellett's and Routh's integral allow as long as the peg rolls, rad; none where other
    /// torques take energy, or nothing bounds θ.
    pub rolling_swing: Option<[f64; 2]>,
    /// Energy that friction took along the path slipped, J.
    pub lost_sliding: Option<f64>,
    /// Energy that rolling resistance, drilling and air took, J.
    pub lost_losses: Option<f64>,
    /// Energy lost by compression and restitution in impacts, J.
    pub lost_restitution: Option<f64>,
    /// Energy lost by friction in impacts, J.
    pub lost_impact_friction: Option<f64>,
    /// Jellett's integral at first, kg m³/s.
    pub jellett: Option<f64>,
    /// How far Jellett's integral was from that at most, kg m³/s.
    pub jellett_drift: Option<f64>,
    /// The greatest sum of the magnitudes of its terms l L_n and R L_z′, kg m³/s: they may cancel.
    pub jellett_terms: Option<f64>,
    /// How far the contact point was from where it began at most, in samples, m.
    pub farthest: Option<f64>,
}
