//! `toprise diff` as a process: exit codes, forms of the report, files.

use assert_cmd::Command;
use serde_json::Value;
use std::fs;
use std::path::Path;
use tempfile::{TempDir, tempdir};
use toprise::archive::recording::{Condition, Recording, Selection};
use unicode_width::UnicodeWidthStr as _;

const TWO: [&str; 6] = [
    "diff",
    "paper",
    "full-coulomb",
    "--set",
    "stop.duration=0.5",
    "--no-floor",
];

fn toprise(directory: &TempDir) -> Command {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command.current_dir(directory.path()).env_remove("NO_COLOR");
    command
}

/// Runs it; gives standard output and standard error.
#[track_caller]
fn ends(directory: &TempDir, arguments: &[&str], code: i32) -> (String, String) {
    let mut command = toprise(directory);
    let output = command
        .args(arguments)
        .assert()
        .code(code)
        .get_output()
        .clone();
    let text = |bytes| String::from_utf8(bytes).unwrap();
    (text(output.stdout), text(output.stderr))
}

fn record(directory: &TempDir, name: &str, more: &[&str]) {
    let mut command = toprise(directory);
    command
        .args(["run", "--set", "stop.duration=0.5", "-o", name])
        .args(more);
    if cfg!(feature = "rerun") {
        command.arg("--no-rrd");
    }
    command.assert().success();
}

fn foreign(name: &str) -> String {
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/foreign");
    data.join(name).display().to_string()
}

#[test]
fn exit_codes_tell_how_it_ended() {
    let directory = tempdir().unwrap();
    record(&directory, "a.mcap", &[]);
    record(&directory, "b.mcap", &["--encoding", "protobuf"]);
    record(&directory, "c.mcap", &["--set", "friction.k=0.030001"]);
    let (text, _) = ends(&directory, &["diff", "a.mcap", "b.mcap"], 0);
    assert!(text.contains("The same values"), "{text}");
    let (text, _) = ends(&directory, &["diff", "a.mcap", "c.mcap", "--no-floor"], 1);
    assert!(text.contains("friction.k (A: 0.03, B: 0.030001)"), "{text}");
    let tolerant = [
        "diff",
        "a.mcap",
        "c.mcap",
        "--no-floor",
        "--rel",
        "0.01",
        "--tol",
    ];
    let (text, _) = ends(&directory, &[&tolerant[..], &["*=abs:0.01"]].concat(), 0);
    assert!(text.contains("Equal within the tolerances"), "{text}");
    fs::write(
        directory.path().join("t.toml"),
        "[fields]\n\"*\" = { abs = 0.01, rel = 0.01 }\n",
    )
    .unwrap();
    ends(
        &directory,
        &[
            "diff",
            "a.mcap",
            "c.mcap",
            "--tolerances",
            "t.toml",
            "--no-floor",
        ],
        0,
    );
    // What was cut off is equal as far as it goes.
    let bytes = fs::read(directory.path().join("a.mcap")).unwrap();
    fs::write(directory.path().join("cut.mcap"), &bytes[..bytes.len() / 2]).unwrap();
    let (text, _) = ends(&directory, &["diff", "a.mcap", "cut.mcap"], 3);
    assert!(text.contains("as far as both can be read"), "{text}");
    assert!(text.contains("interrupted"), "{text}");
    let (text, _) = ends(
        &directory,
        &["diff", "a.mcap", "paper", "--set", "stop.duration=0.5"],
        0,
    );
    assert!(text.contains("simulated now"), "{text}");
    let (text, _) = ends(&directory, &["diff", "a.mcap", "a.mcap"], 0);
    assert!(text.contains("A and B are the same file"), "{text}");
}

#[test]
fn what_agrees_in_parts_is_not_equal() {
    let directory = tempdir().unwrap();
    let [a, b] = ["ros2_a.mcap", "ros2_b.mcap"].map(foreign);
    let (text, _) = ends(&directory, &["diff", &a, &a], 0);
    assert!(text.contains("Identical"), "{text}");
    let (text, _) = ends(&directory, &["diff", &a, &b], 1);
    assert!(text.contains("walkér"), "{text}");
    // One is interpolated at the times of the other.
    let [a, b] = ["json_a.mcap", "json_b.mcap"].map(foreign);
    let agreeing = ["diff", &a, &b, "--topics", "/odom", "--abs", "1.1e-4"];
    let (text, _) = ends(&directory, &agreeing, 3);
    assert!(text.contains("Agreeing"), "{text}");
    assert!(text.contains("A has 100 messages in between"), "{text}");
    assert!(!text.contains("B has"), "{text}");
    let (text, _) = ends(
        &directory,
        &[&agreeing[..], &["--format", "junit"]].concat(),
        3,
    );
    assert!(text.contains("failures=\"1\""), "{text}");
    // There is a clock, which can be put forward.
    let later = foreign("later.mcap");
    let (_, error) = ends(&directory, &["diff", &a, &later], 2);
    assert!(error.contains("--offset start"), "{error}");
    ends(&directory, &["diff", &a, &later, "--offset", "start"], 0);
    ends(&directory, &["diff", &a, &later, "--offset", "-1000s"], 0);
    ends(&directory, &["diff", &a, &later, "--offset", "-999.99s"], 1);
}

