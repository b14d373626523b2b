//! The program as a process: exit codes, streams, signals.

use crate::support::{Folder, assert_contains, files, printed, scenario};
use serde_json::Value;
use std::fs;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;
use toprise::archive::recording::{Condition, Overview};
use toprise::run::scenario::{LAWS, Scenario, Values};

const PROGRAM: &str = env!("CARGO_BIN_EXE_toprise");

const SHORT: &str = "run paper --set stop.duration=0.2";

/// Standard output of a command that must succeed.
#[track_caller]
fn answer(folder: &Folder, line: &str) -> String {
    folder.toprise(line, 0).stdout
}

/// The same as JSON.
#[track_caller]
fn json(folder: &Folder, line: &str) -> Value {
    serde_json::from_str(&answer(folder, line)).unwrap()
}

#[track_caller]
fn assert_contains_all(text: &str, parts: &[&str]) {
    for part in parts {
        assert_contains(text, part);
    }
}

#[test]
fn run_records_and_prints_a_summary() {
    let folder = Folder::new();
    let parts = [
        "stopped at the time limit at t = 0.200000 s",
        "recordings/paper_duration0.2.mcap",
        "201 samples",
        "sha-256",
    ];
    assert_contains_all(&answer(&folder, SHORT), &parts);
    let overview = Overview::read(&folder.at("recordings/paper_duration0.2.mcap"));
    assert!(overview.unwrap().is_whole());
}

#[test]
fn skips_identical_recordings() {
    let folder = Folder::new();
    let recordings = || {
        let mut names = files(&folder.at("recordings"));
        names.retain(|name| !name.ends_with(".rrd"));
        names
    };
    let run = |more: &str| answer(&folder, &format!("{SHORT} {more}"));
    run("");
    let exists = "recordings/paper_duration0.2.mcap already exists with identical content";
    assert_contains(&run(""), exists);
    assert_eq!(recordings(), ["paper_duration0.2.mcap"]);
    // The same content in another encoding, and another run under the same name.
    run("--encoding protobuf");
    let both = ["paper_duration0.2-2.mcap", "paper_duration0.2.mcap"];
    assert_eq!(recordings(), both);
    let text = run("--encoding protobuf");
    assert_contains(&text, "paper_duration0.2-2.mcap already exists");
    // A recording that is run again.
    let text = answer(&folder, "run recordings/paper_duration0.2.mcap");
    assert_contains(&text, "paper_duration0.2.mcap already exists");
    folder.write("recordings/paper_duration0.2-3.mcap", "damaged");
    run("--topics /top/state");
    let damaged = folder.read("recordings/paper_duration0.2-3.mcap");
    assert_eq!(damaged, b"damaged");
    assert_eq!(recordings().len(), 4);
}

#[test]
fn long_names_end_in_the_digest() {
    let folder = Folder::new();
    fs::create_dir(folder.at("recordings")).unwrap();
    folder.write("recordings/paper.mcap", "the preset's");
    let mut line = "run --force --set stop.duration=0.05".to_owned();
    for change in [
        "initial.phi=0.1",
        "initial.psi=0.1",
        "gravity=9",
        "top.mass=0.1",
        "top.peg_radius=0.006",
    ] {
        line += &format!(" --set {change}");
    }
    assert_contains(&answer(&folder, &line), "recordings/paper_");
    assert_eq!(folder.read("recordings/paper.mcap"), b"the preset's");
}

#[test]
fn names_runs_after_their_changes() {
    let folder = Folder::new();
    for (changes, title, file) in [
        (
            &["friction.k=0.02"][..],
            "paper, friction.k = 0.02, stop.duration = 0.2: ",
            "paper_k0.02_duration0.2.mcap",
        ),
        (
            &["friction.law=none", "friction.k=", "friction.dissipation="],
            "paper, 4 keys changed: ",
            "paper_law-none_no-k_no-dissipation_duration0.2.mcap",
        ),
        (
            &[
                "drilling.k=2e-2",
                "drilling.patch_radius=0.001",
                "top.mass=0.11",
            ],
            "paper, 3 keys changed: ",
            "paper_drilling-k0.02_drilling-patch_radius0.001_duration0.2.mcap",
        ),
        (
            &["name=mine", "description=../a b"],
            "mine, stop.duration = 0.2: ",
            "mine_duration0.2.mcap",
        ),
    ] {
        let mut program = folder.program("run --set stop.duration=0.2");
        program.args(changes.iter().flat_map(|change| ["--set", change]));
        let text = printed(&mut program, title, 0).stdout;
        assert!(text.starts_with(title), "{text}");
        assert_contains(&text, &format!("recordings/{file}"));
    }
}

