//! The messages of one topic of two runs, on their way to being paired.
//!
//! A message waits in its [`Lane`] until it is certain which message of the other run it belongs to, or that there
//! is none. That depends on how far the other run has been read, its [`Frontier`]: a message is alone only once the
//! other run has been read beyond its time.
//!
//! Within a topic the reader gives messages in the order of time. Messages of toprise's recordings that go back behind
//! those of other topics are out of order and not paired: there is a digest of them on each side, and if these agree,
//! the messages are the same. So a run is equal to itself whatever its times are.

use super::interpolation::{Method, Stencil};
use super::rule::{Interpolation, Rule};
use super::time_map::{Instant, TimeMap};
use crate::archive::memory::Owned;
use crate::telemetry::digest::append_content;
use crate::telemetry::side::Side;
use sha2::{Digest as _, Sha256};
use std::collections::{BTreeMap, VecDeque};

/// The error of interpolation is estimated at one of so many messages.
const ESTIMATED: u64 = 8;

/// Two rows of numbers that belong together.
#[derive(Clone, Copy, Debug)]
pub(super) struct Pair<'a> {
    /// A's time, ns; the common one unless times are mapped.
    pub(super) time_ns: u64,
    pub(super) sequence: u32,
    pub(super) a: &'a [f64],
    pub(super) b: &'a [f64],
    /// A's and B's texts; none where one is interpolated.
    pub(super) texts: Option<(&'a [String], &'a [String])>,
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

    /// Whether nothing before this time can come any more: messages up to it have their place in the order of time.
    fn has_reached(&self, time_ns: u64) -> bool {
        self.is_ended || self.time_ns >= time_ns
    }
}

/// Messages without a counterpart.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lonely {
    /// Their number.
    pub(super) count: u64,
    /// How many came before the first pair.
    before: u64,
    /// How many have come since the last pair.
    since: u64,
}

impl Lonely {
    /// How many are beyond the messages of the other run: before the first pair or behind the last.
    pub(super) fn beyond(&self, has_pairs: bool) -> u64 {
        if has_pairs {
            self.before + self.since
        } else {
            self.count
        }
    }
}

/// Messages whose times go backward.
#[derive(Clone, Debug, Default)]
struct OutOfOrder {
    count: u64,
    content: Sha256,
}

impl OutOfOrder {
    fn add(&mut self, message: &Owned) {
        let mut content = Vec::new();
        append_content(&message.as_message(), &mut content);
        self.content.update(&content);
        self.count += 1;
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
    /// Messages that others may have to be put before, by their times and the order in which they came.
    early: [BTreeMap<(u64, u64), Owned>; 2],
    /// Messages that wait for their counterparts, in the order of their times.
    waiting: [VecDeque<Owned>; 2],
    /// How much memory they take, bytes.
    held: usize,
    /// How many messages there have been.
    pub(super) counts: [u64; 2],
    pub(super) lonely: [Lonely; 2],
    out_of_order: [OutOfOrder; 2],
    left_out: LeftOut,
    /// The time of the last pair, ns.
    last_pair: Option<u64>,
    /// What the other run has at a time, when it is interpolated.
    values: Vec<f64>,
    /// How many messages of the interpolated run are no longer needed.
    dropped: u64,
}

impl Lane {
    pub(super) fn new(rule: Rule) -> Self {
        Self {
            rule,
            early: [BTreeMap::new(), BTreeMap::new()],
            waiting: [VecDeque::new(), VecDeque::new()],
            held: 0,
            counts: [0; 2],
            lonely: [Lonely::default(); 2],
            out_of_order: [OutOfOrder::default(), OutOfOrder::default()],
            left_out: LeftOut::default(),
            last_pair: None,
            values: Vec::new(),
            dropped: 0,
        }
    }

    /// Takes a message of a run that has been read up to a frontier, and tells how much memory it takes, bytes.
    pub(super) fn push(&mut self, side: Side, message: Owned, frontier: Frontier) -> usize {
        let side = side.index();
        self.counts[side] += 1;
        let memory = memory(&message);
        self.held += memory;
        if self.early[side].is_empty() && frontier.has_reached(message.time_ns) {
            self.waiting[side].push_back(message);
        } else {
            let place = (message.time_ns, self.counts[side]);
            self.early[side].insert(place, message);
        }
        memory
    }

    /// Takes a message whose time goes backward.
    pub(super) fn push_out_of_order(&mut self, side: Side, message: &Owned) {
        self.counts[side.index()] += 1;
        self.out_of_order[side.index()].add(message);
    }

    /// How many messages of both are out of order.
    pub(super) fn out_of_order(&self) -> u64 {
        self.out_of_order.iter().map(|some| some.count).sum()
    }

