//! The outcome of a run: the few numbers that a table of many runs has of each.
//!
//! [`outcome`] runs a scenario for nothing else, and so more than twice as fast as a [`Simulation`](crate::run::simulation::Simulation).
//! [`COLUMNS`] is the one table of what an outcome consists of: names, units, kinds and meanings of Parquet columns,
//! JSON members and documents follow from it.

use self::ColumnKind::{Integer, Text};
use crate::physics::kinematics::Euler;
use crate::run::scenario::Scenario;
use crate::run::simulation::{EventKind, RunEnd, SimulationError, StopReason, Tally, tallied};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::ser::{Serialize, SerializeMap as _, Serializer};
use serde_json::Map;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Outcome of a run. SI units and radians.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The reason for the run's end.
    pub stop_reason: StopReason,
    /// When, s.
    pub stop_time: f64,
    /// Time of the rise, s: θ fell to `stop.theta_risen`. None if it did not.
    pub rise_time: Option<f64>,
    /// Time at which the spin first became too weak to hold an upright top, s. None if it did not.
    pub weak_time: Option<f64>,
    /// Time of the first loop, s; of a tippe top, of the precession's first turn backward. None if there was none.
    pub loop_time: Option<f64>,
    /// Number of times the axis began to loop; of a tippe top: the precession turned backward.
    pub loops: u64,
    /// Number of whole nutation cycles.
    pub nutations: u64,
    /// Inclination at the end, rad.
    pub theta: f64,
    /// Euler rates at the end, rad/s.
    pub rates: Euler,
    /// Turns of precession from start to end.
    pub turns: f64,
    /// Change of the energy.
    pub energy: EnergyChange,
    /// Path that the contact point slipped, m.
    pub slip_path: f64,
    /// Outcome of a free peg; none for a fixed one.
    pub free: Option<FreeOutcome>,
    /// Steps of the integrator.
    pub steps: u64,
}

/// Change of the energy from start to end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EnergyChange {
    /// Total energy at the start, J.
    pub at_start: f64,
    /// Total energy at the end, J.
    pub at_end: f64,
    /// Work of friction, J: negative where it took energy.
    pub friction_work: f64,
}

/// Outcome of a free peg.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FreeOutcome {
    /// Time at which the peg first began to roll, s. None if it did not.
    pub roll_time: Option<f64>,
    /// Time at which a tippe top inverted, its axis passing the horizontal, s. None if it did not, and of other tops.
    pub inversion_time: Option<f64>,
    /// Number of times the peg left the table.
    pub hops: u64,
    /// Number of impacts on the table.
    pub impacts: u64,
}

/// Runs a scenario to its end and returns the outcome: the same, to the last bit, as [`Outcome::new`] gives for a whole
/// [`Simulation`](crate::run::simulation::Simulation).
///
/// `carry_on` is asked before each step of the integrator, so that it can count steps or watch for an interruption. Once
/// it returns false, the outcome is that of a run which was [interrupted](StopReason::Interrupted).
///
/// ```
/// use toprise::run::scenario::Preset;
///
/// let scenario = Preset::find("paper")?.scenario()?;
/// let outcome = toprise::run::outcome(&scenario, || true)?;
/// assert_eq!(outcome.rise_time.map(f64::round), Some(25.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError`] if the motion can't be computed to its end.
pub fn outcome(
    scenario: &Scenario,
    carry_on: impl FnMut() -> bool,
) -> Result<Outcome, SimulationError> {
    let (end, tally) = tallied(scenario, carry_on)?;
    Ok(Outcome::new(scenario, &end, &tally))
}

