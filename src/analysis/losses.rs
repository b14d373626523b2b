//! What takes energy from a motion.

use crate::physics::friction::Friction;
use crate::words::{Sentence, and, sentence};
use schemars::JsonSchema;
use serde::Serialize;

/// The torques that take energy from a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
#[serde(into = "LossFlags")]
#[schemars(with = "LossFlags")]
pub enum Losses {
    /// None acts.
    Absent,
    /// Friction at the contact point.
    Friction,
    /// Air drag.
    AirDrag,
    /// Friction at the contact point and air drag.
    Both,
}

/// The losses in reports.
#[derive(Serialize, JsonSchema)]
struct LossFlags {
    /// Whether there is friction at the contact point.
    has_friction: bool,
    /// Whether there is air drag.
    has_air_drag: bool,
}

impl From<Losses> for LossFlags {
    fn from(losses: Losses) -> Self {
        Self {
            has_friction: matches!(losses, Losses::Friction | Losses::Both),
            has_air_drag: matches!(losses, Losses::AirDrag | Losses::Both),
        }
    }
}

impl Losses {
    /// The losses of a model.
    pub fn new(friction: &Friction) -> Self {
        Self::acting(friction.acts_at_contact(), friction.has_air_drag())
    }

    /// Those of friction at the contact point and air drag that act.
    pub(crate) fn acting(has_friction: bool, has_air_drag: bool) -> Self {
        match (has_friction, has_air_drag) {
            (false, false) => Self::Absent,
            (true, false) => Self::Friction,
            (false, true) => Self::AirDrag,
            (true, true) => Self::Both,
        }
    }

    /// Their names, and impacts if there are any; friction if nothing acts.
    pub(crate) fn list(self, has_impacts: bool) -> Sentence {
        acting(self.with_impacts(has_impacts))
    }

    /// The same of a common effect. What several do is known of all together only: each of them may do the opposite.
    pub(crate) fn names(self, has_impacts: bool) -> Sentence {
        let names = self.list(has_impacts);
        match self.with_impacts(has_impacts) {
            [true, true, _] | [true, _, true] | [_, true, true] => {
                sentence!("{} together", names)
            }
            _ => names,
        }
    }

    fn with_impacts(self, has_impacts: bool) -> [bool; 3] {
        let LossFlags {
            has_friction,
            has_air_drag,
        } = self.into();
        [has_friction, has_air_drag, has_impacts]
    }
}

/// The names of the losses of energy that act: friction at the point of contact, air drag and impacts; friction if none does.
fn acting(acts: [bool; 3]) -> Sentence {
    let names = ["friction", "air drag", "impacts"];
    let mut acting: Vec<Sentence> = Vec::new();
    for (name, acts) in names.into_iter().zip(acts) {
        if acts {
            acting.push(name.into());
        }
    }
    if acting.is_empty() {
        acting.push(names[0].into());
    }
    and(acting)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_only_what_acts() {
        for (losses, has_impacts, expected) in [
            (Losses::Absent, true, "impacts"),
            (Losses::AirDrag, true, "air drag and impacts together"),
            (Losses::Both, false, "friction and air drag together"),
        ] {
            assert_eq!(losses.names(has_impacts).to_string(), expected);
        }
    }

    #[test]
    fn lists_what_acts() {
        for (acts, expected) in [
            ([false; 3], "friction"),
            ([true, false, true], "friction and impacts"),
            ([true; 3], "friction, air drag and impacts"),
        ] {
            assert_eq!(acting(acts).to_string(), expected);
        }
    }
}
