//! The program as a process.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

/// The program.
pub fn program() -> PathBuf {
    PathBuf::from(env!("CARGO_BIN_EXE_toprise"))
}

/// Starts the program in a directory; what it prints goes into the files `stdout` and `stderr` there.
pub fn start(directory: &Path, arguments: &[&str]) -> Child {
    start_with(Command::new(program()).args(arguments), directory)
}

/// Starts a command in a directory; what it prints goes into the files `stdout` and `stderr` there.
pub fn start_with(command: &mut Command, directory: &Path) -> Child {
    let open = |name: &str| {
        let mut options = fs::OpenOptions::new();
        let file = options.create(true).append(true).open(directory.join(name));
        Stdio::from(file.unwrap())
    };
    command.current_dir(directory).stdin(Stdio::null());
    command.stdout(open("stdout")).stderr(open("stderr"));
    command.spawn().unwrap()
}

/// What the programs in a directory have said on standard error.
pub fn errors(directory: &Path) -> String {
    let text = fs::read(directory.join("stderr")).unwrap_or_default();
    let text = String::from_utf8_lossy(&text);
    text.lines().take(6).collect::<Vec<_>>().join(" | ")
}

/// How a process ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ended {
    /// Its exit code; none if a signal ended it.
    pub code: Option<i32>,
    /// Its greatest memory, bytes, as far as it was seen.
    pub memory: u64,
}

/// Waits for a process to end; kills it if that takes too long.
pub fn wait(mut child: Child, limit: Duration) -> Result<Ended, String> {
    let started = Instant::now();
    let mut memory = 0;
    loop {
        memory = memory.max(memory_of(&child));
        if let Some(status) = child.try_wait().unwrap() {
            let code = status.code();
            return match code {
                Some(101 | 134) => Err(format!("it panicked: exit code {code:?}")),
                _ => Ok(Ended { code, memory }),
            };
        }
        if started.elapsed() > limit {
            child.kill().unwrap();
            child.wait().unwrap();
            return Err(format!("it has not ended after {} s", limit.as_secs()));
        }
        thread::sleep(Duration::from_millis(5));
    }
}

/// The peak memory use of a process, if the system reports it.
fn memory_of(child: &Child) -> u64 {
    let status = fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    let kilobytes = line.and_then(|line| line.split_whitespace().next()?.parse::<u64>().ok());
    1024 * kilobytes.unwrap_or(0)
}

/// Waits for a process that must end with an exit code.
pub fn expect(child: Child, directory: &Path, code: i32, limit: Duration) -> Result<(), String> {
    let ended = wait(child, limit).map_err(|error| format!("{error}: {}", errors(directory)))?;
    if ended.code == Some(code) {
        return Ok(());
    }
    let errors = errors(directory);
    Err(format!("exit code {:?}, not {code}: {errors}", ended.code))
}
