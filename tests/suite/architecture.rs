//! The architecture that ARCHITECTURE.md describes, checked by a search of the text: `rustfmt` gives every path the same
//! form.

use crate::file_graph::FileGraph;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use toprise::telemetry::channels;

/// The rooms from the bottom up, each with those that it may use; `cli` may use all.
const ROOMS: [(&str, &str); 11] = [
    ("words", ""),
    ("physics", ""),
    ("run", "words physics"),
    ("telemetry", "words physics run"),
    ("archive", "words physics run telemetry"),
    ("sweep", "words physics run telemetry archive"),
    ("analysis", "words physics run telemetry archive"),
    ("measured", "words physics run telemetry archive"),
    ("fit", "words physics run telemetry archive measured"),
    (
        "figures",
        "words physics run telemetry archive sweep analysis measured fit",
    ),
    ("rerun", "words physics run telemetry archive analysis"),
];

/// The code of each file below `src`, by path, without comments and unit tests.
fn code() -> BTreeMap<String, String> {
    let mut code = BTreeMap::new();
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut directories = vec![src.clone()];
    while let Some(directory) = directories.pop() {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                directories.push(path);
            } else if path.extension().is_some_and(|kind| kind == "rs") {
                let text = fs::read_to_string(&path).unwrap();
                let text = text.split("\n#[cfg(test)]").next().unwrap();
                let lines = text.lines();
                let lines = lines.filter(|line| !line.trim_start().starts_with("//"));
                let name = path.strip_prefix(&src).unwrap().display().to_string();
                code.insert(name, lines.collect::<Vec<_>>().join("\n"));
            }
        }
    }
    code
}

#[test]
fn rooms_use_only_those_below() {
    for (file, text) in code() {
        let room = file.split(['/', '.']).next().unwrap();
        if ["lib", "main", "bin", "cli"].contains(&room) {
            continue;
        }
        let place = ROOMS.iter().find(|(name, _)| *name == room);
        let (_, allowed) = place.unwrap_or_else(|| panic!("{file} is in no room"));
        for path in text.split("crate::").skip(1) {
            let used = path.split([':', ';', ')']).next().unwrap();
            assert!(
                used == room || allowed.split(' ').any(|name| name == used),
                "{file} uses {used}"
            );
        }
    }
}

#[test]
fn files_form_no_circles() {
    let circles = FileGraph::new(&code()).circles();
    assert!(
        circles.is_empty(),
        "files that depend on each other: {circles:?}"
    );
}

/// A folder is read at a glance.
#[test]
fn folders_have_at_most_15_files() {
    let mut sizes: BTreeMap<String, usize> = BTreeMap::new();
    for file in code().into_keys() {
        let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
        *sizes.entry(folder.to_owned()).or_default() += 1;
    }
    for (folder, files) in sizes {
        assert!(files <= 15, "{folder}: {files} files");
    }
}

#[test]
fn only_cli_uses_clap() {
    for (file, text) in code() {
        assert!(file.starts_with("cli") || !text.contains("clap"), "{file}");
    }
}

/// What depends on a feature is in its module; `commands.rs` and `extension.rs` list the commands and the arguments of
/// features. `cfg!` is left to texts, `cfg_attr` to lints.
#[test]
fn cli_chooses_only_modules_by_feature() {
    let mut modules = 0;
    for (file, text) in code() {
        let is_list = ["cli/commands.rs", "cli/extension.rs"].contains(&file.as_str());
        if !file.starts_with("cli/") || is_list {
            continue;
        }
        for rest in text.split("#[cfg(").skip(1) {
            let (condition, rest) = rest.split_once(")]").unwrap();
            if condition.contains("feature") {
                let mut lines = rest.lines().map(str::trim);
                let item = lines.find(|line| !line.is_empty() && !line.starts_with("#["));
                let is_module = item.is_some_and(|item| item.contains("mod "));
                assert!(is_module, "{file}: {condition}");
                modules += 1;
            }
        }
    }
    assert!(modules >= 3, "{modules}");
}

#[test]
fn only_the_table_names_topics() {
    let tables = ["telemetry/table.rs", "telemetry/supplement.rs"];
    for (file, text) in code() {
        let named = channels().iter().find(|info| text.contains(info.topic));
        assert!(named.is_none() || tables.contains(&file.as_str()), "{file}");
    }
}
