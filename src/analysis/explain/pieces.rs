//! The pieces of a run over which means are exact: its nutations, and the motion without nutation between them.

use super::totals::{Totals, is_vertical};
use crate::physics::dynamics::Model;
use crate::physics::kinematics::{Euler, Tilt, world_to_lean};
use crate::physics::top::Top;
use crate::run::simulation::EventKind;
use crate::telemetry::Message;
use crate::telemetry::fields::{
    ACCELERATION, CENTER_OF_MASS, CONTACT, EVENTS, MOMENTUM, NUTATION, STATE, acceleration,
    center_of_mass, contact, events, momentum, nutation, state,
};

/// What lasts longer than this many periods of nutation without being a nutation is a motion of its own; what is shorter
/// may be a part of one, whose mean says nothing. The simulation takes cycles for nutations up to the same limit.
const PERIODS: f64 = 2.0;
/// Samples are missing where more than this many sample periods are between two.
const HOLE: f64 = 1.5;
/// The most states that are kept of a motion without nutation; beyond, every second is dropped.
const STATES: usize = 4096;

/// A nutation, several, or a motion without nutation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Piece {
    /// When it begins and ends, s.
    pub(super) from: f64,
    pub(super) to: f64,
    /// How many nutations it is; 0 for a motion without nutation.
    pub(super) nutations: u64,
    /// Whether the contact point sticks.
    pub(super) sticks: bool,
    /// Whether the peg rolls from its beginning on.
    pub(super) rolls: bool,
    /// Mean inclination, rad.
    pub(super) theta: f64,
    /// Mean Euler rates, rad/s.
    pub(super) rates: Euler,
    /// Mean of the frictional term of φ̈, rad/s²; NaN where it isn't recorded.
    pub(super) friction: f64,
    /// What regular precession would be: the means of that at the mean motion of each nutation.
    pub(super) regular: Regular,
    /// Means of the angular momenta about the axis and the vertical over its samples, kg m²/s, or what is between those
    /// around it if it has none; NaN where they are not recorded. They change by friction alone, slowly.
    pub(super) momenta: [f64; 2],
    /// What its samples tell of the contact; NaN where it has none.
    pub(super) contact: ContactMeans,
    /// Half the range of θ̇, rad/s; NaN where it isn't recorded.
    pub(super) swing: f64,
}

/// The contact during a nutation, as samples show it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ContactMeans {
    /// Mean slip speed, m/s.
    pub(super) slip: f64,
    /// Mean of the slip along the line of nodes, m/s.
    pub(super) along: f64,
    /// Least and greatest normal force, N.
    pub(super) loads: [f64; 2],
}

impl ContactMeans {
    const NONE: Self = Self {
        slip: f64::NAN,
        along: f64::NAN,
        loads: [f64::NAN; 2],
    };

    fn of(states: &[State]) -> Self {
        let loads = || states.iter().map(|state| state.contact[1]);
        let mean =
            |of: &dyn Fn(&State) -> f64| states.iter().map(of).sum::<f64>() / states.len() as f64;
        match states {
            [] => Self::NONE,
            _ => Self {
                slip: mean(&|state| state.contact[0]),
                along: mean(&|state| state.along),
                loads: [
                    loads().fold(f64::INFINITY, f64::min),
                    loads().fold(f64::NEG_INFINITY, f64::max),
                ],
            },
        }
    }
}

/// What follows from a mean motion. NaN where it is not defined: while the contact point sticks, near upright, where
/// precession and spin can hardly be told apart, and where the rates of regular precession are not real.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Regular {
    /// Slow and fast rate of regular precession, rad/s.
    pub(super) roots: [f64; 2],
    /// The θ̇ at which the gyroscopic and Coriolis terms of φ̈ cancel the frictional one, rad/s; NaN where there is none.
    pub(super) demanded: f64,
}

impl Regular {
    const NONE: Self = Self {
        roots: [f64::NAN; 2],
        demanded: f64::NAN,
    };

    /// At a mean motion with a mean of the frictional term of φ̈, rad/s².
    fn at(top: &Top, theta: f64, rates: Euler, friction: f64) -> Self {
        if is_vertical(theta) {
            return Self::NONE;
        }
        let tilt = Tilt::from_rates(theta, rates);
        let gyroscopic = top.axial_moment / top.transverse_moment * tilt.axial_rate();
        let answer = (gyroscopic - 2.0 * rates.phi * tilt.cos) / tilt.sin;
        let roots = top.precession_roots(&tilt);
        Self {
            roots: roots.map_or([f64::NAN; 2], |roots| [roots.slow, roots.fast]),
            demanded: if friction == 0.0 {
                f64::NAN
            } else {
                -friction / answer
            },
        }
    }
}

