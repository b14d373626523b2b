//! Profile likelihoods in words.

use super::super::report::Profile;
use crate::words::number::{Digits, decimals_of_error};
use crate::words::{Number, Piece, Section, Sentence, Table, Tone, sentence};

/// A profile whose interval differs from the curvature's by more than this is mentioned.
const CURVATURE_LIES: f64 = 0.2;

/// The intervals of a profile; `all` shows also its values.
pub(super) fn section(profile: &Profile, has_other_minima: bool, all: bool) -> Section {
    let parameter = Piece::key(profile.parameter.clone());
    let mut section = Section::new(sentence!("Profile of {}", parameter.clone()));
    if has_other_minima {
        section.note = "around the best minimum only".into();
    }
    let digits = digits(profile);
    for (level, ends) in [
        ("68.3 % (Δχ² < 1)", profile.interval_1),
        ("95.4 % (Δχ² < 4)", profile.interval_4),
    ] {
        section.line(sentence!("{}: {}", level, interval(ends, digits)));
    }
    if let Some(error) = profile.curvature_error
        && error > CURVATURE_LIES
    {
        section.tone = Tone::Weak;
        section.line(sentence!(
            "The interval from the standard deviation is wrong by {}: use this one.",
            Piece::fixed(100.0 * error, 0, "%")
        ));
    }
    if all {
        let values = profile.values.iter().zip(&profile.delta_chi2);
        section.table(Table {
            header: vec![parameter.into(), "Δχ²".into()],
            rows: values
                .map(|(value, delta)| {
                    vec![
                        number(*value, digits).into(),
                        Piece::fixed(*delta, 4, "").into(),
                    ]
                })
                .collect(),
            left: 0,
        });
    }
    section
}

/// The decimals of the parameter's estimate, and one more.
fn digits(profile: &Profile) -> Digits {
    match profile.interval_1 {
        [Some(low), Some(high)] => Digits::Decimals(decimals_of_error(0.5 * (high - low)) + 1),
        [_, None] | [None, _] => Digits::AtMost(8),
    }
}

fn number(value: f64, digits: Digits) -> Piece {
    Piece::Number(Number::new(value, digits, ""))
}

/// An interval, whose ends a profile may not have reached.
fn interval(ends: [Option<f64>; 2], digits: Digits) -> Sentence {
    match ends.map(|end| end.map(|value| number(value, digits))) {
        [Some(low), Some(high)] => sentence!("{} to {}", low, high),
        [None, Some(high)] => sentence!("up to {}; no lower end", high),
        [Some(low), None] => sentence!("from {} on; no upper end", low),
        [None, None] => sentence!("no ends"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn profiles_show_their_width_however_large_the_value_is() {
        for (value, half_width, expected) in [
            (4_999.267_231_4, Some(3.9e-4), "4999.267231"),
            (0.035_022_1, Some(5.9e-5), "0.0350221"),
            (172.002, Some(25.0), "172.0"),
            (0.035_022_1, None, "0.0350221"),
        ] {
            let ends = [-1.0, 1.0].map(|side| half_width.map(|width| value + side * width));
            let profile = Profile {
                parameter: "friction.k".to_owned(),
                values: Vec::new(),
                delta_chi2: Vec::new(),
                interval_1: ends,
                interval_4: [None; 2],
                curvature_error: None,
            };
            assert_eq!(number(value, digits(&profile)).to_string(), expected);
        }
    }
}
