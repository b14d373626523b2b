//! A run that is simulated in slices, and the columns that the page draws.

use serde_json::{Value as Json, json};
use std::cell::Cell;
use std::error::Error;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::rc::Rc;
use toprise::archive::format::end_entries;
use toprise::archive::writer::{Form, McapWriter};
use toprise::physics::math::cos;
use toprise::physics::top::Top;
use toprise::run::outcome::Outcome;
use toprise::run::scenario::Scenario;
use toprise::run::simulation::{
    EventKind, Record, Regime, Sample, Simulation, SimulationError, StopReason, Tally,
};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::{RunMessages, Topics};

/// Maximum numbers of steps and samples of a run in the page.
const MAX_STEPS: u64 = 2_000_000;
const MAX_SAMPLES: usize = 500_000;

/// A quantity of a top at a sample.
type Quantity = fn(&Top, &Sample) -> f64;

/// Columns for the page: name and value of a sample. SI units, world frame.
#[rustfmt::skip]
pub const COLUMNS: &[(&str, Quantity)] = &[
    ("time", |_, s| s.time_ns as f64 / 1e9),
    ("theta", |_, s| s.angles.theta),
    ("phi_dot", |_, s| s.tilt.rates.phi),
    ("theta_dot", |_, s| s.tilt.rates.theta),
    ("psi_dot", |_, s| s.tilt.rates.psi),
    ("axial_rate", |_, s| s.pose.omega_body.z),
    ("slip_speed", |_, s| s.slip.world.norm()),
    ("energy", |_, s| s.energy.total()),
    // Of the centre of mass above the table, so that it is never negative.
    ("height_energy", |top, s| top.weight() * (s.pose.peg_position.z + top.center_distance * s.pose.axis.z)),
    ("spin_energy", |_, s| 0.5 * s.momentum.axial * s.pose.omega_body.z),
    ("kinetic", |_, s| s.energy.kinetic),
    ("qw", |_, s| s.pose.world_from_body.w),
    ("qx", |_, s| s.pose.world_from_body.i),
    ("qy", |_, s| s.pose.world_from_body.j),
    ("qz", |_, s| s.pose.world_from_body.k),
    ("peg_x", |_, s| s.pose.peg_position.x),
    ("peg_y", |_, s| s.pose.peg_position.y),
    ("peg_z", |_, s| s.pose.peg_position.z),
    ("slip_x", |_, s| s.slip.world.x),
    ("slip_y", |_, s| s.slip.world.y),
    ("friction_x", |_, s| s.slip.friction_force.x),
    ("friction_y", |_, s| s.slip.friction_force.y),
    // Of friction, about the peg's centre.
    ("torque_x", |_, s| (s.pose.world_from_body * s.torque.friction.body).x),
    ("torque_y", |_, s| (s.pose.world_from_body * s.torque.friction.body).y),
    ("torque_z", |_, s| (s.pose.world_from_body * s.torque.friction.body).z),
    ("momentum_x", |_, s| s.momentum.world.x),
    ("momentum_y", |_, s| s.momentum.world.y),
    ("momentum_z", |_, s| s.momentum.world.z),
    ("height", |top, s| s.pose.peg_position.z - top.peg_radius),
    // 1 in the air, otherwise 0.
    ("flying", |_, s| f64::from(s.regime() == Regime::Flying)),
];

/// A run under way, or complete.
pub struct Run {
    pub scenario: Scenario,
    simulation: Simulation,
    steps: Rc<Cell<u64>>,
    columns: Vec<Vec<f64>>,
    events: Vec<Json>,
    /// The middle of each nutation, s, and its means of θ, φ̇, θ̇ and ψ̇.
    cycles: Vec<[f64; 5]>,
    end: Option<End>,
}

/// End of a run of the page.
enum End {
    Complete(Box<Outcome>),
    Failed(SimulationError),
    /// It has more steps or samples than the page allows.
    TooLong,
}

