//! Events of messages in words.

use super::fields::events;
use super::message::Message;
use crate::physics::top::Top;
use crate::run::simulation::{EventKind, EventState};

/// A sentence about the event of a message on `/events`; its name if this version doesn't know the kind.
pub fn event_sentence(message: &Message<'_>, top: &Top) -> String {
    let name = events::NAME.of(message);
    // Recordings have had no sentences since version 6 of the telemetry: a later version may word them better.
    EventKind::find(name).map_or_else(
        || name.to_owned(),
        |kind| kind.sentence(top, event_state(message)).to_string(),
    )
}

/// The sentence in the views that recordings contain.
pub(super) fn recorded_sentence(message: &Message<'_>, top: &Top) -> String {
    let name = events::NAME.of(message);
    EventKind::find(name).map_or_else(
        || name.to_owned(),
        |kind| kind.recorded_sentence(top, event_state(message)),
    )
}

/// The recorded state at the event of a message on `/events`.
pub(crate) fn event_state(message: &Message<'_>) -> EventState {
    EventState {
        theta: events::THETA.of(message),
        phi_dot: events::PHI_DOT.of(message),
        psi_dot: events::PSI_DOT.of(message),
    }
}
