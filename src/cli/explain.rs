//! `toprise explain`.

use super::arguments::{FormArguments, Override, parse_override};
use super::done::Done;
use super::given::open;
use super::page::{Page, Part, Section};
use super::report;
use super::table::Table;
use crate::analysis::explain::{Chapter, Story, explain as tell};
use anyhow::{Context as _, Error};
use clap::Args;
use std::path::PathBuf;

/// Arguments of `toprise explain`.
#[derive(Args, Debug, Default, PartialEq)]
pub(super) struct ExplainArguments {
    /// A recording, a preset or a scenario file.
    #[arg(value_name = "RUN")]
    run: PathBuf,

    /// Set a key of a scenario that is simulated now, as in friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<Override>,

    #[command(flatten)]
    form: FormArguments,
}

/// Tells the story of a run.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Done, Error> {
    let given = open(&arguments.run, &[], &arguments.overrides)?;
    let context = || arguments.run.display().to_string();
    let story = tell(given.subject()).with_context(context)?;
    report::print(&story, arguments.form.format(), || page(&story))?;
    Ok(if story.losses.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

fn page(story: &Story) -> Page {
    let mut sections: Vec<Section> = story.chapters.iter().map(section).collect();
    if !story.losses.is_empty() {
        let mut remarks = Section::new("Remarks");
        for loss in &story.losses {
            remarks.line(format!("left out: {loss}"));
        }
        sections.push(remarks);
    }
    Page {
        title: story.title.clone(),
        sections,
        ..Page::default()
    }
}

fn section(chapter: &Chapter) -> Section {
    let mut section = Section::new(chapter.heading);
    if chapter.is_list {
        section
            .parts
            .extend(chapter.sentences.iter().cloned().map(Part::Line));
    } else {
        section.line(chapter.sentences.join(" "));
    }
    if let Some((header, rows)) = &chapter.table {
        section.table(Table {
            header: header.clone(),
            rows: rows.clone(),
            left: 1,
        });
    }
    section
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cli::arguments::parse;

    #[test]
    fn one_run_is_named() {
        assert_eq!(
            parse::<ExplainArguments>("paper --set friction.k=0.02").unwrap(),
            ExplainArguments {
                run: "paper".into(),
                overrides: vec![("friction.k".to_owned(), "0.02".to_owned())],
                ..ExplainArguments::default()
            }
        );
        assert!(parse::<ExplainArguments>("").is_err());
    }
}