#[test]
fn reruns_recordings_with_other_values() {
    let folder = Folder::new();
    folder.toprise(&format!("{SHORT} -o a.mcap"), 0);
    folder.toprise("run a.mcap -o b.mcap", 0);
    assert!(folder.read("a.mcap") == folder.read("b.mcap"));
    folder.toprise("run a.mcap --set friction.k=0.02 -o c.mcap", 0);
    let compared = folder.toprise("diff a.mcap c.mcap", 1).stdout;
    assert_contains(&compared, "friction.k");
    // The recording that is read is never replaced.
    folder.refuses("run a.mcap -o a.mcap --force", "a.mcap");
    assert!(folder.read("a.mcap") == folder.read("b.mcap"));
}

#[test]
fn refuses_existing_output_without_force() {
    let folder = Folder::new();
    let run = format!("{SHORT} -o a.mcap");
    folder.toprise(&run, 0);
    let error = folder.toprise(&run, 2).stderr;
    assert_contains_all(&error, &["a.mcap exists", "--force"]);
    folder.toprise(&format!("{run} --force"), 0);
}

#[test]
fn bad_input_exits_with_2_and_writes_nothing() {
    let folder = Folder::new();
    folder.write("broken.toml", "[top\n");
    folder.write("binary.toml", [0xff, 0xfe]);
    folder.write("file", "");
    for (line, part) in [
        ("run nope", "nope"),
        ("run broken.toml", "TOML"),
        ("run binary.toml", "binary.toml"),
        ("run missing.toml", "missing.toml"),
        ("run --set top.mass=-1", "top.mass = -1"),
        ("run --set top.mass", "KEY=VALUE"),
        ("run --set friction.law=none", "friction.k"),
        ("run --topics /top/stat", "/top/state"),
        (
            "run --topics /top/state,/top/free_peg",
            "fixed peg has no topic /top/free_peg",
        ),
        ("run --realtime 0", "positive number"),
        ("run -o file/run.mcap", "file"),
        ("run --format xml", "xml"),
        ("run --set initial.theta=nan", "NaN"),
        ("run frictionless --set stop.duration=", "never stop"),
        ("info missing.mcap", "missing.mcap"),
        ("info broken.toml", "MCAP"),
        ("info file", "empty"),
        ("info .", "."),
        ("verify missing.mcap", "missing.mcap"),
        ("run --encoding cdr", "json"),
        ("presets nope", "paper"),
        ("schema /nope", "/top/state"),
        ("frobnicate", "frobnicate"),
    ] {
        let printed = folder.refuses(line, part);
        assert_eq!(printed.stdout, "", "{line}");
        assert!(!folder.at("recordings").exists(), "{line}");
        assert!(!printed.stderr.contains("panicked"), "{}", printed.stderr);
    }
}

#[test]
fn existing_rrd_leaves_no_mcap() {
    if cfg!(not(feature = "rerun")) {
        return;
    }
    let folder = Folder::new();
    folder.write("a.rrd", "precious");
    folder.toprise(&format!("{SHORT} -o a.mcap --rrd a.rrd"), 2);
    assert_eq!(folder.files(), ["a.rrd"]);
    assert_eq!(folder.read("a.rrd"), b"precious");
}

#[test]
fn prints_summaries_as_json() {
    let folder = Folder::new();
    let run = json(&folder, &format!("{SHORT} --format json"));
    assert_eq!(run["samples"], 201);
    // The members of its outcome are the columns of a sweep.
    let scenario = scenario("paper", &[("stop.duration", "0.2")]);
    let outcome = toprise::run::outcome(&scenario, || true).unwrap();
    assert_eq!(run["outcome"], serde_json::to_value(&outcome).unwrap());
    assert_eq!(run["outcome"]["stop_reason"], "duration");
    let path = run["mcap"]["path"].as_str().unwrap();
    let info = json(&folder, &format!("info {path} --format json"));
    assert_eq!(info["state"], "complete");
    assert_eq!(info["end"]["content_digest"], run["content_digest"]);
    assert_eq!(info["channels"][0]["topic"], "/top/state");
    assert_eq!(info["channels"][0]["messages"], 201);
    assert_eq!(info["bytes"], run["mcap"]["bytes"]);
}

