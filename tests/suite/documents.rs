//! The documents stay true: links lead somewhere, commands are understood, and what they are said to print is what
//! they print.

use crate::generated::{self, foxglove_layout};
use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::{Path, PathBuf};
use toprise::physics::dynamics::Support;
use toprise::run::scenario::{KEYS, Kind};
use toprise::telemetry::Topic;
use toprise::telemetry::views::VIEW_CHANNELS;

/// What stands for any text within a line of output, and alone on a line for any lines.
const ANYTHING: &str = "…";

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

fn documents() -> Vec<(PathBuf, String)> {
    let mut paths: Vec<PathBuf> = ["", "docs", "recordings"]
        .iter()
        .flat_map(|folder| fs::read_dir(root().join(folder)).unwrap())
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "md"))
        .collect();
    paths.sort();
    assert!(paths.len() > 8, "only {} documents are found", paths.len());
    paths
        .into_iter()
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            (path, text)
        })
        .collect()
}

/// Blocks of code in a language, as lines.
fn blocks<'a>(text: &'a str, language: &str) -> Vec<Vec<&'a str>> {
    let mut blocks = Vec::new();
    let mut lines = text.lines();
    while let Some(line) = lines.next() {
        if let Some(found) = line.strip_prefix("```") {
            let block: Vec<&str> = lines
                .by_ref()
                .take_while(|l| !l.starts_with("```"))
                .collect();
            if found == language {
                blocks.push(block);
            }
        }
    }
    blocks
}

#[test]
fn links_point_to_files() {
    let mut links = 0;
    for (path, text) in documents() {
        for rest in text.split("](").skip(1) {
            let target = rest.split(')').next().unwrap().split('#').next().unwrap();
            if target.is_empty() || target.contains("://") {
                continue;
            }
            links += 1;
            let file = path.parent().unwrap().join(target);
            assert!(file.exists(), "{} links to {target}", path.display());
        }
    }
    assert!(links > 20, "only {links} links are found");
}

#[test]
fn documented_commands_parse() {
    let mut commands = 0;
    for (path, text) in documents() {
        for line in blocks(&text, "sh").into_iter().flatten() {
            let line = line.split(" #").next().unwrap().trim();
            let Some(line) = line.strip_prefix("toprise ") else {
                continue;
            };
            let line = line.split(" > ").next().unwrap();
            if cfg!(not(feature = "rerun")) && needs_rerun(line) {
                continue;
            }
            if cfg!(not(feature = "fit")) && line.starts_with("fit ") {
                continue;
            }
            let needs_sweep = line.contains("sweep") || line.contains("--row");
            if cfg!(not(feature = "sweep")) && needs_sweep {
                continue;
            }
            commands += 1;
            let words = line.split_whitespace().map(|word| word.trim_matches('\''));
            let parsed = toprise::cli::command()
                .try_get_matches_from(std::iter::once("toprise").chain(words));
            assert!(
                parsed.is_ok(),
                "{}: toprise {line}: {}",
                path.display(),
                parsed.unwrap_err()
            );
        }
    }
    assert!(commands > 10, "only {commands} commands are found");
}

fn needs_rerun(line: &str) -> bool {
    ["view", "--rrd", "--spawn", "--connect"]
        .iter()
        .any(|word| line.split_whitespace().any(|other| other == *word))
}

/// Runs what the documents show with its output, and compares.
#[test]
#[cfg_attr(
    not(feature = "rerun"),
    ignore = "the documents show the program with Rerun"
)]
fn commands_print_what_the_documents_show() {
    let directory = tempfile::tempdir().unwrap();
    fs::create_dir(directory.path().join("recordings")).unwrap();
    fs::write(directory.path().join("Cargo.toml"), "").unwrap();
    let run = |line: &str| {
        let output = Command::cargo_bin("toprise")
            .unwrap()
            .args(line.split_whitespace())
            .current_dir(directory.path())
            .output()
            .unwrap();
        String::from_utf8(output.stdout).unwrap()
    };
    let paper = run("run");
    let mut sessions = 0;
    for (path, text) in documents() {
        for block in blocks(&text, "text") {
            let Some(line) = block.first().and_then(|l| l.strip_prefix("$ toprise ")) else {
                continue;
            };
            sessions += 1;
            let printed = if line == "run" {
                paper.clone()
            } else {
                run(line)
            };
            let printed: Vec<&str> = printed.lines().collect();
            assert!(
                is_shown(&block[1..], &printed),
                "{}: toprise {line} prints now:\n{}",
                path.display(),
                printed.join("\n")
            );
        }
    }
    assert!(sessions >= 4, "only {sessions} sessions are found");
}

