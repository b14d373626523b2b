//! `toprise laws`.

use crate::cli::report;
use crate::cli::status::Status;
use crate::run::scenario::{Key, LAWS, Law};
use crate::run::suggestion::suggestion;
use crate::words::{Section, Table};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use thiserror::Error;

/// Arguments of `toprise laws`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct LawsArguments {
    /// Law to describe, e.g. viscous
    name: Option<String>,
}

/// A name that no law has.
#[derive(Debug, Error)]
#[error("there is no law {name:?}{}; laws: {}", suggestion(name, LAWS.iter().map(|law| law.name)), LAWS.iter().map(|law| law.name).collect::<Vec<_>>().join(", "))]
struct UnknownLaw {
    name: String,
}

/// The listed laws of friction.
#[derive(Debug, Serialize, JsonSchema)]
pub(super) struct LawsReport(Vec<LawReport>);

/// A law of friction.
#[derive(Debug, Serialize, JsonSchema)]
struct LawReport {
    /// Value of `friction.law`, or the scenario section that enables it.
    name: &'static str,
    /// Whether it is an additional loss rather than a sliding law.
    adds_to_any: bool,
    /// Force or torque.
    formula: &'static str,
    /// Scenario keys of the law.
    parameters: Vec<LawParameter>,
    /// Typical values of the parameters.
    typical: &'static str,
    /// Literature reference.
    source: &'static str,
}

/// A parameter of a law.
#[derive(Debug, Serialize, JsonSchema)]
struct LawParameter {
    /// Key in a scenario.
    key: &'static str,
    /// Unit; empty for a pure number.
    unit: &'static str,
    /// Description.
    meaning: &'static str,
    /// The allowed values.
    allowed: String,
}

/// Lists the laws of friction, or describes one.
pub(super) fn laws(arguments: &LawsArguments) -> Result<Status, anyhow::Error> {
    let mut laws = Vec::new();
    for law in LAWS {
        if arguments.name.as_ref().is_none_or(|name| name == law.name) {
            laws.push(LawReport::new(law));
        }
    }
    if laws.is_empty() {
        let name = arguments.name.clone().unwrap_or_default();
        return Err(UnknownLaw { name }.into());
    }
    let report = LawsReport(laws);
    report::print(&report, || report.page())?;
    Ok(Status::Success)
}

impl LawsReport {
    fn page(&self) -> Vec<Section> {
        let mut symbols = Section::new("Symbols");
        symbols.line(
            "f: friction force, v: slip velocity, N: normal force, ω: angular velocity, ω_⊥: its horizontal part, \
             w_n and w_t: its components along and across the symmetry axis n, M: torque about the peg's centre, \
             z′: the vertical, R: radius of the peg.",
        );
        vec![
            self.section("Sliding friction (friction.law)", false),
            self.section("Additional losses, can be combined with any law", true),
            symbols,
        ]
    }

    fn section(&self, title: &str, adds_to_any: bool) -> Section {
        let mut section = Section::new(title);
        for law in self.0.iter().filter(|law| law.adds_to_any == adds_to_any) {
            section.table(law.table());
        }
        if section.parts.is_empty() {
            return Section::default();
        }
        section
    }
}

impl LawParameter {
    fn new(key: &Key) -> Self {
        Self {
            key: key.path,
            unit: key.unit,
            meaning: key.meaning,
            allowed: key.kind.to_string(),
        }
    }
}

impl LawReport {
    fn new(law: &Law) -> Self {
        Self {
            name: law.name,
            adds_to_any: !law.is_sliding(),
            formula: law.formula,
            parameters: law.parameters().map(LawParameter::new).collect(),
            typical: law.typical,
            source: law.source,
        }
    }

    fn table(&self) -> Table {
        let mut rows = vec![vec![self.name.to_owned(), self.formula.to_owned()]];
        for parameter in &self.parameters {
            let (meaning, allowed) = (parameter.meaning, &parameter.allowed);
            let text = match parameter.unit {
                "" => format!("{meaning}: {allowed}"),
                unit => format!("{meaning} [{unit}]: {allowed}"),
            };
            rows.push(vec![format!("  {}", parameter.key), text]);
        }
        for (name, text) in [("typical", self.typical), ("source", self.source)] {
            if !text.is_empty() {
                rows.push(vec![format!("  {name}"), text.to_owned()]);
            }
        }
        Table::from_texts(rows)
    }
}
