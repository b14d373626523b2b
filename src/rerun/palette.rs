//! The colours of plots and scene, as 0xRRGGBBAA.
//!
//! They are Okabe and Ito's, which stay distinguishable with any kind of colour vision.

pub(super) const ORANGE: u32 = 0xE69F_00FF;
pub(super) const SKY: u32 = 0x56B4_E9FF;
/// The colour of fast ripple; translucent, so that other curves stay visible.
pub(super) const PALE: u32 = 0x56B4_E990;
pub(super) const GREEN: u32 = 0x00B0_80FF;
pub(super) const YELLOW: u32 = 0xF0E4_42FF;
pub(super) const BLUE: u32 = 0x4C8F_D6FF;
pub(super) const VERMILION: u32 = 0xE863_1AFF;
pub(super) const PURPLE: u32 = 0xCC79_A7FF;
pub(super) const GREY: u32 = 0xB4BA_C4FF;
pub(super) const WHITE: u32 = 0xF4F6_F8FF;

/// The name of a colour of an arrow.
pub(super) fn name(color: u32) -> &'static str {
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