impl Piece {
    pub(super) fn duration(&self) -> f64 {
        self.to - self.from
    }

    /// The mean motion as if it were the motion at one instant.
    pub(super) fn tilt(&self) -> Tilt {
        Tilt::from_rates(self.theta, self.rates)
    }

    /// Several pieces as one, their means weighted by their durations.
    pub(super) fn together(pieces: &[Self]) -> Option<Self> {
        let (first, last) = (pieces.first()?, pieces.last()?);
        let duration: f64 = pieces.iter().map(Self::duration).sum();
        let mean = |of: fn(&Self) -> f64| {
            let sum: f64 = pieces
                .iter()
                .map(|piece| of(piece) * piece.duration())
                .sum();
            sum / duration
        };
        Some(Self {
            from: first.from,
            to: last.to,
            nutations: pieces.iter().map(|piece| piece.nutations).sum(),
            sticks: pieces.iter().any(|piece| piece.sticks),
            rolls: pieces.iter().all(|piece| piece.rolls),
            theta: mean(|p| p.theta),
            rates: Euler {
                phi: mean(|p| p.rates.phi),
                theta: mean(|p| p.rates.theta),
                psi: mean(|p| p.rates.psi),
            },
            friction: mean(|p| p.friction),
            regular: Regular {
                roots: [mean(|p| p.regular.roots[0]), mean(|p| p.regular.roots[1])],
                demanded: mean(|p| p.regular.demanded),
            },
            momenta: [f64::NAN; 2],
            contact: ContactMeans::NONE,
            swing: f64::NAN,
        })
    }
}

/// A point of the averaged motion: the middle of a nutation with its mean, or a state of a motion without nutation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    /// Time, s.
    pub(super) time: f64,
    /// Inclination, rad.
    pub(super) theta: f64,
    /// Whether it is a mean.
    pub(super) is_mean: bool,
    pub(super) sticks: bool,
    /// Whether the peg rolls.
    pub(super) rolls: bool,
}

/// A state.
#[derive(Clone, Copy, Debug)]
struct State {
    time: f64,
    angles: Euler,
    rates: Euler,
    friction: f64,
    momenta: [f64; 2],
    /// Slip speed (m/s) and normal force (N).
    contact: [f64; 2],
    /// The slip along the line of nodes, m/s.
    along: f64,
}

/// Collects the pieces of a run, message by message.
#[derive(Clone, Debug)]
pub(super) struct Pieces {
    model: Model,
    /// The top as it nutates.
    top: Top,
    pub(super) pieces: Vec<Piece>,
    pub(super) path: Vec<Point>,
    /// The states since the last piece.
    open: Vec<State>,
    /// The last angular momenta about the axis and the vertical (kg m²/s), with their time (s).
    momenta: Option<(f64, [f64; 2])>,
    sticks: bool,
    /// From when on the peg rolls, s.
    rolls_from: Option<f64>,
    /// The angular momentum about the axis, kg m²/s, in the last message about it.
    axial: f64,
    pub(super) totals: Totals,
    /// The first and the last state: time (s) and inclination (rad).
    pub(super) ends: Option<[(f64, f64); 2]>,
    /// Least and greatest inclination in a sample, rad.
    pub(super) range: [f64; 2],
    pub(super) samples: u64,
}

impl Pieces {
    pub(super) fn new(model: Model) -> Self {
        Self {
            model,
            top: model.nutating_top(),
            pieces: Vec::new(),
            path: Vec::new(),
            open: Vec::new(),
            momenta: None,
            sticks: false,
            rolls_from: None,
            axial: f64::NAN,
            totals: Totals::default(),
            ends: None,
            range: [f64::INFINITY, f64::NEG_INFINITY],
            samples: 0,
        }
    }

