//! Words of several reports.

/// The zero of the potential energy in recordings, wherever an energy and not its change is shown.
pub(crate) const ENERGY_ZERO: &str = "zero at the height of the peg's centre";

/// The causes of a loss of energy: friction at the point of contact, air drag and impacts, where they act; friction if
/// none does.
pub(crate) fn works([has_friction, has_air_drag, has_impacts]: [bool; 3]) -> &'static str {
    match (has_friction, has_air_drag, has_impacts) {
        (_, false, false) => "friction",
        (true, true, true) => "friction, air drag and impacts",
        (true, true, false) => "friction and air drag",
        (true, false, true) => "friction and impacts",
        (false, true, true) => "air drag and impacts",
        (false, true, false) => "air drag",
        (false, false, true) => "impacts",
    }
}
