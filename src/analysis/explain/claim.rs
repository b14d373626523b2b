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
    /// largest angle to the axis: the axis must follow. All angles to the angular momentum are those to its line: a
    /// top that spins the other way has one that points down.
    FrictionRaises {
        /// Horizontal part of the angular momentum, kg m²/s; it decreases.
        horizontal: [f64; 2],
        /// Vertical part of the angular momentum, kg m²/s.
        vertical: [f64; 2],
        /// Whether the vertical part is constant, because friction has no torque about the vertical.
        is_vertical_constant: bool,
        /// Change of the horizontal part by friction and air drag, kg m²/s: more than half of its change.
        by_friction: f64,
        /// The largest angle between the axis and the line of the angular momentum, rad.
        angle_to_momentum: f64,
        /// Inclination of the axis, rad; it decreases.
        theta: [f64; 2],
        /// The end of the rise, s.
        until: f64,
        /// Inclination of the axis in the last sample, rad: the top may fall after its rise.
        theta_at_end: f64,
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
        /// Angle between the axis and the line of the angular momentum, rad; it decreases.
        angle_to_momentum: [f64; 2],
        /// The largest inclination of the line of the angular momentum, rad: less than half of this decrease.
        momentum_inclination: f64,
        /// Energy, J; it decreases.
        energy: [f64; 2],
        /// Whether there is friction at the contact point.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
    },
    /// The spin is, or becomes, too slow to hold the axis up, and the top falls.
    ///
    /// Without friction, energy and both angular momenta decide whether the motion from the start reaches the
    /// inclination of the fall. They don't allow it without gravity: neither the motion at the start nor the
    /// centrifugal force carries the axis there. With gravity they allow it if the top is weak from the start, and
    /// don't if friction has to slow the spin first.
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
    /// Friction shortens the part of the angular momentum about the axis, as in fast precession: the axis turns away from
    /// the angular momentum, which is less inclined in the end.
    ///
    /// Gravity and the normal force have no torque about the axis. The whole angular momentum does not grow, so the angle
    /// between it and the axis increases only because of its part about the axis.
    FrictionLowers {
        /// Time at which the axis is least inclined, s.
        from: f64,
        /// Angle between the axis and the line of the angular momentum then and in the last sample, rad; it increases.
        angle_to_momentum: [f64; 2],
        /// The largest inclination of the line of the angular momentum since then, rad: less than half of this increase.
        momentum_inclination: f64,
        /// Angular momentum about the axis, kg m²/s; its size decreases.
        axial: [f64; 2],
        /// Inclination of the axis, rad; it increases.
        theta: [f64; 2],
        /// Whether the top falls to the level of the event.
        falls: bool,
        /// Whether there is friction at the contact point.
        has_friction: bool,
        /// Whether there is air drag.
        has_air_drag: bool,
    },
    /// A tippe top does not turn over, because its energy at the start is less than the least with which the axis can
    /// reach the horizontal with this Jellett's integral.
    StaysUpright {
        /// Energy at the start, J.
        energy: f64,
        /// The least energy at some inclination between that at the start and the horizontal, J; it is more.
        needed: f64,
        /// That inclination, rad.
        needed_at: f64,
        /// Jellett's integral, kg m³/s.
        jellett: f64,
        /// The largest deviation of Jellett's integral, relative to its terms.
        jellett_deviation: f64,
        /// The spin at the start, with the same inclination and other rates, with which it would have enough energy.
        sufficient_spin: SufficientSpin,
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
    /// The contact point does not slip at the end: friction does no work then.
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
        /// Whether it slipped before.
        has_slipped: bool,
        /// Whether it gripped even before that slip.
        alternates: bool,
        /// Whether it grips for a nutation at least, or at a constant inclination: only then is the range of the
        /// inclination that of the motion.
        lasts: bool,
        /// Whether the inclination is constant since then, within the integration error.
        is_inclination_constant: bool,
        /// Inversion of a tippe top; absent for other tops, if it is claimed, or if the axis passed the horizontal
        /// and came back.
        inversion: Option<Inversion>,
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
        /// Whether it bounces to the end: it never stays on the table, hits it at least twice, and the last impact is
        /// no longer ago than the others are apart.
        bounces_to_end: bool,
    },
    /// The top does not move at all.
    RestsFromStart {
        /// Inclination, rad.
        theta: f64,
        /// What holds it.
        held_by: Hold,
    },
    /// The top moves, and comes to rest; it stays there to the end.
    ComesToRest {
        /// Start of the rest, s.
        from: f64,
        /// Inclination, rad.
        theta: f64,
        /// Kinetic energy in the first and the last sample, J.
        kinetic: [f64; 2],
        /// What holds it.
        held_by: Hold,
    },
}

