//! A limit of what a fit may cost, so that data which no motion follows are told in bounded time.

use std::sync::atomic::{AtomicU64, Ordering};

/// Number of motions like that at the start after which no minimum is expected: fits of data that follow a motion take the
/// steps of 100 to 500, wherever they start.
pub(in crate::fit) const MAX_MOTIONS: u64 = 1000;

/// Number of motions like that at the start whose steps a single one may take.
pub(in crate::fit) const MAX_RATIO: u64 = 20;

/// The fewest steps that a motion counts as: a start that is much slower than the data must not end their fit.
const LEAST_STEPS: u64 = 2500;

/// The integrator steps that the simulations of a problem took, and how many they may take. Threads add to them in any
/// order, so they are asked for only where no other thread runs.
#[derive(Debug)]
pub(in crate::fit) struct StepLimit {
    taken: AtomicU64,
    most: u64,
    /// Steps of a motion near the start, and its duration, s; 0 without a limit.
    motion: u64,
    duration: f64,
}

impl StepLimit {
    /// No limit.
    pub(in crate::fit) fn none() -> Self {
        Self {
            taken: AtomicU64::new(0),
            most: u64::MAX,
            motion: LEAST_STEPS,
            duration: 0.0,
        }
    }

    /// Adds steps that a simulation took.
    pub(in crate::fit) fn add(&self, steps: u64) {
        self.taken.fetch_add(steps, Ordering::Relaxed);
    }

    /// Number of steps so far.
    pub(in crate::fit) fn taken(&self) -> u64 {
        self.taken.load(Ordering::Relaxed)
    }

    /// Allows so many motions with these steps in a duration, s, each.
    pub(in crate::fit) fn begin(&mut self, motions: u64, steps: u64, duration: f64) {
        self.motion = steps.max(LEAST_STEPS);
        self.duration = duration;
        self.most = self.after(motions);
    }

    /// The number of steps after so many further motions.
    pub(in crate::fit) fn after(&self, motions: u64) -> u64 {
        self.taken()
            .saturating_add(motions.saturating_mul(self.motion))
    }

    /// Number of steps that a single motion of this duration, s, may take.
    pub(in crate::fit) fn most_per_motion(&self, duration: f64) -> u64 {
        let part = duration / self.duration;
        // Without a limit, the part is infinite.
        (((MAX_RATIO * self.motion) as f64 * part) as u64).saturating_add(LEAST_STEPS)
    }

    /// Allows any number of motions.
    pub(in crate::fit) fn lift(&mut self) {
        self.most = u64::MAX;
        self.duration = 0.0;
    }

    pub(in crate::fit) fn is_exceeded(&self) -> bool {
        self.taken() > self.most
    }
}

/// A copy counts on for itself: fits of several laws don't share their limits.
impl Clone for StepLimit {
    fn clone(&self) -> Self {
        Self {
            taken: AtomicU64::new(self.taken()),
            ..*self
        }
    }
}
