//! Surroundings that are not as usual: settings, streams, directories, limits, processors.

use crate::bench::Trial;
use crate::program::{expect, program, start, start_with};
use std::fs;
use std::path::Path;
use std::process::Command;
use std::time::Duration;
use tempfile::tempdir;

const LONG: Duration = Duration::from_mins(2);

/// Something around the program, as a line of a shell in which `$T` is the program and `$R` a short run into
/// `x.mcap`; the exit code; whether `x.mcap` must be there then.
type Surroundings = (&'static str, i32, bool);

const SURROUNDINGS: [Surroundings; 41] = [
    // Settings.
    ("LANG=C $R", 0, true),
    ("LC_ALL=POSIX $R", 0, true),
    ("LC_ALL=de_DE.UTF-8 $R", 0, true),
    ("LC_ALL=tr_TR.UTF-8 $R", 0, true),
    ("LC_ALL=nonsense $R", 0, true),
    ("TERM=dumb $R", 0, true),
    ("env -u TERM $R", 0, true),
    ("TERM=xterm-256color CLICOLOR_FORCE=1 $R", 0, true),
    ("NO_COLOR=1 $R", 0, true),
    ("COLUMNS=1 $R && COLUMNS=1 $T diff x.mcap paper", 1, true),
    ("COLUMNS=99999 $R", 0, true),
    ("COLUMNS=nonsense $R", 0, true),
    ("env -u HOME $R", 0, true),
    ("HOME=/nonexistent $R", 0, true),
    ("env -i $R", 0, true),
    ("TMPDIR=/nonexistent $R", 0, true),
    ("PATH= $R", 0, true),
    ("TZ=Pacific/Apia $R", 0, true),
    ("RUST_BACKTRACE=full RUST_LOG=trace $R", 0, true),
    // Streams.
    ("$R <&-", 0, true),
    ("$R >&-", 0, true),
    ("$R >/dev/full", 2, true),
    ("$R 2>&-", 0, true),
    ("$R 2>/dev/full", 0, true),
    ("$T run --set k= -o x.mcap 2>/dev/full", 2, false),
    ("$T run nonsense 2>&-", 2, false),
    ("$R | true; exit ${PIPESTATUS[0]}", 0, true),
    (
        "$T info missing.mcap 2>&1 >/dev/null | true; exit ${PIPESTATUS[0]}",
        2,
        false,
    ),
    // Directories and names.
    ("mkdir gone && cd gone && rmdir ../gone && $R", 2, false),
    ("$T run --set stop.duration=0.1 -o /proc/x.mcap", 2, false),
    (
        "$T run --set stop.duration=0.1 -o /dev/full --force",
        2,
        false,
    ),
    (
        "$T run --set stop.duration=0.1 -o $(printf 'x%.0s' {1..250}).mcap",
        2,
        false,
    ),
    (
        "mkdir d && $T run --set stop.duration=0.1 -o d --force",
        2,
        false,
    ),
    (
        "mkdir 'a ü\u{1f600}' && cd 'a ü\u{1f600}' && $R && mv x.mcap ..",
        0,
        true,
    ),
    (
        "$T run --set stop.duration=0.1 -o $'\\xff.mcap' && mv $'\\xff.mcap' x.mcap",
        0,
        true,
    ),
    (
        "mkdir d && ln -s d e && cd e && $R && mv x.mcap ..",
        0,
        true,
    ),
    ("umask 777; $R", 0, true),
    // Limits.
    ("ulimit -n 16; $R", 0, true),
    ("ulimit -s 256; $R", 0, true),
    ("trap '' INT TERM HUP PIPE; nice -n 19 $R", 0, true),
    ("trap '' XFSZ; ulimit -f 20; $R", 2, false),
];

/// How many surroundings there are.
pub const COUNT: u64 = SURROUNDINGS.len() as u64;

const RUN: [&str; 5] = ["run", "--set", "stop.duration=0.1", "-o", "x.mcap"];

fn whole() -> Vec<u8> {
    let directory = tempdir().unwrap();
    expect(start(directory.path(), &RUN), directory.path(), 0, LONG).unwrap();
    fs::read(directory.path().join("x.mcap")).unwrap()
}

/// Records in each of the surroundings: the bytes are always those of a usual run.
pub fn environments() -> Result<Trial, String> {
    let whole = whole();
    Ok(Box::new(move |random| {
        let (line, code, is_recorded) = SURROUNDINGS[usize::try_from(random.case).unwrap()];
        let directory = tempdir().unwrap();
        let room = directory.path();
        let run = format!("$T {}", RUN.join(" "));
        let line_in_full = line
            .replace("$R", &run)
            .replace("$T", &program().to_string_lossy());
        let mut shell = Command::new("bash");
        shell.args(["-c", &line_in_full]);
        let described = |error: String| format!("{line}: {error}");
        expect(start_with(&mut shell, room), room, code, LONG).map_err(described)?;
        check(room, is_recorded, &whole).map_err(described)
    }))
}

fn check(room: &Path, is_recorded: bool, whole: &[u8]) -> Result<(), String> {
    match fs::read(room.join("x.mcap")) {
        Ok(bytes) if is_recorded && bytes == whole => Ok(()),
        Ok(_) if is_recorded => Err("other bytes are recorded".to_owned()),
        Err(_) if !is_recorded => Ok(()),
        Ok(_) => Err("something is recorded".to_owned()),
        Err(error) => Err(format!("nothing is recorded: {error}")),
    }
}

/// Models that QEMU supports.
const MODELS: [&str; 5] = ["max", "qemu64", "Nehalem", "Haswell", "EPYC"];

/// How many processors are emulated.
pub const CPUS: u64 = MODELS.len() as u64;

/// Records on emulated processors: the bytes are those of this one.
pub fn cpus() -> Result<Trial, String> {
    if !cfg!(target_arch = "x86_64") {
        return Err("this is another processor than QEMU is asked for".to_owned());
    }
    let found = Command::new("qemu-x86_64").arg("--version").output();
    found.map_err(|_| "no qemu-x86_64 is installed".to_owned())?;
    let whole = whole();
    Ok(Box::new(move |random| {
        let model = MODELS[usize::try_from(random.case).unwrap() % MODELS.len()];
        let directory = tempdir().unwrap();
        let room = directory.path();
        let mut emulated = Command::new("qemu-x86_64");
        emulated.args(["-cpu", model]).arg(program()).args(RUN);
        let described = |error: String| format!("{model}: {error}");
        expect(start_with(&mut emulated, room), room, 0, 5 * LONG).map_err(described)?;
        check(room, true, &whole).map_err(described)
    }))
}
