//! How the messages of a topic are paired, and how that is chosen.
//!
//! Messages that belong to the same instant are paired. Which those are depends on the topic:
//!
//! - Cycles and events are counted by their sequence numbers, and belong together by them: the fifth cycle of A
//!   and the fifth of B, whenever they were.
//! - Samples belong together by their times. If one run is sampled so many times finer than the other, its
//!   samples in between are passed over, and counted.
//! - If one run has more messages at other times, or times are mapped (`--align`), the times of one of them count (the
//!   grid), and the other is interpolated.
//! - Where it is asked for, messages belong together that are nearest to each other in time (`--max-dt`), or by the
//!   order in which they come (`--align index`).

use super::clock::Clock;
use super::interpolation::Method;
use super::options::Align;
use super::time_map::TimeMap;
use super::times::Times;
use crate::analysis::phrase::duration;
use crate::telemetry::side::Side;

/// A file with so many times more messages is finer; with fewer, the clocks jitter or one lacks some: a message that has
/// none to be interpolated between is told as missing.
const FINER: f64 = 1.5;
/// In files that toprise did not write, a distance of so many usual ones is a gap: jitter and single messages that are lost
/// make two or three.
const GAP: u64 = 5;

/// How the messages of a topic are paired.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Rule {
    /// Messages with the same time.
    SameTime {
        /// The run that has more messages in between, which are passed over.
        finer: Option<Finer>,
    },
    /// Messages with the same sequence number: the same cycle.
    SameSequence,
    /// Messages that come in the same place.
    SameIndex,
    /// Messages that are nearest to each other in time, and no farther apart than this, ns.
    Nearest(u64),
    /// Each message of one run with what the other has at its time.
    Interpolated(Interpolation),
}

/// A run with more messages than the other.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Finer {
    pub(super) side: Side,
    /// A longer time between two messages of the other run is a gap, ns.
    pub(super) gap: u64,
}

/// How one run is interpolated at the times of the other.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Interpolation {
    /// The run whose times count.
    pub(super) grid: Side,
    /// The method for each field; straight lines for fields that have none.
    pub(super) methods: Vec<Method>,
    /// Two messages that are farther apart than this are not interpolated between, ns.
    pub(super) widest: u64,
    /// A longer time between two messages of the grid is a gap, ns.
    pub(super) gap: u64,
}

impl Rule {
    /// The rule that was asked for, if one was.
    pub(super) fn asked(align: Align, max_dt: Option<u64>) -> Option<Self> {
        match align {
            Align::Index => Some(Self::SameIndex),
            Align::Time => max_dt.map(Self::Nearest),
            Align::Nutation | Align::Theta => None,
        }
    }

    /// The rule for samples of toprise, from the times between samples (ns) where they are known.
    pub(super) fn of_samples(map: &TimeMap, periods: [Option<u64>; 2]) -> Self {
        let [a, b] = periods;
        match (map, a, b) {
            (TimeMap::Through(..), ..) => Self::Interpolated(Interpolation {
                grid: Side::A,
                methods: Vec::new(),
                widest: b.map_or(u64::MAX, gap),
                // Times are stretched: nothing is known of B's messages in between.
                gap: u64::MAX,
            }),
            (TimeMap::Same, Some(x), Some(y)) if x != y => {
                let (fine, coarse) = (x.min(y), x.max(y));
                let side = if x < y { Side::A } else { Side::B };
                if coarse.is_multiple_of(fine) {
                    let gap = gap(coarse);
                    return Self::SameTime {
                        finer: Some(Finer { side, gap }),
                    };
                }
                Self::Interpolated(Interpolation {
                    grid: side.other(),
                    methods: Vec::new(),
                    widest: gap(fine),
                    gap: gap(coarse),
                })
            }
            _ => Self::SameTime { finer: None },
        }
    }

    /// The rule for a topic of two files, from the times of their messages and the clock of both.
    pub(super) fn of_times(a: &Times, b: &Times, clock: Clock) -> Self {
        let (a, b) = (&a.beginning(Side::A, clock), &b.beginning(Side::B, clock));
        let (Some(x), Some(y)) = (a.spacing(), b.spacing()) else {
            return Self::SameTime { finer: None };
        };
        let (coarser, finer, side) = if x >= y {
            (a, b, Side::B)
        } else {
            (b, a, Side::A)
        };
        let (long, short) = (x.max(y), x.min(y));
        let is_finer = long > short && long as f64 >= FINER * short as f64;
        if !is_finer || coarser.shared(finer) > 0.5 {
            return Self::SameTime { finer: None };
        }
        Self::Interpolated(Interpolation {
            grid: side.other(),
            methods: Vec::new(),
            widest: short.saturating_mul(GAP),
            gap: long.saturating_mul(GAP),
        })
    }

    /// What it pairs, in a few words, if it was asked for.
    pub(super) fn name(&self) -> String {
        match self {
            Self::SameIndex => "messages in the same place of their topics".to_owned(),
            Self::Nearest(most) => format!(
                "messages nearest to each other in time, no more than {} apart",
                duration(*most as f64 / 1e9)
            ),
            _ => "messages with equal times".to_owned(),
        }
    }

    /// The rule with methods of interpolation for each field, where it interpolates.
    pub(super) fn with_methods(mut self, methods: Vec<Method>) -> Self {
        if let Self::Interpolated(interpolation) = &mut self {
            interpolation.methods = methods;
        }
        self
    }

    /// Whether it interpolates.
    pub(super) fn is_interpolated(&self) -> bool {
        matches!(self, Self::Interpolated(_))
    }

    /// Whether messages that it gives each other are at the same time or in the same place of the run.
    pub(super) fn is_exact(&self) -> bool {
        matches!(self, Self::SameSequence | Self::SameTime { .. })
    }

    /// The run that has messages between those of the other.
    pub(super) fn finer(&self) -> Option<Finer> {
        match self {
            Self::SameTime { finer } => *finer,
            Self::SameSequence | Self::SameIndex | Self::Nearest(_) => None,
            Self::Interpolated(Interpolation { grid, gap, .. }) => Some(Finer {
                side: grid.other(),
                gap: *gap,
            }),
        }
    }
}

/// With this period, more than this between two messages is a gap, ns.
fn gap(period: u64) -> u64 {
    period.saturating_add(period / 2)
}
