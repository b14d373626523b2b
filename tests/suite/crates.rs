//! Archives of recordings: research object crates, as directories and ZIP files.

use crate::support::{Folder, assert_contains};
use serde_json::Value;
use sha2::{Digest as _, Sha256};
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipWriter};

const ABOUT: &str = r#"
title = "Two tops"
licence = "CC-BY-4.0"
date = 2026-11-29
keywords = ["spinning top", "friction: slipping"]

[[creators]]
name = "Carberry, Josiah"
orcid = "0000-0002-1825-0097"

[[related]]
relation = "isSupplementTo"
id = "arXiv:1101.0001"
"#;

/// A folder with two recordings, `a.mcap` and `b b.mcap`, and their archive `crate`.
fn archived() -> Folder {
    let folder = Folder::new();
    folder.write("about.toml", ABOUT);
    folder.write("notes.txt", "measured at night");
    for (name, k) in [("a", "0.03"), ("b", "0.05")] {
        let keys = format!("--set stop.duration=0.05 --set friction.k={k}");
        folder.toprise(&format!("run paper {keys} -o {name}.mcap"), 0);
    }
    fs::rename(folder.at("b.mcap"), folder.at("b b.mcap")).unwrap();
    let arguments = [
        "a.mcap",
        "b b.mcap",
        "--about",
        "about.toml",
        "--add",
        "notes.txt",
    ];
    let mut archive = folder.program("archive -o crate");
    archive.args(arguments).assert().code(0);
    folder
}

/// All files of a directory, relative.
fn files_in(directory: &Path) -> Vec<PathBuf> {
    let (mut files, mut folders) = (Vec::new(), vec![directory.to_owned()]);
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else {
                files.push(path.strip_prefix(directory).unwrap().to_owned());
            }
        }
    }
    files.sort();
    files
}

/// Packs the files of `crate` as people do: compressed, in a folder.
fn pack(folder: &Folder, name: &str) {
    let mut zip = ZipWriter::new(fs::File::create(folder.at(name)).unwrap());
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Deflated);
    for file in files_in(&folder.at("crate")) {
        let inside = Path::new("crate").join(&file);
        zip.start_file(inside.to_str().unwrap(), options).unwrap();
        zip.write_all(&folder.read(inside)).unwrap();
    }
    zip.finish().unwrap();
}

#[test]
fn archives_are_verified_as_directories_and_zip_files() {
    let folder = archived();
    let printed = folder.toprise("verify crate", 0);
    assert_contains(&printed.stdout, "every file that follows from them");
    // The order of the arguments doesn't matter.
    for name in ["one.zip", "two.zip"] {
        let mut recordings = vec!["a.mcap", "b b.mcap"];
        if name == "two.zip" {
            recordings.reverse();
        }
        let mut archive = folder.program(&format!("archive --about about.toml -o {name}"));
        archive.args(recordings).args(["--add", "notes.txt"]);
        archive.assert().code(0);
    }
    assert!(folder.read("one.zip") == folder.read("two.zip"));
    pack(&folder, "packed.zip");
    folder.toprise("verify one.zip packed.zip a.mcap", 0);
}

#[test]
fn archives_take_what_the_recordings_say() {
    let folder = archived();
    folder.toprise("annotate a.mcap about.toml -o c.mcap", 0);
    folder.toprise("archive c.mcap -o own", 0);
    let name = "CITATION.cff";
    assert_eq!(
        folder.text(Path::new("own").join(name)),
        folder.text(Path::new("crate").join(name))
    );
    folder.write("other.toml", ABOUT.replace("29", "30"));
    folder.toprise("run drop --about other.toml -o d.mcap", 0);
    for (arguments, expected) in [
        ("archive c.mcap d.mcap -o new", "say different things"),
        ("archive a.mcap -o new", "--about"),
        (
            "archive c.mcap --about other.toml -o new",
            "says something else of itself",
        ),
        (
            "archive a.mcap --add . --about about.toml -o new",
            "no name",
        ),
        (
            "archive a.mcap --add ./.hidden --about about.toml -o new",
            "no name",
        ),
        (
            "archive a.mcap --add gone --about about.toml -o new",
            "gone is no file",
        ),
        (
            "archive a.mcap a.mcap --about about.toml -o new",
            "rename a recording",
        ),
        ("archive a.mcap --about about.toml -o crate", "crate exists"),
        ("archive about.toml --about about.toml -o new", "about.toml"),
        ("verify recordings", "recordings"),
    ] {
        let printed = folder.toprise(arguments, 2);
        assert_contains(&printed.stderr, expected);
    }
    fs::create_dir(folder.at("empty")).unwrap();
    assert_contains(&folder.toprise("verify empty", 2).stderr, "SHA256SUMS");
    let mut bytes = folder.read("a.mcap");
    let middle = bytes.len() / 2;
    bytes[middle] ^= 1;
    folder.write("damaged.mcap", bytes);
    let printed = folder.toprise("archive damaged.mcap --about about.toml -o new", 2);
    assert_contains(&printed.stderr, "does not verify");
    assert!(!folder.at("new").exists());
}

