//! Claims about the cause of a motion: the numbers that carry them, and their words.

use super::fact::Fact;
use crate::analysis::phrase::works;
use schemars::JsonSchema;
use serde::Serialize;

/// A claim about the cause of a motion, with the recorded numbers that carry it: SI units and radians, pairs are a
/// quantity at the beginning and at the end. A claim is made only if its numbers have the properties that its variant
/// describes.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Claim {
    /// Without friction, energy and the angular momenta about the vertical and about the axis are constant.
    Conserves {
        /// The largest deviation of the energy, J.
        energy_deviation: f64,
        /// The largest deviations of the vertical and of the axial angular momentum, kg m²/s.
        momentum_deviations: [f64; 2],
        /// Mean θ in the first and the last nutation, rad, if they are equal within the integration error.
        mean_theta: Option<[f64; 2]>,
    },
    /// Friction shortens the horizontal part of the angular momentum, which turns it upright by more than twice its
    /// largest angle to the axis: the axis must follow.
    FrictionRaises {
        /// Horizontal part of the angular momentum, kg m²/s; it decreases.
        horizontal: [f64; 2],
        /// Vertical part of the angular momentum, kg m²/s.
        vertical: [f64; 2],
        /// Whether the vertical part is constant, because friction has no torque about the vertical.
        is_vertical_constant: bool,
        /// Change of the horizontal part by friction and air drag, kg m²/s: more than half of its change.
        by_friction: f64,
        /// The largest angle between the axis and the angular momentum, rad.
        angle_to_momentum: f64,
        /// Inclination of the axis, rad; it decreases.
        theta: [f64; 2],
        /// The end of the rise, s.
        until: f64,
        /// Whether there is friction at the contact point.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
    },
    /// Friction drives the precession beyond the slow rate of regular precession, where θ̈ is negative; the rise slows
    /// the precession, so that its mean stays near the slow rate.
    FrictionSpeedsPrecession {
        /// Change of φ̇ by the friction term of φ̈ alone, rad/s; it has the sign of the mean φ̇.
        friction: f64,
        /// Mean φ̇ in the first and the last nutation, rad/s.
        mean_phi_dot: [f64; 2],
        /// The largest difference of the mean φ̇ from the slow rate of regular precession, rad/s.
        within: f64,
        /// Mean θ in the first and the last nutation, rad; it decreases.
        mean_theta: [f64; 2],
    },
    /// The angular momentum is nearly vertical, and the motion loses energy. An oblate body has the least energy when
    /// it turns about its axis: the axis turns towards the angular momentum.
    LossesAlign {
        /// Angle between the axis and the angular momentum, rad; it decreases.
        angle_to_momentum: [f64; 2],
        /// The largest inclination of the angular momentum, rad: less than half of this decrease.
        momentum_inclination: f64,
        /// Energy, J; it decreases.
        energy: [f64; 2],
        /// Whether there is friction at the contact point.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
    },
    /// The spin is, or becomes, too slow to hold the axis up, and the top falls.
    WeakTopFalls {
        /// Angular momentum about the axis at the start and at the fall, kg m²/s.
        axial: [f64; 2],
        /// The magnitude below which the top is weak, √(4 M g l I_x), kg m²/s: more than that at the fall.
        critical: f64,
        /// Inclination at the start and at the fall, rad; it increases.
        theta: [f64; 2],
        /// Time of the fall, s.
        time: f64,
        /// Whether there is friction at the contact point.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
    },
    /// A tippe top turns over: the vertical angular momentum keeps its sense, the axial one is reversed, and the centre
    /// of mass rises at the expense of the rotation.
    Inverts {
        /// Time at which the axis passes the horizontal, s.
        time: f64,
        /// Inclination of the axis, rad: at the end more than π/2.
        theta: [f64; 2],
        /// The largest deviation of Jellett's integral, relative to its terms.
        jellett_deviation: f64,
        /// Vertical angular momentum, kg m²/s; both have one sign.
        vertical: [f64; 2],
        /// Angular momentum about the axis, kg m²/s; the signs differ.
        axial: [f64; 2],
        /// Height of the centre of mass, m; it increases.
        center_height: [f64; 2],
        /// Kinetic energy, J; it decreases.
        kinetic: [f64; 2],
        /// Energy dissipated by sliding, J; positive.
        lost_sliding: f64,
    },
    /// The contact point no longer slips, to the end: friction does no work, and the inclination stays in a range.
    SlipEnds {
        /// Start, s.
        from: f64,
        /// Inclination then, rad.
        theta: f64,
        /// The least and the greatest inclination in the samples since then, rad.
        theta_range: [f64; 2],
        /// Energy in the first and the last of these samples, J; it is constant.
        energy: [f64; 2],
        /// What the end of the slip stops.
        stops: Stopped,
        /// Whether the peg rolls; otherwise it is fixed, and the top turns as a whole.
        rolls: bool,
    },
    /// The peg hops or bounces.
    Bounces {
        /// Number of times in the air.
        hops: u64,
        /// Number of impacts.
        impacts: u64,
        /// Energy dissipated by them, J.
        lost: f64,
        /// Whether the run starts in the air.
        starts_in_air: bool,
        /// Time from which the peg is on the table to the end, s; absent if it is in the air at the end.
        lands: Option<f64>,
    },
    /// Friction holds the top at rest, to the end.
    Rests {
        /// Start, s.
        from: f64,
        /// Inclination, rad.
        theta: f64,
        /// Kinetic energy in the first and the last sample, J.
        kinetic: [f64; 2],
    },
}

