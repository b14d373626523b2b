//! Formulas with numbers for their parameters, ready to be evaluated.

use super::curve::MonotoneCubic;
use super::error::{FormulaProblem, InvalidCoefficient};
use super::function::{Function, Operator};
use super::step::{Located, Parameters, Step};

/// The most numbers that wait for an operator. The parser refuses formulas that need more.
pub(super) const STACK: usize = 32;

/// Intervals of the grid on which a formula is checked.
const GRID: u32 = 256;

/// A formula with numbers for its parameters: the coefficient of friction μ at a slip speed.
#[derive(Clone, Debug, PartialEq)]
pub struct Program {
    /// The formula.
    text: String,
    instructions: Vec<Instruction>,
    curves: Vec<MonotoneCubic>,
}

/// As a [`Step`]; with its second operand if that is a number, as it mostly is.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Instruction {
    Number(f64),
    Speed,
    Apply(Function),
    Combine(Operator),
    /// The last number with this one.
    CombineWith(Operator, f64),
    /// The curve of this index at the last number.
    Curve(usize),
}

impl Program {
    /// The program of steps that the parser made; or a problem and the byte where it is.
    pub(super) fn new(
        text: &str,
        steps: &[Located],
        parameters: &Parameters,
    ) -> Result<Self, (usize, FormulaProblem)> {
        let mut program = Self {
            text: text.to_owned(),
            instructions: Vec::with_capacity(steps.len()),
            curves: Vec::new(),
        };
        for Located { step, at } in steps {
            match *step {
                Step::Number(number) => program.push(Instruction::Number(number)),
                Step::Parameter(index) => program.push(Instruction::Number(parameters[index])),
                Step::Speed => program.push(Instruction::Speed),
                Step::Apply(function) => program.push(Instruction::Apply(function)),
                Step::Combine(operator) => program.push(Instruction::Combine(operator)),
                Step::Points(count) => {
                    let curve = program
                        .take_curve(count)
                        .map_err(|problem| (*at, problem))?;
                    program.curves.push(curve);
                    program.push(Instruction::Curve(program.curves.len() - 1));
                }
            }
        }
        Ok(program)
    }

    /// Adds an instruction, or does at once what it would do with numbers: the same arithmetic, so the same bits.
    fn push(&mut self, instruction: Instruction) {
        use Instruction::{Apply, Combine, CombineWith, Curve, Number};
        let (taken, instruction) = match (instruction, self.instructions.as_slice()) {
            (Combine(operator), [.., Number(x), Number(y)]) => (2, Number(operator.apply(*x, *y))),
            (Combine(operator), [.., Number(y)]) => (1, CombineWith(operator, *y)),
            (Apply(function), [.., Number(x)]) => (1, Number(function.apply(*x))),
            (Curve(index), [.., Number(x)]) => (1, Number(self.curves[index].at(*x))),
            (other, _) => (0, other),
        };
        self.instructions.truncate(self.instructions.len() - taken);
        self.instructions.push(instruction);
    }

    /// Makes a curve of the last numbers.
    fn take_curve(&mut self, count: usize) -> Result<MonotoneCubic, FormulaProblem> {
        // What doesn't depend on the speed is one number by now; the last instruction of anything else is none.
        let first = self.instructions.len() - 2 * count;
        let mut numbers = Vec::with_capacity(2 * count);
        for instruction in self.instructions.drain(first..) {
            let Instruction::Number(number) = instruction else {
                return Err(FormulaProblem::PointsDepend);
            };
            numbers.push(number);
        }
        let (points, _) = numbers.as_chunks();
        MonotoneCubic::new(points).ok_or(FormulaProblem::UnorderedPoints)
    }

    /// The coefficient of friction at a slip speed, m/s. Whether it makes sense is not checked.
    #[inline]
    pub fn at(&self, speed: f64) -> f64 {
        match self.constant() {
            Some(number) => number,
            None => self.evaluate(speed),
        }
    }

    fn evaluate(&self, speed: f64) -> f64 {
        // The last number is kept apart, because nearly every instruction changes it.
        let mut stack = [0.0; STACK];
        let (mut last, mut height) = (0.0, 0);
        for instruction in &self.instructions {
            last = match *instruction {
                Instruction::Number(number) => {
                    stack[height] = last;
                    height += 1;
                    number
                }
                Instruction::Speed => {
                    stack[height] = last;
                    height += 1;
                    speed
                }
                Instruction::Apply(function) => function.apply(last),
                Instruction::CombineWith(operator, number) => operator.apply(last, number),
                Instruction::Combine(operator) => {
                    height -= 1;
                    operator.apply(stack[height], last)
                }
                Instruction::Curve(index) => self.curves[index].at(last),
            };
        }
        last
    }

    /// The coefficient if it is the same at every speed.
    #[inline]
    pub fn constant(&self) -> Option<f64> {
        match self.instructions.as_slice() {
            [Instruction::Number(number)] => Some(*number),
            _ => None,
        }
    }

    /// Checks the coefficient at a slip speed, m/s.
    ///
    /// # Errors
    /// If it is not a finite number that is not negative.
    pub fn check(&self, speed: f64) -> Result<(), InvalidCoefficient> {
        let value = self.at(speed);
        if value.is_finite() && value >= 0.0 {
            return Ok(());
        }
        Err(InvalidCoefficient {
            formula: self.text.clone(),
            speed,
            value,
        })
    }

    /// Checks the coefficient on a grid of slip speeds from 0 to a largest one, m/s; the slow ones are dense, because there
    /// laws of friction change most.
    ///
    /// # Errors
    /// As [`Program::check`], for the slowest such speed.
    pub fn check_up_to(&self, largest: f64) -> Result<(), InvalidCoefficient> {
        for point in 0..=GRID {
            let share = f64::from(point) / f64::from(GRID);
            self.check(largest * share * share)?;
        }
        Ok(())
    }
}
