//! The arguments of `toprise run`.

use crate::archive::publish::Existing;
use crate::archive::writer::Form;
use crate::cli::arguments::{FormArguments, Override, parse_override};
#[cfg(feature = "rerun")]
use crate::cli::viewer::ViewerArguments;
use crate::telemetry::encoding::Encoding;
use crate::telemetry::{Telemetry, Topics};
use anyhow::Error;
use clap::Args;
use std::path::PathBuf;

/// Arguments of `toprise run`.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct RunArguments {
    /// A preset (see `toprise presets`), a scenario file, or a recording, whose scenario is run again.
    #[arg(default_value = "paper")]
    pub(super) scenario: PathBuf,

    /// Set a key of the scenario, as in friction.k=0.02; an empty value removes the key.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    pub(super) overrides: Vec<Override>,

    /// The MCAP file to write; without this option, the next free name in ./recordings, and an .rrd
    /// file beside it.
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

    /// Encoding of the MCAP file's messages.
    #[arg(long, value_enum, default_value_t = Encoding::Json)]
    encoding: Encoding,

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

    #[command(flatten)]
    pub(super) form: FormArguments,
}

impl RunArguments {
    /// What may happen to files that exist.
    pub(super) fn existing(&self) -> Existing {
        Existing::forced(self.force)
    }

    /// The form of the MCAP file.
    pub(super) fn mcap_form(&self) -> Form {
        Form {
            encoding: self.encoding,
            views: !self.no_views,
        }
    }

    /// The telemetry with the topics that are wanted.
    pub(super) fn telemetry(&self) -> Result<Telemetry, Error> {
        Ok(if self.topics.is_empty() {
            Telemetry::default()
        } else {
            Telemetry::with_topics(&Topics::named(&self.topics)?)
        })
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
