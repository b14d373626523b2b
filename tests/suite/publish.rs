//! Files appear whole or not at all, and nothing that exists is harmed: not what is read, nor what is being written
//! or was left.

use crate::support::{Folder, archive, files, run_again, scenario};
use mcap::read::{LinearReader, Options};
use mcap::records::Record;
use std::fs;
use std::io::Write as _;
use std::process::{Child, Command, Stdio};
use toprise::archive::format::SCENARIO_ATTACHMENT;
use toprise::archive::pipeline::McapSink;
use toprise::archive::publish::{Draft, Existing, is_same_file, partial_name};
use toprise::archive::recording::{Condition, Overview, Recording};
use toprise::archive::sink::SinkError;
use toprise::archive::writer::Form;
use toprise::telemetry::encoding::Encoding;
use toprise::telemetry::{Telemetry, Topics};

fn record(folder: &Folder, name: &str) -> Vec<u8> {
    let scenario = scenario("paper", &[("stop.duration", "0.2")]);
    archive(&folder.at(name), &scenario, &[], Form::default()).unwrap();
    folder.read(name)
}

/// Runs a command that reads `input`, here called `IN`, and ends with this code. The input stays as it is.
#[track_caller]
fn assert_unharmed(folder: &Folder, input: &str, bytes: &[u8], line: &str, code: i32) {
    fs::create_dir_all(folder.at(input).parent().unwrap()).unwrap();
    folder.write(input, bytes);
    let line = line.replace("IN", input);
    folder.toprise(&line, code);
    assert!(folder.read(input) == bytes, "{line}");
}

#[test]
fn never_changes_inputs() {
    let folder = Folder::new();
    let whole = record(&folder, "a.mcap");
    let cut = &whole[..whole.len() / 2];
    let run = "run IN -o x.mcap --force";
    assert_unharmed(&folder, "x.mcap.new", cut, run, 0);
    assert_unharmed(&folder, "x.mcap.partial", cut, run, 0);
    // What would replace the input itself is refused.
    assert_unharmed(&folder, "x.mcap", cut, run, 2);
    let run = "run IN -o ./x.mcap --force";
    assert_unharmed(&folder, "x.mcap", &whole, run, 2);
    let draw = "figures IN --only energy --force";
    assert_unharmed(&folder, "figures/energy.svg", &whole, draw, 2);
    let left = folder.files();
    assert!(!left.iter().any(|name| name.ends_with(".tmp")), "{left:?}");
}

#[cfg(feature = "rerun")]
#[test]
fn never_changes_shown_recordings() {
    let folder = Folder::new();
    let whole = record(&folder, "a.mcap");
    for (input, line, code) in [
        ("h.rrd.new", "diff IN a.mcap --rrd h.rrd --force", 0),
        ("e.rrd.new", "view IN --rrd e.rrd --force", 0),
        ("e.rrd", "view IN --rrd e.rrd --force", 2),
    ] {
        assert_unharmed(&folder, input, &whole, line, code);
    }
}

#[cfg(unix)]
#[test]
fn recognises_inputs_by_any_name_or_link() {
    let folder = Folder::new();
    let whole = record(&folder, "a.mcap");
    let cut = &whole[..whole.len() / 2];
    folder.write("cut.mcap", cut);
    fs::hard_link(folder.at("cut.mcap"), folder.at("hard.mcap")).unwrap();
    std::os::unix::fs::symlink("cut.mcap", folder.at("soft.mcap")).unwrap();
    for output in ["hard.mcap", "soft.mcap", "../{}/cut.mcap"] {
        let name = folder.path().file_name().unwrap().to_string_lossy();
        let output = output.replace("{}", &name);
        let line = format!("run cut.mcap -o {output} --force");
        folder.refuses(&line, "also an input or another output");
        assert!(folder.read(&output) == cut, "{output}");
    }
    // A scenario is read too.
    let toml = scenario("paper", &[("stop.duration", "0.05")]).to_toml();
    folder.write("mine.toml", &toml);
    folder.toprise("run mine.toml -o mine.toml --force", 2);
    assert_eq!(folder.text("mine.toml"), toml);
}

