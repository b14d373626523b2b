//! The arguments of `toprise run`.

use crate::archive::input::{self, is_recording};
use crate::archive::publish::Existing;
use crate::archive::writer::Form;
use crate::cli::arguments::{Override, parse_override};
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
    /// A preset (see `toprise presets`), a scenario file, or a recording, whose scenario is run again.
    #[arg(default_value = "paper")]
    pub(super) scenario: PathBuf,

    /// Run this row of a sweep's table, which is named in place of the scenario.
    #[cfg(feature = "sweep")]
    #[arg(long, value_name = "N")]
    row: Option<u64>,

    /// Set a key of the scenario, as in friction.k=0.02; an empty value removes the key.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    pub(super) overrides: Vec<Override>,

    /// The MCAP file to write; without this option, the next free name in ./recordings, and an .rrd
    /// file next to it.
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,

    /// Write a Rerun recording into this file.
    #[cfg(feature = "rerun")]
    #[arg(long, value_name = "FILE")]
    pub(super) rrd: Option<PathBuf>,

    /// Write no Rerun recording.
    #[cfg(feature = "rerun")]
    #[arg(long, conflicts_with = "rrd")]
    pub(super) no_rrd: bool,

    #[cfg(feature = "rerun")]
    #[command(flatten)]
    pub(super) viewer: ViewerArguments,

    /// Encoding of the MCAP file's messages; without this option that of a recording that is run again, or json.
    #[arg(long, value_enum)]
    encoding: Option<Encoding>,

    /// Leave out the channels that let viewers show the MCAP file by themselves.
    #[arg(long)]
    no_views: bool,

    /// Log only these topics, separated by commas.
    #[arg(long, value_name = "TOPICS", value_delimiter = ',')]
    topics: Vec<String>,

    /// Run no faster than real time, or than SPEED times real time.
    #[arg(long, value_name = "SPEED", num_args = 0..=1, default_missing_value = "1",
          value_parser = parse_speed)]
    pub(super) realtime: Option<f64>,

    /// Replace files that exist.
    #[arg(long)]
    pub(super) force: bool,
}

impl RunArguments {
    /// The keys and values that are run, before any is set.
    pub(super) fn values(&self) -> Result<Values, Error> {
        #[cfg(feature = "sweep")]
        if let Some(row) = self.row {
            return Ok(values_of_row(&self.scenario, row)?);
        }
        if self
            .scenario
            .extension()
            .is_some_and(|kind| kind == "parquet")
        {
            let table = self.scenario.display();
            bail!("{table} is a table: name the row to run, as in --row 42");
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
                "-o names the MCAP file, and {} is the name of a Rerun recording: write one with --rrd {0}",
                path.display()
            ),
            None => Ok(()),
        }
    }

    /// Note on a Rerun recording that is not written, though --no-rrd is not set.
    #[cfg_attr(not(feature = "rerun"), allow(clippy::unused_self))]
    pub(super) fn note_on_rrd(&self) -> Option<&'static str> {
        #[cfg(feature = "rerun")]
        let is_left_out = self.output.is_some() && self.rrd.is_none() && !self.no_rrd;
        #[cfg(not(feature = "rerun"))]
        let is_left_out = false;
        is_left_out.then_some("no Rerun recording, because of -o: --rrd FILE writes one too")
    }

    /// Name of the files: that of the recording that is run again or of the scenario, with its changes, as in
    /// `paper_k0.02`. Where these are too long, the beginning of the scenario's digest stands for them: the name alone is that
    /// of another run.
    pub(super) fn stem(&self, scenario: &Scenario, base: &Values) -> String {
        /// The length of names that can still be read in a list.
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
        if stem == name {
            return stem;
        }
        if stem.len() > LONGEST {
            return format!("{name}_{:.8}", scenario.digest());
        }
        stem
    }

    /// The Rerun recording next to a recording that is there already; none if the arguments name another.
    #[cfg(feature = "rerun")]
    pub(super) fn adjacent_rrd(&self, mcap: Option<&WrittenFile>) -> Option<WrittenFile> {
        let mcap = mcap.filter(|_| self.rrd.is_none())?;
        let path = Path::new(&mcap.path).with_extension("rrd");
        let bytes = path.metadata().ok()?.len();
        Some(WrittenFile::new(&path, bytes))
    }

    /// Treatment of existing files.
    pub(super) fn existing(&self) -> Existing {
        Existing::forced(self.force)
    }

    /// The form of the MCAP file and the topics in it: those of a recording that is run again, unless the arguments name
    /// others.
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
    text.parse()
        .ok()
        .filter(|speed: &f64| speed.is_finite() && *speed > 0.0)
        .ok_or_else(|| "must be a number > 0, as in 0.5".to_owned())
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
