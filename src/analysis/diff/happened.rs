//! Section b of a report: what happened in one run and in the other.
//!
//! Events of a kind are matched one to one ([`match_times`]). The rise is told twice: when θ first was at the limit,
//! which depends on which dip of the nutation reaches it, and when the averaged θ passed a level that both reach.

use crate::analysis::course::{Course, Cycle, Event};
use crate::run::simulation::EventKind;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Matches whose shifts are smaller by this factor are better than matches in order.
const SMALLER: f64 = 0.25;

/// Section b: what happened.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct Happened {
    /// Kinds of events that both or one of them have.
    pub kinds: Vec<EventKindDifference>,
    /// Pairs of events, without nutation extremes.
    pub matched: Vec<EventPair>,
    /// Events that only A has, with nutation extremes.
    pub only_in_a: Vec<EventMoment>,
    /// Events that only B has, with nutation extremes.
    pub only_in_b: Vec<EventMoment>,
    /// The shift of the rise, s.
    pub rise_shift: Option<f64>,
    /// How much the nutation alone can have moved the rise, s: half the ripple over the drift.
    pub rise_shift_uncertainty: Option<f64>,
    /// The level of the averaged θ that both reach, rad.
    pub averaged_level: Option<f64>,
    /// When A's averaged θ reaches it, s.
    pub averaged_crossing_a: Option<f64>,
    /// When B's averaged θ reaches it, s.
    pub averaged_crossing_b: Option<f64>,
}

/// Events of one kind.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventKindDifference {
    /// The kind.
    pub name: String,
    /// How many A has.
    pub count_a: u64,
    /// How many B has.
    pub count_b: u64,
    /// How many of them were matched.
    pub matched: u64,
    /// Mean shift of the matched events, s.
    pub mean_shift: Option<f64>,
    /// Shift of largest magnitude, s.
    pub largest_shift: Option<f64>,
}

/// Two events that belong together.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventPair {
    /// The kind.
    pub name: String,
    /// Time in A, s.
    pub time_a: f64,
    /// Time in B, s.
    pub time_b: f64,
    /// θ of the event in A, rad.
    pub theta_a: f64,
    /// θ of the event in B, rad.
    pub theta_b: f64,
}

/// An event that only one run has.
#[derive(Clone, Debug, PartialEq, Serialize, JsonSchema)]
pub struct EventMoment {
    /// The kind.
    pub name: String,
    /// Time, s.
    pub time: f64,
    /// What happened, in a sentence.
    pub description: String,
}

/// Compares what happened; events only if both have recorded them.
pub(super) fn compare(a: &Course, b: &Course, both_have_events: bool) -> Happened {
    let mut happened = Happened::default();
    if both_have_events {
        for (name, [of_a, of_b]) in by_kind(a, b) {
            compare_kind(name, &of_a, &of_b, &mut happened);
        }
    }
    let time = |time: &f64, other: &f64| time.total_cmp(other);
    happened.matched.sort_by(|x, y| time(&x.time_a, &y.time_a));
    for alone in [&mut happened.only_in_a, &mut happened.only_in_b] {
        alone.sort_by(|x, y| time(&x.time, &y.time));
    }
    if let (Some(x), Some(y)) = (a.report().rise_time, b.report().rise_time) {
        happened.rise_shift = Some(y - x);
        happened.rise_shift_uncertainty = uncertainty(a).zip(uncertainty(b)).map(|(x, y)| x.max(y));
    }
    cross_averaged(a, b, &mut happened);
    happened
}

/// The events of A and of B by their kinds, in the order in which these first come.
fn by_kind<'c>(a: &'c Course, b: &'c Course) -> Vec<(&'c str, [Vec<&'c Event>; 2])> {
    let mut kinds: Vec<(&str, [Vec<&Event>; 2])> = Vec::new();
    let mut known = BTreeMap::new();
    for (side, course) in [a, b].into_iter().enumerate() {
        for event in &course.events {
            let name = event.name.as_str();
            let at = *known.entry(name).or_insert(kinds.len());
            if at == kinds.len() {
                kinds.push((name, Default::default()));
            }
            kinds[at].1[side].push(event);
        }
    }
    kinds
}