/// Writes sums that fit the files: into the metadata, and into the list.
fn forge_sums(directory: &Path) {
    let sum = |path: &Path| {
        format!(
            "{:x}",
            Sha256::digest(fs::read(directory.join(path)).unwrap())
        )
    };
    let path = directory.join("ro-crate-metadata.json");
    let Ok(mut metadata) = serde_json::from_slice::<Value>(&fs::read(&path).unwrap()) else {
        return;
    };
    for entity in metadata["@graph"].as_array_mut().unwrap() {
        let name = entity["name"].as_str().unwrap_or_default().to_owned();
        if entity.get("sha256").is_some() && directory.join(&name).is_file() {
            entity["sha256"] = sum(Path::new(&name)).into();
        }
    }
    fs::write(path, format!("{metadata:#}\n")).unwrap();
    let mut sums = String::new();
    for file in files_in(directory) {
        if file != Path::new("SHA256SUMS") {
            sums.push_str(&format!("{}  {}\n", sum(&file), file.display()));
        }
    }
    fs::write(directory.join("SHA256SUMS"), sums).unwrap();
}

#[test]
fn any_altered_file_of_an_archive_is_found() {
    let folder = archived();
    let files = files_in(&folder.at("crate"));
    assert!(files.len() > 30, "{files:?}");
    let mut missed = Vec::new();
    let mut try_code = |name: String, code: i32| {
        let output = folder.program("verify crate").output().unwrap();
        if output.status.code() != Some(code) {
            missed.push(format!(
                "{name}: {}",
                String::from_utf8_lossy(&output.stdout)
            ));
        }
    };
    for file in &files {
        let path = folder.at(Path::new("crate").join(file));
        let original = fs::read(&path).unwrap();
        let mut changed = original.clone();
        let middle = changed.len() / 2;
        changed[middle] ^= 1;
        fs::write(&path, changed).unwrap();
        try_code(format!("a byte of {}", file.display()), 1);
        fs::remove_file(&path).unwrap();
        let is_sums = file == Path::new("SHA256SUMS");
        try_code(
            format!("no {}", file.display()),
            if is_sums { 2 } else { 1 },
        );
        fs::write(&path, original).unwrap();
    }
    let sums = folder.read("crate/SHA256SUMS");
    let no_text: Vec<u8> = sums.iter().map(|byte| byte | 0x80).collect();
    folder.write("crate/SHA256SUMS", no_text);
    try_code("sums that are no text".to_owned(), 1);
    folder.write("crate/SHA256SUMS", sums);
    let added = folder.write("crate/reports/more.md", "more");
    try_code("an added file".to_owned(), 1);
    fs::remove_file(added).unwrap();
    try_code("untouched".to_owned(), 0);
    assert!(missed.is_empty(), "{}", missed.join("\n"));
}

#[test]
fn forged_sums_hide_no_alteration() {
    let folder = archived();
    let original = folder.at("crate");
    let changes: [(&str, &str, &str); 9] = [
        ("README.md", "Two tops", "Three tops"),
        ("CITATION.cff", "CC-BY-4.0", "CC0-1.0"),
        (".zenodo.json", "cc-by-4.0", "cc-zero"),
        ("datacite.json", "CC-BY-4.0", "CC0-1.0"),
        ("ro-crate-metadata.json", "CC-BY-4.0", "CC0-1.0"),
        ("ro-crate-metadata.json", "toprise run", "toprise walk"),
        ("scenarios/a.toml", "k = 0.03", "k = 0.04"),
        ("reports/a-b b.diff.md", "B", "C"),
        ("reports/a.explain.json", "0", "1"),
    ];
    for (file, from, to) in changes {
        let path = original.join(file);
        let text = fs::read_to_string(&path).unwrap();
        assert!(text.contains(from), "{file}");
        let forged: Vec<_> = files_in(&original)
            .into_iter()
            .map(|file| {
                (
                    original.join(&file),
                    fs::read(original.join(&file)).unwrap(),
                )
            })
            .collect();
        fs::write(&path, text.replace(from, to)).unwrap();
        forge_sums(&original);
        let printed = folder.toprise("verify crate", 1);
        assert_contains(&printed.stdout, file);
        for (path, content) in forged {
            fs::write(path, content).unwrap();
        }
    }
    folder.toprise("verify crate", 0);
}