/// The spin with which a tippe top would have enough energy to turn over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum SufficientSpin {
    /// A faster one.
    Faster,
    /// None, because a faster spin raises the least energy by more than that of the top.
    Absent,
    /// It is not known.
    Unknown,
}

/// What holds a top at rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Hold {
    /// Static friction of a fixed peg, against gravity.
    StaticFriction,
    /// Rolling resistance of a free peg, against gravity.
    RollingResistance,
    /// Nothing has to: gravity has no torque.
    Balance,
}

/// What the end of the slip stops.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Stopped {
    /// The rise of a top.
    Rise,
    /// Nothing that has begun.
    Nothing,
}

/// Inversion of a tippe top by the time its contact point no longer slips.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Inversion {
    /// The axis has not passed the horizontal, and does not to the end.
    Absent,
    /// The axis has passed the horizontal, and stays beyond it.
    Complete,
}

impl Claim {
    /// Whether friction raises the top and the rise ends before this time, s.
    fn is_rise_before(&self, time: f64) -> bool {
        matches!(self, Self::FrictionRaises { until, .. } if *until < time)
    }

    /// Whether the top rises, and is more inclined in the end than at the start.
    fn is_rise_undone(&self) -> bool {
        matches!(self, Self::FrictionRaises { theta, theta_at_end, .. } if *theta_at_end > theta[0])
    }

    /// Whether the top falls after this time, s.
    fn is_fall_after(&self, from: f64) -> bool {
        match self {
            Self::WeakTopFalls { time, .. } => *time > from,
            // The axis is least inclined about when the angular momentum is.
            Self::FrictionLowers { .. } => true,
            _ => false,
        }
    }

