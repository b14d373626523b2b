//! Why the mean inclination of the axis changes, in terms of precession without nutation.
//!
//! Without friction, the angular momenta about the vertical and the axis are constant, and the axis nutates about the
//! inclination at which a top with these precesses regularly. Friction changes the mean inclination in two ways: it
//! changes the angular momenta, and with them that inclination; and it changes the nutation, in which the mean differs
//! from that inclination if the nutation is large. The change is the sum of the two parts.

mod words;

use super::evidence::Evidence;
use super::fact;
use super::momentum::MomentumState;
use crate::analysis::history::Cycle;
use crate::physics::math::{atan2, sin_cos};
use crate::physics::top::Top;
use crate::telemetry::fields::nutation;
use std::f64::consts::FRAC_PI_2;
use std::ops::Range;

/// The ratio of a part to the whole change for which that part is the larger one, and in the same direction; a part that
/// is much larger than the change says little, because the other one takes most of it back.
const LARGER_PART: Range<f64> = 0.5..2.0;

/// Part of a change by which a motion may turn back and still count as one rise or one fall.
const SMALL_PART: f64 = 0.25;

/// Change of the mean inclination in a rise, relative to it, that is told before a fall.
const NOTABLE: f64 = 0.1;

/// Change of the mean inclination, relative to it, that numbers of four digits hardly show.
const UNSEEN: f64 = 1e-3;

/// The causes of the changes of the mean inclination by friction: of one rise or fall, or of two after one another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Drift {
    parts: Vec<DriftPart>,
    /// Whether friction at the contact point acts, and whether air drag does.
    losses: [bool; 2],
    is_tippe_top: bool,
    place: Place,
    /// Whether the contact point slips no more at the end of the run.
    grips: bool,
    falls: bool,
}

/// What a drift is part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Place {
    /// No other cause explains a rise or a fall.
    Whole,
    /// Another cause explains a fall after it.
    Earlier,
    /// Another cause explains a rise before it.
    Later,
}

/// A rise or a fall on average.
#[derive(Clone, Copy, Debug, PartialEq)]
struct DriftPart {
    /// Change of the mean inclination, rad.
    change: f64,
    /// `None` if the numbers don't show it.
    cause: Option<Cause>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Cause {
    /// The angular momenta change, and with them the inclination without nutation.
    Momenta(Option<Turn>),
    /// The nutation shrinks.
    Damping,
    /// The nutation grows, upwards and downwards.
    Growth,
    /// The mean inclination hardly changes.
    Absent,
}

/// What moves the inclination without nutation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Turn {
    /// The angular momentum turns, and the axis with it. `by_line`: it points down.
    Momentum { by_line: bool },
    /// The rotation about the axis becomes slower or faster, and the angle between axis and angular momentum larger or
    /// smaller.
    Axis { by_line: bool },
}

/// The mean motion at the end of a nutation, or the motion at the end of a run that no longer nutates.
#[derive(Clone, Copy)]
struct Point {
    /// Mean inclination, rad.
    theta: f64,
    /// Least and greatest inclination, rad.
    extremes: [f64; 2],
    momentum: MomentumState,
    nutates: bool,
}

impl Point {
    fn new(cycle: &Cycle, momentum: MomentumState) -> Self {
        Self {
            theta: cycle.means[0],
            extremes: [nutation::THETA_MIN, nutation::THETA_MAX].map(|field| cycle.field(field)),
            momentum,
            nutates: true,
        }
    }

    /// The range of the inclination, rad.
    fn range(&self) -> f64 {
        self.extremes[1] - self.extremes[0]
    }
}

/// The causes of the changes of the mean inclination; `None` if the numbers show none.
pub(super) fn drift(evidence: &Evidence) -> Option<Drift> {
    let points = points(evidence, Until::Grip)?;
    let [from, to] = [points[0].theta, points[points.len() - 1].theta];
    let stays = points
        .iter()
        .all(|point| (point.theta - from).abs() <= UNSEEN * from);
    let parts = if stays && fact::is_same_angle(from, to) && evidence.fall().is_none() {
        vec![DriftPart {
            change: to - from,
            cause: Some(Cause::Absent),
        }]
    } else {
        parts(evidence, &points)
    };
    // Without a cause, the words would be those of the facts.
    parts
        .iter()
        .any(|part| part.cause.is_some())
        .then(|| new_drift(evidence, parts, Place::Whole))
}

