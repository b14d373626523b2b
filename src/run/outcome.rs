//! Outcomes: summary numbers of a run, the columns of a sweep table.
//!
//! [`outcome`] computes only the outcome and is more than twice as fast as a
//! [`Simulation`](crate::run::simulation::Simulation). [`COLUMNS`] defines the names, units, types and descriptions of
//! the values; Parquet columns, JSON members and documents are derived from it.

use self::ColumnKind::{Integer, Text};
use crate::run::scenario::Scenario;
use crate::run::simulation::{
    EventKind, RunEnd, SimulationError, StopReason, Tally, run_without_samples,
};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::ser::{SerializeMap as _, Serializer};
use serde_json::Map;
use std::borrow::Cow;
use std::f64::consts::TAU;

/// Outcome of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Outcome {
    /// The end of the run.
    pub end: RunEnd,
    /// Number and times of its events.
    pub tally: Tally,
    /// Turns of precession from start to end.
    pub turns: f64,
    /// Whether the peg is free.
    pub is_free: bool,
}

/// Runs a scenario and returns its outcome, bit-identical to [`Outcome::new`] of a complete
/// [`Simulation`](crate::run::simulation::Simulation).
///
/// `carry_on` is called before each integrator step. If it returns false, the run ends as
/// [interrupted](StopReason::Interrupted).
///
/// ```
/// use toprise::run::scenario::Preset;
/// use toprise::run::simulation::EventKind;
///
/// let scenario = Preset::find("paper")?.scenario()?;
/// let outcome = toprise::run::outcome(&scenario, || true)?;
/// assert_eq!(outcome.tally.first(EventKind::Risen).map(f64::round), Some(25.0));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Errors
/// [`SimulationError`] if the motion can't be computed to its end.
pub fn outcome(
    scenario: &Scenario,
    carry_on: impl FnMut() -> bool,
) -> Result<Outcome, SimulationError> {
    let (end, tally) = run_without_samples(scenario, carry_on)?;
    Ok(Outcome::new(scenario, end, tally))
}

impl Outcome {
    /// The outcome of a run of `scenario` with this end and these event counts.
    pub fn new(scenario: &Scenario, end: RunEnd, tally: Tally) -> Self {
        Self {
            turns: (end.motion.angles.phi - scenario.angles.phi) / TAU,
            is_free: scenario.model.support.is_free(),
            end,
            tally,
        }
    }

    /// A sentence about the end of the run and, for a tippe top, its inversion.
    pub fn sentence(&self) -> String {
        let inversion = self.end.inversion_time.map_or_else(String::new, |time| {
            format!("the top has inverted at t = {time:.6} s; ")
        });
        let (end, time) = (self.end.stop.sentence(), self.end.time);
        format!("{inversion}{end} at t = {time:.6} s")
    }

    /// The value of a column, if the column exists and has a value.
    pub fn get(&self, name: &str) -> Option<Cell> {
        let column = COLUMNS.iter().find(|column| column.name == name)?;
        column.of(self)
    }

    /// Time of the first event of a kind, s.
    fn time_of(&self, kind: EventKind) -> Option<Cell> {
        self.tally.first(kind).map(Cell::Number)
    }
}

/// Serializes as an object with a member for each column that has a value.
impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for column in COLUMNS {
            if let Some(cell) = column.of(self) {
                map.serialize_entry(column.name, &cell)?;
            }
        }
        map.end()
    }
}

/// One member per column; columns without a value are omitted.
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
            "description": "Outcome of a run: the columns of a sweep table.",
            "properties": properties,
            "required": required,
        })
    }
}

/// Type of a column's values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Text: Utf8.
    Text,
    /// Integers: Int64.
    Integer,
    /// Real numbers: Float64.
    Number,
}

/// A value in a column.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Cell {
    /// A text.
    Text(&'static str),
    /// An integer.
    Integer(i64),
    /// A real number.
    Number(f64),
}

/// A column of a table of outcomes.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// Its name.
    pub name: &'static str,
    /// The unit; may be empty.
    pub unit: &'static str,
    /// Type of its values.
    pub kind: ColumnKind,
    /// Its description, and the condition under which it is null.
    pub meaning: &'static str,
    read: fn(&Outcome) -> Option<Cell>,
}

impl Column {
    /// Its value in an outcome, if it has one.
    pub fn of(&self, outcome: &Outcome) -> Option<Cell> {
        (self.read)(outcome)
    }

    /// Whether it can be null.
    fn may_be_null(&self) -> bool {
        self.meaning.contains("null")
    }

    /// Its description and unit as a sentence, with `null` replaced.
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

/// Columns of an outcome, in table order.
#[rustfmt::skip]
pub const COLUMNS: &[Column] = &[
    other("stop_reason", Text, "reason for the end of the run", |o| Some(Cell::Text(o.end.stop.name()))),
    number("stop_time", "s", "end time", |o| Some(Cell::Number(o.end.time))),
    number("rise_time", "s", "time at which θ reached stop.theta_risen; null if it did not",
        |o| o.time_of(EventKind::Risen)),
    number("weak_time", "s", "time at which the top became weak (strength ratio below 1); null if it did not, or was weak from the start",
        |o| o.time_of(EventKind::WeakTop)),
    number("loop_time", "s", "time of the first loop (for a tippe top: of the first reversal of precession); null if there is none",
        |o| o.time_of(EventKind::LoopingBegins)),
    other("loops", Integer, "number of loops (for a tippe top: of reversals of precession)", |o| counted(o.tally.number(EventKind::LoopingBegins))),
    other("nutations", Integer, "number of complete nutation cycles", |o| counted(o.end.nutations)),
    number("theta", "rad", "inclination θ at the end", |o| Some(Cell::Number(o.end.motion.angles.theta))),
    number("phi_dot", "rad/s", "precession rate φ̇ at the end", |o| Some(Cell::Number(o.end.motion.tilt.rates.phi))),
    number("theta_dot", "rad/s", "nutation rate θ̇ at the end", |o| Some(Cell::Number(o.end.motion.tilt.rates.theta))),
    number("psi_dot", "rad/s", "spin rate ψ̇ at the end", |o| Some(Cell::Number(o.end.motion.tilt.rates.psi))),
    number("turns", "", "number of turns of precession", |o| Some(Cell::Number(o.turns))),
    number("energy_at_start", "J", "total energy at the start", |o| Some(Cell::Number(o.end.energy_at_start))),
    number("energy", "J", "total energy at the end", |o| Some(Cell::Number(o.end.energy))),
    number("friction_work", "J", "work done by friction and impacts (normally negative)", |o| Some(Cell::Number(o.end.motion.integrals.friction_work))),
    number("slip_path", "m", "length of the slip path of the contact point", |o| Some(Cell::Number(o.end.motion.integrals.slip_path))),
    number("roll_time", "s", "time at which the peg first rolled; null if it did not, or if the peg is fixed",
        |o| o.time_of(EventKind::RollBegins)),
    number("inversion_time", "s", "time at which the axis of a tippe top passed the horizontal; null otherwise",
        |o| o.end.inversion_time.map(Cell::Number)),
    other("hops", Integer, "number of hops; null for a fixed peg", |o| counted(o.is_free.then(|| o.tally.number(EventKind::LiftOff))?)),
    other("impacts", Integer, "number of impacts on the table; null for a fixed peg", |o| counted(o.is_free.then_some(o.end.impacts)?)),
    other("steps", Integer, "number of integrator steps", |o| counted(o.end.statistics.accepted)),
];
