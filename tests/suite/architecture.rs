//! The architecture that ARCHITECTURE.md describes, checked by a search of the text, in which `rustfmt` gives every path
//! the same form.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;
use toprise::telemetry::channels;

/// The rooms from the bottom up; those of a level are independent of each other.
const LEVELS: &[&[&str]] = &[
    &["physics"],
    &["run"],
    &["telemetry"],
    &["archive"],
    &["analysis", "rerun", "sweep"],
    &["figures"],
    &["cli"],
];

/// Code by module path, without comments and unit tests.
type Code = BTreeMap<String, String>;

fn collect_code(directory: &Path, module: &str, code: &mut Code) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_stem().unwrap().to_str().unwrap();
        let name = format!("{module}::{name}");
        if path.is_dir() {
            collect_code(&path, &name, code);
        } else if !["crate::lib", "crate::main"].contains(&name.as_str()) {
            let text = fs::read_to_string(&path).unwrap_or_default();
            let text = text.split("\n#[cfg(test)]").next().unwrap_or_default();
            let is_code = |line: &&str| !line.trim_start().starts_with("//");
            code.insert(
                name,
                text.lines().filter(is_code).collect::<Vec<_>>().join("\n"),
            );
        }
    }
}

/// The files that a file names: in paths from `crate`, `self` or `super`, and as its modules.
fn used_files<'c>(file: &str, text: &str, code: &'c Code) -> BTreeSet<&'c str> {
    let text = text.replace("mod ", "self::");
    let mut used = BTreeSet::new();
    for (start, _) in ["crate::", "self::", "super::"]
        .iter()
        .flat_map(|root| text.match_indices(root))
        .filter(|(start, root)| {
            // Indented, `super` may be the file itself, seen from a module within it.
            let line = text[..*start].rsplit('\n').next().unwrap_or_default();
            *root == "crate::" || !line.starts_with(' ') && !line.ends_with("super::")
        })
    {
        let mut rest = &text[start..];
        let mut base = file;
        while let Some(above) = rest.strip_prefix("super::") {
            (base, _) = base.rsplit_once("::").unwrap();
            rest = above;
        }
        rest = rest.strip_prefix("self::").unwrap_or(rest);
        let end = rest.find(|c: char| !c.is_alphanumeric() && !"_:".contains(c));
        let (path, group) = rest.split_at(end.unwrap_or(rest.len()));
        let group = group
            .strip_prefix('{')
            .and_then(|group| group.split('}').next());
        for name in group.unwrap_or_default().split(',') {
            let mut target = format!("{path}{}", name.trim());
            if !target.starts_with("crate::") {
                target = format!("{base}::{target}");
            }
            while !code.contains_key(&target) && target.contains("::") {
                target.truncate(target.rfind("::").unwrap());
            }
            used.extend(code.get_key_value(&target).map(|(name, _)| name.as_str()));
        }
    }
    used.remove(file);
    used
}

fn level(file: &str) -> Option<usize> {
    let room = file.split("::").nth(1)?;
    LEVELS.iter().position(|rooms| rooms.contains(&room))
}

#[test]
fn rooms_use_only_lower_rooms_and_files_have_no_cycles() {
    let mut code = Code::new();
    collect_code(Path::new("src"), "crate", &mut code);
    let mut graph: BTreeMap<&str, BTreeSet<&str>> = code
        .iter()
        .map(|(file, text)| (file.as_str(), used_files(file, text, &code)))
        .collect();
    for (file, used) in &graph {
        assert!(level(file).is_some(), "{file} is in no room");
        for other in used {
            let is_same_room = file.split("::").nth(1) == other.split("::").nth(1);
            assert!(
                is_same_room || level(other) < level(file),
                "{file} uses {other}"
            );
            let leaves_plotting = file.contains("::plot::") && !other.contains("::plot");
            assert!(!leaves_plotting, "{file} uses {other}");
        }
    }
    // A file that uses none of the others, or is used by none, is in no cycle.
    let mut others = graph.len() + 1;
    while graph.len() < others {
        others = graph.len();
        let used: BTreeSet<&str> = graph.values().flatten().copied().collect();
        graph.retain(|file, _| used.contains(file));
        let files: BTreeSet<&str> = graph.keys().copied().collect();
        for used in graph.values_mut() {
            used.retain(|other| files.contains(other));
        }
        graph.retain(|_, used| !used.is_empty());
    }
    assert!(graph.is_empty(), "files with cyclic uses: {graph:#?}");
}

#[test]
fn only_the_table_names_topics() {
    let mut code = Code::new();
    collect_code(Path::new("src"), "crate", &mut code);
    code.retain(|file, _| {
        file != "crate::telemetry::table" && file != "crate::telemetry::views::table"
    });
    for (file, text) in code {
        let named = channels().iter().find(|info| text.contains(info.topic));
        assert!(named.is_none(), "{file} names {}", named.unwrap().topic);
    }
}
