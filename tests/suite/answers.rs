//! What all commands have in common: JSON by committed schemas, text that can't steer a terminal, streams that may
//! break, names of files that are no text.

use crate::support::{Folder, assert_contains, printed};
use serde_json::{Map, Value};
use std::collections::BTreeMap;
use std::fs;
use std::io::BufWriter;
use std::path::Path;

/// What a file would do to a terminal that trusted it: move, recolour, rename the window, forge a line.
const HOSTILE: &str = "\x1b]0;owned\x07\u{9b}31m\x1b[2J\u{202e}\nFORGED\r";

/// A directory with a recording, half of it, and a file that is no recording.
fn recorded() -> Folder {
    let folder = Folder::new();
    folder.toprise("run --set stop.duration=0.3 -o a.mcap", 0);
    let whole = folder.read("a.mcap");
    folder.write("cut.mcap", &whole[..whole.len() / 2]);
    folder.write("text.mcap", "not a recording");
    folder
}

/// Checks a value against a JSON Schema as `schemars` writes them. Fields that the schema doesn't have are wrong too.
fn check(path: &str, value: &Value, schema: &Value, root: &Value) -> Result<(), String> {
    if let Some(name) = schema["$ref"].as_str() {
        let inner = root.pointer(name.trim_start_matches('#'));
        return check(path, value, inner.ok_or(name)?, root);
    }
    for choice in ["anyOf", "oneOf"] {
        if let Some(choices) = schema[choice].as_array() {
            let fits = |one| check(path, value, &flattened(one, schema), root).is_ok();
            if !choices.iter().any(fits) {
                return Err(format!("{path}: {value} is none of {choices:?}"));
            }
            if schema.get("properties").is_some() {
                // The choice has checked all members.
                return Ok(());
            }
        }
    }
    if let Some(constant) = schema.get("const")
        && constant != value
    {
        return Err(format!("{path}: {value} is not {constant}"));
    }
    if let Some(words) = schema["enum"].as_array()
        && !words.contains(value)
    {
        return Err(format!("{path}: {value} is none of {words:?}"));
    }
    let kind = match value {
        Value::Null => "null",
        Value::Bool(_) => "boolean",
        Value::Number(number) if number.is_f64() => "number",
        Value::Number(_) => "integer",
        Value::String(_) => "string",
        Value::Array(_) => "array",
        Value::Object(_) => "object",
    };
    let is_of = |allowed: &Value| allowed == kind || (allowed == "number" && kind == "integer");
    let is_right = match &schema["type"] {
        Value::Array(kinds) => kinds.iter().any(is_of),
        Value::Null => true,
        one => is_of(one),
    };
    if !is_right {
        return Err(format!("{path}: {value} is no {}", schema["type"]));
    }
    match value {
        Value::Array(items) => {
            for (at, item) in items.iter().enumerate() {
                let of_place = schema["prefixItems"].get(at);
                if let Some(inner) = of_place.or_else(|| schema.get("items")) {
                    check(&format!("{path}[{at}]"), item, inner, root)?;
                }
            }
        }
        Value::Object(fields) => check_object(path, fields, schema, root)?,
        _ => {}
    }
    Ok(())
}

/// One of the kinds of objects of a schema, with the members that all of them have.
fn flattened(kind: &Value, schema: &Value) -> Value {
    let mut flattened = kind.clone();
    if let Some(common) = schema["properties"].as_object() {
        for (name, member) in common {
            flattened["properties"][name] = member.clone();
        }
        for name in schema["required"].as_array().into_iter().flatten() {
            if let Some(required) = flattened["required"].as_array_mut() {
                required.push(name.clone());
            }
        }
    }
    flattened
}

