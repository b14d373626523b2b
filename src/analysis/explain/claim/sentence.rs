//! The sentences of claims: in the past tense, so that verbs need no agreement, and without the time of the claim.

use super::{Claim, Hold, SufficientSpin, Weakness};
use crate::analysis::explain::fact::times;
use crate::analysis::losses::Losses;
use crate::words::{Piece, Sentence, sentence, span};

impl Claim {
    /// The claim as sentences, the first of which continues after its time.
    pub(in crate::analysis::explain) fn sentence(&self) -> Sentence {
        match self {
            Self::Conserves { mean_theta, .. } => conserves(*mean_theta),
            Self::FrictionRaises {
                is_vertical_constant: true,
                losses,
                ..
            } => raises(*losses, "and left the vertical part unchanged".into()),
            Self::FrictionRaises {
                vertical, losses, ..
            } => {
                let vertical = span(*vertical, 4, "kg m²/s");
                raises(
                    *losses,
                    sentence!("while the vertical part changed from {}", vertical),
                )
            }
            Self::FrictionSpeedsPrecession { .. } => sentence!(
                "in the paper's terms, the friction term of φ̈ sped up the precession. Beyond the slow rate of regular precession, θ̈ is negative: the axis rose, and its rise slowed the precession again. So the precession stayed near the slow rate while the axis rose."
            ),
            Self::LossesAlign { losses, .. } => sentence!(
                "the precession was so fast that the angular momentum was nearly vertical, and {} took energy from the motion. A body whose larger moment of inertia is that about its axis has least energy when it turns about this axis. So the axis turned towards the line of the angular momentum, and the top rose.",
                losses.names(false)
            ),
            Self::WeakTopFalls {
                weakness, losses, ..
            } => weak_top_falls(*weakness, *losses),
            Self::FrictionLowers {
                axial,
                falls: true,
                losses,
                ..
            } => lowers(*axial, *losses, "fell"),
            Self::FrictionLowers { axial, losses, .. } => lowers(*axial, *losses, "sank"),
            Self::MeanInclinationChanges {
                mean_theta,
                regular_theta,
                has_impacts,
                losses,
                ..
            } => mean_inclination_changes(*mean_theta, *regular_theta, losses.names(*has_impacts)),
            Self::SwingsDown {
                kinetic,
                by_gravity,
                ..
            } => sentence!(
                "the top fell as it would have without friction: its motion across the axis had {} at the start, and gravity added {} on the way down.",
                Piece::number(*kinetic, 2, "J"),
                Piece::number(*by_gravity, 2, "J")
            ),
            Self::StaysUpright {
                sufficient_spin, ..
            } => stays_upright(*sufficient_spin),
            Self::EnergySpent { .. } => sentence!(
                "the top did not turn over. At the start it had enough energy for it, but friction took so much of it that the rest was not enough: friction at the contact point does not change Jellett's integral, and with this value of the integral the axis could have reached the horizontal only with more energy than was left."
            ),
            Self::NotYetInverted { slip_speed, .. } => sentence!(
                "the top had not turned over when the run ended. It still had the energy that it needs to reach the horizontal, and its contact point still slipped at {}: a longer run shows whether friction turns it over.",
                Piece::number(*slip_speed, 2, "m/s")
            ),
            Self::Inverts { .. } => sentence!(
                "the top turned over because its contact point slipped. Friction at the contact point does not change Jellett's integral, and the angular momentum about the vertical kept its sense while the axis turned over. So the spin about the axis was reversed in the end. The centre of mass rose, and the energy for this came from the rotation."
            ),
            Self::SlipEnds { rolls: true, .. } => sentence!(
                "the peg rolled: its contact point did not slip, and sliding friction did no work."
            ),
            Self::SlipEnds { .. } => sentence!(
                "the contact point stuck: sliding friction did no work, and the top turned as a whole, at a fixed inclination."
            ),
            Self::Bounces {
                hops,
                impacts,
                lost,
                starts_in_air: true,
                lands,
                ..
            } => bounces(in_air(*hops), *impacts, *lost, *lands),
            Self::Bounces {
                hops,
                impacts,
                lost,
                lands,
                ..
            } => bounces(lifted_off(*hops), *impacts, *lost, *lands),
            Self::RestsFromStart { held_by, .. } => {
                sentence!("the top was at rest from the start: {}.", holds(*held_by))
            }
            Self::ComesToRest { held_by, .. } => sentence!(
                "the top came to rest: its kinetic energy was spent, and {}.",
                holds(*held_by)
            ),
        }
    }
}

fn conserves(mean_theta: Option<[f64; 2]>) -> Sentence {
    // Without two nutations nothing is repeated.
    let repetition = match mean_theta {
        Some(_) => " So each nutation repeated the one before it.",
        None => "",
    };
    sentence!(
        "without friction, nothing changed the energy, the angular momentum about the vertical or the angular momentum about the axis.{}",
        repetition
    )
}

