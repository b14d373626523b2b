//! Nutation cycle by cycle: the averages that show the slow motion.

use crate::physics::dynamics::{Model, Motion};
use crate::physics::kinematics::Euler;

/// Largest ratio of a cycle's duration to that of a nutation without friction, or its inverse.
///
/// Friction changes the period within one cycle slightly: in the presets cycles take 0.94 to 1.05 times the
/// period. A fall takes 9 to 100 times as long, because its pace is that of the friction that undermines the spin.
/// Twice lies far from either.
const PERIOD_FACTOR: f64 = 2.0;

/// One nutation, from a maximum of θ̇ to the next.
///
/// Where an impact makes the rates jump, those before it belong to the cycle that lasts until then, and those after it to the
/// cycle that lasts from then on: to the same one within a cycle, to different ones where θ̈ jumps from positive to negative.
///
/// θ itself has no extremes where the ripple is smaller than the drift; θ̇ always has. Maxima of θ̇ that are not about a
/// period of nutation apart, as before and after a fall, make no cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutationCycle {
    /// Counts the cycles from 0.
    pub index: u32,
    /// Time of its beginning, s.
    pub start: f64,
    /// Time of its end, s.
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
    /// Least Euler rates, rad/s.
    pub least_rates: Euler,
    /// Greatest Euler rates, rad/s.
    pub greatest_rates: Euler,
    /// Mean of the frictional term of φ̈ over the cycle, rad/s².
    pub mean_phi_frictional: f64,
}

impl NutationCycle {
    /// Its duration, s.
    #[must_use]
    pub fn period(&self) -> f64 {
        self.end - self.start
    }
}

/// Collects what a cycle needs while it lasts.
#[derive(Clone, Copy, Debug)]
pub(super) struct NutationTracker {
    model: Model,
    /// Cycles finished so far.
    count: u32,
    /// Since the last maximum of θ̇, or since the motion began, which is no beginning of a cycle.
    open: OpenCycle,
    has_begun: bool,
    /// Time at which an impact made the motion jump, s, and the rates after it, until it is known whether a cycle ends there.
    jump: Option<(f64, Euler)>,
}

#[derive(Clone, Copy, Debug)]
struct OpenCycle {
    start: f64,
    motion: Motion,
    theta_min: f64,
    theta_max: f64,
    least_rates: Euler,
    greatest_rates: Euler,
}

impl OpenCycle {
    fn new(time: f64, motion: &Motion) -> Self {
        Self {
            start: time,
            motion: *motion,
            theta_min: motion.angles.theta,
            theta_max: motion.angles.theta,
            least_rates: motion.tilt.rates,
            greatest_rates: motion.tilt.rates,
        }
    }

    fn widen_rates(&mut self, rates: &Euler) {
        let (least, greatest) = (&mut self.least_rates, &mut self.greatest_rates);
        widen(&mut least.phi, &mut greatest.phi, rates.phi);
        widen(&mut least.theta, &mut greatest.theta, rates.theta);
        widen(&mut least.psi, &mut greatest.psi, rates.psi);
    }

    /// Whether what ends at `time` can have been one nutation, from one maximum of θ̇ to the next.
    fn is_nutation(&self, model: &Model, time: f64) -> bool {
        let extremes = [self.theta_min, self.theta_max];
        let periods = model
            .nutation_period(&self.motion, extremes)
            .map(|period| (time - self.start) / period);
        periods.is_some_and(|periods| (1.0 / PERIOD_FACTOR..=PERIOD_FACTOR).contains(&periods))
    }
}

/// Widens a range so that it contains a value.
fn widen(least: &mut f64, greatest: &mut f64, value: f64) {
    if value < *least {
        *least = value;
    }
    if value > *greatest {
        *greatest = value;
    }
}

impl NutationTracker {
    pub(super) fn new(model: Model, time: f64, motion: Motion) -> Self {
        Self {
            model,
            count: 0,
            open: OpenCycle::new(time, &motion),
            has_begun: false,
            jump: None,
        }
    }

    /// Forgets the open cycle: the motion goes on from here after a break.
    pub(super) fn interrupt(&mut self, time: f64, motion: Motion) {
        self.open = OpenCycle::new(time, &motion);
        self.has_begun = false;
    }

    /// Notes an extreme of θ, and returns whether it is one of nutation: it is not if more time has gone by since the
    /// last maximum of θ̇ than a nutation takes.
    pub(super) fn extreme(&mut self, time: f64, motion: &Motion) -> bool {
        self.widen(time, motion);
        let extremes = [self.open.theta_min, self.open.theta_max];
        let period = self.model.nutation_period(&self.open.motion, extremes);
        period.is_none_or(|period| time - self.open.start <= PERIOD_FACTOR * period)
    }

    /// Notes rates that may be the least or greatest of the cycle. Those where the motion has just jumped may belong to the
    /// next one.
    pub(super) fn rates(&mut self, time: f64, motion: &Motion) {
        if self.jump.is_some_and(|(jump, _)| time <= jump) {
            return;
        }
        if let Some((_, after)) = self.jump.take() {
            self.open.widen_rates(&after);
        }
        self.open.widen_rates(&motion.tilt.rates);
    }

    /// Notes that the motion has jumped. The rates before have been noted.
    pub(super) fn jumped(&mut self, time: f64, after: &Motion) {
        if let Some((_, before)) = self.jump.replace((time, after.tilt.rates)) {
            self.open.widen_rates(&before);
        }
    }

    fn widen(&mut self, time: f64, motion: &Motion) {
        let open = &mut self.open;
        widen(
            &mut open.theta_min,
            &mut open.theta_max,
            motion.angles.theta,
        );
        self.rates(time, motion);
    }

    /// Notes a maximum of θ̇, which ends a cycle and begins the next.
    pub(super) fn boundary(
        &mut self,
        time: f64,
        time_ns: u64,
        motion: Motion,
    ) -> Option<NutationCycle> {
        self.widen(time, &motion);
        self.jump = None;
        let open = std::mem::replace(&mut self.open, OpenCycle::new(time, &motion));
        let has_begun = std::mem::replace(&mut self.has_begun, true);
        let is_nutation = open.is_nutation(&self.model, time);
        if !has_begun || !is_nutation {
            return None;
        }
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
            least_rates: open.least_rates,
            greatest_rates: open.greatest_rates,
            mean_phi_frictional: mean(|m| m.integrals.terms.phi_frictional),
        };
        self.count += 1;
        Some(cycle)
    }
}
