//! Recordings as other people's software reads them.
//!
//! `eval "$(tests/readers/setup)"` installs it. Where it is missing these tests are skipped, unless
//! `TOPRISE_READERS_REQUIRED` is set: then they fail.

use crate::agreement::split_channels;
use crate::forgeries::forgery::Forgery;
use crate::support::Run;
use assert_cmd::Command;
use serde_json::{Map, Value};
use std::env;
use std::ffi::OsStr;
use std::fs;
use std::path::{Path, PathBuf};
use tempfile::{TempDir, tempdir};
use toprise::physics::dynamics::Support;
use toprise::telemetry::Topic;

const ENCODINGS: [&str; 2] = ["json", "protobuf"];

fn readers() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers")
}

/// Says why a test does nothing.
#[track_caller]
fn skip(reason: &str) {
    assert!(
        env::var_os("TOPRISE_READERS_REQUIRED").is_none(),
        "TOPRISE_READERS_REQUIRED is set, but {reason}"
    );
    eprintln!("skipped: {reason}");
}

/// A Python that has the packages of `requirements.txt`.
#[track_caller]
fn python() -> Option<PathBuf> {
    let python = env::var_os("TOPRISE_READERS_PYTHON").map(PathBuf::from);
    if python.is_none() {
        skip("TOPRISE_READERS_PYTHON does not name a Python interpreter");
    }
    python
}

/// Whether there is a node that has the packages of `package.json`.
#[track_caller]
fn has_node() -> bool {
    let runs = std::process::Command::new("node").arg("--version").output();
    let has_packages = readers().join("node_modules").is_dir();
    let found = runs.is_ok() && has_packages;
    if !found {
        skip("there is no node, or tests/readers/node_modules is missing");
    }
    found
}

/// The Rerun program of a Python's `rerun-sdk`: `bin/rerun` beside the interpreter is but a script.
fn rerun(python: &Path) -> Command {
    let script = "import sysconfig; print(sysconfig.get_path('platlib'), end='')";
    let packages = answer(Command::new(python).args(["-c", script]));
    Command::new(Path::new(&packages).join("rerun_sdk/rerun_cli/rerun"))
}

fn toprise(directory: &TempDir) -> Command {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command.current_dir(directory.path());
    command
}

/// Standard output of a command that must succeed.
#[track_caller]
fn answer(command: &mut Command) -> String {
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

#[track_caller]
fn json(command: &mut Command) -> Value {
    serde_json::from_str(&answer(command)).unwrap()
}

/// What one of our scripts says of a recording.
#[track_caller]
fn read(program: impl AsRef<OsStr>, script: &str, recording: &Path) -> Value {
    let mut command = Command::new(program);
    json(command.arg(readers().join(script)).arg(recording))
}

/// Records a second of the paper's run.
fn record(directory: &TempDir, encoding: &str) -> PathBuf {
    let path = directory.path().join(format!("{encoding}.mcap"));
    toprise(directory)
        .args(["run", "--set", "stop.duration=1", "--encoding", encoding])
        .arg("-o")
        .arg(&path)
        .assert()
        .success();
    path
}

fn info(directory: &TempDir, recording: &Path) -> Value {
    let mut command = toprise(directory);
    json(
        command
            .arg("info")
            .arg(recording)
            .args(["--format", "json"]),
    )
}

/// The number of messages that `toprise info` reports for each topic whose encoding is `wanted`.
fn counts(info: &Value, wanted: impl Fn(&str) -> bool) -> Value {
    let channels = info["channels"].as_array().unwrap().iter();
    let counts: Map<String, Value> = channels
        .filter(|channel| wanted(channel["encoding"].as_str().unwrap()))
        .map(|channel| {
            let topic = channel["topic"].as_str().unwrap().to_owned();
            (topic, channel["messages"].clone())
        })
        .collect();
    assert!(!counts.is_empty());
    Value::Object(counts)
}

#[test]
fn val_python_reads_the_same_content_in_both_encodings() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    let mut digests = Vec::new();
    for encoding in ENCODINGS {
        let recording = record(&directory, encoding);
        let info = info(&directory, &recording);
        let found = read(&python, "read.py", &recording);
        assert_eq!(
            found["content_digest"], info["end"]["content_digest"],
            "{encoding}"
        );
        assert_eq!(found["topics"], counts(&info, |of| of == encoding));
        assert_eq!(found["views"], counts(&info, |of| of != encoding));
        digests.push(found["content_digest"].clone());
    }
    assert!(digests[0].is_string());
    assert_eq!(digests[0], digests[1]);
}

