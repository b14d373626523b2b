//! The messages of one topic of two runs, on their way to being paired.
//!
//! A message waits in its [`Lane`] until it is certain which message of the other run it belongs to, or that there
//! is none. That depends on how far the other run has been read, its [`Frontier`]: a message is alone only once the
//! other run has been read beyond its time.
//!
//! Messages that stand behind later ones of their topic, as only files of others have them, are paired in the order in
//! which they come. So a file is equal to itself whatever its times are.

use super::interpolation::{Method, Stencil};
use super::item::{Content, Item};
use super::rule::{Interpolation, Rule};
use super::time_map::{Instant, TimeMap};
use crate::telemetry::payload::Value;
use crate::telemetry::side::Side;
use std::collections::VecDeque;

/// The error of interpolation is estimated at one of so many messages.
const ESTIMATED: u64 = 8;
/// So many messages before an instant are kept for interpolation: three where there are none behind it.
const BEFORE: usize = 3;

/// Two rows of numbers that belong together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<'a> {
    /// A's time, ns; the common one unless times are mapped.
    pub(super) time_ns: u64,
    pub(super) sequence: u32,
    pub(super) a: &'a [f64],
    pub(super) b: &'a [f64],
    /// What is compared exactly.
    pub(super) contents: [Content<'a>; 2],
}

/// What comes out of a lane.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given<'a> {
    /// Two messages that belong together.
    Pair(Pair<'a>),
    /// The error of interpolating a field, as estimated at one of its messages.
    Estimate { field: usize, error: f64 },
}

/// How far a run has been read.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frontier {
    /// Nothing before this time can come any more, ns.
    pub(super) time_ns: u64,
    /// Whether nothing can come at all.
    pub(super) is_ended: bool,
}

impl Frontier {
    /// Whether nothing at this time or before can come any more.
    fn is_past(&self, time_ns: u64) -> bool {
        self.is_ended || self.time_ns > time_ns
    }
}

/// Messages without a counterpart.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lonely {
    /// Their number.
    pub(super) count: u64,
    /// The time of the first, ns.
    pub(super) first_ns: Option<u64>,
    /// How many came before the first pair.
    before: u64,
    /// How many have come since the last pair.
    since: u64,
}

impl Lonely {
    fn add(&mut self, count: u64, first_ns: u64) {
        self.count += count;
        let first = self.first_ns.map_or(first_ns, |first| first.min(first_ns));
        self.first_ns = Some(first);
    }

    /// How many come before the messages of the other run.
    pub(super) fn before(&self, has_pairs: bool) -> u64 {
        if has_pairs { self.before } else { 0 }
    }

    /// How many are beyond the messages of the other run: before the first pair or behind the last.
    pub(super) fn beyond(&self, has_pairs: bool) -> u64 {
        if has_pairs {
            self.before + self.since
        } else {
            self.count
        }
    }
}

/// Messages of the finer run that were left out since the last pair. Whether that was right, the next pair tells.
#[derive(Clone, Copy, Debug, Default)]
struct LeftOut {
    count: u64,
    /// Times of the first and the last, ns.
    span: Option<(u64, u64)>,
}

/// The messages of one topic of both runs that wait to be paired.
#[derive(Debug)]
pub(super) struct Lane {
    pub(super) rule: Rule,
    /// Messages that wait for their counterparts, in the order of their times.
    waiting: [VecDeque<Item>; 2],
    /// Messages that stand behind later ones, and wait for others that do.
    late: [VecDeque<Item>; 2],
    /// The times of the last messages in order, ns.
    reached: [u64; 2],
    /// How much memory they take, bytes.
    held: usize,
    /// How many messages there have been.
    pub(super) counts: [u64; 2],
    pub(super) lonely: [Lonely; 2],
    left_out: LeftOut,
    /// The time of the last pair, ns.
    last_pair: Option<u64>,
    /// Messages between those of the other run, which were compared with none as they are.
    pub(super) between: [u64; 2],
    /// What the other run has at a time, when it is interpolated.
    found: Item,
    /// Whether the fields at the places of A's and B's rows have ever had a fraction.
    is_real: [Vec<bool>; 2],
    /// How many messages of the interpolated run are no longer needed.
    dropped: u64,
}