#[test]
fn info_lists_contents() {
    let folder = Folder::new();
    folder.toprise(SHORT, 0);
    let text = answer(&folder, "info recordings/paper_duration0.2.mcap");
    let channel = ["/top/state", "toprise.State", "201", "1000.0 Hz"];
    assert_contains_all(&text, &channel);
    assert_contains_all(&text, &["complete", "start", "duration"]);
    let is_short = |line: &str| line.chars().count() <= 130;
    assert!(text.lines().all(is_short), "{text}");
}

#[test]
fn runs_edited_presets() {
    let folder = Folder::new();
    assert_contains(&answer(&folder, "presets"), "full-coulomb");
    let toml = answer(&folder, "presets full-coulomb");
    let toml = toml.replace("name = \"full-coulomb\"", "name = \"mine\"");
    folder.write("mine.toml", toml);
    let text = answer(&folder, "run mine.toml --set stop.duration=0.1");
    assert_contains(&text, "recordings/mine_duration0.1.mcap");
}

#[test]
fn names_recordings_after_the_scenario_file() {
    let folder = Folder::new();
    let brief = "--set stop.duration=0.05";
    folder.write("mine.toml", answer(&folder, "presets paper"));
    let text = answer(&folder, &format!("run mine.toml {brief}"));
    assert_contains(&text, "recordings/mine_duration0.05.mcap");
    let report = json(
        &folder,
        &format!("diff paper mine.toml {brief} --format json"),
    );
    let names = ["a", "b"].map(|side| report[side]["name"].clone());
    assert_eq!(names, ["paper", "mine"]);
}

#[test]
fn presets_prints_the_scenario_of_a_recording() {
    let folder = Folder::new();
    answer(&folder, "run viscous --set stop.duration=0.05 -o a.mcap");
    let text = answer(&folder, "presets a.mcap");
    let found = Scenario::new(Values::from_toml(&text).unwrap()).unwrap();
    let expected = scenario("viscous", &[("stop.duration", "0.05")]);
    assert_eq!(found.digest(), expected.digest());
}

#[test]
fn version_names_telemetry_and_features() {
    let text = answer(&Folder::new(), "--version");
    let telemetry = format!("telemetry {}", toprise::telemetry::table::VERSION);
    assert_contains_all(
        &text,
        &[
            env!("CARGO_PKG_VERSION"),
            &telemetry,
            "features cli",
            "commit ",
            "compiler rustc ",
            "profile ",
        ],
    );
    assert_eq!(text.contains("rerun"), cfg!(feature = "rerun"));
}

#[test]
fn completions_know_names() {
    let text = answer(&Folder::new(), "completions bash");
    let names = [
        "full-coulomb",
        "friction.k=",
        "/top/state",
        "figure-2",
        "coulomb-tanh",
    ];
    assert_contains_all(&text, &names);
    for shell in ["elvish", "fish", "nushell", "powershell", "zsh"] {
        let script = answer(&Folder::new(), &format!("completions {shell}"));
        assert_contains_all(&script, &["no-views"]);
    }
}

#[test]
fn the_man_page_has_every_command() {
    let folder = Folder::new();
    let page = answer(&folder, "completions man");
    assert!(page.contains(".TH toprise 1"), "{page}");
    for command in ["RUN", "DIFF", "VERIFY", "ARCHIVE"] {
        assert_contains_all(&page, &[&format!(".SH \"TOPRISE {command}\"")]);
    }
}

#[test]
fn describes_one_law() {
    let folder = Folder::new();
    let text = answer(&folder, "laws viscous");
    assert!(
        text.contains("friction.viscous_speed") && !text.contains("coulomb"),
        "{text}"
    );
    folder.refuses("laws viscos", "did you mean viscous?");
}

