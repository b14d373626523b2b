//! The package for the registry: everything that the crate is built from, and nothing that is too large for it.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Bytes before compression. Registries accept 10 MB of compressed ones; the sources compress to a quarter, so that people
/// download less than a megabyte.
const LARGEST: u64 = 4_000_000;

#[test]
fn package_is_complete_and_small() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let output = Command::new(env!("CARGO"))
        .args(["package", "--list", "--allow-dirty", "--offline"])
        .current_dir(root)
        .output()
        .unwrap();
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    let listed = String::from_utf8(output.stdout).unwrap();
    let packed: BTreeSet<&Path> = listed.lines().map(Path::new).collect();
    let bytes: u64 = packed
        .iter()
        .filter_map(|file| fs::metadata(root.join(file)).ok())
        .map(|metadata| metadata.len())
        .sum();
    assert!(bytes < LARGEST, "the package holds {bytes} bytes");
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

#[test]
fn every_part_has_the_same_version() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        ("python/Cargo.toml", format!("version = \"{version}\"")),
        ("page/Cargo.toml", format!("version = \"{version}\"")),
        ("CITATION.cff", format!("version: {version}")),
    ] {
        let text = fs::read_to_string(root.join(file)).unwrap();
        assert!(text.lines().any(|other| other == line), "{file}: {line}");
    }
}
