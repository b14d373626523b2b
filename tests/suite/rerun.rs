//! The Rerun stream, as far as it can be tested without a viewer.

use crate::support::{Folder, assert_contains, in_memory, printed, scenario};
use rerun::external::re_log_encoding::DecoderApp;
use rerun::external::re_log_types::LogMsg;
use rerun::log::Chunk;
use std::collections::BTreeMap;
use std::fs;
use std::net::TcpListener;
use std::process::{Command, Output};
use std::thread;
use std::time::{Duration, Instant};
use toprise::archive::recording::Overview;
#[cfg(feature = "fit")]
use toprise::run::simulation::sample_at;
use toprise::telemetry::fields::{ACCELERATION, NUTATION, acceleration, nutation};

#[test]
fn run_writes_mcap_and_rrd() {
    let folder = Folder::new();
    let text = folder.toprise("run --set stop.duration=0.3", 0).stdout;
    assert_contains(&text, "rerun recordings/paper_duration0.3.rrd");
    let bytes = folder.read("recordings/paper_duration0.3.rrd");
    assert_eq!(&bytes[..4], b"RRF2");
    let partial = folder.at("recordings/paper_duration0.3.rrd.partial");
    assert!(!partial.exists());
}

#[test]
fn missing_viewer_is_a_warning() {
    let folder = Folder::new();
    let started = Instant::now();
    // Nothing listens on the discard port.
    let viewer = "--connect=rerun+http://127.0.0.1:9/proxy";
    let line = format!("run --set stop.duration=0.3 -o a.mcap {viewer}");
    let mut program = folder.program(&line);
    let warning = printed(program.timeout(Duration::from_mins(1)), &line, 0).stderr;
    assert_contains(&warning, "warning");
    assert_contains(&warning, "127.0.0.1:9");
    assert!(started.elapsed() < Duration::from_secs(30));
    let archive = Overview::read(&folder.at("a.mcap")).unwrap();
    assert!(archive.is_whole());
}

/// The chunks of an `.rrd` file, in order.
fn chunks(bytes: &[u8]) -> Vec<Chunk> {
    DecoderApp::decode_eager(bytes)
        .unwrap()
        .filter_map(|message| match message.unwrap() {
            LogMsg::ArrowMsg(_, message) => Some(Chunk::from_arrow_msg(&message).unwrap()),
            _ => None,
        })
        .collect()
}

#[test]
fn chunks_are_reproducible() {
    let folder = Folder::new();
    // The stem of the file is the name in the viewer, so it is the same for all.
    for (name, pace) in [("first", ""), ("second", ""), ("paced", "--realtime")] {
        let outputs = format!("-o {name}/run.mcap --rrd {name}/run.rrd");
        let line = format!("run --set stop.duration=0.3 {outputs} {pace}");
        folder.toprise(&line, 0);
    }
    folder.toprise("view first/run.mcap --rrd replayed/run.rrd", 0);
    let expected = chunks(&folder.read("first/run.rrd"));
    assert!(expected.len() > 50);
    for name in ["second", "paced", "replayed"] {
        let found = chunks(&folder.read(format!("{name}/run.rrd")));
        assert_eq!(found.len(), expected.len(), "{name}");
        for (found, expected) in found.iter().zip(&expected) {
            // Not assert_eq, which would print the chunks.
            assert!(found == expected, "{name}: {}", expected.entity_path());
        }
    }
}

#[test]
fn whole_runs_have_outcome_properties() {
    let folder = Folder::new();
    let outcomes = |arguments: &str, rrd: &str| {
        folder.toprise(&format!("{arguments} --rrd {rrd}"), 0);
        let bytes = folder.read(rrd);
        chunks(&bytes)
            .iter()
            .filter(|chunk| chunk.entity_path().to_string() == "/__properties/outcome")
            .count()
    };
    let run = "run --set stop.duration=0.1 -o a.mcap";
    assert_eq!(outcomes(run, "a.rrd"), 1);
    assert_eq!(outcomes("view a.mcap", "whole.rrd"), 1);
    // What came of a run is not what came of a part of it.
    assert_eq!(outcomes("view a.mcap --to 0.05", "part.rrd"), 0);
}

