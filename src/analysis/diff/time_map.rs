//! Which time of B is compared with a time of A.
//!
//! Two nearly equal models part in the phase of their nutation, after which a difference at equal times says
//! nothing about the models. Therefore B can be compared where its nutation has the same phase as A's, or where
//! its θ has the same mean over a nutation. Either is a curve over time for each run, known from the nutation
//! cycles (`/top/nutation`): A's time leads by A's curve to a phase or mean, and from there by B's inverse curve to
//! B's time.

use super::error::DiffError;
use super::nutation::end_with_nutation;
use super::options::Align;
use crate::analysis::course::curve::Curve;
use crate::analysis::course::{Course, Cycle};
use crate::analysis::subject::Subject;
use crate::telemetry::Topics;
use crate::telemetry::fields::NUTATION;
use std::ops::ControlFlow;

/// With fewer nutation cycles there is no cubic through them, and no curve to follow.
const FEWEST_CYCLES: usize = 4;

/// A time, finer than whole nanoseconds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Instant {
    /// Whole nanoseconds.
    pub(super) ns: u64,
    /// The part of a nanosecond beyond, from 0 to 1.
    pub(super) rest: f64,
}

impl From<u64> for Instant {
    fn from(ns: u64) -> Self {
        Self { ns, rest: 0.0 }
    }
}

/// The way from A's time to B's.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum TimeMap {
    /// Equal times.
    Same,
    /// From A's time (s) to the phase or mean, and from there to B's time (s).
    Through(Curve, Curve),
}

impl TimeMap {
    /// Reads the nutation cycles of both runs, if the alignment needs them.
    pub(super) fn new([a, b]: [Subject<'_>; 2], align: Align) -> Result<Self, DiffError> {
        let (curve, what): (fn(&Course) -> Curve, _) = match align {
            Align::Time | Align::Index => return Ok(Self::Same),
            Align::Nutation => (Course::phase, "nutations"),
            Align::Theta => (
                |course| course.of_cycles(|cycle| cycle.means[0]),
                "averages of θ",
            ),
        };
        let impossible = |reason: String| DiffError::Align {
            by: align.name(),
            reason,
        };
        let [a, b] = [a, b].map(cycles);
        for (course, name) in [(&a, "A"), (&b, "B")] {
            let found = course.cycles.len();
            if found < FEWEST_CYCLES {
                return Err(impossible(format!(
                    "{name} has {found} nutation cycles ({NUTATION}), at least {FEWEST_CYCLES} are needed"
                )));
            }
        }
        let (from, of_b) = (curve(&a), curve(&b));
        if from == of_b {
            return Ok(Self::Same);
        }
        let to = of_b.inverse();
        let has_target = |cycle: &Cycle| {
            from.at(cycle.middle())
                .is_some_and(|level| to.at(level).is_some())
        };
        if a.cycles.iter().any(has_target) {
            Ok(Self::Through(from, to))
        } else {
            Err(impossible(format!("the two have no {what} in common")))
        }
    }

    /// B's time for one of A's (ns); none where B has none.
    pub(super) fn target(&self, time_ns: u64) -> Option<Instant> {
        let Self::Through(phase, time) = self else {
            return Some(Instant::from(time_ns));
        };
        let seconds = time.at(phase.at(time_ns as f64 / 1e9)?)?;
        let nanoseconds = seconds * 1e9;
        (nanoseconds >= 0.0).then(|| Instant {
            ns: nanoseconds as u64,
            rest: nanoseconds - nanoseconds.floor(),
        })
    }
}

/// The nutation cycles of a run, and nothing else.
fn cycles(run: Subject<'_>) -> Course {
    let mut course = Course::default();
    run.read(&Topics::Only(vec![NUTATION]), &mut |message, _| {
        course.take(message);
        ControlFlow::Continue(())
    });
    if !run.is_of_free_peg() {
        end_with_nutation(&mut course.cycles);
    }
    course
}