    /// The claim in words, as sentences of a paragraph about all `claims`.
    #[allow(clippy::too_many_lines, reason = "a template for each claim")]
    pub(super) fn words_among(&self, claims: &[Self]) -> String {
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
                until,
                ..
            } => raises(
                *vertical,
                *is_vertical_constant,
                [*has_friction, *has_air_drag],
                self.is_rise_undone() || claims.iter().any(|claim| claim.is_fall_after(*until)),
            ),
            Self::FrictionSpeedsPrecession { .. } => {
                // A second argument for what the first has explained already.
                speeds_precession(claims.iter().any(|claim| claim.is_rise_before(f64::INFINITY)))
            }
            Self::LossesAlign {
                has_friction,
                has_air_drag,
                ..
            } => {
                let cause = works([*has_friction, *has_air_drag, false]);
                let verb = if *has_friction && *has_air_drag { "take" } else { "takes" };
                format!(
                    "The precession is so fast that the angular momentum is nearly vertical, and {cause} {verb} energy from the motion. A body whose larger moment of inertia is that about its axis has least energy when it turns about this axis. So the axis turns towards the line of the angular momentum, and the top rises."
                )
            }
            Self::WeakTopFalls {
                axial,
                critical,
                time,
                has_friction,
                has_air_drag,
                ..
            } => {
                if axial[0].abs() < *critical {
                    return "The top falls because it is weak from the start: its spin is too slow to hold the axis up against gravity.".to_owned();
                }
                let cause = works([*has_friction, *has_air_drag, false]);
                let start = if claims.iter().any(|claim| claim.is_rise_before(*time)) {
                    format!("Later, {cause}")
                } else {
                    capitalized(cause)
                };
                let verb = if *has_friction && *has_air_drag { "slow" } else { "slows" };
                format!(
                    "{start} {verb} the spin until the top is weak: the spin no longer holds the axis up against gravity, and the top falls."
                )
            }
            Self::FrictionLowers {
                falls,
                has_friction,
                has_air_drag,
                ..
            } => lowers(
                claims.iter().any(|claim| claim.is_rise_before(f64::INFINITY)),
                [*has_friction, *has_air_drag],
                *falls,
            ),
            Self::StaysUpright {
                sufficient_spin, ..
            } => stays_upright(*sufficient_spin),
            Self::Inverts { .. } => {
                "The top turns over because its contact point slips. Friction at the contact point does not change Jellett's integral, and the angular momentum about the vertical keeps its sense while the axis turns over. So the spin about the axis is reversed in the end. The centre of mass rises, and the energy for this comes from the rotation.".to_owned()
            }
            Self::SlipEnds {
                stops,
                has_slipped,
                alternates,
                lasts,
                is_inclination_constant,
                inversion,
                rolls,
                ..
            } => {
                let before = inversion_words(*inversion);
                let grip = if *alternates {
                    alternating_grip(*rolls, *lasts)
                } else if *lasts {
                    lasting_grip(*stops, *rolls, *has_slipped)
                } else {
                    short_grip(*has_slipped)
                };
                let motion = if *lasts {
                    held_motion(*rolls, *is_inclination_constant)
                } else {
                    ""
                };
                format!("{before}{grip}{motion}.")
            }
            Self::Bounces {
                hops,
                impacts,
                starts_in_air: true,
                lands,
                lost,
                bounces_to_end,
            } => {
                let end = FlightEnd::new(*hops, lands.is_some(), *bounces_to_end);
                starts_in_flight(end, *impacts, *lost > 0.0)
            }
            Self::Bounces {
                hops,
                impacts,
                lands,
                lost,
                ..
            } => peg_hops(*hops, *impacts, lands.is_some(), *lost > 0.0),
            Self::RestsFromStart { held_by, .. } => {
                format!("The top starts at rest, and {}.", holds(*held_by))
            }
            Self::ComesToRest { held_by, .. } => format!(
                "The top comes to rest: its kinetic energy is spent, and {}.",
                holds(*held_by)
            ),
        }
    }

    /// The numbers of the claim that no other fact of an explanation states.
    pub(super) fn facts(&self) -> Vec<Fact> {
        match self {
            Self::FrictionRaises {
                horizontal,
                angle_to_momentum,
                theta,
                theta_at_end,
                until,
                ..
            } => vec![
                Fact::HorizontalMomentum {
                    first: horizontal[0],
                    last: horizontal[1],
                    // Since then, the axis has moved by more than in a nutation.
                    until: (*theta_at_end - theta[1] > *angle_to_momentum).then_some(*until),
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
            Self::FrictionLowers {
                from,
                angle_to_momentum,
                ..
            } => vec![Fact::TurnsAway {
                from: *from,
                first: angle_to_momentum[0],
                last: angle_to_momentum[1],
            }],
            Self::StaysUpright { energy, needed, .. } => vec![Fact::EnergyToTurnOver {
                energy: *energy,
                needed: *needed,
            }],
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
                lasts: true,
                ..
            } => vec![Fact::HeldTheta {
                least: *least,
                greatest: *greatest,
                rolls: *rolls,
            }],
            Self::Conserves { .. }
            | Self::FrictionSpeedsPrecession { .. }
            | Self::SlipEnds { lasts: false, .. }
            | Self::Bounces { .. }
            | Self::RestsFromStart { .. }
            | Self::ComesToRest { .. } => Vec::new(),
        }
    }
}

/// The paper's argument; `is_second` if another has explained the rise already.
fn speeds_precession(is_second: bool) -> String {
    let start = if is_second {
        "In the paper's terms, the"
    } else {
        "The"
    };
    format!(
        "{start} friction term of φ̈ speeds up the precession. Beyond the slow rate of regular precession, θ̈ is negative: the axis rises, and its rise slows the precession again. So the precession stays near the slow rate while the axis rises."
    )
}

