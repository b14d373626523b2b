//! Nutation cycles and their averages.

use crate::physics::dynamics::{Model, Motion};
use crate::physics::kinematics::Euler;

/// Maximum ratio of a cycle's duration to the frictionless nutation period, or the inverse ratio.
///
/// Friction changes the period slightly: in the presets with a fixed peg, cycles take 0.94 to 1.12 times the frictionless
/// period. A fall takes 9 to 100 times as long.
const PERIOD_FACTOR: f64 = 2.0;

/// The same for a cycle with an impact or another change of phase: it is nearer to one nutation than to a half or to two.
/// An impact shifts the phase of the nutation: the maxima of θ̇ around it may be half a nutation apart, whose averages are
/// not those of the motion.
const SHIFTED_FACTOR: f64 = std::f64::consts::SQRT_2;

/// One nutation, from a maximum of θ̇ to the next.
///
/// An impact, at which the rates jump, does not end a cycle, even if θ̈ jumps from positive to negative there: it is not
/// the phase of the nutation at which a cycle begins.
///
/// Cycles are delimited by maxima of θ̇, because θ has no extremes where the drift exceeds the nutation. Maxima of θ̇
/// that are not about one nutation period apart, e.g. before and after a fall, don't form a cycle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NutationCycle {
    /// Index of the cycle in the run, from 0.
    pub index: u32,
    /// Start time, s.
    pub start: f64,
    /// End time, s.
    pub end: f64,
    /// The end time, rounded to nanoseconds.
    pub time_ns: u64,
    /// Least θ, rad.
    pub theta_min: f64,
    /// Greatest θ, rad.
    pub theta_max: f64,
    /// Mean of θ over the cycle, rad.
    pub theta_mean: f64,
    /// Means of the Euler rates over the cycle, rad/s: exactly the changes of the angles divided by the period.
    pub mean_rates: Euler,
    /// Least Euler rates, rad/s.
    pub least_rates: Euler,
    /// Greatest Euler rates, rad/s.
    pub greatest_rates: Euler,
    /// Mean of the frictional term of φ̈ over the cycle, rad/s².
    pub mean_phi_frictional: f64,
}

impl NutationCycle {
    /// Duration, s.
    pub fn period(&self) -> f64 {
        self.end - self.start
    }
}

/// Collects the data of the current cycle.
#[derive(Clone, Debug)]
pub(super) struct NutationTracker {
    model: Model,
    /// Number of completed cycles.
    count: u32,
    /// The current cycle, since the last maximum of θ̇ or the start of the motion.
    open: OpenCycle,
    has_begun: bool,
    /// Time of the last impact or other change of phase, s.
    last_jump: Option<f64>,
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

    /// The frictionless nutation period, s, if the motion is periodic.
    fn period(&self, model: &Model) -> Option<f64> {
        model.nutation_period(&self.motion, [self.theta_min, self.theta_max])
    }

    /// Whether the cycle ending at `time` has the duration of one nutation, within a factor.
    fn is_nutation(&self, model: &Model, time: f64, factor: f64) -> bool {
        let nutations = 1.0 / factor..=factor;
        self.period(model)
            .is_some_and(|period| nutations.contains(&((time - self.start) / period)))
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
            last_jump: None,
        }
    }

    /// Discards the open cycle and restarts from here.
    pub(super) fn restart(&mut self, time: f64, motion: Motion) {
        self.open = OpenCycle::new(time, &motion);
        self.has_begun = false;
    }

    /// Records an extreme of θ. Returns whether it belongs to a nutation: its time since the last maximum of θ̇ is not
    /// longer than a nutation takes.
    pub(super) fn record_extreme(&mut self, time: f64, motion: &Motion) -> bool {
        self.widen(motion);
        let period = self.open.period(&self.model);
        period.is_none_or(|period| time - self.open.start <= PERIOD_FACTOR * period)
    }

    /// Records rates as candidates for the extremes of the cycle.
    pub(super) fn record_rates(&mut self, motion: &Motion) {
        self.open.widen_rates(&motion.tilt.rates);
    }

    /// Records an impact, or another change of phase; the rates before it were recorded already.
    pub(super) fn record_impact(&mut self, time: f64, after: &Motion) {
        self.last_jump = Some(time);
        self.open.widen_rates(&after.tilt.rates);
    }

    fn widen(&mut self, motion: &Motion) {
        let open = &mut self.open;
        widen(
            &mut open.theta_min,
            &mut open.theta_max,
            motion.angles.theta,
        );
        self.record_rates(motion);
    }

    /// Records a maximum of θ̇, which ends a cycle and starts the next unless it is a jump at an impact. Returns the cycle
    /// if it is complete.
    pub(super) fn end_cycle(
        &mut self,
        time: f64,
        time_ns: u64,
        motion: Motion,
    ) -> Option<NutationCycle> {
        self.widen(&motion);
        if self.last_jump == Some(time) {
            return None;
        }
        // This maximum also begins the next cycle, whether or not the last one counts.
        let open = std::mem::replace(&mut self.open, OpenCycle::new(time, &motion));
        // The first maximum of θ̇ only begins a cycle: the motion before it is a part of one.
        let has_begun = std::mem::replace(&mut self.has_begun, true);
        let is_shifted = self.last_jump.is_some_and(|jump| jump >= open.start);
        let factor = if is_shifted {
            SHIFTED_FACTOR
        } else {
            PERIOD_FACTOR
        };
        let is_nutation = open.is_nutation(&self.model, time, factor);
        if !has_begun || !is_nutation {
            return None;
        }
        let period = time - open.start;
        let cycle = NutationCycle {
            index: self.count,
            start: open.start,
            end: time,
            time_ns,
            theta_min: open.theta_min,
            theta_max: open.theta_max,
            theta_mean: (motion.integrals.theta - open.motion.integrals.theta) / period,
            mean_rates: Euler::new(
                (motion.angles.phi - open.motion.angles.phi) / period,
                (motion.angles.theta - open.motion.angles.theta) / period,
                (motion.angles.psi - open.motion.angles.psi) / period,
            ),
            least_rates: open.least_rates,
            greatest_rates: open.greatest_rates,
            mean_phi_frictional: (motion.integrals.terms.phi_frictional
                - open.motion.integrals.terms.phi_frictional)
                / period,
        };
        self.count += 1;
        Some(cycle)
    }
}