#[test]
fn first_page_says_why_the_top_rises() {
    let folder = Folder::new();
    folder.toprise("run paper -o paper.mcap --rrd paper.rrd", 0);
    let explained = folder.toprise("explain paper.mcap --format json", 0).stdout;
    let explained: serde_json::Value = serde_json::from_str(&explained).unwrap();
    assert!(!explained["story"]["claims"].as_array().unwrap().is_empty());
    let bytes = folder.read("paper.rrd");
    let about = about(&bytes);
    let (first, rest) = about.split_once("\n\n").unwrap();
    assert_contains(first, "d²θ/dt² is negative");
    assert_contains(rest, "# paper");
}

#[test]
fn every_part_of_the_layout_has_one_container() {
    let folder = Folder::new();
    for preset in ["paper", "free-viscous", "tippe-top"] {
        folder.toprise(
            &format!("run {preset} --set stop.duration=0.3 -o a.mcap --rrd a.rrd --force"),
            0,
        );
        // The content of each container in the end; `None` for other parts.
        let mut parts: BTreeMap<String, Option<Vec<String>>> = BTreeMap::new();
        for chunk in chunks(&folder.read("a.rrd")) {
            let path = chunk.entity_path().to_string();
            let is_part = path.starts_with("/view/") || path.starts_with("/container/");
            if !is_part || path.matches('/').count() > 2 {
                continue;
            }
            let contents: Vec<String> = chunk
                .iter_slices::<String>("ContainerBlueprint:contents".into())
                .flatten()
                .map(|part| format!("/{part}"))
                .collect();
            let is_cleared = chunk
                .components_identifiers()
                .any(|name| name.as_str() == "Clear:is_recursive");
            if is_cleared {
                parts.remove(&path);
            } else {
                parts.insert(path, (!contents.is_empty()).then_some(contents));
            }
        }
        let mut listed: Vec<&String> = parts.values().flatten().flatten().collect();
        listed.sort();
        // All but the one that fills the window.
        assert_eq!(listed.len(), parts.len() - 1, "{preset}");
        listed.dedup();
        assert_eq!(
            listed.len(),
            parts.len() - 1,
            "{preset}: one is listed twice"
        );
        assert!(
            listed.iter().all(|part| parts.contains_key(*part)),
            "{preset}"
        );
    }
}

/// What an `.rrd` file says about its run in the end.
fn about(bytes: &[u8]) -> String {
    chunks(bytes)
        .iter()
        .filter(|chunk| chunk.entity_path().to_string() == "/about")
        .flat_map(|chunk| {
            chunk
                .iter_slices::<String>("TextDocument:text".into())
                .flatten()
                .map(|text| text.to_string())
                .collect::<Vec<_>>()
        })
        .last()
        .unwrap()
}

/// The number of rows with a time in an `.rrd` file, with those of its layout.
fn count_rows(bytes: &[u8]) -> usize {
    chunks(bytes)
        .iter()
        .filter(|chunk| !chunk.is_static())
        .map(Chunk::num_rows)
        .sum()
}

/// The importer's result for these arguments in a folder.
fn import(folder: &Folder, arguments: &str) -> Output {
    Command::new(env!("CARGO_BIN_EXE_rerun-importer-toprise"))
        .args(arguments.split_whitespace())
        .current_dir(folder.at(""))
        .output()
        .unwrap()
}

