//! The grammar of formulas, by recursive descent.
//!
//! ```text
//! sum     = product { ("+" | "-") product }
//! product = signed { ("*" | "/") signed }
//! signed  = ("+" | "-") signed | power
//! power   = operand [ "^" signed ]
//! operand = number | name | name "(" arguments ")" | "(" sum ")"
//! ```

use super::error::{FormulaError, FormulaProblem};
use super::function::{Function, Operator};
use super::program::STACK;
use super::step::{Located, PARAMETERS, PI, POINTS, SPEED, Step};
use std::ops::Range;

/// The most bytes of a formula.
const MAX_LENGTH: usize = 10_000;

/// How deep parentheses, signs and powers may be nested: each level is a few calls of the parser.
const MAX_NESTING: usize = 100;

/// Parses a text: the steps of its evaluation.
pub(super) fn parse(text: &str) -> Result<Vec<Located>, FormulaError> {
    let mut parser = Parser {
        text,
        at: 0,
        nesting: 0,
        waiting: 0,
        steps: Vec::new(),
    };
    parser
        .all()
        .map_err(|(place, problem)| FormulaError::new(text, place, problem))?;
    Ok(parser.steps)
}

/// A problem of some bytes of the text.
type Problem = (Range<usize>, FormulaProblem);

struct Parser<'a> {
    text: &'a str,
    /// The next byte.
    at: usize,
    nesting: usize,
    /// The numbers that wait for an operator after the steps so far.
    waiting: usize,
    steps: Vec<Located>,
}