#[test]
fn bad_input_is_named() {
    let directory = tempdir().unwrap();
    record(&directory, "a.mcap", &[]);
    for (arguments, parts) in [
        (&["a.mcap", "papr"][..], &["papr", "full-coulomb"][..]),
        (&["a.mcap", "missing.mcap"], &["missing.mcap"]),
        (
            &["a.mcap", "a.mcap", "--set-b", "friction.k=1"],
            &["a.mcap is a recording", "friction.k"],
        ),
        (
            &["paper", "paper", "--set-b", "friction.q=1"],
            &["friction.q", "friction.k"],
        ),
        (
            &["paper", "paper", "--tol", "theta"],
            &["theta", "PATTERN=VALUE"],
        ),
        (
            &["paper", "paper", "--tol", "/top/state.thta=1"],
            &["/top/state.thta", "/top/state.theta"],
        ),
        (&["paper", "paper", "--abs", "nan"], &["abs", "finite"]),
        (
            &["paper", "paper", "--topics", "/top/stat"],
            &["/top/stat", "/top/state"],
        ),
        (
            &["paper", "paper", "--tolerances", "none.toml"],
            &["none.toml"],
        ),
        (
            &["paper", "paper", "paper", "--mcap", "x.mcap"],
            &["two runs"],
        ),
        (
            &["paper", "paper", "paper", "--set-a", "friction.k=1"],
            &["--set-a"],
        ),
    ] {
        let (_, error) = ends(&directory, &[&["diff"], arguments].concat(), 2);
        for part in parts {
            assert!(
                error.contains(part),
                "{arguments:?}: {part} is not in\n{error}"
            );
        }
    }
    ends(&directory, &["diff", "paper"], 2);
    let (a, none, later) = (
        foreign("json_a.mcap"),
        foreign("no_common.mcap"),
        foreign("later.mcap"),
    );
    let (_, error) = ends(&directory, &["diff", &a, &none], 2);
    assert!(error.contains("no topic in common"), "{error}");
    let (_, error) = ends(&directory, &["diff", &a, &later], 2);
    assert!(error.contains("don't overlap"), "{error}");
    let (_, error) = ends(&directory, &["diff", &a, "a.mcap"], 2);
    assert!(error.contains("no topic in common"), "{error}");
    let (_, error) = ends(&directory, &["diff", &a, &a, "--mcap", "x.mcap"], 2);
    assert!(error.contains("--mcap"), "{error}");
    assert!(!directory.path().join("x.mcap.partial").exists());
}

#[test]
fn the_report_fits_a_terminal_and_has_colours_only_there() {
    let directory = tempdir().unwrap();
    let (text, _) = ends(&directory, &TWO, 1);
    assert!(!text.contains('\x1b'));
    for line in text.lines() {
        assert!(line.width() <= 100, "{} columns: {line}", line.width());
    }
    for section in [
        "Set-up",
        "What happened",
        "Averaged motion",
        "Signals",
        "Models",
    ] {
        assert!(
            text.lines().any(|line| line.starts_with(section)),
            "no {section} in\n{text}"
        );
    }
    let coloured = |variables: &[(&str, &str)]| {
        let mut command = toprise(&directory);
        command.args(TWO).envs(variables.iter().copied());
        let output = command.assert().code(1).get_output().stdout.clone();
        String::from_utf8(output).unwrap().contains('\x1b')
    };
    assert!(coloured(&[("CLICOLOR_FORCE", "1")]));
    assert!(!coloured(&[("NO_COLOR", "1")]));
    let (all, _) = ends(&directory, &[&TWO[..], &["--all-fields"]].concat(), 1);
    assert!(all.lines().count() > text.lines().count() + 30);
}

#[test]
fn programs_and_documents_get_their_forms() {
    let directory = tempdir().unwrap();
    let (text, _) = ends(&directory, &[&TWO[..], &["--format", "json"]].concat(), 1);
    let report: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(report["verdict"], "different");
    assert_eq!(
        report["setup"]["scenario"][2]["key"],
        "friction.dissipation"
    );
    let (markdown, _) = ends(&directory, &[&TWO[..], &["--markdown"]].concat(), 1);
    assert!(
        markdown.starts_with("# Different\n\nThe scenarios differ in"),
        "{markdown}"
    );
    assert!(markdown.contains("## Averaged motion") && markdown.contains("| :-- |"));
    let three = [
        "diff",
        "paper",
        "full-coulomb",
        "paper",
        "--set",
        "stop.duration=0.5",
        "--no-floor",
    ];
    let (text, _) = ends(&directory, &three, 1);
    assert!(
        text.contains("Averaged distance") && text.contains("1 of 2 runs are equal"),
        "{text}"
    );
    let (text, _) = ends(&directory, &[&three[..], &["--format", "json"]].concat(), 1);
    let matrix: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(matrix["theta_distance"][0][2], 0.0);
}

