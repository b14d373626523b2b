//! Which message of one run belongs to which of the other.

use super::timing::{Instant, TimeMap};
use crate::analysis::course::curve::{hermite3, hermite5, lagrange};
use crate::archive::memory::Owned;
use crate::telemetry::side::Side;
use std::collections::VecDeque;

/// How the messages of a topic are paired.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    /// Those with the same time.
    SameTime {
        /// The run with more messages, those in between, which are passed over.
        finer: Option<Finer>,
    },
    /// Those with the same sequence number: the same cycle.
    SameSequence,
    /// Each of one run with what the other has at its time, by interpolation.
    Interpolated {
        /// The run whose times count.
        grid: Side,
        /// How each field is interpolated.
        methods: Vec<Method>,
        /// No interpolation over more than this, ns.
        widest: u64,
        /// More than this between two messages of the grid is a gap, ns.
        gap: u64,
    },
}

/// A run with more messages than the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Finer {
    pub(super) side: Side,
    /// More than this between two messages of the other is a gap, ns.
    pub(super) gap: u64,
}

/// How a field is interpolated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    /// On a straight line.
    Linear,
    /// On the cubic through four values.
    Cubic,
    /// By Hermite with the field that is its derivative.
    Slope(usize),
    /// By Hermite with its first and second derivatives.
    Curvature(usize, usize),
}

impl Method {
    /// The methods for fields with these names: derivatives are recognised by `_dot` and `_ddot`.
    pub(super) fn by_names(names: &[&str]) -> Vec<Self> {
        let find = |name: &str, ending: &str| {
            let wanted = format!("{name}{ending}");
            names.iter().position(|other| *other == wanted)
        };
        let method = |name: &&str| match (find(name, "_dot"), find(name, "_ddot")) {
            (Some(first), Some(second)) => Self::Curvature(first, second),
            _ => match name
                .strip_suffix("_dot")
                .and_then(|base| find(base, "_ddot"))
            {
                Some(first) => Self::Slope(first),
                None => Self::Cubic,
            },
        };
        names.iter().map(method).collect()
    }

    /// How much larger the error is when a message is left out and put back by its neighbours: two to the
    /// power of the order, or for a cubic the ratio of the products of distances (4 to 9/16).
    fn exaggeration(self) -> f64 {
        match self {
            Self::Linear => 4.0,
            Self::Cubic => 64.0 / 9.0,
            Self::Slope(_) => 16.0,
            Self::Curvature(..) => 64.0,
        }
    }
}

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

/// What a lane gives.
#[derive(Clone, Copy, Debug)]
pub(super) enum Given<'a> {
    Pair(Pair<'a>),
    /// The error of interpolating a field, as estimated at one of its messages.
    Estimate {
        field: usize,
        error: f64,
    },
}

/// How far a run has been read, ns.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Frontier {
    pub(super) time_ns: u64,
    pub(super) is_ended: bool,
}

impl Frontier {
    /// Whether nothing at this time or before can come any more.
    fn is_past(&self, time_ns: u64) -> bool {
        self.is_ended || self.time_ns > time_ns
    }

    /// Whether nothing before this time can come any more.
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
    pub(super) before: u64,
    /// How many have come since the last pair.
    pub(super) since: u64,
}

/// Messages that were passed over since the last pair: whether that is right, the next one tells.
#[derive(Clone, Copy, Debug, Default)]
struct Passed {
    count: u64,
    /// Times of the first and the last, ns.
    span: Option<(u64, u64)>,
}

/// The messages of one topic of both runs, on their way to being paired.
#[derive(Debug)]
pub(super) struct Lane {
    pub(super) rule: Rule,
    waiting: [VecDeque<Owned>; 2],
    /// The time of the last message that has left.
    left: [Option<u64>; 2],
    /// How many there have been.
    pub(super) counts: [u64; 2],
    pub(super) lonely: [Lonely; 2],
    pub(super) out_of_order: u64,
    passed: Passed,
    last_pair: Option<u64>,
    /// What the other run has at a time, when it is interpolated.
    values: Vec<f64>,
    dropped: u64,
}

