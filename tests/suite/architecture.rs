//! The layers: an upper one may use a lower one, never the reverse.

use std::fs;
use std::path::{Path, PathBuf};

/// From the top down; modules on one line don't see each other, but for those named in `ALLOWED`.
const LAYERS: &[&[&str]] = &[
    &["cli"],
    &["recover"],
    &["convert", "diff", "explain", "figures", "verify", "view"],
    &["course", "subject"],
    &["sink", "recording"],
    &["telemetry"],
    &["simulation"],
    &["scenario"],
    &["dynamics"],
    &["friction", "drawing"],
    &["top"],
    &["integrate", "kinematics"],
    &["math", "phrase"],
];

/// Reading uses the names that writing defines.
const ALLOWED: &[(&str, &str)] = &[("recording", "sink")];

fn layer(module: &str) -> usize {
    LAYERS
        .iter()
        .position(|layer| layer.contains(&module))
        .unwrap_or_else(|| panic!("module {module} is in no layer: add it to LAYERS"))
}

fn rust_files(directory: &Path, files: &mut Vec<PathBuf>) {
    for entry in fs::read_dir(directory).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, files);
        } else if path.extension().is_some_and(|e| e == "rs") {
            files.push(path);
        }
    }
}

#[test]
fn no_layer_uses_one_above_it() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    let mut edges = 0;
    for file in files {
        let relative = file.strip_prefix(&root).unwrap();
        let first = relative.components().next().unwrap().as_os_str();
        let module = Path::new(first).file_stem().unwrap().to_str().unwrap();
        if module == "lib" || module == "main" {
            continue;
        }
        let text = fs::read_to_string(&file).unwrap();
        for rest in text.split("crate::").skip(1) {
            let used: String = rest
                .chars()
                .take_while(|c| c.is_ascii_lowercase() || *c == '_')
                .collect();
            if used.is_empty() || used == module {
                continue;
            }
            edges += 1;
            let permitted =
                layer(module) < layer(&used) || ALLOWED.contains(&(module, used.as_str()));
            assert!(permitted, "{} uses crate::{used}", relative.display());
        }
    }
    assert!(
        edges > 20,
        "the search for `crate::` finds nothing any more"
    );
}
