//! The package for the registry: everything that the crate is built from, and nothing that is too large for it.

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Bytes before compression. Registries accept 10 MB of compressed ones, so what is below that uncompressed is small enough.
const MAX_SIZE: u64 = 10_000_000;

/// The files of the package.
fn packed() -> BTreeSet<PathBuf> {
    let output = Command::new(env!("CARGO"))
        .args(["package", "--list", "--allow-dirty", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let listed = String::from_utf8(output.stdout).unwrap();
    listed.lines().map(PathBuf::from).collect()
}

#[test]
fn package_is_complete_and_small() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let packed = packed();
    let bytes: u64 = packed
        .iter()
        .filter_map(|file| fs::metadata(root.join(file)).ok())
        .map(|metadata| metadata.len())
        .sum();
    assert!(bytes < MAX_SIZE, "the package holds {bytes} bytes");
    for file in ["README.md", "LICENSE-MIT", "LICENSE-APACHE", "Cargo.lock"] {
        assert!(packed.contains(Path::new(file)), "{file} is not packed");
    }
    let mut included = 0;
    for file in packed
        .iter()
        .filter(|f| f.extension().is_some_and(|e| e == "rs"))
    {
        let text = fs::read_to_string(root.join(file)).unwrap();
        for rest in text
            .split("include_str!(\"")
            .chain(text.split("include_bytes!(\""))
            .skip(1)
        {
            let Some((name, _)) = rest.split_once("\")") else {
                continue;
            };
            let path = file.parent().unwrap().join(name);
            if !name.contains('\n') && root.join(&path).exists() {
                included += 1;
                assert!(
                    packed.contains(path.as_path()),
                    "{} is not packed",
                    path.display()
                );
            }
        }
    }
    assert!(included > 5, "only {included} included files are found");
}

/// Registries show README.md, and the package is all that some readers have.
#[test]
fn readme_links_lead_into_the_package() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let packed = packed();
    let readme = fs::read_to_string(root.join("README.md")).unwrap();
    let targets = readme.split("](").skip(1);
    let targets = targets.filter_map(|rest| rest.split([')', '#']).next());
    let mut links = 0;
    for target in targets.filter(|target| !target.contains("://")) {
        assert!(packed.contains(Path::new(target)), "{target} is not packed");
        links += 1;
    }
    assert!(links > 20, "only {links} links are found");
}

#[test]
fn every_part_has_the_same_version() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        ("python/Cargo.toml", format!("version = \"{version}\"")),
        ("page/Cargo.toml", format!("version = \"{version}\"")),
        ("CITATION.cff", format!("version: {version}")),
        ("codemeta.json", format!("  \"version\": \"{version}\",")),
    ] {
        let text = fs::read_to_string(root.join(file)).unwrap();
        assert!(text.lines().any(|other| other == line), "{file}: {line}");
    }
}