/// The cause of a fall after a rise that has another cause; `None` if the axis does not sink again. `is_held`: another
/// claim says that the inclination stays once the contact point grips.
pub(super) fn later_fall(evidence: &Evidence, is_held: bool) -> Option<Drift> {
    let grips = evidence.observations.grip.is_some();
    let until = if grips && is_held {
        Until::Grip
    } else {
        Until::End
    };
    let all = points(evidence, until).unwrap_or_default();
    let after = &all[least(&all)..];
    let fall_time = evidence.fall().map(|fall| fall.time);
    let part = match after {
        [first, .., last] => DriftPart {
            change: last.theta - first.theta,
            // Static friction changes the angular momenta of a rolling top to and fro.
            cause: only_cause(evidence, after).filter(|_| !grips && last.theta > first.theta),
        },
        _ => DriftPart {
            change: 0.0,
            cause: None,
        },
    };
    let rise = all.first().map_or(0.0, |start| start.theta)
        - after.first().map_or(0.0, |point| point.theta);
    let sinks = part.change > SMALL_PART * rise;
    let falls =
        fall_time.is_some_and(|time| after.first().is_none_or(|point| time > point.momentum.time));
    (sinks || falls).then(|| {
        let part = DriftPart {
            change: part.change.abs(),
            ..part
        };
        new_drift(evidence, vec![part], Place::Later)
    })
}

/// The cause of a rise before a fall that has another cause; `None` if the axis does not rise notably first.
pub(super) fn earlier_rise(evidence: &Evidence) -> Option<Drift> {
    let all = points(evidence, Until::Grip)?;
    let before = &all[..=least(&all)];
    let [first, .., last] = before else {
        return None;
    };
    let change = last.theta - first.theta;
    let part = DriftPart {
        change,
        cause: only_cause(evidence, before),
    };
    (-change > NOTABLE * first.theta).then(|| new_drift(evidence, vec![part], Place::Earlier))
}

/// The cause of one rise or fall; `None` if the axis turns back in it.
fn only_cause(evidence: &Evidence, points: &[Point]) -> Option<Cause> {
    match parts(evidence, points)[..] {
        [part] => part.cause,
        _ => None,
    }
}

fn new_drift(evidence: &Evidence, parts: Vec<DriftPart>, place: Place) -> Drift {
    let friction = &evidence.scenario.model.friction;
    Drift {
        parts,
        losses: [friction.acts_at_contact(), friction.has_air_drag()],
        is_tippe_top: evidence.history.is_tippe_top(),
        place,
        grips: evidence.observations.grip.is_some(),
        falls: evidence.fall().is_some(),
    }
}

/// The end of the mean motions that are looked at.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Until {
    /// The contact point grips to the end of the run, or the run ends without that. Static friction changes the angular momenta of a rolling top to
    /// and fro, and holds one that sticks.
    Grip,
    /// The run ends.
    End,
}

/// The mean motions in the order of time; `None` if there are fewer than two.
fn points(evidence: &Evidence, until: Until) -> Option<Vec<Point>> {
    let observations = &evidence.observations;
    let whole = observations.momentum.whole()?;
    let (end, theta, momentum) = match observations.grip {
        Some(grip) if until == Until::Grip => {
            (grip.from, grip.theta_at_start, grip.momentum_before?)
        }
        _ => (f64::INFINITY, whole.to.theta, whole.to),
    };
    let mut points = Vec::new();
    let mut last = None;
    let cycles = &evidence.history.cycles;
    for (cycle, momentum) in cycles.iter().zip(&observations.momentum_in_nutations) {
        if cycle.end() <= end {
            points.push(Point::new(cycle, (*momentum)?));
            last = Some(cycle);
        }
    }
    if last.is_some_and(|last| last.is_last_before(end.min(whole.to.time))) {
        points.push(Point {
            theta,
            extremes: [theta; 2],
            momentum,
            nutates: false,
        });
    }
    (points.len() >= 2).then_some(points)
}

/// The point of the least inclination; 0 if there are none.
fn least(points: &[Point]) -> usize {
    let least = points
        .iter()
        .enumerate()
        .min_by(|(_, one), (_, other)| one.theta.total_cmp(&other.theta));
    least.map_or(0, |(at, _)| at)
}

