//! The runs of a sweep that a map shows, and their outcomes.

use crate::figures::plot::frame::Quantity;
use crate::figures::plot::shape::Colour;
use crate::run::scenario::{KEYS, Key};
use crate::run::simulation::StopReason;
use std::collections::BTreeSet;

/// A quantity of a map.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapAxis {
    /// The name of its column.
    pub name: String,
    /// The unit; empty where there is none.
    pub unit: String,
}

/// A run of a map. Values that are absent are NaN.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MapRun {
    /// The x value.
    pub x: f64,
    /// The y value; ignored without a y axis.
    pub y: f64,
    /// The value shown as colour or curve.
    pub color: f64,
    /// The reason why the run stopped; `None` where it has no outcome.
    pub stop: Option<String>,
    /// Whether the axis looped; `None` where that is not known.
    pub loops: Option<bool>,
    /// The scenario: each has a curve of its own.
    pub scenario: String,
}

/// A map of a sweep: its quantities and its runs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Map {
    /// The quantity on the x axis.
    pub x: MapAxis,
    /// The quantity on the y axis; `None` for curves.
    pub y: Option<MapAxis>,
    /// The quantity shown as colours or curves.
    pub color: MapAxis,
    /// The runs.
    pub runs: Vec<MapRun>,
}

const NO_OUTCOME: &str = "no outcome";

/// Time columns for which a missing value means "not yet" (not those of free pegs).
const AWAITED: [&str; 3] = ["rise_time", "weak_time", "loop_time"];

impl MapAxis {
    /// The quantity of an axis: with the symbol of its key, if it has one.
    pub(super) fn quantity(&self) -> Quantity {
        let symbol = self.symbol();
        Quantity {
            symbol: symbol.unwrap_or_else(|| self.name.replace('_', " ")).into(),
            unit: self.unit.clone().into(),
        }
    }

    fn symbol(&self) -> Option<String> {
        let is_own = |key: &&Key| key.path.replace('.', "_") == self.name;
        let symbol = KEYS.iter().find(is_own)?.symbol()?;
        // If two keys share a symbol, only the first uses it.
        let mut of_symbol = KEYS.iter().filter(|key| key.symbol() == Some(symbol));
        let key = of_symbol.next().filter(is_own)?;
        let (letter, index) = symbol.split_once('_').unwrap_or((symbol, ""));
        let is_initial = key.path.starts_with("initial.");
        Some(match if is_initial { "0" } else { index } {
            "" => format!("*{letter}*"),
            index => format!("*{letter}*_{{{index}}}"),
        })
    }
}

impl MapRun {
    /// The outcome shown for a missing value.
    pub(super) fn outcome(&self) -> &str {
        self.stop.as_deref().unwrap_or(NO_OUTCOME)
    }
}

impl Map {
    /// The values of all runs.
    pub(super) fn values(&self, value: impl Fn(&MapRun) -> f64) -> Vec<f64> {
        self.runs.iter().map(value).collect()
    }

    /// The outcomes of runs that have no value to show, in words and with their colours, in the order of their names.
    pub(super) fn outcomes(&self) -> Vec<(String, Colour)> {
        let valueless = self.runs.iter().filter(|run| !run.color.is_finite());
        let outcomes: BTreeSet<_> = valueless.map(MapRun::outcome).collect();
        let column = self.color.name.as_str();
        let words = |outcome| (outcome_words(outcome, column), outcome_colour(outcome));
        outcomes.into_iter().map(words).collect()
    }
}

/// The colour of runs with this outcome and no value: the same in every figure, and outside the colour map.
pub(super) fn outcome_colour(outcome: &str) -> Colour {
    let stop = StopReason::ALL.iter().find(|stop| stop.name() == outcome);
    match stop {
        Some(StopReason::Fallen) => Colour(0xd5, 0x5e, 0x00),
        Some(StopReason::Duration) => Colour(0xdd, 0xdd, 0xdd),
        Some(StopReason::Risen) => Colour(0xcc, 0x79, 0xa7),
        Some(StopReason::SlipStopped) => Colour(0x99, 0x99, 0x99),
        Some(StopReason::Rest) => Colour(0xa6, 0xce, 0xe3),
        Some(StopReason::Singular) => Colour(0x8c, 0x56, 0x4b),
        Some(StopReason::Jam) => Colour(0x80, 0x00, 0x20),
        Some(StopReason::Pivot) => Colour(0xff, 0xb6, 0xc1),
        Some(StopReason::Interrupted | StopReason::Failed) => Colour(0x30, 0x30, 0x30),
        None if outcome == NO_OUTCOME => Colour(0x30, 0x30, 0x30),
        // A stop reason of a newer version.
        None => Colour(0xf0, 0xc8, 0xa0),
    }
}

/// A human-readable outcome, where a run has no value in a column.
fn outcome_words(outcome: &str, column: &str) -> String {
    match outcome {
        "duration" if AWAITED.contains(&column) => "not reached".to_owned(),
        "duration" => "none in the whole run".to_owned(),
        other => other.replace('_', " "),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_column_can_never_have_is_not_called_late() {
        let words = |column| outcome_words("duration", column);
        assert_eq!(words("rise_time"), "not reached");
        assert_eq!(words("hops"), "none in the whole run");
    }

    #[test]
    fn labels_have_power_and_unit_where_there_are_any() {
        let label = |unit: &str, exponent| {
            let (name, unit) = ("k".to_owned(), unit.to_owned());
            MapAxis { name, unit }.quantity().text(exponent).spoken
        };
        assert_eq!(label("", 0), "k");
        assert_eq!(label("s", 0), "k (s)");
        assert_eq!(label("", -3), "k (10^−3)");
        assert_eq!(label("s", 3), "k (10^3 s)");
        let label = |name: &str| {
            let (name, unit) = (name.to_owned(), String::new());
            MapAxis { name, unit }.quantity().text(0).spoken
        };
        assert_eq!(label("friction_k"), "k");
        assert_eq!(label("drilling_k"), "drilling k");
        assert_eq!(label("friction_viscous_speed"), "v_0");
        assert_eq!(label("initial_psi_dot"), "ψ\u{307}_0");
        assert_eq!(label("initial_height"), "initial height");
        assert_eq!(label("stop_theta_risen"), "stop theta risen");
        assert_eq!(label("rise_time"), "rise time");
    }

    #[test]
    fn a_reason_to_stop_has_a_colour_of_its_own() {
        let all = StopReason::ALL.iter().map(|stop| stop.name());
        let mut all: Vec<_> = all
            .chain([NO_OUTCOME, "of a newer version"])
            .map(|outcome| format!("{:?}", outcome_colour(outcome)))
            .collect();
        all.sort();
        all.dedup();
        // Those that leave no outcome share a colour.
        assert_eq!(all.len(), StopReason::ALL.len());
    }
}
