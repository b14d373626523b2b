//! A report in words, for all who show it.

mod cells;
mod correlations;
mod laws;
mod minima;
mod parameters;
mod profile;
mod remarks;
mod signals;

use super::note::Note;
use super::report::{Quality, Report, Verdict};
use crate::fit::problem::model::Loss;
use crate::fit::search::modes::MAX_TRIALS;
use crate::fit::search::monitor::Progress;
use crate::measured::FileReading;
use crate::words::number::rounded;
use crate::words::{Piece, Section, Sentence, Tone, sentence};
use cells::{labelled_probability, time};
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// A report in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Words {
    /// The verdict, without the scenario.
    pub verdict: Sentence,
    /// The first parameter; empty without parameters, or without a minimum.
    pub headline: Sentence,
    /// The whole report. The first section is on the verdict and on what was fitted.
    pub sections: Vec<Section>,
}

impl Report {
    /// The report in words. `all` shows also estimates that would mislead.
    pub fn words(&self, all: bool) -> Words {
        let mut sections = vec![
            summary(self),
            parameters::section(self, all),
            signals::section(&self.signals),
            data(&self.files),
            Section::from_lines("Remarks", remarks::remarks(self)),
            minima::section(self, all),
        ];
        for profile in &self.profiles {
            sections.push(profile::section(profile, !self.modes.is_empty(), all));
        }
        if let Some(comparison) = &self.comparison {
            sections.push(laws::section(self, comparison));
            if all {
                sections.extend(comparison.laws.iter().map(laws::parameters));
            }
        }
        sections.retain(|section| !section.parts.is_empty());
        Words {
            verdict: verdict(self),
            headline: minima::headline(self),
            sections,
        }
    }
}

/// Progress in a line.
impl Display for Progress {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "fitting {:.2} of {:.2} s of data",
            self.window, self.until
        )?;
        if self.spins > 0 {
            write!(
                f,
                ", with {} of up to {} other spins",
                self.spins,
                2 * MAX_TRIALS
            )?;
        }
        write!(
            f,
            ": χ² = {}, {} simulations",
            rounded(self.chi2, 4),
            self.evaluations
        )
    }
}

/// The verdict and what was fitted.
fn summary(report: &Report) -> Section {
    let tone = match report.verdict {
        Verdict::Fitted => Tone::Good,
        Verdict::Undecided => Tone::Weak,
        Verdict::BadFit | Verdict::NotConverged => Tone::Bad,
    };
    let mut section = Section::with_tone(tone, title(report));
    section.note = note(report);
    if is_about_laws(report) {
        section.line(sentence!(
            "Parameters, signals and remarks are those of {}.",
            &report.law
        ));
    }
    let samples: usize = report.signals.iter().map(|signal| signal.samples).sum();
    section.line(sentence!(
        "{} in {}; the scenario starts at t = {} in the data. {}.",
        Piece::count(samples as u64, "sample"),
        time(report.until),
        time(report.origin),
        Piece::count(report.evaluations, "simulation")
    ));
    section
}

/// What was read of each file.
fn data(files: &[FileReading]) -> Section {
    let named = files.iter().filter(|file| !file.file.is_empty());
    Section::from_lines("Data", named.map(FileReading::sentence))
}

fn title(report: &Report) -> Sentence {
    let Report { scenario, law, .. } = report;
    if is_about_laws(report) {
        sentence!("{}: {}", scenario, verdict(report))
    } else {
        sentence!("{} ({}): {}", scenario, law, verdict(report))
    }
}

fn verdict(report: &Report) -> Sentence {
    let is_comparison = report.comparison.is_some();
    match report.verdict {
        Verdict::Fitted => sentence!("describes the data{}", minima::in_title(report)),
        Verdict::Undecided => sentence!("undecided between laws"),
        Verdict::BadFit if is_comparison => sentence!("none of the laws describes the data"),
        Verdict::BadFit => sentence!("does not describe the data"),
        Verdict::NotConverged if is_comparison => {
            sentence!("no minimum was found for the best law")
        }
        Verdict::NotConverged if report.notes.iter().any(Note::is_on_spins) => {
            sentence!("no minimum near the data among the spins tried")
        }
        Verdict::NotConverged => sentence!("no minimum was found"),
    }
}

/// Whether the title is a verdict on several laws, which has no χ² of its own.
fn is_about_laws(report: &Report) -> bool {
    report.comparison.is_some() && report.verdict != Verdict::Fitted
}

/// Goodness of the fit, next to the title.
fn note(report: &Report) -> Sentence {
    let is_sigma_estimated = report
        .signals
        .iter()
        .any(|signal| signal.is_sigma_estimated);
    match report.loss {
        _ if is_about_laws(report) => Sentence::default(),
        // χ²/ν is then about 1, whatever the fit.
        Loss::Squares if is_sigma_estimated => {
            sentence!("χ² can't be tested, because σ is estimated")
        }
        Loss::Squares => goodness(&report.quality),
        // The loss has no known distribution.
        Loss::Huber => sentence!("χ² can't be tested, because outliers count less"),
    }
}

/// χ² and its probability in a line.
fn goodness(quality: &Quality) -> Sentence {
    let p = quality.p_value.map_or_else(Sentence::default, |p| {
        sentence!(", {}", labelled_probability(p))
    });
    sentence!(
        "χ²/ν = {} ({}/{}){}",
        Piece::fixed(quality.chi2 / quality.freedom as f64, 3, ""),
        Piece::fixed(quality.chi2, 1, ""),
        quality.freedom.to_string(),
        p
    )
}