fn check_object(
    path: &str,
    fields: &Map<String, Value>,
    schema: &Value,
    root: &Value,
) -> Result<(), String> {
    // One of several kinds of objects: their schemas have been checked.
    if schema.get("properties").is_none() && schema.get("additionalProperties").is_none() {
        return Ok(());
    }
    for (name, value) in fields {
        let of_others = schema.get("additionalProperties");
        let inner = schema["properties"].get(name).or(of_others);
        let inner = inner.ok_or_else(|| format!("{path}.{name} is not in the schema"))?;
        check(&format!("{path}.{name}"), value, inner, root)?;
    }
    let required = schema["required"].as_array().into_iter().flatten();
    for name in required.filter_map(Value::as_str) {
        if !fields.contains_key(name) {
            return Err(format!("{path}.{name} is missing"));
        }
    }
    Ok(())
}

#[test]
fn reports_match_their_schemas() {
    let folder = recorded();
    let about =
        "title = \"T\"\nlicence = \"MIT\"\ndate = 2026-11-29\ncreators = [{ name = \"A\" }]\n";
    folder.write("about.toml", about);
    let schemas = Path::new(env!("CARGO_MANIFEST_DIR")).join("schemas");
    let mut used = BTreeMap::new();
    for (name, line, code) in [
        ("RunReport", "run --set stop.duration=0.1 -o b.mcap", 0),
        #[cfg(feature = "rerun")]
        (
            "RunReport",
            "run --set stop.duration=0.1 -o c.mcap --rrd c.rrd",
            0,
        ),
        #[cfg(feature = "rerun")]
        ("ViewReport", "view a.mcap cut.mcap --rrd shown", 3),
        #[cfg(feature = "fit")]
        (
            "FitReport",
            "fit paper a.mcap --signal theta:1mrad --free friction.k",
            0,
        ),
        ("ExplainReport", "explain a.mcap", 0),
        ("ExplainReport", "explain cut.mcap", 3),
        ("DiffReport", "diff a.mcap cut.mcap", 3),
        (
            "DiffReport",
            "diff a.mcap full-coulomb --set stop.duration=0.3",
            1,
        ),
        (
            "FiguresReport",
            "figures a.mcap cut.mcap --only figure-2 -o drawn",
            3,
        ),
        #[cfg(feature = "sweep")]
        (
            "SweepReport",
            "sweep paper --set stop.duration=0.01 --over initial.theta=0.5,4 -o s.parquet",
            3,
        ),
        ("InfoReport", "info a.mcap", 0),
        ("InfoReport", "info cut.mcap", 3),
        (
            "VerifyReport",
            "verify a.mcap cut.mcap text.mcap missing.mcap",
            2,
        ),
        ("RunReport", "run cut.mcap -o again.mcap", 0),
        (
            "AnnotateReport",
            "annotate a.mcap about.toml -o annotated.mcap",
            0,
        ),
        (
            "ArchiveReport",
            "archive a.mcap --about about.toml -o packed",
            0,
        ),
        ("VerifyReport", "verify packed", 0),
        ("PresetsReport", "presets", 0),
        ("PresetsReport", "presets paper", 0),
        ("LawsReport", "laws", 0),
        ("SchemaReport", "schema", 0),
        ("SchemaReport", "schema /events --encoding protobuf", 0),
        ("SchemaReport", "schema --write written", 0),
    ] {
        let text = folder
            .toprise(&format!("{line} --format json"), code)
            .stdout;
        let value: Value = serde_json::from_str(&text).unwrap();
        let schema = fs::read_to_string(schemas.join(format!("toprise.{name}.json"))).unwrap();
        let schema: Value = serde_json::from_str(&schema).unwrap();
        let checked = check(name, &value, &schema, &schema);
        assert_eq!(checked, Ok(()), "toprise {line}\n{text}");
        // Nothing but objects and arrays of them, so that there is room for more.
        assert!(value.is_object() || value[0].is_object(), "{line}");
        used.insert(name, schema);
    }
    for (name, _) in toprise::cli::schemas() {
        let name = name.strip_prefix("toprise.");
        let name = name.unwrap().strip_suffix(".json").unwrap();
        assert!(used.contains_key(name), "{name} is not tried");
    }
    // The check works: it finds a value that the schema forbids.
    let schema = &used["VerifyReport"];
    for wrong in [
        "[{}]",
        r#"[{"file": 1}]"#,
        r#"[{"file": "a", "verdict": "verified", "state": "lost", "missing": 0, "without": []}]"#,
        r#"[{"file": "a", "more": 1}]"#,
    ] {
        let wrong = serde_json::from_str(wrong).unwrap();
        assert!(check("", &wrong, schema, schema).is_err(), "{wrong}");
    }
}

