//! Events of two runs, matched by what they are in the motion.
//!
//! What happens once or twice in a run, such as its fall, is matched in its order. Loops, passages through upright and
//! extremes of θ come again with each nutation: there an event of A is looked for in B where B's averaged motion is
//! where A's was ([`LevelPassage::counterpart`]), and what is farther from there than half the way to its neighbours is
//! another event.

use super::passage::LevelPassage;
use super::touch::SAME_LEVEL;
use crate::analysis::course::{Course, Event};
use crate::run::simulation::EventKind;
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeMap;

/// Matches whose shifts are smaller by this factor are better than matches in order. The nearest events are about a quarter
/// of a period apart whatever they are, so they are believed only where those in order are apart by more than a period.
const SMALLER: f64 = 0.25;
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

/// The events of A and of B by their kinds, in the order in which these first come.
fn by_kind<'c>(a: &'c Course, b: &'c Course) -> Vec<(&'c str, [Vec<&'c Event>; 2])> {
    let mut kinds: Vec<(&str, [Vec<&Event>; 2])> = Vec::new();
    let mut known = BTreeMap::new();
    for (side, course) in [a, b].into_iter().enumerate() {
        for event in without_cusps(&course.events) {
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

/// The events without loops that are none: at a cusp φ̇ comes to zero and no farther, but for rounding. A loop shorter
/// than `SHORTEST_LOOP` has a φ̇ of no more than some 1e-8 rad/s, which is the integrators' error.
fn without_cusps(events: &[Event]) -> impl Iterator<Item = &Event> {
    const SHORTEST_LOOP: f64 = 1e-6;
    let is = |event: &Event, kind: EventKind| event.name == kind.name();
    let is_cusp = move |begin: &Event, end: &Event| {
        is(begin, EventKind::LoopingBegins)
            && is(end, EventKind::LoopingEnds)
            && end.time - begin.time < SHORTEST_LOOP
    };
    let near = |at: usize| events[at.saturating_sub(2)..events.len().min(at + 3)].iter();
    let belongs_to_cusp = move |(at, event): &(usize, &Event)| {
        near(*at).any(|other| is_cusp(event, other) && other.time >= event.time)
            || near(*at).any(|other| is_cusp(other, event) && other.time <= event.time)
    };
    let events = events.iter().enumerate();
    events
        .filter(move |event| !belongs_to_cusp(event))
        .map(|(_, event)| event)
}

/// What two runs have in common and not, of their events.
#[derive(Clone, Debug, Default)]
pub(super) struct Events {
    pub(super) kinds: Vec<EventKindDifference>,
    pub(super) matched: Vec<EventPair>,
    pub(super) only_in_a: Vec<EventMoment>,
    pub(super) only_in_b: Vec<EventMoment>,
}

impl Events {
    /// Compares the events of two runs, along their averaged motions if these are known.
    pub(super) fn compare(a: &Course, b: &Course, passage: Option<&LevelPassage>) -> Self {
        let mut found = Self::default();
        for (name, [of_a, of_b]) in by_kind(a, b) {
            found.add_kind(name, &of_a, &of_b, passage);
        }
        let time = |time: &f64, other: &f64| time.total_cmp(other);
        found.matched.sort_by(|x, y| time(&x.time_a, &y.time_a));
        for alone in [&mut found.only_in_a, &mut found.only_in_b] {
            alone.sort_by(|x, y| time(&x.time, &y.time));
        }
        found
    }

    /// The largest shift of an event, s. Those of each nutation are left out: where one of hundreds has no counterpart,
    /// as near upright, the shift is to another nutation.
    pub(super) fn largest_shift(&self) -> f64 {
        let kinds = self.kinds.iter().filter(|kind| !is_of_nutation(&kind.name));
        let shifts = kinds.filter_map(|kind| kind.largest_shift);
        shifts.map(f64::abs).fold(0.0, f64::max)
    }

    fn add_kind(&mut self, name: &str, a: &[&Event], b: &[&Event], passage: Option<&LevelPassage>) {
        let matches = matches(name, a, b, passage);
        let shifts: Vec<f64> = matches
            .iter()
            .map(|(i, j)| b[*j].time - a[*i].time)
            .collect();
        let largest = shifts
            .iter()
            .copied()
            .max_by(|x, y| x.abs().total_cmp(&y.abs()));
        self.kinds.push(EventKindDifference {
            name: name.to_owned(),
            count_a: a.len() as u64,
            count_b: b.len() as u64,
            matched: matches.len() as u64,
            mean_shift: largest.map(|_| shifts.iter().sum::<f64>() / shifts.len() as f64),
            largest_shift: largest,
        });
        // Those that come with each nutation are counted, not listed.
        if !is_of_nutation(name) {
            let pair = |(i, j): &(usize, usize)| EventPair {
                name: name.to_owned(),
                time_a: a[*i].time,
                time_b: b[*j].time,
                theta_a: a[*i].theta,
                theta_b: b[*j].theta,
            };
            self.matched.extend(matches.iter().map(pair));
        }
        // Both sides of the matches are in rising order.
        let is_in_a = |at: usize| matches.binary_search_by(|(i, _)| i.cmp(&at)).is_ok();
        let is_in_b = |at: usize| matches.binary_search_by(|(_, j)| j.cmp(&at)).is_ok();
        self.only_in_a.extend(alone(a, is_in_a));
        self.only_in_b.extend(alone(b, is_in_b));
    }
}

fn alone(events: &[&Event], is_matched: impl Fn(usize) -> bool) -> Vec<EventMoment> {
    let alone = events.iter().enumerate().filter(|(at, _)| !is_matched(*at));
    let moment = |(_, event): (usize, &&Event)| EventMoment {
        name: event.name.clone(),
        time: event.time,
        description: event.description.clone(),
    };
    alone.map(moment).collect()
}

/// Matches the events of a kind: positions in A and B.
fn matches(
    name: &str,
    a: &[&Event],
    b: &[&Event],
    passage: Option<&LevelPassage>,
) -> Vec<(usize, usize)> {
    let kind = EventKind::find(name);
    let times = |events: &[&Event]| -> Vec<f64> { events.iter().map(|event| event.time).collect() };
    match (kind, passage) {
        (Some(EventKind::Risen | EventKind::Fallen), _) => {
            let is_pair = |(i, j): &(usize, usize)| (a[*i].theta - b[*j].theta).abs() <= SAME_LEVEL;
            in_order(a.len(), b.len()).filter(is_pair).collect()
        }
        (Some(kind), Some(passage)) if kind.comes_with_nutation() => {
            let (a, b) = (times(a), times(b));
            let along = match_along(passage, &a, &b);
            if a.len() != b.len() {
                return along;
            }
            // Where the averages hardly change, as near upright, they don't tell one nutation from the next.
            let in_order: Vec<_> = in_order(a.len(), b.len()).collect();
            let largest = |matches: &[(usize, usize)]| {
                let shifts = matches.iter().map(|(i, j)| (b[*j] - a[*i]).abs());
                shifts.fold(0.0, f64::max)
            };
            if largest(&in_order) < largest(&along) {
                in_order
            } else {
                along
            }
        }
        (Some(kind), None) if kind.comes_with_nutation() => match_times(&times(a), &times(b)),
        _ => in_order(a.len(), b.len()).collect(),
    }
}

/// The first with the first and so on.
fn in_order(a: usize, b: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..a.min(b)).map(|at| (at, at))
}

/// Matches events that come with the nutation where the averaged motions are the same; behind those, where the averages no
/// longer go the same way, each with the one that follows.
fn match_along(passage: &LevelPassage, a: &[f64], b: &[f64]) -> Vec<(usize, usize)> {
    let expected = a.iter().enumerate();
    let expected = expected.filter_map(|(i, time)| Some((i, passage.counterpart(*time)?)));
    let mut last = f64::NEG_INFINITY;
    // Where A's average turns back, its levels are those of another part of B's motion.
    let expected =
        expected.take_while(|(_, (time, _))| *time > std::mem::replace(&mut last, *time));
    let (places, expected): (Vec<usize>, Vec<(f64, f64)>) = expected.unzip();
    let widest = expected.first().map_or(0.0, |(_, period)| *period);
    let expected: Vec<f64> = expected.into_iter().map(|(time, _)| time).collect();
    let found = follow(&expected, b, 0.0, widest);
    let mut matches: Vec<_> = found.into_iter().map(|(i, j)| (places[i], j)).collect();
    if let Some((i, j)) = matches.last().copied() {
        let (from_a, from_b) = (i + 1, j + 1);
        let behind = follow(&a[from_a..], &b[from_b..], b[j] - a[i], f64::INFINITY);
        matches.extend(behind.into_iter().map(|(i, j)| (from_a + i, from_b + j)));
    }
    matches
}

/// Matches events of one kind by their times: positions in A and B.
///
/// Where there are as many in both, the first belongs to the first and so on, unless following the shift from
/// one to the next gives much smaller shifts. Where there are not, it is followed, beginning with none or with
/// that of the first two, whichever matches more.
fn match_times(a: &[f64], b: &[f64]) -> Vec<(usize, usize)> {
    let (Some(first_a), Some(first_b)) = (a.first(), b.first()) else {
        return Vec::new();
    };
    let in_place = follow(a, b, 0.0, f64::INFINITY);
    if a.len() == b.len() {
        let in_order: Vec<_> = (0..a.len()).map(|at| (at, at)).collect();
        let mean = |matches: &[(usize, usize)]| {
            let shifts = matches.iter().map(|(i, j)| (b[*j] - a[*i]).abs());
            shifts.sum::<f64>() / matches.len() as f64
        };
        let is_better = 2 * in_place.len() > a.len() && mean(&in_place) < SMALLER * mean(&in_order);
        return if is_better { in_place } else { in_order };
    }
    let from_first = follow(a, b, first_b - first_a, f64::INFINITY);
    if from_first.len() > in_place.len() {
        from_first
    } else {
        in_place
    }
}

/// Matches events by following their shift: one that would need a shift other than the last one by more than
/// half the distance to its neighbours, or half the `widest`, has no counterpart.
fn follow(a: &[f64], b: &[f64], mut shift: f64, widest: f64) -> Vec<(usize, usize)> {
    let mut matches = Vec::new();
    let (mut i, mut j) = (0, 0);
    while i < a.len() && j < b.len() {
        let change = b[j] - a[i] - shift;
        let spacing = spacing(a, i).min(spacing(b, j)).min(widest);
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

fn is_of_nutation(name: &str) -> bool {
    EventKind::find(name).is_some_and(EventKind::is_of_nutation)
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
    fn matches_in_order_give_way_to_shifts_of_less_than_a_quarter() {
        let a: Vec<f64> = (0..10).map(f64::from).collect();
        // Those in order are apart by 1 + `shift`, their neighbours by `shift`: a quarter of it for one of 1/3.
        for (shift, count) in [(0.32, 9), (0.35, 10)] {
            let b: Vec<f64> = a.iter().map(|t| t + 1.0 + shift).collect();
            let matches = match_times(&a, &b);
            assert_eq!(matches.len(), count, "{shift}");
            assert!(matches.iter().all(|(i, j)| i + count == j + 10));
        }
    }

    #[test]
    fn events_at_the_end_of_the_longer_run_have_no_counterpart() {
        assert_eq!(match_times(&[1.0, 2.0, 3.0], &[1.1, 2.1]), [(0, 0), (1, 1)]);
        assert_eq!(match_times(&[], &[1.0]), []);
    }
}
