//! Requests from the page and their responses.

use crate::run::{Run, recording};
use crate::tables::tables;
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::collections::BTreeMap;
use std::error::Error;
use toprise::analysis::diff::{Finding, Options, compare};
use toprise::analysis::explain::{Fact, explain};
use toprise::run::scenario::{Preset, Scenario, ScenarioError};
use toprise::telemetry::encoding::Encoding;

/// A request: an object whose only member is the request name.
#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Question {
    /// The tables of keys and presets, and the names of the columns.
    Tables {},
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
}

/// A scenario: a preset and the keys that are set in it, as on the command line.
#[derive(Deserialize)]
pub struct ScenarioRequest {
    preset: String,
    set: BTreeMap<String, String>,
}

/// State kept between requests.
#[derive(Default)]
pub struct Page {
    pub question: Vec<u8>,
    pub output: String,
    pub file: Vec<u8>,
    run: Option<Run>,
}

impl Page {
    pub fn column(&self, index: usize) -> &[f64] {
        self.run.as_ref().map_or(&[], |run| run.column(index))
    }

    /// Handles the request in the input buffer; returns the response length in bytes.
    pub fn answer(&mut self) -> usize {
        let answer = self.answer_to_question();
        let answer = answer.unwrap_or_else(|error| error_response(&*error));
        self.output = answer.to_string();
        self.output.len()
    }

    fn answer_to_question(&mut self) -> Result<Json, Box<dyn Error>> {
        match serde_json::from_slice(&self.question)? {
            Question::Tables {} => Ok(tables()),
            Question::Start(given) => {
                let scenario = given.scenario()?;
                let top = &scenario.model.top;
                let answer = json!({
                    "title": scenario.title(),
                    "digest": scenario.digest(),
                    "is_free": scenario.model.support.is_free(),
                    "center_distance": top.center_distance,
                    "peg_radius": top.peg_radius,
                    "force": scenario.force_scale(),
                });
                self.run = Some(Run::new(scenario)?);
                Ok(answer)
            }
            Question::Advance { records } => {
                let run = self.run.as_mut().ok_or("no run has been started")?;
                run.advance(records);
                Ok(run.progress())
            }
            Question::Explain(given) => {
                let explanation = explain(&given.scenario()?)?;
                let chapters = explanation.chapters.iter().map(|chapter| {
                    let sentences: Vec<_> = chapter.facts.iter().map(Fact::sentence).collect();
                    json!({ "heading": chapter.heading, "sentences": sentences })
                });
                Ok(chapters.collect())
            }
            Question::Compare { a, b } => {
                let report = compare(&a.scenario()?, &b.scenario()?, &Options::default())?;
                let findings = report.findings.iter().filter(|finding| finding.differs());
                let findings: Vec<_> = findings.map(Finding::cells).collect();
                Ok(json!({ "verdict": report.verdict.title(), "findings": findings }))
            }
            Question::Record { scenario, encoding } => {
                let known = Encoding::ALL
                    .into_iter()
                    .find(|known| known.name() == encoding);
                let encoding = known.ok_or_else(|| format!("there is no encoding {encoding:?}"))?;
                let (file, digest) = recording(&scenario.scenario()?, encoding)?;
                self.file = file;
                Ok(json!({ "length": self.file.len(), "digest": digest }))
            }
        }
    }
}

/// The response to a request that failed: the message, and the key of the scenario that is wrong, if it is one.
fn error_response(error: &(dyn Error + 'static)) -> Json {
    let scenario_error = error.downcast_ref::<ScenarioError>();
    json!({
        "error": error.to_string(),
        "key": scenario_error.and_then(|error| error.key.as_deref()),
    })
}

impl ScenarioRequest {
    fn scenario(&self) -> Result<Scenario, ScenarioError> {
        let mut values = Preset::find(&self.preset).and_then(Preset::values)?;
        for (key, value) in &self.set {
            values.set(key, value)?;
        }
        Scenario::new(values)
    }
}