impl Lane {
    pub(super) fn new(rule: Rule) -> Self {
        Self {
            rule,
            waiting: [VecDeque::new(), VecDeque::new()],
            left: [None, None],
            counts: [0; 2],
            lonely: [Lonely::default(); 2],
            out_of_order: 0,
            passed: Passed::default(),
            last_pair: None,
            values: Vec::new(),
            dropped: 0,
        }
    }

    /// Takes a message of one run.
    pub(super) fn push(&mut self, side: Side, message: Owned) {
        let side = side.index();
        self.counts[side] += 1;
        if self.left[side].is_some_and(|left| message.time_ns < left) {
            self.out_of_order += 1;
            return;
        }
        let waiting = &mut self.waiting[side];
        let place = match waiting.back() {
            Some(last) if last.time_ns > message.time_ns => {
                waiting.partition_point(|other| other.time_ns <= message.time_ns)
            }
            _ => waiting.len(),
        };
        waiting.insert(place, message);
    }

    fn pop(&mut self, side: usize) -> Option<Owned> {
        let message = self.waiting[side].pop_front()?;
        self.left[side] = Some(message.time_ns);
        Some(message)
    }

    /// Gives all pairs that are certain.
    pub(super) fn drain(
        &mut self,
        frontiers: [Frontier; 2],
        map: &TimeMap,
        give: &mut impl FnMut(Given<'_>),
    ) {
        match &self.rule {
            Rule::SameTime { finer } => {
                let finer = *finer;
                self.drain_same_time(frontiers, finer, give);
            }
            Rule::SameSequence => self.drain_same_sequence(frontiers, give),
            Rule::Interpolated { grid, widest, .. } => {
                let (grid, widest) = (*grid, *widest);
                while self
                    .interpolate_next(grid, widest, frontiers, map, give)
                    .is_some()
                {}
                self.forget(grid, frontiers, map);
            }
        }
    }

    fn drain_same_time(
        &mut self,
        frontiers: [Frontier; 2],
        finer: Option<Finer>,
        give: &mut impl FnMut(Given<'_>),
    ) {
        loop {
            let [a, b] = &self.waiting;
            let is_past = |side: usize, message: &Owned| frontiers[side].is_past(message.time_ns);
            let alone = match (a.front(), b.front()) {
                (Some(x), Some(y)) if x.time_ns == y.time_ns => {
                    if !frontiers
                        .iter()
                        .all(|frontier| frontier.has_reached(x.time_ns))
                    {
                        break;
                    }
                    self.pair_fronts(give);
                    continue;
                }
                (Some(x), Some(y)) if x.time_ns < y.time_ns && is_past(1, x) => Side::A,
                (Some(x), Some(y)) if x.time_ns > y.time_ns && is_past(0, y) => Side::B,
                (Some(x), None) if is_past(1, x) => Side::A,
                (None, Some(y)) if is_past(0, y) => Side::B,
                _ => break,
            };
            let Some(message) = self.pop(alone.index()) else {
                break;
            };
            if finer.is_some_and(|finer| finer.side == alone) {
                self.pass_over(message.time_ns);
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
            self.pop(alone.index());
            self.note_lonely(alone);
        }
    }

    fn pair_fronts(&mut self, give: &mut impl FnMut(Given<'_>)) {
        let (Some(a), Some(b)) = (self.pop(0), self.pop(1)) else {
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

    fn pass_over(&mut self, time_ns: u64) {
        self.passed.count += 1;
        let first = self.passed.span.map_or(time_ns, |(first, _)| first);
        self.passed.span = Some((first, time_ns));
    }

    /// The run that has messages between those of the other, and what is a gap in the other.
    fn finer(&self) -> Option<Finer> {
        match &self.rule {
            Rule::SameTime { finer } => *finer,
            Rule::SameSequence => None,
            Rule::Interpolated { grid, gap, .. } => Some(Finer {
                side: grid.other(),
                gap: *gap,
            }),
        }
    }

    /// There is a pair: what was passed over before it was in between, or in a gap of the coarser run.
    fn settle(&mut self, time_ns: u64) {
        let passed = std::mem::take(&mut self.passed);
        let last = self.last_pair.replace(time_ns);
        for lonely in &mut self.lonely {
            lonely.since = 0;
        }
        let (Some(finer), Some((first, _))) = (self.finer(), passed.span) else {
            return;
        };
        let is_gap = time_ns.saturating_sub(last.unwrap_or(first)) > finer.gap;
        if is_gap {
            let lonely = &mut self.lonely[finer.side.index()];
            lonely.count += passed.count;
            if last.is_none() {
                lonely.before += passed.count;
            }
        }
    }

    /// Both runs have ended: what was passed over since the last pair was beyond the end of the coarser run.
    pub(super) fn finish(&mut self) {
        let passed = std::mem::take(&mut self.passed);
        let (Some(finer), Some((_, last))) = (self.finer(), passed.span) else {
            return;
        };
        let is_beyond = self
            .last_pair
            .is_none_or(|pair| last.saturating_sub(pair) > finer.gap);
        if is_beyond {
            let lonely = &mut self.lonely[finer.side.index()];
            lonely.count += passed.count;
            lonely.since += passed.count;
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
        let (mine, others) = (grid.index(), grid.other().index());
        let time_ns = self.waiting[mine].front()?.time_ns;
        if !frontiers[mine].has_reached(time_ns) {
            return None;
        }
        let Some(at) = map.target(time_ns) else {
            self.pop(mine);
            self.note_lonely(grid);
            return Some(());
        };
        self.drop_before(others, at.ns, give);
        let rows = &self.waiting[others];
        let before = rows
            .iter()
            .take(2)
            .filter(|row| row.time_ns <= at.ns)
            .count();
        let last = before.checked_sub(1).map(|last| rows[last].time_ns);
        let is_there = at.rest == 0.0 && last == Some(at.ns);
        let behind = rows.get(before + 1).map(|row| row.time_ns);
        let has_enough = is_there || behind.is_some_and(|time| frontiers[others].has_reached(time));
        let limit = at.ns.saturating_add(widest.saturating_mul(2));
        if !has_enough && !frontiers[others].is_past(limit) {
            return None;
        }
        let found = self.evaluate(others, at, widest);
        let is_inside = before > 0 && self.waiting[others].len() > before;
        let is_near = |row: &Owned| row.time_ns.abs_diff(at.ns) <= widest;
        let is_edge = !is_inside && self.waiting[others].iter().take(2).any(is_near);
        let row = self.pop(mine)?;
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
    fn drop_before(&mut self, side: usize, time_ns: u64, give: &mut impl FnMut(Given<'_>)) {
        let is_early = |row: &Owned| row.time_ns <= time_ns;
        while self.waiting[side].get(2).is_some_and(is_early) {
            self.estimate(side, give);
            if let Some(row) = self.pop(side) {
                self.pass_over(row.time_ns);
            }
        }
    }

    /// Lets go of what no message of the grid will ask for.
    fn forget(&mut self, grid: Side, frontiers: [Frontier; 2], map: &TimeMap) {
        let (mine, others) = (grid.index(), grid.other().index());
        if !self.waiting[mine].is_empty() {
            return;
        }
        if frontiers[mine].is_ended {
            while let Some(row) = self.pop(others) {
                self.pass_over(row.time_ns);
            }
        } else if let Some(at) = map.target(frontiers[mine].time_ns) {
            self.drop_before(others, at.ns, &mut |_| {});
        }
    }

    /// What a run has at a time: as it was recorded, or between two messages.
    fn evaluate(&mut self, side: usize, at: Instant, widest: u64) -> Option<()> {
        let rows = &self.waiting[side];
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
        let stencil = Stencil::new(
            [outer_left, Some(left), Some(right), outer_right],
            [left, right],
            at,
        );
        let Rule::Interpolated { methods, .. } = &self.rule else {
            return None;
        };
        for field in 0..left.numbers.len().min(right.numbers.len()) {
            let method = methods.get(field).copied().unwrap_or(Method::Linear);
            self.values.push(stencil.value(field, method));
        }
        Some(())
    }

    /// Estimates the errors of interpolation at every eighth message: as if it were not there.
    fn estimate(&mut self, side: usize, give: &mut impl FnMut(Given<'_>)) {
        self.dropped += 1;
        let rows = &self.waiting[side];
        let Rule::Interpolated { methods, .. } = &self.rule else {
            return;
        };
        if !self.dropped.is_multiple_of(8) || rows.len() < 5 {
            return;
        }
        let [first, left, middle, right, last] = std::array::from_fn(|i| &rows[i]);
        let times = [first, left, middle, right, last].map(|row| row.time_ns);
        if !times.is_sorted_by(|x, y| x < y) {
            return;
        }
        let at = Instant {
            ns: middle.time_ns,
            rest: 0.0,
        };
        let stencil = Stencil::new(
            [Some(first), Some(left), Some(right), Some(last)],
            [left, right],
            at,
        );
        let rows = [first, left, middle, right, last];
        let width = rows
            .map(|row| row.numbers.len())
            .into_iter()
            .min()
            .unwrap_or(0);
        for field in 0..width {
            let method = methods.get(field).copied().unwrap_or(Method::Linear);
            let guess = stencil.value(field, method);
            let error = (guess - middle.numbers[field]).abs() / method.exaggeration();
            give(Given::Estimate { field, error });
        }
    }
}

/// The messages around a time, and how much each of them counts there.
struct Stencil<'a> {
    rows: Vec<&'a Owned>,
    /// Lagrange's.
    weights: Vec<f64>,
    /// The neighbours of the time, their distance in s, and the part of it that the time is on.
    inner: [&'a Owned; 2],
    h: f64,
    s: f64,
}

impl<'a> Stencil<'a> {
    fn new(rows: [Option<&'a Owned>; 4], inner: [&'a Owned; 2], at: Instant) -> Self {
        let rows: Vec<_> = rows.into_iter().flatten().collect();
        let [left, right] = inner;
        // Exact in integers first: times since 1970 in ns have more digits than doubles.
        let seconds =
            |row: &&Owned| (i128::from(row.time_ns) - i128::from(left.time_ns)) as f64 / 1e9;
        let h = seconds(&right);
        let t = ((at.ns - left.time_ns) as f64 + at.rest) / 1e9;
        let nodes: Vec<f64> = rows.iter().map(seconds).collect();
        Self {
            weights: lagrange(&nodes, t).collect(),
            rows,
            inner,
            h,
            s: t / h,
        }
    }

    fn value(&self, field: usize, method: Method) -> f64 {
        let [x, y] = self.inner.map(|row| row.numbers.as_slice());
        match method {
            Method::Linear => x[field] + self.s * (y[field] - x[field]),
            Method::Cubic => {
                let column = self.rows.iter().map(|row| row.numbers[field]);
                self.weights
                    .iter()
                    .zip(column)
                    .map(|(w, value)| w * value)
                    .sum()
            }
            Method::Slope(d) => hermite3([x[field], x[d]], [y[field], y[d]], self.h, self.s),
            Method::Curvature(d, c) => {
                let [x, y] = [x, y].map(|row| [row[field], row[d], row[c]]);
                hermite5(x, y, self.h, self.s)
            }
        }
    }
}