/// Two outputs are one file if they lead to one, however they are spelled, and before there is such a file.
#[cfg(unix)]
#[test]
fn regress_refuses_two_outputs_with_one_name() {
    let folder = Folder::new();
    record(&folder, "a.mcap");
    fs::create_dir(folder.at("real")).unwrap();
    std::os::unix::fs::symlink("real", folder.at("link")).unwrap();
    let before = folder.files();
    for (one, other) in [
        ("o.mcap", "o.mcap"),
        ("o.mcap", "./o.mcap"),
        ("real/o.mcap", "link/o.mcap"),
        ("real/o.mcap", "link/../real/./o.mcap"),
        ("new/o.mcap", "new/deep/../o.mcap"),
    ] {
        let [one, other] = [one, other].map(|name| folder.at(name));
        assert!(is_same_file(&one, &other), "{one:?} {other:?}");
    }
    assert_eq!(folder.files(), before);
    assert!(files(&folder.at("real")).is_empty());
    // These are two.
    for (one, other) in [
        ("o.mcap", "real/o.mcap"),
        ("o.mcap", "o.y"),
        ("new/o.mcap", "new/o/x"),
    ] {
        let [one, other] = [one, other].map(|name| folder.at(name));
        assert!(!is_same_file(&one, &other), "{one:?} {other:?}");
    }
}

/// A table of which a map is drawn is read too.
#[cfg(feature = "sweep")]
#[test]
fn regress_map_does_not_replace_its_table() {
    let folder = Folder::new();
    let over = "--over friction.k=0.1,0.2 -o sweep.parquet";
    folder.toprise(&format!("sweep paper --set stop.duration=0.01 {over}"), 0);
    fs::rename(folder.at("sweep.parquet"), folder.at("sweep.svg")).unwrap();
    let before = folder.read("sweep.svg");
    let figures = "figures --sweep sweep.svg --x friction_k --show theta -o . --force";
    folder.toprise(figures, 2);
    assert!(folder.read("sweep.svg") == before);
}

#[cfg(unix)]
#[test]
fn replaces_symbolic_links_without_following_them() {
    let folder = Folder::new();
    let precious = folder.at("precious");
    let link = folder.at("link.mcap");
    fs::write(&precious, "precious").unwrap();
    std::os::unix::fs::symlink("precious", &link).unwrap();
    // The temporary name of a run may be a link as well.
    std::os::unix::fs::symlink("precious", partial_name(&link)).unwrap();
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    let sink = |existing| {
        let telemetry = Telemetry::default();
        McapSink::create(&link, existing, &scenario, &telemetry, Form::default())
    };
    let kept = sink(Existing::Keep);
    assert!(matches!(kept, Err(SinkError::Exists { .. })));
    let line = "run --set stop.duration=0.05 -o link.mcap --force";
    folder.toprise(line, 0);
    assert!(!link.is_symlink() && Overview::read(&link).unwrap().is_whole());
    assert_eq!(fs::read(&precious).unwrap(), b"precious");
    assert!(partial_name(&link).is_symlink());

    let schema = folder.at("schemas/toprise.State.json");
    fs::create_dir(folder.at("schemas")).unwrap();
    std::os::unix::fs::symlink("../precious", &schema).unwrap();
    folder.toprise("schema --write schemas", 0);
    assert!(!schema.is_symlink() && fs::read(&schema).unwrap().starts_with(b"{"));
    assert_eq!(fs::read(&precious).unwrap(), b"precious");
}