#[test]
fn ci_gets_a_test_for_each_topic() {
    let directory = tempdir().unwrap();
    let form = ["--format", "junit"];
    let (text, _) = ends(&directory, &[&TWO[..], &form].concat(), 1);
    let document = roxmltree::Document::parse(&text).unwrap();
    let tests = |is_failed: bool| -> Vec<String> {
        let cases = document
            .descendants()
            .filter(|node| node.has_tag_name("testcase"));
        let cases = cases
            .filter(|case| case.children().any(|child| child.has_tag_name("failure")) == is_failed);
        cases
            .map(|case| case.attribute("name").unwrap().to_owned())
            .collect()
    };
    assert!(
        tests(true).contains(&"/top/state".to_owned())
            && tests(true).contains(&"verdict".to_owned())
    );
    let suite = document
        .descendants()
        .find(|node| node.has_tag_name("testsuite"))
        .unwrap();
    let count = |name: &str| suite.attribute(name).unwrap().parse::<usize>().unwrap();
    assert_eq!(count("failures"), tests(true).len());
    assert_eq!(count("tests"), tests(true).len() + tests(false).len());
    record(&directory, "a<&\">.mcap", &[]);
    let (text, _) = ends(
        &directory,
        &[&["diff", "a<&\">.mcap", "a<&\">.mcap"], &form[..]].concat(),
        0,
    );
    let document = roxmltree::Document::parse(&text).unwrap();
    let failures = document
        .descendants()
        .filter(|node| node.has_tag_name("failure"));
    assert_eq!(failures.count(), 0);
    // Topics and fields that are ignored.
    let ignoring = [
        "--ignore", "/top/*", "--ignore", "/events", "--format", "json",
    ];
    let (_, error) = ends(&directory, &[&TWO[..], &ignoring].concat(), 2);
    assert!(error.contains("no topic"), "{error}");
    let ignoring = ["--ignore", "/top/[sp]", "--format", "json"];
    let (_, error) = ends(&directory, &[&TWO[..], &ignoring].concat(), 2);
    assert!(error.contains("/top/[sp]"), "{error}");
}

#[test]
fn differences_are_written_as_channels() {
    let directory = tempdir().unwrap();
    for encoding in ["json", "protobuf"] {
        let name = format!("{encoding}.mcap");
        let written = ["--mcap", name.as_str(), "--encoding", encoding];
        let (_, error) = ends(&directory, &[&TWO[..], &written].concat(), 1);
        assert!(error.contains(&format!("wrote {name}")), "{error}");
        let recording = Recording::open(&directory.path().join(&name)).unwrap();
        assert_eq!(recording.condition(), Condition::Foreign);
        let topics: Vec<_> = recording
            .channels()
            .iter()
            .map(|c| c.topic.as_str())
            .collect();
        for topic in [
            "/diff/top/state",
            "/diff/top/nutation",
            "/a/events",
            "/b/events",
        ] {
            assert!(topics.contains(&topic), "{topics:?}");
        }
        assert!(!topics.contains(&"/diff/events"));
        let mut reader = recording.reader(Selection::default());
        let mut states = 0;
        while let Some(message) = reader.next_undecoded() {
            states += u64::from(message.channel.topic == "/diff/top/state");
        }
        assert_eq!(states, 501);
        let report = recording
            .all_metadata()
            .find_map(|(_, entries)| entries.get("report"));
        let report: Value = serde_json::from_str(report.unwrap()).unwrap();
        assert_eq!(report["verdict"], "different");
        // What is there is not lost.
        let (_, error) = ends(&directory, &[&TWO[..], &written].concat(), 2);
        assert!(error.contains("exists"), "{error}");
        ends(&directory, &[&TWO[..], &written, &["--force"]].concat(), 1);
    }
    // The same numbers in both; what the timestamps' parts are called is the encodings' affair.
    let (text, _) = ends(&directory, &["diff", "json.mcap", "protobuf.mcap"], 1);
    assert!(text.contains("What both have is the same"), "{text}");
}

#[cfg(feature = "rerun")]
#[test]
fn both_runs_are_written_for_rerun() {
    let directory = tempdir().unwrap();
    let (_, error) = ends(&directory, &[&TWO[..], &["--rrd", "pair.rrd"]].concat(), 1);
    assert!(error.contains("wrote pair.rrd"), "{error}");
    assert!(
        fs::metadata(directory.path().join("pair.rrd"))
            .unwrap()
            .len()
            > 100_000
    );
    let (_, error) = ends(&directory, &[&TWO[..], &["--rrd", "pair.rrd"]].concat(), 2);
    assert!(error.contains("exists"), "{error}");
    let missing = [
        "diff",
        &foreign("json_a.mcap"),
        &foreign("json_b.mcap"),
        "--rrd",
        "x.rrd",
    ];
    let (_, error) = ends(&directory, &missing, 2);
    assert!(error.contains("another file"), "{error}");
}
