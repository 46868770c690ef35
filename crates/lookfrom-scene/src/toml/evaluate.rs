//! The values of expressions. Arithmetic with lists of numbers is that of their items, one by one.

use std::cell::Cell;

use super::expression::{Expression, ExpressionKind, Fault, Operator};
use super::function;
use super::quantity::Quantity;

/// The greatest depth of parts of expressions, and of variables that are defined by others.
const DEEPEST: usize = 192;

/// The greatest size of all values that the expressions of a scene may have together.
const MOST: u64 = 1 << 24;

/// The deepest nesting of lists in a value.
const DEEPEST_LIST: usize = 16;

/// Depth and work that evaluation may still take, so that a few lines cannot ask for endless memory or time.
#[derive(Debug, Default)]
pub(super) struct Allowance {
    depth: Cell<usize>,
    spent: Cell<u64>,
}

impl Allowance {
    /// Fails where all is spent: an expression that copies a large value must not do so before it fails.
    fn check(&self, at: usize) -> Result<(), Fault> {
        if self.spent.get() <= MOST {
            return Ok(());
        }
        Err(Fault::new(at, format!("the expressions of this scene have more than {MOST} values")))
    }

    /// Accounts for a value.
    pub(super) fn spend(&self, value: Quantity, at: usize) -> Result<Quantity, Fault> {
        if value.depth() > DEEPEST_LIST {
            return Err(Fault::new(
                at,
                format!("lists are inside each other more than {DEEPEST_LIST} times"),
            ));
        }
        self.spent.set(self.spent.get().saturating_add(value.size()));
        self.check(at)?;
        Ok(value)
    }

    /// Evaluates something that is one level deeper.
    pub(super) fn deeper<T>(
        &self,
        at: usize,
        evaluate: impl FnOnce() -> Result<T, Fault>,
    ) -> Result<T, Fault> {
        if self.depth.get() == DEEPEST {
            let message = format!("expressions and variables are nested deeper than {DEEPEST} levels");
            return Err(Fault::new(at, message));
        }
        self.depth.set(self.depth.get() + 1);
        let value = evaluate();
        self.depth.set(self.depth.get() - 1);
        value
    }
}

/// Evaluates an expression, with the values of its names.
pub(super) fn evaluate(
    expression: &Expression,
    names: &dyn Fn(&str, usize) -> Result<Quantity, Fault>,
    allowance: &Allowance,
) -> Result<Quantity, Fault> {
    let at = expression.at;
    allowance.check(at)?;
    let of = |part: &Expression| allowance.deeper(at, || evaluate(part, names, allowance));
    let all = |parts: &[Expression]| parts.iter().map(of).collect::<Result<Vec<_>, _>>();
    let value = match &expression.kind {
        ExpressionKind::Constant(value) => value.clone(),
        ExpressionKind::Name(name) => names(name, at)?,
        ExpressionKind::List(items) => Quantity::List(all(items)?),
        ExpressionKind::Minus(value) => numbers(&[of(value)?], "-", at, &|x| -x[0])?,
        ExpressionKind::Not(value) => Quantity::Truth(!truth(of(value)?, value.at)?),
        ExpressionKind::Choice(parts) => {
            let [condition, one, other] = &**parts;
            of(if truth(of(condition)?, condition.at)? { one } else { other })?
        }
        ExpressionKind::Item(parts) => item(of(&parts[0])?, at, of(&parts[1])?, parts[1].at)?,
        ExpressionKind::Call(name, arguments) => function::call(name, &all(arguments)?, at)?,
        ExpressionKind::Chain(first, others) => {
            let mut value = of(first)?;
            for &(operator, at, ref other) in others {
                value = match (operator, &value) {
                    // What does not matter is not evaluated.
                    (Operator::And, Quantity::Truth(false)) | (Operator::Or, Quantity::Truth(true)) => value,
                    (Operator::And | Operator::Or, _) => {
                        truth(value, expression.at)?;
                        Quantity::Truth(truth(of(other)?, other.at)?)
                    }
                    _ => allowance.spend(operate(operator, &value, &of(other)?, at)?, at)?,
                };
            }
            value
        }
    };
    allowance.spend(value, at)
}

fn truth(value: Quantity, at: usize) -> Result<bool, Fault> {
    match value {
        Quantity::Truth(truth) => Ok(truth),
        other => Err(Fault::new(at, format!("{} is no condition; expected a comparison", other.what()))),
    }
}

