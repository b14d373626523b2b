//! The events of a run, as a log of sentences.

use crate::run::time::seconds;
use rerun::{Color, StateChange, StateConfiguration, TextLog, TextLogLevel};

use crate::physics::top::Top;
use crate::rerun::entity::{self, REGIME};
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::palette::{GREEN, SKY, VERMILION};
use crate::rerun::role::Role;
use crate::run::simulation::{EventKind, Regime};
use crate::telemetry::fields::{CONTACT, EVENTS, contact, events};
use crate::telemetry::{Message, event_sentence};

/// The logs of a run's events: one with repetitions merged, and one with every event but the nutation extremes.
pub(super) struct Events {
    summary: Track<Entry>,
    each: Track<Entry>,
    kinds: Vec<Repeated>,
    top: Top,
    role: Role,
}

/// A line of a log, with its level.
type Entry = (String, &'static str);

/// Repetitions of a kind of event.
struct Repeated {
    kind: EventKind,
    /// Number of repetitions, and the times of the first and the last.
    more: u32,
    again_ns: u64,
    last_ns: u64,
}

impl Events {
    /// Opens empty logs. Where two runs are compared, each entry begins with the letter of its run.
    pub(super) fn new(top: Top, role: &Role, output: &mut Output) -> Self {
        Self {
            summary: log(entity::EVENTS, role, output),
            each: log(entity::EACH_EVENT, role, output),
            kinds: Vec::new(),
            top,
            role: role.clone(),
        }
    }

    /// Adds the event of a message, if it is one. Returns whether it is the first of its kind.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) -> bool {
        if message.topic() != EVENTS {
            return false;
        }
        let time_ns = message.time_ns;
        let kind = EventKind::find(events::NAME.of(message));
        // Every nutation has two of them.
        if kind.is_some_and(EventKind::is_nutation_extreme) {
            return false;
        }
        let text = self.text(&event_sentence(message, &self.top));
        let entry = (text, level(kind));
        // Kinds of a later version can't be counted, so each of their events is shown.
        let is_first = kind.is_none_or(|kind| self.is_first(kind, time_ns));
        if is_first {
            self.summary.push(output, time_ns, [entry.clone()]);
        }
        self.each.push(output, time_ns, [entry]);
        is_first
    }

    /// A sentence in lines that fit into the view in a small window.
    fn text(&self, sentence: &str) -> String {
        let width = if self.role.is_alone() { NARROW } else { WIDE };
        wrapped(&self.role.name(sentence), width)
    }

    /// Counts an event. Returns whether it is the first of its kind.
    fn is_first(&mut self, kind: EventKind, time_ns: u64) -> bool {
        let Some(known) = self.kinds.iter_mut().find(|known| known.kind == kind) else {
            self.kinds.push(Repeated {
                kind,
                more: 0,
                again_ns: time_ns,
                last_ns: time_ns,
            });
            return true;
        };
        if known.more == 0 {
            known.again_ns = time_ns;
        }
        known.last_ns = time_ns;
        known.more += 1;
        false
    }

    /// Adds a line for each kind that happened more than once.
    pub(super) fn summarize(&mut self, output: &mut Output) {
        for repeated in std::mem::take(&mut self.kinds) {
            let Repeated { kind, more, .. } = repeated;
            if more > 0
                && let Some(plural) = kind.plural(&self.top)
            {
                let last = seconds(repeated.last_ns);
                let text = self.text(&format!("{more} more {plural}, the last at {last:.4} s"));
                self.summary
                    .push(output, repeated.again_ns, [(text, level(Some(kind)))]);
            }
        }
    }
}

/// Letters that fit beside the time and the level in a window of 1366 points: below the scene of two runs, and of one.
const NARROW: usize = 48;
const WIDE: usize = 60;

/// A text in lines of at most `width` letters, but for longer words. Rerun 0.36 cuts the end of a line off; 0.41 shows the first one.
fn wrapped(text: &str, width: usize) -> String {
    let mut lines = String::new();
    let mut length = 0;
    for word in text.split(' ') {
        let letters = word.chars().count();
        if length > 0 {
            let is_full = length + 1 + letters > width;
            lines.push(if is_full { '\n' } else { ' ' });
            length = if is_full { 0 } else { length + 1 };
        }
        lines += word;
        length += letters;
    }
    lines
}

/// The level of an event: a warning for one that ends what the top was doing.
fn level(kind: Option<EventKind>) -> &'static str {
    match kind {
        Some(EventKind::Fallen | EventKind::Jam | EventKind::Singular) => TextLogLevel::WARN,
        _ => TextLogLevel::INFO,
    }
}

/// An empty log; where two runs are compared, in the colour of the run.
fn log(entity: &str, role: &Role, output: &mut Output) -> Track<Entry> {
    let entity = role.entity(entity);
    if !role.is_alone() {
        let mark = TextLog::update_fields().with_color(Color::from_u32(role.color(u32::MAX, 0)));
        output.send_static(entity.as_str(), &mark);
    }
    Track::new(entity, columns, output)
}

fn columns(rows: &[Entry]) -> ComponentColumns {
    let log = TextLog::update_fields()
        .with_many_text(rows.iter().map(|(text, _)| text.as_str()))
        .with_many_level(rows.iter().map(|(_, level)| *level));
    Ok(log.columns_of_unit_batches()?.collect())
}

/// What the peg does, as states.
pub(super) struct Regimes {
    track: Track<&'static str>,
    last: Option<Regime>,
}

impl Regimes {
    /// Sends the colours, which are those of the contact point's path.
    pub(super) fn new(output: &mut Output) -> Self {
        let regimes = [Regime::Slipping, Regime::Sticking, Regime::Flying];
        let style = StateConfiguration::new()
            .with_values(regimes.map(state))
            .with_colors([SKY, GREEN, VERMILION].map(Color::from_u32));
        output.send_static(REGIME, &style);
        Self {
            track: Track::new(REGIME, state_columns, output),
            last: None,
        }
    }

    /// Adds a state if the message changes it.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        if message.topic() != CONTACT {
            return;
        }
        let regime = Regime::from_code(contact::REGIME.of(message));
        if let Some(new) = regime
            && self.last.replace(new) != Some(new)
        {
            self.track.push(output, message.time_ns, [state(new)]);
        }
    }
}

fn state(regime: Regime) -> &'static str {
    match regime {
        Regime::Slipping => "slides",
        Regime::Sticking => "rolls or sticks",
        Regime::Flying => "flies",
    }
}

fn state_columns(rows: &[&'static str]) -> ComponentColumns {
    let changes = StateChange::update_fields().with_state(rows.iter().copied());
    Ok(changes.columns_of_unit_batches()?.collect())
}
