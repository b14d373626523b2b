//! Means over stages of a run, and integrals over the whole of it.

use crate::analysis::course::curve::Integral;
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use crate::telemetry::Message;
use crate::telemetry::fields::{
    ACCELERATION, CONTACT, NUTATION, PRECESSION, STATE, acceleration, contact, precession, state,
};

/// The inclination below which precession and spin can hardly be told apart, because their terms explode, rad.
const UPRIGHT: f64 = 0.01;
/// What remains after the last nutation is a stage of its own if it is longer than the run divided by this.
const NOTABLE: u64 = 50;
/// The most windows that are kept while the length of the run is not known.
const WINDOWS: usize = 96;

/// Sums over the samples of a stage.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stage {
    /// The number of whole nutation cycles.
    cycles: u64,
    /// The times of the first and last sample, ns.
    pub(super) from: u64,
    pub(super) to: u64,
    samples: u64,
    /// Sums of θ, φ̇, ψ̇, θ̇.
    sums: [f64; 4],
    /// The sum of the θ̇ that cancels friction, and the number of samples that have one.
    cancelling: f64,
    cancelled: u64,
    /// The number of samples with θ̈ < 0.
    rising: u64,
    /// Sums of the slow root and of φ̇ less it; the number of samples that have one, and of those with φ̇ above it.
    roots: [f64; 2],
    rooted: u64,
    above: u64,
}

impl Stage {
    fn add(&mut self, other: &Self) {
        if self.samples == 0 {
            self.from = other.from;
        }
        self.to = other.to;
        self.cycles += other.cycles;
        self.samples += other.samples;
        self.rising += other.rising;
        self.rooted += other.rooted;
        self.cancelling += other.cancelling;
        self.cancelled += other.cancelled;
        self.above += other.above;
        for (mine, theirs) in self.sums.iter_mut().zip(other.sums) {
            *mine += theirs;
        }
        for (mine, theirs) in self.roots.iter_mut().zip(other.roots) {
            *mine += theirs;
        }
    }

    fn mean(&self, sum: f64) -> f64 {
        sum / self.samples.max(1) as f64
    }

    /// Mean inclination, rad.
    pub(super) fn theta(&self) -> f64 {
        self.mean(self.sums[0])
    }

    /// Mean precession rate, rad/s.
    pub(super) fn phi_dot(&self) -> f64 {
        self.mean(self.sums[1])
    }

    /// Mean spin rate, rad/s.
    pub(super) fn psi_dot(&self) -> f64 {
        self.mean(self.sums[2])
    }

    /// Mean nutation rate, rad/s.
    pub(super) fn theta_dot(&self) -> f64 {
        self.mean(self.sums[3])
    }

    /// Mean of the θ̇ at which the gyroscopic and Coriolis terms of φ̈ cancel the frictional one, rad/s.
    pub(super) fn cancelling(&self) -> Option<f64> {
        (self.cancelled > 0).then(|| self.cancelling / self.cancelled as f64)
    }

    /// The part of the time during which θ̈ was negative.
    pub(super) fn rising(&self) -> f64 {
        self.rising as f64 / self.samples.max(1) as f64
    }

    /// Mean slow root and mean of φ̇ less it, rad/s; none where it was never real.
    pub(super) fn roots(&self) -> Option<[f64; 2]> {
        let mean = |sum: f64| sum / self.rooted as f64;
        (self.rooted > 0).then(|| self.roots.map(mean))
    }

    /// The part of the time with real roots during which φ̇ was above the slow one.
    pub(super) fn above(&self) -> f64 {
        self.above as f64 / self.rooted.max(1) as f64
    }
}

/// An integral over the whole run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Total {
    /// ∫ of the gyroscopic, Coriolis and frictional terms of φ̈, rad/s.
    PrecessionGyroscopic,
    PrecessionCoriolis,
    PrecessionFrictional,
    /// ∫ of the frictional term of ψ̈, rad/s.
    SpinFrictional,
    /// ∫ friction force · slip velocity, J: the work that the force of the law would have done.
    ContactWork,
}

/// Collects the means over stages and the integrals over the run, message by message.
///
/// Windows begin and end where a nutation does, at a maximum of θ̇: there φ̇ is at the slow root, so that the
/// ripple, hundreds of times larger than the mean, leaves nothing at their ends.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    /// The number of cycles in a window.
    width: u64,
    windows: Vec<Stage>,
    /// The cycle that has not ended yet.
    open: Stage,
    last_acceleration: f64,
    /// Whether the first nutation is still to come.
    has_not_begun: bool,
    top: Top,
    /// φ̈ per θ̇ of the gyroscopic and Coriolis terms in the last state, 1/s.
    answer: f64,
    totals: [Integral; 5],
    /// The time between the first two samples, ns, and whether it is the same between all.
    step: Option<u64>,
    is_even: bool,
    /// The time of the last sample, ns.
    last: Option<u64>,
    /// When the axis first came near upright, ns: sums over the run end there.
    pub(super) upright: Option<u64>,
    /// The fast root of least magnitude, rad/s.
    pub(super) fast_root: Option<f64>,
    /// Whether the roots lie on different sides of zero: then θ̈ is negative outside of them.
    pub(super) are_opposed: bool,
}

impl Stages {
    /// Stages of a run of this top.
    pub(super) fn new(top: Top) -> Self {
        Self {
            width: 1,
            windows: Vec::new(),
            open: Stage::default(),
            last_acceleration: f64::NAN,
            has_not_begun: true,
            top,
            answer: f64::NAN,
            totals: [Integral::default(); 5],
            step: None,
            is_even: true,
            last: None,
            upright: None,
            fast_root: None,
            are_opposed: false,
        }
    }

