//! The arguments of `toprise run`.

use crate::archive::input::{self, has_extension, is_recording};
use crate::archive::writer::Form;
use crate::cli::arguments::{OUTPUT, Override, VIEWER, parse_number, parse_override};
use crate::cli::input::checked;
#[cfg(feature = "rerun")]
use crate::cli::report::WrittenFile;
#[cfg(feature = "rerun")]
use crate::cli::viewer::ViewerArguments;
use crate::run::scenario::{Scenario, Value, Values};
#[cfg(feature = "sweep")]
use crate::sweep::values_of_row;
use crate::telemetry::Topics;
use crate::telemetry::encoding::Encoding;
use anyhow::{Error, bail};
use clap::Args;
use std::ffi::OsStr;
#[cfg(feature = "rerun")]
use std::path::Path;
use std::path::PathBuf;

/// Arguments of `toprise run`.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct RunArguments {
    /// Preset, scenario file, or recording to repeat
    #[arg(default_value = "paper")]
    pub(super) scenario: PathBuf,

    /// Run this row of a sweep table (SCENARIO is the .parquet file)
    #[cfg(feature = "sweep")]
    #[arg(long, value_name = "N")]
    row: Option<u64>,

    /// Set a key, e.g. friction.k=0.02; an empty value removes it
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    pub(super) overrides: Vec<Override>,

    /// MCAP file to write [default: next free name in recordings/, with an .rrd file]
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) output: Option<PathBuf>,

    /// Write a Rerun recording (.rrd) to this file
    #[cfg(feature = "rerun")]
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    pub(super) rrd: Option<PathBuf>,

    /// Don't write a Rerun recording
    #[cfg(feature = "rerun")]
    #[arg(long, conflicts_with = "rrd", help_heading = OUTPUT)]
    pub(super) no_rrd: bool,

    #[cfg(feature = "rerun")]
    #[command(flatten)]
    pub(super) viewer: ViewerArguments,

    /// Message encoding [default: json, or that of the repeated recording]
    #[arg(long, value_enum, help_heading = OUTPUT)]
    encoding: Option<Encoding>,

    /// Omit the ROS 2 channels for viewers (/tf, /view/…, /log)
    #[arg(long, help_heading = OUTPUT)]
    no_views: bool,

    /// Record only these topics (comma-separated)
    #[arg(long, value_name = "TOPICS", value_delimiter = ',', help_heading = OUTPUT)]
    topics: Vec<String>,

    /// Limit the speed to real time, or to SPEED × real time
    #[arg(long, value_name = "SPEED", num_args = 0..=1, default_missing_value = "1",
          value_parser = parse_speed, help_heading = VIEWER)]
    pub(super) realtime: Option<f64>,

    /// Overwrite existing files
    #[arg(long, help_heading = OUTPUT)]
    pub(super) force: bool,
}

impl RunArguments {
    /// The keys and values before overrides.
    pub(super) fn values(&self) -> Result<Values, Error> {
        let is_table = has_extension(&self.scenario, "parquet");
        let name = self.scenario.display();
        #[cfg(feature = "sweep")]
        if let Some(row) = self.row {
            if !is_table {
                bail!("{name} is not a sweep table: --row needs a .parquet file");
            }
            return Ok(values_of_row(&self.scenario, row)?);
        }
        if is_table {
            bail!("{name} is a sweep table: choose a row, e.g. --row 42");
        }
        Ok(input::values(&self.scenario)?)
    }

    /// The scenario that is run.
    pub(super) fn scenario(&self, values: Values) -> Result<Scenario, Error> {
        checked(&self.scenario, values, &self.overrides)
    }

    /// Refuses to write an MCAP file under the name of a Rerun recording.
    pub(super) fn check_output(&self) -> Result<(), Error> {
        let is_rrd = |path: &&PathBuf| path.extension().is_some_and(|kind| kind == "rrd");
        match self.output.as_ref().filter(is_rrd) {
            Some(path) => bail!(
                "-o is for the MCAP file; to write the Rerun recording {}, use --rrd {0}",
                path.display()
            ),
            None => Ok(()),
        }
    }

