//! A TOML value with its location, and checks of its type and range. The other decoders interpret it.

use ::toml::Spanned;
use ::toml::de::DeValue;
use glam::DVec3;

use super::document::Document;
use super::synonyms;
use super::table::Table;
use crate::error::{Error, ErrorKind, Location, Result};
use crate::suggest::nearest;

/// A value with its key.
#[derive(Clone, Copy)]
pub(super) struct Value<'a> {
    pub(super) document: &'a Document,
    pub(super) key: &'a str,
    pub(super) item: &'a Spanned<DeValue<'a>>,
}

impl<'a> Value<'a> {
    pub(super) fn at(self) -> Location {
        self.document.location(self.item.span().start)
    }

    pub(super) fn key(self) -> &'a str {
        self.key
    }

    /// Records an error about this value.
    pub(super) fn note(self, error: Error) {
        self.document.note(self.item.span().start, error);
    }

    /// The decoded value, or a placeholder if decoding failed: the error is recorded.
    pub(super) fn noting<T>(self, result: Result<T>, stand_in: T) -> T {
        result.unwrap_or_else(|error| {
            self.note(error);
            stand_in
        })
    }

    /// An error at this value.
    pub(super) fn error(self, message: impl Into<String>) -> Error {
        Error::invalid(&self.at(), message)
    }

    /// The error that this value is not as expected.
    pub(super) fn wrong(self, expected: &str) -> Error {
        self.error(format!("`{}` is {}; expected {expected}", self.key, self.found()))
    }

    /// Assigns to this value the error of a file that cannot be opened or recognised; errors inside a file keep their location.
    pub(super) fn blame(self, mut error: Error) -> Error {
        error.more = std::mem::take(&mut error.more).into_iter().map(|error| self.blame(error)).collect();
        if error.at.line > 0 || !matches!(error.kind, ErrorKind::Io | ErrorKind::Unsupported) {
            return error;
        }
        self.locate(error)
    }

    /// Assigns to this value an error of a file that this value is the reason of.
    pub(super) fn locate(self, error: Error) -> Error {
        Error { message: format!("{}: {}", error.at, error.message), at: self.at(), ..error }
    }

    fn found(self) -> String {
        match self.item.get_ref() {
            DeValue::String(text) if text.chars().count() > 40 => "a long string".to_owned(),
            DeValue::String(text) => format!("{text:?}"),
            DeValue::Integer(number) => number.to_string(),
            DeValue::Float(number) => number.to_string(),
            DeValue::Boolean(truth) => truth.to_string(),
            DeValue::Datetime(_) => "a date".to_owned(),
            DeValue::Array(items) => format!("a list of {}", crate::plural::counted(items.len(), "value")),
            DeValue::Table(_) => "a table".to_owned(),
        }
    }

    pub(super) fn is_number(self) -> bool {
        matches!(self.item.get_ref(), DeValue::Integer(_) | DeValue::Float(_))
    }

    pub(super) fn is_table(self) -> bool {
        matches!(self.item.get_ref(), DeValue::Table(_))
    }

    pub(super) fn is_list(self) -> bool {
        matches!(self.item.get_ref(), DeValue::Array(_))
    }

    pub(super) fn as_text(self) -> Option<&'a str> {
        match self.item.get_ref() {
            DeValue::String(text) => Some(text),
            _ => None,
        }
    }

    fn as_number(self) -> Option<f64> {
        match self.item.get_ref() {
            DeValue::Integer(number) if number.radix() == 10 => number.as_str().parse().ok(),
            DeValue::Integer(number) => {
                i64::from_str_radix(number.as_str(), number.radix()).ok().map(|number| number as f64)
            }
            DeValue::Float(number) => number.as_str().parse().ok(),
            _ => None,
        }
    }

    /// A finite number that satisfies `ok`.
    pub(super) fn number_where(self, expected: &str, ok: impl Fn(f64) -> bool) -> Result<f64> {
        match self.as_number() {
            Some(number) if number.is_finite() && ok(number) => Ok(number),
            Some(number) if number.is_infinite() && ok(number) => {
                Err(self.wrong(&format!("{expected}, and finite")))
            }
            _ => Err(self.wrong(expected)),
        }
    }

    /// A finite number.
    pub(super) fn number(self) -> Result<f64> {
        self.number_where("a finite number", f64::is_finite)
    }

    /// A finite number > 0.
    pub(super) fn positive(self) -> Result<f64> {
        self.number_where("a number greater than 0", |number| number > 0.0)
    }

    /// A finite number ≥ 0.
    pub(super) fn not_negative(self) -> Result<f64> {
        self.number_where("a number of at least 0", |number| number >= 0.0)
    }

    /// A number that is finite as `f32` and satisfies `ok`.
    pub(super) fn single_where(self, expected: &str, ok: impl Fn(f32) -> bool) -> Result<f32> {
        let number = self.number_where(expected, |number| ok(number as f32))? as f32;
        if number.is_finite() {
            return Ok(number);
        }
        Err(self.wrong(&format!("{expected}, and at most {:e}", f32::MAX)))
    }

    /// A number that is finite as `f32`.
    pub(super) fn single(self) -> Result<f32> {
        self.single_where("a finite number", f32::is_finite)
    }

    /// A whole number from `low` to `high`.
    pub(super) fn integer(self, low: u64, high: u64) -> Result<u64> {
        let found = match self.item.get_ref() {
            DeValue::Integer(number) => u64::from_str_radix(number.as_str(), number.radix()).ok(),
            _ => None,
        };
        found.filter(|number| (low..=high).contains(number)).ok_or_else(|| {
            self.wrong(&match high {
                u64::MAX => format!("a whole number of at least {low}"),
                _ => format!("a whole number from {low} to {high}"),
            })
        })
    }

    pub(super) fn boolean(self) -> Result<bool> {
        match self.item.get_ref() {
            DeValue::Boolean(truth) => Ok(*truth),
            _ => Err(self.wrong("true or false")),
        }
    }

    /// A non-empty string.
    pub(super) fn text(self, expected: &str) -> Result<&'a str> {
        self.as_text().filter(|text| !text.is_empty()).ok_or_else(|| self.wrong(expected))
    }

    /// A word of a fixed set.
    pub(super) fn choice<T: Copy>(self, choices: &[(&str, T)]) -> Result<T> {
        let words = || choices.iter().map(|&(word, _)| word);
        let expected = || words().map(|word| format!("{word:?}")).collect::<Vec<_>>().join(", ");
        let word = self.as_text().ok_or_else(|| self.wrong(&format!("one of {}", expected())))?;
        choices.iter().find(|choice| choice.0 == word).map(|choice| choice.1).ok_or_else(|| {
            let error = self.wrong(&format!("one of {}", expected()));
            let known: Vec<&str> = words().collect();
            match (synonyms::choice(word, &known), nearest(word, words())) {
                (Some(hint), _) => error.hint(hint),
                (None, Some(meant)) => error.hint(format!("did you mean {meant:?}?")),
                (None, None) => error,
            }
        })
    }

    /// The values of a list.
    pub(super) fn list(self, expected: &str) -> Result<impl ExactSizeIterator<Item = Value<'a>>> {
        let DeValue::Array(items) = self.item.get_ref() else { return Err(self.wrong(expected)) };
        Ok(items.iter().map(move |item| Value { item, ..self }))
    }

    /// The values of a list of length `N`.
    pub(super) fn list_of<const N: usize>(self, expected: &str) -> Result<[Value<'a>; N]> {
        let items: Vec<Value<'a>> = self.list(expected)?.take(N + 1).collect();
        items.try_into().map_err(|_| self.wrong(expected))
    }

    /// `N` finite numbers.
    pub(super) fn numbers<const N: usize>(self, expected: &str) -> Result<[f64; N]> {
        let items = self.list_of::<N>(expected)?;
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = item.number()?;
        }
        Ok(numbers)
    }

    /// `N` numbers that are finite as `f32`.
    pub(super) fn singles<const N: usize>(self, expected: &str) -> Result<[f32; N]> {
        let items = self.list_of::<N>(expected)?;
        let mut numbers = [0.0; N];
        for (number, item) in numbers.iter_mut().zip(items) {
            *number = item.single()?;
        }
        Ok(numbers)
    }

    /// A point or vector.
    pub(super) fn vector(self) -> Result<DVec3> {
        self.numbers("three numbers, [x, y, z]").map(DVec3::from_array)
    }

    /// A vector of non-zero length.
    pub(super) fn direction(self) -> Result<DVec3> {
        let vector = self.vector()?;
        if vector.length_squared() > 0.0 && vector.length_squared().is_finite() {
            Ok(vector)
        } else {
            Err(self.error(format!("`{}` has no direction: its length is {}", self.key, vector.length())))
        }
    }

    /// A table, called `title` in messages.
    pub(super) fn table(self, title: impl Into<String>) -> Result<Table<'a>> {
        let DeValue::Table(map) = self.item.get_ref() else { return Err(self.wrong("a table")) };
        Ok(Table::new(self.document, self.item.span().start, title.into(), map))
    }

    /// The tables of an array `[[key]]`; anything else is recorded as an error.
    pub(super) fn tables(self) -> impl Iterator<Item = Table<'a>> {
        let remedy = format!("write [[{}]], with two brackets, for each of them", self.key);
        let items = self.list("an array of tables").map_err(|error| error.hint(remedy));
        let items = items.map(Some).unwrap_or_else(|error| self.noting(Err(error), None));
        let tables = items.into_iter().flatten().map(|item| {
            let table = item.table(format!("[[{}]]", item.key));
            item.noting(table.map(Some), None)
        });
        tables.flatten().take_while(move |_| !self.document.is_full())
    }

    /// The entries of a table whose keys are names.
    pub(super) fn named(self, title: &str) -> impl Iterator<Item = Value<'a>> {
        let table = self.noting(self.table(title).map(Some), None);
        let entries = table.into_iter().flat_map(|table| table.entries().collect::<Vec<_>>());
        entries.take_while(move |_| !self.document.is_full())
    }
}

/// A direction of unit length. One that has it already, to single precision, stays as it is.
pub(super) fn unit(value: Value<'_>) -> Result<DVec3> {
    let direction = value.direction()?;
    let is_single = direction == direction.as_vec3().as_dvec3();
    Ok(if is_single && (direction.length_squared() - 1.0).abs() < 1e-6 {
        direction
    } else {
        direction.normalize()
    })
}