#[test]
fn lists_laws() {
    let folder = Folder::new();
    let text = answer(&folder, "laws");
    let parameter = ["friction.patch_radius", "[m/s]", "air.disc"];
    assert_contains_all(&text, &parameter);
    assert_contains_all(&text, &["coulomb-tanh", "Zhuravlev"]);
    let json = json(&folder, "laws --format json");
    let names = json.as_array().unwrap().iter().map(|law| &law["name"]);
    let listed: Vec<_> = LAWS.iter().map(|law| law.name).collect();
    assert_eq!(names.collect::<Vec<_>>(), listed);
    let parameter = &json[1]["parameters"][0];
    assert_eq!(parameter["key"], "friction.k");
    assert_eq!(parameter["allowed"], "a number from 0 to 100");
}

#[test]
fn draws_laws_without_replacing_files() {
    let folder = Folder::new();
    let paper = answer(&folder, "presets paper");
    fs::write(folder.at("mine.toml"), paper).unwrap();
    folder.toprise("run paper --set stop.duration=0.01 -o run.mcap", 0);
    let text = answer(&folder, "laws stribeck mine.toml run.mcap --plot laws.svg");
    assert_contains_all(
        &text,
        &["friction.stribeck_speed", "coulomb", "wrote  laws.svg"],
    );
    let svg = fs::read_to_string(folder.at("laws.svg")).unwrap();
    let curves = [
        "\"stribeck\"",
        "\"mine\"",
        "\"run\"",
        "slip speed v (m/s)",
        "coefficient of friction μ",
    ];
    assert_contains_all(&svg, &curves);
    folder.refuses("laws viscous --plot laws.svg", "overwrite it with --force");
    assert_eq!(fs::read_to_string(folder.at("laws.svg")).unwrap(), svg);
    answer(&folder, "laws viscous --plot laws.svg --force");
    assert_ne!(fs::read_to_string(folder.at("laws.svg")).unwrap(), svg);
    answer(&folder, "laws viscous --plot laws.png");
    assert!(
        fs::read(folder.at("laws.png"))
            .unwrap()
            .starts_with(b"\x89PNG")
    );
    for (line, expected) in [
        ("laws viscos --plot a.svg", "did you mean viscous?"),
        (
            "laws missing.toml --plot a.svg",
            "cannot read the scenario missing.toml",
        ),
        ("laws rolling --plot a.svg", "rolling is an additional loss"),
        ("laws viscous --plot a.pdf", "call it a.svg"),
        ("laws mine.toml --plot mine.toml", "call it mine.svg"),
        ("laws --plot a.svg", "<LAW>"),
    ] {
        folder.refuses(line, expected);
    }
    assert!(!folder.at("a.svg").exists());
}

#[test]
fn diff_draws_both_laws_without_replacing_files() {
    let folder = Folder::new();
    let line = "diff paper viscous --set stop.duration=0.5 --no-integration-error --plot pair.svg";
    let printed = folder.toprise(line, 1);
    assert_contains(&printed.stderr, "wrote pair.svg");
    assert_contains(
        &printed.stdout,
        "A: μ stays at 0.03; B: μ falls from 0.0342 to 0.0335 as the slip",
    );
    let svg = fs::read_to_string(folder.at("pair.svg")).unwrap();
    let parts = [
        "key: A: paper: coulomb, k = 0.03",
        "key: B: viscous: k = 0.03, v_0 = 0.5 m/s",
        "paper: visited slip speeds",
        "B: time spent at each slip speed",
    ];
    assert_contains_all(&svg, &parts);
    folder.refuses(line, "overwrite it with --force");
    assert_eq!(fs::read_to_string(folder.at("pair.svg")).unwrap(), svg);
    folder.toprise(&format!("{line} --force"), 1);
    folder.refuses("diff paper viscous --plot pair.pdf", "call it pair.svg");
}

