//! Nutation cycle by cycle: the averages that show the slow motion.

use crate::physics::dynamics::Motion;
use crate::physics::kinematics::Euler;

/// One nutation, from a maximum of θ̇ to the next.
///
/// θ itself has no extremes where the ripple is smaller than the drift; θ̇ always has.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutationCycle {
    /// Counts the cycles from 0.
    pub index: u32,
    /// When it began, s.
    pub start: f64,
    /// When it ended, s.
    pub end: f64,
    /// The end rounded to nanoseconds.
    pub time_ns: u64,
    /// Least θ, rad.
    pub theta_min: f64,
    /// Greatest θ, rad.
    pub theta_max: f64,
    /// Mean of θ over the cycle, rad.
    pub theta_mean: f64,
    /// Means of the Euler rates over the cycle, rad/s: exactly the differences of the angles over the
    /// period.
    pub mean_rates: Euler,
}

impl NutationCycle {
    /// Its duration, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.end - self.start
    }
}

/// Collects what a cycle needs while it lasts.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct NutationTracker {
    /// Cycles finished so far.
    pub(super) count: u32,
    open: Option<OpenCycle>,
}

#[derive(Clone, Copy, Debug)]
struct OpenCycle {
    start: f64,
    motion: Motion,
    theta_min: f64,
    theta_max: f64,
}

impl OpenCycle {
    fn new(time: f64, motion: Motion) -> Self {
        Self {
            start: time,
            motion,
            theta_min: motion.angles.theta,
            theta_max: motion.angles.theta,
        }
    }

    fn widen(&mut self, theta: f64) {
        if theta < self.theta_min {
            self.theta_min = theta;
        }
        if theta > self.theta_max {
            self.theta_max = theta;
        }
    }
}

impl NutationTracker {
    /// Forgets the open cycle: the motion has a break.
    pub(super) fn interrupt(&mut self) {
        self.open = None;
    }

    /// Notes an extreme of θ within the cycle.
    pub(super) fn extreme(&mut self, theta: f64) {
        if let Some(open) = &mut self.open {
            open.widen(theta);
        }
    }

    /// Notes a maximum of θ̇, which ends a cycle and begins the next.
    pub(super) fn boundary(
        &mut self,
        time: f64,
        time_ns: u64,
        motion: Motion,
    ) -> Option<NutationCycle> {
        let mut open = self.open.replace(OpenCycle::new(time, motion))?;
        open.widen(motion.angles.theta);
        let period = time - open.start;
        let mean = |of: fn(&Motion) -> f64| (of(&motion) - of(&open.motion)) / period;
        let cycle = NutationCycle {
            index: self.count,
            start: open.start,
            end: time,
            time_ns,
            theta_min: open.theta_min,
            theta_max: open.theta_max,
            theta_mean: mean(|m| m.integrals.theta),
            mean_rates: Euler {
                phi: mean(|m| m.angles.phi),
                theta: mean(|m| m.angles.theta),
                psi: mean(|m| m.angles.psi),
            },
        };
        self.count += 1;
        Some(cycle)
    }
}
