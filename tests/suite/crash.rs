//! Runs that are killed or run out of space: what was on the disk stays readable and can be run again.

use crate::support::{assert_contains, verified};
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::Duration;
use toprise::archive::recording::{Condition, Overview, Recording, Selection};
use toprise::archive::verify::Verdict;
use toprise::telemetry::Topics;

/// Runs that are killed.
const KILLS: u64 = 24;
const SCENARIO: [&str; 2] = ["--set", "stop.duration=10"];

const PROGRAM: &str = env!("CARGO_BIN_EXE_toprise");

/// Forms of a run.
const FORMS: [&[&str]; 2] = [
    &["--encoding", "json"],
    &["--encoding", "protobuf", "--topics", "/top/state,/events"],
];

/// A run in the background.
fn start(directory: &Path, arguments: &[&str]) -> Child {
    Command::new(PROGRAM)
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

/// Waits until something is so, for twenty seconds at most.
fn wait_until(mut is_so: impl FnMut() -> bool) {
    for _ in 0..1000 {
        if is_so() {
            break;
        }
        thread::sleep(Duration::from_millis(20));
    }
}

/// Kills a run some milliseconds after its first messages have reached the disk.
fn killed_after(directory: &Path, form: &[&str], milliseconds: u64, expected: &[u8]) {
    let partial = directory.join("live.mcap.partial");
    let paced = ["--realtime", "4", "-o", "live.mcap"];
    let mut run = start(directory, &[&SCENARIO, form, &paced].concat());
    wait_until(|| messages(&partial) > 0);
    thread::sleep(Duration::from_millis(milliseconds));
    let before = messages(&partial);
    assert!(before > 0, "the run doesn't write anything");
    run.kill().unwrap();
    run.wait().unwrap();

    let recording = Recording::open(&partial).unwrap();
    assert_eq!(recording.condition(), Condition::Interrupted);
    let overview = Overview::new(&recording);
    let after = overview.messages();
    assert!(after >= before, "{after} of {before}");
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
fn killed_runs_lose_nothing_on_disk() {
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
fn reports_full_file_systems() {
    let directory = tempfile::tempdir().unwrap();
    let room = directory.path().join("room");
    fs::create_dir(&room).unwrap();
    let script = format!(
        "mount -t tmpfs -o size=400k tmpfs {room} || exit 99; cd {room}; \
         {PROGRAM} run -o full.mcap; code=$?; cp full.mcap.partial ..; ls; exit $code",
        room = room.display(),
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
fn signals_end_runs_without_records() {
    let directory = tempfile::tempdir().unwrap();
    let mut program = Command::new(PROGRAM);
    program.args(["run", "-o", "still.mcap"]);
    for change in [
        "initial.psi_dot=1e6",
        "sampling.period=3600",
        "stop.duration=1e5",
        "stop.theta_risen=",
        "stop.theta_fallen=",
    ] {
        program.args(["--set", change]);
    }
    program.stdout(Stdio::null()).stderr(Stdio::null());
    let mut run = program.current_dir(directory.path()).spawn().unwrap();
    let partial = directory.path().join("still.mcap.partial");
    wait_until(|| fs::metadata(&partial).is_ok_and(|metadata| metadata.len() > 0));
    let pid = run.id().to_string();
    let killed = Command::new("kill").args(["-TERM", &pid]).status();
    assert!(killed.unwrap().success());
    let mut status = None;
    wait_until(|| {
        status = run.try_wait().unwrap();
        status.is_some()
    });
    if status.is_none() {
        run.kill().unwrap();
    }
    assert_eq!(status.and_then(|status| status.code()), Some(3));
    let recording = Recording::open(&directory.path().join("still.mcap")).unwrap();
    assert_eq!(recording.condition(), Condition::Interrupted);
    let end = recording.end().unwrap();
    assert_eq!(end["stop_reason"], "interrupted");
}
