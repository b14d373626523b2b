//! The events of a run, as a log of sentences.

use crate::run::time::seconds;
use rerun::{Color, TextLog};

use crate::physics::top::Top;
use crate::rerun::entity;
use crate::rerun::output::track::Track;
use crate::rerun::output::{ComponentColumns, Output};
use crate::rerun::role::Role;
use crate::run::simulation::EventKind;
use crate::telemetry::fields::{EVENTS, events};
use crate::telemetry::{Message, event_sentence};

/// The logs of a run's events: one with repetitions merged, one with every event, and one with the nutation extremes.
pub(super) struct Events {
    summary: Track<String>,
    each: Track<String>,
    nutation: Track<String>,
    kinds: Vec<Repeated>,
    top: Top,
    role: Role,
}

/// Repetitions of a kind of event.
struct Repeated {
    kind: EventKind,
    /// Number of repetitions, and the times of the first and the last.
    more: u32,
    again_ns: u64,
    last_ns: u64,
}

impl Events {
    /// Opens empty logs. Where two runs are compared, each entry begins with the letter of its run, and its "level" is the
    /// name.
    pub(super) fn new(top: Top, role: &Role, output: &mut Output) -> Self {
        Self {
            summary: log(entity::EVENTS, role, output),
            each: log(entity::EACH_EVENT, role, output),
            nutation: log("events/nutation", role, output),
            kinds: Vec::new(),
            top,
            role: role.clone(),
        }
    }

    /// Adds the event of a message, if it is one.
    pub(super) fn write(&mut self, message: &Message<'_>, output: &mut Output) {
        if message.topic() != EVENTS {
            return;
        }
        let time_ns = message.time_ns;
        let time = events::TIME.of(message);
        let sentence = event_sentence(message, &self.top);
        let text = self.role.name(&format!("{time:.6} s: {sentence}"));
        let kind = EventKind::find(events::NAME.of(message));
        if kind.is_some_and(EventKind::is_nutation_extreme) {
            self.nutation.push(output, time_ns, [text]);
            return;
        }
        // Kinds of a later version can't be counted, so each of their events is shown.
        if kind.is_none_or(|kind| self.is_first(kind, time_ns)) {
            self.summary.push(output, time_ns, [text.clone()]);
        }
        self.each.push(output, time_ns, [text]);
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
        for repeated in self.kinds.drain(..).filter(|repeated| repeated.more > 0) {
            let Repeated { kind, more, .. } = repeated;
            if let Some(plural) = kind.plural(&self.top) {
                let span = [repeated.again_ns, repeated.last_ns];
                let [again, last] = span.map(seconds);
                let text = format!("{again:.6} s to {last:.6} s: {more} more {plural}");
                self.summary
                    .push(output, repeated.again_ns, [self.role.name(&text)]);
            }
        }
    }
}

/// An empty log; where two runs are compared, with the name and the colour of the run.
fn log(entity: &str, role: &Role, output: &mut Output) -> Track<String> {
    let entity = role.entity(entity);
    if let Role::Compared(_, run) = role {
        let mark = TextLog::update_fields()
            .with_level(run.as_str())
            .with_color(Color::from_u32(role.color(u32::MAX, 0)));
        output.send_static(entity.as_str(), &mark);
    }
    Track::new(entity, columns, output)
}

fn columns(rows: &[String]) -> ComponentColumns {
    let texts = rows.iter().map(String::as_str);
    let log = TextLog::update_fields().with_many_text(texts);
    Ok(log.columns_of_unit_batches()?.collect())
}
