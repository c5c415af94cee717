//! Formulas over named numbers: as text, with the numbers inserted, and evaluated exactly.
//!
//! A formula accompanies the pipeline's value and never replaces it. The pipeline's own functions compute the displayed
//! value; the formula gives the exact result for the same inputs.

use std::borrow::Cow;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::exact::ExactNumber;
use super::number::Number;
use crate::math::real::Real;

/// Formula over named numbers, as an expression tree.
#[derive(Clone, Debug)]
pub(crate) enum Formula {
    /// A named number of the pipeline.
    Given(Cow<'static, str>, Number),
    /// A constant of the formula, with its text.
    Constant(Cow<'static, str>, ExactNumber),
    /// A binary operation on two formulas.
    Binary(Op, Box<Self>, Box<Self>),
    /// A function of one formula.
    Unary(Function, Box<Self>),
}

/// Binary operation in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Op {
    /// The sum a + b.
    Add,
    /// The difference a − b.
    Subtract,
    /// The product a · b.
    Multiply,
    /// The quotient a / b.
    Divide,
    /// The maximum of a and b.
    Max,
    /// The minimum of a and b.
    Min,
    /// The power a^b, evaluated with the precision of an f64.
    Power,
}

/// Function of one number in a formula.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    /// Negation: −x.
    Negate,
    /// The square root √x.
    SquareRoot,
    /// The power x^(5/12) = x^(1/2.4), for sRGB encoding.
    SrgbRoot,
    /// The power x^(12/5) = x^2.4, for sRGB decoding.
    SrgbPower,
    /// Largest integer that does not exceed x.
    Floor,
    /// The integer nearest to x, with ties to even.
    Round,
}

/// Exact result of a formula.
#[derive(Clone, Debug)]
pub(crate) struct Evaluated {
    /// Exact value of the formula.
    pub(crate) value: ExactNumber,
    /// Maximum number of leading bits cancelled by any sum or difference in the formula.
    pub(crate) lost_bits: u32,
}

/// Creates a formula that consists of one named number of the pipeline.
pub(crate) fn given(name: impl Into<Cow<'static, str>>, number: impl Into<Number>) -> Formula {
    Formula::Given(name.into(), number.into())
}

/// Creates a formula that consists of one integer constant, displayed as `text`.
pub(crate) fn whole(text: &'static str, value: i64) -> Formula {
    Formula::Constant(text.into(), ExactNumber::whole(value))
}

/// Creates a formula that consists of one fractional constant, displayed as `text`. The denominator must not be 0.
pub(crate) fn fraction(text: &'static str, numerator: i64, denominator: i64) -> Formula {
    Formula::Constant(text.into(), ExactNumber::ratio(numerator, denominator).unwrap_or_else(|| ExactNumber::whole(0)))
}

/// Returns the sum of formulas; 0 if there are none.
pub(crate) fn sum(terms: impl IntoIterator<Item = Formula>) -> Formula {
    terms.into_iter().reduce(|a, b| a + b).unwrap_or_else(|| whole("0", 0))
}

impl Formula {
    /// Returns the maximum of two formulas.
    pub(crate) fn max(self, other: Self) -> Self {
        Self::Binary(Op::Max, Box::new(self), Box::new(other))
    }

    /// Returns the minimum of two formulas.
    pub(crate) fn min(self, other: Self) -> Self {
        Self::Binary(Op::Min, Box::new(self), Box::new(other))
    }

    /// Raises the formula to the power of another one. The value of the base must not be negative.
    pub(crate) fn raised_to(self, exponent: Self) -> Self {
        Self::Binary(Op::Power, Box::new(self), Box::new(exponent))
    }

    /// Applies a function to the formula.
    pub(crate) fn apply(self, function: Function) -> Self {
        Self::Unary(function, Box::new(self))
    }

    /// Returns the formula as text with names and operators.
    pub(crate) fn words(&self) -> String {
        self.text(&|formula| match formula {
            // Parentheses prevent a name that contains an operator from being read as a formula.
            Self::Given(name, _) if name.contains('/') => format!("({name})"),
            Self::Given(name, _) => name.to_string(),
            _ => String::new(),
        })
        .0
    }

    /// Returns the formula as text with numbers instead of names.
    pub(crate) fn numbers(&self) -> String {
        self.text(&|formula| match formula {
            Self::Given(_, number) if number.to_f64() < 0.0 => format!("({number})"),
            Self::Given(_, number) => number.to_string(),
            _ => String::new(),
        })
        .0
    }

    /// Returns the number of roundings if every operation is performed separately; a power counts as two.
    pub(crate) fn operations(&self) -> usize {
        match self {
            Self::Given(..) | Self::Constant(..) => 0,
            Self::Binary(Op::Max | Op::Min, a, b) => a.operations() + b.operations(),
            // A power is not correctly rounded, so it counts twice.
            Self::Binary(Op::Power, a, b) => 2 + a.operations() + b.operations(),
            Self::Binary(_, a, b) => 1 + a.operations() + b.operations(),
            Self::Unary(Function::Negate, a) => a.operations(),
            Self::Unary(_, a) => 1 + a.operations(),
        }
    }