#[test]
fn prints_schemas_and_completions() {
    let folder = Folder::new();
    assert_contains(&answer(&folder, "schema"), "/top/torque");
    assert_eq!(json(&folder, "schema /events")["title"], "toprise.Event");
    folder.toprise("schema --write out", 0);
    assert!(folder.at("out/toprise.State.json").exists());
    assert_contains(&answer(&folder, "completions bash"), "toprise");
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

/// A run in real time, in the background, of which something is written.
#[cfg(unix)]
fn paced_run(folder: &Folder) -> Child {
    let child = Command::new(PROGRAM)
        .current_dir(folder.path())
        .args(["run", "--realtime", "-o", "live.mcap", "--force"])
        .stderr(Stdio::null())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    wait_for_data(&folder.at("live.mcap.partial"));
    child
}

#[cfg(unix)]
fn signal(child: &Child, name: &str) {
    let mut kill = Command::new("kill");
    let status = kill.args([name, &child.id().to_string()]).status();
    assert!(status.unwrap().success());
}

#[cfg(unix)]
#[test]
fn interrupted_runs_end_cleanly() {
    let folder = Folder::new();
    let mut child = paced_run(&folder);
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(3));
    let overview = Overview::read(&folder.at("live.mcap")).unwrap();
    assert_eq!(overview.condition, Condition::Interrupted);
    assert_eq!(overview.end.unwrap()["stop_reason"], "interrupted");
    assert!(!folder.at("live.mcap.partial").exists());
    let info = folder.toprise("info live.mcap", 3).stdout;
    assert_contains(&info, "interrupted");
}

#[cfg(unix)]
#[test]
fn interrupted_runs_replace_no_complete_recording() {
    let folder = Folder::new();
    folder.toprise(&format!("{SHORT} -o live.mcap"), 0);
    let complete = folder.read("live.mcap");
    let mut child = paced_run(&folder);
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(3));
    assert_eq!(folder.read("live.mcap"), complete);
    let partial = Overview::read(&folder.at("live.mcap.partial")).unwrap();
    assert_eq!(partial.condition, Condition::Interrupted);
    // An incomplete recording is replaced.
    fs::rename(folder.at("live.mcap.partial"), folder.at("live.mcap")).unwrap();
    let mut child = paced_run(&folder);
    signal(&child, "-INT");
    assert_eq!(child.wait().unwrap().code(), Some(3));
    assert!(!folder.at("live.mcap.partial").exists());
}

#[cfg(unix)]
#[test]
fn killed_runs_leave_readable_partial_files() {
    let folder = Folder::new();
    let mut child = paced_run(&folder);
    signal(&child, "-KILL");
    child.wait().unwrap();
    let partial = folder.at("live.mcap.partial");
    let overview = Overview::read(&partial).unwrap();
    assert!(overview.run.is_some() && overview.end.is_none());
    assert!(overview.messages() > 100);
    let scenario = Scenario::from_toml(&overview.scenario.unwrap()).unwrap();
    assert_eq!(scenario.name(), "paper");
    let info = folder.toprise("info live.mcap.partial", 3).stdout;
    assert_contains(&info, "interrupted");
    // The next run neither overwrites it nor fails silently.
    folder.toprise(&format!("{SHORT} -o live.mcap"), 2);
    assert!(partial.exists());
}

#[cfg(target_os = "linux")]
#[test]
fn reports_full_disks() {
    // A file-size limit stands for the full disk: it needs no privileges. Both end a write early.
    let folder = Folder::new();
    let output = folder.limited(200, "run -o full.mcap");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert_contains_all(&error, &["full.mcap.partial", "large"]);
    assert!(!folder.at("full.mcap").exists());
    let overview = Overview::read(&folder.at("full.mcap.partial")).unwrap();
    assert!(overview.messages() > 100 && overview.end.is_none());
}

/// Every command may be followed by `| head -1`.
#[test]
fn closed_stdout_is_quiet() {
    let folder = Folder::new();
    folder.toprise(&format!("{SHORT} -o a.mcap"), 0);
    for (line, code) in [
        ("run drop --set stop.duration=0.01 -o b.mcap", 0),
        ("explain a.mcap", 0),
        ("diff a.mcap a.mcap", 0),
        ("figures a.mcap --format json", 0),
        ("info a.mcap", 0),
        ("verify a.mcap", 0),
        ("presets", 0),
        ("presets paper", 0),
        ("laws --format json", 0),
        ("schema", 0),
        ("completions bash", 0),
        ("--help", 0),
        ("--version", 0),
        ("presets nope --format json", 2),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let mut program = Command::new(PROGRAM);
        let program = program.current_dir(folder.path()).args(line.split(' '));
        let output = program.stdout(writer).output().unwrap();
        let stderr = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{line}: {stderr}");
        assert_eq!(stderr.is_empty(), code == 0, "{line}: {stderr}");
    }
}