/// The profile's validator and the crates' library, both by their makers.
#[test]
fn val_archives_are_process_run_crates() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    for (name, extra) in [
        ("least", ""),
        (
            "most",
            "doi = \"10.5281/zenodo.1\"\npublisher = \"Zenodo\"\ndescription = \"Two\"\nkeywords = [\"a\", \"b\"]\n\
             [[funders]]\nname = \"ERC\"\naward = \"1\"\n\
             [[related]]\nrelation = \"cites\"\nid = \"https://example.org/a b\"\n",
        ),
    ] {
        let creators =
            "creators = [{ name = \"Doe, Jo\", affiliation = \"MIT\" }, { name = \"Top Group\" }]";
        let about =
            format!("title = \"Tops\"\nlicence = \"MIT\"\ndate = 2026-11-29\n{creators}\n{extra}");
        fs::write(
            directory.path().join("about.toml"),
            about.replace("a b", "a"),
        )
        .unwrap();
        let run = [
            "run",
            "paper",
            "--set",
            "stop.duration=0.05",
            "--force",
            "-o",
            "a b.mcap",
        ];
        toprise(&directory).args(run).assert().success();
        let archive = ["archive", "a b.mcap", "--about", "about.toml", "-o", name];
        toprise(&directory).args(archive).assert().success();
        let script = readers().join("ro_crate.py");
        let actions = answer(
            Command::new(&python)
                .arg(script)
                .arg(directory.path().join(name)),
        );
        assert!(
            actions.contains("toprise run 'scenarios/a b.toml'"),
            "{actions}"
        );
    }
}

/// The program on the page about the format, for fixed and free pegs.
#[test]
fn val_documented_program_computes_the_content_digest() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    for preset in ["paper", "drop"] {
        let recording = directory.path().join(format!("{preset}.mcap"));
        toprise(&directory)
            .args(["run", preset, "--set", "stop.duration=0.5", "-o"])
            .arg(&recording)
            .assert()
            .success();
        let digest = answer(
            Command::new(&python)
                .arg(readers().join("digest.py"))
                .arg(&recording),
        );
        let recorded = &info(&directory, &recording)["end"]["content_digest"];
        assert_eq!(*recorded, digest.trim(), "{preset}");
    }
}

/// Software that records what several publishers send splits a topic into channels.
#[test]
fn val_documented_program_joins_split_topics() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    let recording = record(&directory, "json");
    let digest = |recording: &Path| {
        let script = readers().join("digest.py");
        answer(Command::new(&python).arg(script).arg(recording))
    };
    let whole = digest(&recording);
    let mut forgery = Forgery::of(&fs::read(&recording).unwrap());
    split_channels(&mut forgery);
    fs::write(&recording, forgery.bytes()).unwrap();
    assert_eq!(digest(&recording), whole);
}

#[test]
fn val_javascript_reads_every_message_through_the_index() {
    if !has_node() {
        return;
    }
    let directory = tempdir().unwrap();
    let run = Run::with("paper", &[("stop.duration", "1")]);
    let sum_theta = run.samples.iter().fold(0.0, |sum, s| sum + s.angles.theta);
    for encoding in ENCODINGS {
        let recording = record(&directory, encoding);
        let expected = counts(&info(&directory, &recording), |_| true);
        let found = read("node", "read.mjs", &recording);
        assert_eq!(found["indexed"], expected, "{encoding}");
        assert_eq!(found["streamed"], expected, "{encoding}");
        // In the same order the sum is the same to the last bit.
        assert_eq!(found["sum_theta"].as_f64(), Some(sum_theta), "{encoding}");
    }
}

#[test]
fn val_other_readers_notice_flipped_bits() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    for encoding in ENCODINGS {
        let recording = record(&directory, encoding);
        let mut bytes = fs::read(&recording).unwrap();
        let middle = bytes.len() / 2;
        bytes[middle] ^= 4;
        fs::write(&recording, bytes).unwrap();
        let mut command = Command::new(&python);
        command.arg(readers().join("read.py")).arg(&recording);
        command.assert().failure();
    }
}

#[test]
fn val_proto_files_compile_to_recorded_descriptors() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    let fixed = record(&directory, "protobuf");
    let free = directory.path().join("free.mcap");
    let run = ["run", "drop", "--set", "stop.duration=0.5"];
    toprise(&directory)
        .args(run)
        .args(["--encoding", "protobuf", "-o"])
        .arg(&free)
        .assert()
        .success();
    let compared = json(
        Command::new(&python)
            .arg(readers().join("protos.py"))
            .args([&fixed, &free]),
    );
    let supports = [Support::FixedPeg, Support::FreePeg { restitution: 0.0 }];
    let channels = supports.map(|support| Topic::all_with(support).count());
    assert_eq!(compared, channels.iter().sum::<usize>());
}

#[test]
fn val_rerun_reads_recordings() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    for encoding in ENCODINGS {
        let recording = record(&directory, encoding);
        for command in ["info", "check"] {
            let text = answer(rerun(&python).args(["mcap", command]).arg(&recording));
            for topic in ["/top/state", "/events", "/tf"] {
                assert!(text.contains(topic), "{command}: no {topic} in\n{text}");
            }
        }
    }
}

#[cfg(feature = "rerun")]
#[test]
fn val_view_streams_the_same_as_run() {
    let Some(python) = python() else { return };
    let directory = tempdir().unwrap();
    let run = ["run", "--set", "stop.duration=1", "-o", "a.mcap"];
    let mut command = toprise(&directory);
    command.args(run).args(["--rrd", "a.rrd"]);
    command.assert().success();
    let mut command = toprise(&directory);
    command.args(["view", "a.mcap", "--rrd", "b.rrd"]);
    command.assert().success();
    for arguments in [
        &["rrd", "compare", "a.rrd", "b.rrd"][..],
        &["rrd", "verify", "b.rrd"],
    ] {
        let mut command = rerun(&python);
        command.current_dir(directory.path()).args(arguments);
        command.assert().success();
    }
}
