//! `toprise laws`.

use super::image::Plot;
use crate::archive::input::{Input, InputError};
use crate::archive::publish::{Drafts, Existing};
use crate::cli::arguments::OUTPUT;
use crate::cli::input::{checked, run_name};
use crate::cli::report::{self, WrittenFile};
use crate::cli::status::Status;
use crate::figures::{LawCurve, draw_laws};
use crate::run::scenario::{Key, LAWS, Law, Preset, Scenario};
use crate::run::suggestion::suggestion;
use crate::words::{Section, Table};
use anyhow::{Error, bail};
use clap::Args;
use schemars::JsonSchema;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// Arguments of `toprise laws`.
#[derive(Args, Debug, Default, PartialEq)]
pub(in crate::cli) struct LawsArguments {
    /// Laws to describe, e.g. viscous; or scenario files, recordings and presets, for their laws
    #[arg(value_name = "LAW")]
    laws: Vec<PathBuf>,

    /// Draw the coefficient of friction of each against the slip speed, as SVG or PNG
    #[arg(long, value_name = "FILE", requires = "laws", help_heading = OUTPUT)]
    plot: Option<PathBuf>,

    /// Overwrite existing files
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// The law that a word names.
enum NamedLaw {
    /// A law of the table.
    Law(&'static Law),
    /// The law of a scenario.
    Scenario {
        name: String,
        scenario: Box<Scenario>,
    },
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

/// Lists the laws of friction, or describes and draws some.
pub(super) fn laws(arguments: &LawsArguments, drafts: &Drafts) -> Result<Status, Error> {
    let plot = match &arguments.plot {
        Some(path) => {
            let existing = Existing::forced(arguments.force);
            Some(Plot::new(path, existing, &arguments.laws)?)
        }
        None => None,
    };
    let mut named = Vec::new();
    for word in &arguments.laws {
        named.push(NamedLaw::find(word)?);
    }
    let written = match plot {
        Some(plot) => Some(draw(&named, &plot, drafts)?),
        None => None,
    };
    let mut laws = Vec::new();
    for law in LAWS {
        if named.is_empty() || named.iter().any(|other| other.name() == law.name) {
            laws.push(LawReport::new(law));
        }
    }
    let report = LawsReport(laws);
    report::print(&report, || {
        let mut page = report.page();
        page.extend(written.map(|file| written_section(&file)));
        page
    })?;
    Ok(Status::Success)
}

/// Draws laws.
fn draw(laws: &[NamedLaw], plot: &Plot, drafts: &Drafts) -> Result<WrittenFile, Error> {
    let mut curves = Vec::new();
    for law in laws {
        curves.push(law.curve()?);
    }
    plot.write(drafts, &draw_laws(&curves, Plot::WIDTH))
}

/// The file that was written.
fn written_section(file: &WrittenFile) -> Section {
    Section::from(Table::from_facts([("wrote", file.line())]))
}

impl NamedLaw {
    /// The law of this name, or that of a scenario, a recording or a preset. Some presets have the name of their law.
    fn find(word: &Path) -> Result<Self, Error> {
        if let Some(law) = LAWS.iter().find(|law| word.as_os_str() == law.name) {
            return Ok(Self::Law(law));
        }
        let input = match Input::open(word) {
            Ok(input) => input,
            Err(InputError::UnknownPreset(_)) => {
                let name = word.display().to_string();
                let laws: Vec<&str> = LAWS.iter().map(|law| law.name).collect();
                bail!(
                    "there is no law {name:?}{}; laws: {}",
                    suggestion(&name, laws.iter().copied()),
                    laws.join(", ")
                );
            }
            Err(error) => return Err(error.into()),
        };
        let scenario = checked(&input, input.values()?, &[])?;
        Ok(Self::Scenario {
            name: run_name(&input, &scenario, &[]),
            scenario: Box::new(scenario),
        })
    }

    /// The name of the law.
    fn name(&self) -> &str {
        match self {
            Self::Law(law) => law.name,
            Self::Scenario { scenario, .. } => scenario.word("friction.law"),
        }
    }

    /// The curve of the law. One of the table has the usual parameters, and the motion of the paper's top.
    fn curve(&self) -> Result<LawCurve, Error> {
        match self {
            Self::Scenario { name, scenario } => Ok(LawCurve::new(name, scenario)),
            Self::Law(law) if law.is_sliding() => {
                let mut values = Preset::find("paper")?.values()?;
                values.change("friction.law", law.name)?;
                Ok(LawCurve::new(law.name, &Scenario::new(values)?))
            }
            Self::Law(law) => bail!(
                "{} is an additional loss, which has no coefficient of friction against the slip speed",
                law.name
            ),
        }
    }
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
