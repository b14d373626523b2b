//! What happened in one run: its events, its nutation cycles, its budget.

pub(crate) mod curve;

use self::curve::{Curve, Integral, extreme};
use crate::archive::format::{Entries, STOP_REASON, STOP_TIME};
use crate::physics::kinematics::{Euler, Tilt};
use crate::telemetry::{Message, channel_index, channels};
use schemars::JsonSchema;
use serde::Serialize;

/// What happened in one run.
#[derive(Clone, Debug, Default, PartialEq, Serialize, JsonSchema)]
pub struct CourseReport {
    /// Why it ended.
    pub stop_reason: Option<String>,
    /// When, s.
    pub stop_time: Option<f64>,
    /// When the top had risen, s: θ first at the scenario's limit.
    pub rise_time: Option<f64>,
    /// When the last sample was taken, s: sums over the run go to it.
    pub last_sample: Option<f64>,
    /// Number of whole nutation cycles.
    pub nutations: Option<u64>,
    /// Mechanical energy at the first sample, J.
    pub energy_first: Option<f64>,
    /// Mechanical energy at the last sample, J.
    pub energy_last: Option<f64>,
    /// Work of friction up to the last sample, J, as the integrator summed it.
    pub friction_work: Option<f64>,
    /// The same about the line of nodes (against the nutation), the perpendicular n × e_N (against the
    /// precession) and the symmetry axis (against the spin), summed from the samples.
    pub friction_work_node: Option<[f64; 3]>,
    /// Length of the path that the contact point slipped, m.
    pub slip_path: Option<f64>,
    /// Spin rate ψ̇ when the run stopped, rad/s.
    pub spin_rate_last: Option<f64>,
    /// Precession rate φ̇ when the run stopped, rad/s.
    pub precession_rate_last: Option<f64>,
    /// Largest change of the angular momentum about the vertical, as a part of it.
    pub vertical_momentum_drift: Option<f64>,
    /// Largest difference between the energy and what friction left of it, J.
    pub energy_imbalance: Option<f64>,
}

/// A field of the table: its channel and its place in the numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Place {
    pub(crate) channel: usize,
    number: usize,
}

impl Place {
    /// A field that the table has.
    pub(crate) fn find(topic: &str, field: &str) -> Self {
        let channel = channel_index(topic).unwrap_or(usize::MAX);
        let info = channels().get(channel);
        let number = info.and_then(|info| info.number_index(field));
        Self {
            channel,
            number: number.unwrap_or(usize::MAX),
        }
    }

    /// Its value in a message of its channel; none in a recording of another version that lacks it.
    pub(crate) fn of(self, message: &Message<'_>) -> Option<f64> {
        let value = *message.numbers.get(self.number)?;
        (!value.is_nan()).then_some(value)
    }
}

/// Several fields of a channel, in the order in which they are asked for.
pub(crate) fn places<const N: usize>(topic: &str, fields: [&str; N]) -> [Place; N] {
    fields.map(|field| Place::find(topic, field))
}

/// An event.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Event {
    pub(crate) name: String,
    pub(crate) description: String,
    /// s.
    pub(crate) time: f64,
    /// rad.
    pub(crate) theta: f64,
    /// φ̇ and ψ̇, rad/s.
    rates: [f64; 2],
}

/// The quantities of which a cycle knows the range, as fields of `/top/state` with their slopes.
const RANGED: [(&str, &str); 4] = [
    ("theta", "theta_dot"),
    ("theta_dot", "theta_ddot"),
    ("phi_dot", "phi_ddot"),
    ("psi_dot", "psi_ddot"),
];
/// Where θ and θ̇ stand among them.
const THETA: usize = 0;
const THETA_DOT: usize = 1;

/// A nutation cycle.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Cycle {
    pub(crate) number: f64,
    pub(crate) start: f64,
    pub(crate) period: f64,
    /// Means of θ, θ̇, φ̇, ψ̇.
    pub(crate) means: [f64; 4],
    /// Least and greatest values of the same; NaN where they are not known.
    pub(crate) ranges: [[f64; 2]; 4],
}

impl Cycle {
    pub(crate) fn middle(&self) -> f64 {
        self.start + 0.5 * self.period
    }

    /// Half the range of θ̇, rad/s: free of the drift, unlike that of θ.
    pub(crate) fn amplitude(&self) -> f64 {
        let [least, greatest] = self.ranges[THETA_DOT];
        0.5 * (greatest - least)
    }
}

