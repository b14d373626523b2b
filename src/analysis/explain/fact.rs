//! Facts of an explanation.

mod sentence;

pub use self::sentence::ENERGY_ZERO;
pub(super) use self::sentence::times;

use crate::analysis::losses::Losses;
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
    /// The energy of a tippe top at the end, and what it needs to turn over.
    EnergyLeft {
        /// In the last sample, J.
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
        /// The losses that act.
        #[serde(flatten)]
        losses: Losses,
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
