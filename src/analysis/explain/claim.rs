//! Claims about the cause of a motion, and the numbers that carry them.

mod sentence;

use super::fact::Fact;
use super::time_span::TimeSpan;
use crate::analysis::losses::Losses;
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
        /// The beginning of the rise, s.
        from: f64,
        /// The end of the rise, s.
        until: f64,
        /// Inclination of the axis in the last sample, rad: the top may fall after its rise.
        theta_at_end: f64,
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
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
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
    },
    /// The spin is, or becomes, too slow to hold the axis up, and the top falls.
    ///
    /// Gravity adds more energy up to the fall than the motion across the axis has at the start. Without friction, energy
    /// and both angular momenta decide whether the motion from the start reaches the inclination of the fall: they allow
    /// it if the top is weak from the start, and don't if friction has to slow the spin first.
    WeakTopFalls {
        /// Angular momentum about the axis at the start and at the fall, kg m²/s.
        axial: [f64; 2],
        /// The magnitude below which the top is weak, √(4 M g l I_x), kg m²/s: more than that at the fall.
        critical: f64,
        /// Inclination at the start and at the fall, rad; it increases.
        theta: [f64; 2],
        /// Time of the fall, s.
        time: f64,
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
        /// Why the spin is too slow.
        weakness: Weakness,
    },
    /// Friction shortens the part of the angular momentum about the axis, as in fast precession: the axis turns away from
    /// the angular momentum, which is less inclined in the end.
    ///
    /// Gravity and the normal force have no torque about the axis. The whole angular momentum does not grow, so the angle
    /// between it and the axis increases only because of its part about the axis.
    FrictionLowers {
        /// Time at which the top begins to sink, s.
        from: f64,
        /// The end of the fall, s.
        until: f64,
        /// Angle between the axis and the line of the angular momentum at these times, rad; it increases.
        angle_to_momentum: [f64; 2],
        /// The largest inclination of the line of the angular momentum between them, rad: less than half of this increase.
        momentum_inclination: f64,
        /// Angular momentum about the axis, kg m²/s; its size decreases.
        axial: [f64; 2],
        /// Inclination of the axis, rad; it increases.
        theta: [f64; 2],
        /// Whether the top falls to the level of the event.
        falls: bool,
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
    },
    /// The mean inclination changes from one nutation to another, in one sense but for a tenth of its range in the run.
    ///
    /// Without friction, the angular momenta about the vertical and the axis are constant, and the axis nutates about
    /// the inclination at which a top with these precesses without nutation. Losses change the angular momenta, and with
    /// them that inclination; and they change the nutation, in which the mean differs from it. The change of the mean is
    /// the sum of both.
    MeanInclinationChanges {
        /// The beginning of the change, s.
        from: f64,
        /// The end of the change, s.
        until: f64,
        /// Mean inclination in the first and the last nutation of that time, rad.
        mean_theta: [f64; 2],
        /// The ends of these nutations, s: the last samples in them.
        nutation_ends: [f64; 2],
        /// Inclination without nutation, rad, with the angular momenta at these times.
        regular_theta: [f64; 2],
        /// Whether the peg hits the table meanwhile, as far as impacts are recorded.
        has_impacts: bool,
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
    },
    /// A top falls in its first nutation as it would without friction, and not because it is weak: its energy and its
    /// angular momenta allow it. It is strong, or its motion at the start has more energy than gravity adds.
    SwingsDown {
        /// Inclination at the start and at the fall, rad; it increases.
        theta: [f64; 2],
        /// Time of the fall, s.
        time: f64,
        /// Kinetic energy of the motion across the axis at the start, J.
        kinetic: f64,
        /// Work of gravity from the start to the fall, J.
        by_gravity: f64,
    },
    /// A tippe top that had enough energy at the start does not turn over, because too little is left.
    EnergySpent {
        /// Energy at the start and in the last sample, J.
        energy: [f64; 2],
        /// The least energy at some inclination between that at the end and the horizontal, J: more than is left.
        needed: f64,
    },
    /// A tippe top has not turned over at the time limit: it has enough energy, and its contact point slips.
    NotYetInverted {
        /// Energy in the last sample, J.
        energy: f64,
        /// The least energy at each inclination between that at the end and the horizontal, J: not more than the top has.
        needed: f64,
        /// Slip speed in the last sample, m/s; positive.
        slip_speed: f64,
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
        /// Energy in the first and the last of these samples, J; it is constant unless other losses act.
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
        /// Time at which it is first in the air, s.
        from: f64,
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

/// Why the spin of a top is too slow when it falls.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Weakness {
    /// It is from the start.
    FromStart,
    /// It is from the start, but the axis would come up again if nothing slowed the spin further.
    NeedsLoss,
    /// Friction or air drag have slowed it.
    ByLoss,
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

/// The motion that a claim gives a cause of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Effect {
    /// A rise of the top.
    Rise,
    /// A fall of the top at a time, s.
    Fall { time: f64 },
    /// A tippe top that turns over, or does not.
    Inversion,
    /// None of these.
    Other,
}

impl Claim {
    /// The time in which the claim holds.
    pub fn interval(&self) -> TimeSpan {
        match self {
            Self::Conserves { .. }
            | Self::FrictionSpeedsPrecession { .. }
            | Self::LossesAlign { .. }
            | Self::StaysUpright { .. }
            | Self::EnergySpent { .. }
            | Self::NotYetInverted { .. }
            | Self::RestsFromStart { .. } => TimeSpan::WHOLE,
            Self::WeakTopFalls { time, .. }
            | Self::SwingsDown { time, .. }
            | Self::Inverts { time, .. }
            | Self::ComesToRest { from: time, .. } => TimeSpan::at(*time),
            Self::SlipEnds { from, .. }
            | Self::Bounces {
                from, lands: None, ..
            } => TimeSpan::from(*from),
            Self::FrictionRaises { from, until, .. }
            | Self::FrictionLowers { from, until, .. }
            | Self::MeanInclinationChanges { from, until, .. }
            | Self::Bounces {
                from,
                lands: Some(until),
                ..
            } => TimeSpan::between(*from, *until),
        }
    }

    /// The motion that it gives a cause of.
    pub(super) fn effect(&self) -> Effect {
        match self {
            Self::FrictionRaises { .. }
            | Self::FrictionSpeedsPrecession { .. }
            | Self::LossesAlign { .. } => Effect::Rise,
            Self::WeakTopFalls { time, .. } | Self::SwingsDown { time, .. } => {
                Effect::Fall { time: *time }
            }
            Self::StaysUpright { .. }
            | Self::Inverts { .. }
            | Self::EnergySpent { .. }
            | Self::NotYetInverted { .. } => Effect::Inversion,
            _ => Effect::Other,
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
            Self::EnergySpent { energy, needed } => vec![Fact::EnergyLeft {
                energy: energy[1],
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
                ..
            } => vec![Fact::HeldTheta {
                least: *least,
                greatest: *greatest,
                rolls: *rolls,
            }],
            Self::Conserves { .. }
            | Self::FrictionSpeedsPrecession { .. }
            | Self::MeanInclinationChanges { .. }
            | Self::SwingsDown { .. }
            | Self::NotYetInverted { .. }
            | Self::Bounces { .. }
            | Self::RestsFromStart { .. }
            | Self::ComesToRest { .. } => Vec::new(),
        }
    }
}
