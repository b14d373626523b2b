//! Further simulations for a comparison, and their sections of the report.

use crate::analysis::diff::{
    ByKey, Effect, KeyChange, KeyPlan, MEASURED, Report, Sensitivity, find_match, sensitivities,
};
use crate::cli::input::OpenRun;
use crate::cli::output;
use crate::cli::progress::Progress;
use crate::run::scenario::Scenario;
use crate::words::{Section, Sentence, Table, counted, sentence};
use anyhow::{Context as _, Error, bail};
use clap::Args;

/// What else to simulate.
#[derive(Args, Clone, Debug, PartialEq)]
pub(super) struct VariationArguments {
    /// Show the part of each changed key in the findings, by simulating A with each change and each pair
    #[arg(long, help_heading = "Comparison")]
    by_key: bool,

    /// Find the value of a key of A with which it comes closest to B, e.g. friction.k
    #[arg(long = "match", value_name = "KEY", help_heading = "Comparison")]
    key: Option<String>,
}

/// The further simulations, with what they need.
#[derive(Debug)]
pub(super) struct VariationPlan {
    arguments: VariationArguments,
    /// Whether sensitivities are computed.
    is_sensitive: bool,
    scenarios: [Option<Scenario>; 2],
}

impl VariationArguments {
    /// Checks that both runs have scenarios if they are needed.
    pub(super) fn plan(
        &self,
        runs: [&OpenRun; 2],
        is_sensitive: bool,
    ) -> Result<VariationPlan, Error> {
        let scenarios = runs.map(|run| run.subject().scenario());
        let has_both = scenarios.iter().all(Option::is_some);
        if (self.by_key || self.key.is_some()) && !has_both {
            bail!("--by-key and --match need the scenarios of both runs");
        }
        Ok(VariationPlan {
            arguments: self.clone(),
            is_sensitive,
            scenarios,
        })
    }
}

impl VariationPlan {
    /// Simulates what was asked for, and adds it to the report.
    pub(super) fn add_to(&self, report: &mut Report) -> Result<(), Error> {
        let [Some(a), Some(b)] = &self.scenarios else {
            return Ok(());
        };
        let progress = Progress::for_state();
        let count = || progress.set_text("simulating".to_owned());
        if self.arguments.by_key {
            let plan = KeyPlan::new(a, b, &report.setup.scenario).context(
                "--by-key needs runs that differ in two keys that can change one after the other",
            )?;
            output::note(&announcement(&plan));
            report.by_key = Some(plan.compute(&report.findings, &count));
        }
        if let Some(key) = &self.arguments.key {
            report.matched = Some(find_match(a, b, key, &count)?);
        }
        if self.is_sensitive {
            report.sensitivities = sensitivities([a, b], &report.findings, &count);
        }
        progress.finish();
        Ok(())
    }
}

/// What will be simulated.
fn announcement(plan: &KeyPlan) -> String {
    let mut changes = Vec::new();
    for change in &plan.changes {
        changes.push(change.keys.join(" and "));
    }
    format!(
        "{}: A with each of {} changes ({}){}",
        counted(plan.runs() as u64, "simulation"),
        changes.len(),
        changes.join("; "),
        if plan.has_pairs() {
            ", and with their pairs"
        } else {
            ""
        }
    )
}

/// The parts of the changes.
pub(super) fn by_key(report: &Report) -> Section {
    let Some(by_key) = &report.by_key else {
        return Section::default();
    };
    let mut header = vec![Sentence::default(), "B − A".into()];
    header.extend(by_key.changes.iter().map(|change| name(change).into()));
    header.push("interaction".into());
    if !by_key.pairs.is_empty() {
        header.push("of a pair at most".into());
    }
    let rows = by_key
        .effects
        .iter()
        .map(|effect| effect_row(effect, by_key));
    let mut section = Section::from(Table {
        header,
        rows: rows.collect(),
        left: 1,
    });
    for line in by_key.changes.iter().flat_map(legend) {
        section.line(line);
    }
    section.titled(
        "Parts of the changes",
        "each alone, or after those named below; the interaction is what they leave; [within the nutation]",
    )
}

fn effect_row(effect: &Effect, by_key: &ByKey) -> Vec<Sentence> {
    let cell = |part: Option<f64>| {
        let part = part.map(|part| effect.above_error(part));
        let text = effect.quantity.cell_of_change(part);
        match part {
            Some(part) if part != 0.0 && effect.is_within_nutation(part) => format!("[{text}]"),
            _ => text,
        }
    };
    let mut row = vec![effect.quantity.label_with_unit()];
    row.push(cell(Some(effect.difference)).into());
    row.extend(effect.parts.iter().map(|part| cell(*part).into()));
    row.push(cell(effect.interaction).into());
    row.extend(
        effect
            .largest_pair(by_key)
            .map(|([one, other], interaction)| {
                let [one, other] = [one, other].map(|at| name(&by_key.changes[at]));
                sentence!("{} ({} × {})", cell(Some(interaction)), one, other)
            }),
    );
    row
}

/// The name of a change: its first key.
fn name(change: &KeyChange) -> String {
    match &change.keys[..] {
        [] => String::new(),
        [key] => key.clone(),
        [key, ..] => format!("{key}…"),
    }
}

/// The further keys of a change, and those before it.
fn legend(change: &KeyChange) -> Vec<String> {
    let mut lines = Vec::new();
    if let [_, further @ ..] = &change.keys[..]
        && !further.is_empty()
    {
        lines.push(format!("{}: with {}", name(change), further.join(", ")));
    }
    if !change.after.is_empty() {
        lines.push(format!(
            "{}: after {}",
            name(change),
            change.after.join(", ")
        ));
    }
    lines
}

/// The value of the matched key.
pub(super) fn matched(report: &Report) -> Section {
    let mut section = Section::default();
    if let Some(matched) = &report.matched {
        section.line(matched.sentence());
    }
    section
}

/// The sensitivities.
pub(super) fn sensitivity(report: &Report) -> Section {
    let mut header = vec![Sentence::default()];
    header.extend(MEASURED.map(|(_, symbol)| symbol.into()));
    let mut section = Section::default();
    section.table(Table {
        header,
        rows: report.sensitivities.iter().map(sensitivity_row).collect(),
        left: 1,
    });
    section.titled(
        "Sensitivity",
        "change of B − A by 1 % of a measured number of both runs",
    )
}

fn sensitivity_row(sensitivity: &Sensitivity) -> Vec<Sentence> {
    let mut row = vec![sensitivity.quantity.label_with_unit()];
    for change in sensitivity.changes {
        row.push(sensitivity.quantity.cell_of_change(change).into());
    }
    row
}