#[test]
fn help_fits_80_columns() {
    let mut program = toprise::cli::command();
    program.build();
    let mut pages = vec![
        ("toprise --help".to_owned(), program.render_long_help()),
        ("toprise -h".to_owned(), program.render_help()),
    ];
    for command in program.get_subcommands_mut() {
        let name = command.get_name().to_owned();
        pages.push((format!("{name} --help"), command.render_long_help()));
        pages.push((format!("{name} -h"), command.render_help()));
    }
    for (name, page) in pages {
        for line in page.to_string().lines() {
            assert!(line.chars().count() <= 80, "{name}: {line}");
        }
    }
}

#[test]
fn set_names_take_precedence_over_file_names() {
    let folder = Folder::new();
    fs::write(
        folder.at("mine.toml"),
        folder.toprise("presets paper", 0).stdout,
    )
    .unwrap();
    let short = "--set stop.duration=0.05";
    let named = json(
        &folder,
        &format!("diff mine.toml mine.toml --set-a name=X {short} --format json"),
    );
    assert_eq!(
        (&named["a"]["name"], &named["b"]["name"]),
        (&"X".into(), &"mine".into())
    );
    let run = json(
        &folder,
        &format!("run mine.toml --set name=X {short} --format json"),
    );
    assert_contains(run["mcap"]["path"].as_str().unwrap(), "recordings/X");
}

#[test]
fn presets_reads_standard_input() {
    let folder = Folder::new();
    let toml = answer(&folder, "presets drop");
    let mut program = folder.program("presets -");
    let printed = printed(program.write_stdin(toml.clone()), "presets -", 0);
    assert_eq!(printed.stdout, toml);
    folder.refuses("info -", "the file is empty");
    folder.refuses("presets nope", "nope");
}

/// What says under which name a file is written is checked before the run.
#[test]
fn regress_refuses_impossible_names_at_once() {
    let folder = Folder::new();
    for (output, part) in [
        ("new/", "\"new/\" is not a file name"),
        ("new/..", "is not a file name"),
        ("a.mcap/.", "is not a file name"),
        ("a.mcap.partial", "reserved for incomplete runs"),
        (
            "a.rrd",
            if cfg!(feature = "rerun") {
                "use --rrd a.rrd"
            } else {
                "-o writes an MCAP file"
            },
        ),
        ("foo.txt", "call it foo.mcap"),
    ] {
        // It would take longer than the test does.
        folder.refuses(&format!("run --realtime 1e-3 -o {output} --force"), part);
    }
    assert_eq!(folder.files().len(), 0);
}

/// Chunks end by their sizes: no clock reaches the file.
#[test]
fn regress_pacing_does_not_change_bytes() {
    let folder = Folder::new();
    let recorded = |name: &str, pace: &str| {
        let line = format!("run --set stop.duration=0.3 -o {name} {pace}");
        folder.toprise(&line, 0);
        folder.read(name)
    };
    let whole = recorded("a.mcap", "");
    assert!(whole == recorded("b.mcap", "--realtime"));
    assert!(whole == recorded("c.mcap", "--realtime 0.5"));
}

/// Only `-o` leaves a Rerun recording out that nobody has asked to leave out.
#[cfg(feature = "rerun")]
#[test]
fn report_mentions_omitted_rrd() {
    let folder = Folder::new();
    for (output, is_mentioned) in [
        ("-o a.mcap", true),
        ("-o b.mcap --no-rrd", false),
        ("-o c.mcap --rrd c.rrd", false),
        ("--no-rrd", false),
    ] {
        let text = answer(&folder, &format!("run --set stop.duration=0.01 {output}"));
        let found = text.contains("no Rerun recording with -o");
        assert_eq!(found, is_mentioned, "{output}: {text}");
    }
}