    /// Takes in a message of the table.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        match message.topic() {
            STATE => self.state(message),
            NUTATION => self.cycle(),
            // The rest is about precession and spin, which can't be told apart any longer.
            _ if self.upright.is_some() => {}
            ACCELERATION => self.acceleration(message),
            CONTACT => {
                let [force, slip] =
                    [contact::FRICTION_FORCE, contact::SLIP_WORLD].map(|field| field.of(message));
                self.totals[Total::ContactWork as usize].add(force.dot(&slip));
            }
            PRECESSION => self.roots(message),
            _ => {}
        }
    }

    fn acceleration(&mut self, message: &Message<'_>) {
        let terms = [
            acceleration::PHI_DDOT_GYROSCOPIC,
            acceleration::PHI_DDOT_CORIOLIS,
            acceleration::PHI_DDOT_FRICTIONAL,
            acceleration::PSI_DDOT_FRICTIONAL,
        ];
        let terms = terms.map(|term| term.of(message));
        for (total, term) in self.totals.iter_mut().zip(terms) {
            total.add(term);
        }
        let cancelling = -terms[Total::PrecessionFrictional as usize] / self.answer;
        if cancelling.is_finite() {
            self.open.cancelling += cancelling;
            self.open.cancelled += 1;
        }
    }

    fn state(&mut self, message: &Message<'_>) {
        let fields = [
            state::THETA,
            state::PHI_DOT,
            state::PSI_DOT,
            state::THETA_DOT,
            state::THETA_DDOT,
        ];
        let [theta, phi, psi, rate, acceleration] = fields.map(|field| field.of(message));
        let time_ns = message.time_ns;
        if let Some(last) = self.last.replace(time_ns) {
            let step = time_ns.saturating_sub(last);
            self.is_even &= *self.step.get_or_insert(step) == step;
        }
        if theta < UPRIGHT {
            self.upright.get_or_insert(time_ns);
        }
        // The first cycle begins where θ̇ is greatest: what was before is not part of it.
        if self.has_not_begun && self.last_acceleration > 0.0 && acceleration <= 0.0 {
            self.has_not_begun = false;
            self.open = Stage::default();
        }
        self.last_acceleration = acceleration;
        let (sin, cos) = sin_cos(theta);
        let axial = self.top.axial_moment / self.top.transverse_moment * (psi + phi * cos);
        self.answer = (axial - 2.0 * phi * cos) / sin;
        self.open.add(&Stage {
            from: time_ns,
            to: time_ns,
            samples: 1,
            sums: [theta, phi, psi, rate],
            rising: u64::from(acceleration < 0.0),
            ..Stage::default()
        });
    }

    /// Closes the cycle that has ended.
    fn cycle(&mut self) {
        self.has_not_begun = false;
        // The cycle was shorter than the time between samples.
        if self.open.samples == 0 {
            return;
        }
        let mut cycle = std::mem::take(&mut self.open);
        cycle.cycles = 1;
        match self.windows.last_mut() {
            Some(last) if last.cycles < self.width => last.add(&cycle),
            _ => self.windows.push(cycle),
        }
        if self.windows.len() > WINDOWS {
            self.merge();
        }
    }

    fn roots(&mut self, message: &Message<'_>) {
        let fields = [
            precession::SLOW_ROOT,
            precession::EXCESS,
            precession::FAST_ROOT,
        ];
        let [slow, excess, fast] = fields.map(|field| field.of(message));
        let least = self.fast_root.get_or_insert(fast);
        if fast.abs() < least.abs() {
            *least = fast;
        }
        self.are_opposed = slow * fast < 0.0;
        // The state of the same instant came before.
        self.open.roots[0] += slow;
        self.open.roots[1] += excess;
        self.open.rooted += 1;
        self.open.above += u64::from(excess > 0.0);
    }

    /// Joins the windows in pairs.
    fn merge(&mut self) {
        self.width *= 2;
        let pairs = self.windows.chunks(2);
        self.windows = pairs.map(together).collect();
    }

    /// Whether there are fewer than two samples.
    pub(super) fn is_empty(&self) -> bool {
        self.step.is_none()
    }

    /// The run in at most `count` stages with about the same number of nutations, and the rest; a run without nutations
    /// is one stage.
    pub(super) fn in_stages(&self, count: usize) -> Vec<Stage> {
        if self.windows.is_empty() {
            return vec![self.open];
        }
        let share = self.windows.len().div_ceil(count).max(1);
        let mut stages: Vec<Stage> = self.windows.chunks(share).map(together).collect();
        if self.open.to.saturating_sub(self.open.from) > self.open.to / NOTABLE {
            stages.push(self.open);
        }
        stages
    }

    /// The run as one stage.
    pub(super) fn whole(&self) -> Stage {
        together(&self.in_stages(1))
    }

    /// An integral over the run; none if samples are missing.
    pub(super) fn total(&self, total: Total) -> Option<f64> {
        let step = self.step.filter(|_| self.is_even)? as f64 / 1e9;
        Some(self.totals[total as usize].over(step)).filter(|total| total.is_finite())
    }
}

fn together(windows: &[Stage]) -> Stage {
    let mut stage = Stage::default();
    for window in windows {
        stage.add(window);
    }
    stage
}
