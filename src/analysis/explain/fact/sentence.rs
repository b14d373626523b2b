//! The sentences of facts.

use super::{Fact, PrecessionRoot};
use crate::physics::friction::Dissipation;
use crate::run::scenario::find_dissipation;
use crate::words::number::{pair, significant};
use crate::words::{Piece, Sentence, sentence, span};

/// The zero of the potential energy in recordings, wherever an energy and not its change is shown.
pub const ENERGY_ZERO: &str = "zero at the height of the peg's centre";

impl PrecessionRoot {
    fn name(self) -> &'static str {
        match self {
            Self::Slow => "slow",
            Self::Fast => "fast",
        }
    }
}

impl Fact {
    /// The fact as a sentence.
    #[allow(clippy::too_many_lines, reason = "a template for each fact")]
    pub fn sentence(&self) -> Sentence {
        match self {
            Self::Start { theta, psi_dot } => sentence!(
                "The top started with the inclination θ = {} and the spin ψ̇ = {}.",
                angle(*theta),
                Piece::number(*psi_dot, 4, "rad/s")
            ),
            Self::Risen { theta, time } => sentence!(
                "The top reached θ = {} at {}.",
                angle(*theta),
                Piece::time(*time)
            ),
            Self::Fallen { theta, time } => sentence!(
                "The top fell to θ = {} at {}.",
                angle(*theta),
                Piece::time(*time)
            ),
            Self::Inverted { time } => sentence!(
                "The top inverted (its axis passed the horizontal) at {}.",
                Piece::time(*time)
            ),
            Self::NotInverted { time } => sentence!(
                "The top did not invert before the end at {}.",
                Piece::time(*time)
            ),
            Self::PassesHorizontal { time } => sentence!(
                "The axis passed the horizontal at {}, but the top did not stay inverted.",
                Piece::time(*time)
            ),
            Self::MeanTheta { first, last } if is_same_angle(*first, *last) => sentence!(
                "The mean inclination θ, {}, hardly changed (last nutation minus first nutation: {}).",
                angle(*first),
                Piece::number(last - first, 2, "rad")
            ),
            Self::MeanTheta { first, last } => {
                let [first, last] = Piece::range([*first, *last], 4, "rad");
                sentence!(
                    "The mean inclination θ changed from {} (first nutation) to {} (last nutation).",
                    first,
                    last
                )
            }
            Self::ThetaConstant { theta } => sentence!(
                "The mean inclination θ was the same in the first and in the last nutation: {}.",
                angle(*theta)
            ),
            Self::End {
                theta,
                nutation_end: Some(time),
            } => sentence!(
                "The nutation ended at {}; at the end (last sample), θ = {}.",
                Piece::time(*time),
                angle(*theta)
            ),
            Self::End { theta, .. } => {
                sentence!("At the end (last sample), θ = {}.", angle(*theta))
            }
            Self::Loops { count, first } => {
                sentence!("The axis looped {}.", occurrences(*count, *first))
            }
            Self::Sticks {
                time,
                count,
                slips_at_end,
            } => sentence!(
                "The contact point stopped slipping {}{}.",
                occurrences(*count, *time),
                if *slips_at_end {
                    ", but slipped again at the end"
                } else {
                    ""
                }
            ),
            // A peg that bounces is in one flight until it stays on the table, however often it hits it.
            Self::Hops { count, first } => sentence!(
                "The peg flew {}, {} {} (bounces do not end a flight).",
                times(*count),
                if *count == 1 { "from" } else { "first from" },
                Piece::time(first.max(0.0))
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
                sentence!(
                    "The peg hit the table {}{}; the impacts dissipated {}.",
                    times(*count),
                    when,
                    joule(*lost)
                )
            }
            Self::Rolls { from, theta } if theta.is_finite() => sentence!(
                "The peg rolled from {} to the end, starting at θ = {}.",
                Piece::time(*from),
                angle(*theta)
            ),
            Self::Rolls { from, .. } => {
                sentence!("The peg rolled from {} to the end.", Piece::time(*from))
            }
            Self::RollsAtTimes { first, duration } => sentence!(
                "The peg first rolled at {}; it rolled for {} in total.",
                Piece::time(*first),
                Piece::number(*duration, 3, "s")
            ),
            Self::FollowsRoot { root, within } => sentence!(
                "The mean precession rate φ̇ followed the {} rate of regular precession (± {}).",
                root.name(),
                Piece::number(*within, 2, "rad/s")
            ),
            Self::FollowsNoRoot => {
                sentence!("The mean precession rate φ̇ followed neither rate of regular precession.")
            }
            Self::NoRoots => {
                sentence!("At the start, the spin was too low for regular precession.")
            }
            Self::FrictionOnPrecession { friction, change } => {
                let [friction, change] = pair([*friction, *change], 4);
                sentence!(
                    "The friction term of φ̈ alone would have changed φ̇ by {} rad/s; all terms together changed it by {} rad/s.",
                    friction,
                    change
                )
            }
            Self::NoFrictionOnPrecession => sentence!(
                "The friction term of φ̈ did not change φ̇ by more than the integration error."
            ),
            Self::TermsCancel { demanded, mean } => {
                let [demanded, mean] = pair([*demanded, *mean], 4);
                sentence!(
                    "The gyroscopic and Coriolis terms are proportional to θ̇. They balance the friction term at a mean θ̇ of {} rad/s; the observed mean was {} rad/s.",
                    demanded,
                    mean
                )
            }
            Self::HorizontalMomentum { first, last, until } => {
                // When the rise ends would be a third number.
                let start = if until.is_some() {
                    "During the rise, the"
                } else {
                    "The"
                };
                sentence!(
                    "{} horizontal part of the angular momentum decreased from {}.",
                    start,
                    span([*first, *last], 4, "kg m²/s")
                )
            }
            Self::AngleToMomentum { largest } => sentence!(
                "Meanwhile the axis was always within {} of the line of the angular momentum.",
                Piece::number(*largest, 2, "rad")
            ),
            Self::AngleToMomentumChange { first, last } => sentence!(
                "The angle between the axis and the line of the angular momentum decreased from {}.",
                span([*first, *last], 3, "rad")
            ),
            Self::TurnsAway { first, last, .. } => sentence!(
                "After the axis was least inclined, the angle between it and the line of the angular momentum increased from {}.",
                span([*first, *last], 3, "rad")
            ),
            Self::EnergyToTurnOver { energy, needed } => {
                let [energy, needed] = Piece::distinct([*energy, *needed], 4, "J");
                sentence!(
                    "The top started with an energy of {}; to reach the horizontal, it would have needed at least {} ({}).",
                    energy,
                    needed,
                    ENERGY_ZERO
                )
            }
            Self::EnergyLeft { energy, needed } => {
                let [energy, needed] = Piece::distinct([*energy, *needed], 4, "J");
                sentence!(
                    "At the end, the top had an energy of {}; to reach the horizontal, it needed at least {} ({}).",
                    energy,
                    needed,
                    ENERGY_ZERO
                )
            }
            Self::AxialMomentum { first, last } => {
                let size = Piece::number(*last, 4, "kg m²/s");
                if size.to_string() == Piece::number(*first, 4, "kg m²/s").to_string() {
                    sentence!("The angular momentum about the axis stayed at {}.", size)
                } else {
                    sentence!(
                        "The angular momentum about the axis changed from {}.",
                        span([*first, *last], 4, "kg m²/s")
                    )
                }
            }
            Self::WeakBelow { critical } => sentence!(
                "The top is weak where its size is less than {}.",
                Piece::number(*critical, 4, "kg m²/s")
            ),
            Self::CenterHeight { first, last } => sentence!(
                "The centre of mass rose from a height of {}.",
                span([*first, *last], 4, "m")
            ),
            Self::HeldTheta {
                least,
                greatest,
                rolls,
            } => {
                let grip = if *rolls {
                    "peg rolled to the end"
                } else {
                    "contact point stuck to the end"
                };
                if is_same_angle(*least, *greatest) {
                    sentence!("While the {}, θ stayed at {}.", grip, angle(*least))
                } else {
                    let [least, greatest] = Piece::range([*least, *greatest], 4, "rad");
                    sentence!(
                        "While the {}, θ stayed between {} and {}.",
                        grip,
                        least,
                        greatest
                    )
                }
            }
            Self::ModelPart {
                dissipation,
                drops_term: true,
            } => sentence!(
                "The model omits {}; what is left does not correspond to a torque.",
                omission(dissipation)
            ),
            Self::ModelPart {
                dissipation,
                drops_term: false,
            } => sentence!("The model omits {}.", omission(dissipation)),
            Self::Energy {
                first,
                last,
                time,
                within,
            } => {
                let change = (last - first).abs();
                let change = Piece::number(change, known_digits(change, *within), "J");
                let until = Piece::time(*time);
                if last < first {
                    sentence!(
                        "Up to {} (last sample), energy decreased by {}.",
                        until,
                        change
                    )
                } else {
                    // Every torque of friction dissipates: only terms without a torque add energy.
                    sentence!(
                        "Up to {} (last sample), energy increased by {}: the friction of this model creates energy, as no real friction does.",
                        until,
                        change
                    )
                }
            }
            // Its size would need its zero: the page also shows energies from the table.
            Self::EnergyConstant { deviation, .. } => sentence!(
                "Energy was constant in all samples (± {}).",
                Piece::number(*deviation, 2, "J")
            ),
            Self::EnergyImbalance { deviation } => sentence!(
                "The recorded energy does not agree with the recorded work: they differ by up to {}.",
                Piece::number(*deviation, 2, "J")
            ),
            Self::Balance {
                within,
                losses,
                has_impacts,
            } => sentence!(
                "The work of {} equals this change (± {}).",
                losses.list(*has_impacts),
                Piece::number(*within, 2, "J")
            ),
            Self::Sliding { sliding, losses } if *losses > 0.0 => {
                let [sliding, losses] = pair([*sliding, *losses], 4);
                sentence!(
                    "Sliding dissipated {} J; rolling resistance, drilling and air drag dissipated {} J.",
                    sliding,
                    losses
                )
            }
            Self::Sliding { sliding, .. } => sentence!("Sliding dissipated {}.", joule(*sliding)),
            Self::SlipPath { length } => sentence!(
                "The contact point slipped {} in all.",
                Piece::number(*length, 3, "m")
            ),
            Self::VerticalMomentum {
                deviation,
                is_constant: true,
            } => sentence!(
                "The vertical angular momentum was constant (± {}, relative); no torque acts about the vertical.",
                significant(*deviation, 2)
            ),
            Self::VerticalMomentum { deviation, .. } => sentence!(
                "The vertical angular momentum changed by up to {} %.",
                significant(100.0 * deviation, 3)
            ),
            Self::Jellett {
                deviation,
                is_constant: true,
            } => sentence!(
                "Jellett's integral l·L_n + R·L_z′ was constant (± {}, relative), as expected for contact forces.",
                significant(*deviation, 2)
            ),
            Self::Jellett { deviation, .. } => sentence!(
                "Jellett's integral changed by up to {} % of its terms, because of torques other than contact forces.",
                significant(100.0 * deviation, 3)
            ),
        }
    }
}

/// Whether two inclinations, rad, are the same number in a sentence.
fn is_same_angle(one: f64, other: f64) -> bool {
    significant(one, 4) == significant(other, 4)
}

fn angle(theta: f64) -> Piece {
    Piece::number(theta, 4, "rad")
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
pub(in crate::analysis::explain) fn times(count: u64) -> Sentence {
    match count {
        1 => "once".into(),
        count => Piece::count(count, "time").into(),
    }
}

/// When something happened, the first time of several.
fn occurrences(count: u64, first: f64) -> Sentence {
    match count {
        1 => sentence!("once, at {}", Piece::time(first)),
        count => sentence!("{}, first at {}", times(count), Piece::time(first)),
    }
}