#[test]
fn verifies_and_reruns_recordings() {
    let folder = Folder::new();
    folder.toprise(&format!("{SHORT} -o a.mcap"), 0);
    let text = answer(&folder, "verify a.mcap");
    assert!(text.starts_with("a.mcap: verified"), "{text}");
    let whole = folder.read("a.mcap");
    let cut = &whole[..whole.len() / 2];
    folder.write("cut.mcap", cut);
    folder.write("e.mcap.partial", cut);
    let mut flipped = whole.clone();
    flipped[whole.len() / 2] ^= 4;
    folder.write("flipped.mcap", flipped);
    // A recording with the beginning of one run and the end of another.
    let other = format!("{SHORT} --set friction.k=0.02 -o other.mcap");
    folder.toprise(&other, 0);
    let other = folder.read("other.mcap");
    folder.write("spliced.mcap", [cut, &other[..]].concat());
    for (line, code) in [
        ("run a.mcap --encoding protobuf -o b.mcap", 0),
        ("run a.mcap --encoding protobuf -o b.mcap", 2),
        ("verify a.mcap b.mcap", 0),
        ("verify cut.mcap", 3),
        ("verify a.mcap flipped.mcap cut.mcap", 3),
        ("verify a.mcap spliced.mcap cut.mcap", 1),
        ("verify a.mcap spliced.mcap missing.mcap", 2),
        ("info cut.mcap", 3),
        ("run cut.mcap -o c.mcap", 0),
        ("run flipped.mcap -o d.mcap", 0),
        // What an interrupted run has left becomes the file that it should have been.
        ("run e.mcap.partial -o e.mcap", 2),
        ("run e.mcap.partial -o e.mcap --force", 0),
        // The encoding of a recording is kept, or another one is chosen.
        ("run b.mcap -o same.mcap", 0),
        ("run b.mcap --encoding json -o f.mcap", 0),
        // Another scenario is another run.
        ("run a.mcap --set friction.k=0.02 -o g.mcap", 0),
    ] {
        folder.toprise(line, code);
    }
    for same in ["c.mcap", "d.mcap", "e.mcap", "f.mcap"] {
        assert!(folder.read(same) == whole, "{same}");
    }
    assert!(folder.read("same.mcap") == folder.read("b.mcap"));
    assert!(folder.read("g.mcap") == other);
    assert_eq!(folder.read("e.mcap.partial"), cut);
    let line = "verify a.mcap spliced.mcap flipped.mcap --format json";
    let report: Value = serde_json::from_str(&folder.toprise(line, 1).stdout).unwrap();
    assert_eq!(report[0]["verdict"], "verified");
    assert_eq!(report[1]["verdict"], "different");
    assert_eq!(report[2]["verdict"], "incomplete");
    assert_eq!(report[2]["state"], "damaged");
}

#[cfg(feature = "rerun")]
#[test]
fn view_replays_recordings() {
    let folder = Folder::new();
    folder.toprise(&format!("{SHORT} -o a.mcap --rrd a.rrd"), 0);
    let whole = folder.read("a.mcap");
    folder.write("cut.mcap", &whole[..whole.len() / 2]);
    for (line, code) in [
        ("view a.mcap --rrd b.rrd", 0),
        ("view a.mcap --rrd b.rrd", 2),
        ("view a.mcap --rrd b.rrd --force", 0),
        ("view a.mcap --rrd c.rrd --from 0.1 --to 0.15", 0),
        ("view cut.mcap --rrd d.rrd", 3),
        ("view a.mcap cut.mcap --rrd both", 3),
        ("view a.mcap ./a.mcap --rrd twice", 0),
    ] {
        folder.toprise(line, code);
    }
    let size = |name: &str| fs::metadata(folder.at(name)).unwrap().len();
    assert!(size("c.rrd") < size("b.rrd"));
    assert!(size("both/a.rrd") > 0 && size("both/cut.rrd") > 0);
    assert!(size("twice/a.rrd") > 0 && size("twice/a-2.rrd") > 0);
    for (line, part) in [
        ("view a.mcap --rrd e.rrd --from 2 --to 1", "after"),
        ("view a.mcap --rrd e.rrd --from -1", "seconds"),
        ("view missing.mcap", "missing.mcap"),
        ("view a.mcap --connect=127.0.0.1:9", "no Rerun viewer"),
        ("view a.mcap --spawn --connect", "--connect"),
    ] {
        folder.refuses(line, part);
    }
    // Where no viewer is installed, it is said how to get one.
    let line = "view a.mcap";
    let mut program = folder.program(line);
    let error = printed(program.env("PATH", "/nowhere"), line, 2).stderr;
    assert_contains(&error, "pip install rerun-sdk");
}

#[test]
fn omits_the_speed_of_runs_without_duration() {
    let folder = Folder::new();
    for duration in ["0", "1e-300"] {
        let line = format!("run --force -o none.mcap --set stop.duration={duration}");
        let text = answer(&folder, &line);
        assert!(!text.contains("of the simulated time"), "{text}");
        assert!(text.lines().all(|line| line.len() < 120), "{text}");
    }
}