impl Lane {
    pub(super) fn new(rule: Rule) -> Self {
        Self {
            rule,
            waiting: [VecDeque::new(), VecDeque::new()],
            late: [VecDeque::new(), VecDeque::new()],
            reached: [0; 2],
            held: 0,
            counts: [0; 2],
            lonely: [Lonely::default(); 2],
            left_out: LeftOut::default(),
            last_pair: None,
            between: [0; 2],
            found: Item::default(),
            is_real: [Vec::new(), Vec::new()],
            dropped: 0,
        }
    }

    /// Takes a message, and tells how much memory it takes, bytes.
    pub(super) fn push(&mut self, side: Side, message: Item) -> usize {
        let side = side.index();
        self.counts[side] += 1;
        let memory = message.memory();
        self.held += memory;
        if self.rule.is_interpolated() {
            self.note_fractions(side, &message.values);
        }
        if message.time_ns < self.reached[side] && self.rule != Rule::SameIndex {
            self.late[side].push_back(message);
        } else {
            self.reached[side] = message.time_ns;
            self.waiting[side].push_back(message);
        }
        memory
    }

    fn note_fractions(&mut self, side: usize, values: &[Value]) {
        let known = &mut self.is_real[side];
        known.resize(known.len().max(values.len()), false);
        for (known, value) in known.iter_mut().zip(values) {
            *known |= matches!(value, Value::Real(_));
        }
    }

    /// How much memory the messages take that wait, bytes.
    pub(super) fn held(&self) -> usize {
        self.held
    }

    fn pop(&mut self, side: Side) -> Option<Item> {
        let message = self.waiting[side.index()].pop_front()?;
        self.held -= message.memory();
        Some(message)
    }