#[test]
fn reports_are_valid_markdown() {
    let folder = recorded();
    for (line, code) in [
        ("explain a.mcap --all", 0),
        ("diff a.mcap a.mcap", 0),
        ("info a.mcap", 0),
        ("verify a.mcap cut.mcap", 3),
        ("presets", 0),
        ("laws", 0),
        ("schema", 0),
        ("run --set stop.duration=0.1 -o b.mcap", 0),
    ] {
        let text = folder
            .toprise(&format!("{line} --format markdown"), code)
            .stdout;
        assert!(text.contains("| :-- |"), "{line}:\n{text}");
        assert!(!text.contains('\x1b'), "{line}");
    }
}

#[test]
fn diff_counts_hidden_findings() {
    let folder = Folder::new();
    let text = folder.toprise("diff free-paper free-rolls", 1).stdout;
    assert_contains(&text, "more findings and every field");
}

/// Copies a recording with hostile text wherever a file can have text; with another library it is a foreign one.
fn forge(from: &Path, to: &Path, library: &str) {
    let bytes = fs::read(from).unwrap();
    let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
    let file = BufWriter::new(fs::File::create(to).unwrap());
    let library = format!("{library}{HOSTILE}");
    let mut writer = mcap::WriteOptions::new()
        .library(&library)
        .create(file)
        .unwrap();
    let is_ours = library.starts_with("toprise");
    for index in &summary.attachment_indexes {
        let attachment = mcap::read::attachment(&bytes, index).unwrap();
        writer.attach(&attachment).unwrap();
    }
    for index in &summary.metadata_indexes {
        let mut metadata = mcap::read::metadata(&bytes, index).unwrap();
        for value in metadata.metadata.values_mut() {
            value.push_str(HOSTILE);
        }
        if is_ours {
            writer.write_metadata(&metadata).unwrap();
        }
    }
    for message in mcap::MessageStream::new(&bytes).unwrap() {
        let mut message = message.unwrap();
        if message.channel.topic == "/events" {
            let mut event: Value = serde_json::from_slice(&message.data).unwrap();
            let name = event["name"].as_str().unwrap().to_owned();
            event["name"] = (name + HOSTILE).into();
            message.data = serde_json::to_vec(&event).unwrap().into();
        }
        writer.write(&message).unwrap();
        if !is_ours && message.sequence < 3 {
            let mut channel = (*message.channel).clone();
            channel.id += 1000;
            channel.topic.push_str(HOSTILE);
            message.channel = channel.into();
            writer.write(&message).unwrap();
        }
    }
    writer.finish().unwrap();
}

#[test]
fn sanitizes_text_from_files() {
    let folder = recorded();
    let a = folder.at("a.mcap");
    forge(&a, &folder.at("ours.mcap"), "toprise/0.1.0");
    forge(&a, &folder.at("other.mcap"), "another");
    let scenario = format!("name = {HOSTILE:?}\n[top]\nmass = \"{HOSTILE}");
    folder.write("hostile.toml", scenario);
    let mut lines = vec!["run hostile.toml".to_owned()];
    for file in ["ours.mcap", "other.mcap"] {
        for verb in [
            "info",
            "verify",
            "explain",
            "diff a.mcap",
            "diff other.mcap",
        ] {
            for format in ["text", "json", "markdown"] {
                lines.push(format!("{verb} {file} --color never --format {format}"));
            }
        }
        lines.push(format!("run {file} -o again-{file}"));
        lines.push(format!("figures {file} -o drawn-{file}"));
        if cfg!(feature = "rerun") {
            lines.push(format!("view {file} --rrd {file}.rrd"));
            lines.push(format!("diff a.mcap {file} --rrd diff-{file}.rrd"));
        }
    }
    let mut shown = 0;
    for line in &lines {
        let output = folder.program(line).output().unwrap();
        for stream in [output.stdout, output.stderr] {
            let text = String::from_utf8(stream).unwrap();
            let steers = |c: char| (c.is_control() && c != '\n') || c == '\u{202e}';
            assert!(!text.contains(steers), "toprise {line}: {text:?}");
            let forges = |line: &str| line.starts_with("FORGED");
            assert!(!text.lines().any(forges), "toprise {line}: {text}");
            shown += usize::from(text.contains("FORGED"));
        }
    }
    // Much of it is shown all the same.
    assert!(shown >= 10, "only {shown} answers show hostile text");
}

