//! The colours of arrows, as 0xRRGGBBAA.
//!
//! They are Okabe and Ito's, which stay distinguishable with any kind of colour vision.

pub(crate) const ORANGE: u32 = 0xE69F_00FF;
pub(crate) const SKY: u32 = 0x56B4_E9FF;
pub(crate) const GREEN: u32 = 0x00B0_80FF;
pub(crate) const YELLOW: u32 = 0xF0E4_42FF;
pub(crate) const VERMILION: u32 = 0xE863_1AFF;
pub(crate) const GREY: u32 = 0xB4BA_C4FF;
pub(crate) const WHITE: u32 = 0xF4F6_F8FF;

/// The name of a colour of an arrow.
pub(crate) fn name(color: u32) -> &'static str {
    match color {
        ORANGE => "orange",
        SKY => "blue",
        GREEN => "green",
        YELLOW => "yellow",
        VERMILION => "red",
        WHITE => "white",
        _ => "grey",
    }
}