/// A rise, and what the torque did to the vertical part of the angular momentum.
fn raises(losses: Losses, rest: Sentence) -> Sentence {
    sentence!(
        "the top rose because {} turned its angular momentum towards the vertical: the torque shortened the horizontal part of the angular momentum {}. The top spun so fast that its axis stayed close to the line of the angular momentum, and rose with it.",
        losses.names(false),
        rest
    )
}

fn weak_top_falls(weakness: Weakness, losses: Losses) -> Sentence {
    let losses = losses.names(false);
    match weakness {
        Weakness::FromStart => sentence!(
            "the top fell because it was weak from the start: its spin was too slow to hold the axis up against gravity."
        ),
        Weakness::NeedsLoss => sentence!(
            "the top fell. It was weak from the start: its spin was too slow to hold the axis up steadily. It would still have sunk and risen again without falling, but {} slowed the spin further.",
            losses
        ),
        Weakness::ByLoss => sentence!(
            "the top fell because {} had slowed the spin until the top was weak: the spin no longer held the axis up against gravity.",
            losses
        ),
    }
}

fn lowers(axial: [f64; 2], losses: Losses, verb: &str) -> Sentence {
    sentence!(
        "{} shortened the part of the angular momentum about the axis, from {}. So the axis turned away from the line of the angular momentum, and the top {}.",
        losses.names(false),
        span(axial.map(f64::abs), 4, "kg m²/s"),
        verb
    )
}

/// The two parts of a change of the mean inclination, neither of which is judged to be the cause.
fn mean_inclination_changes(
    mean_theta: [f64; 2],
    regular_theta: [f64; 2],
    causes: Sentence,
) -> Sentence {
    let by_momenta = regular_theta[1] - regular_theta[0];
    let by_nutation = (mean_theta[1] - mean_theta[0]) - by_momenta;
    sentence!(
        "the mean inclination changed from {}: by {} because {} changed the angular momenta, and with them the inclination at which the top would precess without nutation, and by {} because the nutation changed.",
        span(mean_theta, 4, "rad"),
        Piece::number(by_momenta, 2, "rad"),
        causes,
        Piece::number(by_nutation, 2, "rad")
    )
}

fn stays_upright(sufficient_spin: SufficientSpin) -> Sentence {
    const INTEGRAL: &str = "friction at the contact point does not change Jellett's integral";
    const BARRED: &str = "with this value of the integral the axis could have reached the horizontal only with more energy than the top had at the start";
    match sufficient_spin {
        SufficientSpin::Faster => sentence!(
            "the top did not turn over. It spun too slowly: {}, and {}.",
            INTEGRAL,
            BARRED
        ),
        SufficientSpin::Absent => sentence!(
            "the top did not turn over, and would not have with any other spin at the start: {}, and with the value that the integral has at any spin the axis could have reached the horizontal only with more energy than the top would then have had.",
            INTEGRAL
        ),
        SufficientSpin::Unknown => {
            sentence!("the top did not turn over: {}, and {}.", INTEGRAL, BARRED)
        }
    }
}

/// Flights of a peg that starts in the air.
fn in_air(hops: u64) -> Sentence {
    match hops {
        0 | 1 => sentence!("the peg was in the air."),
        _ => sentence!("the peg was in the air {}.", times(hops)),
    }
}

/// Flights of a peg that starts on the table.
fn lifted_off(hops: u64) -> Sentence {
    if hops == 1 {
        sentence!("the force between peg and table had fallen to zero, and the peg was in the air.")
    } else {
        sentence!(
            "the peg was in the air {}, whenever the force between it and the table had fallen to zero.",
            times(hops)
        )
    }
}

/// Flights of a peg, with the number of its impacts and the energy that these dissipated, J.
fn bounces(flights: Sentence, impacts: u64, lost: f64, lands: Option<f64>) -> Sentence {
    let hits = match (impacts, lost > 0.0) {
        (0, _) => Sentence::default(),
        (_, false) => sentence!(" It hit the table {}.", times(impacts)),
        (_, true) => sentence!(
            " It hit the table {}, which dissipated {}.",
            times(impacts),
            Piece::number(lost, 4, "J")
        ),
    };
    let end = match lands {
        None => " At the end it was in the air.",
        Some(_) => "",
    };
    sentence!("{}{}{}", flights, hits, end)
}

fn holds(held_by: Hold) -> &'static str {
    match held_by {
        Hold::StaticFriction => "static friction held it against gravity",
        Hold::RollingResistance => "rolling resistance held it against gravity",
        Hold::Balance => "gravity had no torque that would have moved it",
    }
}
