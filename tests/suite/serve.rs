//! The web viewer that `--serve` serves, with the feature `web-viewer`.

use std::fs;
use std::io::{BufRead as _, BufReader, Read as _, Write as _};
use std::net::{TcpListener, TcpStream};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use tempfile::tempdir;

/// A port such that it and the next one are free.
fn free_port() -> u16 {
    loop {
        let port = TcpListener::bind("127.0.0.1:0")
            .unwrap()
            .local_addr()
            .unwrap()
            .port();
        if port < u16::MAX && TcpListener::bind(("127.0.0.1", port + 1)).is_ok() {
            return port;
        }
    }
}

fn serve(directory: &Path, arguments: &[&str]) -> (Child, u16, Vec<String>) {
    let port = free_port();
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("toprise"))
        .current_dir(directory)
        .args(arguments)
        .arg(format!("--serve=127.0.0.1:{port}"))
        .stderr(Stdio::piped())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let mut lines = Vec::new();
    let mut errors = BufReader::new(child.stderr.take().unwrap());
    while !lines
        .last()
        .is_some_and(|line: &String| line.starts_with("still serving"))
    {
        let mut line = String::new();
        assert!(
            errors.read_line(&mut line).unwrap() > 0,
            "it ended: {lines:?}"
        );
        lines.push(line);
    }
    (child, port, lines)
}

fn interrupt(mut child: Child) -> Option<i32> {
    let id = child.id().to_string();
    assert!(
        Command::new("kill")
            .args(["-INT", &id])
            .status()
            .unwrap()
            .success()
    );
    child.wait().unwrap().code()
}

/// The answer to a request for the page.
fn page(port: u16) -> String {
    let mut stream = TcpStream::connect(("127.0.0.1", port)).unwrap();
    stream
        .write_all(b"GET / HTTP/1.1\r\nHost: localhost\r\nConnection: close\r\n\r\n")
        .unwrap();
    let mut answer = Vec::new();
    let _ = stream.read_to_end(&mut answer);
    String::from_utf8_lossy(&answer).into_owned()
}

#[test]
fn runs_and_recordings_are_served_until_ctrl_c() {
    let directory = tempdir().unwrap();
    let run = ["run", "--set", "stop.duration=0.2", "-o", "a.mcap"];
    for arguments in [&run[..], &["view", "a.mcap"]] {
        let (child, port, lines) = serve(directory.path(), arguments);
        let url = format!(
            "http://127.0.0.1:{port}/?url=rerun%2Bhttp%3A%2F%2F127.0.0.1%3A{}%2Fproxy",
            port + 1
        );
        assert_eq!(lines[0], format!("serving at {url}\n"));
        let page = page(port);
        assert!(page.contains("200 OK") && page.contains("Rerun"), "{page}");
        assert!(TcpStream::connect(("127.0.0.1", port + 1)).is_ok());

        // The port is taken now.
        let second = Command::new(assert_cmd::cargo::cargo_bin("toprise"))
            .current_dir(directory.path())
            .args(["view", "a.mcap", &format!("--serve=127.0.0.1:{port}")])
            .output()
            .unwrap();
        assert_eq!(second.status.code(), Some(2));
        let error = String::from_utf8_lossy(&second.stderr).into_owned();
        assert!(
            error.contains("in use") && error.contains("--serve="),
            "{error}"
        );
        assert_eq!(interrupt(child), Some(0));
    }
    assert!(fs::metadata(directory.path().join("a.mcap")).unwrap().len() > 1000);
}

/// A browser shows the recording: what it draws is neither empty nor of one colour.
#[test]
fn val_a_browser_shows_a_recording() {
    let Some(python) = std::env::var_os("TOPRISE_BROWSER_PYTHON") else {
        eprintln!("skipped: TOPRISE_BROWSER_PYTHON does not name a Python with Playwright");
        return;
    };
    let directory = tempdir().unwrap();
    let run = ["run", "--set", "stop.duration=0.5", "-o", "a.mcap"];
    let (child, _, lines) = serve(directory.path(), &run);
    let url = lines[0].trim_start_matches("serving at ").trim_end();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/browser.py");
    let output = Command::new(python).arg(script).arg(url).output().unwrap();
    assert_eq!(interrupt(child), Some(0));
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{errors}");
}
