//! Completion scripts, which know presets, keys, topics, figures and laws.

use crate::run::scenario::{KEYS, LAWS, PRESETS};
use crate::telemetry::Topic;
use clap::builder::PossibleValuesParser;
use clap::{Arg, Command, ValueHint};
use clap_complete::{Shell, generate};

/// The completion script of a command line.
pub(super) fn script(shell: Shell, command: Command) -> String {
    let mut suggesting = command.mut_subcommands(|command| command.mut_args(with_values));
    let mut script = Vec::new();
    generate(shell, &mut suggesting, "toprise", &mut script);
    String::from_utf8_lossy(&script).into_owned()
}

/// An argument with the values that it can complete. They are suggestions: this command line parses nothing.
fn with_values(argument: Arg) -> Arg {
    // Ids are the names of the fields.
    match argument.get_id().as_str() {
        "laws" => {
            let laws = LAWS.iter().map(|law| law.name);
            argument.value_parser(PossibleValuesParser::new(laws))
        }
        "scenario" | "run" | "runs" | "bases" | "name" => {
            let presets = PRESETS.iter().map(|preset| preset.name.clone());
            argument.value_parser(PossibleValuesParser::new(presets))
        }
        "overrides" | "overrides_a" | "overrides_b" | "over" => {
            let keys = KEYS.iter().map(|key| format!("{}=", key.path));
            argument.value_parser(PossibleValuesParser::new(keys))
        }
        "topic" | "topics" => {
            let topics = Topic::all().map(Topic::name);
            argument.value_parser(PossibleValuesParser::new(topics))
        }
        "files" | "file" | "output" | "plot" | "rrd" | "table" => {
            argument.value_hint(ValueHint::FilePath)
        }
        _ => argument,
    }
}