#[test]
fn last_published_draft_wins() {
    let folder = Folder::new();
    let path = folder.at("x.mcap");
    let hidden = || Draft::new(&path, Existing::Replace).unwrap();
    let run = || hidden().make_partial().unwrap();
    let drafts = [run(), run(), hidden(), hidden()];
    for (number, mut draft) in drafts.into_iter().enumerate() {
        let content = vec![number as u8; 1000 * (4 - number)];
        draft.write_all(&content).unwrap();
        draft.publish().unwrap();
        assert_eq!(fs::read(&path).unwrap(), content);
    }
    assert_eq!(folder.files(), ["x.mcap"]);
}

/// Commands that write a file which can be made again leave no draft of it when they are asked to end.
#[cfg(all(feature = "rerun", unix))]
#[test]
fn signals_leave_no_drafts() {
    // Below `nohup`, and before `&` in a script, signals are ignored; what is started here inherits that.
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    if ignored.is_some_and(|mask| mask & 0b11 != 0) {
        return;
    }
    let folder = Folder::new();
    let scenario = scenario("paper", &[("stop.duration", "20")]);
    let topics = ["/top/state", "/top/pose"];
    archive(&folder.at("a.mcap"), &scenario, &topics, Form::default()).unwrap();
    let whole = folder.read("a.mcap");
    folder.write("cut.mcap", &whole[..whole.len() - 9]);
    for signal in ["-INT", "-TERM"] {
        let mut program = Command::new(env!("CARGO_BIN_EXE_toprise"));
        program.args(["diff", "a.mcap", "cut.mcap", "--rrd", "x.rrd"]);
        program.stdout(Stdio::null()).stderr(Stdio::null());
        let mut child = program.current_dir(folder.path()).spawn().unwrap();
        // As soon as there is a draft.
        let is_draft = |name: &String| name.ends_with(".tmp");
        while !folder.files().iter().any(is_draft) {
            let ended = child.try_wait().unwrap();
            assert_eq!(ended, None, "it ended before {signal}");
            std::thread::sleep(std::time::Duration::from_millis(1));
        }
        let id = child.id().to_string();
        Command::new("kill").args([signal, &id]).status().unwrap();
        assert_eq!(child.wait().unwrap().code(), Some(130), "{signal}");
        assert_eq!(folder.files(), ["a.mcap", "cut.mcap"], "{signal}");
    }
}

#[test]
fn removes_directories_of_unwritten_files() {
    let folder = Folder::new();
    fs::create_dir(folder.at("mine")).unwrap();
    folder.write("damaged.mcap", "no recording");
    folder.toprise("run damaged.mcap -o mine/a/b/x.mcap", 2);
    assert_eq!(files(&folder.at("mine")), Vec::<String>::new());
}

#[test]
fn keeps_files_of_interrupted_runs() {
    let folder = Folder::new();
    folder.write("x.mcap.partial", "interrupted");
    let run = "run --set stop.duration=0.05 -o x.mcap";
    folder.refuses(run, "toprise run x.mcap.partial -o OUT");
    folder.toprise(&format!("{run} --force"), 0);
    assert_eq!(folder.read("x.mcap.partial"), b"interrupted");
    assert_eq!(folder.files(), ["x.mcap", "x.mcap.partial"]);
}

/// Starts a run in the background.
fn start(folder: &Folder, arguments: &str) -> Child {
    let mut program = Command::new(env!("CARGO_BIN_EXE_toprise"));
    program.args(["run", "--set", "stop.duration=0.3"]);
    program.args(arguments.split_whitespace());
    program.stdout(Stdio::null());
    program.current_dir(folder.path()).spawn().unwrap()
}

#[test]
fn simultaneous_runs_find_free_names() {
    let folder = Folder::new();
    // Other files, as one that is there already is not written again.
    let forms = [
        "",
        "--no-views",
        "--encoding=protobuf",
        "--encoding=protobuf --no-views",
    ];
    for mut run in forms.map(|form| start(&folder, form)) {
        assert!(run.wait().unwrap().success());
    }
    let mut recordings = files(&folder.at("recordings"));
    recordings.retain(|name| name.ends_with(".mcap"));
    let expected = ["-2.mcap", "-3.mcap", "-4.mcap", ".mcap"];
    assert_eq!(
        recordings,
        expected.map(|end| format!("paper_duration0.3{end}"))
    );
}