/// Finds the least and greatest values of the states within a cycle.
#[derive(Clone, Debug)]
struct Ranges {
    fields: [[Place; 2]; 4],
    /// The last state: its time (s), and values with slopes.
    last: Option<(f64, [[f64; 2]; 4])>,
    open: [[f64; 2]; 4],
}

/// Of nothing.
const EMPTY: [[f64; 2]; 4] = [[f64::INFINITY, f64::NEG_INFINITY]; 4];

impl Ranges {
    fn new() -> Self {
        let fields = RANGED.map(|(value, slope)| places("/top/state", [value, slope]));
        Self {
            fields,
            last: None,
            open: EMPTY,
        }
    }

    /// Takes in a state. Gives the extremes between the last one and this one, for the cycle that ended there.
    fn state(&mut self, message: &Message<'_>, has_cycles: bool) -> [[f64; 2]; 4] {
        let time = message.time_ns as f64 / 1e9;
        let value = |place: Place| place.of(message).unwrap_or(f64::NAN);
        let now = self.fields.map(|pair| pair.map(value));
        let mut between = EMPTY;
        if let Some((before, last)) = &self.last {
            for (quantity, range) in between.iter_mut().enumerate() {
                let found = extreme(last[quantity], now[quantity], time - before);
                widen(range, found.unwrap_or(f64::NAN));
            }
            // Where θ̇ is greatest, the first cycle begins: what was before is not part of it.
            let slopes = [last[THETA_DOT][1], now[THETA_DOT][1]];
            if !has_cycles && slopes[0] > 0.0 && slopes[1] <= 0.0 {
                self.open = EMPTY;
            }
        }
        for (quantity, range) in self.open.iter_mut().enumerate() {
            for value in [now[quantity][0], between[quantity][0], between[quantity][1]] {
                widen(range, value);
            }
        }
        self.last = Some((time, now));
        between
    }

    /// The ranges since they were taken last.
    fn take(&mut self) -> [[f64; 2]; 4] {
        let ranges = std::mem::replace(&mut self.open, EMPTY);
        ranges.map(|range| {
            if range[0] <= range[1] {
                range
            } else {
                [f64::NAN; 2]
            }
        })
    }
}

/// Makes a range take in a value; what is not finite is none.
fn widen([least, greatest]: &mut [f64; 2], value: f64) {
    if !value.is_finite() {
        return;
    }
    if value < *least {
        *least = value;
    }
    if value > *greatest {
        *greatest = value;
    }
}

/// The work of friction about each axis of the node frame, from the torques and rates of the samples.
#[derive(Clone, Debug)]
struct NodeWork {
    torque: [Place; 3],
    integrals: [Integral; 3],
    /// The time of the last sample, and the distance of two, ns.
    last: Option<u64>,
    step: u64,
    is_even: bool,
}

impl NodeWork {
    fn new() -> Self {
        let torque = places(
            "/top/torque",
            ["friction_node.x", "friction_node.y", "friction_node.z"],
        );
        Self {
            torque,
            integrals: [Integral::default(); 3],
            last: None,
            step: 0,
            is_even: true,
        }
    }

    fn add(&mut self, message: &Message<'_>, tilt: &Tilt) {
        let omega = tilt.omega_node();
        let rates = [omega.x, omega.y, omega.z];
        for ((place, rate), integral) in self.torque.iter().zip(rates).zip(&mut self.integrals) {
            integral.add(place.of(message).unwrap_or(f64::NAN) * rate);
        }
        if let Some(last) = self.last.replace(message.time_ns) {
            let step = message.time_ns.saturating_sub(last);
            self.is_even &= step > 0 && (self.step == 0 || self.step == step);
            self.step = step;
        }
    }

    /// In J; none if samples are missing in between.
    fn work(&self) -> Option<[f64; 3]> {
        let work = self
            .integrals
            .map(|integral| integral.over(self.step as f64 / 1e9));
        let is_known = self.last.is_some() && self.is_even && work.iter().all(|w| w.is_finite());
        is_known.then_some(work)
    }
}

