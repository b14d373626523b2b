//! The program as a process: exit codes, streams, signals.

use crate::support::{assert_contains, scenario};
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::time::Duration;
use tempfile::{TempDir, tempdir};
use toprise::archive::recording::Overview;
use toprise::run::scenario::Scenario;

fn toprise(directory: &TempDir) -> Command {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command.current_dir(directory.path());
    command
}

/// Standard output of a command that must succeed.
fn answer(command: &mut Command) -> String {
    let output = command.assert().success().get_output().stdout.clone();
    String::from_utf8(output).unwrap()
}

const SHORT: [&str; 4] = ["run", "paper", "--set", "stop.duration=0.2"];

#[test]
fn run_records_and_summarises() {
    let directory = tempdir().unwrap();
    let text = answer(toprise(&directory).args(SHORT));
    for part in [
        "the run reached its duration at t = 0.200000 s",
        "recordings/paper_duration0.2.mcap",
        "201 samples",
        "sha-256",
    ] {
        assert_contains(&text, part);
    }
    assert!(
        Overview::read(&directory.path().join("recordings/paper_duration0.2.mcap"))
            .unwrap()
            .is_whole()
    );
}

#[test]
fn a_run_that_is_recorded_is_not_written_again() {
    let directory = tempdir().unwrap();
    let recordings = || {
        let mut names: Vec<String> = fs::read_dir(directory.path().join("recordings"))
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .filter(|name| !name.ends_with(".rrd"))
            .collect();
        names.sort_unstable();
        names
    };
    let run = |more: &[&str]| answer(toprise(&directory).args(SHORT).args(more));
    run(&[]);
    let text = run(&[]);
    assert_contains(
        &text,
        "recordings/paper_duration0.2.mcap already exists with identical content",
    );
    assert_eq!(recordings(), ["paper_duration0.2.mcap"]);
    // The same content in another encoding, and another run under the same name.
    run(&["--encoding", "protobuf"]);
    assert_eq!(
        recordings(),
        ["paper_duration0.2-2.mcap", "paper_duration0.2.mcap"]
    );
    let text = run(&["--encoding", "protobuf"]);
    assert_contains(&text, "paper_duration0.2-2.mcap already exists");
    // A recording that is run again.
    let text = answer(toprise(&directory).args(["run", "recordings/paper_duration0.2.mcap"]));
    assert_contains(&text, "paper_duration0.2.mcap already exists");
    let path = directory.path().join("recordings/paper_duration0.2-3.mcap");
    fs::write(&path, "damaged").unwrap();
    run(&["--topics", "/top/state"]);
    assert_eq!(fs::read(&path).unwrap(), b"damaged");
    assert_eq!(recordings().len(), 4);
}

#[test]
fn a_run_with_many_changes_takes_no_other_runs_name() {
    let directory = tempdir().unwrap();
    let kept = directory.path().join("recordings/paper.mcap");
    fs::create_dir(kept.parent().unwrap()).unwrap();
    fs::write(&kept, "the preset's").unwrap();
    let mut command = toprise(&directory);
    command.args(["run", "--force", "--set", "stop.duration=0.05"]);
    for change in [
        "initial.phi=0.1",
        "initial.psi=0.1",
        "gravity=9",
        "top.mass=0.1",
    ] {
        command.args(["--set", change]);
    }
    let text = answer(command.args(["--set", "top.peg_radius=0.006"]));
    assert_contains(&text, "recordings/paper_");
    assert_eq!(fs::read(&kept).unwrap(), b"the preset's");
}

