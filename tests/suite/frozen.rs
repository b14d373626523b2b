//! The archives of releases (`tests/archive`): small recordings that every later version verifies and reads.
//!
//! `tests/archive/make` adds the folder of a release, which then never changes.

use crate::compatible::{Use, broken};
use crate::support::{Folder, files, verified};
#[cfg(feature = "sweep")]
use arrow_array::{Array, cast::AsArray as _, types};
#[cfg(feature = "sweep")]
use parquet::arrow::arrow_reader::ParquetRecordBatchReaderBuilder;
use serde_json::Value;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::archive::recording::Recording;
use toprise::archive::verify::{SchemaCheck, Verdict};
#[cfg(feature = "sweep")]
use toprise::run::outcome::{COLUMNS, Cell, outcome};
#[cfg(feature = "sweep")]
use toprise::run::scenario::Scenario;
use toprise::telemetry::fields::{ACCELERATION, ENERGY, EVENTS, STATE};

/// Recordings that were ended before their runs.
const PARTS: [&str; 2] = ["interrupted.mcap", "killed.mcap.partial"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The folders of the releases.
fn releases() -> Vec<PathBuf> {
    let entries = fs::read_dir(root().join("tests/archive")).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let folders: Vec<_> = paths.filter(|path| path.is_dir()).collect();
    assert!(!folders.is_empty(), "there is no archive");
    folders
}

fn json(path: &Path) -> Value {
    let text = fs::read_to_string(path).unwrap();
    serde_json::from_str(&text).unwrap()
}

/// The recordings of all releases with their content digests.
fn recordings() -> Vec<(PathBuf, String)> {
    let mut recordings = Vec::new();
    for release in releases() {
        let digests: BTreeMap<String, String> =
            serde_json::from_value(json(&release.join("digests.json"))).unwrap();
        for (name, digest) in digests {
            recordings.push((release.join(name), digest));
        }
    }
    recordings
}

#[test]
fn regress_verifies_archived_recordings() {
    for (path, digest) in recordings() {
        let report = verified(&path);
        let place = path.display();
        assert_eq!(report.verdict, Verdict::Verified, "{place}: {report:#?}");
        assert_ne!(report.schemas, Some(SchemaCheck::Unknown), "{place}");
        let end = Recording::open(&path).unwrap().end().cloned().unwrap();
        assert_eq!(end["content_digest"], digest, "{place}");
    }
}

#[test]
fn every_archived_recording_is_listed() {
    for release in releases() {
        let listed = json(&release.join("digests.json"));
        for name in files(&release) {
            let is_recording = name.contains(".mcap") && !PARTS.contains(&name.as_str());
            let is_listed = listed.get(&name).is_some();
            assert_eq!(is_listed, is_recording, "{}: {name}", release.display());
        }
    }
}

#[test]
fn verify_exits_with_0_for_archived_recordings() {
    let folder = Folder::new();
    for release in releases() {
        let recordings = recordings().into_iter().map(|(path, _)| path);
        let own = recordings.filter(|path| path.starts_with(&release));
        let mut program = folder.program("verify");
        program.args(own).assert().code(0);
    }
}

#[test]
fn completes_archived_parts() {
    let folder = Folder::new();
    for release in releases() {
        for name in PARTS {
            let part = release.join(name).display().to_string();
            folder.toprise(&format!("verify {part}"), 3);
            folder.toprise(&format!("run {part} -o whole.mcap --force"), 0);
            let report = verified(&folder.at("whole.mcap"));
            assert_eq!(report.verdict, Verdict::Verified, "{part}: {report:#?}");
        }
    }
}

#[test]
fn explains_archived_recordings() {
    let folder = Folder::new();
    let mut explained = 0;
    for (path, _) in recordings() {
        let recording = Recording::open(&path).unwrap();
        let needed = [STATE, ACCELERATION, ENERGY, EVENTS];
        if needed.into_iter().all(|topic| recording.has(topic)) {
            folder.toprise(&format!("explain {}", path.display()), 0);
            explained += 1;
        }
    }
    assert!(explained > 10, "{explained}");
}

#[test]
fn diffs_archived_recordings_with_new_runs() {
    let folder = Folder::new();
    for (path, _) in recordings() {
        let path = path.display();
        folder.toprise(&format!("diff {path} {path}"), 0);
        folder.toprise(&format!("run {path} -o again.mcap --force"), 0);
        folder.toprise(&format!("diff {path} again.mcap"), 0);
    }
}

#[cfg(feature = "rerun")]
#[test]
fn views_archived_recordings() {
    let folder = Folder::new();
    for (path, _) in recordings() {
        folder.toprise(&format!("view {} --rrd a.rrd --force", path.display()), 0);
        assert!(!folder.read("a.rrd").is_empty());
    }
}

/// A cell of a table as the text of its value; numbers with all digits.
#[cfg(feature = "sweep")]
fn cell(column: &dyn Array, row: usize) -> Option<String> {
    if !column.is_valid(row) {
        return None;
    }
    if let Some(numbers) = column.as_primitive_opt::<types::Float64Type>() {
        return Some(format!("{:?}", numbers.value(row)));
    }
    if let Some(integers) = column.as_primitive_opt::<types::Int64Type>() {
        return Some(integers.value(row).to_string());
    }
    Some(column.as_string::<i32>().value(row).to_owned())
}

#[cfg(feature = "sweep")]
#[test]
fn regress_recomputes_archived_sweeps() {
    for release in releases() {
        let path = release.join("sweep.parquet");
        let file = fs::File::open(&path).unwrap();
        let reader = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
        let table = reader.build().unwrap().next().unwrap().unwrap();
        assert_eq!(table.num_rows(), 6);
        let mut compared = 0;
        for row in 0..table.num_rows() {
            let values = toprise::sweep::values_of_row(&path, row as u64).unwrap();
            let outcome = outcome(&Scenario::new(values).unwrap(), || true).unwrap();
            for (field, column) in table.schema().fields().iter().zip(table.columns()) {
                let Some(known) = COLUMNS.iter().find(|known| known.name == field.name()) else {
                    continue;
                };
                let expected = known.value_of(&outcome).map(|value| match value {
                    Cell::Text(text) => text.to_owned(),
                    Cell::Integer(integer) => integer.to_string(),
                    Cell::Number(number) => format!("{number:?}"),
                });
                assert_eq!(cell(column, row), expected, "row {row}, {}", known.name);
                let unit = field.metadata().get("unit").map_or("", String::as_str);
                assert_eq!(unit, known.unit, "{}", known.name);
                compared += 1;
            }
        }
        assert!(compared > 6 * 20, "{compared}");
    }
}

/// Columns of sweeps keep their names.
#[cfg(feature = "sweep")]
#[test]
fn regress_keeps_columns_of_archived_sweeps() {
    for release in releases() {
        let file = fs::File::open(release.join("sweep.parquet")).unwrap();
        let archived = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
        let folder = Folder::new();
        let line = "sweep paper drop --set stop.duration=0.05 --over friction.k=0.01..0.03/3";
        folder.toprise(&format!("{line} -o today.parquet"), 0);
        let file = fs::File::open(folder.at("today.parquet")).unwrap();
        let today = ParquetRecordBatchReaderBuilder::try_new(file).unwrap();
        for field in archived.schema().fields() {
            let found = today.schema().field_with_name(field.name()).cloned();
            assert_eq!(found.unwrap().data_type(), field.data_type());
        }
    }
}

/// Members of 1.0.0's report of fits that were false: a law without a fit had qualities and differences of 1.8e308, which
/// are absent now, and the oddity of an estimated standard deviation, an optional member, was a guess from single values.
const MENDED: [(&str, &str); 4] = [
    ("/$defs/LawFit", "quality"),
    ("/$defs/LawFit", "delta_aic"),
    ("/$defs/LawFit", "delta_bic"),
    ("/$defs/SignalReport", "oddity"),
];

/// Puts the mended members back into a schema of today, as they were.
fn restore_mended(today: &mut Value, archived: &Value) {
    today["$defs"]["Oddity"] = archived["$defs"]["Oddity"].clone();
    for (place, member) in MENDED {
        let (Some(today), Some(archived)) = (today.pointer_mut(place), archived.pointer(place))
        else {
            continue;
        };
        today["properties"][member] = archived["properties"][member].clone();
        let required = archived["required"].as_array().unwrap();
        if required.contains(&member.into()) {
            today["required"]
                .as_array_mut()
                .unwrap()
                .push(member.into());
        }
    }
}

#[test]
fn regress_keeps_what_archived_schemas_have() {
    let folder = Folder::new();
    fs::create_dir(folder.at("today")).unwrap();
    folder.toprise("schema --write today", 0);
    for release in releases() {
        let archived = release.join("schemas");
        let mut compared = 0;
        for name in files(&archived) {
            let usage = match name.as_str() {
                "scenario.json" => Use::Input,
                _ => Use::Output,
            };
            let mut today = folder.at("today").join(&name);
            if !today.exists() {
                // The report of a feature that this build lacks.
                today = root().join("schemas").join(&name);
            }
            let (archived, mut today) = (json(&archived.join(&name)), json(&today));
            if name == "toprise.FitReport.json" {
                restore_mended(&mut today, &archived);
            }
            let broken = broken(&archived, &today, usage);
            assert!(
                broken.is_empty(),
                "{}, {name}: {broken:#?}",
                release.display()
            );
            compared += 1;
        }
        assert!(compared > 20, "{compared}");
    }
}