fn item(list: Quantity, at: usize, index: Quantity, at_index: usize) -> Result<Quantity, Fault> {
    let Quantity::List(mut items) = list else {
        return Err(Fault::new(at, format!("{} has no items; expected a list", list.what())));
    };
    let place = match index {
        Quantity::Number(number) if number.fract() == 0.0 && number >= 0.0 && number < items.len() as f64 => {
            number as usize
        }
        other => {
            let message = format!("there is no item {}; expected a whole number from 0", other.what());
            return Err(Fault::new(at_index, message).hint(format!(
                "the list has {}; the first is item 0",
                crate::plural::counted(items.len(), "value")
            )));
        }
    };
    Ok(items.swap_remove(place))
}

fn operate(operator: Operator, a: &Quantity, b: &Quantity, at: usize) -> Result<Quantity, Fault> {
    let arithmetic = |sign: &str, f: &dyn Fn(&[f64]) -> f64| numbers(&[a.clone(), b.clone()], sign, at, f);
    let compared = |sign: &str, is: &dyn Fn(f64, f64) -> bool| match (a, b) {
        (Quantity::Number(a), Quantity::Number(b)) => Ok(Quantity::Truth(is(*a, *b))),
        _ => Err(Fault::new(at, format!("{} {sign} {}; expected numbers", a.what(), b.what()))),
    };
    match operator {
        Operator::Plus => match (a, b) {
            (Quantity::Text(a), Quantity::Text(b)) => Ok(Quantity::Text(format!("{a}{b}"))),
            (Quantity::Text(a), Quantity::Number(_)) => Ok(Quantity::Text(format!("{a}{b}"))),
            (Quantity::Number(_), Quantity::Text(b)) => Ok(Quantity::Text(format!("{a}{b}"))),
            _ => arithmetic("+", &|x| x[0] + x[1]),
        },
        Operator::Minus => arithmetic("-", &|x| x[0] - x[1]),
        Operator::Times => arithmetic("*", &|x| x[0] * x[1]),
        Operator::Over => arithmetic("/", &|x| x[0] / x[1]),
        Operator::Modulo => arithmetic("%", &|x| modulo(x[0], x[1])),
        Operator::Power => arithmetic("^", &|x| libm::pow(x[0], x[1])),
        Operator::Less => compared("<", &|a, b| a < b),
        Operator::Greater => compared(">", &|a, b| a > b),
        Operator::LessOrEqual => compared("<=", &|a, b| a <= b),
        Operator::GreaterOrEqual => compared(">=", &|a, b| a >= b),
        Operator::Equal => Ok(Quantity::Truth(a == b)),
        Operator::NotEqual => Ok(Quantity::Truth(a != b)),
        Operator::Or | Operator::And => Ok(a.clone()),
    }
}

/// The remainder with the sign of the divisor, so that angles and times come round evenly.
pub(super) fn modulo(a: f64, b: f64) -> f64 {
    let rest = libm::fmod(a, b);
    if rest != 0.0 && (rest < 0.0) != (b < 0.0) { rest + b } else { rest }
}

/// Applies a function of numbers, to items of lists one by one; numbers beside a list go with each of its items.
pub(super) fn numbers(
    values: &[Quantity],
    name: &str,
    at: usize,
    f: &dyn Fn(&[f64]) -> f64,
) -> Result<Quantity, Fault> {
    let said = || {
        let values: Vec<String> = values.iter().map(Quantity::what).collect();
        match (values.len(), name.starts_with(char::is_alphabetic)) {
            (_, true) => format!("{name}({})", values.join(", ")),
            (1, _) => format!("{name}{}", values[0]),
            _ => values.join(&format!(" {name} ")),
        }
    };
    let lists = values.iter().filter_map(|value| match value {
        Quantity::List(items) => Some(items.len()),
        _ => None,
    });
    let lengths: Vec<usize> = lists.collect();
    let Some(&length) = lengths.first() else {
        let singles: Option<Vec<f64>> = values
            .iter()
            .map(|value| match value {
                Quantity::Number(number) => Some(*number),
                _ => None,
            })
            .collect();
        let Some(singles) = singles else {
            return Err(Fault::new(at, format!("{}; expected numbers, or lists of numbers", said())));
        };
        let number = f(&singles);
        return match number.is_finite() {
            true => Ok(Quantity::Number(number)),
            false if matches!(name, "/" | "%") && singles[1] == 0.0 => {
                Err(Fault::new(at, format!("{}: division by zero", said())))
            }
            false => Err(Fault::new(at, format!("{} is not a finite number", said()))),
        };
    };
    if lengths.iter().any(|&other| other != length) {
        return Err(Fault::new(at, format!("{}; expected lists of the same length", said())));
    }
    let of_item = |index: usize| {
        let parts: Vec<Quantity> = values
            .iter()
            .map(|value| match value {
                Quantity::List(items) => items[index].clone(),
                other => other.clone(),
            })
            .collect();
        numbers(&parts, name, at, f)
    };
    (0..length).map(of_item).collect::<Result<Vec<_>, _>>().map(Quantity::List)
}
