//! Files appear whole or not at all, and nothing that exists is harmed: not what is read, nor what is being written
//! or was left.

use crate::support::{archive, assert_contains, run_again, scenario};
use assert_cmd::Command;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::{Child, Command as Process, Stdio};
use tempfile::{TempDir, tempdir};
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::{Draft, Existing, is_same_file, partial_name};
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::sink::SinkError;
use toprise::archive::writer::Form;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::{Telemetry, Topics};

/// The files in a directory, hidden ones too.
fn files(directory: &Path) -> Vec<String> {
    let entries = fs::read_dir(directory).unwrap();
    let name = |entry: fs::DirEntry| entry.file_name().to_string_lossy().into_owned();
    let mut names: Vec<_> = entries.map(|entry| name(entry.unwrap())).collect();
    names.sort();
    names
}

fn record(directory: &TempDir, name: &str) -> Vec<u8> {
    let path = directory.path().join(name);
    let scenario = scenario("paper", &[("stop.duration", "0.2")]);
    archive(&path, &scenario, &[], Form::default()).unwrap();
    fs::read(path).unwrap()
}

fn toprise(directory: &TempDir, arguments: &[&str]) -> assert_cmd::assert::Assert {
    let mut command = Command::cargo_bin("toprise").unwrap();
    command
        .current_dir(directory.path())
        .args(arguments)
        .assert()
}

/// Arguments with the name of the input in place of `IN`.
fn with_input<'a>(arguments: &[&'a str], input: &'a str) -> Vec<&'a str> {
    let name = |word: &&'a str| if *word == "IN" { input } else { word };
    arguments.iter().map(name).collect()
}

#[test]
fn what_is_read_is_never_harmed_whatever_it_is_called() {
    let directory = tempdir().unwrap();
    let whole = record(&directory, "a.mcap");
    let cut = &whole[..whole.len() / 2];
    let cases: &[(&str, &[u8], &[&str], i32)] = &[
        (
            "x.mcap.new",
            cut,
            &["run", "IN", "-o", "x.mcap", "--force"],
            0,
        ),
        (
            "x.mcap.partial",
            cut,
            &["run", "IN", "-o", "x.mcap", "--force"],
            0,
        ),
        // What would replace the input itself is refused.
        ("x.mcap", cut, &["run", "IN", "-o", "x.mcap", "--force"], 2),
        (
            "x.mcap",
            &whole,
            &["run", "IN", "-o", "./x.mcap", "--force"],
            2,
        ),
        (
            "figures/energy.svg",
            &whole,
            &["figures", "IN", "--only", "energy", "--force"],
            2,
        ),
    ];
    for (input, bytes, arguments, code) in cases {
        let path = directory.path().join(input);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(&path, bytes).unwrap();
        let arguments = with_input(arguments, input);
        toprise(&directory, &arguments).code(*code);
        assert!(fs::read(&path).unwrap() == *bytes, "{arguments:?}");
    }
    assert!(
        !files(directory.path())
            .iter()
            .any(|name| name.ends_with(".tmp"))
    );
}

#[cfg(feature = "rerun")]
#[test]
fn what_is_shown_is_never_harmed() {
    let directory = tempdir().unwrap();
    let whole = record(&directory, "a.mcap");
    let cases: &[(&str, &[&str], i32)] = &[
        (
            "h.rrd.new",
            &["diff", "IN", "a.mcap", "--rrd", "h.rrd", "--force"],
            0,
        ),
        ("e.rrd.new", &["view", "IN", "--rrd", "e.rrd", "--force"], 0),
        ("e.rrd", &["view", "IN", "--rrd", "e.rrd", "--force"], 2),
    ];
    for (input, arguments, code) in cases {
        let path = directory.path().join(input);
        fs::write(&path, &whole).unwrap();
        let arguments = with_input(arguments, input);
        toprise(&directory, &arguments).code(*code);
        assert!(fs::read(&path).unwrap() == whole, "{arguments:?}");
    }
}