fn raises(
    vertical: [f64; 2],
    is_constant: bool,
    [friction, air]: [bool; 2],
    falls_later: bool,
) -> String {
    let cause = works([friction, air, false]);
    let turn = if friction && air { "turn" } else { "turns" };
    let torque = if is_constant {
        format!(
            "The torque of {cause} is horizontal: it shortens the horizontal part of the angular momentum and leaves the vertical part unchanged."
        )
    } else if vertical[1].abs() > vertical[0].abs() {
        format!(
            "The torque of {cause} shortens the horizontal part of the angular momentum, while the vertical part grows."
        )
    } else {
        format!(
            "The torque of {cause} shortens the horizontal part of the angular momentum by a larger fraction than the vertical part."
        )
    };
    // The angular momentum of a top that spins the other way points down.
    let line = if vertical[0] < 0.0 {
        "the line of "
    } else {
        ""
    };
    let start = if falls_later { "At first, the" } else { "The" };
    format!(
        "{start} top rises because {cause} {turn} {line}its angular momentum upright. {torque} The top spins so fast that its axis stays close to {line}the angular momentum, and rises with it."
    )
}

fn lowers(is_later: bool, [friction, air]: [bool; 2], falls: bool) -> String {
    let cause = works([friction, air, false]);
    let shorten = if friction && air {
        "shorten"
    } else {
        "shortens"
    };
    let start = if is_later {
        format!("Later, {cause}")
    } else {
        capitalized(cause)
    };
    let falls = if falls { "falls" } else { "sinks" };
    format!(
        "{start} {shorten} the part of the angular momentum about the axis. So the axis turns away from the line of the angular momentum, which leans less in the end, and the top {falls}."
    )
}

fn stays_upright(sufficient_spin: SufficientSpin) -> String {
    let integral = "friction at the contact point does not change Jellett's integral";
    let barred = "with this value of the integral the axis could reach the horizontal only with more energy than the top has at the start";
    match sufficient_spin {
        SufficientSpin::Faster => {
            format!("The top does not turn over. It spins too slowly: {integral}, and {barred}.")
        }
        SufficientSpin::Absent => format!(
            "The top does not turn over, and would not with any other spin at the start: {integral}, and with the value that the integral has at any spin the axis could reach the horizontal only with more energy than the top then has."
        ),
        SufficientSpin::Unknown => {
            format!("The top does not turn over: {integral}, and {barred}.")
        }
    }
}

fn inversion_words(inversion: Option<Inversion>) -> &'static str {
    match inversion {
        Some(Inversion::Absent) => "The top does not turn over. ",
        Some(Inversion::Complete) => "The axis passes the horizontal, and stays beyond it. ",
        None => "",
    }
}

fn alternating_grip(rolls: bool, lasts: bool) -> &'static str {
    match (rolls, lasts) {
        (true, true) => {
            "The peg slips and rolls by turns, and then rolls to the end: the contact point no longer slips, friction does no more work"
        }
        (true, false) => "The peg slips and rolls by turns, and rolls at the end",
        (false, _) => {
            "The contact point slips and sticks by turns, and then sticks to the end: friction does no more work"
        }
    }
}

/// A peg that rolls for less than a nutation: others stick at a constant inclination.
fn short_grip(has_slipped: bool) -> &'static str {
    if has_slipped {
        "The peg slips at first, and rolls at the end"
    } else {
        "The peg does not slip, and rolls at the end"
    }
}