#[test]
fn changed_runs_are_called_by_their_changes() {
    let directory = tempdir().unwrap();
    for (changes, title, file) in [
        (
            &["--set", "friction.k=0.02"][..],
            "paper, friction.k = 0.02, stop.duration = 0.2: ",
            "paper_k0.02_duration0.2.mcap",
        ),
        (
            &[
                "--set",
                "friction.law=none",
                "--set",
                "friction.k=",
                "--set",
                "friction.dissipation=",
            ],
            "paper, 4 keys changed: ",
            "paper_law-none_no-k_no-dissipation_duration0.2.mcap",
        ),
        (
            &[
                "--set",
                "drilling.k=2e-2",
                "--set",
                "drilling.patch_radius=0.001",
                "--set",
                "top.mass=0.11",
            ],
            "paper, 3 keys changed: ",
            "paper_drilling-k0.02_drilling-patch_radius0.001_duration0.2.mcap",
        ),
        (
            &["--set", "name=mine", "--set", "description=../a b"],
            "mine, stop.duration = 0.2: ",
            "mine_duration0.2.mcap",
        ),
    ] {
        let mut command = toprise(&directory);
        command
            .args(["run", "--set", "stop.duration=0.2"])
            .args(changes);
        let text = answer(&mut command);
        assert!(text.starts_with(title), "{text}");
        assert!(text.contains(&format!("recordings/{file}")), "{text}");
    }
}

#[test]
fn a_recording_can_be_run_again_and_with_another_value() {
    let directory = tempdir().unwrap();
    let run = |words: &[&str]| {
        let mut command = toprise(&directory);
        command.arg("run").args(words);
        command
    };
    run(&SHORT[1..]).args(["-o", "a.mcap"]).assert().success();
    run(&["a.mcap", "-o", "b.mcap"]).assert().success();
    let read = |name: &str| fs::read(directory.path().join(name)).unwrap();
    assert!(read("a.mcap") == read("b.mcap"));
    run(&["a.mcap", "--set", "friction.k=0.02", "-o", "c.mcap"])
        .assert()
        .success();
    let compared = toprise(&directory)
        .args(["diff", "a.mcap", "c.mcap"])
        .assert()
        .code(1);
    let text = String::from_utf8_lossy(&compared.get_output().stdout).into_owned();
    assert_contains(&text, "friction.k");
    // The recording that is read is never replaced.
    let refused = run(&["a.mcap", "-o", "a.mcap", "--force"]).assert().code(2);
    let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert_contains(&error, "a.mcap");
    assert!(read("a.mcap") == read("b.mcap"));
}

#[test]
fn an_explicit_output_that_exists_needs_force() {
    let directory = tempdir().unwrap();
    let run = |extra: &[&str]| {
        let mut command = toprise(&directory);
        command.args(SHORT).args(["-o", "a.mcap"]).args(extra);
        command
    };
    run(&[]).assert().success();
    let failure = run(&[]).assert().code(2);
    let error = String::from_utf8_lossy(&failure.get_output().stderr).into_owned();
    assert!(
        error.contains("a.mcap exists") && error.contains("--force"),
        "{error}"
    );
    run(&["--force"]).assert().success();
}

#[test]
fn bad_input_is_exit_code_2_and_writes_nothing() {
    let directory = tempdir().unwrap();
    fs::write(directory.path().join("broken.toml"), "[top\n").unwrap();
    fs::write(directory.path().join("binary.toml"), [0xff, 0xfe]).unwrap();
    fs::write(directory.path().join("file"), "").unwrap();
    for (arguments, part) in [
        (&["run", "nope"][..], "nope"),
        (&["run", "broken.toml"], "TOML"),
        (&["run", "binary.toml"], "binary.toml"),
        (&["run", "missing.toml"], "missing.toml"),
        (&["run", "--set", "top.mass=-1"], "top.mass = -1"),
        (&["run", "--set", "top.mass"], "KEY=VALUE"),
        (&["run", "--set", "friction.law=none"], "friction.k"),
        (&["run", "--topics", "/top/stat"], "/top/state"),
        (&["run", "--realtime", "0"], "positive number"),
        (&["run", "-o", "file/run.mcap"], "file"),
        (&["run", "--format", "xml"], "xml"),
        (&["run", "--set", "initial.theta=nan"], "NaN"),
        (
            &["run", "frictionless", "--set", "stop.duration="],
            "never stop",
        ),
        (&["info", "missing.mcap"], "missing.mcap"),
        (&["info", "broken.toml"], "MCAP"),
        (&["info", "file"], "empty"),
        (&["info", "."], "."),
        (&["verify", "missing.mcap"], "missing.mcap"),
        (&["run", "--encoding", "cdr"], "json"),
        (&["presets", "nope"], "paper"),
        (&["schema", "/nope"], "/top/state"),
        (&["frobnicate"], "frobnicate"),
    ] {
        let failure = toprise(&directory).args(arguments).assert().code(2);
        let output = failure.get_output();
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(
            error.contains(part),
            "{arguments:?}: {part} is not in {error}"
        );
        assert!(output.stdout.is_empty(), "{arguments:?}");
        assert!(
            !directory.path().join("recordings").exists(),
            "{arguments:?}"
        );
        assert!(!error.contains("panicked"), "{error}");
    }
}

