//! Writes the files of the repository that are made from tables.
//!
//! ```sh
//! cargo run --no-default-features --example generate               # pages of docs
//! cargo run --no-default-features --example generate -- release    # the version's entry in the table of releases
//! ```

use std::fs;
use std::io::Result;
use std::path::Path;
use toprise::archive::verify::release_entry;

#[path = "../tests/suite/generated.rs"]
mod generated;

/// The released schemas, which `verify` compares with.
const RELEASES: &str = "src/archive/verify/releases.txt";

fn main() -> Result<()> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    match std::env::args().nth(1).as_deref() {
        Some("release") => add_release(&root.join(RELEASES)),
        _ => write_pages(root),
    }
}

fn write_pages(root: &Path) -> Result<()> {
    for (path, page) in generated::pages() {
        fs::write(root.join(path), page)?;
    }
    Ok(())
}

/// Adds this version, unless it has been added before: then a test compares.
fn add_release(table: &Path) -> Result<()> {
    let version = env!("CARGO_PKG_VERSION");
    let releases = fs::read_to_string(table)?;
    if releases.contains(&format!("release {version} ")) {
        return Ok(());
    }
    fs::write(table, releases + &release_entry(version))
}