#[test]
fn importer_streams_the_run() {
    let folder = Folder::new();
    let scenario = folder.toprise("presets paper", 0).stdout;
    let scenario = scenario.replace("duration = 25", "duration = 0.3");
    fs::write(folder.at("mine.toml"), scenario).unwrap();
    let names = "--application-id app --recording-id rec";
    let imported = import(&folder, &format!("mine.toml {names}"));
    assert!(imported.status.success(), "{imported:?}");
    let messages: Vec<_> = DecoderApp::decode_eager(&imported.stdout[..])
        .unwrap()
        .map(Result::unwrap)
        .collect();
    let stores: Vec<_> = messages
        .iter()
        .filter_map(|message| match message {
            LogMsg::SetStoreInfo(set) => Some(&set.info.store_id),
            _ => None,
        })
        .collect();
    for store in &stores {
        assert_eq!(store.application_id().as_str(), "app");
        assert_eq!(store.recording_id().as_str(), "rec");
    }
    assert_eq!(stores.len(), 2, "the recording and its layout");
    folder.toprise("run mine.toml -o mine.mcap --rrd mine.rrd", 0);
    let recorded = folder.read("mine.rrd");
    assert!(count_rows(&recorded) > 1000);
    assert_eq!(count_rows(&imported.stdout), count_rows(&recorded));
    let story = |about: String| about.split_once("\n\n").unwrap().0.to_owned();
    assert_eq!(story(about(&imported.stdout)), story(about(&recorded)));
}

#[test]
fn importer_refuses_other_files() {
    let folder = Folder::new();
    let scenario = folder.toprise("presets paper", 0).stdout;
    let misspelt = scenario.replace("mass", "maas");
    let broken = scenario.replace("[initial]", "[initial");
    for (name, text, code, message) in [
        (
            "other.toml",
            "[package]\nname = \"x\"\n",
            66,
            "not a toprise scenario",
        ),
        ("scenario.txt", &scenario, 66, "not a toprise scenario"),
        ("misspelt.toml", &misspelt, 1, "top.maas"),
        ("broken.toml", &broken, 1, "[initial"),
    ] {
        fs::write(folder.at(name), text).unwrap();
        let imported = import(&folder, name);
        assert_eq!(imported.status.code(), Some(code), "{name}: {imported:?}");
        assert_contains(&String::from_utf8_lossy(&imported.stderr), message);
        // The viewer shows the error of a scenario.
        let is_shown = code == 1;
        assert_eq!(!imported.stdout.is_empty(), is_shown, "{name}");
        if is_shown {
            assert_contains(&about(&imported.stdout), message);
        }
    }
    assert_eq!(import(&folder, "absent.toml").status.code(), Some(1));
    assert_eq!(import(&folder, "").status.code(), Some(1));
}

#[test]
fn lost_viewer_is_a_partial_result() {
    let folder = Folder::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    // Accepts the connection, so that a viewer seems to be there, and breaks it.
    thread::spawn(move || listener.incoming().for_each(drop));
    let viewer = format!("--connect=rerun+http://127.0.0.1:{port}/proxy");
    let line = format!("run --set stop.duration=0.3 -o a.mcap {viewer}");
    let warning = folder.toprise(&line, 3).stderr;
    assert_contains(&warning, "was lost");
    let archive = Overview::read(&folder.at("a.mcap")).unwrap();
    assert!(archive.is_whole());
}

#[test]
fn lost_viewer_loses_nothing_of_a_complete_file() {
    let folder = Folder::new();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    // Accepts the connection, so that a viewer seems to be there, and breaks it.
    thread::spawn(move || listener.incoming().for_each(drop));
    let viewer = format!("--connect=rerun+http://127.0.0.1:{port}/proxy");
    let line = format!("run --set stop.duration=0.3 -o a.mcap --rrd a.rrd {viewer}");
    assert_contains(&folder.toprise(&line, 0).stderr, "was lost");
    assert!(!chunks(&folder.read("a.rrd")).is_empty());
}

/// θ and φ of a second of a preset's motion at 100 Hz.
#[cfg(feature = "fit")]
fn measured_motion() -> Vec<[f64; 3]> {
    let scenario = scenario("full-coulomb", &[("stop.duration", "1")]);
    let times: Vec<f64> = (0..=100).map(|i| f64::from(i) / 100.0).collect();
    let mut rows = Vec::new();
    sample_at(&scenario, &times, &mut |index, sample| {
        rows.push([times[index], sample.angles.theta, sample.angles.phi]);
    })
    .unwrap();
    rows
}

