//! What shells and packages take: completion scripts, which know presets, keys, topics, figures and laws, and man pages.

use crate::run::scenario::{KEYS, LAWS, PRESETS};
use crate::telemetry::Topic;
use clap::builder::PossibleValuesParser;
use clap::{Arg, Command, ValueEnum, ValueHint};
use clap_complete::{Shell, generate};
use clap_complete_nushell::Nushell;
use clap_mangen::Man;
use std::io;

/// What is printed for a shell, or for `man`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(in crate::cli) enum ScriptKind {
    /// Bash
    Bash,
    /// Elvish
    Elvish,
    /// Fish
    Fish,
    /// Nushell
    Nushell,
    /// PowerShell
    #[value(name = "powershell")]
    PowerShell,
    /// Zsh
    Zsh,
    /// Not a shell: the man page, in roff
    Man,
}

/// The completion script of a command line, or its man page.
///
/// # Errors
/// Never: it is written into memory.
pub(super) fn script(kind: ScriptKind, command: Command) -> io::Result<String> {
    let mut suggesting = command
        .clone()
        .mut_subcommands(|command| command.mut_args(with_values));
    let mut script = Vec::new();
    let mut complete = |shell| generate(shell, &mut suggesting, "toprise", &mut script);
    match kind {
        ScriptKind::Bash => complete(Shell::Bash),
        ScriptKind::Elvish => complete(Shell::Elvish),
        ScriptKind::Fish => complete(Shell::Fish),
        ScriptKind::PowerShell => complete(Shell::PowerShell),
        ScriptKind::Zsh => complete(Shell::Zsh),
        ScriptKind::Nushell => generate(Nushell, &mut suggesting, "toprise", &mut script),
        ScriptKind::Man => write_man_page(command, &mut script)?,
    }
    Ok(String::from_utf8_lossy(&script).into_owned())
}

/// One page: the program, then each command with its options.
fn write_man_page(mut command: Command, page: &mut Vec<u8>) -> io::Result<()> {
    command.build();
    let man = Man::new(command.clone());
    man.render_title(page)?;
    man.render_name_section(page)?;
    man.render_synopsis_section(page)?;
    man.render_description_section(page)?;
    man.render_options_section(page)?;
    for subcommand in command.get_subcommands().filter(|c| c.get_name() != "help") {
        let man = Man::new(subcommand.clone());
        page.extend(format!(".SH \"TOPRISE {}\"\n", subcommand.get_name().to_uppercase()).bytes());
        man.render_synopsis_section(page)?;
        man.render_description_section(page)?;
        man.render_options_section(page)?;
    }
    man.render_extra_section(page)
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
