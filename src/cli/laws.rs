//! `toprise laws`.

use super::done::Done;
use super::page::{Page, Section};
use super::report;
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
    /// Its word under `friction.law`, or the section of a scenario that adds it to any law.
    name: &'static str,
    /// Whether it adds to any law of sliding instead of being one.
    adds_to_any: bool,
    /// Force or torque.
    formula: &'static str,
    /// The keys of a scenario that it has.
    parameters: Vec<Parameter>,
    /// Typical values of the parameters.
    typical: &'static str,
    /// Who wrote about it.
    source: &'static str,
}

/// A parameter of a law.
#[derive(Debug, Serialize, JsonSchema)]
struct Parameter {
    /// Its key in a scenario.
    key: &'static str,
    /// Its unit; empty for a pure number.
    unit: &'static str,
    /// Its nature.
    meaning: &'static str,
    /// The values that it may have.
    allowed: String,
}

/// Lists the laws of friction.
pub(super) fn laws() -> Result<Done, Error> {
    let report = LawsReport(LAWS.iter().map(LawReport::of).collect());
    report::print(&report, || report.page())?;
    Ok(Done::Well)
}

impl LawsReport {
    fn page(&self) -> Page {
        let section = |title: &str, adds_to_any: bool| {
            let mut section = Section::new(title);
            for law in self.0.iter().filter(|law| law.adds_to_any == adds_to_any) {
                section.table(law.table());
            }
            section
        };
        let mut symbols = Section::new("Symbols");
        symbols.line(
            "f force, v slip velocity, N normal force, ω angular velocity, ω_⊥ its horizontal part, w_n its part \
             along the symmetry axis n, w_t the rest, M torque about the peg's centre, z′ the vertical, R radius of \
             the peg.",
        );
        Page {
            sections: vec![
                section("Laws of sliding: friction.law is one of them", false),
                section(
                    "Losses that add to any of them, each by keys of its own",
                    true,
                ),
                symbols,
            ],
            ..Page::default()
        }
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
        for Parameter {
            key,
            unit,
            meaning,
            allowed,
        } in &self.parameters
        {
            let unit = if unit.is_empty() {
                String::new()
            } else {
                format!(" [{unit}]")
            };
            add(key, format!("{meaning}{unit}: {allowed}"));
        }
        for (name, text) in [("typical", self.typical), ("source", self.source)] {
            if !text.is_empty() {
                add(name, text.to_owned());
            }
        }
        Table::of_texts(rows)
    }
}
