//! The version of the program.

use crate::telemetry::table;

/// The features that this program was compiled with.
const FEATURES: [(&str, bool); 3] = [
    ("fit", cfg!(feature = "fit")),
    ("rerun", cfg!(feature = "rerun")),
    ("sweep", cfg!(feature = "sweep")),
];

/// Version, telemetry version, commit (where the build names one) and features, for `--version`.
pub(super) fn long() -> String {
    let mut features = vec!["cli"];
    for (name, is_enabled) in FEATURES {
        if is_enabled {
            features.push(name);
        }
    }
    let mut text = format!(
        "{}\ntelemetry {}\nfeatures {}",
        env!("CARGO_PKG_VERSION"),
        table::VERSION,
        features.join(", ")
    );
    // Set by whoever builds: a build script would compile everything again after each commit.
    if let Some(commit) = option_env!("TOPRISE_COMMIT") {
        text.push_str(&format!("\ncommit {commit}"));
    }
    text
}
