//! Kinds of files that commands write, and the names that they may have.

use std::path::{Path, PathBuf};
use thiserror::Error;

/// A kind of file that an option names.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum FileKind {
    /// An MCAP recording.
    Mcap,
    /// A Rerun recording.
    #[cfg_attr(
        not(any(feature = "rerun", test)),
        expect(dead_code, reason = "written by Rerun")
    )]
    Rrd,
    /// The table of a sweep.
    #[cfg_attr(
        not(any(feature = "sweep", test)),
        expect(dead_code, reason = "written by sweeps")
    )]
    Parquet,
    /// A scenario file.
    #[cfg_attr(
        not(any(feature = "fit", test)),
        expect(dead_code, reason = "written by fits")
    )]
    Scenario,
}

/// A name of a file that promises another kind.
#[derive(Debug, PartialEq, Eq, Error)]
pub(super) enum ExtensionError {
    /// A name of a Rerun recording for an MCAP file.
    #[error("{option} is for the MCAP file; to write the Rerun recording {}, use --rrd {}", path.display(), path.display())]
    IsRerun { option: &'static str, path: PathBuf },
    /// A name of something else.
    #[error("{option} writes {noun}: call it {}", name.display())]
    Other {
        option: &'static str,
        noun: &'static str,
        /// The path with the right extension.
        name: PathBuf,
    },
}

impl FileKind {
    /// Refuses a name that promises another kind of file. A name without an extension promises nothing.
    pub(super) fn check(self, option: &'static str, path: &Path) -> Result<(), ExtensionError> {
        let Some(extension) = path.extension() else {
            return Ok(());
        };
        let (noun, own) = match self {
            Self::Mcap => ("an MCAP file", "mcap"),
            Self::Rrd => ("a Rerun recording", "rrd"),
            Self::Parquet => ("a Parquet table", "parquet"),
            Self::Scenario => ("a scenario file", "toml"),
        };
        // Drafts have their own error.
        if extension == own || extension == "partial" {
            return Ok(());
        }
        // For Rerun recordings there is an option, which the error names if this program has it.
        let is_rerun = cfg!(feature = "rerun") && extension == "rrd";
        Err(if self == Self::Mcap && is_rerun {
            ExtensionError::IsRerun {
                option,
                path: path.to_owned(),
            }
        } else {
            ExtensionError::Other {
                option,
                noun,
                name: path.with_extension(own),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_outputs_with_other_extensions() {
        for (kind, name, expected) in [
            (FileKind::Mcap, "a.mcap", ""),
            (FileKind::Mcap, "a", ""),
            (
                FileKind::Mcap,
                "a.rrd",
                if cfg!(feature = "rerun") {
                    "use --rrd a.rrd"
                } else {
                    "-o writes an MCAP file: call it a.mcap"
                },
            ),
            (
                FileKind::Mcap,
                "a.txt",
                "-o writes an MCAP file: call it a.mcap",
            ),
            (FileKind::Rrd, "b/z.rrd", ""),
            (
                FileKind::Rrd,
                "b/z.txt",
                "-o writes a Rerun recording: call it b/z.rrd",
            ),
            (FileKind::Rrd, "z.mcap", "call it z.rrd"),
            (FileKind::Parquet, "map.parquet", ""),
            (
                FileKind::Parquet,
                "map.csv",
                "-o writes a Parquet table: call it map.parquet",
            ),
            (FileKind::Scenario, "best.toml", ""),
            (
                FileKind::Scenario,
                "best.mcap",
                "-o writes a scenario file: call it best.toml",
            ),
        ] {
            let error = kind.check("-o", Path::new(name)).err();
            let message = error.map_or_else(String::new, |error| error.to_string());
            assert!(message.contains(expected), "{name}: {message}");
            assert_eq!(message.is_empty(), expected.is_empty(), "{name}");
        }
    }
}