    /// Whether both have the same messages out of order.
    pub(super) fn has_same_out_of_order(&self) -> bool {
        let [a, b] = &self.out_of_order;
        let digest = |some: &OutOfOrder| some.content.clone().finalize();
        a.count == b.count && (a.count == 0 || digest(a) == digest(b))
    }

    /// How much memory the messages take that wait, bytes.
    pub(super) fn held(&self) -> usize {
        self.held
    }

    fn pop(&mut self, side: Side) -> Option<Owned> {
        let message = self.waiting[side.index()].pop_front()?;
        self.held -= memory(&message);
        Some(message)
    }

    /// Gives all pairs that are certain.
    pub(super) fn drain(
        &mut self,
        frontiers: [Frontier; 2],
        map: &TimeMap,
        give: &mut impl FnMut(Given<'_>),
    ) {
        for side in [0, 1] {
            while let Some(first) = self.early[side].first_entry()
                && frontiers[side].has_reached(first.key().0)
            {
                self.waiting[side].push_back(first.remove());
            }
        }
        match &self.rule {
            Rule::SameTime { .. } => self.drain_same_time(frontiers, give),
            Rule::SameSequence => self.drain_same_sequence(frontiers, give),
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

    fn drain_same_time(&mut self, frontiers: [Frontier; 2], give: &mut impl FnMut(Given<'_>)) {
        let finer = self.rule.finer().map(|finer| finer.side);
        loop {
            let [a, b] = &self.waiting;
            let is_past =
                |side: Side, message: &Owned| frontiers[side.index()].is_past(message.time_ns);
            let alone = match (a.front(), b.front()) {
                (Some(x), Some(y)) if x.time_ns == y.time_ns => {
                    self.pair_fronts(give);
                    continue;
                }
                (Some(x), Some(y)) if x.time_ns < y.time_ns && is_past(Side::B, x) => Side::A,
                (Some(x), Some(y)) if x.time_ns > y.time_ns && is_past(Side::A, y) => Side::B,
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
                self.note_lonely(alone);
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
            self.pop(alone);
            self.note_lonely(alone);
        }
    }

    fn pair_fronts(&mut self, give: &mut impl FnMut(Given<'_>)) {
        let (Some(a), Some(b)) = (self.pop(Side::A), self.pop(Side::B)) else {
            return;
        };
        self.settle(a.time_ns);
        give(Given::Pair(Pair {
            time_ns: a.time_ns,
            sequence: a.sequence,
            a: &a.numbers,
            b: &b.numbers,
            texts: Some((&a.texts, &b.texts)),
        }));
    }

    fn note_lonely(&mut self, side: Side) {
        let lonely = &mut self.lonely[side.index()];
        lonely.count += 1;
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
            lonely.count += left_out.count;
            if last.is_none() {
                lonely.before += left_out.count;
            }
        }
    }

    /// Both runs have ended: what was left out since the last pair was beyond the end of the coarser run.
    pub(super) fn finish(&mut self) {
        let left_out = std::mem::take(&mut self.left_out);
        let (Some(finer), Some((_, last))) = (self.rule.finer(), left_out.span) else {
            return;
        };
        let is_beyond = self
            .last_pair
            .is_none_or(|pair| last.saturating_sub(pair) > finer.gap);
        if is_beyond {
            let lonely = &mut self.lonely[finer.side.index()];
            lonely.count += left_out.count;
            lonely.since += left_out.count;
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
            self.pop(grid);
            self.note_lonely(grid);
            return Some(());
        };
        self.drop_before(other, at.ns, give);
        let rows = &self.waiting[others];
        let before = rows.iter().take(2).filter(|row| row.time_ns <= at.ns);
        let before = before.count();
        let last = before.checked_sub(1).map(|last| rows[last].time_ns);
        let is_there = at.rest == 0.0 && last == Some(at.ns);
        let has_enough = is_there || rows.len() > before + 1;
        let limit = at.ns.saturating_add(widest.saturating_mul(2));
        if !has_enough && !frontiers[others].is_past(limit) {
            return None;
        }
        let is_inside = before > 0 && rows.len() > before;
        let is_near = |row: &Owned| row.time_ns.abs_diff(at.ns) <= widest;
        let is_edge = !is_inside && rows.iter().take(2).any(is_near);
        let found = self.evaluate(other, at, widest);
        let row = self.pop(grid)?;
        if found.is_none() {
            // Less than one message beyond the other's end is not beyond it.
            if !is_edge {
                self.note_lonely(grid);
            }
            return Some(());
        }
        self.settle(time_ns);
        let (a, b) = match grid {
            Side::A => (row.numbers.as_slice(), self.values.as_slice()),
            Side::B => (self.values.as_slice(), row.numbers.as_slice()),
        };
        give(Given::Pair(Pair {
            time_ns,
            sequence: row.sequence,
            a,
            b,
            texts: None,
        }));
        Some(())
    }

    /// Lets go of what is not needed for a time: two messages before it are, and all behind it.
    fn drop_before(&mut self, side: Side, time_ns: u64, give: &mut impl FnMut(Given<'_>)) {
        let is_early = |row: &Owned| row.time_ns <= time_ns;
        while self.waiting[side.index()].get(2).is_some_and(is_early) {
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
        let before = rows.iter().take(2).rposition(|row| row.time_ns <= at.ns)?;
        let left = &rows[before];
        self.values.clear();
        if left.time_ns == at.ns && at.rest == 0.0 {
            self.values.extend_from_slice(&left.numbers);
            return Some(());
        }
        let right = rows.get(before + 1)?;
        let is_near = |from: &Owned, to: &Owned| to.time_ns - from.time_ns <= widest;
        if !is_near(left, right) {
            return None;
        }
        let outer_left = before.checked_sub(1).map(|i| &rows[i]);
        let outer_left = outer_left.filter(|outer| is_near(outer, left));
        let outer_right = rows.get(before + 2).filter(|outer| is_near(right, outer));
        let stencil = Stencil::new([left, right], outer_left, outer_right, at);
        let methods = methods(&self.rule);
        let value = |field| stencil.value(field, method(methods, field));
        self.values.extend((0..stencil.width()).map(value));
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
        let stencil = Stencil::new([left, right], Some(first), Some(last), at);
        let methods = methods(&self.rule);
        for (field, number) in middle.numbers.iter().enumerate().take(stencil.width()) {
            let method = method(methods, field);
            let error = (stencil.value(field, method) - number).abs() / method.exaggeration();
            give(Given::Estimate { field, error });
        }
    }
}

/// How much memory a message takes, bytes.
fn memory(message: &Owned) -> usize {
    let texts = message
        .texts
        .iter()
        .map(|text| size_of::<String>() + text.capacity());
    size_of::<Owned>() + size_of_val(message.numbers.as_slice()) + texts.sum::<usize>()
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

    fn message(time_ns: u64, number: f64) -> Owned {
        Owned {
            channel: 0,
            sequence: 0,
            time_ns,
            numbers: vec![number],
            texts: Vec::new(),
        }
    }

    fn up_to(time_ns: u64) -> Frontier {
        Frontier {
            time_ns,
            is_ended: false,
        }
    }

    #[test]
    fn messages_are_let_go_of_once_they_are_certain() {
        let mut lane = Lane::new(Rule::SameTime { finer: None });
        let mut pairs = Vec::new();
        let mut drain = |lane: &mut Lane, frontiers: [u64; 2]| {
            lane.drain(frontiers.map(up_to), &TimeMap::Same, &mut |given| {
                if let Given::Pair(pair) = given {
                    pairs.push((pair.time_ns, pair.a[0], pair.b[0]));
                }
            });
            pairs.clone()
        };
        // The frontiers lag behind: messages come in another order than their times.
        for (time, number) in [(3, 0.3), (1, 0.1), (2, 0.2), (2, 0.25)] {
            lane.push(Side::A, message(time, number), up_to(0));
            lane.push(Side::B, message(time, -number), up_to(0));
        }
        assert!(drain(&mut lane, [0, 3]).is_empty());
        let held = lane.held();
        assert_eq!(drain(&mut lane, [1, 3]).len(), 1);
        assert!(lane.held() < held);
        let all = drain(&mut lane, [4, 4]);
        assert_eq!(
            all,
            [
                (1, 0.1, -0.1),
                (2, 0.2, -0.2),
                (2, 0.25, -0.25),
                (3, 0.3, -0.3)
            ]
        );
        assert_eq!(lane.held(), 0);
        assert_eq!(lane.lonely.map(|alone| alone.count), [0, 0]);
    }

    #[test]
    fn messages_out_of_order_are_the_same_if_their_contents_are() {
        let mut lane = Lane::new(Rule::SameSequence);
        lane.push_out_of_order(Side::A, &message(1, 0.5));
        assert!(!lane.has_same_out_of_order());
        lane.push_out_of_order(Side::B, &message(1, 0.5));
        assert!(lane.has_same_out_of_order());
        lane.push_out_of_order(Side::A, &message(1, 0.5));
        lane.push_out_of_order(Side::B, &message(2, 0.5));
        assert!(!lane.has_same_out_of_order());
        assert_eq!((lane.out_of_order(), lane.counts), (4, [2, 2]));
    }
}
