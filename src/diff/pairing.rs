//! Which message of one run belongs to which of the other.

use super::timing::{Instant, TimeMap};
use crate::course::curve::{hermite3, hermite5, lagrange};
use crate::sink::Side;
use crate::sink::memory::Owned;
use std::collections::VecDeque;

/// How the messages of a topic are paired.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    /// Those with the same time. Messages of a finer run in between, on whose side that is, are passed over.
    SameTime { finer: Option<Side> },
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
    },
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
}

/// Messages without a counterpart.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Lonely {
    /// Their number.
    pub(super) count: u64,
    /// Times of the first and the last, ns.
    pub(super) span: Option<(u64, u64)>,
    /// How many came before the first pair.
    pub(super) before: u64,
    /// How many have come since the last pair.
    pub(super) since: u64,
}

/// The messages of one topic of both runs, on their way to being paired.
#[derive(Debug)]
pub(super) struct Lane {
    pub(super) rule: Rule,
    waiting: [VecDeque<Owned>; 2],
    last: [Option<u64>; 2],
    pub(super) lonely: [Lonely; 2],
    pub(super) out_of_order: u64,
    has_paired: bool,
    /// What the other run has at a time, when it is interpolated.
    values: Vec<f64>,
    dropped: u64,
}

impl Lane {
    pub(super) fn new(rule: Rule) -> Self {
        Self {
            rule,
            waiting: [VecDeque::new(), VecDeque::new()],
            last: [None, None],
            lonely: [Lonely::default(); 2],
            out_of_order: 0,
            has_paired: false,
            values: Vec::new(),
            dropped: 0,
        }
    }

    /// Takes a message of one run.
    pub(super) fn push(&mut self, side: Side, message: Owned) {
        let side = side.index();
        if self.last[side].is_some_and(|last| message.time_ns < last) {
            self.out_of_order += 1;
            return;
        }
        self.last[side] = Some(message.time_ns);
        self.waiting[side].push_back(message);
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
                self.drain_equal(frontiers, finer, |m| m.time_ns, Frontier::is_past, give);
            }
            Rule::SameSequence => {
                let is_past = |frontier: &Frontier, _| frontier.is_ended;
                self.drain_equal(frontiers, None, |m| u64::from(m.sequence), is_past, give);
            }
            Rule::Interpolated { grid, widest, .. } => {
                let (grid, widest) = (*grid, *widest);
                while self
                    .interpolate_next(grid, widest, frontiers, map, give)
                    .is_some()
                {}
            }
        }
    }

    fn drain_equal(
        &mut self,
        frontiers: [Frontier; 2],
        finer: Option<Side>,
        key: impl Fn(&Owned) -> u64,
        is_past: impl Fn(&Frontier, u64) -> bool,
        give: &mut impl FnMut(Given<'_>),
    ) {
        loop {
            let [a, b] = &self.waiting;
            let alone = match (a.front(), b.front()) {
                (Some(x), Some(y)) if key(x) == key(y) => {
                    self.has_paired = true;
                    give(Given::Pair(Pair {
                        time_ns: x.time_ns,
                        sequence: x.sequence,
                        a: &x.numbers,
                        b: &y.numbers,
                        texts: Some((&x.texts, &y.texts)),
                    }));
                    for side in 0..2 {
                        self.waiting[side].pop_front();
                        self.lonely[side].since = 0;
                    }
                    continue;
                }
                (Some(x), Some(y)) if key(x) < key(y) => Side::A,
                (Some(_), Some(_)) => Side::B,
                (Some(x), None) if is_past(&frontiers[1], key(x)) => Side::A,
                (None, Some(y)) if is_past(&frontiers[0], key(y)) => Side::B,
                _ => break,
            };
            let message = self.waiting[alone.index()].pop_front();
            if finer != Some(alone) {
                self.note_lonely(alone, message.map(|m| m.time_ns));
            }
        }
    }

    fn note_lonely(&mut self, side: Side, time_ns: Option<u64>) {
        let Some(time_ns) = time_ns else {
            return;
        };
        let lonely = &mut self.lonely[side.index()];
        lonely.count += 1;
        lonely.since += 1;
        if !self.has_paired {
            lonely.before += 1;
        }
        let first = lonely.span.map_or(time_ns, |(first, _)| first);
        lonely.span = Some((first, time_ns));
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
        let (mine, others) = (grid.index(), 1 - grid.index());
        let time_ns = self.waiting[mine].front()?.time_ns;
        let Some(at) = map.target(time_ns) else {
            self.waiting[mine].pop_front();
            self.note_lonely(grid, Some(time_ns));
            return Some(());
        };
        // Two messages before it and two behind it are needed; what is earlier is not.
        while self.waiting[others]
            .get(2)
            .is_some_and(|third| third.time_ns <= at.ns)
        {
            self.estimate(others, give);
            self.waiting[others].pop_front();
        }
        let rows = &self.waiting[others];
        let before = rows
            .iter()
            .take(2)
            .filter(|row| row.time_ns <= at.ns)
            .count();
        let last = before.checked_sub(1).map(|last| rows[last].time_ns);
        let is_there = at.rest == 0.0 && last == Some(at.ns);
        let is_certain = frontiers[others].is_past(at.ns.saturating_add(2 * widest));
        if !is_there && rows.len() < before + 2 && !is_certain {
            return None;
        }
        let found = self.evaluate(others, at, widest);
        let row = self.waiting[mine].pop_front()?;
        if found.is_none() {
            self.note_lonely(grid, Some(time_ns));
            return Some(());
        }
        self.has_paired = true;
        self.lonely[mine].since = 0;
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
