//! The words of claims: templates of the sentences of a story.

use super::{Claim, Hold, Inversion, Stopped, SufficientSpin};
use crate::analysis::explain::course::Course;
use crate::analysis::phrase::works;
use crate::words::capitalized;

impl Claim {
    /// Whether it is about a rise of the top.
    pub(in crate::analysis::explain) fn is_rise(&self) -> bool {
        matches!(
            self,
            Self::FrictionRaises { .. }
                | Self::FrictionSpeedsPrecession { .. }
                | Self::LossesAlign { .. }
        )
    }

    /// Whether it is about a fall of the top, or the beginning of one.
    pub(in crate::analysis::explain) fn is_fall(&self) -> bool {
        matches!(
            self,
            Self::WeakTopFalls { .. } | Self::FrictionLowers { .. }
        )
    }

    /// Whether it is about a tippe top that turns over, or can't.
    pub(in crate::analysis::explain) fn is_inversion(&self) -> bool {
        matches!(self, Self::StaysUpright { .. } | Self::Inverts { .. })
    }

    /// The claim in words, as sentences of a paragraph about a motion of this course with these `claims`.
    #[allow(clippy::too_many_lines, reason = "a template for each claim")]
    pub(in crate::analysis::explain) fn words_in(&self, course: Course, claims: &[Self]) -> String {
        match self {
            Self::Conserves { .. } => format!(
                "Without friction, nothing changes the energy, the angular momentum about the vertical or the angular momentum about the axis.{}",
                repetition(course)
            ),
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
                course,
            ),
            Self::FrictionSpeedsPrecession { .. } => {
                // A second argument for what the first has explained already.
                let is_second = claims
                    .iter()
                    .any(|claim| matches!(claim, Self::FrictionRaises { .. }));
                speeds_precession(is_second, course)
            }
            Self::LossesAlign {
                has_friction,
                has_air_drag,
                ..
            } => {
                let cause = works([*has_friction, *has_air_drag, false]);
                let verb = if *has_friction && *has_air_drag { "take" } else { "takes" };
                let start = course.start_of_rise();
                format!(
                    "{start} precession is so fast that the angular momentum is nearly vertical, and {cause} {verb} energy from the motion. A body whose larger moment of inertia is that about its axis has least energy when it turns about this axis. So the axis turns towards the line of the angular momentum, and the top rises."
                )
            }
            Self::WeakTopFalls {
                axial,
                critical,
                has_friction,
                has_air_drag,
                needs_loss,
                ..
            } => {
                let weakness = if *needs_loss {
                    Weakness::NeedsLoss
                } else if axial[0].abs() < *critical {
                    Weakness::FromStart
                } else {
                    Weakness::ByLoss
                };
                weak_top_falls(weakness, [*has_friction, *has_air_drag], course)
            }
            Self::FrictionLowers {
                falls,
                has_friction,
                has_air_drag,
                ..
            } => lowers([*has_friction, *has_air_drag], *falls, course),
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
}

/// What follows from the conservation laws for the course of the motion.
fn repetition(course: Course) -> &'static str {
    match course {
        Course::Repeats => {
            " So each nutation repeats the one before it, and on average the top neither rises nor falls."
        }
        Course::FallsRepeatedly => {
            " So each nutation repeats the one before it: the axis swings down and up again."
        }
        // Without two nutations nothing is repeated.
        Course::Open
        | Course::Rises
        | Course::Falls
        | Course::RisesThenFalls
        | Course::FallsThenRises => "",
    }
}

/// Why the spin is too slow when a top falls.
enum Weakness {
    /// It is from the start.
    FromStart,
    /// It is from the start, but the axis would come up again if nothing slowed the spin further.
    NeedsLoss,
    /// Friction or air drag have slowed it.
    ByLoss,
}

fn weak_top_falls(weakness: Weakness, [friction, air]: [bool; 2], course: Course) -> String {
    let cause = works([friction, air, false]);
    let slow = if friction && air { "slow" } else { "slows" };
    let sentence = match (weakness, course) {
        (Weakness::FromStart, Course::FallsRepeatedly) => {
            "the top falls each time because it is weak from the start: its spin is too slow to hold the axis up against gravity.".to_owned()
        }
        (Weakness::FromStart, _) => {
            "the top falls because it is weak from the start: its spin is too slow to hold the axis up against gravity.".to_owned()
        }
        (Weakness::NeedsLoss, _) => format!(
            "the top is weak from the start: its spin is too slow to hold the axis up steadily. It would still sink and rise again without falling, but {cause} {slow} the spin further, and the top falls."
        ),
        (Weakness::ByLoss, _) => format!(
            "{cause} {slow} the spin until the top is weak: the spin no longer holds the axis up against gravity, and the top falls."
        ),
    };
    begun(course.start_of_fall(), &sentence)
}

/// A sentence after words of time, which may be empty.
fn begun(time: &str, sentence: &str) -> String {
    if time.is_empty() {
        capitalized(sentence)
    } else {
        format!("{time}{sentence}")
    }
}

/// The paper's argument; `is_second` if another has explained the rise already.
fn speeds_precession(is_second: bool, course: Course) -> String {
    let start = if is_second {
        "In the paper's terms, the"
    } else {
        course.start_of_rise()
    };
    format!(
        "{start} friction term of φ̈ speeds up the precession. Beyond the slow rate of regular precession, θ̈ is negative: the axis rises, and its rise slows the precession again. So the precession stays near the slow rate while the axis rises."
    )
}

fn raises(
    vertical: [f64; 2],
    is_constant: bool,
    [friction, air]: [bool; 2],
    course: Course,
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
    let start = course.start_of_rise();
    format!(
        "{start} top rises because {cause} {turn} {line}its angular momentum upright. {torque} The top spins so fast that its axis stays close to {line}the angular momentum, and rises with it."
    )
}

fn lowers([friction, air]: [bool; 2], falls: bool, course: Course) -> String {
    let cause = works([friction, air, false]);
    let shorten = if friction && air {
        "shorten"
    } else {
        "shortens"
    };
    let falls = if falls { "falls" } else { "sinks" };
    let sentence = format!(
        "{cause} {shorten} the part of the angular momentum about the axis. So the axis turns away from the line of the angular momentum, which leans less in the end, and the top {falls}."
    );
    begun(course.start_of_fall(), &sentence)
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
