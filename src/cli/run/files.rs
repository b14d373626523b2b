//! Which files a run writes.

use super::RunArguments;
use crate::archive::format::CONTENT_DIGEST;
use crate::archive::publish::partial_name;
use crate::archive::recording::Recording;
use crate::archive::writer::Archived;
use crate::run::scenario::Scenario;
use anyhow::{Error, bail};
use std::path::{Path, PathBuf};

/// Where recordings go if nothing else is said.
const DIRECTORY: &str = "recordings";

/// The files of a run.
pub(super) struct Plan {
    pub(super) mcap: PathBuf,
    pub(super) rrd: Option<PathBuf>,
    /// Recordings of the same name that were there before.
    earlier: Vec<PathBuf>,
}

impl Plan {
    /// Chooses the names.
    pub(super) fn new(arguments: &RunArguments, scenario: &Scenario) -> Result<Self, Error> {
        let mut plan = match &arguments.output {
            Some(mcap) => Self {
                mcap: mcap.clone(),
                rrd: None,
                earlier: Vec::new(),
            },
            None => Self::free(scenario.name(), arguments.force),
        };
        #[cfg(feature = "rerun")]
        if arguments.no_rrd {
            plan.rrd = None;
        } else if let Some(rrd) = &arguments.rrd {
            plan.rrd = Some(rrd.clone());
        }
        if cfg!(not(feature = "rerun")) {
            plan.rrd = None;
        }
        if plan.rrd.as_ref() == Some(&plan.mcap) {
            bail!(
                "{} can't be both the MCAP and the Rerun recording",
                plan.mcap.display()
            );
        }
        Ok(plan)
    }

    /// The first of `NAME`, `NAME-2`, `NAME-3`, … of which nothing exists; `NAME` itself if it may be
    /// replaced.
    fn free(name: &str, replace: bool) -> Self {
        let mut earlier = Vec::new();
        let mut number = 1;
        loop {
            let stem = match number {
                1 => name.to_owned(),
                _ => format!("{name}-{number}"),
            };
            let file = |extension: &str| Path::new(DIRECTORY).join(format!("{stem}.{extension}"));
            let (mcap, rrd) = (file("mcap"), file("rrd"));
            let taken = [&mcap, &rrd]
                .into_iter()
                .any(|path| path.exists() || partial_name(path).exists());
            if replace || !taken {
                return Self {
                    mcap,
                    rrd: Some(rrd),
                    earlier,
                };
            }
            earlier.push(mcap);
            number += 1;
        }
    }

    /// The latest of the earlier recordings whose content is that of the new one.
    pub(super) fn identical(&self, archive: &Archived) -> Option<&Path> {
        let same = |path: &&PathBuf| {
            let earlier = Recording::open(path).ok();
            let end = earlier.as_ref().and_then(Recording::end);
            end.is_some_and(|end| end.get(CONTENT_DIGEST) == Some(&archive.digest))
        };
        self.earlier.iter().rev().find(same).map(PathBuf::as_path)
    }
}