/// Whether the lines of a document are those of an output.
fn is_shown(shown: &[&str], printed: &[&str]) -> bool {
    match (shown.split_first(), printed.split_first()) {
        (None, None) => true,
        (Some((&ANYTHING, rest)), _) => {
            (0..=printed.len()).any(|from| is_shown(rest, &printed[from..]))
        }
        (Some((line, shown)), Some((other, printed))) => {
            is_line(line, other) && is_shown(shown, printed)
        }
        _ => false,
    }
}

/// Whether a line is the shown one; the time that something took is another one each time.
fn is_line(shown: &str, printed: &str) -> bool {
    let of_time = |line: &str| line.trim_start().starts_with("took ");
    if of_time(shown) && of_time(printed) {
        return shown.split(';').skip(1).eq(printed.split(';').skip(1));
    }
    match shown.split_once(ANYTHING) {
        Some((before, after)) => printed
            .strip_prefix(before)
            .is_some_and(|rest| rest.ends_with(after)),
        None => shown.trim_end() == printed.trim_end(),
    }
}

/// `cargo run --no-default-features --example generate` writes them.
#[test]
fn generated_pages_are_current() {
    for (path, page) in generated::pages() {
        let written = fs::read_to_string(root().join(path)).unwrap();
        assert!(written == page, "{path} is stale; the new one is\n{page}");
    }
}

/// The program of the format's page is the one that the tests run.
#[test]
fn format_page_shows_the_tested_program() {
    let page = fs::read_to_string(root().join("docs/format.md")).unwrap();
    let program = fs::read_to_string(root().join("tests/readers/digest.py")).unwrap();
    assert!(page.contains(&format!("```python\n{program}```\n")));
}

#[test]
fn foxglove_layouts_show_existing_panels_and_topics() {
    for support in [Support::FixedPeg, Support::FreePeg { restitution: 0.0 }] {
        let layout: Value = serde_json::from_str(&foxglove_layout(support)).unwrap();
        let panels = layout["configById"].as_object().unwrap();
        let mut shown = Vec::new();
        shown_panels(&layout["layout"], &mut shown);
        for tab in panels["Tab!plots"]["tabs"].as_array().unwrap() {
            shown_panels(&tab["layout"], &mut shown);
        }
        shown.sort_unstable();
        let mut all: Vec<_> = panels.keys().cloned().collect();
        all.sort_unstable();
        assert_eq!(shown, all, "each panel is shown once");
        let views = VIEW_CHANNELS.iter();
        let mut topics: Vec<_> = views.map(|view| view.topic).collect();
        topics.extend(Topic::all_with(support).map(|topic| topic.info().topic));
        let scene = panels["3D!top"]["topics"].as_object().unwrap();
        let log = panels["RosOut!events"]["topicToRender"].as_str().unwrap();
        let paths = panels
            .values()
            .filter_map(|panel| panel["paths"].as_array());
        let paths = paths.flatten().map(|path| path["value"].as_str().unwrap());
        let plotted = paths.map(|path| path.split_once('.').unwrap().0);
        for topic in scene.keys().map(String::as_str).chain([log]).chain(plotted) {
            assert!(topics.contains(&topic), "{topic}");
        }
    }
}

/// The panels in a tree of rows and columns.
fn shown_panels(node: &Value, shown: &mut Vec<String>) {
    if let Some(panel) = node.as_str() {
        shown.push(panel.to_owned());
        return;
    }
    for part in ["first", "second"] {
        shown_panels(&node[part], shown);
    }
}

#[test]
fn scenario_schema_has_every_key() {
    let text = toprise::run::scenario::schema();
    let schema: serde_json::Value = serde_json::from_str(&text).unwrap();
    for key in KEYS {
        let mut part = &schema;
        for name in key.path.split('.') {
            part = &part["properties"][name];
        }
        let meaning = part["description"].as_str().unwrap();
        assert!(meaning.starts_with(key.meaning), "{}", key.path);
        assert_eq!(
            part.get("enum").is_some(),
            matches!(key.kind, Kind::Choice(_))
        );
    }
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas/scenario.json");
    assert_eq!(fs::read_to_string(file).unwrap(), text);
}

/// Commands of documents with files of the repository, run where it was cloned.
#[cfg(feature = "fit")]
#[test]
fn fit_examples_run_in_a_clone() {
    let mut commands = 0;
    for (path, text) in documents() {
        for line in text.lines().filter(|line| line.contains("docs/example/")) {
            let line = line.split(" #").next().unwrap().trim_start_matches("$ ");
            let Some(arguments) = line.strip_prefix("toprise ") else {
                continue;
            };
            commands += 1;
            let output = Command::cargo_bin("toprise")
                .unwrap()
                .args(arguments.split_whitespace())
                .current_dir(root())
                .output()
                .unwrap();
            let report = String::from_utf8_lossy(&output.stdout);
            assert!(
                output.status.success(),
                "{}: {line}: {report}",
                path.display()
            );
        }
    }
    assert_eq!(commands, 4, "two in the README, two in docs/fit.md");
}
