//! Formulas: a coefficient of friction μ(v) that a person writes.
//!
//! A [`Formula`] is a text that has been parsed: a sum of products of powers, with numbers, the slip speed `v`, parameters,
//! `pi` and functions. Signs bind as in physics texts: `-v^2` is −(v²), and `2^3^2` is 2⁹. With numbers for its parameters it
//! becomes a [`Program`], a few steps without names, which computes μ at a speed without allocating anything.
//!
//! A scenario holds the text, and recordings hold the scenario: what a formula means is frozen. So the grammar and the
//! arithmetic are here, down to the order of operations, and no rule of algebra changes the order that was written.

mod curve;
mod error;
mod function;
mod parser;
mod program;
mod step;

pub use error::{FormulaError, FormulaProblem, InvalidCoefficient};
pub use program::Program;
pub use step::{PARAMETERS, Parameters};

use self::function::{Function, Operator};
use self::step::{Located, PI, POINTS, SPEED, Step};

/// A formula that has been parsed.
#[derive(Clone, Debug, PartialEq)]
pub struct Formula {
    text: String,
    /// In the order of their evaluation: operands before what is done with them.
    steps: Vec<Located>,
}

impl Formula {
    /// Parses a text.
    ///
    /// # Errors
    /// What isn't a formula, and where.
    pub fn parse(text: &str) -> Result<Self, FormulaError> {
        let steps = parser::parse(text)?;
        let text = text.to_owned();
        Ok(Self { text, steps })
    }

    /// Whether the formula contains this parameter.
    pub fn uses(&self, parameter: &str) -> bool {
        self.steps.iter().any(|located| {
            matches!(located.step, Step::Parameter(index) if PARAMETERS[index] == parameter)
        })
    }

    /// The program of the formula with these values of its parameters.
    ///
    /// # Errors
    /// Points whose speeds don't increase, or that depend on the slip speed.
    pub fn with_parameters(&self, parameters: &Parameters) -> Result<Program, FormulaError> {
        Program::new(&self.text, &self.steps, parameters)
            .map_err(|(at, problem)| FormulaError::new(&self.text, at..at + 1, problem))
    }

    /// All names that a formula may contain.
    pub fn names() -> impl Iterator<Item = &'static str> {
        let functions = Function::ALL.iter().map(|(name, _)| *name);
        let operators = Operator::FUNCTIONS.iter().map(|(name, _)| *name);
        [SPEED, PI, POINTS]
            .into_iter()
            .chain(PARAMETERS)
            .chain(functions)
            .chain(operators)
    }
}