/// The times (ns) and the numbers of an entity.
#[cfg(feature = "fit")]
fn numbers(chunks: &[Chunk], entity: &str) -> Vec<(i64, f64)> {
    let mut numbers = Vec::new();
    for chunk in chunks {
        if chunk.entity_path().to_string() == entity && !chunk.is_static() {
            let times = chunk.timelines().values().next().unwrap().times_raw();
            let values = chunk.iter_slices::<f64>("Scalars:scalars".into());
            for (time, values) in times.iter().zip(values) {
                numbers.extend(values.iter().map(|value| (*time, *value)));
            }
        }
    }
    numbers
}

#[cfg(feature = "fit")]
#[test]
fn fits_show_data_over_the_curve() {
    let folder = Folder::new();
    let rows = measured_motion();
    let mut csv = "t,theta,phi\n".to_owned();
    for [time, theta, phi] in &rows {
        csv += &format!("{time},{theta},{phi}\n");
    }
    fs::write(folder.at("data.csv"), csv).unwrap();
    let line = "fit full-coulomb data.csv --set friction.k=0.04 --free friction.k \
        --signal theta:1mrad --signal phi:1mrad --holdout 0.2 --rrd fit.rrd";
    let printed = folder.toprise(line, 0).stdout;
    assert_contains(&printed, "fit.rrd");
    let chunks = chunks(&folder.read("fit.rrd"));
    for (name, column) in [("theta", 1), ("phi", 2)] {
        let entity = format!("/fit/data/top/state/{name}");
        let mut found = numbers(&chunks, &entity);
        assert_eq!(found.len(), 81, "{name}");
        found.extend(numbers(&chunks, &format!("{entity}/held_out")));
        let expected: Vec<(i64, f64)> = rows
            .iter()
            .map(|row| ((row[0] * 1e9).round() as i64, row[column]))
            .collect();
        assert_eq!(found, expected, "{name}");
        // The fit is the motion itself, so the curve goes through the values, and the band lies around them.
        let curve = numbers(&chunks, &format!("/fit/curve/top/state/{name}"));
        let band = numbers(&chunks, &format!("/fit/curve/top/state/{name}/band"));
        assert_eq!(band.len(), 2 * curve.len());
        for (time, value) in &expected {
            let (_, fitted) = curve.iter().find(|(other, _)| other == time).unwrap();
            assert!((fitted - value).abs() < 1e-6, "{name} at {time} ns");
            let bounds: Vec<_> = band.iter().filter(|(other, _)| other == time).collect();
            assert!((bounds[0].1 - (fitted - 0.002)).abs() < 1e-12);
            assert!((bounds[1].1 - (fitted + 0.002)).abs() < 1e-12);
        }
        let residuals = numbers(&chunks, &format!("/fit/residual/top/state/{name}"));
        assert_eq!(residuals.len(), 81);
        assert!(residuals.iter().all(|(_, residual)| residual.abs() < 1e-3));
    }
    let poses = chunks
        .iter()
        .filter(|chunk| chunk.entity_path().to_string() == "/scene/measured" && !chunk.is_static());
    assert_eq!(poses.map(Chunk::num_rows).sum::<usize>(), rows.len());
    assert_contains(&text(&chunks, "/fit/report"), "friction.k");
}

/// The last text of an entity.
fn text(chunks: &[Chunk], entity: &str) -> String {
    let chunks = chunks.iter();
    let texts = chunks
        .filter(|chunk| chunk.entity_path().to_string() == entity)
        .flat_map(|chunk| {
            chunk
                .iter_slices::<String>("TextDocument:text".into())
                .flatten()
                .map(|text| text.to_string())
                .collect::<Vec<_>>()
        });
    texts.last().unwrap()
}

