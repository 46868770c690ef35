//! Values of expressions and variables: numbers, truths, texts, lists, tables.

use std::collections::BTreeMap;
use std::fmt;
use std::ops::Range;
use std::slice::Iter;

use ::toml::Spanned;
use ::toml::de::DeValue;

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Quantity {
    /// Finite.
    Number(f64),
    Truth(bool),
    Text(String),
    List(Vec<Quantity>),
    Table(BTreeMap<String, Quantity>),
}

/// Whole numbers up to this one are told apart from their neighbours.
pub(super) const MOST_EXACT: f64 = ((1u64 << 53) - 1) as f64;

/// The size of values that are shown whole.
const LONGEST: u64 = 40;

impl Quantity {
    /// In words.
    pub(super) fn what(&self) -> String {
        match self {
            Self::Number(number) => number.to_string(),
            Self::Truth(truth) => truth.to_string(),
            Self::Text(text) if text.chars().count() > 40 => "a long text".to_owned(),
            Self::Text(text) => format!("{text:?}"),
            Self::List(items) => format!("a list of {}", crate::plural::counted(items.len(), "value")),
            Self::Table(_) => "a table".to_owned(),
        }
    }

    /// In TOML, if that is not long, and else in words.
    pub(super) fn in_short(&self) -> String {
        if self.size() > LONGEST { self.what() } else { self.to_string() }
    }

    /// A measure of its memory: the number of values in it, and of the bytes of its texts.
    pub(super) fn size(&self) -> u64 {
        match self {
            Self::Number(_) | Self::Truth(_) => 1,
            Self::Text(text) => 1 + text.len() as u64,
            Self::List(items) => 1 + items.iter().map(Self::size).sum::<u64>(),
            Self::Table(entries) => {
                1 + entries.iter().map(|(key, value)| key.len() as u64 + value.size()).sum::<u64>()
            }
        }
    }

    /// The number of lists and tables that are inside each other.
    pub(super) fn depth(&self) -> usize {
        let deepest = |depth: Option<usize>| 1 + depth.unwrap_or(0);
        match self {
            Self::List(items) => deepest(items.iter().map(Self::depth).max()),
            Self::Table(entries) => deepest(entries.values().map(Self::depth).max()),
            _ => 0,
        }
    }

    /// The texts of its numbers, which values of TOML borrow.
    fn digits(&self, digits: &mut Vec<String>) {
        match self {
            Self::Number(_) => digits.push(self.to_string()),
            Self::Truth(_) | Self::Text(_) => {}
            Self::List(items) => items.iter().for_each(|item| item.digits(digits)),
            Self::Table(entries) => entries.values().for_each(|value| value.digits(digits)),
        }
    }

    fn as_toml<'q>(&'q self, span: &Range<usize>, digits: &mut Iter<'q, String>) -> Spanned<DeValue<'q>> {
        let value = match self {
            // Numbers are written as TOML has them.
            Self::Number(_) => digits
                .next()
                .and_then(|digits| DeValue::parse(digits).ok())
                .map_or(DeValue::Boolean(false), Spanned::into_inner),
            Self::Truth(truth) => DeValue::Boolean(*truth),
            Self::Text(text) => DeValue::String(text.into()),
            Self::List(items) => {
                DeValue::Array(items.iter().map(|item| item.as_toml(span, digits)).collect())
            }
            Self::Table(entries) => DeValue::Table(
                entries
                    .iter()
                    .map(|(key, value)| (Spanned::new(span.clone(), key.into()), value.as_toml(span, digits)))
                    .collect(),
            ),
        };
        Spanned::new(span.clone(), value)
    }
}

/// A value that takes the place of another one in a file.
#[derive(Debug)]
pub(super) struct Replacement {
    value: Quantity,
    digits: Vec<String>,
}

impl Replacement {
    pub(super) fn new(value: Quantity) -> Self {
        let mut digits = Vec::new();
        value.digits(&mut digits);
        Self { value, digits }
    }

    /// As a value of TOML, all of it at one place of a text. Whole numbers are integers, as counts have to be.
    pub(super) fn as_toml(&self, span: &Range<usize>) -> Spanned<DeValue<'_>> {
        self.value.as_toml(span, &mut self.digits.iter())
    }
}

/// In TOML.
impl fmt::Display for Quantity {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            // Negative zero has no integer.
            Self::Number(number) if number.fract() == 0.0 && number.abs() <= MOST_EXACT => {
                write!(f, "{}", *number as i64)
            }
            Self::Number(number) => write!(f, "{number:?}"),
            Self::Truth(truth) => write!(f, "{truth}"),
            Self::Text(text) => write!(f, "{text:?}"),
            Self::List(items) => {
                f.write_str("[")?;
                for (index, item) in items.iter().enumerate() {
                    write!(f, "{}{item}", if index > 0 { ", " } else { "" })?;
                }
                f.write_str("]")
            }
            Self::Table(entries) => {
                f.write_str("{")?;
                for (index, (key, value)) in entries.iter().enumerate() {
                    write!(f, "{} {key} = {value}", if index > 0 { "," } else { "" })?;
                }
                f.write_str(" }")
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_become_the_same_in_toml() {
        for number in [0.0, -0.0, 1.0, -3.0, 0.1, 1e300, -2.5e-300, MOST_EXACT, 1e16, f64::MIN_POSITIVE] {
            let text = Quantity::Number(number).to_string();
            assert_eq!(text.parse::<f64>(), Ok(number), "{text}");
            let replacement = Replacement::new(Quantity::Number(number));
            let toml = replacement.as_toml(&(3..5));
            assert_eq!(toml.span(), 3..5);
            let is_whole = number.fract() == 0.0 && number.abs() <= MOST_EXACT;
            assert_eq!(toml.get_ref().is_integer(), is_whole, "{text}");
            assert!(is_whole || toml.get_ref().is_float(), "{text}");
        }
    }
}