/// What the end of the slip stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// The rise of a top.
    Rise,
    /// The inversion of a tippe top, before it has turned over.
    Inversion,
    /// Nothing that has begun.
    Nothing,
}

impl Claim {
    /// The claim in words, as sentences of a paragraph.
    pub fn words(&self) -> String {
        match self {
            Self::Conserves { mean_theta, .. } => {
                let so = match mean_theta {
                    Some(_) => {
                        " So each nutation repeats the one before it, and the top neither rises nor falls."
                    }
                    None => "",
                };
                format!(
                    "Without friction, nothing changes the energy, the angular momentum about the vertical or the angular momentum about the axis.{so}"
                )
            }
            Self::FrictionRaises {
                vertical,
                is_vertical_constant,
                has_friction,
                has_air_drag,
                ..
            } => raises(
                *vertical,
                *is_vertical_constant,
                [*has_friction, *has_air_drag],
            ),
            Self::FrictionSpeedsPrecession { .. } => {
                "In the paper's terms, the friction term of φ̈ speeds up the precession. Beyond the slow rate of regular precession, θ̈ is negative: the axis rises, and its rise slows the precession again. So the precession stays near the slow rate while the axis rises.".to_owned()
            }
            Self::LossesAlign {
                has_friction,
                has_air_drag,
                ..
            } => {
                let cause = works([*has_friction, *has_air_drag, false]);
                let verb = if *has_friction && *has_air_drag { "take" } else { "takes" };
                format!(
                    "The precession is so fast that the angular momentum is nearly vertical, and {cause} {verb} energy from the motion. A body whose larger moment of inertia is that about its axis has least energy when it turns about this axis. So the axis turns towards the angular momentum, and the top rises."
                )
            }
            Self::WeakTopFalls {
                axial,
                critical,
                has_friction,
                has_air_drag,
                ..
            } => {
                if axial[0].abs() < *critical {
                    return "The top falls because it is weak from the start: its spin is too slow to hold the axis up against gravity.".to_owned();
                }
                let cause = capitalized(works([*has_friction, *has_air_drag, false]));
                let verb = if *has_friction && *has_air_drag { "slow" } else { "slows" };
                format!(
                    "{cause} {verb} the spin until the top is weak: the spin no longer holds the axis up against gravity, and the top falls."
                )
            }
            Self::Inverts { .. } => {
                "The top turns over because its contact point slips. Friction at the contact point does not change Jellett's integral, and the angular momentum about the vertical keeps its sense while the axis turns over. So the spin about the axis is reversed in the end. The centre of mass rises, and the energy for this comes from the rotation.".to_owned()
            }
            Self::SlipEnds { stops, rolls, .. } => slip_ends(*stops, *rolls).to_owned(),
            Self::Bounces {
                starts_in_air,
                lands,
                lost,
                ..
            } => bounces(*starts_in_air, lands.is_some(), *lost > 0.0).to_owned(),
            Self::Rests { kinetic, .. } => {
                if kinetic[0] > 0.0 {
                    "The top comes to rest: its kinetic energy is spent, and static friction holds it against gravity.".to_owned()
                } else {
                    "The top starts at rest, and static friction holds it against gravity.".to_owned()
                }
            }
        }
    }