/// Compares the events of a kind.
fn compare_kind(name: &str, a: &[&Event], b: &[&Event], happened: &mut Happened) {
    let times = |events: &[&Event]| -> Vec<f64> { events.iter().map(|event| event.time).collect() };
    let matches = match_times(&times(a), &times(b));
    let shifts: Vec<f64> = matches
        .iter()
        .map(|(i, j)| b[*j].time - a[*i].time)
        .collect();
    let largest = shifts
        .iter()
        .copied()
        .max_by(|x, y| x.abs().total_cmp(&y.abs()));
    happened.kinds.push(EventKindDifference {
        name: name.to_owned(),
        count_a: a.len() as u64,
        count_b: b.len() as u64,
        matched: matches.len() as u64,
        mean_shift: largest.map(|_| shifts.iter().sum::<f64>() / shifts.len() as f64),
        largest_shift: largest,
    });
    // Those that come with each nutation are counted, not listed.
    if !EventKind::find(name).is_some_and(EventKind::is_of_nutation) {
        happened
            .matched
            .extend(matches.iter().map(|(i, j)| EventPair {
                name: name.to_owned(),
                time_a: a[*i].time,
                time_b: b[*j].time,
                theta_a: a[*i].theta,
                theta_b: b[*j].theta,
            }));
    }
    let alone = |events: &[&Event], matched: &dyn Fn(usize) -> bool| -> Vec<EventMoment> {
        let alone = events.iter().enumerate().filter(|(at, _)| !matched(*at));
        let moment = |(_, event): (usize, &&Event)| EventMoment {
            name: event.name.clone(),
            time: event.time,
            description: event.description.clone(),
        };
        alone.map(moment).collect()
    };
    // Both sides of the matches are in rising order.
    let in_a = |at: usize| matches.binary_search_by(|(i, _)| i.cmp(&at)).is_ok();
    let in_b = |at: usize| matches.binary_search_by(|(_, j)| j.cmp(&at)).is_ok();
    happened.only_in_a.extend(alone(a, &in_a));
    happened.only_in_b.extend(alone(b, &in_b));
}

/// Matches events of one kind in their order: positions in A and B.
///
/// Where there are as many in both, the first belongs to the first and so on, unless following the shift from
/// one to the next gives much smaller shifts. Where there are not, it is followed, beginning with none or with
/// that of the first two, whichever matches more.
pub(super) fn match_times(a: &[f64], b: &[f64]) -> Vec<(usize, usize)> {
    let (Some(first_a), Some(first_b)) = (a.first(), b.first()) else {
        return Vec::new();
    };
    let in_place = follow(a, b, 0.0);
    if a.len() == b.len() {
        let in_order: Vec<_> = (0..a.len()).map(|at| (at, at)).collect();
        let mean = |matches: &[(usize, usize)]| {
            let shifts = matches.iter().map(|(i, j)| (b[*j] - a[*i]).abs());
            shifts.sum::<f64>() / matches.len() as f64
        };
        let is_better = 2 * in_place.len() > a.len() && mean(&in_place) < SMALLER * mean(&in_order);
        return if is_better { in_place } else { in_order };
    }
    let from_first = follow(a, b, first_b - first_a);
    if from_first.len() > in_place.len() {
        from_first
    } else {
        in_place
    }
}

/// Matches events by following their shift: one that would need a shift other than the last one by more than
/// half the distance to its neighbours has no counterpart.
fn follow(a: &[f64], b: &[f64], mut shift: f64) -> Vec<(usize, usize)> {
    let mut matches = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let change = b[j] - a[i] - shift;
        let spacing = spacing(a, i).min(spacing(b, j));
        if change.abs() <= 0.5 * spacing {
            matches.push((i, j));
            shift = b[j] - a[i];
            i += 1;
            j += 1;
        } else if change > 0.0 {
            i += 1;
        } else {
            j += 1;
        }
    }
    matches
}

