//! The runs of a sweep that a map shows, and their outcomes.

use crate::figures::plot::frame::Quantity;
use crate::figures::plot::shape::Colour;
use crate::figures::symbol;
use crate::run::scenario::{KEYS, Key};
use crate::run::simulation::StopReason;
use std::collections::BTreeMap;

/// The name of an absent outcome.
const NO_OUTCOME: &str = "no outcome";

/// Time columns for which a missing value means "not yet" (not those of free pegs).
const AWAITED: [&str; 3] = ["rise_time", "weak_time", "loop_time"];

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

/// The outcome shown for a missing value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ShownOutcome<'a> {
    Stopped(StopReason),
    /// A stop reason of a newer version.
    Unknown(&'a str),
    /// The run failed, or was interrupted.
    Absent,
}

impl MapAxis {
    /// The quantity of an axis: with the symbol of its key, if it has one.
    pub(super) fn quantity(&self) -> Quantity {
        let symbol = self
            .key_with_symbol()
            .map_or_else(|| self.name.replace('_', " "), symbol::markup);
        Quantity {
            symbol: symbol.into(),
            unit: self.unit.clone().into(),
        }
    }

    /// The key with values in the column, and its symbol, unless an earlier key has the same symbol.
    fn key_with_symbol(&self) -> Option<(&'static Key, &'static str)> {
        let key = KEYS.iter().find(|key| self.is_of(key))?;
        let symbol = key.symbol?;
        // No two axes have the same label.
        let first = KEYS.iter().find(|key| key.symbol == Some(symbol))?;
        self.is_of(first).then_some((key, symbol))
    }

    /// Whether the column has the values of a key.
    fn is_of(&self, key: &Key) -> bool {
        key.path.replace('.', "_") == self.name
    }
}

impl MapRun {
    pub(super) fn outcome(&self) -> ShownOutcome<'_> {
        ShownOutcome::new(self.stop.as_deref())
    }
}

impl Map {
    /// The values of all runs.
    pub(super) fn values(&self, value: impl Fn(&MapRun) -> f64) -> Vec<f64> {
        self.runs.iter().map(value).collect()
    }

    /// The outcomes of runs that have no value to show, in the order of their names.
    pub(super) fn outcomes(&self) -> Vec<ShownOutcome<'_>> {
        let mut outcomes = BTreeMap::new();
        for run in &self.runs {
            if !run.color.is_finite() {
                let outcome = run.outcome();
                outcomes.insert(outcome.name(), outcome);
            }
        }
        outcomes.into_values().collect()
    }
}

impl<'a> ShownOutcome<'a> {
    fn new(stop: Option<&'a str>) -> Self {
        let Some(name) = stop else {
            return Self::Absent;
        };
        match StopReason::ALL.iter().find(|stop| stop.name() == name) {
            Some(stop) => Self::Stopped(*stop),
            None => Self::Unknown(name),
        }
    }

    fn name(self) -> &'a str {
        match self {
            Self::Stopped(stop) => stop.name(),
            Self::Unknown(name) => name,
            Self::Absent => NO_OUTCOME,
        }
    }

    /// The colour of runs with this outcome and no value: the same in every figure, and outside the colour map.
    pub(super) fn colour(self) -> Colour {
        match self {
            Self::Stopped(StopReason::Fallen) => Colour(0xd5, 0x5e, 0x00),
            Self::Stopped(StopReason::Duration) => Colour(0xdd, 0xdd, 0xdd),
            Self::Stopped(StopReason::Risen) => Colour(0xcc, 0x79, 0xa7),
            Self::Stopped(StopReason::SlipStopped) => Colour(0x99, 0x99, 0x99),
            Self::Stopped(StopReason::Rest) => Colour(0xa6, 0xce, 0xe3),
            Self::Stopped(StopReason::Singular) => Colour(0x8c, 0x56, 0x4b),
            Self::Stopped(StopReason::Jam) => Colour(0x80, 0x00, 0x20),
            Self::Stopped(StopReason::Pivot) => Colour(0xff, 0xb6, 0xc1),
            Self::Stopped(StopReason::Interrupted | StopReason::Failed) | Self::Absent => {
                Colour(0x30, 0x30, 0x30)
            }
            Self::Unknown(_) => Colour(0xf0, 0xc8, 0xa0),
        }
    }

    /// The outcome in words, where a run has no value in a column.
    pub(super) fn words(self, column: &str) -> String {
        match self {
            // A longer run would have a value.
            Self::Stopped(StopReason::Duration) if AWAITED.contains(&column) => {
                "not reached".to_owned()
            }
            Self::Stopped(StopReason::Duration) => "none in the whole run".to_owned(),
            other => other.name().replace('_', " "),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_awaited_times_are_not_reached() {
        let outcome = ShownOutcome::Stopped(StopReason::Duration);
        assert_eq!(outcome.words("rise_time"), "not reached");
        assert_eq!(outcome.words("hops"), "none in the whole run");
    }

    #[test]
    fn labels_have_symbol_power_and_unit() {
        for (name, unit, exponent, expected) in [
            ("k", "", 0, "k"),
            ("k", "s", 0, "k (s)"),
            ("k", "", -3, "k (10^−3)"),
            ("k", "s", 3, "k (10^3 s)"),
            ("friction_k", "", 0, "k"),
            ("drilling_k", "", 0, "drilling k"),
            ("friction_viscous_speed", "", 0, "v_0"),
            ("initial_psi_dot", "", 0, "ψ\u{307}_0"),
            ("initial_height", "", 0, "initial height"),
            ("stop_theta_risen", "", 0, "stop theta risen"),
            ("rise_time", "", 0, "rise time"),
        ] {
            let axis = MapAxis {
                name: name.to_owned(),
                unit: unit.to_owned(),
            };
            assert_eq!(axis.quantity().text(exponent).spoken, expected);
        }
    }

    #[test]
    fn stop_reasons_have_their_own_colours() {
        let stops = StopReason::ALL.iter().map(|stop| Some(stop.name()));
        let mut colours: Vec<_> = stops
            .chain([None, Some("of a newer version")])
            .map(|stop| format!("{:?}", ShownOutcome::new(stop).colour()))
            .collect();
        colours.sort();
        colours.dedup();
        // Interrupted, failed and absent outcomes share a colour.
        assert_eq!(colours.len(), StopReason::ALL.len());
    }
}