#[test]
fn archives_of_other_versions_are_compared_in_part() {
    let folder = archived();
    let path = folder.at("crate/ro-crate-metadata.json");
    let text = fs::read_to_string(&path).unwrap();
    let mut metadata: Value = serde_json::from_str(&text).unwrap();
    for entity in metadata["@graph"].as_array_mut().unwrap() {
        if entity["@id"] == "#maker" {
            entity["softwareVersion"] = "9.9.9".into();
        }
    }
    fs::write(path, format!("{metadata:#}\n")).unwrap();
    forge_sums(&folder.at("crate"));
    let printed = folder.toprise("verify crate", 3);
    assert_contains(&printed.stdout, "toprise 9.9.9");
}

#[test]
fn archives_are_the_same_in_any_order_and_hold_runs_of_few_topics() {
    let folder = archived();
    let few = "run paper --set stop.duration=0.05 --topics /top/state -o few.mcap";
    folder.toprise(few, 0);
    for (name, added) in [
        ("x.zip", "--add notes.txt --add about.toml"),
        ("y.zip", "--add about.toml --add notes.txt"),
    ] {
        folder.toprise(
            &format!("archive few.mcap a.mcap {added} --about about.toml -o {name}"),
            0,
        );
    }
    assert!(folder.read("x.zip") == folder.read("y.zip"));
    folder.toprise("verify x.zip", 0);
}

#[test]
fn names_that_would_collide_are_refused_before_anything_is_written() {
    let folder = archived();
    for name in ["a-b", "b-c", "c", "A"] {
        fs::copy(folder.at("a.mcap"), folder.at(format!("{name}.mcap"))).unwrap();
    }
    for names in ["a.mcap b-c.mcap a-b.mcap c.mcap", "a.mcap A.mcap"] {
        let line = format!("archive {names} --about about.toml -o new");
        assert_contains(&folder.toprise(&line, 2).stderr, "rename a recording");
        assert!(!folder.at("new").exists());
    }
}

#[test]
fn an_archive_holds_recordings() {
    let folder = archived();
    for name in ["recordings", "scenarios", "reports", "figures"] {
        fs::remove_dir_all(folder.at(Path::new("crate").join(name))).unwrap();
    }
    forge_sums(&folder.at("crate"));
    let printed = folder.toprise("verify crate", 1);
    assert_contains(&printed.stdout, "recordings is missing");
}

/// Links lead out of the archive, and pipes never end.
#[cfg(unix)]
#[test]
fn links_and_pipes_are_no_files_of_an_archive() {
    let folder = archived();
    let copy = folder.at("copy.md");
    fs::rename(folder.at("crate/README.md"), &copy).unwrap();
    std::os::unix::fs::symlink(&copy, folder.at("crate/README.md")).unwrap();
    assert_contains(
        &folder.toprise("verify crate", 1).stdout,
        "README.md is a link",
    );
    fs::remove_file(folder.at("crate/README.md")).unwrap();
    let made = std::process::Command::new("mkfifo")
        .arg(folder.at("crate/README.md"))
        .status();
    assert!(made.unwrap().success());
    assert_contains(
        &folder.toprise("verify crate", 1).stdout,
        "README.md is a link",
    );
}

/// Programs differ in which of two files of one name they unpack.
#[test]
fn zip_files_with_a_name_twice_are_refused() {
    let folder = archived();
    let mut zip = ZipWriter::new(fs::File::create(folder.at("twice.zip")).unwrap());
    let options = SimpleFileOptions::default().compression_method(CompressionMethod::Stored);
    for (name, content) in [("README.md", "one"), ("README.mx", "other")] {
        zip.start_file(name, options).unwrap();
        zip.write_all(content.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    let mut bytes = folder.read("twice.zip");
    for at in 0..bytes.len() - 9 {
        if &bytes[at..at + 9] == b"README.mx" {
            bytes[at + 8] = b'd';
        }
    }
    folder.write("twice.zip", bytes);
    assert_contains(
        &folder.toprise("verify twice.zip", 2).stderr,
        "two files of one name",
    );
}
