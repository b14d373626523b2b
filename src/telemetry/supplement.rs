//! Channels and attachments that a recording may hold in addition to its run.
//!
//! They come from elsewhere, such as the data of a fit, so they don't follow from the scenario: `verify` checks that they
//! are declared as here and lists them, but can't compare their content. They are not part of the content digest.

use super::encoding::json;
use super::encoding::template::Template;
use super::message::Message;
use super::table::channel::{ChannelInfo, Leaf};
use super::table::quantity::Quantity;
use std::sync::OnceLock;

/// Topic of the measured values of a fit.
pub const FIT_DATA: &str = "/fit/data";
/// Topic of the residuals of a fit.
pub const FIT_RESIDUAL: &str = "/fit/residual";

/// An attachment in addition to the scenario.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SupplementaryAttachment {
    /// Name.
    pub name: &'static str,
    /// Media type.
    pub media_type: &'static str,
}

/// The attachments that a recording may have in addition to its scenario. Their times are 0.
pub const SUPPLEMENTARY_ATTACHMENTS: [SupplementaryAttachment; 2] = [
    SupplementaryAttachment {
        name: "fit-problem.json",
        media_type: "application/json",
    },
    SupplementaryAttachment {
        name: "fit-report.json",
        media_type: "application/json",
    },
];

/// A channel in addition to those of a run. Its messages are JSON in recordings of any encoding.
#[derive(Debug)]
pub struct Supplement {
    /// Topic, message type and fields.
    pub info: ChannelInfo,
    template: Template,
}

impl Supplement {
    /// The supplement with this topic.
    pub fn find(topic: &str) -> Option<&'static Self> {
        supplements().iter().find(|s| s.info.topic == topic)
    }

    /// Appends a message to `out`, as JSON. Numbers and texts are in the order of the fields.
    pub fn encode(&self, time_ns: u64, numbers: &[f64], texts: &[String], out: &mut Vec<u8>) {
        let message = Message {
            // The template stands for the channel, which has no index in the table.
            channel: usize::MAX,
            sequence: 0,
            time_ns,
            numbers,
            texts,
        };
        json::encode(&self.template, &message, out);
    }
}

/// All supplements.
pub fn supplements() -> &'static [Supplement] {
    static SUPPLEMENTS: OnceLock<Vec<Supplement>> = OnceLock::new();
    SUPPLEMENTS.get_or_init(|| {
        let field = text("field", "measured field, e.g. /top/state.theta");
        let fields = [
            ChannelInfo {
                texts: vec![field.clone(), text("unit", "unit of the numbers")],
                numbers: vec![
                    number("value", "measured value"),
                    number("sigma", "standard deviation of the measured value"),
                ],
                ..channel(FIT_DATA, "toprise.FitData", "measured values of a fit")
            },
            ChannelInfo {
                texts: vec![field],
                numbers: vec![
                    number(
                        "residual",
                        "(model − data)/σ, without unit; the model is the run of this recording",
                    ),
                    number("held_out", "1 predicted, 0 fitted"),
                ],
                ..channel(FIT_RESIDUAL, "toprise.FitResidual", "residuals of a fit")
            },
        ];
        fields
            .map(|info| Supplement {
                template: json::template(&info),
                info,
            })
            .into()
    })
}

fn channel(topic: &'static str, schema: &'static str, meaning: &'static str) -> ChannelInfo {
    ChannelInfo {
        topic,
        schema,
        meaning,
        texts: Vec::new(),
        numbers: Vec::new(),
        is_sampled: false,
        is_optional: true,
        is_free_peg_only: false,
    }
}

fn text(name: &str, meaning: &'static str) -> Leaf {
    leaf(name, Quantity::Text, meaning)
}

/// A number whose unit depends on the measured field.
fn number(name: &str, meaning: &'static str) -> Leaf {
    leaf(name, Quantity::Number, meaning)
}

fn leaf(name: &str, quantity: Quantity, meaning: &'static str) -> Leaf {
    Leaf {
        path: name.to_owned(),
        quantity,
        unit: quantity.unit(),
        frame: "",
        meaning,
        plot: "",
        is_component: false,
        derivative: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encodes_fields_by_name() {
        let mut message = Vec::new();
        let texts = ["/top/state.theta", "rad"].map(str::to_owned);
        let data = Supplement::find(FIT_DATA).unwrap();
        data.encode(1_500_000_000, &[0.25, 0.001], &texts, &mut message);
        let message: serde_json::Value = serde_json::from_slice(&message).unwrap();
        let expected = serde_json::json!({
            "timestamp": { "sec": 1, "nsec": 500_000_000 },
            "field": "/top/state.theta", "unit": "rad", "value": 0.25, "sigma": 0.001,
        });
        assert_eq!(message, expected);
        assert!(Supplement::find("/fit/other").is_none());
    }
}