impl Outcome {
    /// The outcome of a run of `scenario` that ended so, with these events.
    #[must_use]
    pub fn new(scenario: &Scenario, end: &RunEnd, tally: &Tally) -> Self {
        let motion = &end.motion;
        let is_free = scenario.model.support.is_free();
        Self {
            stop_reason: end.stop,
            stop_time: end.time,
            rise_time: tally.first(EventKind::Risen),
            weak_time: tally.first(EventKind::WeakTop),
            loop_time: tally.first(EventKind::LoopingBegins),
            loops: tally.number(EventKind::LoopingBegins),
            nutations: end.nutations,
            theta: motion.angles.theta,
            rates: motion.tilt.rates,
            turns: (motion.angles.phi - scenario.angles.phi) / TAU,
            energy: EnergyChange {
                at_start: end.energy_at_start,
                at_end: end.energy,
                friction_work: motion.integrals.friction_work,
            },
            slip_path: motion.integrals.slip_path,
            free: is_free.then(|| FreeOutcome {
                roll_time: tally.first(EventKind::RollBegins),
                inversion_time: end.inversion_time,
                hops: tally.number(EventKind::LiftOff),
                impacts: end.impacts,
            }),
            steps: end.statistics.accepted,
        }
    }

    /// The end of the run and, for a tippe top, that it inverted.
    #[must_use]
    pub fn sentence(&self) -> String {
        let inversion = self.free.and_then(|free| free.inversion_time);
        let inversion = inversion.map_or_else(String::new, |time| {
            format!("the top has inverted at t = {time:.6} s; ")
        });
        let (end, time) = (self.stop_reason.sentence(), self.stop_time);
        format!("{inversion}{end} at t = {time:.6} s")
    }

    /// The value in a column, by its name; none if there is none, or no such column.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<Cell> {
        let column = COLUMNS.iter().find(|column| column.name == name)?;
        column.of(self)
    }
}

/// As an object with a member for each column that has a value.
impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for column in COLUMNS {
            match column.of(self) {
                Some(Cell::Text(text)) => map.serialize_entry(column.name, text)?,
                Some(Cell::Integer(number)) => map.serialize_entry(column.name, &number)?,
                Some(Cell::Number(number)) => map.serialize_entry(column.name, &number)?,
                None => {}
            }
        }
        map.end()
    }
}

/// The members are the columns; those that can have no value are absent then.
impl JsonSchema for Outcome {
    fn schema_name() -> Cow<'static, str> {
        "Outcome".into()
    }

    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let mut properties = Map::new();
        let mut required = Vec::new();
        for column in COLUMNS {
            let schema = match column.kind {
                ColumnKind::Text => generator.subschema_for::<StopReason>(),
                ColumnKind::Integer => generator.subschema_for::<i64>(),
                ColumnKind::Number => generator.subschema_for::<f64>(),
            };
            let mut property = schema.to_value();
            property["description"] = column.described("absent").into();
            properties.insert(column.name.to_owned(), property);
            if !column.may_be_null() {
                required.push(column.name);
            }
        }
        json_schema!({
            "type": "object",
            "description": "What happened in a run, and how it ended: the columns of a sweep's table.",
            "properties": properties,
            "required": required,
        })
    }
}

/// Type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Words: Utf8.
    Text,
    /// Whole numbers: Int64.
    Integer,
    /// Real numbers: Float64.
    Number,
}

/// A value in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cell {
    /// A word.
    Text(&'static str),
    /// A whole number.
    Integer(i64),
    /// A real number.
    Number(f64),
}

/// A column of a table of outcomes.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// The unit; empty where there is none.
    pub unit: &'static str,
    /// Type of its values.
    pub kind: ColumnKind,
    /// Its meaning, and when it has no value.
    pub meaning: &'static str,
    read: fn(&Outcome) -> Option<Cell>,
}

impl Column {
    /// Its value in an outcome, if it has one.
    #[must_use]
    pub fn of(&self, outcome: &Outcome) -> Option<Cell> {
        (self.read)(outcome)
    }

    /// Whether it can have no value.
    fn may_be_null(&self) -> bool {
        self.meaning.contains("null")
    }

