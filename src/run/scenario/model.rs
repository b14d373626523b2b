//! Builds the model from scenario values.

use super::choice::{SupportKind, find_dissipation};
use super::error::{Problem, ScenarioError};
use super::laws::{LawKeys, find_sliding_law};
use super::values::Values;
use crate::physics::dynamics::{Model, Support};
use crate::physics::formula::PARAMETERS;
use crate::physics::friction::{Air, Branch, Dissipation, Drilling, Friction, FrictionLaw, Losses};
use crate::physics::top::Top;
use std::sync::Arc;

/// The model of complete values.
pub(super) fn model(values: &Values) -> Result<Model, ScenarioError> {
    Ok(Model {
        top: top(values)?,
        friction: friction(values)?,
        support: support(values)?,
    })
}

fn support(values: &Values) -> Result<Support, ScenarioError> {
    match values.optional_choice("support.kind", SupportKind::find)? {
        Some(SupportKind::Free) => Ok(Support::FreePeg {
            restitution: values.number_or_zero("support.restitution"),
        }),
        Some(SupportKind::Fixed) | None => Ok(Support::FixedPeg),
    }
}

fn top(values: &Values) -> Result<Top, ScenarioError> {
    Ok(Top {
        mass: values.required_number("top.mass")?,
        transverse_moment: values.required_number("top.transverse_moment")?,
        axial_moment: values.required_number("top.axial_moment")?,
        center_distance: values.required_number("top.center_distance")?,
        peg_radius: values.required_number("top.peg_radius")?,
        gravity: values.required_number("gravity")?,
    })
}

impl LawKeys for Values {
    fn number(&self, path: &'static str) -> Result<f64, ScenarioError> {
        self.required_number(path)
    }

    fn formula_law(&self) -> Result<FrictionLaw, ScenarioError> {
        let key = "friction.formula";
        let Some(formula) = self.formula()? else {
            return Err(self.not_allowed(key));
        };
        let parameters = PARAMETERS.map(|name| self.number_or_zero(&format!("friction.{name}")));
        let coefficient = formula
            .with_parameters(&parameters)
            .map_err(|error| self.invalid_formula(error))?;
        coefficient
            .check(0.0)
            .map_err(|error| self.invalid(key, Problem::Coefficient(error)))?;
        let at_rest = coefficient.at(0.0);
        let static_k = self.optional_number("friction.static_k");
        if static_k.is_some_and(|static_k| static_k < at_rest || at_rest == 0.0) {
            return Err(self.invalid("friction.static_k", Problem::StaticFriction { at_rest }));
        }
        Ok(FrictionLaw::Formula {
            coefficient: Arc::new(coefficient),
            static_k: static_k.unwrap_or(at_rest),
        })
    }
}

fn friction(values: &Values) -> Result<Friction, ScenarioError> {
    let make_law = values.choice("friction.law", find_sliding_law)?;
    let law = make_law(values)?;
    let losses = losses(values);
    if matches!(law, FrictionLaw::Contensou { .. }) && values.has("drilling.k") {
        return Err(values.invalid("drilling.k", Problem::AlreadyIncluded));
    }
    let dissipation = values.optional_choice("friction.dissipation", find_dissipation)?;
    Ok(Friction {
        law,
        // Without sliding friction the key doesn't apply, and there is nothing to leave out.
        dissipation: dissipation.unwrap_or(Dissipation::Full),
        // Without losses, the equations leave out their terms instead of adding zeros.
        losses: (!losses.is_none()).then_some(losses),
        branch: Branch::default(),
    })
}

/// The additional losses.
fn losses(values: &Values) -> Losses {
    Losses {
        rolling_arm: values.number_or_zero("rolling.arm"),
        drilling: Drilling {
            k: values.number_or_zero("drilling.k"),
            patch_radius: values.number_or_zero("drilling.patch_radius"),
        },
        air: Air {
            axial: values.number_or_zero("air.axial"),
            transverse: values.number_or_zero("air.transverse"),
            disc: values.number_or_zero("air.disc"),
        },
    }
}