/// The causes of one rise or fall, or of two if the axis turns back in between.
fn parts(evidence: &Evidence, points: &[Point]) -> Vec<DriftPart> {
    let last = points.len() - 1;
    let turning = turning(points);
    let pieces = if turning == 0 || turning == last {
        vec![points]
    } else {
        vec![&points[..=turning], &points[turning..]]
    };
    let top = evidence.scenario.model.nutating_top();
    // Impacts change the nutation, too.
    let is_by_friction = !evidence.may_have_impacts();
    pieces
        .into_iter()
        .map(|piece| part(&top, piece, is_by_friction))
        .collect()
}

/// The point of the greatest inclination or of the least, whichever is farther beyond those of the first and the last
/// point; the last one if neither is by more than a small part of the range.
fn turning(points: &[Point]) -> usize {
    let last = points.len() - 1;
    let (mut least, mut greatest) = (0, 0);
    for (at, point) in points.iter().enumerate() {
        if point.theta < points[least].theta {
            least = at;
        }
        if point.theta > points[greatest].theta {
            greatest = at;
        }
    }
    let [first, end] = [points[0].theta, points[last].theta];
    let below = first.min(end) - points[least].theta;
    let above = points[greatest].theta - first.max(end);
    let (farthest, distance) = if below > above {
        (least, below)
    } else {
        (greatest, above)
    };
    let range = points[greatest].theta - points[least].theta;
    if distance > SMALL_PART * range {
        farthest
    } else {
        last
    }
}

/// The cause of one rise or fall.
fn part(top: &Top, points: &[Point], is_by_friction: bool) -> DriftPart {
    let (from, to) = (&points[0], &points[points.len() - 1]);
    let change = to.theta - from.theta;
    let cause = if turning(points) == points.len() - 1 {
        cause(top, [from, to], is_by_friction)
    } else {
        None
    };
    DriftPart { change, cause }
}

fn cause(top: &Top, [from, to]: [&Point; 2], is_by_friction: bool) -> Option<Cause> {
    let change = to.theta - from.theta;
    let regular = [from, to].map(|point| RegularMotion::new(top, &point.momentum));
    let by_momenta = (regular[1].theta - regular[0].theta) / change;
    if LARGER_PART.contains(&by_momenta) {
        return Some(Cause::Momenta(turn(regular)));
    }
    let shrinks = to.range() < 0.5 * from.range();
    let grows = to.extremes[0] < from.extremes[0] && to.extremes[1] > from.extremes[1];
    if !is_by_friction || !to.nutates {
        None
    } else if LARGER_PART.contains(&(1.0 - by_momenta)) && shrinks {
        Some(Cause::Damping)
    } else if grows && by_momenta < 1.0 {
        Some(Cause::Growth)
    } else {
        None
    }
}

/// Regular precession with the angular momenta of a motion.
#[derive(Clone, Copy)]
struct RegularMotion {
    /// Inclination of the axis, rad.
    theta: f64,
    /// Inclination of the line of the angular momentum towards the axis, rad.
    momentum_inclination: f64,
    /// Size of the angular momentum about the axis, kg m²/s.
    axial: f64,
    points_down: bool,
}

impl RegularMotion {
    fn new(top: &Top, momentum: &MomentumState) -> Self {
        let (vertical, axial) = (momentum.vertical, momentum.axial);
        let theta = top.regular_inclination(vertical, axial);
        let (sin, cos) = sin_cos(theta);
        // The angular momentum is in the plane of the axis and the vertical.
        let horizontal = (axial - vertical * cos) / sin;
        let sense = if momentum.points_down() { -1.0 } else { 1.0 };
        Self {
            theta,
            momentum_inclination: atan2(sense * horizontal, sense * vertical),
            axial: axial.abs(),
            points_down: momentum.points_down(),
        }
    }

    fn angle_to_axis(&self) -> f64 {
        self.theta - self.momentum_inclination
    }
}

