//! The files of an archive: each follows from the recordings, the added files and what is said about them.

use super::parts::{ADDED, Archive, ArchiveFile, ArchivedRecording, Content, DATACITE, SUMS};
use super::{citation, metadata, readme};
use crate::analysis::diff::{Observer, Options, compare_observed};
use crate::analysis::explain::explain;
use crate::analysis::subject::Subject;
use crate::cli::commands::diff::content;
use crate::cli::commands::info::InfoReport;
use crate::cli::report;
use crate::figures::{FIGURES, Figure, RunData};
use crate::words::Section;
use anyhow::{Context as _, Error, bail};
use schemars::JsonSchema;
use serde::Serialize;
use std::collections::BTreeSet;

/// Width of figures, mm.
const FIGURE_WIDTH: f64 = 85.0;

impl Archive {
    /// All files, in the order of the archive.
    pub(super) fn files(&self) -> Result<Vec<ArchiveFile>, Error> {
        let mut files = Vec::new();
        for archived in &self.recordings {
            archived.add_files(&mut files)?;
        }
        for (place, a) in self.recordings.iter().enumerate() {
            for b in &self.recordings[place + 1..] {
                add_comparison(a, b, &mut files)?;
            }
        }
        for path in &self.added {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            let content = Content::File(path.clone());
            files.push(ArchiveFile::new(
                format!("{ADDED}/{name}"),
                "added",
                content,
            )?);
        }
        check_unique(&files)?;
        self.add_words(&mut files)?;
        let metadata = metadata::json(self, &files);
        let name = "ro-crate-metadata.json";
        files.push(ArchiveFile::text(
            name,
            "all files, for machines",
            metadata,
        )?);
        let mut sums = String::new();
        for file in &files {
            sums.push_str(&format!("{}  {}\n", file.sha256, file.name));
        }
        files.push(ArchiveFile::text(SUMS, "SHA-256 sums of all files", sums)?);
        Ok(files)
    }

    /// Adds what is said about the recordings, for people and for repositories.
    fn add_words(&self, files: &mut Vec<ArchiveFile>) -> Result<(), Error> {
        let datacite = pretty(&self.about.to_datacite())?;
        files.push(ArchiveFile::text(
            DATACITE,
            "who made it, for DataCite",
            datacite,
        )?);
        let cff = citation::cff(&self.about);
        files.push(ArchiveFile::text("CITATION.cff", "how to cite it", cff)?);
        let zenodo = pretty(&citation::zenodo(&self.about))?;
        files.push(ArchiveFile::text(
            ".zenodo.json",
            "who made it, for Zenodo",
            zenodo,
        )?);
        let readme = readme::text(self, files);
        files.push(ArchiveFile::text("README.md", "what this is", readme)?);
        Ok(())
    }
}

/// Two files of one name would have one place, on some systems also if only the case differs.
fn check_unique(files: &[ArchiveFile]) -> Result<(), Error> {
    let mut names = BTreeSet::new();
    for file in files {
        if !names.insert(file.name.to_lowercase()) {
            bail!(
                "two files of the archive would be called {}: rename a recording",
                file.name
            );
        }
    }
    Ok(())
}

/// JSON as it is written into files.
pub(super) fn pretty(value: &impl Serialize) -> Result<String, serde_json::Error> {
    Ok(serde_json::to_string_pretty(value)? + "\n")
}

impl ArchivedRecording {
    /// Adds the recording, its scenario, reports and figures.
    fn add_files(&self, files: &mut Vec<ArchiveFile>) -> Result<(), Error> {
        let Self { name, recording } = self;
        let content = Content::File(recording.path().to_owned());
        files.push(ArchiveFile::new(
            self.path(),
            "the recording of a run",
            content,
        )?);
        let scenario = recording.scenario_text().with_context(|| name.clone())?;
        let meaning = format!("the scenario of {name}");
        files.push(ArchiveFile::text(self.scenario_path(), meaning, scenario)?);
        let info = InfoReport::new(self.path(), recording);
        let meaning = format!("content of {name}");
        add_report(
            &format!("{name}.info"),
            &meaning,
            &info,
            &info.page(),
            files,
        )?;
        // As figures, for which a recording of few topics lacks data, too.
        if let Ok(explanation) = explain(Subject::Recording(recording)) {
            let name = format!("{name}.explain");
            let meaning = format!("why the top of {} moves as it does", self.name);
            let sections = explanation.sections(true);
            add_report(&name, &meaning, &explanation, &sections, files)?;
        }
        self.add_figures(files)
    }

    fn add_figures(&self, files: &mut Vec<ArchiveFile>) -> Result<(), Error> {
        let figures = FIGURES.iter().filter(|figure| figure.min_runs == 1);
        let figures: Vec<&Figure> = figures.collect();
        let subject = Subject::Recording(&self.recording);
        let run = RunData::read(subject, &self.name, &figures, &|_| {});
        for figure in figures {
            if figure.exclusion(&run).is_none() && figure.missing(&run).is_none() {
                let svg = figure.draw(&[&run], FIGURE_WIDTH).svg();
                let path = format!("figures/{}/{}.svg", self.name, figure.name);
                files.push(ArchiveFile::text(path, figure.title, svg)?);
            }
        }
        Ok(())
    }
}

/// Adds a report as JSON and as Markdown.
fn add_report(
    name: &str,
    meaning: &str,
    report: &(impl Serialize + JsonSchema),
    sections: &[Section],
    files: &mut Vec<ArchiveFile>,
) -> Result<(), Error> {
    let [json, markdown] = report::documents(report, sections)?;
    for (extension, text) in [("md", markdown), ("json", json)] {
        let path = format!("reports/{name}.{extension}");
        files.push(ArchiveFile::text(path, meaning, text)?);
    }
    Ok(())
}

/// Adds the comparison of two recordings.
fn add_comparison(
    a: &ArchivedRecording,
    b: &ArchivedRecording,
    files: &mut Vec<ArchiveFile>,
) -> Result<(), Error> {
    /// Nobody watches.
    struct Silent;
    impl Observer for Silent {}
    let [one, other] = [a, b].map(|archived| Subject::Recording(&archived.recording));
    let options = Options {
        integration_error: true,
        ..Options::default()
    };
    let mut report = compare_observed(one, other, &options, &mut Silent)?;
    for (run, archived) in [(&mut report.a, a), (&mut report.b, b)] {
        run.name.clone_from(&archived.name);
        run.file = Some(archived.path());
    }
    let meaning = format!("{} compared with {}", a.name, b.name);
    let sections = content::page(&report, true, false);
    let name = format!("{}-{}.diff", a.name, b.name);
    add_report(&name, &meaning, &report, &sections, files)
}