#[cfg(unix)]
#[test]
fn an_input_is_known_by_any_name_or_link() {
    let directory = tempdir().unwrap();
    let whole = record(&directory, "a.mcap");
    let cut = &whole[..whole.len() / 2];
    fs::write(directory.path().join("cut.mcap"), cut).unwrap();
    fs::hard_link(
        directory.path().join("cut.mcap"),
        directory.path().join("hard.mcap"),
    )
    .unwrap();
    std::os::unix::fs::symlink("cut.mcap", directory.path().join("soft.mcap")).unwrap();
    for output in ["hard.mcap", "soft.mcap", "../{}/cut.mcap"] {
        let name = directory.path().file_name().unwrap().to_string_lossy();
        let output = output.replace("{}", &name);
        let refused = toprise(&directory, &["run", "cut.mcap", "-o", &output, "--force"]).code(2);
        let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
        assert_contains(&error, "also an input or another output");
        assert!(fs::read(directory.path().join(&output)).unwrap() == cut);
    }
    // A scenario is read too.
    let toml = scenario("paper", &[("stop.duration", "0.05")]).to_toml();
    fs::write(directory.path().join("mine.toml"), &toml).unwrap();
    toprise(
        &directory,
        &["run", "mine.toml", "-o", "mine.toml", "--force"],
    )
    .code(2);
    assert_eq!(
        fs::read_to_string(directory.path().join("mine.toml")).unwrap(),
        toml
    );
}

/// Two outputs are one file if they lead to one, however they are spelled, and before there is such a file.
#[cfg(unix)]
#[test]
fn regress_two_outputs_of_one_name_are_refused() {
    let directory = tempdir().unwrap();
    record(&directory, "a.mcap");
    fs::create_dir(directory.path().join("real")).unwrap();
    std::os::unix::fs::symlink("real", directory.path().join("link")).unwrap();
    let before = files(directory.path());
    let run = ["run", "--set", "stop.duration=0.05", "-o"];
    for (one, other) in [
        ("o.x", "o.x"),
        ("o.x", "./o.x"),
        ("real/o.x", "link/o.x"),
        ("real/o.x", "link/../real/./o.x"),
        ("new/o.x", "new/deep/../o.x"),
    ] {
        let outputs = [one, "--rrd", other, "--force"];
        let arguments: Vec<_> = run.into_iter().chain(outputs).collect();
        if cfg!(feature = "rerun") {
            let refused = toprise(&directory, &arguments).code(2);
            let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
            assert_contains(&error, "also an input or another output");
        }
        assert!(is_same_file(
            &directory.path().join(one),
            &directory.path().join(other)
        ));
    }
    assert_eq!(files(directory.path()), before);
    assert!(files(&directory.path().join("real")).is_empty());
    // These are two.
    for (one, other) in [("o.x", "real/o.x"), ("o.x", "o.y"), ("new/o.x", "new/o/x")] {
        let [one, other] = [one, other].map(|name| directory.path().join(name));
        assert!(!is_same_file(&one, &other));
    }
}

/// A table of which a map is drawn is read too.
#[cfg(feature = "sweep")]
#[test]
fn regress_a_table_is_not_replaced_by_its_map() {
    let directory = tempdir().unwrap();
    let sweep = [
        "sweep",
        "paper",
        "--set",
        "stop.duration=0.01",
        "-o",
        "sweep.svg",
    ];
    let over = ["--over", "friction.k=0.1,0.2"];
    toprise(&directory, &[&sweep[..], &over].concat()).success();
    let before = fs::read(directory.path().join("sweep.svg")).unwrap();
    let figures = [
        "figures",
        "--sweep",
        "sweep.svg",
        "--x",
        "friction_k",
        "--show",
        "theta",
    ];
    toprise(
        &directory,
        &[&figures[..], &["-o", ".", "--force"]].concat(),
    )
    .code(2);
    assert!(fs::read(directory.path().join("sweep.svg")).unwrap() == before);
}

#[cfg(unix)]
#[test]
fn a_symbolic_link_is_replaced_as_a_name_and_never_written_through() {
    let directory = tempdir().unwrap();
    let precious = directory.path().join("precious");
    let link = directory.path().join("link.mcap");
    fs::write(&precious, "precious").unwrap();
    std::os::unix::fs::symlink("precious", &link).unwrap();
    // The temporary name of a run may be a link as well.
    std::os::unix::fs::symlink("precious", partial_name(&link)).unwrap();
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let sink = |existing| {
        let telemetry = Telemetry::default();
        McapSink::create(&link, existing, &scenario, &telemetry, Form::default())
    };
    assert!(matches!(
        sink(Existing::Keep),
        Err(SinkError::Exists { .. })
    ));
    toprise(
        &directory,
        &[
            "run",
            "--set",
            "stop.duration=0.05",
            "-o",
            "link.mcap",
            "--force",
        ],
    )
    .success();
    assert!(!link.is_symlink() && Overview::read(&link).unwrap().is_whole());
    assert_eq!(fs::read(&precious).unwrap(), b"precious");
    assert!(partial_name(&link).is_symlink());

    let schema = directory.path().join("schemas/toprise.State.json");
    fs::create_dir(directory.path().join("schemas")).unwrap();
    std::os::unix::fs::symlink("../precious", &schema).unwrap();
    toprise(&directory, &["schema", "--write", "schemas"]).success();
    assert!(!schema.is_symlink() && fs::read(&schema).unwrap().starts_with(b"{"));
    assert_eq!(fs::read(&precious).unwrap(), b"precious");
}

