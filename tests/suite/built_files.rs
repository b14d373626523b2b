//! Files that are built for a release: the page, pictures, and reference recordings. They stay those of the release until
//! `release/prepare` builds them again and writes their digests into the manifest.

use sha2::{Digest as _, Sha256};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The lines of the manifest, in the format of `sha256sum`: digest and path.
fn manifest() -> Vec<(String, String)> {
    let text = fs::read_to_string(root().join("release/manifest.sha256")).unwrap();
    text.lines()
        .map(|line| {
            let (digest, path) = line.split_once("  ").unwrap();
            (digest.to_owned(), path.to_owned())
        })
        .collect()
}

#[test]
fn built_files_change_with_a_release_only() {
    for (digest, path) in manifest() {
        let bytes = fs::read(root().join(&path)).unwrap();
        assert_eq!(
            format!("{:x}", Sha256::digest(bytes)),
            digest,
            "{path} differs from release/manifest.sha256; only release/prepare changes built files"
        );
    }
}

#[test]
fn manifest_lists_all_built_files() {
    let listed: BTreeSet<String> = manifest().into_iter().map(|(_, path)| path).collect();
    let mut built = BTreeSet::from(["docs/toprise.html".to_owned()]);
    for (folder, extension) in [
        ("docs", Some("png")),
        ("recordings/reference", None::<&str>),
    ] {
        for entry in fs::read_dir(root().join(folder)).unwrap() {
            let name = entry.unwrap().file_name().into_string().unwrap();
            if extension.is_none_or(|extension| name.ends_with(extension)) {
                built.insert(format!("{folder}/{name}"));
            }
        }
    }
    let missing: Vec<_> = built.difference(&listed).collect();
    assert!(
        missing.is_empty(),
        "release/manifest.sha256 lacks {missing:?}"
    );
}