/// What is named like a file is one: the error is about the file.
#[test]
fn unusable_files_are_not_presets() {
    let folder = Folder::new();
    folder.write("empty.mcap", "");
    fs::create_dir(folder.at("folder.mcap")).unwrap();
    for (name, reason) in [
        ("a.mcap.partial", "No such file"),
        ("empty.mcap", "the file is empty"),
        ("folder.mcap", "directory"),
    ] {
        let error = folder.toprise(&format!("run {name} -o b.mcap"), 2).stderr;
        assert_contains_all(&error, &[name, reason]);
    }
}

/// `-` is a scenario or a recording on standard input.
#[test]
fn reads_scenarios_from_standard_input() {
    let folder = Folder::new();
    let scenario = scenario("paper", &[("stop.duration", "0.05")]).to_toml();
    let piped = |line: &str, code: i32| {
        let mut program = folder.program(line);
        printed(program.write_stdin(scenario.clone()), line, code)
    };
    piped("run - -o a.mcap", 0);
    assert_eq!(piped("verify a.mcap", 0).stderr, "");
    assert_contains(&piped("explain -", 0).stdout, "The top started with");
    piped("diff - a.mcap", 0);
    assert_contains(&piped("diff - -", 2).stderr, "it can be read only once");
    for line in ["verify -", "info -"] {
        assert_contains(&piped(line, 2).stderr, "not an MCAP file");
    }
    assert_eq!(folder.files(), ["a.mcap"]);
}

#[test]
fn recordings_go_through_pipes() {
    let folder = Folder::new();
    let run = "run paper --set stop.duration=0.05 -o";
    folder.toprise(&format!("{run} a.mcap"), 0);
    let streamed = folder.program(&format!("{run} -")).output().unwrap();
    assert!(streamed.stdout == folder.read("a.mcap"));
    assert!(streamed.stderr.is_empty());
    let piped = |line: &str, code: i32| {
        let mut program = folder.program(line);
        printed(program.write_stdin(folder.read("a.mcap")), line, code)
    };
    assert_contains(&piped("verify -", 0).stdout, "byte-identical");
    assert_contains(&piped("explain -", 0).stdout, "The top started with");
    assert_contains(&piped("info -", 0).stdout, "complete");
    let compared = piped("diff a.mcap -", 0).stdout;
    assert_contains(&compared, "Identical");
    assert_contains(&compared, "B  paper");
    assert_contains(&piped("diff - -", 2).stderr, "it can be read only once");
    piped("run - -o b.mcap --encoding protobuf", 0);
    folder.toprise("verify b.mcap", 0);
    let missing = folder.at("missing");
    let mut program = folder.program("verify -");
    program
        .env("TMPDIR", &missing)
        .env("TEMP", &missing)
        .env("TMP", &missing);
    let refused = printed(program.write_stdin(folder.read("a.mcap")), "verify -", 2);
    assert_contains(&refused.stderr, "can't be kept in a temporary file");
}

/// A shell's `<(…)` is a descriptor that is open already.
#[cfg(target_os = "linux")]
#[test]
fn reads_process_substitutions() {
    let folder = Folder::new();
    folder.toprise("run paper --set stop.duration=0.05 -o a.mcap", 0);
    let program = env!("CARGO_BIN_EXE_toprise");
    let script = format!("{program} diff a.mcap <(cat a.mcap) && {program} verify <(cat a.mcap)");
    let mut bash = std::process::Command::new("bash");
    let output = bash
        .current_dir(folder.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    assert_contains(&String::from_utf8_lossy(&output.stdout), "B  paper");
}

#[cfg(unix)]
#[test]
fn warns_when_replacing_a_symbolic_link() {
    let folder = Folder::new();
    folder.write("target", "precious");
    let run = "run --set stop.duration=0.05 -o link.mcap --force";
    std::os::unix::fs::symlink("target", folder.at("link.mcap")).unwrap();
    let stderr = folder.toprise(run, 0).stderr;
    assert_contains(&stderr, "link.mcap is a symbolic link");
    assert_eq!(folder.text("target"), "precious");
    // Now it is a file.
    assert!(!folder.toprise(run, 0).stderr.contains("symbolic link"));
}