#[test]
fn a_rerun_file_that_exists_leaves_no_mcap_behind() {
    if cfg!(not(feature = "rerun")) {
        return;
    }
    let directory = tempdir().unwrap();
    fs::write(directory.path().join("a.rrd"), "precious").unwrap();
    let arguments = ["-o", "a.mcap", "--rrd", "a.rrd"];
    toprise(&directory)
        .args(SHORT)
        .args(arguments)
        .assert()
        .code(2);
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 1);
    assert_eq!(
        fs::read(directory.path().join("a.rrd")).unwrap(),
        b"precious"
    );
}

#[test]
fn summaries_are_json_where_a_program_reads_them() {
    let directory = tempdir().unwrap();
    let run: Value = serde_json::from_str(&answer(
        toprise(&directory).args(SHORT).args(["--format", "json"]),
    ))
    .unwrap();
    assert_eq!(run["samples"], 201);
    // The members of its outcome are the columns of a sweep.
    let scenario = scenario("paper", &[("stop.duration", "0.2")]);
    let outcome = toprise::run::outcome(&scenario, || true).unwrap();
    assert_eq!(run["outcome"], serde_json::to_value(&outcome).unwrap());
    assert_eq!(run["outcome"]["stop_reason"], "duration");
    let path = run["mcap"]["path"].as_str().unwrap();
    let info: Value = serde_json::from_str(&answer(
        toprise(&directory).args(["info", path, "--format", "json"]),
    ))
    .unwrap();
    assert_eq!(info["state"], "complete");
    assert_eq!(info["end"]["content_digest"], run["content_digest"]);
    assert_eq!(info["channels"][0]["topic"], "/top/state");
    assert_eq!(info["channels"][0]["messages"], 201);
    assert_eq!(info["bytes"], run["mcap"]["bytes"]);
}

#[test]
fn info_tells_what_is_in_a_recording() {
    let directory = tempdir().unwrap();
    toprise(&directory).args(SHORT).assert().success();
    let text = answer(toprise(&directory).args(["info", "recordings/paper_duration0.2.mcap"]));
    for part in [
        "complete",
        "/top/state",
        "toprise.State",
        "201",
        "1000.0 Hz",
        "start",
        "duration",
    ] {
        assert_contains(&text, part);
    }
    assert!(
        text.lines().all(|line| line.chars().count() <= 130),
        "{text}"
    );
}

#[test]
fn presets_can_be_edited_and_run() {
    let directory = tempdir().unwrap();
    let list = answer(toprise(&directory).arg("presets"));
    assert!(list.contains("full-coulomb"));
    let toml = answer(toprise(&directory).args(["presets", "full-coulomb"]));
    let toml = toml.replace("name = \"full-coulomb\"", "name = \"mine\"");
    fs::write(directory.path().join("mine.toml"), toml).unwrap();
    let arguments = ["run", "mine.toml", "--set", "stop.duration=0.1"];
    let text = answer(toprise(&directory).args(arguments));
    assert_contains(&text, "recordings/mine_duration0.1.mcap");
}