#[cfg(target_os = "linux")]
#[test]
fn broken_streams_do_not_panic() {
    let folder = recorded();
    let program = env!("CARGO_BIN_EXE_toprise");
    let ends = |line: &str, streams: &str| {
        let script = format!("{program} {line} {streams}");
        let status = std::process::Command::new("bash")
            .current_dir(folder.path())
            .args(["-c", &script])
            .status();
        status.unwrap().code()
    };
    for line in [
        "run nope",
        "info missing.mcap",
        "verify text.mcap",
        "explain text.mcap",
        "diff a.mcap text.mcap",
        "run text.mcap -o b.mcap",
        "figures text.mcap",
        "presets nope",
        "schema /nope",
        "frobnicate",
    ] {
        for broken in [
            "2>/dev/full",
            "2>&-",
            "2> >(true)",
            ">/dev/full 2>/dev/full",
        ] {
            assert_eq!(ends(line, broken), Some(2), "{line} {broken}");
        }
    }
    // Warnings and notes that nobody hears change nothing.
    assert_eq!(ends("explain cut.mcap", "2>/dev/full >/dev/null"), Some(3));
    // An answer that can't be written is a failure.
    for line in [
        "--help",
        "--version",
        "laws",
        "info a.mcap",
        "presets --format json",
    ] {
        assert_eq!(ends(line, ">/dev/full"), Some(2), "{line}");
    }
}

#[cfg(target_os = "linux")]
#[test]
fn accepts_file_names_that_are_not_utf8() {
    use std::os::unix::ffi::OsStrExt as _;
    let folder = recorded();
    let name = std::ffi::OsStr::from_bytes(b"\xff\xfe.mcap");
    let scenario = std::ffi::OsStr::from_bytes(b"\xff.toml");
    folder.write(name, folder.read("a.mcap"));
    folder.write(scenario, folder.toprise("presets paper", 0).stdout);
    for (verb, file, rest, code) in [
        ("info", name, "", 0),
        ("verify", name, "", 0),
        ("explain", name, "", 0),
        ("diff", name, "a.mcap", 0),
        ("figures", name, "--only figure-2 -o drawn", 0),
        ("run", name, "-o b.mcap", 0),
        ("run", scenario, "--set stop.duration=0.1 -o c.mcap", 0),
    ] {
        let mut program = folder.program(verb);
        let program = program.arg(file).args(rest.split_whitespace());
        let error = printed(program, verb, code).stderr;
        assert!(!error.contains("UTF-8"), "{verb}: {error}");
    }
}

