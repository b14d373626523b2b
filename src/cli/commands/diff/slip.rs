//! The slip of both runs: in the report of a comparison, and as a picture.

use crate::analysis::diff::Report;
use crate::analysis::normal_force::NormalForces;
use crate::analysis::slip::SlipComparison;
use crate::archive::publish::Drafts;
use crate::cli::commands::image::Plot;
use crate::cli::input::OpenRun;
use crate::cli::output;
use crate::figures::{LawCurve, draw_laws};
use crate::run::scenario::Scenario;
use crate::telemetry::side::Side;
use crate::words::Section;
use anyhow::{Context as _, Error};

/// What the coefficients of friction do, and the normal forces, if they differ.
pub(super) fn section(report: &Report) -> Section {
    let mut section = Section::default();
    let slip = report.slip.as_ref();
    if let Some(sentence) = slip.and_then(SlipComparison::sentence) {
        section.line(sentence);
    }
    if let Some(sentence) = report
        .normal_forces
        .as_ref()
        .and_then(NormalForces::sentence)
    {
        section.line(sentence);
    }
    section
}

/// The picture of both laws.
pub(super) struct LawPlot {
    plot: Plot,
    scenarios: [Scenario; 2],
}

impl LawPlot {
    /// Checks that both runs have laws to draw.
    pub(super) fn new(plot: Plot, [a, b]: [&OpenRun; 2]) -> Result<Self, Error> {
        Ok(Self {
            plot,
            scenarios: [scenario(a)?, scenario(b)?],
        })
    }

    /// Draws the laws with the slip speeds of their runs.
    pub(super) fn write(&self, report: &Report, drafts: &Drafts) -> Result<(), Error> {
        let slip = report.slip.clone().unwrap_or_default();
        let sides = [(Side::A, &report.a, slip.a), (Side::B, &report.b, slip.b)];
        let mut curves = Vec::new();
        for ((side, run, slip), scenario) in sides.into_iter().zip(&self.scenarios) {
            let curve = LawCurve::new(&run.name, scenario);
            curves.push(curve.for_side(side, slip.as_ref()));
        }
        let file = self.plot.write(drafts, &draw_laws(&curves, Plot::WIDTH))?;
        output::note(&format!("wrote {}", file.line()));
        Ok(())
    }
}

/// The scenario of a run.
fn scenario(run: &OpenRun) -> Result<Scenario, Error> {
    run.subject().scenario().with_context(|| {
        format!(
            "--plot needs the scenarios of both runs, but {} has none that this version can read",
            run.name()
        )
    })
}