impl Run {
    /// Starts a run.
    ///
    /// # Errors
    /// If the simulation can't start.
    pub fn new(scenario: Scenario) -> Result<Self, SimulationError> {
        let steps = Rc::new(Cell::new(0));
        let counted = Rc::clone(&steps);
        let simulation = Simulation::new(&scenario)?.continue_while(move || {
            counted.set(counted.get() + 1);
            counted.get() < MAX_STEPS
        });
        Ok(Self {
            simulation,
            scenario,
            steps,
            columns: vec![Vec::new(); COLUMNS.len()],
            events: Vec::new(),
            cycles: Vec::new(),
            end: None,
        })
    }

    /// A column; empty if the index is out of range.
    pub fn column(&self, index: usize) -> &[f64] {
        self.columns.get(index).map_or(&[], Vec::as_slice)
    }

    /// Simulates some more records.
    pub fn advance(&mut self, records: usize) {
        for _ in 0..records {
            match self.simulation.next() {
                _ if self.columns[0].len() > MAX_SAMPLES => self.finish(),
                Some(Ok(record)) => self.take(&record),
                Some(Err(error)) => self.end = Some(End::Failed(error)),
                None => self.finish(),
            }
            if self.end.is_some() {
                break;
            }
        }
    }

    fn take(&mut self, record: &Record) {
        match record {
            Record::Sample(sample) => {
                let top = &self.scenario.model.top;
                for ((_, value), column) in COLUMNS.iter().zip(&mut self.columns) {
                    column.push(value(top, sample));
                }
            }
            Record::Event(event) => {
                if !event.kind.is_nutation_extreme() {
                    self.events.push(json!({
                        "time": event.time,
                        "text": event.sentence(&self.scenario.model.top),
                        "kind": event.kind.name(),
                        "plural": event.kind.plural(&self.scenario.model.top),
                    }));
                }
            }
            Record::Nutation(cycle) => {
                let middle = f64::midpoint(cycle.start, cycle.end);
                let rates = cycle.mean_rates;
                let means = [middle, cycle.theta_mean, rates.phi, rates.theta, rates.psi];
                self.cycles.push(means);
            }
            Record::Impact(_) => {}
        }
    }

    fn finish(&mut self) {
        let end = self.simulation.end();
        let is_whole = end.stop != StopReason::Interrupted && self.columns[0].len() <= MAX_SAMPLES;
        self.end = Some(if is_whole {
            End::Complete(Box::new(Outcome::new(
                &self.scenario,
                end,
                self.simulation.tally().clone(),
            )))
        } else {
            End::TooLong
        });
    }

    /// Progress of the run.
    pub fn progress(&self) -> Json {
        let samples = self.columns[0].len();
        let mut progress = json!({ "samples": samples });
        match &self.end {
            Some(End::Complete(outcome)) => {
                progress["events"] = json!(self.events);
                progress["cycles"] = json!(self.cycles);
                progress["outcome"] = json!(headline(&self.scenario, outcome));
            }
            Some(End::Failed(error)) => progress["error"] = json!(error.to_string()),
            Some(End::TooLong) => {
                progress["error"] = json!(format!(
                    "the run is too long for the page: at t = {:.3} s it has {} steps and {samples} samples",
                    self.simulation.end().time,
                    self.steps.get(),
                ));
            }
            None => {}
        }
        progress
    }
}

/// A sentence about the end of a run, for a reader who sees it from the start: in the present tense, with few digits.
fn headline(scenario: &Scenario, outcome: &Outcome) -> String {
    let time = rounded(outcome.end.time);
    let end = match outcome.end.stop {
        StopReason::Risen => format!("upright after {time}"),
        StopReason::Fallen => format!("fallen after {time}"),
        StopReason::Duration => state_at_time_limit(outcome),
        StopReason::SlipStopped => format!("stops slipping after {time}"),
        StopReason::Rest => format!("at rest after {time}"),
        StopReason::Singular => {
            format!("exactly upright, which its formulation can't describe, after {time}")
        }
        StopReason::Jam => format!("jams after {time}"),
        StopReason::Pivot => format!("only turns about the vertical after {time}"),
        StopReason::Interrupted | StopReason::Failed => format!("ends after {time}"),
    };
    format!("{}{}{end}", inversion(scenario, outcome), swings(outcome))
}

