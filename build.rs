//! What the program knows of its own build, as `src/archive/provenance.rs` reads it.
//!
//! Only release builds name their commit: others would compile everything again after each.

use std::env;
use std::fs;
use std::process::Command;

/// What is compiled.
const COMPILED: [&str; 5] = ["src", "schemas", "build.rs", "Cargo.toml", "Cargo.lock"];

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let profile = env::var("PROFILE").unwrap_or_default();
    let compiler = env::var("RUSTC")
        .ok()
        .and_then(|rustc| output(&rustc, &["--version"]));
    set("TARGET", env::var("TARGET").ok());
    set("COMPILER", compiler);
    if profile == "release" {
        let commit = commit_of_package().or_else(commit_of_checkout);
        set("COMMIT", commit);
    }
    set("PROFILE", Some(profile));
}

fn set(name: &str, value: Option<String>) {
    let value = value.unwrap_or_default();
    println!("cargo::rustc-env=TOPRISE_BUILD_{name}={value}");
}

/// The commit from which Cargo made the package that is built.
fn commit_of_package() -> Option<String> {
    let info = fs::read_to_string(".cargo_vcs_info.json").ok()?;
    let (_, rest) = info.split_once("\"sha1\": \"")?;
    let (commit, _) = rest.split_once('"')?;
    Some(with_changes(commit, info.contains("\"dirty\": true")))
}

/// The commit of the checkout that is built.
fn commit_of_checkout() -> Option<String> {
    // The folder may lie in another project's checkout.
    fs::metadata(".git").ok()?;
    let log = output("git", &["rev-parse", "--git-path", "logs/HEAD"])?;
    for path in COMPILED.into_iter().chain([log.as_str()]) {
        println!("cargo::rerun-if-changed={path}");
    }
    let commit = output("git", &["rev-parse", "HEAD"])?;
    let status = ["status", "--porcelain", "--untracked-files=no", "--"];
    let changes = output("git", &[&status[..], &COMPILED].concat())?;
    Some(with_changes(&commit, !changes.is_empty()))
}

fn with_changes(commit: &str, is_changed: bool) -> String {
    let note = if is_changed { " with changes" } else { "" };
    format!("{commit}{note}")
}

/// What a program prints, if it succeeds.
fn output(program: &str, arguments: &[&str]) -> Option<String> {
    let output = Command::new(program).args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    output.status.success().then(|| text.trim().to_owned())
}
