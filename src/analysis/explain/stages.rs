//! What the axis did, in stages: found from the averaged motion and the events.

use super::pieces::Point;
use crate::analysis::course::Event;
use crate::run::simulation::{EventKind, UPRIGHT};

/// A turn of the averaged θ back by less than this part of all that it moved is not told: it is not what the run is
/// about.
const NOTABLE: f64 = 0.02;
/// An axis that stays near upright this many times as long as it takes, at the pace at which it came, from there to
/// upright and back sleeps; otherwise it passes. One that passes stays once as long; nutation about upright, which may make the
/// pace seem faster than it is, some times as long.
const ASLEEP: f64 = 5.0;
/// The number of points of the path from which that pace is taken: enough for their mean to be that of the drift, few enough
/// for the pace to be that near upright; a top that starts upright sleeps if it is there for as
/// many.
const PACE: usize = 10;

/// A stage of a run, or a moment.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Stage {
    pub(super) kind: Kind,
    /// When it begins and ends, s.
    pub(super) from: f64,
    pub(super) to: f64,
    /// Inclination then, rad.
    pub(super) thetas: [f64; 2],
    /// Least inclination in it, rad, and when.
    pub(super) least: (f64, f64),
    /// Greatest inclination less the least, rad.
    pub(super) range: f64,
    /// Whether inclinations are means over nutations.
    pub(super) is_mean: bool,
}

/// What a top does in a stage.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Rises,
    Sinks,
    /// Sinks until it has fallen.
    Falls,
    /// Neither rises nor sinks.
    Stays,
    /// Rolls without losses, so that θ swings and comes back each time.
    Swings,
    /// Stays near upright for long.
    Sleeps,
    /// Comes near upright for less than that.
    Passes,
    /// Turns as a whole about the contact point, which sticks.
    Sticks,
    /// A moment: what an event says.
    Moment(EventKind),
}

impl Kind {
    /// What the top does, as a verb.
    pub(super) fn verb(self) -> Option<&'static str> {
        Some(match self {
            Self::Rises | Self::Moment(EventKind::Risen) => "rises",
            Self::Sinks => "sinks",
            Self::Falls | Self::Moment(EventKind::Fallen) => "falls",
            Self::Stays | Self::Swings => "neither rises nor sinks",
            Self::Sleeps => "sleeps",
            Self::Passes => "comes near upright",
            Self::Sticks | Self::Moment(EventKind::Stick) => "sticks",
            Self::Moment(EventKind::SlipStops) => "stops slipping",
            Self::Moment(EventKind::SlipResumes) => "slips again",
            Self::Moment(EventKind::Rest) => "rests",
            Self::Moment(EventKind::WeakTop) => "weakens",
            Self::Moment(_) => return None,
        })
    }
}

impl Stage {
    /// When its verb is said, among the others: a fall ends what weakens in it.
    fn said_at(&self) -> f64 {
        if self.kind == Kind::Falls {
            self.to
        } else {
            self.from
        }
    }
}

/// The stages of a run and the moments that matter, in the order in which their verbs are said. `floor` is the least change of θ that counts,
/// rad; `is_lossless` tells that nothing brakes a peg that rolls.
pub(super) fn stages(
    path: &[Point],
    events: &[Event],
    floor: f64,
    is_lossless: bool,
) -> Vec<Stage> {
    let mut stages = Vec::new();
    let mut pace = 0.0;
    let all = range(path);
    for part in path.chunk_by(|a, b| regime(a) == regime(b)) {
        match regime(&part[0]) {
            Regime::Stuck => stages.push(whole(Kind::Sticks, part)),
            Regime::Upright => {
                let stage = whole(Kind::Sleeps, part);
                let is_asleep = (stage.to - stage.from) * pace >= ASLEEP * 2.0 * UPRIGHT;
                // What starts upright came from nowhere.
                let starts_asleep = stages.is_empty() && part.len() >= PACE;
                let kind = if is_asleep || starts_asleep {
                    Kind::Sleeps
                } else {
                    Kind::Passes
                };
                stages.push(Stage { kind, ..stage });
            }
            // Three integrals let θ only swing while the peg rolls without losses: what its means differ by is no motion.
            Regime::Rolling if is_lossless && part.iter().any(|point| point.is_mean) => {
                stages.push(swings(part));
            }
            Regime::Rolling if range(part) <= NOTABLE * all => {
                stages.push(whole(Kind::Stays, part));
            }
            Regime::Inclined | Regime::Rolling => {
                legs(part, floor, &mut stages);
                let (first, last) = (
                    &part[part.len().saturating_sub(PACE)],
                    &part[part.len() - 1],
                );
                pace =
                    (last.theta - first.theta).abs() / (last.time - first.time).max(f64::EPSILON);
            }
        }
    }
    let moments = [
        EventKind::Risen,
        EventKind::Fallen,
        EventKind::WeakTop,
        EventKind::SlipStops,
        EventKind::Stick,
        EventKind::SlipResumes,
        EventKind::Rest,
    ];
    for event in events {
        let kind = EventKind::find(&event.name).filter(|kind| moments.contains(kind));
        let Some(kind) = kind else { continue };
        // A fall is a stage that ends with its event.
        if kind == EventKind::Fallen
            && let Some(last) = legs_before(&mut stages, event.time)
            && last.kind == Kind::Sinks
        {
            last.kind = Kind::Falls;
            last.to = event.time;
            last.thetas[1] = event.theta;
        } else if !stages.iter().any(|stage| stage.kind == Kind::Moment(kind)) {
            stages.push(Stage {
                kind: Kind::Moment(kind),
                from: event.time,
                to: event.time,
                thetas: [event.theta; 2],
                least: (event.theta, event.time),
                range: 0.0,
                is_mean: false,
            });
        }
    }
    stages.sort_by(|a, b| a.said_at().total_cmp(&b.said_at()));
    stages
}