#[cfg(feature = "fit")]
#[test]
fn view_shows_a_recorded_fit_as_fit_does() {
    let folder = Folder::new();
    let mut csv = "t,theta,phi\n".to_owned();
    for [time, theta, phi] in measured_motion() {
        csv += &format!("{time},{theta},{phi}\n");
    }
    fs::write(folder.at("data.csv"), csv).unwrap();
    let line = "fit full-coulomb data.csv --set friction.k=0.04 --free friction.k --signal theta:1mrad \
        --signal phi:1mrad --holdout 0.2 -o fit.mcap --rrd fit.rrd";
    folder.toprise(line, 0);
    folder.toprise("view fit.mcap --rrd view.rrd", 0);
    let [expected, found] = ["fit.rrd", "view.rrd"].map(|file| chunks(&folder.read(file)));
    for kind in ["data", "residual"] {
        for name in ["theta", "phi", "theta/held_out", "phi/held_out"] {
            let entity = format!("/fit/{kind}/top/state/{name}");
            let rows = numbers(&expected, &entity);
            assert!(!rows.is_empty(), "{entity}");
            assert_eq!(numbers(&found, &entity), rows, "{entity}");
        }
    }
    assert_eq!(text(&found, "/fit/report"), text(&expected, "/fit/report"));
    let part = folder.toprise("view fit.mcap --to 0.1 --rrd part.rrd", 0);
    assert_eq!(part.stderr, "");
    let part = numbers(
        &chunks(&folder.read("part.rrd")),
        "/fit/data/top/state/theta",
    );
    assert_eq!(part.len(), 11);
}

/// The vectors of a component of an entity, in all rows.
fn positions(chunks: &[Chunk], entity: &str, component: &'static str) -> Vec<[f32; 3]> {
    let mut positions = Vec::new();
    for chunk in chunks {
        if chunk.entity_path().to_string() == entity {
            let rows = chunk.iter_slices::<[f32; 3]>(component.into());
            positions.extend(rows.flatten().copied());
        }
    }
    positions
}

#[test]
fn legends_name_arrows_and_paths() {
    let folder = Folder::new();
    for (preset, names) in [
        (
            "paper",
            &["**L** angular momentum", "centre of the peg", "axis"][..],
        ),
        (
            "tippe-top",
            &["friction torque", "centre of mass", "contact"],
        ),
    ] {
        let line = format!("run {preset} --set stop.duration=0.1 -o a.mcap --rrd a.rrd --force");
        folder.toprise(&line, 0);
        let legend = text(&chunks(&folder.read("a.rrd")), "/legend");
        for name in names {
            assert_contains(&legend, name);
        }
    }
}

/// The sum of two vectors of an arrow.
fn sum(a: [f32; 3], b: [f32; 3]) -> [f32; 3] {
    [0, 1, 2].map(|axis| a[axis] + b[axis])
}

fn assert_near(a: [f32; 3], b: [f32; 3], size: f32) {
    // Single precision.
    let is_near = (0..3).all(|axis| (a[axis] - b[axis]).abs() <= 1e-6 * size);
    assert!(is_near, "{a:?}, {b:?}");
}

#[test]
fn momentum_is_the_sum_of_its_drawn_parts() {
    let folder = Folder::new();
    for (preset, is_free) in [("paper", false), ("tippe-top", true)] {
        let line = format!("run {preset} --set stop.duration=0.1 -o a.mcap --rrd a.rrd --force");
        folder.toprise(&line, 0);
        let chunks = chunks(&folder.read("a.rrd"));
        let arrow = |name: &str| {
            let entity = format!("/scene/{name}");
            ["Arrows3D:origins", "Arrows3D:vectors"]
                .map(|component| positions(&chunks, &entity, component)[0])
        };
        let [start, whole] = arrow("angular_momentum");
        let [_, horizontal] = arrow("horizontal_part_of_L");
        let [corner, vertical] = arrow("vertical_part_of_L");
        let [torque_start, _] = arrow("friction_torque");
        assert_near(sum(horizontal, vertical), whole, 1.0);
        assert_near(sum(start, horizontal), corner, 1.0);
        assert_near(torque_start, corner, 1.0);
        let peg = positions(&chunks, "/scene/top", "Transform3D:translation")[0];
        let top = scenario(preset, &[]).model.top;
        let distance = sum(start, peg.map(|part| -part));
        let size = distance.iter().map(|part| part * part).sum::<f32>().sqrt();
        let expected = if is_free {
            top.center_distance.abs()
        } else {
            0.0
        };
        assert!(
            (f64::from(size) - expected).abs() < 1e-6,
            "{preset}: {size}"
        );
    }
}

