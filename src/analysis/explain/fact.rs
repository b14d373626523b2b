//! Facts of an explanation, and their text.

use crate::analysis::phrase::{ENERGY_ZERO, works};
use crate::physics::friction::Dissipation;
use crate::run::scenario::find_dissipation;
use crate::words::Piece;
use crate::words::number::{pair, significant};
use schemars::JsonSchema;
use serde::Serialize;

/// One of the two rates of regular precession.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum PrecessionRoot {
    /// The rate of the smaller size, at which gravity and the gyroscopic torque balance.
    Slow,
    /// The rate of the larger size, near that of a free top.
    Fast,
}

impl PrecessionRoot {
    fn name(self) -> &'static str {
        match self {
            Self::Slow => "slow",
            Self::Fast => "fast",
        }
    }
}

/// A fact about a run: numbers in SI units and radians.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Fact {
    /// The state in which the top starts.
    Start {
        /// Inclination, rad.
        theta: f64,
        /// Spin rate, rad/s.
        psi_dot: f64,
    },
    /// θ has reached `stop.theta_risen`.
    Risen {
        /// The level, rad.
        theta: f64,
        /// Time, s.
        time: f64,
    },
    /// θ has reached `stop.theta_fallen`, or π/2.
    Fallen {
        /// The level, rad.
        theta: f64,
        /// When, s.
        time: f64,
    },
    /// A tippe top's axis has passed the horizontal.
    Inverted {
        /// Time, s.
        time: f64,
    },
    /// A tippe top's axis has not passed the horizontal.
    NotInverted {
        /// The end of the run, s.
        time: f64,
    },
    /// A tippe top's axis has passed the horizontal, but is above it in the last sample.
    PassesHorizontal {
        /// Time of the first passage, s.
        time: f64,
    },
    /// Mean inclination in the first and last nutation.
    MeanTheta {
        /// In the first nutation, rad.
        first: f64,
        /// In the last nutation, rad.
        last: f64,
    },
    /// The inclination of the averaged motion did not change by more than the integrator's error.
    ThetaConstant {
        /// The mean, rad.
        theta: f64,
    },
    /// The inclination at the end, where the last nutation is not at the end of the run.
    End {
        /// In the last sample, rad.
        theta: f64,
        /// End of the last nutation, s; absent if there are fewer than two.
        nutation_end: Option<f64>,
    },
    /// The axis loops.
    Loops {
        /// Number of times.
        count: u64,
        /// Time at which the first loop begins, s.
        first: f64,
    },
    /// The contact point stops slipping.
    Sticks {
        /// When first, s.
        time: f64,
        /// Number of times.
        count: u64,
        /// Whether it slips again at the end.
        slips_at_end: bool,
    },
    /// The peg hops.
    Hops {
        /// Number, from lift-off to landing.
        count: u64,
        /// Time at which it first lifts off, s.
        first: f64,
    },
    /// Impacts of the peg.
    Impacts {
        /// Number.
        count: u64,
        /// Number after the last sample.
        after_samples: u64,
        /// Energy dissipated, J.
        lost: f64,
    },
    /// The peg rolls to the end.
    Rolls {
        /// Start time, s.
        from: f64,
        /// Inclination then, rad.
        theta: f64,
    },
    /// The peg rolls for some of the time.
    RollsAtTimes {
        /// Time of the first, s.
        first: f64,
        /// Total duration, s.
        duration: f64,
    },
    /// The mean φ̇ follows a rate of regular precession.
    FollowsRoot {
        /// The rate that it follows.
        root: PrecessionRoot,
        /// The largest difference, rad/s.
        within: f64,
    },
    /// Averaged over nutations, φ̇ follows neither rate of regular precession.
    FollowsNoRoot,
    /// There are no real rates of regular precession at the start.
    NoRoots,
    /// Friction's part in the change of φ̇.
    FrictionOnPrecession {
        /// The integral of friction's term in φ̈, rad/s.
        friction: f64,
        /// The change of φ̇, rad/s.
        change: f64,
    },
    /// The integral of friction's term in φ̈ is no more than the integrator's error.
    NoFrictionOnPrecession,
    /// The gyroscopic and Coriolis terms cancel friction's.
    TermsCancel {
        /// The mean θ̇ required for the balance, rad/s.
        demanded: f64,
        /// The mean θ̇, rad/s.
        mean: f64,
    },
    /// The horizontal part of the angular momentum.
    HorizontalMomentum {
        /// At the beginning, kg m²/s.
        first: f64,
        /// At the end of the rise, kg m²/s.
        last: f64,
        /// Time of the end of the rise, s; absent if the axis has not turned back since.
        until: Option<f64>,
    },
    /// The axis stays close to the line of the angular momentum.
    AngleToMomentum {
        /// The largest angle between them during the rise, rad.
        largest: f64,
    },
    /// The axis turns towards the line of the angular momentum.
    AngleToMomentumChange {
        /// The angle between them at the beginning, rad.
        first: f64,
        /// The angle between them in the last sample, rad.
        last: f64,
    },
    /// The axis turns away from the line of the angular momentum.
    TurnsAway {
        /// Start, s.
        from: f64,
        /// The angle between them then, rad.
        first: f64,
        /// The angle between them in the last sample, rad.
        last: f64,
    },
    /// A tippe top has less energy than it needs to turn over.
    EnergyToTurnOver {
        /// At the start, J.
        energy: f64,
        /// The least energy on the way to the horizontal, J.
        needed: f64,
    },
    /// The angular momentum about the symmetry axis.
    AxialMomentum {
        /// At the beginning, kg m²/s.
        first: f64,
        /// At the fall of a top, or in the last sample, kg m²/s.
        last: f64,
    },
    /// The size of the angular momentum about the axis below which the top is weak.
    WeakBelow {
        /// √(4 M g l I_x), kg m²/s.
        critical: f64,
    },
    /// The height of the centre of mass above the table.
    CenterHeight {
        /// At the beginning, m.
        first: f64,
        /// In the last sample, m.
        last: f64,
    },
    /// The inclination while the contact point does not slip, to the end.
    HeldTheta {
        /// The least, rad.
        least: f64,
        /// The greatest, rad.
        greatest: f64,
        /// Whether the peg rolls.
        rolls: bool,
    },
    /// The model omits a component of the friction torque.
    ModelPart {
        /// The value of `friction.dissipation`.
        dissipation: String,
        /// Whether it drops a term of the equations rather than a torque.
        drops_term: bool,
    },
    /// The energy has changed.
    Energy {
        /// At the start, J.
        first: f64,
        /// In the last sample, J.
        last: f64,
        /// Time of the last sample, s.
        time: f64,
        /// The largest deviation of the change from the work of friction, air drag and impacts, J.
        within: f64,
    },
    /// The energy has not changed by more than the integrator's error.
    EnergyConstant {
        /// The energy, J.
        energy: f64,
        /// The largest deviation, J.
        deviation: f64,
    },
    /// The recorded energy differs from that at the start and the recorded work by more than the integrator's error.
    EnergyImbalance {
        /// The largest difference, J.
        deviation: f64,
    },
    /// The work of friction, air drag and impacts accounts for the change of energy.
    Balance {
        /// Within this, J.
        within: f64,
        /// Whether there is friction at the point of contact.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
        /// Whether the peg hits the table.
        has_impacts: bool,
    },
    /// Energy dissipated by sliding and by other losses of a free peg.
    Sliding {
        /// By sliding, J.
        sliding: f64,
        /// By rolling resistance, drilling and air, J.
        losses: f64,
    },
    /// The length of the path slipped.
    SlipPath {
        /// The length, m.
        length: f64,
    },
    /// The angular momentum about the vertical.
    VerticalMomentum {
        /// The largest deviation, relative.
        deviation: f64,
        /// Whether friction has no torque about the vertical.
        is_constant: bool,
    },
    /// Jellett's integral.
    Jellett {
        /// The largest deviation, relative to its terms.
        deviation: f64,
        /// Whether there are no torques other than those of the contact force.
        is_constant: bool,
    },
}