/// What happened in a run, taken in message by message.
#[derive(Clone, Debug)]
pub(crate) struct Course {
    pub(crate) events: Vec<Event>,
    pub(crate) cycles: Vec<Cycle>,
    pub(crate) messages: u64,
    pub(crate) last_ns: u64,
    /// Entries of the end record.
    pub(crate) end: Option<Entries>,
    ranges: Ranges,
    has_just_closed: bool,
    /// The last state: its time, ns, and what it is.
    tilt: Option<(u64, Tilt)>,
    work: NodeWork,
    energy: Option<[f64; 2]>,
    imbalance: f64,
    friction_work: Option<f64>,
    momentum: Option<(f64, f64)>,
    slip_path: Option<f64>,
    fields: Fields,
}

/// The fields that are needed here.
#[derive(Clone, Copy, Debug)]
struct Fields {
    state: [Place; 4],
    nutation: [Place; 9],
    event: [Place; 4],
    energy: [Place; 2],
    vertical: Place,
    slip_path: Place,
}

impl Fields {
    fn find() -> Self {
        Self {
            state: places("/top/state", ["theta", "phi_dot", "theta_dot", "psi_dot"]),
            nutation: places(
                "/top/nutation",
                [
                    "cycle",
                    "start",
                    "period",
                    "theta_min",
                    "theta_max",
                    "theta_mean",
                    "theta_dot_mean",
                    "phi_dot_mean",
                    "psi_dot_mean",
                ],
            ),
            event: places("/events", ["time", "theta", "phi_dot", "psi_dot"]),
            energy: places("/top/energy", ["total", "friction_work"]),
            vertical: Place::find("/top/momentum", "vertical"),
            slip_path: Place::find("/top/contact", "slip_path"),
        }
    }
}

impl Default for Course {
    fn default() -> Self {
        Self {
            events: Vec::new(),
            cycles: Vec::new(),
            messages: 0,
            last_ns: 0,
            end: None,
            ranges: Ranges::new(),
            has_just_closed: false,
            tilt: None,
            work: NodeWork::new(),
            energy: None,
            imbalance: 0.0,
            friction_work: None,
            momentum: None,
            slip_path: None,
            fields: Fields::find(),
        }
    }
}

impl Course {
    /// Takes a message of the table.
    pub(crate) fn take(&mut self, message: &Message<'_>) {
        self.messages += 1;
        self.last_ns = self.last_ns.max(message.time_ns);
        let fields = self.fields;
        let channel = message.channel;
        if channel == fields.state[0].channel {
            self.state(message);
        } else if channel == self.work.torque[0].channel {
            if let Some((time_ns, tilt)) = &self.tilt
                && *time_ns == message.time_ns
            {
                self.work.add(message, tilt);
            }
        } else if channel == fields.energy[0].channel {
            self.energy(message);
        } else if channel == fields.vertical.channel {
            let vertical = fields.vertical.of(message).unwrap_or(f64::NAN);
            let (first, drift) = self.momentum.get_or_insert((vertical, 0.0));
            *drift = drift.max((vertical - *first).abs());
        } else if channel == fields.slip_path.channel {
            self.slip_path = fields.slip_path.of(message);
        } else if channel == fields.nutation[0].channel {
            self.cycle(message);
        } else if channel == fields.event[0].channel {
            self.event(message);
        }
    }

    fn state(&mut self, message: &Message<'_>) {
        let between = self.ranges.state(message, !self.cycles.is_empty());
        if std::mem::take(&mut self.has_just_closed)
            && let Some(cycle) = self.cycles.last_mut()
        {
            // The θ̇ with which the cycle ended lies between two samples.
            for (range, [least, greatest]) in cycle.ranges.iter_mut().zip(between).skip(THETA_DOT) {
                widen(range, least);
                widen(range, greatest);
            }
        }
        if let [Some(theta), Some(phi), Some(rate), Some(psi)] =
            self.fields.state.map(|place| place.of(message))
        {
            let rates = Euler {
                phi,
                theta: rate,
                psi,
            };
            self.tilt = Some((message.time_ns, Tilt::from_rates(theta, rates)));
        }
    }

    /// The state that a message has just told.
    pub(crate) fn new_tilt(&self, message: &Message<'_>) -> Option<&Tilt> {
        let is_state = message.channel == self.fields.state[0].channel;
        let (time_ns, tilt) = self.tilt.as_ref()?;
        (is_state && *time_ns == message.time_ns).then_some(tilt)
    }