#[test]
fn laws_are_listed() {
    let directory = tempdir().unwrap();
    let text = answer(toprise(&directory).arg("laws"));
    for part in [
        "coulomb-tanh",
        "friction.patch_radius",
        "[m/s]",
        "Zhuravlev",
        "air.disc",
    ] {
        assert_contains(&text, part);
    }
    let json = answer(toprise(&directory).args(["laws", "--format", "json"]));
    let json: Value = serde_json::from_str(&json).unwrap();
    let names = json.as_array().unwrap().iter().map(|law| &law["name"]);
    let listed: Vec<_> = toprise::run::scenario::LAWS
        .iter()
        .map(|law| law.name)
        .collect();
    assert_eq!(names.collect::<Vec<_>>(), listed);
    let parameter = &json[1]["parameters"][0];
    assert_eq!(parameter["key"], "friction.k");
    assert_eq!(parameter["allowed"], "a number from 0 to 100");
}

#[test]
fn schemas_and_completions_are_printed() {
    let directory = tempdir().unwrap();
    assert!(answer(toprise(&directory).arg("schema")).contains("/top/torque"));
    let schema: Value =
        serde_json::from_str(&answer(toprise(&directory).args(["schema", "/events"]))).unwrap();
    assert_eq!(schema["title"], "toprise.Event");
    answer(toprise(&directory).args(["schema", "--write", "out"]));
    assert!(directory.path().join("out/toprise.State.json").exists());
    assert!(answer(toprise(&directory).args(["completions", "bash"])).contains("toprise"));
}