impl Fact {
    /// The fact as a sentence.
    #[allow(clippy::too_many_lines, reason = "a template for each fact")]
    pub fn sentence(&self) -> String {
        match self {
            Self::Start { theta, psi_dot } => {
                let (theta, psi_dot) = (angle(*theta), rate(*psi_dot));
                format!(
                    "The top starts with the inclination θ = {theta} and the spin ψ̇ = {psi_dot}."
                )
            }
            Self::Risen { theta, time } => {
                format!(
                    "The top reaches θ = {} at {}.",
                    angle(*theta),
                    Piece::time(*time)
                )
            }
            Self::Fallen { theta, time } => {
                format!(
                    "The top falls to θ = {} at {}.",
                    angle(*theta),
                    Piece::time(*time)
                )
            }
            Self::Inverted { time } => {
                format!(
                    "The top inverts (its axis passes the horizontal) at {}.",
                    Piece::time(*time)
                )
            }
            Self::NotInverted { time } => {
                format!(
                    "The top does not invert before the end at {}.",
                    Piece::time(*time)
                )
            }
            Self::PassesHorizontal { time } => format!(
                "The axis passes the horizontal at {}, but the top does not stay inverted.",
                Piece::time(*time)
            ),
            Self::MeanTheta { first, last } if is_same_angle(*first, *last) => format!(
                "The mean inclination θ, {}, hardly changes (last nutation minus first nutation: {}).",
                angle(*first),
                Piece::number(last - first, 2, "rad")
            ),
            Self::MeanTheta { first, last } => {
                let [first, last] = Piece::range([*first, *last], 4, "rad");
                format!(
                    "The mean inclination θ changes from {first} (first nutation) to {last} (last nutation)."
                )
            }
            Self::ThetaConstant { theta } => {
                let theta = angle(*theta);
                format!(
                    "The mean inclination θ is the same in the first and in the last nutation: {theta}."
                )
            }
            Self::End {
                theta,
                nutation_end: Some(time),
            } => format!(
                "The nutation ends at {}; at the end (last sample), θ = {}.",
                Piece::time(*time),
                angle(*theta)
            ),
            Self::End { theta, .. } => format!("At the end (last sample), θ = {}.", angle(*theta)),
            Self::Loops { count: 1, first } => {
                format!("The axis loops once, at {}.", Piece::time(*first))
            }
            Self::Loops { count, first } => {
                format!(
                    "The axis loops {count} times, first at {}.",
                    Piece::time(*first)
                )
            }
            Self::Sticks {
                time,
                count,
                slips_at_end,
            } => {
                let times = match count {
                    1 => format!("at {}", Piece::time(*time)),
                    count => format!("{}, first at {}", times(*count), Piece::time(*time)),
                };
                let end = if *slips_at_end {
                    ", but slips again at the end"
                } else {
                    ""
                };
                format!("The contact point stops slipping {times}{end}.")
            }
            // A peg that bounces is in one flight until it stays on the table, however often it hits it.
            Self::Hops { count: 1, first } if *first <= 0.0 => {
                "The peg flies once, from the start (bounces do not end a flight).".to_owned()
            }
            Self::Hops { count, first } if *first <= 0.0 => format!(
                "The peg flies {count} times, first from the start (bounces do not end a flight)."
            ),
            Self::Hops { count: 1, first } => format!(
                "The peg flies once, from {} (bounces do not end a flight).",
                Piece::time(*first)
            ),
            Self::Hops { count, first } => format!(
                "The peg flies {count} times, first from {} (bounces do not end a flight).",
                Piece::time(*first)
            ),
            Self::Impacts {
                count,
                after_samples,
                lost,
            } => {
                let when = match after_samples {
                    0 => "",
                    after if after == count => ", after the last sample",
                    _ => ", also after the last sample",
                };
                let (count, lost) = (times(*count), joule(*lost));
                format!("The peg hits the table {count}{when}; the impacts dissipate {lost}.")
            }
            Self::Rolls { from, theta } if theta.is_finite() => format!(
                "The peg rolls from {} to the end, starting at θ = {}.",
                Piece::time(*from),
                angle(*theta)
            ),
            Self::Rolls { from, .. } => {
                format!("The peg rolls from {} to the end.", Piece::time(*from))
            }
            Self::RollsAtTimes { first, duration } => format!(
                "The peg first rolls at {}; it rolls for {} in total.",
                Piece::time(*first),
                Piece::number(*duration, 3, "s")
            ),
            Self::FollowsRoot { root, within } => format!(
                "The mean precession rate φ̇ follows the {} rate of regular precession (± {}).",
                root.name(),
                Piece::number(*within, 2, "rad/s")
            ),
            Self::FollowsNoRoot => {
                "The mean precession rate φ̇ follows neither rate of regular precession.".to_owned()
            }
            Self::NoRoots => "At the start, the spin is too low for regular precession.".to_owned(),
            Self::FrictionOnPrecession { friction, change } => {
                let [friction, change] = pair([*friction, *change], 4);
                format!(
                    "The friction term of φ̈ alone would change φ̇ by {friction} rad/s; all terms together change it by {change} rad/s."
                )
            }
            Self::NoFrictionOnPrecession => {
                "The friction term of φ̈ does not change φ̇ by more than the integration error."
                    .to_owned()
            }
            Self::TermsCancel { demanded, mean } => {
                let [demanded, mean] = pair([*demanded, *mean], 4);
                format!(
                    "The gyroscopic and Coriolis terms are proportional to θ̇. They balance the friction term at a mean θ̇ of {demanded} rad/s; the observed mean is {mean} rad/s."
                )
            }
            Self::HorizontalMomentum { first, last, until } => {
                // When the rise ends would be a third number.
                let start = if until.is_some() {
                    "During the rise, the"
                } else {
                    "The"
                };
                let [first, last] = Piece::range([*first, *last], 4, "kg m²/s");
                format!(
                    "{start} horizontal part of the angular momentum decreases from {first} to {last}."
                )
            }
            Self::AngleToMomentum { largest } => format!(
                "Meanwhile the axis is always within {} of the line of the angular momentum.",
                Piece::number(*largest, 2, "rad")
            ),
            Self::AngleToMomentumChange { first, last } => {
                let [first, last] = Piece::range([*first, *last], 3, "rad");
                format!(
                    "The angle between the axis and the line of the angular momentum decreases from {first} to {last}."
                )
            }
            Self::TurnsAway { first, last, .. } => {
                let [first, last] = Piece::range([*first, *last], 3, "rad");
                format!(
                    "After the axis is least inclined, the angle between it and the line of the angular momentum increases from {first} to {last}."
                )
            }
            Self::EnergyToTurnOver { energy, needed } => {
                let [energy, needed] = Piece::distinct([*energy, *needed], 4, "J");
                format!(
                    "The top starts with an energy of {energy}; to reach the horizontal, it would need at least {needed} ({ENERGY_ZERO})."
                )
            }
            Self::AxialMomentum { first, last } => {
                let size = Piece::number(*last, 4, "kg m²/s");
                if size == Piece::number(*first, 4, "kg m²/s") {
                    format!("The angular momentum about the axis stays at {size}.")
                } else {
                    let [first, last] = Piece::range([*first, *last], 4, "kg m²/s");
                    format!("The angular momentum about the axis changes from {first} to {last}.")
                }
            }
            Self::WeakBelow { critical } => format!(
                "The top is weak where its size is less than {}.",
                Piece::number(*critical, 4, "kg m²/s")
            ),
            Self::CenterHeight { first, last } => {
                let [first, last] = Piece::range([*first, *last], 4, "m");
                format!("The centre of mass rises from a height of {first} to {last}.")
            }
            Self::HeldTheta {
                least,
                greatest,
                rolls,
            } => {
                let grip = if *rolls {
                    "peg rolls to the end"
                } else {
                    "contact point sticks"
                };
                let only = angle(*least);
                if only == angle(*greatest) {
                    format!("While the {grip}, θ stays at {only}.")
                } else {
                    let [least, greatest] = Piece::range([*least, *greatest], 4, "rad");
                    format!("While the {grip}, θ stays between {least} and {greatest}.")
                }
            }
            Self::ModelPart {
                dissipation,
                drops_term: true,
            } => format!(
                "The model omits {}; what is left does not correspond to a torque.",
                omission(dissipation)
            ),
            Self::ModelPart {
                dissipation,
                drops_term: false,
            } => format!("The model omits {}.", omission(dissipation)),
            Self::Energy {
                first,
                last,
                time,
                within,
            } => {
                let is_lost = last < first;
                let verb = if is_lost { "decreases" } else { "increases" };
                let change = (last - first).abs();
                let change = Piece::number(change, known_digits(change, *within), "J");
                let until = Piece::time(*time);
                // Every torque of friction dissipates: only terms without a torque add energy.
                let remark = if is_lost {
                    ""
                } else {
                    ": the friction of this model creates energy, as no real friction does"
                };
                format!("Up to {until} (last sample), energy {verb} by {change}{remark}.")
            }
            // Its size would need its zero: the page also shows energies from the table.
            Self::EnergyConstant { deviation, .. } => format!(
                "Energy is constant in all samples (± {}).",
                Piece::number(*deviation, 2, "J")
            ),
            Self::EnergyImbalance { deviation } => format!(
                "The recorded energy does not agree with the recorded work: they differ by up to {}.",
                Piece::number(*deviation, 2, "J")
            ),
            Self::Balance {
                within,
                has_friction,
                has_air_drag,
                has_impacts,
            } => format!(
                "The work of {} equals this change (± {}).",
                works([*has_friction, *has_air_drag, *has_impacts]),
                Piece::number(*within, 2, "J")
            ),
            Self::Sliding { sliding, losses } if *losses > 0.0 => {
                let [sliding, losses] = pair([*sliding, *losses], 4);
                format!(
                    "Sliding dissipates {sliding} J; rolling resistance, drilling and air drag dissipate {losses} J."
                )
            }
            Self::Sliding { sliding, .. } => format!("Sliding dissipates {}.", joule(*sliding)),
            Self::SlipPath { length } => format!(
                "The contact point slips {} in all.",
                Piece::number(*length, 3, "m")
            ),
            Self::VerticalMomentum {
                deviation,
                is_constant: true,
            } => format!(
                "The vertical angular momentum is constant (± {}, relative); no torque acts about the vertical.",
                significant(*deviation, 2)
            ),
            Self::VerticalMomentum { deviation, .. } => format!(
                "The vertical angular momentum changes by up to {} %.",
                significant(100.0 * deviation, 3)
            ),
            Self::Jellett {
                deviation,
                is_constant: true,
            } => format!(
                "Jellett's integral l·L_n + R·L_z′ is constant (± {}, relative), as expected for contact forces.",
                significant(*deviation, 2)
            ),
            Self::Jellett { deviation, .. } => format!(
                "Jellett's integral changes by up to {} % of its terms, because of torques other than contact forces.",
                significant(100.0 * deviation, 3)
            ),
        }
    }
}

