//! The arguments of `toprise run`.

use super::file_plan::FilePlan;
use crate::archive::input::Input;
use crate::archive::publish::Existing;
use crate::archive::recording::Recording;
use crate::archive::supplements::about::About;
use crate::archive::writer::Form;
use crate::cli::arguments::{OUTPUT, Override, VIEWER, parse_override, parse_positive};
use crate::cli::extension::{
    FeatureArguments as _, RowArgument, ShowRun, ShowRunArguments, SweepRow,
};
use crate::cli::file_kind::FileKind;
use crate::cli::input::{checked, read_about, run_name};
use crate::physics::dynamics::Support;
use crate::run::scenario::{Scenario, Values};
use crate::telemetry::encoding::Encoding;
use crate::telemetry::{Topic, Topics};
use anyhow::{Error, bail};
use clap::Args;
use clap::builder::NonEmptyStringValueParser;
use std::path::PathBuf;

/// Arguments of `toprise run`.
#[derive(Args, Clone, Debug, PartialEq)]
pub(crate) struct RunArguments {
    /// Preset, scenario file, or recording to repeat
    #[arg(default_value = "paper")]
    scenario: PathBuf,

    #[command(flatten)]
    row: RowArgument,

    /// Set a key, e.g. friction.k=0.02; an empty value removes it
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    /// MCAP file to write, or - for standard output [default: next free name in recordings/, with an .rrd file]
    #[arg(short, long, value_name = "FILE", help_heading = OUTPUT)]
    output: Option<PathBuf>,

    #[command(flatten)]
    show: ShowRunArguments,

    /// Message encoding [default: json, or that of the repeated recording]
    #[arg(long, value_enum, help_heading = OUTPUT)]
    encoding: Option<Encoding>,

    /// Omit the ROS 2 channels for viewers (/tf, /view/…, /log)
    #[arg(long, help_heading = OUTPUT)]
    no_views: bool,

    /// Record only these topics (comma-separated)
    #[arg(long, value_name = "TOPICS", value_delimiter = ',', value_parser = NonEmptyStringValueParser::new(), help_heading = OUTPUT)]
    topics: Vec<String>,

    /// TOML file with title, creators, licence, date and more, which the recording then holds
    #[arg(long, value_name = "FILE", help_heading = OUTPUT)]
    about: Option<PathBuf>,

    /// Limit the speed to real time, or to SPEED × real time
    #[arg(long, value_name = "SPEED", num_args = 0..=1, default_missing_value = "1",
          value_parser = parse_positive, help_heading = VIEWER)]
    realtime: Option<f64>,

    /// Overwrite existing files
    #[arg(long, help_heading = OUTPUT)]
    force: bool,
}

/// A run and what becomes of it.
#[derive(Debug)]
pub(super) struct RunPlan {
    /// The scenario that is run.
    pub(super) scenario: Scenario,
    /// The keys and values before the changes of `--set`.
    pub(super) base: Values,
    /// The form of the MCAP file.
    pub(super) form: Form,
    /// The topics that are recorded.
    pub(super) topics: Topics,
    /// The recording that is repeated, unless it is changed: what it says of its run is not about another.
    pub(super) repeated: Option<Box<Recording>>,
    /// What the recording says of itself.
    pub(super) about: Option<About>,
    /// Simulated time per real time; `None` for as fast as possible.
    pub(super) speed: Option<f64>,
    /// The files that are read and written.
    pub(super) files: FilePlan,
    /// Where it is shown.
    pub(super) show: Option<Box<dyn ShowRun>>,
}

impl RunArguments {
    /// Resolves the arguments. The input is opened and read here, once.
    pub(super) fn plan(&self) -> Result<RunPlan, Error> {
        // A wrong name is reported before anything is read.
        if let Some(path) = &self.output {
            FileKind::Mcap.check("-o", path)?;
        }
        let about = self.about.as_deref().map(read_about).transpose()?;
        let input = Input::open(&self.scenario)?;
        let row: Option<SweepRow> = self.row.plan(&input)?;
        let base = match &row {
            Some(row) => row.values.clone(),
            None => input.values()?,
        };
        let scenario = checked(&input, base.clone(), &self.overrides)?;
        let (mut form, mut topics) = input.form().unwrap_or_default();
        form.encoding = self.encoding.unwrap_or(form.encoding);
        // A recording without views is repeated without them.
        form.views &= !self.no_views;
        if !self.topics.is_empty() {
            topics = Topics::named(&self.topics)?;
            check_topics(&topics, scenario.model.support)?;
        }
        let mut name = run_name(&input, &scenario, &self.overrides);
        if let Some(row) = row {
            name.push_str(&format!("_row{}", row.number));
        }
        let repeated = match input {
            Input::Recording(recording) if self.overrides.is_empty() => Some(recording),
            _ => None,
        };
        Ok(RunPlan {
            repeated,
            about,
            files: FilePlan {
                input: self.scenario.clone(),
                mcap: self.output.clone(),
                stem: scenario.file_stem(&name, &base),
                existing: Existing::forced(self.force),
            },
            show: self.show.plan((self.output.as_deref(), self.realtime))?,
            speed: self.realtime,
            scenario,
            base,
            form,
            topics,
        })
    }
}

/// Refuses a topic that runs with this support don't have: the recording would lack it without a word.
fn check_topics(topics: &Topics, support: Support) -> Result<(), Error> {
    let Topics::Only(topics) = topics else {
        return Ok(());
    };
    for topic in topics {
        if !Topic::all_with(support).any(|existing| existing == *topic) {
            bail!("a run with a fixed peg has no topic {topic}: leave it out of --topics");
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn parses_arguments() {
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
