//! Runs that are killed, that contend for one name, and that are asked to end.

use crate::bench::{Random, Trial};
use crate::material::failure;
use crate::program::{expect, start, wait};
use std::fs;
use std::path::Path;
use std::process::{Child, Command};
use std::thread;
use std::time::Duration;
use tempfile::tempdir;
use toprise::archive::recording::Recording;
use toprise::archive::verify::verify;

/// Longer than anything here should take on a busy machine.
const LONG: Duration = Duration::from_mins(2);
/// In which a program that is asked to end must end on a busy machine.
const SOON: Duration = Duration::from_secs(10);

/// Forms of a run.
const FORMS: [&[&str]; 5] = [
    &[],
    &["--encoding", "protobuf"],
    &["--no-views"],
    &["--topics", "/top/state,/events", "--encoding", "protobuf"],
    &["--realtime"],
];

/// The bytes that a run gives.
fn whole(arguments: &[&str]) -> Vec<u8> {
    let directory = tempdir().unwrap();
    let run = start(directory.path(), &[arguments, &["-o", "x.mcap"]].concat());
    expect(run, directory.path(), 0, LONG).unwrap();
    fs::read(directory.path().join("x.mcap")).unwrap()
}

/// Kills runs at any moment: what they leave is run again to the bytes of the whole run.
pub fn kills() -> Result<Trial, String> {
    const RUN: [&str; 3] = ["run", "--set", "stop.duration=2"];
    // Real time parts the chunks otherwise, but a run that is killed doesn't reach its end.
    let timeless = |form: &[&'static str]| match form {
        ["--realtime"] => whole(&RUN),
        form => whole(&[&RUN[..], form].concat()),
    };
    let wholes = FORMS.map(timeless);
    Ok(Box::new(move |random| {
        let form = random.below(FORMS.len());
        let directory = tempdir().unwrap();
        let room = directory.path();
        let mut run = start(room, &[&RUN[..], FORMS[form], &["-o", "x.mcap"]].concat());
        let moment = random.about(1.0, 800.0);
        thread::sleep(Duration::from_secs_f64(moment / 1e3));
        run.kill().unwrap();
        run.wait().unwrap();
        let named = room.join("x.mcap");
        if !named.exists() {
            if !room.join("x.mcap.partial").exists() {
                return Ok(()); // It had not begun.
            }
            let again = ["run", "x.mcap.partial", "-o", "x.mcap", "--force"];
            let ended = expect(start(room, &again), room, 0, LONG);
            ended.map_err(|error| format!("after {moment:.1} ms: {error}"))?;
        }
        if fs::read(&named).unwrap() != wholes[form] {
            let form = FORMS[form];
            return Err(format!(
                "{form:?} after {moment:.1} ms: run again to other bytes"
            ));
        }
        Ok(())
    }))
}

/// Starts several runs at once, with one name that they replace or with default names: each ends well, and each
/// file is whole.
pub fn races() -> Result<Trial, String> {
    const RUN: [&str; 3] = ["run", "--set", "stop.duration=0.3"];
    const TWO: [&[&str]; 2] = [&[], &["--encoding", "protobuf"]];
    let wholes: Vec<_> = TWO.map(|form| whole(&[&RUN[..], form].concat())).into();
    Ok(Box::new(move |random| {
        let directory = tempdir().unwrap();
        let room = directory.path();
        let count = 2 + random.below(3);
        let one_name = random.below(2) == 0;
        let target: &[&str] = if one_name {
            &["-o", "x.mcap", "--force"]
        } else {
            &[]
        };
        let runs: Vec<_> = (0..count)
            .map(|number| start(room, &[&RUN[..], TWO[number % 2], target].concat()))
            .collect();
        for run in runs {
            expect(run, room, 0, LONG)?;
        }
        let place = if one_name {
            room.to_owned()
        } else {
            room.join("recordings")
        };
        let entries = fs::read_dir(place)
            .unwrap()
            .map(|entry| entry.unwrap().path());
        let files: Vec<_> = entries
            .filter(|path| path.file_name().unwrap() != "stdout")
            .collect();
        let recordings = files
            .iter()
            .filter(|path| path.extension().is_some_and(|e| e == "mcap"));
        let contents: Vec<_> = recordings.map(|path| fs::read(path).unwrap()).collect();
        // A recording that another run has finished meanwhile is not written again.
        let expected = if one_name {
            1..=1
        } else {
            count.min(TWO.len())..=count
        };
        if !expected.contains(&contents.len()) {
            return Err(format!(
                "{} files, not {expected:?}: {files:?}",
                contents.len()
            ));
        }
        if !contents.iter().all(|content| wholes.contains(content)) {
            return Err("a published file is not whole".to_owned());
        }
        let left = |path: &&std::path::PathBuf| {
            let name = path.to_string_lossy().into_owned();
            name.ends_with(".partial") || name.ends_with(".tmp")
        };
        match files.iter().find(left) {
            Some(path) => Err(format!("{} is left", path.display())),
            None => Ok(()),
        }
    }))
}

