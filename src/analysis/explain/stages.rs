//! Means over some stages of a run, and sums over the whole of it.

use crate::analysis::course::curve::Integral;
use crate::analysis::course::{Place, places};
use crate::physics::math::sin_cos;
use crate::physics::top::Top;
use crate::telemetry::Message;

/// Nearer to upright than this, precession and spin can hardly be told apart: their terms explode, rad.
const UPRIGHT: f64 = 0.01;
/// What remains after the last nutation is a stage if it is a larger part of the run.
const NOTABLE: u64 = 50;
/// Windows that are kept while the run's length is not known.
const WINDOWS: usize = 96;

/// Sums over a stretch of time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Stage {
    /// Whole nutation cycles in it.
    cycles: u64,
    /// From and to, ns.
    pub(super) from: u64,
    pub(super) to: u64,
    samples: u64,
    /// Of θ, φ̇, ψ̇, θ̇.
    sums: [f64; 4],
    /// Of the θ̇ that cancels friction, and samples that have it.
    cancelling: f64,
    cancelled: u64,
    /// Samples with θ̈ < 0.
    sinking: u64,
    /// Of the slow root and φ̇ less it; samples that have it, and those with φ̇ above it.
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
        self.sinking += other.sinking;
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
    pub(super) fn sinking(&self) -> f64 {
        self.sinking as f64 / self.samples.max(1) as f64
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

/// What is integrated over the whole run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Total {
    /// ∫ of the gyroscopic, Coriolis and frictional terms of φ̈, rad/s.
    PrecessionGyroscopic,
    PrecessionCoriolis,
    PrecessionFrictional,
    /// ∫ of the frictional term of ψ̈, rad/s.
    SpinFrictional,
    /// ∫ friction force · slip velocity, J: what the force of the law would have done.
    ContactWork,
}

/// Collects means and sums, message by message.
///
/// Windows begin and end where a nutation does, at a maximum of θ̇: there φ̇ is at the slow root, so that the
/// ripple, hundreds of times larger than the mean, leaves nothing at their ends.
#[derive(Clone, Debug)]
pub(super) struct Stages {
    /// Cycles in a window.
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
    step: Option<u64>,
    last: Option<u64>,
    /// When the axis first came near upright, ns: sums over the run end there.
    pub(super) upright: Option<u64>,
    /// The fast root of least magnitude, rad/s.
    pub(super) fast_root: Option<f64>,
    /// Whether the roots lie on different sides of zero: then θ̈ is negative outside of them.
    pub(super) are_opposed: bool,
    fields: Fields,
}

#[derive(Clone, Copy, Debug)]
struct Fields {
    state: [Place; 5],
    acceleration: [Place; 4],
    contact: [Place; 6],
    roots: [Place; 3],
    nutation: Place,
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
            last: None,
            upright: None,
            fast_root: None,
            are_opposed: false,
            fields: Fields {
                state: places(
                    "/top/state",
                    ["theta", "phi_dot", "psi_dot", "theta_dot", "theta_ddot"],
                ),
                acceleration: places(
                    "/top/acceleration",
                    [
                        "phi_ddot.gyroscopic",
                        "phi_ddot.coriolis",
                        "phi_ddot.frictional",
                        "psi_ddot.frictional",
                    ],
                ),
                contact: places(
                    "/top/contact",
                    [
                        "friction_force.x",
                        "friction_force.y",
                        "friction_force.z",
                        "slip_world.x",
                        "slip_world.y",
                        "slip_world.z",
                    ],
                ),
                roots: places("/top/precession", ["slow_root", "excess", "fast_root"]),
                nutation: Place::find("/top/nutation", "cycle"),
            },
        }
    }

    /// Takes in a message of the table.
    pub(super) fn take(&mut self, message: &Message<'_>) {
        let fields = self.fields;
        let channel = message.channel;
        let value = |place: Place| place.of(message).unwrap_or(f64::NAN);
        if channel == fields.state[0].channel {
            self.state(message.time_ns, fields.state.map(value));
        } else if channel == fields.nutation.channel {
            self.cycle();
        } else if self.upright.is_some() {
            // What follows is about precession and spin.
        } else if channel == fields.acceleration[0].channel {
            let terms = fields.acceleration.map(value);
            for (total, term) in self.totals.iter_mut().zip(terms) {
                total.add(term);
            }
            let cancelling = -terms[Total::PrecessionFrictional as usize] / self.answer;
            if cancelling.is_finite() {
                self.open.cancelling += cancelling;
                self.open.cancelled += 1;
            }
        } else if channel == fields.contact[0].channel {
            let [fx, fy, fz, vx, vy, vz] = fields.contact.map(value);
            self.totals[Total::ContactWork as usize].add(fx * vx + fy * vy + fz * vz);
        } else if channel == fields.roots[0].channel {
            self.roots(fields.roots.map(value));
        }
    }

    fn state(&mut self, time_ns: u64, [theta, phi, psi, rate, acceleration]: [f64; 5]) {
        if let Some(last) = self.last {
            self.step.get_or_insert(time_ns - last);
        }
        self.last = Some(time_ns);
        if theta < UPRIGHT {
            self.upright.get_or_insert(time_ns);
        }
        // Where θ̇ is greatest, the first cycle begins: what was before is not part of it.
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
            sinking: u64::from(acceleration < 0.0),
            ..Stage::default()
        });
    }

    /// A nutation has ended.
    fn cycle(&mut self) {
        self.has_not_begun = false;
        // Shorter than the time between samples.
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

    fn roots(&mut self, [slow, excess, fast]: [f64; 3]) {
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

    /// Makes the windows twice as long.
    fn merge(&mut self) {
        self.width *= 2;
        let pairs = self.windows.chunks(2);
        self.windows = pairs.map(together).collect();
    }

    /// Whether there is anything at all.
    pub(super) fn is_empty(&self) -> bool {
        self.step.is_none()
    }

    /// The run in so many stages of about the same number of nutations; of a run without any, all of it.
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

    /// The run as one.
    pub(super) fn whole(&self) -> Stage {
        together(&self.in_stages(1))
    }

    /// An integral over the run; none without samples.
    pub(super) fn total(&self, total: Total) -> Option<f64> {
        let step = self.step? as f64 / 1e9;
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