    /// Returns the type name of every number in the formula, such as "f32", including repetitions.
    pub(crate) fn kinds(&self) -> Vec<&'static str> {
        match self {
            Self::Given(_, number) => vec![number.kind()],
            Self::Constant(..) => Vec::new(),
            Self::Binary(_, a, b) => [a.kinds(), b.kinds()].concat(),
            Self::Unary(_, a) => a.kinds(),
        }
    }

    /// Evaluates the formula exactly; `None` for a non-finite input or a division by 0.
    pub(crate) fn evaluate(&self) -> Option<Evaluated> {
        match self {
            Self::Given(_, number) => Some(Evaluated { value: number.exact()?, lost_bits: 0 }),
            Self::Constant(_, value) => Some(Evaluated { value: value.clone(), lost_bits: 0 }),
            Self::Binary(op, a, b) => {
                let (a, b) = (a.evaluate()?, b.evaluate()?);
                let value = match op {
                    Op::Add => &a.value + &b.value,
                    Op::Subtract => &a.value - &b.value,
                    Op::Multiply => &a.value * &b.value,
                    Op::Divide => a.value.divided_by(&b.value)?,
                    Op::Max => (&a.value).max(&b.value).clone(),
                    Op::Min => (&a.value).min(&b.value).clone(),
                    Op::Power => ExactNumber::from_f64(libm::pow(a.value.approximate(), b.value.approximate()))?,
                };
                let here = match op {
                    Op::Add | Op::Subtract => cancelled_bits(&a.value, &b.value, &value),
                    _ => 0,
                };
                Some(Evaluated { value, lost_bits: here.max(a.lost_bits).max(b.lost_bits) })
            }
            Self::Unary(function, a) => {
                let Evaluated { value, lost_bits } = a.evaluate()?;
                let value = match function {
                    Function::Negate => -&value,
                    Function::SquareRoot => value.root(2)?,
                    Function::SrgbRoot => value.power(5).root(12)?,
                    Function::SrgbPower => value.power(12).root(5)?,
                    Function::Floor => value.floor(),
                    Function::Round => value.round_ties_even(),
                };
                Some(Evaluated { value, lost_bits })
            }
        }
    }

    /// Returns the value of a formula of a kernel with every operation rounded to f32, as the pipeline computes it.
    fn rounded(&self) -> f32 {
        match self {
            Self::Given(_, number) => number.to_f64() as f32,
            Self::Constant(_, value) => value.approximate() as f32,
            Self::Binary(op, a, b) => {
                let (a, b) = (a.rounded(), b.rounded());
                match op {
                    Op::Add => a + b,
                    Op::Subtract => a - b,
                    Op::Multiply => a * b,
                    Op::Divide => a / b,
                    Op::Max => a.max(b),
                    Op::Min => a.min(b),
                    Op::Power => libm::powf(a, b),
                }
            }
            Self::Unary(function, a) => {
                let a = a.rounded();
                match function {
                    Function::Negate => -a,
                    Function::SquareRoot => a.sqrt(),
                    Function::SrgbRoot => libm::powf(a, 5.0 / 12.0),
                    Function::SrgbPower => libm::powf(a, 12.0 / 5.0),
                    Function::Floor => a.floor(),
                    Function::Round => a.round_ties_even(),
                }
            }
        }
    }

    /// Returns the text of the formula, and the precedence of its outermost operator.
    fn text(&self, name: &impl Fn(&Self) -> String) -> (String, Precedence) {
        let inside = |part: &Self, least: Precedence| {
            let (text, binding) = part.text(name);
            if binding < least { format!("({text})") } else { text }
        };
        match self {
            Self::Given(..) => (name(self), Precedence::Atom),
            Self::Constant(text, _) => (text.to_string(), Precedence::Atom),
            Self::Binary(op, a, b) => {
                let (sign, binding, of_second) = match op {
                    Op::Add => ("+", Precedence::Sum, Precedence::Sum),
                    Op::Subtract => ("−", Precedence::Sum, Precedence::Product),
                    Op::Multiply => ("·", Precedence::Product, Precedence::Product),
                    Op::Divide => ("/", Precedence::Product, Precedence::Atom),
                    Op::Power => {
                        let (base, exponent) = (inside(a, Precedence::Atom), inside(b, Precedence::Atom));
                        return (format!("{base}^{exponent}"), Precedence::Atom);
                    }
                    Op::Max => return (format!("max({}, {})", a.text(name).0, b.text(name).0), Precedence::Atom),
                    Op::Min => return (format!("min({}, {})", a.text(name).0, b.text(name).0), Precedence::Atom),
                };
                (format!("{} {sign} {}", inside(a, binding), inside(b, of_second)), binding)
            }
            Self::Unary(function, a) => {
                let whole = || a.text(name).0;
                match function {
                    Function::Negate => (format!("−{}", inside(a, Precedence::Atom)), Precedence::Product),
                    Function::SquareRoot => (format!("√({})", whole()), Precedence::Atom),
                    Function::SrgbRoot => (format!("({})^(1/2.4)", whole()), Precedence::Atom),
                    Function::SrgbPower => (format!("({})^2.4", whole()), Precedence::Atom),
                    Function::Floor => (format!("⌊{}⌋", whole()), Precedence::Atom),
                    Function::Round => (format!("round({})", whole()), Precedence::Atom),
                }
            }
        }
    }
}

