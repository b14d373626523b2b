//! Outcomes: summary numbers of a run, the columns of a sweep table.
//!
//! [`outcome`] computes only the outcome and is more than twice as fast as a
//! [`Simulation`](crate::run::simulation::Simulation). [`COLUMNS`] defines the names, units, types and descriptions of
//! the values; Parquet columns, JSON members and documents are derived from it.

use self::Read::{Integer, Number, Text};
use crate::run::scenario::Scenario;
use crate::run::simulation::{
    EventKind, RunEnd, SimulationError, StopReason, Tally, run_without_samples,
};
use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::Serialize;
use serde::ser::{SerializeMap as _, Serializer};
use serde_json::Map;
use std::borrow::Cow;
use std::f64::consts::{FRAC_PI_2, TAU};

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
        // A top that swings may pass the horizontal and come back.
        let passage = if self.end.motion.angles.theta >= FRAC_PI_2 {
            "the top inverted"
        } else {
            "the axis passed the horizontal"
        };
        let inversion = self.end.inversion_time.map_or_else(String::new, |time| {
            format!("{passage} at t = {time:.6} s; ")
        });
        let (end, time) = (self.end.stop.sentence(), self.end.time);
        format!("{inversion}{end} at t = {time:.6} s")
    }

    /// The value of a column, if the column exists and has a value.
    pub fn get(&self, name: &str) -> Option<Cell> {
        let column = COLUMNS.iter().find(|column| column.name == name)?;
        column.value_of(self)
    }
}

/// Serializes as an object with a member for each column that has a value.
impl Serialize for Outcome {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut map = serializer.serialize_map(None)?;
        for column in COLUMNS {
            // Absent rather than null, as in all reports.
            if let Some(cell) = column.value_of(self) {
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
            let schema = match column.read {
                Text(_) => generator.subschema_for::<StopReason>(),
                Integer(_) => generator.subschema_for::<i64>(),
                Number(_) => generator.subschema_for::<f64>(),
            };
            let mut property = schema.to_value();
            property["description"] = column.sentence().into();
            properties.insert(column.name.to_owned(), property);
            if column.null.is_none() {
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

/// Reads the values of a column, which all have one type, or nothing.
#[derive(Clone, Copy, Debug)]
pub enum Read {
    /// Text: Utf8.
    Text(fn(&Outcome) -> Option<&'static str>),
    /// Integers: Int64.
    Integer(fn(&Outcome) -> Option<i64>),
    /// Real numbers: Float64.
    Number(fn(&Outcome) -> Option<f64>),
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
    /// Name.
    pub name: &'static str,
    /// The unit; may be empty.
    pub unit: &'static str,
    /// Description.
    pub meaning: &'static str,
    /// The condition under which the value is null, e.g. "for a fixed peg"; `None` if it never is.
    pub null: Option<&'static str>,
    /// The values and their type.
    pub read: Read,
}

impl Column {
    /// The value in an outcome, if there is one.
    pub fn value_of(&self, outcome: &Outcome) -> Option<Cell> {
        match self.read {
            Text(read) => read(outcome).map(Cell::Text),
            Integer(read) => read(outcome).map(Cell::Integer),
            Number(read) => read(outcome).map(Cell::Number),
        }
    }

    /// The description, and the condition under which the value is null.
    pub fn description(&self) -> String {
        match self.null {
            Some(condition) => format!("{}; null {condition}", self.meaning),
            None => self.meaning.to_owned(),
        }
    }

    /// The description as a sentence, with the unit; a JSON member that would be null is absent.
    fn sentence(&self) -> String {
        // One text serves tables, where it continues a line, and the JSON schema, where it is a sentence.
        let mut letters = self.meaning.chars();
        let first = letters.next().map(char::to_uppercase);
        let mut sentence: String = first.into_iter().flatten().chain(letters).collect();
        if !self.unit.is_empty() {
            sentence += &format!(", {}", self.unit);
        }
        if let Some(condition) = self.null {
            sentence += &format!("; absent {condition}");
        }
        sentence + "."
    }

    /// Sets the condition under which the value is null.
    const fn null(self, condition: &'static str) -> Self {
        Self {
            null: Some(condition),
            ..self
        }
    }
}

const fn column(
    name: &'static str,
    unit: &'static str,
    meaning: &'static str,
    read: Read,
) -> Column {
    Column {
        name,
        unit,
        meaning,
        null: None,
        read,
    }
}

/// A count as a value of an Int64 column; `None` beyond the range of that type.
fn to_int64(count: u64) -> Option<i64> {
    i64::try_from(count).ok()
}

/// Columns of an outcome, in table order.
#[rustfmt::skip]
pub const COLUMNS: &[Column] = &[
    column("stop_reason", "", "reason for the end of the run", Text(|o| Some(o.end.stop.name()))),
    column("stop_time", "s", "end time", Number(|o| Some(o.end.time))),
    column("rise_time", "s", "time at which θ reached stop.theta_risen",
        Number(|o| o.tally.first(EventKind::Risen))).null("if it did not"),
    column("weak_time", "s", "time at which the top became weak (strength ratio below 1)",
        Number(|o| o.tally.first(EventKind::WeakTop))).null("if it did not, or was weak from the start"),
    column("loop_time", "s", "time of the first loop (for a tippe top: of the first reversal of precession)",
        Number(|o| o.tally.first(EventKind::LoopingBegins))).null("if there is none"),
    column("loops", "", "number of loops (for a tippe top: of reversals of precession)", Integer(|o| to_int64(o.tally.count_of(EventKind::LoopingBegins)))),
    column("nutations", "", "number of complete nutation cycles", Integer(|o| to_int64(o.end.nutations))),
    column("theta", "rad", "inclination θ at the end", Number(|o| Some(o.end.motion.angles.theta))),
    column("phi_dot", "rad/s", "precession rate φ̇ at the end", Number(|o| Some(o.end.motion.tilt.rates.phi))),
    column("theta_dot", "rad/s", "nutation rate θ̇ at the end", Number(|o| Some(o.end.motion.tilt.rates.theta))),
    column("psi_dot", "rad/s", "spin rate ψ̇ at the end", Number(|o| Some(o.end.motion.tilt.rates.psi))),
    column("turns", "", "number of turns of precession", Number(|o| Some(o.turns))),
    column("energy_at_start", "J", "total energy at the start", Number(|o| Some(o.end.energy_at_start))),
    column("energy", "J", "total energy at the end", Number(|o| Some(o.end.energy))),
    column("friction_work", "J", "work done by friction, air drag and impacts (normally negative)", Number(|o| Some(o.end.motion.integrals.friction_work))),
    column("slip_path", "m", "length of the slip path of the contact point", Number(|o| Some(o.end.motion.integrals.slip_path))),
    column("roll_time", "s", "time at which the peg first rolled",
        Number(|o| o.tally.first(EventKind::RollBegins))).null("if it did not, or if the peg is fixed"),
    column("inversion_time", "s", "time at which the axis of a tippe top passed the horizontal",
        Number(|o| o.end.inversion_time)).null("otherwise"),
    column("hops", "", "number of hops", Integer(|o| to_int64(o.is_free.then(|| o.tally.count_of(EventKind::LiftOff))?))).null("for a fixed peg"),
    column("impacts", "", "number of impacts on the table", Integer(|o| to_int64(o.is_free.then_some(o.end.impacts)?))).null("for a fixed peg"),
    column("steps", "", "number of integrator steps", Integer(|o| to_int64(o.end.statistics.accepted))),
];
