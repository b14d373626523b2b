//! Requests from the page and their responses.

use crate::fit::{FitRequest, fit};
use crate::form;
use crate::run::{Run, recording};
use crate::scenario_request::ScenarioRequest;
use crate::tables::tables;
use crate::verify::{VerifyRequest, verify};
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::error::Error;
use std::mem::take;
use toprise::analysis::diff::{Agreement, Finding, Options, compare};
use toprise::analysis::explain::{Chapter, explain};
use toprise::analysis::subject::Subject;
use toprise::archive::recording::Recording;
use toprise::fit::FitError;
use toprise::run::scenario::{Preset, Scenario, ScenarioError};
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::proportions::Proportions;

/// A request: an object whose only member is the request name.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Request {
    /// The table of presets, and the names of the columns.
    Tables {},
    /// The keys that can be set in a scenario, and their ranges.
    Form(ScenarioRequest),
    /// A scenario with a key changed, and others that the change requires.
    Change {
        scenario: ScenarioRequest,
        key: String,
        value: String,
    },
    /// Starts a run; an error if the scenario is wrong.
    Start(ScenarioRequest),
    /// Simulates some more records of the run.
    Advance { records: usize },
    /// The sentences of `toprise explain` on a scenario.
    Explain(ScenarioRequest),
    /// The findings of `toprise diff` for two scenarios.
    Compare {
        a: ScenarioRequest,
        b: ScenarioRequest,
    },
    /// Records a scenario into memory.
    Record {
        scenario: ScenarioRequest,
        encoding: String,
    },
    /// Fits a scenario to the file in the buffer of files.
    Fit(FitRequest),
    /// Verifies the recording in the buffer of files, and compares it with the one before.
    Verify(VerifyRequest),
}

/// State kept between requests.
#[derive(Default)]
pub struct Page {
    pub input: Vec<u8>,
    pub output: String,
    pub file: Vec<u8>,
    /// Content of the file that the next request reads.
    pub given: Vec<u8>,
    run: Option<Run>,
    /// The recording that was verified last.
    verified: Option<Recording>,
}

impl Page {
    pub fn column(&self, index: usize) -> &[f64] {
        self.run.as_ref().map_or(&[], |run| run.column(index))
    }

    /// Handles the request in the input buffer; returns the response length in bytes.
    pub fn respond(&mut self) -> usize {
        let response = self
            .handle()
            .unwrap_or_else(|error| error_response(&*error));
        self.output = response.to_string();
        self.output.len()
    }

    fn handle(&mut self) -> Result<Json, Box<dyn Error>> {
        match serde_json::from_slice(&self.input)? {
            Request::Tables {} => Ok(tables()),
            Request::Form(request) => Ok(form::keys(&request.values()?)),
            Request::Change {
                scenario,
                key,
                value,
            } => {
                let mut values = scenario.values()?;
                values.change(&key, &value)?;
                Ok(json!({ "set": form::differences(&scenario.preset()?, &values) }))
            }
            Request::Start(request) => {
                let scenario = request.scenario()?;
                let description = describe(&scenario, &request)?;
                self.run = Some(Run::new(scenario)?);
                Ok(description)
            }
            Request::Advance { records } => {
                let run = self.run.as_mut().ok_or("no run has been started")?;
                run.advance(records);
                Ok(run.progress())
            }
            Request::Explain(request) => explanation(&request.scenario()?),
            Request::Compare { a, b } => comparison(&a.scenario()?, &b.scenario()?),
            Request::Record { scenario, encoding } => {
                let encoding = Encoding::ALL
                    .into_iter()
                    .find(|known| known.name() == encoding)
                    .ok_or_else(|| format!("there is no encoding {encoding:?}"))?;
                let (file, digest) = recording(&scenario.scenario()?, encoding)?;
                self.file = file;
                Ok(json!({ "length": self.file.len(), "digest": digest }))
            }
            Request::Fit(request) => fit(&request, &self.given),
            Request::Verify(request) => verify(&request, take(&mut self.given), &mut self.verified),
        }
    }
}

/// The response to a request that failed: the message, its pieces if it has some, and the key of the scenario that is wrong,
/// if it is one.
fn error_response(error: &(dyn Error + 'static)) -> Json {
    let scenario_error = error.downcast_ref::<ScenarioError>();
    json!({
        "error": error.to_string(),
        "sentence": error.downcast_ref::<FitError>().map(FitError::sentence),
        "key": scenario_error.and_then(|error| error.key.as_deref()),
    })
}

/// Description of a scenario before its run.
fn describe(scenario: &Scenario, request: &ScenarioRequest) -> Result<Json, ScenarioError> {
    let top = &scenario.model.top;
    let shape = Proportions::new(top);
    Ok(json!({
        "title": Preset::find(&request.preset)?.title,
        "file": scenario.file_stem(scenario.name(), &request.preset()?),
        "digest": scenario.digest(),
        "is_free": scenario.model.support.is_free(),
        "is_frictionless": scenario.is_frictionless(),
        "top": {
            "weight": top.weight(),
            "gravity": top.gravity,
            "axial_moment": top.axial_moment,
            "peg_radius": top.peg_radius,
        },
        "shape": {
            "is_ball": shape.is_ball,
            "peg": shape.peg,
            "disc_height": shape.disc_height,
            "disc_radius": shape.disc_radius,
            "thickness": shape.thickness(),
            "stem_radius": shape.stem_radius,
            "shoulder": shape.shoulder(),
            "neck": shape.neck(),
            "cut": shape.cut(),
            "tip": shape.tip,
            "size": shape.size(),
        },
        "keys": form::keys(&request.values()?),
    }))
}

/// The explanation of a run: a paragraph on its causes, and the sections of its chapters.
pub fn explanation<'a>(subject: impl Into<Subject<'a>>) -> Result<Json, Box<dyn Error>> {
    let explanation = explain(subject)?;
    let chapters: Vec<_> = explanation.chapters.iter().map(Chapter::section).collect();
    Ok(json!({ "story": explanation.story.paragraph(), "chapters": chapters }))
}

/// The comparison of two runs: its headline, findings and remarks.
pub fn comparison<'a>(
    a: impl Into<Subject<'a>>,
    b: impl Into<Subject<'a>>,
) -> Result<Json, Box<dyn Error>> {
    let report = compare(a, b, &Options::default())?;
    let differing = report.differing().map(Finding::cells);
    let losses = [("A", &report.a.losses), ("B", &report.b.losses)].into_iter();
    let losses =
        losses.flat_map(|(name, losses)| losses.iter().map(move |loss| format!("{name}: {loss}.")));
    let equal = report.findings.iter().filter(|finding| !finding.differs());
    let equal = equal.map(Finding::cells_of_equal);
    Ok(json!({
        "headline": report.headline(),
        "agreement": report.agreement.map(Agreement::sentence),
        "findings": differing.collect::<Vec<_>>(),
        "losses": losses.collect::<Vec<_>>(),
        "remarks": report.remarks().collect::<Vec<_>>(),
        "equal": equal.collect::<Vec<_>>(),
    }))
}