    /// Gives all pairs that are certain.
    pub(super) fn drain(
        &mut self,
        frontiers: [Frontier; 2],
        map: &TimeMap,
        give: &mut impl FnMut(Given<'_>),
    ) {
        self.drain_late(frontiers, give);
        match &self.rule {
            Rule::SameTime { .. } => self.drain_same_time(frontiers, give),
            Rule::SameSequence => self.drain_same_sequence(frontiers, give),
            Rule::SameIndex => self.drain_same_index(frontiers, give),
            Rule::Nearest(most) => {
                let most = *most;
                while self.pair_nearest(most, frontiers, give).is_some() {}
            }
            Rule::Interpolated(Interpolation { grid, widest, .. }) => {
                let (grid, widest) = (*grid, *widest);
                while self
                    .interpolate_next(grid, widest, frontiers, map, give)
                    .is_some()
                {}
                self.forget(grid, frontiers, map);
            }
        }
    }

    /// Pairs messages that stand behind later ones in the order in which they come, if they are at the same time.
    fn drain_late(&mut self, frontiers: [Frontier; 2], give: &mut impl FnMut(Given<'_>)) {
        loop {
            let [a, b] = &mut self.late;
            let sides = match (a.front(), b.front()) {
                (Some(x), Some(y)) if x.time_ns == y.time_ns => [true, true],
                (Some(_), Some(_)) => [true, true],
                (Some(_), None) if frontiers[1].is_ended => [true, false],
                (None, Some(_)) if frontiers[0].is_ended => [false, true],
                _ => break,
            };
            let [x, y] = [(sides[0], a), (sides[1], b)]
                .map(|(is_taken, late)| is_taken.then(|| late.pop_front()).flatten());
            for item in [&x, &y].into_iter().flatten() {
                self.held -= item.memory();
            }
            match (x, y) {
                (Some(x), Some(y)) if x.time_ns == y.time_ns => give_pair(&x, &y, give),
                (x, y) => {
                    for (item, side) in [(x, Side::A), (y, Side::B)] {
                        if let Some(item) = item {
                            self.lonely[side.index()].add(1, item.time_ns);
                        }
                    }
                }
            }
        }
    }

    fn drain_same_time(&mut self, frontiers: [Frontier; 2], give: &mut impl FnMut(Given<'_>)) {
        let finer = self.rule.finer().map(|finer| finer.side);
        loop {
            let [a, b] = &self.waiting;
            let is_past =
                |side: Side, message: &Item| frontiers[side.index()].is_past(message.time_ns);
            let alone = match (a.front(), b.front()) {
                (Some(x), Some(y)) if x.time_ns == y.time_ns => {
                    self.pair_fronts(give);
                    continue;
                }
                // Within a topic nothing comes behind what is later.
                (Some(x), Some(y)) if x.time_ns < y.time_ns => Side::A,
                (Some(_), Some(_)) => Side::B,
                (Some(x), None) if is_past(Side::B, x) => Side::A,
                (None, Some(y)) if is_past(Side::A, y) => Side::B,
                _ => break,
            };
            let Some(message) = self.pop(alone) else {
                break;
            };
            if finer == Some(alone) {
                self.leave_out(message.time_ns);
            } else {
                self.note_lonely(alone, message.time_ns);
            }
        }
    }

    fn drain_same_sequence(&mut self, frontiers: [Frontier; 2], give: &mut impl FnMut(Given<'_>)) {
        loop {
            let [a, b] = &self.waiting;
            let alone = match (a.front(), b.front()) {
                (Some(x), Some(y)) if x.sequence == y.sequence => {
                    self.pair_fronts(give);
                    continue;
                }
                (Some(x), Some(y)) if x.sequence < y.sequence => Side::A,
                (Some(_), Some(_)) => Side::B,
                (Some(_), None) if frontiers[1].is_ended => Side::A,
                (None, Some(_)) if frontiers[0].is_ended => Side::B,
                _ => break,
            };
            self.leave_alone(alone);
        }
    }

    fn drain_same_index(&mut self, frontiers: [Frontier; 2], give: &mut impl FnMut(Given<'_>)) {
        loop {
            let [a, b] = &self.waiting;
            match (a.is_empty(), b.is_empty()) {
                (false, false) => self.pair_fronts(give),
                (false, true) if frontiers[1].is_ended => self.leave_alone(Side::A),
                (true, false) if frontiers[0].is_ended => self.leave_alone(Side::B),
                _ => break,
            }
        }
    }

    /// Pairs the next two messages that are nearest to each other, if that is certain.
    fn pair_nearest(
        &mut self,
        most: u64,
        frontiers: [Frontier; 2],
        give: &mut impl FnMut(Given<'_>),
    ) -> Option<()> {
        let [a, b] = &self.waiting;
        let time = |items: &VecDeque<Item>, at: usize| items.get(at).map(|item| item.time_ns);
        let (first, other) = match (time(a, 0), time(b, 0)) {
            (Some(x), Some(y)) if x <= y => (Side::A, Some(y)),
            (Some(x), Some(_)) => (Side::B, Some(x)),
            (Some(_), None) => (Side::A, None),
            (None, Some(_)) => (Side::B, None),
            (None, None) => return None,
        };
        let second = first.other();
        let (mine, theirs) = (&self.waiting[first.index()], &self.waiting[second.index()]);
        let time_ns = time(mine, 0)?;
        let reach = time_ns.saturating_add(most);
        let Some(other) = other.filter(|other| *other <= reach) else {
            // Nothing of the other run is near, or can still come.
            let is_certain = other.is_some() || frontiers[second.index()].is_past(reach);
            return is_certain.then(|| self.leave_alone(first));
        };
        // The next message of this run may be nearer to that one, unless another is nearer to the next.
        let Some(next) = time(mine, 1) else {
            if !frontiers[first.index()].is_past(other.saturating_add(most)) {
                return None;
            }
            self.pair_fronts(give);
            return Some(());
        };
        if next.abs_diff(other) >= other - time_ns {
            self.pair_fronts(give);
            return Some(());
        }
        let Some(after) = time(theirs, 1) else {
            if !frontiers[second.index()].is_past(next.saturating_add(most)) {
                return None;
            }
            self.leave_alone(first);
            return Some(());
        };
        if next.abs_diff(after) < next.abs_diff(other) {
            self.pair_fronts(give);
        } else {
            self.leave_alone(first);
        }
        Some(())
    }

    fn leave_alone(&mut self, side: Side) {
        if let Some(message) = self.pop(side) {
            self.note_lonely(side, message.time_ns);
        }
    }

    fn pair_fronts(&mut self, give: &mut impl FnMut(Given<'_>)) {
        let (Some(a), Some(b)) = (self.pop(Side::A), self.pop(Side::B)) else {
            return;
        };
        self.settle(a.time_ns);
        give_pair(&a, &b, give);
    }

    fn note_lonely(&mut self, side: Side, time_ns: u64) {
        let lonely = &mut self.lonely[side.index()];
        lonely.add(1, time_ns);
        lonely.since += 1;
        if self.last_pair.is_none() {
            lonely.before += 1;
        }
    }

    fn leave_out(&mut self, time_ns: u64) {
        self.left_out.count += 1;
        let first = self.left_out.span.map_or(time_ns, |(first, _)| first);
        self.left_out.span = Some((first, time_ns));
    }

    /// There is a pair: what was left out before it was in between, or in a gap of the coarser run.
    fn settle(&mut self, time_ns: u64) {
        let left_out = std::mem::take(&mut self.left_out);
        let last = self.last_pair.replace(time_ns);
        for lonely in &mut self.lonely {
            lonely.since = 0;
        }
        let (Some(finer), Some((first, _))) = (self.rule.finer(), left_out.span) else {
            return;
        };
        let is_gap = time_ns.saturating_sub(last.unwrap_or(first)) > finer.gap;
        if is_gap {
            let lonely = &mut self.lonely[finer.side.index()];
            lonely.add(left_out.count, first);
            if last.is_none() {
                lonely.before += left_out.count;
            }
        } else {
            self.between[finer.side.index()] += left_out.count;
        }
    }

    /// Both runs have ended: what was left out since the last pair was beyond the end of the coarser run.
    pub(super) fn finish(&mut self) {
        let left_out = std::mem::take(&mut self.left_out);
        let (Some(finer), Some((first, last))) = (self.rule.finer(), left_out.span) else {
            return;
        };
        let is_beyond = self
            .last_pair
            .is_none_or(|pair| last.saturating_sub(pair) > finer.gap);
        if is_beyond {
            let lonely = &mut self.lonely[finer.side.index()];
            lonely.add(left_out.count, first);
            lonely.since += left_out.count;
        } else {
            self.between[finer.side.index()] += left_out.count;
        }
    }

    /// Pairs the next message of the grid, if that is certain.
    fn interpolate_next(
        &mut self,
        grid: Side,
        widest: u64,
        frontiers: [Frontier; 2],
        map: &TimeMap,
        give: &mut impl FnMut(Given<'_>),
    ) -> Option<()> {
        let other = grid.other();
        let (mine, others) = (grid.index(), other.index());
        let time_ns = self.waiting[mine].front()?.time_ns;
        let Some(at) = map.target(time_ns) else {
            self.leave_alone(grid);
            return Some(());
        };
        self.drop_before(other, at.ns, give);
        let rows = &self.waiting[others];
        let before = rows.iter().take(BEFORE).filter(|row| row.time_ns <= at.ns);
        let before = before.count();
        let last = before.checked_sub(1).map(|last| rows[last].time_ns);
        let is_there = at.rest == 0.0 && last == Some(at.ns);
        // The first two messages have none before them: there two behind the instant's neighbours are needed.
        let behind = if before < 2 { 2 } else { 1 };
        let has_enough = is_there || rows.len() > before + behind;
        let limit = at.ns.saturating_add(widest.saturating_mul(2));
        if !has_enough && !frontiers[others].is_past(limit) {
            return None;
        }
        let is_inside = before > 0 && rows.len() > before;
        let is_near = |row: &Item| row.time_ns.abs_diff(at.ns) <= widest;
        let is_edge = !is_inside && rows.iter().take(BEFORE).any(is_near);
        let found = self.evaluate(other, at, widest);
        let row = self.pop(grid)?;
        if found.is_none() {
            // Less than one message beyond the other's end is not beyond it.
            if !is_edge {
                self.note_lonely(grid, time_ns);
            }
            return Some(());
        }
        self.settle(time_ns);
        let (a, b) = match grid {
            Side::A => (&row, &self.found),
            Side::B => (&self.found, &row),
        };
        give(Given::Pair(Pair {
            time_ns,
            sequence: row.sequence,
            a: &a.numbers,
            b: &b.numbers,
            contents: [a.content(), b.content()],
        }));
        Some(())
    }

    /// Lets go of what is not needed for a time: some messages before it are, and all behind it.
    fn drop_before(&mut self, side: Side, time_ns: u64, give: &mut impl FnMut(Given<'_>)) {
        let is_early = |row: &Item| row.time_ns <= time_ns;
        while self.waiting[side.index()].get(BEFORE).is_some_and(is_early) {
            self.estimate(side, give);
            if let Some(row) = self.pop(side) {
                self.leave_out(row.time_ns);
            }
        }
    }

    /// Lets go of what no message of the grid will ask for.
    fn forget(&mut self, grid: Side, frontiers: [Frontier; 2], map: &TimeMap) {
        if !self.waiting[grid.index()].is_empty() {
            return;
        }
        let frontier = frontiers[grid.index()];
        if frontier.is_ended {
            while let Some(row) = self.pop(grid.other()) {
                self.leave_out(row.time_ns);
            }
        } else if let Some(at) = map.target(frontier.time_ns) {
            self.drop_before(grid.other(), at.ns, &mut |_| {});
        }
    }

    /// Finds what a run has at a time: as it was recorded, or between two messages.
    fn evaluate(&mut self, side: Side, at: Instant, widest: u64) -> Option<()> {
        let rows = &self.waiting[side.index()];
        let before = rows
            .iter()
            .take(BEFORE)
            .rposition(|row| row.time_ns <= at.ns)?;
        let left = &rows[before];
        let found = &mut self.found;
        if left.time_ns == at.ns && at.rest == 0.0 {
            found.clone_from(left);
            return Some(());
        }
        let right = rows.get(before + 1)?;
        let is_near = |from: &Item, to: &Item| to.time_ns - from.time_ns <= widest;
        if !is_near(left, right) {
            return None;
        }
        let at_left = |steps: usize| rows.get(before.checked_sub(steps)?);
        let at_right = |steps: usize| rows.get(before + 1 + steps);
        let outer_left = at_left(1).filter(|outer| is_near(outer, left));
        let outer_right = at_right(1).filter(|outer| is_near(right, outer));
        // At the ends of the run, and beside gaps, both lie on one side.
        let others = match (outer_left, outer_right) {
            (Some(x), None) => [Some(x), at_left(2).filter(|outer| is_near(outer, x))],
            (None, Some(y)) => [Some(y), at_right(2).filter(|outer| is_near(y, outer))],
            both => both.into(),
        };
        let stencil = Stencil::new([left, right], others.into_iter().flatten(), at);
        let methods = methods(&self.rule);
        let value = |field| stencil.value(field, method(methods, field));
        found.numbers.clear();
        found.numbers.extend((0..stencil.width()).map(value));
        found.values.clone_from(&left.values);
        found.rest.clone_from(&left.rest);
        let is_real = &self.is_real[side.index()];
        for (at, value) in found.values.iter_mut().enumerate() {
            // What isn't continuous is what it was last.
            let is_continuous = |next: &Value| is_real[at] && value.is_number() && next.is_number();
            if right.values.get(at).is_some_and(is_continuous) {
                *value = Value::Real(found.numbers[at]);
            } else if let Some(number) = found.numbers.get_mut(at) {
                *number = value.number();
            }
        }
        Some(())
    }

    /// Estimates the errors of interpolation at some of the messages: as if they were not there.
    fn estimate(&mut self, side: Side, give: &mut impl FnMut(Given<'_>)) {
        self.dropped += 1;
        let rows = &self.waiting[side.index()];
        if !self.dropped.is_multiple_of(ESTIMATED) || rows.len() < 5 {
            return;
        }
        let [first, left, middle, right, last] = std::array::from_fn(|i| &rows[i]);
        let times = [first, left, middle, right, last].map(|row| row.time_ns);
        if !times.is_sorted_by(|x, y| x < y) {
            return;
        }
        let at = Instant::from(middle.time_ns);
        let stencil = Stencil::new([left, right], [first, last], at);
        let methods = methods(&self.rule);
        for (field, number) in middle.numbers.iter().enumerate().take(stencil.width()) {
            let method = method(methods, field);
            let error = (stencil.value(field, method) - number).abs() / method.exaggeration();
            give(Given::Estimate { field, error });
        }
    }
}

fn give_pair(a: &Item, b: &Item, give: &mut impl FnMut(Given<'_>)) {
    give(Given::Pair(Pair {
        time_ns: a.time_ns,
        sequence: a.sequence,
        a: &a.numbers,
        b: &b.numbers,
        contents: [a.content(), b.content()],
    }));
}

/// The methods by which fields are interpolated.
fn methods(rule: &Rule) -> &[Method] {
    match rule {
        Rule::Interpolated(interpolation) => &interpolation.methods,
        _ => &[],
    }
}

fn method(methods: &[Method], field: usize) -> Method {
    methods.get(field).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(time_ns: u64, number: f64) -> Item {
        Item {
            time_ns,
            numbers: vec![number],
            ..Item::default()
        }
    }

    fn up_to(time_ns: u64) -> Frontier {
        Frontier {
            time_ns,
            is_ended: false,
        }
    }

    /// The pairs that a lane gives: A's and B's numbers.
    fn pairs(lane: &mut Lane, frontiers: [Frontier; 2]) -> Vec<(f64, f64)> {
        let mut pairs = Vec::new();
        lane.drain(frontiers, &TimeMap::Same, &mut |given| {
            if let Given::Pair(pair) = given {
                pairs.push((pair.a[0], pair.b[0]));
            }
        });
        pairs
    }

    const ENDED: [Frontier; 2] = [Frontier {
        time_ns: 0,
        is_ended: true,
    }; 2];

    #[test]
    fn messages_are_let_go_of_once_they_are_certain() {
        let mut lane = Lane::new(Rule::SameTime { finer: None });
        for (time, number) in [(1, 0.1), (2, 0.2), (2, 0.25), (4, 0.4)] {
            lane.push(Side::A, message(time, number));
        }
        lane.push(Side::B, message(1, -0.1));
        assert_eq!(pairs(&mut lane, [4, 1].map(up_to)), [(0.1, -0.1)]);
        let held = lane.held();
        // Another topic of B has gone on.
        assert!(pairs(&mut lane, [4, 3].map(up_to)).is_empty());
        assert!(lane.held() < held);
        assert_eq!(lane.lonely.map(|alone| alone.count), [2, 0]);
        lane.push(Side::B, message(4, -0.4));
        assert_eq!(pairs(&mut lane, [4, 4].map(up_to)), [(0.4, -0.4)]);
        assert_eq!(lane.held(), 0);
    }

    #[test]
    fn messages_behind_later_ones_are_paired_in_their_order() {
        let mut lane = Lane::new(Rule::SameTime { finer: None });
        for side in [Side::A, Side::B] {
            for (time, number) in [(5, 0.5), (3, 0.3), (7, 0.7), (3, 0.35)] {
                lane.push(side, message(time, number));
            }
        }
        lane.push(Side::B, message(1, 0.1));
        let found = pairs(&mut lane, ENDED);
        assert_eq!(found, [(0.3, 0.3), (0.35, 0.35), (0.5, 0.5), (0.7, 0.7)]);
        assert_eq!(lane.lonely.map(|alone| alone.count), [0, 1]);
        assert_eq!(lane.held(), 0);
    }

    #[test]
    fn the_nearest_are_paired() {
        let nearest = |a: &[u64], b: &[u64]| {
            let mut lane = Lane::new(Rule::Nearest(10));
            for (side, times) in [(Side::A, a), (Side::B, b)] {
                for time in times {
                    lane.push(side, message(*time, *time as f64));
                }
            }
            let found = pairs(&mut lane, ENDED);
            (found, lane.lonely.map(|alone| alone.count))
        };
        let (found, alone) = nearest(&[100, 200, 300], &[97, 206, 311, 400]);
        assert_eq!(found, [(100.0, 97.0), (200.0, 206.0)]);
        assert_eq!(alone, [1, 2]);
        // The second of B is nearer; the first has no other.
        let (found, alone) = nearest(&[100], &[95, 101]);
        assert_eq!((found, alone), (vec![(100.0, 101.0)], [0, 1]));
        // Both of A have one of B within reach.
        let (found, alone) = nearest(&[100, 106], &[95, 104]);
        assert_eq!(found, [(100.0, 95.0), (106.0, 104.0)]);
        assert_eq!(alone, [0, 0]);
    }
}
