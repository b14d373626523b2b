//! Builds the model from scenario values.

use super::choice::dissipation;
use super::error::ScenarioError;
use super::laws::sliding_law;
use super::values::Values;
use crate::physics::dynamics::{Model, Support};
use crate::physics::friction::{Air, Branch, Dissipation, Drilling, Friction, FrictionLaw, Losses};
use crate::physics::top::Top;

/// The model of complete values.
pub(super) fn model(values: &Values) -> Result<Model, ScenarioError> {
    Ok(Model {
        top: top(values)?,
        friction: friction(values)?,
        support: support(values),
    })
}

fn support(values: &Values) -> Support {
    let restitution = values.optional_number("support.restitution");
    match values.text("support.kind") {
        Ok("free") => Support::FreePeg {
            restitution: restitution.unwrap_or_default(),
        },
        _ => Support::FixedPeg,
    }
}

fn top(values: &Values) -> Result<Top, ScenarioError> {
    Ok(Top {
        mass: values.number("top.mass")?,
        transverse_moment: values.number("top.transverse_moment")?,
        axial_moment: values.number("top.axial_moment")?,
        center_distance: values.number("top.center_distance")?,
        peg_radius: values.number("top.peg_radius")?,
        gravity: values.number("gravity")?,
    })
}

fn friction(values: &Values) -> Result<Friction, ScenarioError> {
    let law = law(values)?;
    let losses = Some(losses(values)).filter(|losses| !losses.is_none());
    if matches!(law, FrictionLaw::Contensou { .. }) && values.get("drilling.k").is_some() {
        let reason = "friction.law = \"contensou\" already includes a drilling torque";
        return Err(values.invalid("drilling.k", reason));
    }
    let word = values.text("friction.dissipation").ok();
    Ok(Friction {
        law,
        dissipation: word.and_then(dissipation).unwrap_or(Dissipation::Full),
        losses,
        branch: Branch::default(),
    })
}

fn law(values: &Values) -> Result<FrictionLaw, ScenarioError> {
    let word = values.text("friction.law")?;
    let law = sliding_law(word, &|key| values.number(key));
    // The value was validated before.
    law.unwrap_or(Ok(FrictionLaw::None))
}

/// The additional losses.
fn losses(values: &Values) -> Losses {
    let number = |path| values.optional_number(path).unwrap_or_default();
    Losses {
        rolling_arm: number("rolling.arm"),
        drilling: Drilling {
            k: number("drilling.k"),
            patch_radius: number("drilling.patch_radius"),
        },
        air: Air {
            axial: number("air.axial"),
            transverse: number("air.transverse"),
            disc: number("air.disc"),
        },
    }
}