/// The first fall of a top whose run goes on after it; empty if there is none.
fn swings(outcome: &Outcome) -> String {
    let falls = outcome.tally.first(EventKind::Fallen);
    match (outcome.end.stop, falls) {
        // Without an inclination that ends the run, the level of a fall is the horizontal.
        (StopReason::Duration, Some(time)) => {
            format!("passes the horizontal at {}; ", rounded(time))
        }
        _ => String::new(),
    }
}

/// A clause about the inversion of a tippe top; empty for others.
fn inversion(scenario: &Scenario, outcome: &Outcome) -> String {
    let is_tippe_top = outcome.is_free && scenario.model.top.center_distance < 0.0;
    let starts_upright = scenario.angles.theta < FRAC_PI_2;
    match outcome.end.inversion_time {
        Some(time) if outcome.end.motion.angles.theta >= FRAC_PI_2 => {
            format!("turns over at {}; ", rounded(time))
        }
        // It swings, and comes back.
        Some(time) => format!("passes the horizontal at {}; ", rounded(time)),
        None if is_tippe_top && starts_upright => "does not turn over; ".to_owned(),
        None => String::new(),
    }
}

/// Below this rate the page shows 0.0 rev/s.
const LEAST_SPIN: f64 = 0.05 * TAU;

/// A clause about the motion of a top when the time limit ends its run.
fn state_at_time_limit(outcome: &Outcome) -> String {
    let motion = &outcome.end.motion;
    let (theta, rates) = (motion.angles.theta, motion.tilt.rates);
    // A top that has fallen may swing with any spin: that is not what "still spinning" promises.
    let has_fallen = outcome.tally.first(EventKind::Fallen).is_some();
    let is_slow = (rates.psi + rates.phi * cos(theta)).abs() < LEAST_SPIN;
    let verb = if is_slow || has_fallen {
        "tilted by"
    } else {
        "still spinning, tilted by"
    };
    let grip = match since(
        &outcome.tally,
        EventKind::RollBegins,
        &[EventKind::RollEnds, EventKind::LiftOff],
    ) {
        Some(time) => format!(", rolling since {}", rounded(time)),
        None => String::new(),
    };
    format!(
        "after {} {verb} {:.1}°{grip}",
        rounded(outcome.end.time),
        theta.to_degrees()
    )
}

/// Time of the last event of a kind, if none of those that end its state came later, s.
fn since(tally: &Tally, begin: EventKind, ends: &[EventKind]) -> Option<f64> {
    let begun = last(tally, begin)?;
    let has_ended = ends
        .iter()
        .any(|end| last(tally, *end).is_some_and(|time| time > begun));
    (!has_ended).then_some(begun)
}

/// Time of the last event of a kind, s.
fn last(tally: &Tally, kind: EventKind) -> Option<f64> {
    let mut counts = tally.counts().iter();
    counts
        .find(|count| count.name == kind)
        .map(|count| count.last_time)
}

/// A time in s, with three decimals where two would be few, and no line break before its unit.
fn rounded(time: f64) -> String {
    if time < 1.0 {
        format!("{time:.3}\u{a0}s")
    } else {
        format!("{time:.2}\u{a0}s")
    }
}

/// The recording of a scenario, with its content digest: the bytes that `toprise run` writes.
///
/// # Errors
/// If the motion can't be computed to its end.
pub fn recording(
    scenario: &Scenario,
    encoding: Encoding,
) -> Result<(Vec<u8>, String), Box<dyn Error>> {
    let mut run = RunMessages::new(scenario, &Topics::All)?;
    let form = Form {
        encoding,
        ..Form::default()
    };
    let mut writer = McapWriter::new(Vec::new(), scenario, run.telemetry(), form)?;
    while let Some(record) = run.next(|message| Ok::<_, Box<dyn Error>>(writer.write(message)?)) {
        record?;
    }
    Ok(writer.finish(end_entries(&run.end()))?)
}
