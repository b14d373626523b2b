//! What takes energy from a motion.

use crate::physics::friction::Friction;
use crate::words::{Sentence, and, sentence};
use schemars::JsonSchema;
use serde::Serialize;

/// The torques that take energy from a motion.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, JsonSchema)]
pub struct Losses {
    /// Whether there is friction at the contact point.
    pub has_friction: bool,
    /// Whether there is air drag.
    pub has_air_drag: bool,
}

impl Losses {
    /// The losses of a model.
    pub fn new(friction: &Friction) -> Self {
        Self {
            has_friction: friction.acts_at_contact(),
            has_air_drag: friction.has_air_drag(),
        }
    }

    /// Their names, and impacts if there are any; friction if nothing acts.
    pub(crate) fn list(self, has_impacts: bool) -> Sentence {
        acting([self.has_friction, self.has_air_drag, has_impacts])
    }

    /// The same of a common effect. What several do is known of all together only: each of them may do the opposite.
    pub(crate) fn names(self, has_impacts: bool) -> Sentence {
        let names = self.list(has_impacts);
        match [self.has_friction, self.has_air_drag, has_impacts] {
            [true, true, _] | [true, _, true] | [_, true, true] => {
                sentence!("{} together", names)
            }
            _ => names,
        }
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
        for (has_friction, has_air_drag, has_impacts, expected) in [
            (false, false, true, "impacts"),
            (false, true, true, "air drag and impacts together"),
            (true, true, false, "friction and air drag together"),
        ] {
            let losses = Losses {
                has_friction,
                has_air_drag,
            };
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
