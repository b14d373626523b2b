//! Verification of recordings that are dropped on the page.

use crate::form;
use crate::progress::show_progress;
use crate::request::{comparison, explanation};
use serde::Deserialize;
use serde_json::{Value as Json, json};
use std::cell::Cell;
use std::error::Error;
use std::path::Path;
use toprise::archive::format::CONTENT_DIGEST;
use toprise::archive::recording::Recording;
use toprise::archive::verify;
use toprise::run::scenario::{Preset, Values};

/// The recording in the buffer of files.
#[derive(Deserialize)]
pub struct VerifyRequest {
    /// Name of the file.
    file: String,
}

/// Verifies a recording, explains its run and compares it with the one before.
pub fn verify(
    request: &VerifyRequest,
    content: Vec<u8>,
    before: &mut Option<Recording>,
) -> Result<Json, Box<dyn Error>> {
    let recording = Recording::from_bytes(content, Path::new(&request.file))?;
    let done = Cell::new(0);
    let report = verify::verify(&recording, &|bytes| {
        done.set(done.get() + bytes);
        // A file that differs is read twice.
        let part = done.get() as f64 / (2 * recording.size()) as f64;
        show_progress(&format!("verifying: {:.0} %", 100.0 * part));
    })?;
    show_progress("explaining");
    let explained = explanation(&recording);
    let compared = before.as_ref().map(|before| {
        show_progress("comparing");
        json!({
            "file": before.path().display().to_string(),
            "report": comparison(before, &recording).unwrap_or_else(|error| failure(&*error)),
        })
    });
    let response = json!({
        "report": report,
        "section": report.section(&request.file),
        "digest": recording.end().and_then(|end| end.get(CONTENT_DIGEST)),
        "scenario": recording.scenario_text().ok(),
        "request": scenario_request(&recording),
        "explanation": explained.unwrap_or_else(|error| failure(&*error)),
        "comparison": compared,
    });
    *before = Some(recording);
    Ok(response)
}

fn failure(error: &dyn Error) -> Json {
    json!({ "error": error.to_string() })
}

/// The scenario of a recording as the page asks for one: the preset of its name, or the paper's, and the keys that differ.
fn scenario_request(recording: &Recording) -> Option<Json> {
    let values = Values::from_toml(&recording.scenario_text().ok()?).ok()?;
    let scenario = recording.scenario().ok()?;
    let preset = Preset::find(scenario.name())
        .or_else(|_| Preset::find("paper"))
        .ok()?;
    let set = form::differences(&preset.values().ok()?, &values);
    Some(json!({ "preset": preset.name, "set": set }))
}