#[test]
fn simultaneous_runs_with_one_name_publish_whole_files() {
    let folder = Folder::new();
    let encodings = ["json", "protobuf"];
    let expected = encodings.map(|encoding| {
        let own = format!("{encoding}.mcap");
        let mut run = start(&folder, &format!("-o {own} --encoding {encoding}"));
        run.wait().unwrap();
        folder.read(own)
    });
    for _ in 0..5 {
        let one = |encoding| format!("-o x.mcap --force --encoding {encoding}");
        for mut run in encodings.map(|encoding| start(&folder, &one(encoding))) {
            assert!(run.wait().unwrap().success());
        }
        assert!(expected.contains(&folder.read("x.mcap")));
    }
    assert_eq!(folder.files(), ["json.mcap", "protobuf.mcap", "x.mcap"]);
}

#[test]
fn repeats_runs_killed_before_the_first_message() {
    let scenario = scenario("paper", &[("stop.duration", "0.05")]);
    for (encoding, topics, views) in [
        (Encoding::Json, &[][..], true),
        (Encoding::Protobuf, &["/top/state", "/events"][..], false),
    ] {
        let folder = Folder::new();
        let path = folder.at("run.mcap");
        let form = Form { encoding, views };
        archive(&path, &scenario, topics, form).unwrap();
        let whole = fs::read(&path).unwrap();

        let telemetry = match topics {
            [] => Telemetry::default(),
            _ => Telemetry::with_topics(&Topics::named(topics).unwrap()),
        };
        let live = folder.at("live.mcap");
        let sink = McapSink::create(&live, Existing::Keep, &scenario, &telemetry, form).unwrap();
        // What is on the disk now is what a killed process leaves.
        let killed = folder.at("killed.mcap");
        fs::copy(partial_name(&live), &killed).unwrap();
        drop(sink);
        // Other software finds the scenario, too.
        let bytes = fs::read(&killed).unwrap();
        let records =
            LinearReader::new_with_options(&bytes, Options::IgnoreEndMagic.into()).unwrap();
        let attachment = records.map(Result::unwrap).find_map(|record| match record {
            Record::Attachment { header, .. } => Some(header.name),
            _ => None,
        });
        assert_eq!(attachment.as_deref(), Some(SCENARIO_ATTACHMENT));
        let recording = Recording::open(&killed).unwrap();
        assert_eq!(recording.condition(), Condition::Interrupted);
        assert!(run_again(&killed).unwrap() == whole, "{encoding:?}");
    }
}

/// A Rerun recording for which there is no room leaves the MCAP file alone.
#[cfg(all(feature = "rerun", target_os = "linux"))]
#[test]
fn continues_without_rrd_when_the_disk_is_full() {
    let folder = Folder::new();
    // The limit stands for the full disk: larger than the MCAP file, smaller than the Rerun recording.
    let output = folder.limited(1100, "run --set stop.duration=1 -o x.mcap --rrd x.rrd");
    let error = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(3), "{error}");
    for part in ["Rerun recording", "x.rrd", "too large"] {
        assert!(error.contains(part), "{part} is not in {error}");
    }
    let recording = Recording::open(&folder.at("x.mcap")).unwrap();
    assert_eq!(recording.condition(), Condition::Whole);
    assert_eq!(folder.files(), ["x.mcap"]);
}

#[test]
fn repeats_recordings_without_channels() {
    let folder = Folder::new();
    let path = folder.at("a.mcap");
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
    folder.write("cut.mcap", &whole[..end]);
    assert!(run_again(&folder.at("cut.mcap")).unwrap() == whole);
}