/// Asks programs to end while they are at work or wait, and gives them files that never come: each ends soon, and
/// what a run has recorded is published.
pub fn signals() -> Result<Trial, String> {
    const LONGEST: &str = "stop.duration=1e6";
    let runs: [&[&str]; 5] = [
        &["run", "--realtime", "-o", "x.mcap"],
        &["run", "--realtime", "1e-30", "-o", "x.mcap"],
        &[
            "run",
            "frictionless",
            "--set",
            LONGEST,
            "-o",
            "x.mcap",
            "--topics",
            "/events",
        ],
        // No record comes for hours of work.
        &[
            "run",
            "frictionless",
            "--set",
            LONGEST,
            "--set",
            "sampling.period=3600",
            "--set",
            "initial.psi_dot=1e6",
            "--set",
            "initial.theta=0.5",
            "--topics",
            "/top/state",
            "-o",
            "x.mcap",
        ],
        &["run", "viscous", "--realtime", "0.001", "-o", "x.mcap"],
    ];
    let others: [&[&str]; 3] = [
        &["diff", "frictionless", "paper", "--set", LONGEST],
        &["explain", "frictionless", "--set", LONGEST],
        &["verify", "fifo"],
    ];
    let fifos: [&[&str]; 5] = [
        &["info", "fifo"],
        &["verify", "fifo"],
        &["run", "./fifo"],
        &["diff", "fifo", "paper"],
        &["run", "--set", "stop.duration=0.1", "-o", "fifo", "--force"],
    ];
    Ok(Box::new(move |random| {
        let directory = tempdir().unwrap();
        let room = directory.path();
        let made = Command::new("mkfifo").arg(room.join("fifo")).status();
        if !made.is_ok_and(|status| status.success()) {
            return Err("mkfifo is missing".to_owned());
        }
        let case = usize::try_from(random.case).unwrap() % 3;
        if case == 2 {
            let arguments = random.one_of(&fifos);
            let ended = expect(start(room, arguments), room, 2, SOON);
            return ended.map_err(|error| format!("{arguments:?}: {error}"));
        }
        let is_run = case == 0;
        let arguments = if is_run {
            random.one_of(&runs)
        } else {
            random.one_of(&others)
        };
        let mut program = start(room, arguments);
        thread::sleep(Duration::from_secs_f64(random.between(0.3, 1.5)));
        if program.try_wait().unwrap().is_some() {
            return Ok(());
        }
        let signal = ask(&program, random);
        let described = |error: String| format!("{arguments:?} after {signal}: {error}");
        if !is_run {
            return wait(program, SOON).map(|_| ()).map_err(described);
        }
        expect(program, room, 3, SOON).map_err(described)?;
        is_sound(&room.join("x.mcap")).map_err(described)
    }))
}

/// Sends a signal that asks for an end.
fn ask(program: &Child, random: &mut Random) -> &'static str {
    // A shell starts a command before `&` with Ctrl-C ignored, which the programs below inherit.
    let signals = if is_ctrl_c_ignored() {
        &["-TERM"][..]
    } else {
        &["-INT", "-TERM"]
    };
    let signal = *random.one_of(signals);
    let id = program.id().to_string();
    Command::new("kill").args([signal, &id]).status().unwrap();
    signal
}

/// Whether this process and its children ignore Ctrl-C, if the system reports it.
fn is_ctrl_c_ignored() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_some_and(|mask| mask & 0b10 != 0)
}

fn is_sound(path: &Path) -> Result<(), String> {
    let recording = Recording::open(path).map_err(|error| error.to_string())?;
    let report = verify(&recording, &|_| {}).map_err(|error| error.to_string())?;
    failure(&report).map_or(Ok(()), Err)
}