    /// Note that -o suppressed the Rerun recording.
    #[cfg_attr(not(feature = "rerun"), allow(clippy::unused_self))]
    pub(super) fn note_on_rrd(&self) -> Option<&'static str> {
        #[cfg(feature = "rerun")]
        let is_left_out = self.output.is_some() && self.rrd.is_none() && !self.no_rrd;
        #[cfg(not(feature = "rerun"))]
        let is_left_out = false;
        is_left_out.then_some("no Rerun recording with -o; add --rrd FILE to write one")
    }

    /// File stem: name of the repeated recording or of the scenario, with the changed keys appended, e.g.
    /// `paper_k0.02`. If it is too long, the start of the scenario digest replaces the changes.
    pub(super) fn stem(&self, scenario: &Scenario, base: &Values) -> String {
        /// Maximum length of a file stem.
        const LONGEST: usize = 60;
        let file = self.scenario.file_name().and_then(OsStr::to_str);
        let file = file.filter(|_| is_recording(&self.scenario));
        let name = file.map(|file| {
            let file = file.trim_end_matches(".partial");
            file.trim_end_matches(".mcap").trim_end_matches(".parquet")
        });
        let name = name
            .filter(|name| !name.is_empty())
            .unwrap_or_else(|| scenario.name());
        let mut stem = name.to_owned();
        #[cfg(feature = "sweep")]
        if let Some(row) = self.row {
            stem += &format!("_row{row}");
        }
        for (key, value) in scenario.changes(base) {
            let key = key.short_name();
            stem += &match value {
                None => format!("_no-{key}"),
                Some(Value::Number(number)) => format!("_{key}{number}"),
                Some(Value::Text(word)) => format!("_{key}-{word}"),
            };
        }
        if stem != name && stem.len() > LONGEST {
            return format!("{name}_{:.8}", scenario.digest());
        }
        stem
    }

    /// The existing Rerun recording next to an existing MCAP file, unless --rrd names another.
    #[cfg(feature = "rerun")]
    pub(super) fn adjacent_rrd(&self, mcap: Option<&WrittenFile>) -> Option<WrittenFile> {
        let mcap = mcap.filter(|_| self.rrd.is_none())?;
        let path = Path::new(&mcap.path).with_extension("rrd");
        let bytes = path.metadata().ok()?.len();
        Some(WrittenFile::new(&path, bytes))
    }

    /// Format and topics of the MCAP file: from the repeated recording, unless set by arguments.
    pub(super) fn form(&self) -> Result<(Form, Topics), Error> {
        let recorded = input::form(&self.scenario);
        let (mut form, mut topics) = recorded.unwrap_or_default();
        form.encoding = self.encoding.unwrap_or(form.encoding);
        form.views &= !self.no_views;
        if !self.topics.is_empty() {
            topics = Topics::named(&self.topics)?;
        }
        Ok((form, topics))
    }
}

fn parse_speed(text: &str) -> Result<f64, String> {
    let is_speed = |speed: &f64| speed.is_finite() && *speed > 0.0;
    parse_number(text, is_speed, "must be a positive number, e.g. 0.5")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn run_alone_means_the_paper() {
        let base = parse::<RunArguments>("").unwrap();
        assert_eq!(base.scenario, PathBuf::from("paper"));
        assert_eq!((base.realtime, base.force), (None, false));
        assert_eq!(parse::<RunArguments>("paper").unwrap(), base);
        assert_eq!(
            parse::<RunArguments>("mine.toml -o a.mcap --realtime --set friction.k=0.02").unwrap(),
            RunArguments {
                scenario: "mine.toml".into(),
                output: Some("a.mcap".into()),
                realtime: Some(1.0),
                overrides: vec![("friction.k".to_owned(), "0.02".to_owned())],
                ..base
            }
        );
        for line in [
            "--realtime 0",
            "--realtime inf",
            "--set friction.k",
            "--encoding cdr",
        ] {
            assert!(parse::<RunArguments>(line).is_err(), "{line}");
        }
    }
}