    /// Its meaning and unit as a sentence, with another word for null.
    fn described(&self, null: &str) -> String {
        let meaning = self.meaning.replace("null", null);
        let (what, unless) = match meaning.split_once(';') {
            Some((what, unless)) => (what, format!(";{unless}")),
            None => (&*meaning, String::new()),
        };
        let unit = match self.unit {
            "" => String::new(),
            unit => format!(", {unit}"),
        };
        let (first, rest) = what.split_at(what.chars().next().map_or(0, char::len_utf8));
        format!("{}{rest}{unit}{unless}.", first.to_uppercase())
    }
}

/// A column of real numbers.
const fn number(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    read: fn(&Outcome) -> Option<Cell>,
) -> Column {
    let kind = ColumnKind::Number;
    Column {
        name,
        unit,
        kind,
        meaning,
        read,
    }
}

/// A column of something without a unit.
const fn other(
    name: &'static str,
    kind: ColumnKind,
    meaning: &'static str,
    read: fn(&Outcome) -> Option<Cell>,
) -> Column {
    Column {
        kind,
        ..number(name, "", meaning, read)
    }
}

fn counted(count: u64) -> Option<Cell> {
    i64::try_from(count).ok().map(Cell::Integer)
}

/// Columns of an outcome, in the order in which tables have it.
#[rustfmt::skip]
pub const COLUMNS: &[Column] = &[
    other("stop_reason", Text, "why the run ended", |o| Some(Cell::Text(o.stop_reason.name()))),
    number("stop_time", "s", "when the run ended", |o| Some(Cell::Number(o.stop_time))),
    number("rise_time", "s", "when the top had risen: θ fell to stop.theta_risen; null if it did not",
        |o| o.rise_time.map(Cell::Number)),
    number("weak_time", "s", "when the spin first became too weak to hold an upright top; null if it did not, or was from the start",
        |o| o.weak_time.map(Cell::Number)),
    number("loop_time", "s", "when the axis first began to loop (of a tippe top: the precession turned backward); null if it did not",
        |o| o.loop_time.map(Cell::Number)),
    other("loops", Integer, "how often the axis began to loop (of a tippe top: the precession turned backward)", |o| counted(o.loops)),
    other("nutations", Integer, "number of whole nutation cycles", |o| counted(o.nutations)),
    number("theta", "rad", "inclination θ at the end", |o| Some(Cell::Number(o.theta))),
    number("phi_dot", "rad/s", "precession rate φ̇ at the end", |o| Some(Cell::Number(o.rates.phi))),
    number("theta_dot", "rad/s", "nutation rate θ̇ at the end", |o| Some(Cell::Number(o.rates.theta))),
    number("psi_dot", "rad/s", "spin rate ψ̇ at the end", |o| Some(Cell::Number(o.rates.psi))),
    number("turns", "", "turns of precession from start to end", |o| Some(Cell::Number(o.turns))),
    number("energy_at_start", "J", "total energy at the start", |o| Some(Cell::Number(o.energy.at_start))),
    number("energy", "J", "total energy at the end", |o| Some(Cell::Number(o.energy.at_end))),
    number("friction_work", "J", "work of friction: negative where it took energy", |o| Some(Cell::Number(o.energy.friction_work))),
    number("slip_path", "m", "path that the contact point slipped", |o| Some(Cell::Number(o.slip_path))),
    number("roll_time", "s", "when the peg first began to roll; null if it did not, and with a fixed peg",
        |o| o.free?.roll_time.map(Cell::Number)),
    number("inversion_time", "s", "when a tippe top inverted: its axis passed the horizontal; null if it did not, and of other tops",
        |o| o.free?.inversion_time.map(Cell::Number)),
    other("hops", Integer, "how often the peg left the table; null with a fixed peg", |o| counted(o.free?.hops)),
    other("impacts", Integer, "number of impacts on the table; null with a fixed peg", |o| counted(o.free?.impacts)),
    other("steps", Integer, "steps of the integrator", |o| counted(o.steps)),
];