#[test]
fn balls_hide_no_arrow() {
    let folder = Folder::new();
    folder.toprise(
        "run tippe-top --set stop.duration=0.1 -o a.mcap --rrd a.rrd",
        0,
    );
    let albedo = chunks(&folder.read("a.rrd"))
        .iter()
        .filter(|chunk| chunk.entity_path().to_string() == "/scene/top/body")
        .flat_map(|chunk| {
            let colors = chunk.iter_slices::<u32>("Mesh3D:albedo_factor".into());
            colors.flatten().copied().collect::<Vec<_>>()
        })
        .last()
        .unwrap();
    assert!(albedo & 0xFF < 0xC0, "translucent");
}

/// The numbers of an entity by time, ns.
fn rows(chunks: &[Chunk], entity: &str) -> BTreeMap<i64, Vec<f64>> {
    let mut rows = BTreeMap::new();
    for chunk in chunks {
        if chunk.entity_path().to_string() == entity && !chunk.is_static() {
            let times = chunk.timelines().values().next().unwrap().times_raw();
            let values = chunk.iter_slices::<f64>("Scalars:scalars".into());
            rows.extend(times.iter().copied().zip(values.map(<[f64]>::to_vec)));
        }
    }
    rows
}

/// The simulation integrates the frictional term of d²φ/dt² with the motion, and knows its mean.
#[test]
fn val_means_of_terms() {
    let folder = Folder::new();
    folder.toprise("run paper --set stop.duration=1 -o a.mcap --rrd a.rrd", 0);
    let mut expected = BTreeMap::new();
    let mut terms = Vec::new();
    for message in &in_memory(&scenario("paper", &[("stop.duration", "1")]))
        .0
        .messages
    {
        let message = message.as_message();
        if message.topic() == NUTATION {
            let mean = nutation::PHI_DDOT_FRICTIONAL_MEAN.of(&message);
            expected.insert(message.time_ns as i64, mean);
        } else if message.topic() == ACCELERATION {
            terms.push(acceleration::PHI_DDOT_FRICTIONAL.of(&message));
        }
    }
    let found = rows(
        &chunks(&folder.read("a.rrd")),
        "/derived/mean_terms/phi_ddot",
    );
    assert!(found.len() > 20 && found.len() + 1 >= expected.len());
    // The trapezoidal rule and the line up to the end of a nutation are wrong by at most h²/8 max |f″|, twice.
    let bends = terms.windows(3).map(|f| (f[0] - 2.0 * f[1] + f[2]).abs());
    let tolerance = bends.fold(0.0, f64::max) / 4.0;
    for (time, row) in found {
        let mean = expected[&time];
        assert!(
            (row[0] - mean).abs() < tolerance,
            "{time}: {row:?}, {mean} ± {tolerance}"
        );
        assert!((row[0] + row[1] - row[2]).abs() <= f64::EPSILON * row[0].abs());
    }
}

#[cfg(feature = "fit")]
#[test]
fn lost_viewer_makes_a_fit_partial() {
    let folder = Folder::new();
    fs::write(
        folder.at("data.csv"),
        "t,theta\n0,0.5\n0.01,0.5\n0.02,0.5\n",
    )
    .unwrap();
    let listener = TcpListener::bind("127.0.0.1:0").unwrap();
    let port = listener.local_addr().unwrap().port();
    // Accepts the connection, so that a viewer seems to be there, and breaks it.
    thread::spawn(move || listener.incoming().for_each(drop));
    let viewer = format!("--connect=rerun+http://127.0.0.1:{port}/proxy");
    let line = format!("fit full-coulomb data.csv --free friction.k --signal theta:1 {viewer}");
    assert_contains(&folder.toprise(&line, 3).stderr, "was lost");
}