fn turn([from, to]: [RegularMotion; 2]) -> Option<Turn> {
    let change = to.theta - from.theta;
    let by_line = from.points_down;
    let by_momentum = (to.momentum_inclination - from.momentum_inclination) / change;
    let is_slower = to.axial < from.axial;
    // Beyond a right angle to its line, the axis is nearer to the other end of the line.
    let is_near = [from, to]
        .iter()
        .all(|regular| (0.0..FRAC_PI_2).contains(&regular.angle_to_axis()));
    if !is_near {
        None
    } else if LARGER_PART.contains(&by_momentum) {
        Some(Turn::Momentum { by_line })
    } else if LARGER_PART.contains(&(1.0 - by_momentum)) && is_slower == (change > 0.0) {
        Some(Turn::Axis { by_line })
    } else {
        None
    }
}

impl Drift {
    /// Whether it is told before the words about a fall, or about the end of slip.
    pub(super) fn comes_first(&self) -> bool {
        self.place != Place::Later
    }
}

#[cfg(test)]
mod tests {
    use crate::analysis::explain::explain;
    use crate::run::scenario::{Preset, Scenario};

    #[test]
    fn names_why_the_mean_inclination_changes() {
        for (preset, keys, expected) in [
            (
                "lifecycle",
                &["initial.theta = 1.45"][..],
                "and sinks, until the top falls",
            ),
            (
                "spin-torque-only",
                &["initial.theta = 1.45"],
                "Friction slows the rotation about the axis",
            ),
            (
                "paper-precession-term-only",
                &["friction.k = 0.3"],
                "precess without nutation decreases. The axis follows it, and rises",
            ),
            ("tilt-torque-only", &["initial.psi_dot = 30"], "and sinks."),
            (
                "paper-spin-term-only",
                &["initial.phi_dot = 30"],
                "the nutation grows",
            ),
            (
                "free-viscous",
                &[
                    "initial.psi_dot = 35",
                    "initial.theta = 0.3",
                    "friction.k = 0.01",
                    "stop.duration = 10",
                ],
                "damps the nutation",
            ),
            (
                "free-paper",
                &["initial.psi_dot = 30"],
                "Until the contact point slips for the last time, friction",
            ),
            (
                "paper",
                &["stop.theta_risen = ", "stop.duration = 40"],
                "and rises with it. Later, friction slows the rotation about the axis",
            ),
            (
                "free-paper",
                &[
                    "air.axial = 1e-6",
                    "air.transverse = 1e-6",
                    "stop.duration = 100",
                ],
                "and rises with it. Later, the axis sinks again.",
            ),
            (
                "viscous",
                &[
                    "initial.phi_dot = 30",
                    "air.axial = 1e-5",
                    "air.transverse = 1e-5",
                ],
                "and rises. Later, friction and air drag slow the spin",
            ),
            (
                "paper",
                &["initial.theta = 2.9", "stop.theta_fallen = "],
                "and sinks. Later, friction changes",
            ),
            (
                "free-viscous",
                &["initial.theta = 2.0", "stop.theta_fallen = "],
                "The axis follows it, and rises.",
            ),
            (
                "rise-by-loss-of-spin",
                &["initial.theta = 2.9", "stop.theta_fallen = "],
                "The axis follows it, and sinks.",
            ),
            ("drop", &["friction.k = 0.003"], "and rises"),
            (
                "rise-by-loss-of-spin",
                &["initial.theta = 1.45"],
                "because of its motion at the start",
            ),
        ] {
            let mut values = Preset::find(preset).unwrap().values().unwrap();
            for (key, value) in keys.iter().filter_map(|key| key.split_once(" = ")) {
                values.set(key, value).unwrap();
            }
            let explanation = explain(&Scenario::new(values).unwrap()).unwrap();
            let text = explanation.story.text().unwrap_or_default();
            assert!(text.contains(expected), "{preset}, {keys:?}: {text}");
        }
    }

    #[test]
    fn a_nutation_is_no_fall_after_a_rise() {
        for duration in ["1.3", "1.5", "2", "2.5", "4.3"] {
            for (key, value) in [("initial.theta_dot", "15"), ("initial.phi_dot", "-10")] {
                let mut values = Preset::find("paper").unwrap().values().unwrap();
                values.set(key, value).unwrap();
                values.set("stop.duration", duration).unwrap();
                let explanation = explain(&Scenario::new(values).unwrap()).unwrap();
                let text = explanation.story.text().unwrap_or_default();
                assert!(!text.contains("sinks"), "{key} {value}, {duration}: {text}");
            }
        }
    }
}