    /// The numbers of the claim that no other fact of an explanation states.
    pub(super) fn facts(&self) -> Vec<Fact> {
        match self {
            Self::FrictionRaises {
                horizontal,
                angle_to_momentum,
                ..
            } => vec![
                Fact::HorizontalMomentum {
                    first: horizontal[0],
                    last: horizontal[1],
                },
                Fact::AngleToMomentum {
                    largest: *angle_to_momentum,
                },
            ],
            Self::LossesAlign {
                angle_to_momentum, ..
            } => vec![Fact::AngleToMomentumChange {
                first: angle_to_momentum[0],
                last: angle_to_momentum[1],
            }],
            Self::WeakTopFalls {
                axial, critical, ..
            } => vec![
                Fact::AxialMomentum {
                    first: axial[0],
                    last: axial[1],
                },
                Fact::WeakBelow {
                    critical: *critical,
                },
            ],
            Self::Inverts {
                axial,
                center_height,
                ..
            } => vec![
                Fact::AxialMomentum {
                    first: axial[0],
                    last: axial[1],
                },
                Fact::CenterHeight {
                    first: center_height[0],
                    last: center_height[1],
                },
            ],
            Self::SlipEnds {
                theta_range: [least, greatest],
                rolls,
                ..
            } => vec![Fact::HeldTheta {
                least: *least,
                greatest: *greatest,
                rolls: *rolls,
            }],
            Self::Conserves { .. }
            | Self::FrictionSpeedsPrecession { .. }
            | Self::Bounces { .. }
            | Self::Rests { .. } => Vec::new(),
        }
    }
}

fn raises(vertical: [f64; 2], is_constant: bool, [friction, air]: [bool; 2]) -> String {
    let cause = works([friction, air, false]);
    let turn = if friction && air { "turn" } else { "turns" };
    let torque = if is_constant {
        format!(
            "The torque of {cause} is horizontal: it shortens the horizontal part of the angular momentum and leaves the vertical part unchanged."
        )
    } else if vertical[1] > vertical[0] {
        format!(
            "The torque of {cause} shortens the horizontal part of the angular momentum, while the vertical part grows."
        )
    } else {
        format!(
            "The torque of {cause} shortens the horizontal part of the angular momentum by a larger fraction than the vertical part."
        )
    };
    format!(
        "The top rises because {cause} {turn} its angular momentum upright. {torque} The top spins so fast that its axis stays close to the angular momentum, and rises with it."
    )
}

fn slip_ends(stops: Stopped, rolls: bool) -> &'static str {
    match (stops, rolls) {
        (Stopped::Rise, true) => {
            "The rise ends where the peg begins to roll: the contact point no longer slips, friction does no more work, and the axis nutates between fixed inclinations."
        }
        (Stopped::Inversion, true) => {
            "The top does not turn over, because the peg rolls: the contact point does not slip, friction does no work, and the axis nutates between fixed inclinations."
        }
        (Stopped::Nothing, true) => {
            "The peg rolls to the end: the contact point does not slip, friction does no work, and the axis nutates between fixed inclinations."
        }
        (Stopped::Rise, false) => {
            "The rise ends where the contact point stops slipping: friction does no more work, and the top turns as a whole, at a fixed inclination."
        }
        (Stopped::Inversion | Stopped::Nothing, false) => {
            "The contact point does not slip to the end: friction does no work, and the top turns as a whole, at a fixed inclination."
        }
    }
}

fn bounces(starts_in_air: bool, lands: bool, loses: bool) -> &'static str {
    match (starts_in_air, lands, loses) {
        (true, true, true) => {
            "The top starts in the air. Its peg bounces, and the impacts dissipate energy, until it stays on the table."
        }
        (true, true, false) => "The top starts in the air, and its peg lands on the table.",
        (true, false, true) => {
            "The top starts in the air. Its peg bounces on the table to the end, and the impacts dissipate energy."
        }
        (true, false, false) => "The top starts in the air, and is in the air at the end.",
        (false, true, true) => {
            "At times the force between peg and table falls to zero: the peg hops, and its impacts dissipate energy."
        }
        (false, true, false) => {
            "At times the force between peg and table falls to zero, and the peg hops."
        }
        (false, false, true) => {
            "At times the force between peg and table falls to zero: the peg hops, its impacts dissipate energy, and it is in the air at the end."
        }
        (false, false, false) => {
            "The force between peg and table falls to zero, and the peg is in the air at the end."
        }
    }
}

/// A text with a capital first letter.
fn capitalized(text: &str) -> String {
    let mut characters = text.chars();
    match characters.next() {
        Some(first) => first.to_uppercase().chain(characters).collect(),
        None => String::new(),
    }
}
