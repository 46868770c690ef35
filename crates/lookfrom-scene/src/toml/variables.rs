//! The variables of a scene: those of each file, and values that replace them from outside.

use std::cell::Cell;
use std::collections::BTreeMap;
use std::path::Path;

use ::toml::Spanned;
use ::toml::de::{DeTable, DeValue};

use super::document::Document;
use super::evaluate::Allowance;
use super::quantity::{Quantity, Replacement};
use super::scope::Scope;
use super::value::Value;
use crate::error::{Error, ErrorKind, Location};
use crate::files::LoadContext;
use crate::suggest::nearest;

/// The table of variables.
pub(super) const VARIABLES: &str = "variables";

/// The most names that a message lists.
const MOST_LISTED: usize = 12;

/// Values from outside: texts of their own, by name.
pub(super) fn given(context: &LoadContext<'_>) -> BTreeMap<String, Document> {
    let whole = |name: &str| Location::file(Path::new(&format!("define {name}")));
    let values = context.variables.values.iter();
    values.map(|(name, text)| (name.clone(), Document::new(whole(name), text.clone()))).collect()
}

/// The variables of a scene so far.
pub(super) struct Variables<'g> {
    pub(super) given: BTreeMap<&'g str, Given<'g>>,
    /// The values of the open files, the outermost first; `None` for a variable without a valid one.
    pub(super) open: Vec<BTreeMap<String, Option<Quantity>>>,
    /// All variables that any file has, with their values in short.
    all: BTreeMap<String, String>,
    /// In seconds.
    pub(super) now: f64,
    pub(super) fps: f64,
    pub(super) allowance: Allowance,
    /// As [`Contents::duration`](crate::contents::Contents::duration).
    duration: Cell<Option<f64>>,
}

/// A value from outside: TOML, or else the text itself.
pub(super) struct Given<'g> {
    pub(super) document: &'g Document,
    pub(super) item: Spanned<DeValue<'g>>,
}

impl<'g> Given<'g> {
    fn new(document: &'g Document) -> Self {
        let text = document.text();
        let as_text = |_| Spanned::new(0..text.len(), DeValue::String(text.into()));
        Self { document, item: DeValue::parse(text).unwrap_or_else(as_text) }
    }
}

impl<'g> Variables<'g> {
    pub(super) fn new(given: &'g BTreeMap<String, Document>, context: &LoadContext<'_>) -> Self {
        Self {
            given: given.iter().map(|(name, document)| (name.as_str(), Given::new(document))).collect(),
            open: Vec::new(),
            all: BTreeMap::new(),
            now: context.import.at.unwrap_or(0.0),
            fps: context.variables.fps,
            allowance: Allowance::default(),
            duration: Cell::new(None),
        }
    }

    /// Evaluates the variables of a file, and all that is written with them: the values that [`replace`](super::scope::replace) puts there.
    /// `knows_all` unless the file has variables that cannot be read. To be followed by [`close`](Self::close) after all that
    /// the file imports.
    pub(super) fn open(
        &mut self,
        document: &Document,
        root: &DeTable<'_>,
        knows_all: bool,
    ) -> Vec<Option<Replacement>> {
        let empty = DeTable::new();
        let table = match root.get(VARIABLES).map(|item| (item, item.get_ref())) {
            None => &empty,
            Some((_, DeValue::Table(table))) => table,
            Some((item, _)) => {
                let value = Value { document, key: VARIABLES, item };
                value.note(value.wrong("a table of names and values"));
                &empty
            }
        };
        let (own, replacements) = Scope::new(self, document, table, knows_all).evaluate(root);
        self.open.push(own);
        for key in table.keys() {
            let name: &str = key.get_ref();
            let value = self.open.iter().find_map(|file| file.get(name)).cloned().flatten();
            let in_short = value.map_or(String::new(), |value| value.in_short());
            self.all.entry(name.to_owned()).or_insert(in_short);
        }
        replacements
    }

    /// Forgets the variables of the file that was opened last.
    pub(super) fn close(&mut self) {
        self.open.pop();
    }

    /// The errors of values from outside; where all names of the scene are known, also for those that it does not have.
    pub(super) fn errors(&self, knows_all: bool) -> Vec<Error> {
        let mut errors: Vec<Error> =
            self.given.values().flat_map(|given| given.document.errors(Vec::new())).collect();
        let strangers = self.given.keys().filter(|name| knows_all && !self.all.contains_key(**name));
        errors.extend(strangers.map(|name| {
            let message = format!("the scene has no variable `{name}`");
            let known = || self.all.keys().map(String::as_str);
            Error::new(ErrorKind::Request, &Location::default(), message).hint(match nearest(name, known()) {
                Some(meant) => format!("did you mean `{meant}`?"),
                None if self.all.is_empty() => {
                    format!("give it one: a table [variables] with a line `{name} = 1`")
                }
                None => format!("it has: {}", listed(known())),
            })
        }));
        errors
    }

    /// Takes note of a value that changes up to a time in seconds.
    pub(super) fn changes_until(&self, time: f64) {
        let before = self.duration.get().unwrap_or(0.0);
        self.duration.set(Some(before.max(time)));
    }

    /// The time up to which values that were evaluated change.
    pub(super) fn duration(&self) -> Option<f64> {
        self.duration.get()
    }

    /// All variables that any file has, with their values in short.
    pub(super) fn into_all(self) -> Vec<(String, String)> {
        self.all.into_iter().collect()
    }
}

/// The first of many names.
pub(super) fn listed<'a>(names: impl Iterator<Item = &'a str>) -> String {
    let mut some: Vec<&str> = names.take(MOST_LISTED + 1).collect();
    if some.len() > MOST_LISTED {
        some[MOST_LISTED] = "…";
    }
    some.join(", ")
}
