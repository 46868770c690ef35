//! The values of a file that are written with variables.
//!
//! A text that begins with `=` is an [expression], a table with `keyframes` a value that changes with
//! time. Before a file is decoded both are replaced by their values, so that no decoder knows of them.

use std::cell::RefCell;
use std::collections::BTreeMap;
use std::f64::consts::PI;
use std::slice::Iter;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};

use super::document::Document;
use super::evaluate::evaluate;
use super::expression::{self, Fault};
use super::keyframes::{self, KEYFRAMES};
use super::quantity::{MOST_EXACT, Quantity, Replacement};
use super::table::Table;
use super::value::Value;
use super::variables::{VARIABLES, Variables, listed};
use crate::error::{Error, Result};
use crate::suggest::nearest;

/// Names that every scene has.
const BUILT_IN: [&str; 5] = ["t", "frame", "pi", "true", "false"];

/// The definition of a variable.
#[derive(Clone, Copy)]
struct Definition<'a> {
    document: &'a Document,
    item: &'a Spanned<DeValue<'a>>,
}

/// The variables that a file can use.
pub(super) struct Scope<'a> {
    variables: &'a Variables<'a>,
    document: &'a Document,
    /// Variables that the file defines, and no file that imports it.
    own: BTreeMap<&'a str, Definition<'a>>,
    done: RefCell<BTreeMap<&'a str, Option<Quantity>>>,
    /// Variables whose values are being determined, each for the one before.
    pending: RefCell<Vec<&'a str>>,
    knows_all: bool,
}

impl<'a> Scope<'a> {
    pub(super) fn new(
        variables: &'a Variables<'a>,
        document: &'a Document,
        table: &'a DeTable<'a>,
        knows_all: bool,
    ) -> Self {
        let mut own = BTreeMap::new();
        for (key, item) in table {
            let name: &str = key.get_ref();
            let wrong = match name {
                _ if BUILT_IN.contains(&name) => format!("`{name}` cannot be defined: every scene has it"),
                _ if !expression::is_name(name) => {
                    format!("{name:?} cannot be a name; expected letters, digits and _, first no digit")
                }
                _ => {
                    let given = variables.given.get(name);
                    let here = Definition { document, item };
                    let definition = given
                        .map_or(here, |given| Definition { document: given.document, item: &given.item });
                    if !variables.open.iter().any(|file| file.contains_key(name)) {
                        own.insert(name, definition);
                    }
                    continue;
                }
            };
            let offset = key.span().start;
            document.note(offset, Error::invalid(&document.location(offset), wrong));
        }
        Self { variables, document, own, done: RefCell::default(), pending: RefCell::default(), knows_all }
    }

    /// The values of the file's variables, and all that is written with variables, in its order.
    pub(super) fn evaluate(
        self,
        root: &DeTable<'_>,
    ) -> (BTreeMap<String, Option<Quantity>>, Vec<Option<Replacement>>) {
        let names: Vec<&str> = self.own.keys().copied().collect();
        for name in names {
            // Errors are told where the variable is defined.
            let _ = self.defined(name, 0);
        }
        let mut replacements = Vec::new();
        for (_, item) in root.iter().filter(|(key, _)| key.get_ref() != VARIABLES) {
            self.evaluate_in(item, &mut replacements);
        }
        let done = self.done.into_inner().into_iter();
        (done.map(|(name, value)| (name.to_owned(), value)).collect(), replacements)
    }

