//! An explanation as a report for people.

use super::{Chapter, EventSummary, Explanation, Fact, Stage};
use crate::run::simulation::EventKind;
use crate::words::number::significant;
use crate::words::{Part, Piece, Section, Sentence, Table, grouped, sentence};

impl Explanation {
    /// The explanation for people: the causes, the chapters, the events and, with `all`, the averaged motion.
    pub fn sections(&self, all: bool) -> Vec<Section> {
        // The causes come first, in words; the numbers follow.
        let mut story = Section::default();
        story
            .parts
            .extend(self.story.paragraph().map(Part::Paragraph));
        let mut sections = vec![story];
        sections.extend(self.chapters.iter().map(Chapter::section));
        sections.push(events(self));
        if all {
            sections.push(stages(&self.stages));
        }
        sections.push(Section::from_lines("Incomplete input", &self.losses));
        sections.retain(|section| !section.parts.is_empty());
        // After that: a title has no parts.
        sections.insert(0, Section::new(&self.title));
        sections
    }
}

impl Chapter {
    /// The facts under their heading.
    pub fn section(&self) -> Section {
        Section::from_lines(self.heading, self.facts.iter().map(Fact::sentence))
    }
}

/// One line for each kind of event.
fn events(explanation: &Explanation) -> Section {
    let rows = explanation.events.iter().map(event_row);
    Section::from(Table::from_texts(rows)).titled("Events", "")
}

/// First time, name and further occurrences of an event.
fn event_row(event: &EventSummary) -> Vec<Sentence> {
    // Recordings of later versions may have other kinds.
    let words = EventKind::find(&event.name)
        .map_or_else(|| event.name.clone(), |kind| kind.words(event.count));
    let again = match event.count {
        1 => Sentence::default(),
        count => sentence!(
            "{} times, last at {}",
            grouped(count),
            Piece::time(event.last)
        ),
    };
    vec![Piece::time(event.first).into(), words.into(), again]
}

/// A mean, or a dash if it was not recorded (NaN).
fn mean(value: f64, digits: usize) -> String {
    if value.is_nan() {
        "–".to_owned()
    } else {
        significant(value, digits)
    }
}

/// Table of the averaged motion.
fn stages(stages: &[Stage]) -> Section {
    let table = Table::new(
        stages,
        1,
        &[
            ("time [s]", |stage| {
                format!("{:.2} to {:.2}", stage.from, stage.to)
            }),
            ("nutations", |stage| stage.nutations.to_string()),
            ("θ [rad]", |stage| mean(stage.theta, 4)),
            ("θ̇ [rad/s]", |stage| mean(stage.theta_dot, 3)),
            ("φ̇ [rad/s]", |stage| mean(stage.phi_dot, 5)),
            ("slow root", |stage| match stage.slow_root {
                Some(root) => significant(root, 5),
                None => "–".to_owned(),
            }),
            ("ψ̇ [rad/s]", |stage| mean(stage.psi_dot, 5)),
        ],
    );
    Section::from(table).titled("Nutations", "")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn prints_missing_means_as_dashes() {
        assert_eq!(mean(f64::NAN, 3), "–");
        assert_eq!(mean(0.5, 3), significant(0.5, 3));
    }
}
