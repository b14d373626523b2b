//! Runs that are killed or run out of space: what was on the disk stays readable and can be run again.

use crate::support::{assert_contains, verified};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;
use toprise::analysis::verify::Verdict;
use toprise::archive::recording::{Condition, Overview, Recording, Selection};
use toprise::telemetry::Topics;

/// Runs that are killed.
const KILLS: u64 = 24;
const SCENARIO: [&str; 2] = ["--set", "stop.duration=10"];

fn program() -> std::path::PathBuf {
    assert_cmd::cargo::cargo_bin("toprise")
}

/// Forms of a run.
const FORMS: [&[&str]; 2] = [
    &["--encoding", "json"],
    &["--encoding", "protobuf", "--topics", "/top/state,/events"],
];

/// A run in the background.
fn start(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(program())
        .current_dir(directory)
        .arg("run")
        .args(arguments)
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

/// The bytes of the recording of a run that ends.
fn whole(directory: &Path, arguments: &[&str]) -> Vec<u8> {
    let run = start(directory, &[arguments, &["-o", "whole.mcap"]].concat()).wait();
    assert!(run.unwrap().success(), "{arguments:?}");
    fs::read(directory.join("whole.mcap")).unwrap()
}

/// Messages of a recording that is being written, once there are any.
fn messages(partial: &Path) -> u64 {
    Overview::read(partial).map_or(0, |overview| overview.messages())
}

/// Kills a run some milliseconds after its first messages have reached the disk.
fn killed_after(directory: &Path, form: &[&str], milliseconds: u64, expected: &[u8]) {
    let partial = directory.join("live.mcap.partial");
    let paced = ["--realtime", "4", "-o", "live.mcap"];
    let mut run = start(directory, &[&SCENARIO, form, &paced].concat());
    for _ in 0..1000 {
        if messages(&partial) > 0 {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
    thread::sleep(Duration::from_millis(milliseconds));
    let before = messages(&partial);
    assert!(before > 0, "the run doesn't write anything");
    run.kill().unwrap();
    run.wait().unwrap();

    let recording = Recording::open(&partial).unwrap();
    assert_eq!(recording.condition(), Condition::Interrupted);
    let overview = Overview::of(&recording);
    assert!(
        overview.messages() >= before,
        "{} of {before}",
        overview.messages()
    );
    let report = verified(&partial);
    assert_eq!(report.verdict, Verdict::Incomplete, "{report:#?}");
    assert!(whole(directory, &["live.mcap.partial"]) == expected);
    // Not one sample is missing in what was on the disk.
    let mut reader = recording.reader(Selection {
        topics: Topics::Only(vec!["/top/state".to_owned()]),
        ..Selection::default()
    });
    let mut next = 0;
    while let Some(message) = reader.next() {
        assert_eq!(message.unwrap().sequence, next);
        next += 1;
    }
}

#[test]
fn runs_that_are_killed_at_any_moment_lose_nothing_that_was_on_the_disk() {
    let directory = tempfile::tempdir().unwrap();
    let wholes = FORMS.map(|form| {
        let arguments = [&SCENARIO, form, &["--force"]].concat();
        whole(directory.path(), &arguments)
    });
    thread::scope(|scope| {
        for lane in 0..4 {
            let wholes = &wholes;
            scope.spawn(move || {
                // Knuth's multiplicative hash spreads the moments over the first 700 ms.
                for kill in (lane..KILLS).step_by(4) {
                    let directory = tempfile::tempdir().unwrap();
                    let moment = (kill * 2_654_435_761) % 700;
                    let form = (kill / 4 % 2) as usize;
                    killed_after(directory.path(), FORMS[form], moment, &wholes[form]);
                }
            });
        }
    });
}

/// A file system with 400 kB of room, where the system lets a user mount one.
#[cfg(target_os = "linux")]
#[test]
fn a_full_file_system_is_a_clear_error() {
    let directory = tempfile::tempdir().unwrap();
    let room = directory.path().join("room");
    fs::create_dir(&room).unwrap();
    let script = format!(
        "mount -t tmpfs -o size=400k tmpfs {room} || exit 99; cd {room}; \
         {program} run -o full.mcap; code=$?; cp full.mcap.partial ..; ls; exit $code",
        room = room.display(),
        program = program().display()
    );
    let output = Command::new("unshare")
        .args(["--user", "--mount", "--map-root-user", "sh", "-c", &script])
        .output();
    let output = match output {
        Ok(output) if ![Some(1), Some(99)].contains(&output.status.code()) => output,
        _ => {
            eprintln!("skipped: no file system can be mounted here");
            return;
        }
    };
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert_contains(&error, "full.mcap.partial");
    assert_contains(&error, "No space left");
    assert_eq!(output.stdout, b"full.mcap.partial\n");
    let partial = directory.path().join("full.mcap.partial");
    let recording = Recording::open(&partial).unwrap();
    assert_eq!(recording.condition(), Condition::Interrupted);
    let report = verified(&partial);
    assert_eq!(report.verdict, Verdict::Incomplete, "{report:#?}");
    assert!(messages(&partial) > 100);
}

/// Steps of a microsecond, and an hour to the next sample.
#[test]
fn a_run_without_records_ends_when_it_is_told_to() {
    let directory = tempfile::tempdir().unwrap();
    let mut run = Command::new(program())
        .current_dir(directory.path())
        .args(["run", "--set", "initial.psi_dot=1e6"])
        .args([
            "--set",
            "sampling.period=3600",
            "--set",
            "stop.duration=1e5",
        ])
        .args(["--set", "stop.theta_risen=", "--set", "stop.theta_fallen="])
        .args(["-o", "still.mcap"])
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    let partial = directory.path().join("still.mcap.partial");
    let written = |path: &Path| fs::metadata(path).map_or(0, |metadata| metadata.len());
    for _ in 0..1000 {
        if written(&partial) > 0 {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
    let pid = run.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-TERM", &pid])
            .status()
            .unwrap()
            .success()
    );
    let mut status = None;
    for _ in 0..1000 {
        status = run.try_wait().unwrap();
        if status.is_some() {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
    if status.is_none() {
        run.kill().unwrap();
    }
    assert_eq!(status.and_then(|status| status.code()), Some(3));
    let recording = Recording::open(&directory.path().join("still.mcap")).unwrap();
    assert_eq!(recording.condition(), Condition::Whole);
    let end = recording.end().unwrap();
    assert_eq!(
        end.get("stop_reason").map(String::as_str),
        Some("interrupted")
    );
}