    /// Takes in a message of the table.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        match message.topic() {
            STATE => self.state(message),
            ACCELERATION => {
                if let Some(last) = self.open.last_mut() {
                    last.friction = acceleration::PHI_DOT_FRICTIONAL.of(message);
                }
                self.totals.acceleration(message);
            }
            CONTACT => {
                self.totals.contact(message);
                if let Some(last) = self.open.last_mut() {
                    last.contact =
                        [contact::SLIP_SPEED, contact::NORMAL_FORCE].map(|field| field.of(message));
                    let slip = world_to_lean(&contact::SLIP_WORLD.of(message), last.angles.phi);
                    last.along = slip.y;
                }
            }
            MOMENTUM => {
                self.axial = momentum::AXIAL.of(message);
                if !self.model.support.is_free() {
                    self.momentum(message.time_ns, momentum::VERTICAL.of(message));
                }
            }
            // That of a free top about its centre of mass is what friction and weight alone change.
            CENTER_OF_MASS => {
                let vertical = center_of_mass::ANGULAR_MOMENTUM.of(message).z;
                self.momentum(message.time_ns, vertical);
            }
            NUTATION => self.nutation(message),
            EVENTS => self.event(message),
            _ => {}
        }
    }

    /// Takes in the end of the run.
    pub(super) fn finish(&mut self) {
        self.close(f64::INFINITY);
    }

    fn state(&mut self, message: &Message<'_>) {
        let value = |field: crate::telemetry::fields::NumberField| field.of(message);
        let state = State {
            time: message.time_ns as f64 / 1e9,
            angles: Euler {
                phi: value(state::PHI),
                theta: value(state::THETA),
                psi: value(state::PSI),
            },
            rates: Euler {
                phi: value(state::PHI_DOT),
                theta: value(state::THETA_DOT),
                psi: value(state::PSI_DOT),
            },
            friction: f64::NAN,
            momenta: [f64::NAN; 2],
            contact: [f64::NAN; 2],
            along: f64::NAN,
        };
        let theta = state.angles.theta;
        // A hole in the recording is no motion without nutation.
        if let (Some(step), Some([_, (before, _)])) = (self.totals.step(), self.ends)
            && state.time - before > HOLE * step
        {
            self.close(f64::INFINITY);
        }
        let now = (state.time, theta);
        self.ends = Some([self.ends.map_or(now, |[first, _]| first), now]);
        let [least, greatest] = self.range;
        self.range = [
            if theta < least { theta } else { least },
            if theta > greatest { theta } else { greatest },
        ];
        self.samples += 1;
        self.totals
            .state(message, &self.top, self.sticks, state.time);
        self.open.push(state);
        if self.open.len() > STATES {
            let mut index = 0;
            self.open.retain(|_| {
                index += 1;
                index % 2 == 1
            });
        }
    }

    fn momentum(&mut self, time_ns: u64, vertical: f64) {
        let now = time_ns as f64 / 1e9;
        let momenta = [self.axial, vertical];
        if let Some(last) = self.open.last_mut() {
            last.momenta = momenta;
        }
        let Some((before, others)) = self.momenta.replace((now, momenta)) else {
            return;
        };
        // The nutations since then met no sample.
        for piece in self.pieces.iter_mut().rev() {
            if !piece.momenta[0].is_nan() || piece.from < before {
                break;
            }
            let part = (piece.from + 0.5 * piece.duration() - before) / (now - before);
            piece.momenta = [0, 1].map(|i| others[i] + part * (momenta[i] - others[i]));
        }
    }

    fn nutation(&mut self, message: &Message<'_>) {
        let value = |field: crate::telemetry::fields::NumberField| field.of(message);
        let (start, period) = (value(nutation::START), value(nutation::PERIOD));
        self.close(start);
        let momenta = [0, 1].map(|index| {
            let sum: f64 = self.open.iter().map(|state| state.momenta[index]).sum();
            sum / self.open.len() as f64
        });
        let theta = value(nutation::THETA_MEAN);
        let rates = Euler {
            phi: value(nutation::PHI_DOT_MEAN),
            theta: value(nutation::THETA_DOT_MEAN),
            psi: value(nutation::PSI_DOT_MEAN),
        };
        let friction = value(nutation::PHI_DDOT_FRICTIONAL_MEAN);
        let [slowest, fastest] =
            [nutation::THETA_DOT_MIN, nutation::THETA_DOT_MAX].map(|field| field.of(message));
        let is_held = !self.model.support.is_free();
        let rolls = self.rolls_from.is_some_and(|from| start >= from);
        let piece = Piece {
            from: start,
            to: start + period,
            nutations: 1,
            sticks: false,
            rolls,
            theta,
            rates,
            friction,
            regular: match rolls {
                true => Regular::NONE,
                // A free peg's own acceleration is in φ̈ too, so that nothing follows from friction's term alone.
                false => Regular::at(
                    &self.top,
                    theta,
                    rates,
                    if is_held { friction } else { 0.0 },
                ),
            },
            momenta,
            contact: ContactMeans::of(&self.open),
            swing: 0.5 * (fastest - slowest),
        };
        self.open.clear();
        // Recordings of the first version took falls for nutations; damaged ones may hold anything.
        if self.is_nutation(message, &piece) {
            self.path.push(Point {
                time: start + 0.5 * period,
                theta: piece.theta,
                is_mean: true,
                sticks: false,
                rolls,
            });
            self.pieces.push(piece);
        }
    }

    fn is_nutation(&self, message: &Message<'_>, piece: &Piece) -> bool {
        let extremes = [nutation::THETA_MIN, nutation::THETA_MAX].map(|field| field.of(message));
        let is_known = piece.theta.is_finite() && piece.duration() > 0.0;
        // Free pegs came later; a cycle may begin in sliding and end in rolling.
        if self.model.support.is_free() {
            return is_known;
        }
        let period = self.top.nutation_period(&piece.tilt(), extremes);
        is_known && period.is_none_or(|period| piece.duration() <= PERIODS * period)
    }

    fn event(&mut self, message: &Message<'_>) {
        let time = events::TIME.of(message);
        match EventKind::find(events::NAME.of(message)) {
            Some(EventKind::Stick) => {
                self.close(time);
                self.open.clear();
                self.sticks = true;
            }
            Some(EventKind::RollBegins) => {
                self.close(time);
                self.rolls_from = Some(time);
            }
            Some(EventKind::RollEnds) => {
                self.close(time);
                self.rolls_from = None;
            }
            Some(EventKind::SlipResumes | EventKind::Rest) => {
                self.close(time);
                self.open.clear();
                self.sticks = false;
            }
            _ => {}
        }
    }

    /// Makes a piece of the states before `time`, if they are a motion without nutation.
    fn close(&mut self, time: f64) {
        let count = self.open.partition_point(|state| state.time <= time);
        let states: Vec<State> = self.open.drain(..count).collect();
        let ([first, ..], [.., last]) = (states.as_slice(), states.as_slice()) else {
            return;
        };
        let duration = last.time - first.time;
        if duration <= 0.0 || (!self.sticks && duration <= PERIODS * self.period(&states)) {
            return;
        }
        // What nods and is no nutation has been broken by impacts, or by rolling that begins or ends: its mean says nothing.
        let nods = states
            .windows(2)
            .filter(|pair| pair[0].rates.theta * pair[1].rates.theta < 0.0)
            .count();
        if self.model.support.is_free() && nods > 1 {
            return;
        }
        let area: f64 = states
            .windows(2)
            .map(|pair| {
                0.5 * (pair[0].angles.theta + pair[1].angles.theta) * (pair[1].time - pair[0].time)
            })
            .sum();
        let rate = |of: fn(&State) -> f64| (of(last) - of(first)) / duration;
        let theta = area / duration;
        let rates = Euler {
            phi: rate(|s| s.angles.phi),
            theta: rate(|s| s.angles.theta),
            psi: rate(|s| s.angles.psi),
        };
        let friction = rate(|s| s.friction);
        self.pieces.push(Piece {
            from: first.time,
            to: last.time,
            nutations: 0,
            sticks: self.sticks,
            rolls: self.rolls_from.is_some_and(|from| first.time >= from),
            theta,
            rates,
            friction,
            regular: match self.sticks {
                true => Regular::NONE,
                false => Regular::at(&self.top, theta, rates, friction),
            },
            momenta: [f64::NAN; 2],
            contact: ContactMeans::NONE,
            swing: f64::NAN,
        });
        let sticks = self.sticks;
        let rolls_from = self.rolls_from;
        let points = states.iter().map(|state| Point {
            time: state.time,
            theta: state.angles.theta,
            is_mean: false,
            sticks,
            rolls: rolls_from.is_some_and(|from| state.time >= from),
        });
        self.path.extend(points);
    }

    /// How long a nutation takes where some states are, s.
    fn period(&self, states: &[State]) -> f64 {
        let Some(first) = states.first() else {
            return f64::INFINITY;
        };
        let tilt = Tilt::from_rates(first.angles.theta, first.rates);
        let angles = states.iter().map(|state| state.angles.theta);
        let extremes = angles.fold(
            [f64::INFINITY, f64::NEG_INFINITY],
            |[least, greatest], x| {
                [
                    if x < least { x } else { least },
                    if x > greatest { x } else { greatest },
                ]
            },
        );
        let nutation = self.pieces.iter().rev().find(|piece| piece.nutations > 0);
        let top = match self.rolls_from {
            Some(_) => self.model.rolling_top(tilt.cos),
            None => self.top,
        };
        top.nutation_period(&tilt, extremes)
            .or(nutation.map(Piece::duration))
            .unwrap_or(f64::INFINITY)
    }

    /// The nutations and motions without nutation in at most `count` stages with about the same number of nutations;
    /// motions without nutation are stages of their own.
    pub(super) fn in_stages(&self, count: usize) -> Vec<Piece> {
        let nutations = self
            .pieces
            .iter()
            .filter(|piece| piece.nutations > 0)
            .count();
        let share = nutations.div_ceil(count).max(1);
        let mut stages = Vec::new();
        for run in self.pieces.chunk_by(|a, b| {
            a.nutations > 0 && b.nutations > 0 && (b.from - a.to).abs() < 0.5 * a.duration()
        }) {
            stages.extend(run.chunks(share).filter_map(Piece::together));
        }
        stages
    }
}