impl Parser<'_> {
    fn all(&mut self) -> Result<(), Problem> {
        if self.text.len() > MAX_LENGTH {
            return Err((0..0, FormulaProblem::TooLong(MAX_LENGTH)));
        }
        self.sum()?;
        match self.peek() {
            None => Ok(()),
            Some('(') => Err(self.problem_here(FormulaProblem::NoOperator)),
            Some(next) if is_in_name(next) => Err(self.problem_here(FormulaProblem::NoOperator)),
            Some(next) => Err(self.problem_here(FormulaProblem::UnexpectedCharacter(next))),
        }
    }

    fn sum(&mut self) -> Result<(), Problem> {
        self.product()?;
        loop {
            let at = self.start_of_next();
            let operator = match self.peek() {
                Some('+') => Operator::Add,
                Some('-') => Operator::Subtract,
                Some(_) | None => return Ok(()),
            };
            self.at = at + 1;
            self.product()?;
            self.push(Step::Combine(operator), at)?;
        }
    }

    fn product(&mut self) -> Result<(), Problem> {
        self.signed()?;
        loop {
            let at = self.start_of_next();
            let operator = match self.peek() {
                Some('*') => Operator::Multiply,
                Some('/') => Operator::Divide,
                Some(_) | None => return Ok(()),
            };
            self.at = at + 1;
            self.signed()?;
            self.push(Step::Combine(operator), at)?;
        }
    }

    /// All that is nested passes here.
    fn signed(&mut self) -> Result<(), Problem> {
        if self.nesting == MAX_NESTING {
            return Err(self.problem_here(FormulaProblem::TooDeep(MAX_NESTING)));
        }
        self.nesting += 1;
        let at = self.start_of_next();
        if self.accept('-') {
            self.signed()?;
            self.push(Step::Apply(Function::Negate), at)?;
        } else if self.accept('+') {
            self.signed()?;
        } else {
            self.power()?;
        }
        self.nesting -= 1;
        Ok(())
    }

    fn power(&mut self) -> Result<(), Problem> {
        self.operand()?;
        let at = self.start_of_next();
        if self.accept('^') {
            self.signed()?;
            self.push(Step::Combine(Operator::Power), at)?;
        }
        Ok(())
    }

    fn operand(&mut self) -> Result<(), Problem> {
        let at = self.start_of_next();
        match self.peek() {
            Some('(') => {
                self.at = at + 1;
                self.sum()?;
                self.expect(')', ")")
            }
            Some(next) if next.is_ascii_digit() || next == '.' => self.number(at),
            Some(next) if is_in_name(next) => self.name(at),
            Some(next) if !next.is_ascii() => {
                Err(self.problem_here(FormulaProblem::UnexpectedCharacter(next)))
            }
            // Of `v**2`, which is a power elsewhere.
            Some('*') if self.text[..at].ends_with('*') => {
                Err(self.problem_here(FormulaProblem::UnexpectedCharacter('*')))
            }
            Some(_) | None => Err(self.problem_here(FormulaProblem::NoOperand)),
        }
    }

    /// A number: digits, with a point and an exponent if they have them.
    fn number(&mut self, at: usize) -> Result<(), Problem> {
        let rest = &self.text[at..];
        let mut length = rest
            .find(|c: char| !c.is_ascii_digit() && c != '.')
            .unwrap_or(rest.len());
        if let Some(exponent) = rest[length..].strip_prefix(['e', 'E']) {
            let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
            let digits = unsigned
                .find(|c: char| !c.is_ascii_digit())
                .unwrap_or(unsigned.len());
            // Otherwise it is a name: `2e` has no meaning, but is no number either.
            if digits > 0 {
                length += 1 + exponent.len() - unsigned.len() + digits;
            }
        }
        self.at = at + length;
        match rest[..length].parse::<f64>() {
            Ok(number) if number.is_finite() => self.push(Step::Number(number), at),
            Ok(_) | Err(_) => Err((at..self.at, FormulaProblem::NotANumber)),
        }
    }

    fn name(&mut self, at: usize) -> Result<(), Problem> {
        let rest = &self.text[at..];
        let name = &rest[..rest.find(|c: char| !is_in_name(c)).unwrap_or(rest.len())];
        self.at = at + name.len();
        if let Some(index) = PARAMETERS.iter().position(|parameter| *parameter == name) {
            return self.push(Step::Parameter(index), at);
        }
        match name {
            SPEED => self.push(Step::Speed, at),
            PI => self.push(Step::Number(std::f64::consts::PI), at),
            POINTS => self.points(at),
            _ => self.function(name, at),
        }
    }

    /// A function and its arguments.
    fn function(&mut self, name: &str, at: usize) -> Result<(), Problem> {
        if let Some((name, function)) = Function::ALL.into_iter().find(|(known, _)| *known == name)
        {
            self.open(name, at)?;
            self.sum()?;
            self.expect(')', ")")?;
            return self.push(Step::Apply(function), at);
        }
        let Some((name, operator)) = Operator::FUNCTIONS
            .into_iter()
            .find(|(known, _)| *known == name)
        else {
            let place = at..at + name.len();
            return Err((place, FormulaProblem::UnknownName(name.to_owned())));
        };
        self.open(name, at)?;
        self.sum()?;
        self.expect(',', ",")?;
        loop {
            self.sum()?;
            self.push(Step::Combine(operator), at)?;
            if !self.accept(',') {
                return self.expect(')', ", or )");
            }
        }
    }

    /// `points(x; v₁, μ₁; v₂, μ₂; …)`.
    fn points(&mut self, at: usize) -> Result<(), Problem> {
        self.open(POINTS, at)?;
        self.sum()?;
        self.expect(';', ";")?;
        let waiting = self.waiting;
        let mut count = 0;
        loop {
            self.sum()?;
            self.expect(',', ",")?;
            self.sum()?;
            count += 1;
            // They become part of the curve, and never wait.
            self.waiting = waiting;
            if !self.accept(';') {
                break;
            }
        }
        self.expect(')', "; or )")?;
        self.steps.push(Located {
            step: Step::Points(count),
            at,
        });
        Ok(())
    }

    fn open(&mut self, name: &'static str, at: usize) -> Result<(), Problem> {
        if self.accept('(') {
            return Ok(());
        }
        Err((at..at + name.len(), FormulaProblem::NoArguments(name)))
    }

    /// Adds a step whose operands are there.
    fn push(&mut self, step: Step, at: usize) -> Result<(), Problem> {
        match step {
            Step::Number(_) | Step::Speed | Step::Parameter(_) => self.waiting += 1,
            Step::Combine(_) => self.waiting -= 1,
            Step::Apply(_) | Step::Points(_) => {}
        }
        if self.waiting > STACK {
            return Err((at..at + 1, FormulaProblem::TooDeep(STACK)));
        }
        self.steps.push(Located { step, at });
        Ok(())
    }

    /// Where the next character is that is not a space.
    fn start_of_next(&self) -> usize {
        self.text.len() - self.text[self.at..].trim_start().len()
    }

    fn peek(&self) -> Option<char> {
        self.text[self.start_of_next()..].chars().next()
    }

    /// Skips this character if it is the next.
    fn accept(&mut self, wanted: char) -> bool {
        let is_next = self.peek() == Some(wanted);
        if is_next {
            self.at = self.start_of_next() + wanted.len_utf8();
        }
        is_next
    }

    fn expect(&mut self, wanted: char, text: &'static str) -> Result<(), Problem> {
        if self.accept(wanted) {
            return Ok(());
        }
        // Two operands without an operator are a more likely mistake than a missing parenthesis.
        let problem = match self.peek() {
            Some(next) if is_in_name(next) || next == '(' => FormulaProblem::NoOperator,
            Some(next) if !next.is_ascii() => FormulaProblem::UnexpectedCharacter(next),
            Some(_) | None => FormulaProblem::Missing(text),
        };
        Err(self.problem_here(problem))
    }

    /// A problem of the next character.
    fn problem_here(&self, problem: FormulaProblem) -> Problem {
        let start = self.start_of_next();
        let length = self.peek().map_or(0, char::len_utf8);
        (start..start + length, problem)
    }
}

fn is_in_name(character: char) -> bool {
    character.is_ascii_alphanumeric() || character == '_'
}