/// The distance of an event to the nearest of its neighbours; infinite if it has none.
fn spacing(times: &[f64], at: usize) -> f64 {
    let before = at.checked_sub(1).map(|other| times[at] - times[other]);
    let behind = times.get(at + 1).map(|next| next - times[at]);
    before
        .into_iter()
        .chain(behind)
        .fold(f64::INFINITY, f64::min)
}

/// How much earlier or later the nutation alone can make θ reach a level, s: half the ripple over the drift.
fn uncertainty(course: &Course) -> Option<f64> {
    let last = course.cycles.last()?;
    let [_, drift, ..] = last.means;
    let [least, greatest] = last.ranges[0];
    // Within a cycle the drift widens the range too.
    let ripple = (greatest - least - (drift * last.period).abs()).max(0.0);
    Some(0.5 * ripple / drift.abs()).filter(|time| time.is_finite())
}

/// When the averaged θ reaches the lowest level that both reach.
fn cross_averaged(a: &Course, b: &Course, happened: &mut Happened) {
    let mean = |cycle: &Cycle| cycle.means[0];
    let last = |course: &Course| course.cycles.last().map(mean);
    let first = |course: &Course| course.cycles.first().map(mean);
    let (Some(last_a), Some(last_b), Some(first_a), Some(first_b)) =
        (last(a), last(b), first(a), first(b))
    else {
        return;
    };
    let level = last_a.max(last_b);
    if level >= first_a.min(first_b) {
        return;
    }
    let reach = |course: &Course| course.of_cycles(mean).first_reaches(level);
    happened.averaged_level = Some(level);
    happened.averaged_crossing_a = reach(a);
    happened.averaged_crossing_b = reach(b);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn as_many_events_match_in_order() {
        let matches = match_times(&[1.0, 2.0, 3.0], &[1.6, 2.6, 3.6]);
        assert_eq!(matches, [(0, 0), (1, 1), (2, 2)]);
        assert_eq!(match_times(&[24.7], &[68.4]), [(0, 0)]);
        assert_eq!(match_times(&[], &[]), []);
    }

    #[test]
    fn a_missing_event_doesn_t_shift_the_others() {
        let a: Vec<f64> = (0..50).map(f64::from).collect();
        // The lag grows beyond the distance of two events.
        let lag = |t: f64| t + 0.04 * t;
        let b: Vec<f64> = a
            .iter()
            .map(|t| lag(*t))
            .filter(|t| (t - lag(30.0)).abs() > 0.1)
            .collect();
        let matches = match_times(&a, &b);
        assert_eq!(matches.len(), 49);
        assert!(
            matches
                .iter()
                .all(|(i, j)| (b[*j] - lag(a[*i])).abs() < 1e-12)
        );
        let mirrored = match_times(&b, &a);
        assert!(
            mirrored
                .iter()
                .zip(&matches)
                .all(|((j, i), m)| (*i, *j) == *m)
        );
    }

    #[test]
    fn one_missing_at_either_end_is_noticed_though_there_are_as_many() {
        let all: Vec<f64> = (0..40).map(f64::from).collect();
        let matches = match_times(&all[1..], &all[..39]);
        assert_eq!(matches.len(), 38);
        assert!(matches.iter().all(|(i, j)| i + 1 == *j));
    }

    #[test]
    fn events_at_the_end_of_the_longer_run_have_no_counterpart() {
        assert_eq!(match_times(&[1.0, 2.0, 3.0], &[1.1, 2.1]), [(0, 0), (1, 1)]);
        assert_eq!(match_times(&[], &[1.0]), []);
    }
}