fn lasting_grip(stops: Stopped, rolls: bool, has_slipped: bool) -> &'static str {
    match (stops, rolls, has_slipped) {
        (Stopped::Rise, true, _) => {
            "The rise ends where the peg begins to roll: the contact point no longer slips, friction does no more work"
        }
        (Stopped::Rise, false, _) => {
            "The rise ends where the contact point stops slipping: friction does no more work"
        }
        (Stopped::Nothing, true, true) => {
            "The peg slips at first, and then rolls to the end: the contact point no longer slips, friction does no more work"
        }
        (Stopped::Nothing, true, false) => {
            "The peg rolls to the end: the contact point does not slip, friction does no work"
        }
        (Stopped::Nothing, false, true) => {
            "The contact point slips at first, and then sticks to the end: friction does no more work"
        }
        (Stopped::Nothing, false, false) => {
            "The contact point does not slip to the end: friction does no work"
        }
    }
}

fn held_motion(rolls: bool, is_constant: bool) -> &'static str {
    match (rolls, is_constant) {
        (true, false) => ", and the axis nutates between fixed inclinations",
        (true, true) => ", and the inclination of the axis stays constant",
        (false, _) => ", and the top turns as a whole, at a fixed inclination",
    }
}

/// The end of a motion that begins in the air.
enum FlightEnd {
    Lands,
    Bounces,
    /// In the air, for the first or another time.
    Flies,
    FliesAgain,
}

impl FlightEnd {
    fn new(hops: u64, lands: bool, bounces_to_end: bool) -> Self {
        match (lands, bounces_to_end, hops) {
            (true, ..) => Self::Lands,
            (false, true, _) => Self::Bounces,
            (false, false, 0 | 1) => Self::Flies,
            (false, false, _) => Self::FliesAgain,
        }
    }
}

fn starts_in_flight(end: FlightEnd, impacts: u64, loses: bool) -> String {
    let hits = match (impacts, loses) {
        (0, _) => "",
        (1, false) => " Its peg hits the table once.",
        (1, true) => " Its peg hits the table once, and the impact dissipates energy.",
        (_, false) => " Its peg bounces.",
        (_, true) => " Its peg bounces, and the impacts dissipate energy.",
    };
    match (end, impacts, loses) {
        (FlightEnd::Lands, 2.., true) => {
            "The top starts in the air. Its peg bounces, and the impacts dissipate energy, until it stays on the table.".to_owned()
        }
        (FlightEnd::Lands, 1, true) => {
            "The top starts in the air. Its peg hits the table once, the impact dissipates energy, and it stays on the table.".to_owned()
        }
        (FlightEnd::Lands, ..) => {
            "The top starts in the air, and its peg lands on the table.".to_owned()
        }
        (FlightEnd::Bounces, _, true) => {
            "The top starts in the air. Its peg bounces on the table to the end, and the impacts dissipate energy.".to_owned()
        }
        (FlightEnd::Bounces, _, false) => {
            "The top starts in the air. Its peg bounces on the table to the end.".to_owned()
        }
        (FlightEnd::Flies, ..) => {
            format!("The top starts in the air, and is in the air at the end.{hits}")
        }
        (FlightEnd::FliesAgain, ..) => {
            format!("The top starts in the air, lands, and is in the air again at the end.{hits}")
        }
    }
}

/// A top that hops from the table.
fn peg_hops(hops: u64, impacts: u64, lands: bool, loses: bool) -> String {
    let falls = if hops == 1 {
        "Once the force between peg and table falls to zero"
    } else {
        "At times the force between peg and table falls to zero"
    };
    let dissipation = match (impacts, loses) {
        (_, false) => "",
        (1, true) => "its impact dissipates energy",
        (_, true) => "its impacts dissipate energy",
    };
    match (lands, loses) {
        (true, true) => format!("{falls}: the peg hops, and {dissipation}."),
        (true, false) => format!("{falls}, and the peg hops."),
        (false, true) => {
            format!("{falls}: the peg hops, {dissipation}, and it is in the air at the end.")
        }
        (false, false) => format!("{falls}, and the peg is in the air at the end."),
    }
}

fn holds(held_by: Hold) -> &'static str {
    match held_by {
        Hold::StaticFriction => "static friction holds it against gravity",
        Hold::RollingResistance => "rolling resistance holds it against gravity",
        Hold::Balance => "gravity has no torque that would move it",
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