/// Whether two inclinations, rad, are the same number in a sentence.
pub(super) fn is_same_angle(one: f64, other: f64) -> bool {
    angle(one) == angle(other)
}

fn angle(theta: f64) -> Piece {
    Piece::number(theta, 4, "rad")
}

fn rate(rate: f64) -> Piece {
    Piece::number(rate, 4, "rad/s")
}

fn joule(energy: f64) -> Piece {
    Piece::number(energy, 4, "J")
}

/// What a value of `friction.dissipation` leaves out of the friction of sliding.
fn omission(dissipation: &str) -> &'static str {
    match find_dissipation(dissipation) {
        Some(Dissipation::WithoutNutationPart) => {
            "the component of the friction torque that would damp the nutation"
        }
        Some(Dissipation::PrecessionTermOnly) => {
            "all friction terms of the equations except the one of φ̈"
        }
        Some(Dissipation::SpinTermOnly) => {
            "all friction terms of the equations except the one of ψ̈"
        }
        Some(Dissipation::TiltTorqueOnly) => {
            "all components of the friction torque except the one that tilts the axis"
        }
        Some(Dissipation::SpinTorqueOnly) => {
            "the components of the friction torque but the one about the axis"
        }
        // Full friction omits nothing, and reports have no fact about it.
        Some(Dissipation::Full) | None => "a part of friction",
    }
}

/// Number of significant digits, at most 4, of a value with this uncertainty.
fn known_digits(value: f64, uncertainty: f64) -> usize {
    let mut digits = 1;
    let mut resolved = 10.0 * uncertainty;
    while digits < 4 && resolved < value {
        (digits, resolved) = (digits + 1, 10.0 * resolved);
    }
    digits
}

/// Number of times.
fn times(count: u64) -> String {
    match count {
        1 => "once".to_owned(),
        2 => "twice".to_owned(),
        count => format!("{count} times"),
    }
}