#[test]
fn json_errors_have_text_and_key() {
    let folder = recorded();
    folder.write("mine.toml", "name = \"mine\"\ngravty = 1.0\n");
    folder.write("a.csv", "t,theta\n0,0.5\n0.1,0.4\n0.2,0.5\n");
    folder.write("runs.csv", "friction_k\n0.03\nmuch\n");
    for (line, part, key) in [
        ("info missing.mcap --format json", "missing.mcap", None),
        ("run papr --format json", "papr", None),
        ("run --nope --format=json", "--nope", None),
        (
            "run --set friction.k=-1 --format json",
            "friction.k = -1",
            Some("friction.k"),
        ),
        (
            "run --set friction.law=none --format json",
            "friction.k",
            Some("friction.k"),
        ),
        ("explain mine.toml --format json", "gravty", Some("gravty")),
        (
            "fit paper a.csv --free friction.q --format json",
            "friction.q",
            Some("friction.q"),
        ),
        (
            "fit paper a.csv --free stop.duration --format json",
            "stop.duration can't be fitted",
            Some("stop.duration"),
        ),
        (
            "fit paper a.csv --free friction.k --bound friction.k=1..2 --format json",
            "friction.k: the bounds",
            Some("friction.k"),
        ),
        (
            "fit paper a.csv --free friction.k --bound gravity=1..20 --format json",
            "gravity is not free",
            Some("gravity"),
        ),
        (
            "fit paper a.csv --free friction.k,initial.psi --format json",
            "no signal depends on initial.psi",
            Some("initial.psi"),
        ),
        // A parameter of the fit, but no key of the scenario.
        (
            "fit paper a.csv --free friction.k,offset --format json",
            "offset can't be fitted",
            None,
        ),
        (
            "sweep paper --over friction.k=0.01..0.1 -o map.parquet --format json",
            "friction.k=0.01..0.1",
            Some("friction.k"),
        ),
        (
            "sweep paper --over friction.k=0,1 --over friction.k=2,3 -o map.parquet --format json",
            "friction.k varies twice",
            Some("friction.k"),
        ),
        (
            "sweep paper --over gravity=1,x -o map.parquet --format json",
            "gravity=1,x",
            Some("gravity"),
        ),
        (
            "sweep paper --table runs.csv -o map.parquet --format json",
            "friction.k = \"much\"",
            Some("friction.k"),
        ),
    ] {
        let optional = [
            ("fit ", cfg!(feature = "fit")),
            ("sweep ", cfg!(feature = "sweep")),
        ];
        let lacks = |(command, is_there): (&str, bool)| line.starts_with(command) && !is_there;
        if optional.into_iter().any(lacks) {
            continue;
        }
        let failed = folder.refuses(line, part);
        let answer: Value = serde_json::from_str(&failed.stdout).unwrap();
        assert_contains(answer["error"].as_str().unwrap(), part);
        assert_eq!(answer["key"].as_str(), key, "{line}");
    }
    assert_eq!(folder.toprise("info missing.mcap", 2).stdout, "");
}

#[test]
fn honours_quiet_and_color() {
    let folder = recorded();
    #[cfg(feature = "sweep")]
    {
        let sweep = "sweep paper paper --set stop.duration=0.01 --over initial.theta=0.5";
        let noted = folder.toprise(&format!("{sweep} -o a.parquet"), 0);
        assert_ne!(noted.stderr, "");
        let quiet = folder.toprise(&format!("-q {sweep} -o b.parquet"), 0);
        assert_eq!(quiet.stderr, "");
    }
    // Errors are still printed, and so is output in a requested format.
    folder.refuses("info missing.mcap --quiet", "missing.mcap");
    assert_eq!(folder.toprise("info a.mcap -q", 0).stdout, "");
    let json = folder.toprise("info a.mcap -q --format json", 0).stdout;
    assert_ne!(json, "");
    let is_coloured = |line: &str, variable: &str| {
        let mut program = folder.program(line);
        let program = program.env_remove("NO_COLOR").env(variable, "1");
        printed(program, line, 0).stdout.contains('\x1b')
    };
    for (line, variable, expected) in [
        ("info a.mcap", "NO_COLOR", false),
        ("info a.mcap", "CLICOLOR_FORCE", true),
        ("info a.mcap --color always", "NO_COLOR", true),
        ("info a.mcap --color never", "CLICOLOR_FORCE", false),
        ("info a.mcap --color auto", "OTHER", false),
        ("info a.mcap --color always --format json", "OTHER", false),
    ] {
        assert_eq!(is_coloured(line, variable), expected, "{variable} {line}");
    }
}

#[test]
fn prints_each_cause_once() {
    let folder = recorded();
    for (line, cause) in [
        ("info missing.mcap", "No such file"),
        ("run missing/x.toml", "No such file"),
        ("explain text.mcap", "not an MCAP file"),
    ] {
        let error = folder.toprise(line, 2).stderr;
        assert_eq!(error.matches(cause).count(), 1, "{error}");
    }
}