/// Waits until the partial recording has grown.
#[cfg(unix)]
fn wait_for_data(path: &Path) {
    for _ in 0..200 {
        if fs::metadata(path).is_ok_and(|metadata| metadata.len() > 100_000) {
            return;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("{} does not grow", path.display());
}

/// A run in real time, in the background.
#[cfg(unix)]
fn paced_run(directory: &TempDir) -> std::process::Child {
    std::process::Command::new(assert_cmd::cargo::cargo_bin("toprise"))
        .current_dir(directory.path())
        .args(["run", "--realtime", "-o", "live.mcap"])
        .stdout(std::process::Stdio::piped())
        .spawn()
        .unwrap()
}

#[cfg(unix)]
fn signal(child: &std::process::Child, name: &str) {
    let id = child.id().to_string();
    let status = std::process::Command::new("kill")
        .args([name, &id])
        .status()
        .unwrap();
    assert!(status.success());
}

#[cfg(unix)]
#[test]
fn an_interrupted_run_ends_cleanly() {
    let directory = tempdir().unwrap();
    let mut child = paced_run(&directory);
    wait_for_data(&directory.path().join("live.mcap.partial"));
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(3));
    let overview = Overview::read(&directory.path().join("live.mcap")).unwrap();
    assert!(overview.is_whole());
    assert_eq!(overview.end.unwrap()["stop_reason"], "interrupted");
    assert!(!directory.path().join("live.mcap.partial").exists());
}

#[cfg(unix)]
#[test]
fn a_killed_run_leaves_a_readable_partial_file() {
    let directory = tempdir().unwrap();
    let mut child = paced_run(&directory);
    let partial = directory.path().join("live.mcap.partial");
    wait_for_data(&partial);
    signal(&child, "-KILL");
    child.wait().unwrap();
    let overview = Overview::read(&partial).unwrap();
    assert!(overview.run.is_some() && overview.end.is_none());
    assert!(overview.messages() > 100);
    let scenario = Scenario::from_toml(&overview.scenario.unwrap()).unwrap();
    assert_eq!(scenario.name(), "paper");
    let info = toprise(&directory)
        .args(["info", "live.mcap.partial"])
        .assert()
        .code(3);
    let text = String::from_utf8_lossy(&info.get_output().stdout).into_owned();
    assert_contains(&text, "interrupted");
    // The next run neither overwrites it nor fails silently.
    toprise(&directory)
        .args(SHORT)
        .args(["-o", "live.mcap"])
        .assert()
        .code(2);
    assert!(partial.exists());
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_clear_error() {
    // A file-size limit stands for the full disk: it needs no privileges. Both end a write early.
    let directory = tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("toprise");
    let script = format!(
        "ulimit -f 200; trap '' XFSZ; exec {} run -o full.mcap",
        program.display()
    );
    let output = std::process::Command::new("bash")
        .current_dir(directory.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(
        error.contains("full.mcap.partial") && error.contains("large"),
        "{error}"
    );
    assert!(!directory.path().join("full.mcap").exists());
    let overview = Overview::read(&directory.path().join("full.mcap.partial")).unwrap();
    assert!(overview.messages() > 100 && overview.end.is_none());
}

/// A reader that stops early is none: `cli::output` tests it.
#[test]
fn an_answer_that_nobody_can_read_is_failed_output() {
    let directory = tempdir().unwrap();
    for arguments in [&["schema"][..], &["--help"], &["laws", "--format", "json"]] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut program = std::process::Command::new(assert_cmd::cargo::cargo_bin("toprise"));
        let program = program.current_dir(directory.path()).args(arguments);
        let output = program.stdout(writer).output().unwrap();
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {told}");
        assert_contains(&told, "cannot write to standard output");
    }
}

/// What says under which name a file is written is checked before the run.
#[test]
fn regress_names_that_no_recording_can_have_are_refused_at_once() {
    let directory = tempdir().unwrap();
    for (output, part) in [
        ("new/", "\"new/\" is not a file name"),
        ("new/..", "is not a file name"),
        ("a.mcap/.", "is not a file name"),
        ("a.mcap.partial", "reserved for incomplete runs"),
        ("a.rrd", "use --rrd a.rrd"),
    ] {
        // It would take longer than the test does.
        let mut program = toprise(&directory);
        program.args(["run", "--realtime", "1e-3", "-o", output, "--force"]);
        let refused = program.timeout(Duration::from_secs(20)).assert().code(2);
        let told = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert!(told.contains(part), "{output}: {told}");
    }
    assert_eq!(fs::read_dir(directory.path()).unwrap().count(), 0);
}

/// Chunks end by their sizes: no clock reaches the file.
#[test]
fn regress_a_paced_run_writes_the_bytes_of_one_that_is_not() {
    let directory = tempdir().unwrap();
    let recorded = |name: &str, pace: &[&str]| {
        let mut program = toprise(&directory);
        let brief = ["run", "--set", "stop.duration=0.3", "-o", name];
        program.args(brief).args(pace).assert().success();
        fs::read(directory.path().join(name)).unwrap()
    };
    let whole = recorded("a.mcap", &[]);
    assert!(whole == recorded("b.mcap", &["--realtime"]));
    assert!(whole == recorded("c.mcap", &["--realtime", "0.5"]));
}

/// Only `-o` leaves a Rerun recording out that nobody has asked to leave out.
#[cfg(feature = "rerun")]
#[test]
fn the_report_tells_of_a_rerun_recording_that_is_left_out() {
    let directory = tempdir().unwrap();
    let told = |arguments: &[&str]| {
        let mut program = toprise(&directory);
        let program = program.args(["run", "--set", "stop.duration=0.01"]);
        answer(program.args(arguments)).contains("no Rerun recording with -o")
    };
    assert!(told(&["-o", "a.mcap"]));
    assert!(!told(&["-o", "b.mcap", "--no-rrd"]));
    assert!(!told(&["-o", "c.mcap", "--rrd", "c.rrd"]));
    assert!(!told(&["--no-rrd"]));
}

/// Runs `commands` one after the other; each must end with its exit code.
fn ends_with(directory: &TempDir, commands: &[(&[&str], i32)]) {
    for (arguments, code) in commands {
        toprise(directory).args(*arguments).assert().code(*code);
    }
}

#[test]
fn recordings_are_verified_and_run_again() {
    let directory = tempdir().unwrap();
    let file = |name: &str| directory.path().join(name);
    toprise(&directory)
        .args(SHORT)
        .args(["-o", "a.mcap"])
        .assert()
        .success();
    let text = answer(toprise(&directory).args(["verify", "a.mcap"]));
    assert!(text.starts_with("a.mcap: verified"), "{text}");
    let whole = fs::read(file("a.mcap")).unwrap();
    let cut = &whole[..whole.len() / 2];
    fs::write(file("cut.mcap"), cut).unwrap();
    fs::write(file("e.mcap.partial"), cut).unwrap();
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    fs::write(file("flipped.mcap"), flipped).unwrap();
    // A recording with the beginning of one run and the end of another.
    let other = ["--set", "friction.k=0.02", "-o", "other.mcap"];
    let run = toprise(&directory).args(SHORT).args(other).assert();
    run.success();
    let other = fs::read(file("other.mcap")).unwrap();
    fs::write(file("spliced.mcap"), [cut, &other[..]].concat()).unwrap();
    let force = |arguments: &[&'static str]| [&["run"], arguments, &["--force"]].concat();
    ends_with(
        &directory,
        &[
            (
                &["run", "a.mcap", "--encoding", "protobuf", "-o", "b.mcap"],
                0,
            ),
            (
                &["run", "a.mcap", "--encoding", "protobuf", "-o", "b.mcap"],
                2,
            ),
            (&["verify", "a.mcap", "b.mcap"], 0),
            (&["verify", "cut.mcap"], 3),
            (&["verify", "a.mcap", "flipped.mcap", "cut.mcap"], 3),
            (&["verify", "a.mcap", "spliced.mcap", "cut.mcap"], 1),
            (&["verify", "a.mcap", "spliced.mcap", "missing.mcap"], 2),
            (&["info", "cut.mcap"], 3),
            (&["run", "cut.mcap", "-o", "c.mcap"], 0),
            (&["run", "flipped.mcap", "-o", "d.mcap"], 0),
            // What an interrupted run has left becomes the file that it should have been.
            (&["run", "e.mcap.partial", "-o", "e.mcap"], 2),
            (&force(&["e.mcap.partial", "-o", "e.mcap"]), 0),
            // The encoding of a recording is kept, or another one is chosen.
            (&["run", "b.mcap", "-o", "same.mcap"], 0),
            (&["run", "b.mcap", "--encoding", "json", "-o", "f.mcap"], 0),
            // Another scenario is another run.
            (
                &["run", "a.mcap", "--set", "friction.k=0.02", "-o", "g.mcap"],
                0,
            ),
        ],
    );
    let bytes = |name: &str| fs::read(file(name)).unwrap();
    for same in ["c.mcap", "d.mcap", "e.mcap", "f.mcap"] {
        assert!(bytes(same) == whole, "{same}");
    }
    assert!(bytes("same.mcap") == bytes("b.mcap"));
    assert!(bytes("g.mcap") == other);
    assert_eq!(bytes("e.mcap.partial"), cut);
    let names = ["a.mcap", "spliced.mcap", "flipped.mcap"];
    let report = toprise(&directory)
        .arg("verify")
        .args(names)
        .args(["--format", "json"])
        .assert()
        .code(1);
    let report: Value = serde_json::from_slice(&report.get_output().stdout).unwrap();
    assert_eq!(report[0]["verdict"], "verified");
    assert_eq!(report[1]["verdict"], "different");
    assert_eq!(report[2]["verdict"], "incomplete");
    assert_eq!(report[2]["state"], "damaged");
}

#[cfg(feature = "rerun")]
#[test]
fn recordings_are_shown_again() {
    let directory = tempdir().unwrap();
    let live = ["-o", "a.mcap", "--rrd", "a.rrd"];
    toprise(&directory)
        .args(SHORT)
        .args(live)
        .assert()
        .success();
    let whole = fs::read(directory.path().join("a.mcap")).unwrap();
    fs::write(directory.path().join("cut.mcap"), &whole[..whole.len() / 2]).unwrap();
    ends_with(
        &directory,
        &[
            (&["view", "a.mcap", "--rrd", "b.rrd"], 0),
            (&["view", "a.mcap", "--rrd", "b.rrd"], 2),
            (&["view", "a.mcap", "--rrd", "b.rrd", "--force"], 0),
            (
                &[
                    "view", "a.mcap", "--rrd", "c.rrd", "--from", "0.1", "--to", "0.15",
                ],
                0,
            ),
            (&["view", "cut.mcap", "--rrd", "d.rrd"], 3),
            (&["view", "a.mcap", "cut.mcap", "--rrd", "both"], 3),
            (&["view", "a.mcap", "./a.mcap", "--rrd", "twice"], 0),
        ],
    );
    let size = |name: &str| fs::metadata(directory.path().join(name)).unwrap().len();
    assert!(size("c.rrd") < size("b.rrd"));
    assert!(size("both/a.rrd") > 0 && size("both/cut.rrd") > 0);
    assert!(size("twice/a.rrd") > 0 && size("twice/a-2.rrd") > 0);
    for (arguments, part) in [
        (
            &[
                "view", "a.mcap", "--rrd", "e.rrd", "--from", "2", "--to", "1",
            ][..],
            "after",
        ),
        (
            &["view", "a.mcap", "--rrd", "e.rrd", "--from", "-1"],
            "seconds",
        ),
        (&["view", "missing.mcap"], "missing.mcap"),
        (
            &["view", "a.mcap", "--connect=127.0.0.1:9"],
            "no Rerun viewer",
        ),
        (&["view", "a.mcap", "--spawn", "--serve"], "--serve"),
    ] {
        let failure = toprise(&directory).args(arguments).assert().code(2);
        let error = String::from_utf8_lossy(&failure.get_output().stderr).into_owned();
        assert!(error.contains(part), "{arguments:?}: {error}");
    }
    // Where no viewer is installed, it is said how to get one.
    let failure = toprise(&directory)
        .env("PATH", "/nowhere")
        .args(["view", "a.mcap"])
        .assert()
        .code(2);
    let error = String::from_utf8_lossy(&failure.get_output().stderr).into_owned();
    assert_contains(&error, "pip install rerun-sdk");
}

#[test]
fn a_run_of_no_time_tells_no_ratio_to_it() {
    let directory = tempfile::tempdir().unwrap();
    for duration in ["0", "1e-300"] {
        let set = format!("stop.duration={duration}");
        let output = Command::cargo_bin("toprise")
            .unwrap()
            .current_dir(directory.path())
            .args(["run", "--force", "-o", "none.mcap", "--set", &set])
            .output()
            .unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        assert!(output.status.success(), "{text}");
        assert!(!text.contains("of the simulated time"), "{text}");
        assert!(text.lines().all(|line| line.len() < 120), "{text}");
    }
}

/// What is named like a file is one: the error is about the file.
#[test]
fn a_file_that_can_t_be_run_is_not_taken_for_a_preset() {
    let directory = tempdir().unwrap();
    fs::write(directory.path().join("empty.mcap"), "").unwrap();
    fs::create_dir(directory.path().join("folder.mcap")).unwrap();
    for (name, reason) in [
        ("a.mcap.partial", "No such file"),
        ("empty.mcap", "the file is empty"),
        ("folder.mcap", "directory"),
    ] {
        let run = toprise(&directory)
            .args(["run", name, "-o", "b.mcap"])
            .assert()
            .code(2);
        let told = String::from_utf8_lossy(&run.get_output().stderr).into_owned();
        assert!(told.contains(name) && told.contains(reason), "{told}");
    }
}