    fn energy(&mut self, message: &Message<'_>) {
        let [Some(total), Some(work)] = self.fields.energy.map(|place| place.of(message)) else {
            return;
        };
        let first = self.energy.map_or(total - work, |energy| energy[0]);
        self.energy = Some([first, total]);
        self.friction_work = Some(work);
        self.imbalance = self.imbalance.max((total - first - work).abs());
    }

    fn cycle(&mut self, message: &Message<'_>) {
        let values = self
            .fields
            .nutation
            .map(|place| place.of(message).unwrap_or(f64::NAN));
        let [
            number,
            start,
            period,
            least,
            greatest,
            theta,
            theta_dot,
            phi_dot,
            psi_dot,
        ] = values;
        let mut ranges = self.ranges.take();
        // The integrator knew these exactly.
        ranges[THETA] = [least, greatest];
        self.cycles.push(Cycle {
            number,
            start,
            period,
            means: [theta, theta_dot, phi_dot, psi_dot],
            ranges,
        });
        self.has_just_closed = true;
    }

    fn event(&mut self, message: &Message<'_>) {
        let [time, theta, phi, psi] = self
            .fields
            .event
            .map(|place| place.of(message).unwrap_or(f64::NAN));
        let mut texts = message.texts.iter();
        let mut text = || texts.next().cloned().unwrap_or_default();
        self.events.push(Event {
            name: text(),
            description: text(),
            time,
            theta,
            rates: [phi, psi],
        });
    }

    /// The boundaries of the nutation cycles: their times (s) and how many nutations there have been.
    pub(crate) fn phase(&self) -> Curve {
        let starts = self.cycles.iter().map(|cycle| (cycle.start, cycle.number));
        let end = self
            .cycles
            .last()
            .map(|last| (last.start + last.period, last.number + 1.0));
        Curve::new(starts.chain(end))
    }

    /// A quantity of the cycles over their middles (s).
    pub(crate) fn of_cycles(&self, quantity: impl Fn(&Cycle) -> f64) -> Curve {
        let points = self
            .cycles
            .iter()
            .map(|cycle| (cycle.middle(), quantity(cycle)));
        Curve::new(points.filter(|(_, value)| !value.is_nan()))
    }

    /// The first event of a kind.
    pub(crate) fn first(&self, name: &str) -> Option<&Event> {
        self.events.iter().find(|event| event.name == name)
    }

    /// A rate of the last sample, if that is when the run stopped.
    fn rate_at(&self, stop_time: Option<f64>, rate: impl Fn(&Euler) -> f64) -> Option<f64> {
        let (time_ns, tilt) = self.tilt.as_ref()?;
        let is_end = (stop_time? - *time_ns as f64 / 1e9).abs() < 1e-9;
        is_end.then(|| rate(&tilt.rates))
    }

    pub(crate) fn report(&self) -> CourseReport {
        let entry = |key: &str| self.end.as_ref()?.get(key);
        let stop_time = entry(STOP_TIME).and_then(|time| time.parse::<f64>().ok());
        // The last event is the end of the run, unless its duration was over.
        let last = self
            .events
            .last()
            .filter(|event| Some(event.time) == stop_time);
        let is_rise = entry(STOP_REASON).is_some_and(|reason| reason == "risen");
        let risen = self.first("risen").map(|event| event.time);
        CourseReport {
            stop_reason: entry(STOP_REASON).cloned(),
            stop_time,
            rise_time: risen.or(stop_time.filter(|_| is_rise)),
            nutations: (!self.cycles.is_empty()).then_some(self.cycles.len() as u64),
            energy_first: self.energy.map(|energy| energy[0]),
            energy_last: self.energy.map(|energy| energy[1]),
            friction_work: self.friction_work,
            friction_work_node: self.work.work(),
            slip_path: self.slip_path,
            spin_rate_last: last
                .map_or_else(|| self.rate_at(stop_time, |r| r.psi), |e| Some(e.rates[1])),
            precession_rate_last: last
                .map_or_else(|| self.rate_at(stop_time, |r| r.phi), |e| Some(e.rates[0])),
            last_sample: self.tilt.as_ref().map(|(time_ns, _)| *time_ns as f64 / 1e9),
            vertical_momentum_drift: self.momentum.map(|(first, drift)| drift / first.abs()),
            energy_imbalance: self.energy.map(|_| self.imbalance),
        }
    }
}