#[test]
fn whichever_of_several_files_of_one_name_is_published_last_stays_and_is_whole() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("x.mcap");
    let run = || Draft::of_run(&path, Existing::Replace, b"preface").unwrap();
    let other = || Draft::new(&path, Existing::Replace).unwrap();
    let drafts = [run(), run(), other(), other()];
    for (number, mut draft) in drafts.into_iter().enumerate() {
        draft
            .write_all(&vec![number as u8; 1000 * (4 - number)])
            .unwrap();
        draft.publish().unwrap();
        assert_eq!(
            fs::read(&path).unwrap(),
            vec![number as u8; 1000 * (4 - number)]
        );
    }
    assert_eq!(files(directory.path()), ["x.mcap"]);
}

/// Commands that write a file which can be made again leave no draft of it when they are asked to end.
#[cfg(all(feature = "rerun", unix))]
#[test]
fn a_signal_leaves_no_drafts() {
    // Below `nohup`, and before `&` in a script, signals are ignored; what is started here inherits that.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    if ignored.is_some_and(|mask| mask & 0b11 != 0) {
        return;
    }
    let directory = tempdir().unwrap();
    let scenario = scenario("paper", &[("stop.duration", "20")]);
    let path = directory.path().join("a.mcap");
    archive(
        &path,
        &scenario,
        &["/top/state", "/top/pose"],
        Form::default(),
    )
    .unwrap();
    let whole = fs::read(&path).unwrap();
    fs::write(directory.path().join("cut.mcap"), &whole[..whole.len() - 9]).unwrap();
    for signal in ["-INT", "-TERM"] {
        let arguments = ["diff", "a.mcap", "cut.mcap", "--rrd", "x.rrd"];
        let mut command = Process::new(assert_cmd::cargo::cargo_bin("toprise"));
        command.current_dir(directory.path()).args(arguments);
        let mut child = command
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // As soon as there is a draft.
        while !files(directory.path())
            .iter()
            .any(|name| name.ends_with(".tmp"))
        {
            assert_eq!(
                child.try_wait().unwrap(),
                None,
                "{arguments:?} ended before it was asked to"
            );
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let id = child.id().to_string();
        Process::new("kill").args([signal, &id]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{arguments:?}");
        assert_eq!(
            files(directory.path()),
            ["a.mcap", "cut.mcap"],
            "{arguments:?}"
        );
    }
}

#[test]
fn directories_of_files_that_are_not_written_vanish() {
    let directory = tempdir().unwrap();
    fs::create_dir(directory.path().join("mine")).unwrap();
    fs::write(directory.path().join("damaged.mcap"), "no recording").unwrap();
    let run = ["run", "damaged.mcap", "-o", "mine/a/b/x.mcap"];
    toprise(&directory, &run).code(2);
    assert_eq!(files(&directory.path().join("mine")), Vec::<String>::new());
}

#[test]
fn what_an_interrupted_run_left_is_never_touched() {
    let directory = tempdir().unwrap();
    let left = directory.path().join("x.mcap.partial");
    fs::write(&left, "interrupted").unwrap();
    let run = ["run", "--set", "stop.duration=0.05", "-o", "x.mcap"];
    let refused = toprise(&directory, &run).code(2);
    let error = String::from_utf8_lossy(&refused.get_output().stderr).into_owned();
    assert_contains(&error, "toprise run x.mcap.partial -o OUT");
    toprise(&directory, &[&run[..], &["--force"]].concat()).success();
    assert_eq!(fs::read(&left).unwrap(), b"interrupted");
    assert_eq!(files(directory.path()), ["x.mcap", "x.mcap.partial"]);
}

/// Starts a run in the background.
fn start(directory: &TempDir, arguments: &[&str]) -> Child {
    let program = assert_cmd::cargo::cargo_bin("toprise");
    let mut command = Process::new(program);
    command
        .current_dir(directory.path())
        .args(["run", "--set", "stop.duration=0.3"]);
    command
        .args(arguments)
        .stdout(Stdio::null())
        .spawn()
        .unwrap()
}

#[test]
fn runs_that_start_at_once_each_find_a_free_name() {
    let directory = tempdir().unwrap();
    // Other files, as one that is there already is not written again.
    let forms: [&[&str]; 4] = [
        &[],
        &["--no-views"],
        &["--encoding=protobuf"],
        &["--encoding=protobuf", "--no-views"],
    ];
    let runs = forms.map(|form| start(&directory, form));
    for mut run in runs {
        assert!(run.wait().unwrap().success());
    }
    let recordings = files(&directory.path().join("recordings"));
    let recordings = recordings
        .into_iter()
        .filter(|name| name.ends_with(".mcap"));
    assert_eq!(
        recordings.collect::<Vec<_>>(),
        ["-2.mcap", "-3.mcap", "-4.mcap", ".mcap"].map(|end| format!("paper_duration0.3{end}"))
    );
}

#[test]
fn runs_with_one_name_each_publish_a_whole_file() {
    let directory = tempdir().unwrap();
    let mut expected = Vec::new();
    for encoding in ["json", "protobuf"] {
        let own = format!("{encoding}.mcap");
        start(&directory, &["-o", &own, "--encoding", encoding])
            .wait()
            .unwrap();
        expected.push(fs::read(directory.path().join(own)).unwrap());
    }
    for _ in 0..5 {
        let one = |encoding| {
            start(
                &directory,
                &["-o", "x.mcap", "--force", "--encoding", encoding],
            )
        };
        for mut run in ["json", "protobuf"].map(one) {
            assert!(run.wait().unwrap().success());
        }
        assert!(expected.contains(&fs::read(directory.path().join("x.mcap")).unwrap()));
    }
    assert_eq!(
        files(directory.path()),
        ["json.mcap", "protobuf.mcap", "x.mcap"]
    );
}

#[test]
fn a_run_that_is_killed_before_its_first_message_can_be_run_again() {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    for (encoding, topics, views) in [
        (Encoding::Json, &[][..], true),
        (Encoding::Protobuf, &["/top/state", "/events"][..], false),
    ] {
        let directory = tempdir().unwrap();
        let path = directory.path().join("run.mcap");
        let form = Form { encoding, views };
        archive(&path, &scenario, topics, form).unwrap();
        let whole = fs::read(&path).unwrap();

        let telemetry = match topics {
            [] => Telemetry::default(),
            _ => Telemetry::with_topics(&Topics::named(topics).unwrap()),
        };
        let live = directory.path().join("live.mcap");
        let sink = McapSink::create(&live, Existing::Keep, &scenario, &telemetry, form).unwrap();
        // What is on the disk now is what a killed process leaves.
        let killed = directory.path().join("killed.mcap");
        fs::copy(partial_name(&live), &killed).unwrap();
        drop(sink);
        let recording = Recording::open(&killed).unwrap();
        assert_eq!(recording.condition(), Condition::Interrupted);
        assert!(run_again(&killed).unwrap() == whole, "{encoding:?}");
    }
}

/// A Rerun recording for which there is no room leaves the MCAP file alone.
#[cfg(all(feature = "rerun", target_os = "linux"))]
#[test]
fn a_run_goes_on_without_a_rerun_recording_that_finds_no_room() {
    let directory = tempdir().unwrap();
    let program = assert_cmd::cargo::cargo_bin("toprise");
    // The limit stands for the full disk: larger than the MCAP file, smaller than the Rerun recording.
    let script = format!(
        "ulimit -f 1100; trap '' XFSZ; exec {} run --set stop.duration=1 -o x.mcap --rrd x.rrd",
        program.display()
    );
    let output = Process::new("bash")
        .current_dir(directory.path())
        .args(["-c", &script])
        .output()
        .unwrap();
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    assert_contains(&error, "x.rrd");
    let recording = Recording::open(&directory.path().join("x.mcap")).unwrap();
    assert_eq!(recording.condition(), Condition::Whole);
    assert_eq!(files(directory.path()), ["x.mcap"]);
}

#[test]
fn a_recording_without_its_channels_is_run_again_to_the_same_bytes() {
    let directory = tempdir().unwrap();
    let path = directory.path().join("a.mcap");
    let scenario = scenario("paper", &[("stop.duration", "0.2")]);
    let form = Form {
        encoding: Encoding::Protobuf,
        views: false,
    };
    archive(&path, &scenario, &["/top/state", "/events"], form).unwrap();
    let whole = fs::read(path).unwrap();
    // The metadata and the attachment, without the first chunk and all that follows.
    let (header, chunk) = (1, 6);
    let mut end = 8;
    while whole[end] == header || whole[end] > chunk {
        let length = u64::from_le_bytes(whole[end + 1..end + 9].try_into().unwrap());
        end += 9 + usize::try_from(length).unwrap();
    }
    fs::write(directory.path().join("cut.mcap"), &whole[..end]).unwrap();
    assert!(run_again(&directory.path().join("cut.mcap")).unwrap() == whole);
}
