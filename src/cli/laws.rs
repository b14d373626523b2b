//! `toprise laws`.

use super::page::Section;
use super::report;
use super::status::Status;
use super::table::Table;
use crate::run::scenario::{Key, LAWS, Law};
use anyhow::Error;
use schemars::JsonSchema;
use serde::Serialize;

/// All laws of friction.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct LawsReport(Vec<LawReport>);

/// A law of friction.
#[derive(Debug, Serialize, JsonSchema)]
struct LawReport {
    /// Its value of `friction.law`, or the scenario section that enables it.
    name: &'static str,
    /// Whether it is an additional loss rather than a sliding law.
    adds_to_any: bool,
    /// Force or torque.
    formula: &'static str,
    /// Its scenario keys.
    parameters: Vec<Parameter>,
    /// Typical values of the parameters.
    typical: &'static str,
    /// Literature reference.
    source: &'static str,
}

/// A parameter of a law.
#[derive(Debug, Serialize, JsonSchema)]
struct Parameter {
    /// Its key in a scenario.
    key: &'static str,
    /// Its unit; empty for a pure number.
    unit: &'static str,
    /// Its description.
    meaning: &'static str,
    /// The allowed values.
    allowed: String,
}

/// Lists the laws of friction.
pub(super) fn laws() -> Result<Status, Error> {
    let report = LawsReport(LAWS.iter().map(LawReport::of).collect());
    report::print(&report, || report.page())?;
    Ok(Status::Success)
}

impl LawsReport {
    fn page(&self) -> Vec<Section> {
        let section = |title: &str, adds_to_any: bool| {
            let mut section = Section::new(title);
            for law in self.0.iter().filter(|law| law.adds_to_any == adds_to_any) {
                section.table(law.table());
            }
            section
        };
        let mut symbols = Section::new("Symbols");
        symbols.line(
            "f: friction force, v: slip velocity, N: normal force, ω: angular velocity, ω_⊥: its horizontal part, \
             w_n and w_t: its components along and across the symmetry axis n, M: torque about the peg's centre, \
             z′: the vertical, R: radius of the peg.",
        );
        vec![
            section("Sliding friction (friction.law)", false),
            section("Additional losses, can be combined with any law", true),
            symbols,
        ]
    }
}

impl LawReport {
    fn of(law: &Law) -> Self {
        let parameter = |key: &Key| Parameter {
            key: key.path,
            unit: key.unit,
            meaning: key.meaning,
            allowed: key.kind.to_string(),
        };
        Self {
            name: law.name,
            adds_to_any: !law.is_sliding(),
            formula: law.formula,
            parameters: law.parameters().map(parameter).collect(),
            typical: law.typical,
            source: law.source,
        }
    }

    fn table(&self) -> Table {
        let mut rows = vec![vec![self.name.to_owned(), self.formula.to_owned()]];
        let mut add = |left: &str, right: String| rows.push(vec![format!("  {left}"), right]);
        for parameter in &self.parameters {
            let (meaning, allowed) = (parameter.meaning, &parameter.allowed);
            let text = match parameter.unit {
                "" => format!("{meaning}: {allowed}"),
                unit => format!("{meaning} [{unit}]: {allowed}"),
            };
            add(parameter.key, text);
        }
        for (name, text) in [("typical", self.typical), ("source", self.source)] {
            if !text.is_empty() {
                add(name, text.to_owned());
            }
        }
        Table::of_texts(rows)
    }
}