/// Precedence of operators, from low to high.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Precedence {
    Sum,
    Product,
    Atom,
}

/// Returns the number of leading bits cancelled in `result`, the sum or difference of `a` and `b`: the binary exponent
/// of the larger operand minus that of the result. Returns 0 if the result is 0, where equal numbers cancel without
/// error.
fn cancelled_bits(a: &ExactNumber, b: &ExactNumber, result: &ExactNumber) -> u32 {
    let Some(left) = result.floor_log2() else { return 0 };
    let largest = a.floor_log2().max(b.floor_log2()).unwrap_or(left);
    u32::try_from(largest - left).unwrap_or(0)
}

macro_rules! operator {
    ($trait:ident, $function:ident, $op:ident) => {
        impl $trait for Formula {
            type Output = Self;

            fn $function(self, other: Self) -> Self {
                Self::Binary(Op::$op, Box::new(self), Box::new(other))
            }
        }
    };
}

operator!(Add, add, Add);
operator!(Sub, sub, Subtract);
operator!(Mul, mul, Multiply);
operator!(Div, div, Divide);

impl Neg for Formula {
    type Output = Self;

    fn neg(self) -> Self {
        self.apply(Function::Negate)
    }
}

impl Real for Formula {
    fn constant(&self, value: f32) -> Self {
        constant(value)
    }

    fn max(self, other: Self) -> Self {
        Self::max(self, other)
    }

    fn floor(self) -> Self {
        self.apply(Function::Floor)
    }

    /// Returns the formula of the number that the pipeline chooses.
    fn choose_above(&self, limit: &Self, then: Self, otherwise: Self) -> Self {
        if self.rounded() > limit.rounded() { then } else { otherwise }
    }
}

/// Creates a formula that consists of one constant, displayed as the shortest decimal that identifies it, or as ½.
pub(crate) fn constant(value: f32) -> Formula {
    let text = if value == 0.5 { Cow::Borrowed("½") } else { Cow::Owned(value.to_string()) };
    Formula::Constant(text, ExactNumber::from_f64(value.into()).unwrap_or_else(|| ExactNumber::whole(0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_numbers_have_the_necessary_parentheses() {
        let (a, b, c) = (|| given("a", 2.0_f32), || given("b", -3.0_f32), || given("c", 0.5_f32));
        assert_eq!((a() * (b() + c())).words(), "a · (b + c)");
        assert_eq!((a() - (b() - c())).words(), "a − (b − c)");
        assert_eq!((a() / (b() * c())).words(), "a / (b · c)");
        assert_eq!((a() * b() + c()).numbers(), "2.0 · (−3.0) + 0.5");
        assert_eq!((-(a() + b())).words(), "−(a + b)");
        assert_eq!(a().max(b()).words(), "max(a, b)");
        assert_eq!((whole("1", 1) - a()).words(), "1 − a");
    }

    #[test]
    fn exact_values_are_not_rounded() {
        let formula = given("a", 0.1_f32) + given("b", 0.2_f32);
        let exact = formula.evaluate().unwrap().value;
        assert_eq!(
            exact,
            &ExactNumber::from_f64(0.1_f32.into()).unwrap() + &ExactNumber::from_f64(0.2_f32.into()).unwrap()
        );
        assert!((given("a", 1.0_f32) / given("b", 0.0_f32)).evaluate().is_none());
        assert!(given("a", f32::NAN).evaluate().is_none());
    }

    #[test]
    fn lost_bits_count_cancelled_leading_bits() {
        let near = given("a", 1.0_f32 + 1.0 / 1024.0) - given("b", 1.0_f32);
        assert_eq!(near.evaluate().unwrap().lost_bits, 10);
        let far = given("a", 4.0_f32) - given("b", 1.0_f32);
        assert_eq!(far.evaluate().unwrap().lost_bits, 1);
        let equal = given("a", 4.0_f32) - given("b", 4.0_f32);
        assert_eq!(equal.evaluate().unwrap().lost_bits, 0);
    }
}