/// The last stage that began before `time` and is none of a moment.
fn legs_before(stages: &mut [Stage], time: f64) -> Option<&mut Stage> {
    let mut before = stages.iter_mut().rev();
    before.find(|stage| stage.from < time && !matches!(stage.kind, Kind::Moment(_)))
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Regime {
    Inclined,
    Rolling,
    Upright,
    Stuck,
}

fn regime(point: &Point) -> Regime {
    if point.sticks {
        Regime::Stuck
    } else if point.rolls {
        Regime::Rolling
    } else if point.theta < UPRIGHT {
        Regime::Upright
    } else {
        Regime::Inclined
    }
}

/// Greatest inclination less the least, rad.
fn range(path: &[Point]) -> f64 {
    let thetas = || path.iter().map(|point| point.theta);
    thetas().fold(f64::NEG_INFINITY, f64::max) - thetas().fold(f64::INFINITY, f64::min)
}

/// A part of the path as one stage.
fn whole(kind: Kind, part: &[Point]) -> Stage {
    let least = part.iter().min_by(|a, b| a.theta.total_cmp(&b.theta));
    let (first, last) = (part[0], part[part.len() - 1]);
    let least = least.unwrap_or(&first);
    Stage {
        kind,
        from: first.time,
        to: last.time,
        thetas: [first.theta, last.theta],
        least: (least.theta, least.time),
        range: range(part),
        is_mean: part.iter().all(|point| point.is_mean),
    }
}

/// A part of the path in which θ swings: the middle of its means is told, for one that rolling broke off differs.
fn swings(part: &[Point]) -> Stage {
    let means = part.iter().filter(|point| point.is_mean);
    let mut means: Vec<f64> = means.map(|point| point.theta).collect();
    means.sort_by(f64::total_cmp);
    Stage {
        thetas: [means[means.len() / 2]; 2],
        is_mean: true,
        ..whole(Kind::Swings, part)
    }
}

/// Divides a part of the path where θ turns.
fn legs(part: &[Point], floor: f64, stages: &mut Vec<Stage>) {
    let floor = floor.max(NOTABLE * range(part));
    let (mut start, mut turn) = (0, 0);
    let mut is_rising = None;
    for (index, point) in part.iter().enumerate() {
        let change = point.theta - part[turn].theta;
        match is_rising {
            None if change.abs() > floor => {
                is_rising = Some(change < 0.0);
                turn = index;
            }
            Some(rising) if (change < 0.0) == rising => turn = index,
            Some(rising) if change.abs() > floor => {
                stages.push(leg(rising, &part[start..=turn]));
                (start, turn) = (turn, index);
                is_rising = Some(!rising);
            }
            None | Some(_) => {}
        }
    }
    stages.push(match is_rising {
        Some(rising) => leg(rising, &part[start..]),
        None => whole(Kind::Stays, part),
    });
}

fn leg(is_rising: bool, part: &[Point]) -> Stage {
    whole(if is_rising { Kind::Rises } else { Kind::Sinks }, part)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn path(thetas: &[f64]) -> Vec<Point> {
        let points = thetas.iter().enumerate();
        points
            .map(|(index, theta)| Point {
                time: index as f64,
                theta: *theta,
                is_mean: true,
                sticks: false,
                rolls: false,
            })
            .collect()
    }

    fn kinds(thetas: &[f64], floor: f64) -> Vec<Kind> {
        let stages = stages(&path(thetas), &[], floor, true);
        stages.iter().map(|stage| stage.kind).collect()
    }

    #[test]
    fn stages_follow_the_turns_of_the_averaged_motion() {
        assert_eq!(kinds(&[0.5, 0.4, 0.3], 1e-6), [Kind::Rises]);
        assert_eq!(kinds(&[0.5, 0.4, 0.4001, 0.3], 1e-6), [Kind::Rises]);
        assert_eq!(kinds(&[0.5, 0.3, 0.6], 1e-6), [Kind::Rises, Kind::Sinks]);
        assert_eq!(kinds(&[0.5, 0.5 + 1e-9, 0.5], 1e-6), [Kind::Stays]);
        assert_eq!(
            kinds(&[0.5, 0.1, 0.005, 0.2, 0.9], 1e-6),
            [Kind::Rises, Kind::Passes, Kind::Sinks]
        );
        let mut life = vec![0.5, 0.49];
        life.extend([0.001; 12]);
        life.extend([0.1, 0.9]);
        assert_eq!(kinds(&life, 1e-6), [Kind::Rises, Kind::Sleeps, Kind::Sinks]);
    }

    #[test]
    fn tops_that_roll_without_losses_only_swing() {
        let mut path = path(&[0.31, 0.25, 0.250_000_1, 0.249_999_9, 0.25]);
        for point in &mut path {
            point.rolls = true;
        }
        let [stage] = stages(&path, &[], 1e-12, true)[..] else {
            panic!("one stage");
        };
        assert_eq!((stage.kind, stage.thetas), (Kind::Swings, [0.25; 2]));
        assert_ne!(stages(&path, &[], 1e-12, false)[0].kind, Kind::Swings);
        // A fall in rolling has no means.
        for point in &mut path {
            point.is_mean = false;
        }
        assert_eq!(stages(&path, &[], 1e-12, true)[0].kind, Kind::Rises);
    }
}
