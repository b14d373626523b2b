//! `toprise explain`.

use super::given::open;
use super::page::{Page, Part, Section, Table, Tone};
use super::run::parse_override;
use super::{Done, output};
use crate::analysis::explain::{Chapter, Story, explain as tell};
use anyhow::{Context as _, Error};
use clap::Args;

/// Arguments of `toprise explain`.
#[derive(Args, Debug, PartialEq)]
pub(super) struct ExplainArguments {
    /// A recording, a preset or a scenario file.
    #[arg(value_name = "RUN")]
    run: String,

    /// Set a key of a scenario that is simulated now, as in friction.k=0.02.
    #[arg(long = "set", value_name = "KEY=VALUE", value_parser = parse_override)]
    overrides: Vec<(String, String)>,

    /// Write Markdown.
    #[arg(long)]
    markdown: bool,
}

/// Tells the story of a run.
pub(super) fn explain(arguments: &ExplainArguments) -> Result<Done, Error> {
    let given = open(&arguments.run, &[], &arguments.overrides)?;
    let story = tell(given.subject()).with_context(|| arguments.run.clone())?;
    let page = page(&story);
    if arguments.markdown {
        output::print(&page.markdown())?;
    } else {
        output::print_styled(&page.text())?;
    }
    Ok(if story.losses.is_empty() {
        Done::Well
    } else {
        Done::WithLosses
    })
}

fn page(story: &Story) -> Page {
    let mut sections: Vec<Section> = story.chapters.iter().map(section).collect();
    if !story.losses.is_empty() {
        let mut remarks = Section::new("Remarks", String::new());
        for loss in &story.losses {
            remarks.line(format!("lost {loss}"));
        }
        sections.push(remarks);
    }
    Page {
        title: story.title.clone(),
        tone: Tone::Same,
        sections,
        ..Page::default()
    }
}

fn section(chapter: &Chapter) -> Section {
    let mut section = Section::new(chapter.heading, String::new());
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