    /// The value of a name in an expression, at a byte offset of it.
    fn named(&self, name: &str, at: usize) -> std::result::Result<Quantity, Fault> {
        match name {
            "t" | "frame" => {
                let Variables { now, fps, .. } = *self.variables;
                self.variables.changes_until(0.0);
                return Ok(Quantity::Number(if name == "t" { now } else { libm::round(now * fps) }));
            }
            "pi" => return Ok(Quantity::Number(PI)),
            "true" | "false" => return Ok(Quantity::Truth(name == "true")),
            _ => {}
        }
        if let Some(value) = self.variables.open.iter().find_map(|file| file.get(name)) {
            return value.clone().ok_or_else(Fault::default);
        }
        if let Some((&name, _)) = self.own.get_key_value(name) {
            return self.defined(name, at);
        }
        if !self.knows_all {
            return Err(Fault::default());
        }
        let outer = self.variables.open.iter().flat_map(|file| file.keys().map(String::as_str));
        let known: Vec<&str> = self.own.keys().copied().chain(outer).collect();
        Err(Fault::new(at, format!("there is no variable `{name}`")).hint(
            match nearest(name, known.iter().copied().chain(BUILT_IN)) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None if known.is_empty() => {
                    format!("give it a value: a table [variables] with a line `{name} = 1`")
                }
                None => format!("there are: {}", listed(known.into_iter())),
            },
        ))
    }

    /// The value of a variable of this file.
    fn defined(&self, name: &'a str, at: usize) -> std::result::Result<Quantity, Fault> {
        if let Some(value) = self.done.borrow().get(name) {
            return value.clone().ok_or_else(Fault::default);
        }
        let chain = self.pending.borrow().clone();
        if let Some(start) = chain.iter().position(|&other| other == name) {
            let chain: Vec<&str> = chain[start..].iter().copied().chain([name]).collect();
            let message = format!("`{name}` is defined by itself: {}", chain.join(" → "));
            return Err(Fault::new(at, message).hint("give one of them a value of its own"));
        }
        let Some(&Definition { document, item }) = self.own.get(name) else { return Err(Fault::default()) };
        self.pending.borrow_mut().push(name);
        let value = self.variables.allowance.deeper(at, || {
            let value = Value { document, key: name, item };
            Ok(self.quantity(value).map_err(|error| document.refuse(item.span().start, error)))
        });
        self.pending.borrow_mut().pop();
        let value = value?.ok();
        self.done.borrow_mut().insert(name, value.clone());
        value.ok_or_else(Fault::default)
    }

    /// Evaluates the expressions and keyframes in a value, in their order; `None` for one without a valid value, whose error
    /// is recorded.
    fn evaluate_in(&self, item: &Spanned<DeValue<'_>>, replacements: &mut Vec<Option<Replacement>>) {
        match item.get_ref() {
            value if is_calculated(value) => {
                let value = self.quantity(Value { document: self.document, key: "", item });
                let refuse = |error| self.document.refuse(item.span().start, error);
                replacements.push(value.map_err(refuse).ok().map(Replacement::new));
            }
            DeValue::Array(items) => items.iter().for_each(|item| self.evaluate_in(item, replacements)),
            DeValue::Table(entries) => {
                entries.values().for_each(|item| self.evaluate_in(item, replacements));
            }
            _ => {}
        }
    }

    /// The time in seconds, for a value that changes up to another one.
    pub(super) fn now(&self, changes_until: f64) -> f64 {
        self.variables.changes_until(changes_until);
        self.variables.now
    }

    /// The value of a value of TOML.
    pub(super) fn quantity(&self, value: Value<'_>) -> Result<Quantity> {
        let offset = value.item.span().start;
        let calculated = match value.item.get_ref() {
            DeValue::String(text) if text.starts_with('=') => {
                let expression = expression::parse(text, 1);
                let names = |name: &str, at: usize| self.named(name, at);
                expression.and_then(|expression| evaluate(&expression, &names, &self.variables.allowance))
            }
            DeValue::Table(map) if map.contains_key(KEYFRAMES) => {
                let table = Table::new(value.document, offset, KEYFRAMES.to_owned(), map);
                return keyframes::at_time(&table, self);
            }
            DeValue::String(text) => Ok(Quantity::Text(text.clone().into_owned())),
            DeValue::Boolean(truth) => Ok(Quantity::Truth(*truth)),
            DeValue::Integer(_) | DeValue::Float(_) => {
                let number = value.number()?;
                if number.abs() > MOST_EXACT && value.item.get_ref().is_integer() {
                    return Err(value
                        .wrong(&format!("a number of at most {MOST_EXACT}, as larger ones are not exact")));
                }
                Ok(Quantity::Number(number))
            }
            DeValue::Datetime(_) => {
                return Err(value.wrong("a number, a text, true, false, a list or a table"));
            }
            DeValue::Array(items) => {
                let items = items.iter().map(|item| self.quantity(Value { item, ..value }));
                Ok(Quantity::List(items.collect::<Result<_>>()?))
            }
            DeValue::Table(map) => {
                let entries = map.iter().map(|(key, item)| {
                    let key: &str = key.get_ref();
                    Ok((key.to_owned(), self.quantity(Value { key, item, ..value })?))
                });
                Ok(Quantity::Table(entries.collect::<Result<_>>()?))
            }
        };
        calculated
            .and_then(|quantity| self.variables.allowance.spend(quantity, 0))
            .map_err(|fault| located(value, fault))
    }
}

/// Takes the variables out of a file, and puts values in place of all that is written with them.
pub(super) fn replace<'r>(root: &mut DeTable<'r>, replacements: &'r [Option<Replacement>]) {
    root.remove(VARIABLES);
    let mut replacements = replacements.iter();
    root.iter_mut().for_each(|(_, item)| replace_in(item, &mut replacements));
}

fn replace_in<'r>(item: &mut Spanned<DeValue<'r>>, replacements: &mut Iter<'r, Option<Replacement>>) {
    if is_calculated(item.get_ref()) {
        if let Some(Some(replacement)) = replacements.next() {
            *item = replacement.as_toml(&item.span());
        }
        return;
    }
    match item.get_mut() {
        DeValue::Array(items) => items.iter_mut().for_each(|item| replace_in(item, replacements)),
        DeValue::Table(entries) => entries.iter_mut().for_each(|(_, item)| replace_in(item, replacements)),
        _ => {}
    }
}

/// Whether a value is not itself what is meant.
fn is_calculated(value: &DeValue<'_>) -> bool {
    match value {
        DeValue::String(text) => text.starts_with('='),
        DeValue::Table(map) => map.contains_key(KEYFRAMES),
        _ => false,
    }
}

/// The error of a text or value of a file.
fn located(value: Value<'_>, fault: Fault) -> Error {
    if fault.message.is_empty() {
        return Error::untold();
    }
    let span = value.item.span();
    let written = value.document.text().get(span.clone()).unwrap_or_default();
    // A text with escapes is not written as it is; then its beginning has to do.
    let inside = value.as_text().and_then(|text| written.find(text)).map_or(0, |start| start + fault.at);
    let error = Error::invalid(&value.document.location(span.start + inside), fault.message);
    match fault.hint {
        Some(hint) => error.hint(hint),
        None => error,
    }
}
