//! A TOML table: required, optional and unknown keys.

use std::cell::RefCell;
use std::collections::BTreeSet;

use ::toml::de::{DeTable, DeValue};

use super::document::Document;
use super::synonyms;
use super::value::Value;
use super::vocabulary::SETTINGS;
use crate::error::{Error, Location, Result};
use crate::suggest::nearest;

/// The name of the outermost table in messages.
pub(super) const SCENE: &str = "a scene";

/// Types of an item, with the keys of each.
pub(super) type Kinds = &'static [(&'static str, &'static [&'static str])];

/// Keys that several types have, in groups.
pub(super) type Groups = &'static [&'static [&'static str]];

/// A table whose keys are looked up by name. Errors are recorded and values are replaced by placeholders, so that one run
/// finds all errors; the result is valid only if none was recorded.
#[derive(Clone)]
pub(super) struct Table<'a> {
    document: &'a Document,
    offset: usize,
    title: String,
    map: &'a DeTable<'a>,
    /// The keys whose values are invalid or missing, so far.
    wrong: RefCell<BTreeSet<String>>,
    /// The keys that were suggested for unknown ones.
    meant: RefCell<Vec<&'static str>>,
}

impl<'a> Table<'a> {
    /// A table at a byte offset, called `title` in messages.
    pub(super) fn new(document: &'a Document, offset: usize, title: String, map: &'a DeTable<'a>) -> Self {
        Self { document, offset, title, map, wrong: RefCell::default(), meant: RefCell::default() }
    }

    pub(super) fn at(&self) -> Location {
        self.document.location(self.offset)
    }

    /// An error about the table as a whole.
    pub(super) fn error(&self, message: impl std::fmt::Display) -> Error {
        Error::invalid(&self.at(), format!("{}: {message}", self.title))
    }

    /// An error about the value of a key.
    pub(super) fn error_at(&self, key: &str, message: impl Into<String>) -> Error {
        let at = self.find(key).map_or_else(|| self.at(), Value::at);
        Error::invalid(&at, message)
    }

    /// Records an error about the table as a whole.
    pub(super) fn note(&self, error: Error) {
        self.document.note(self.offset, error);
    }

    /// Fails if one of these values has an error of its own, so that an error of their combination is not reported.
    pub(super) fn sound(&self, keys: &[&str]) -> Result<()> {
        let is_wrong = keys.iter().any(|&key| self.wrong.borrow().contains(key));
        if is_wrong { Err(Error::untold()) } else { Ok(()) }
    }

    fn are_wrong(&self, keys: &[&str]) {
        self.wrong.borrow_mut().extend(keys.iter().map(|&key| key.to_owned()));
    }

    /// Whether one of these keys was suggested for an unknown key.
    pub(super) fn means(&self, keys: &[&str]) -> bool {
        self.meant.borrow().iter().any(|meant| keys.contains(meant))
    }

    /// Records that these keys are missing, unless one of them was suggested for an unknown key.
    pub(super) fn lacks(&self, keys: &[&str], error: Error) {
        self.are_wrong(keys);
        if !self.means(keys) {
            self.note(error);
        }
    }

    /// Rejects every key that is in none of the groups: misspelt keys must not be ignored.
    pub(super) fn allow(&self, groups: &[&[&'static str]]) {
        let known = groups.concat();
        for key in self.map.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            let word: &str = key.get_ref();
            let message = format!("unknown key `{word}` in {}", self.title);
            let list = || format!("it may have: {}", distinct(&known).join(", "));
            let hint = self.suggestion(word, &known).unwrap_or_else(list);
            self.refuse(key.span().start, message, hint);
        }
    }

    /// A suggestion for an unknown key, as a question.
    fn suggestion(&self, word: &str, known: &[&'static str]) -> Option<String> {
        let known = &self.absent(known);
        let ask = |keys: &[&'static str]| {
            self.assume(keys);
            format!("did you mean `{}`?", keys.join("` and `"))
        };
        let synonyms = synonyms::keys(word, known);
        if !synonyms.is_empty() {
            return Some(ask(synonyms));
        }
        // Settings are often written in the wrong table.
        let is_setting = self.title == SCENE || SETTINGS.iter().any(|(title, _)| *title == self.title);
        let others = || SETTINGS.iter().filter(|(title, _)| is_setting && *title != self.title);
        if let Some((title, _)) = others().find(|(_, keys)| keys.contains(&word)) {
            return Some(format!("`{word}` belongs in {title}"));
        }
        if let Some(meant) = nearest(word, known.iter().copied()) {
            return Some(ask(&[meant]));
        }
        others().find_map(|(title, keys)| match synonyms::keys(word, keys) {
            [] => None,
            meant => Some(format!("did you mean `{}` in {title}?", meant.join("` and `"))),
        })
    }

    /// Keys that may still be added: those that the table does not have yet, and shapes and lights, which may be
    /// several. No other can be meant by an unknown one.
    fn absent(&self, keys: &[&'static str]) -> Vec<&'static str> {
        let is_open = |key: &str| match self.map.get(key).map(::toml::Spanned::get_ref) {
            None => true,
            Some(DeValue::Array(_)) => self.title == SCENE,
            Some(_) => false,
        };
        keys.iter().copied().filter(|key| is_open(key)).collect()
    }

    /// Records these keys as suggestions.
    pub(super) fn assume(&self, keys: &[&'static str]) {
        self.are_wrong(keys);
        self.meant.borrow_mut().extend(keys);
    }

    fn refuse(&self, offset: usize, message: String, hint: String) {
        // Keys are checked against all those of a type first, and then against those that may be combined.
        if !self.document.is_noted(offset) {
            let error = Error::invalid(&self.document.location(offset), message).hint(hint);
            self.document.note(offset, error);
        }
    }

    /// The requested type, or else the default one. Rejects every key that the type does not have, naming the types that
    /// have it. `None` for an unknown type: the error is recorded.
    pub(super) fn kind(
        &self,
        kinds: Kinds,
        default: Option<&'static str>,
        common: impl Fn(&'static str) -> Groups,
    ) -> Option<&'static str> {
        let words: Vec<(&str, &'static str)> = kinds.iter().map(|&(word, _)| (word, word)).collect();
        let word = match (self.find("type"), default) {
            (None, Some(word)) => word,
            (Some(value), _) => value.noting(value.choice(&words).map(Some), None)?,
            (None, None) => {
                let error = self.error("`type` is missing").hint(format!("add `type = {:?}`", kinds[1].0));
                self.lacks(&["type"], error);
                return None;
            }
        };
        let keys_of = |word: &'static str| {
            let own = kinds.iter().find(|kind| kind.0 == word).map_or(&[][..], |kind| kind.1);
            [&["type"], own, &common(word).concat()].concat()
        };
        let known = keys_of(word);
        for key in self.map.keys().filter(|key| !known.contains(&key.get_ref().as_ref())) {
            let name: &str = key.get_ref();
            let others = kinds.iter().filter(|kind| keys_of(kind.0).contains(&name));
            let others: Vec<String> = others.map(|kind| format!("{:?}", kind.0)).collect();
            if others.is_empty() {
                continue;
            }
            let message = format!("{} of type {word:?} has no `{name}`", self.title);
            let elsewhere = format!("is for type = {}", others.join(" or "));
            let meant = synonyms::keys(name, &self.absent(&known));
            self.assume(meant);
            let hint = match meant {
                [] => format!("it {elsewhere}"),
                _ => format!("did you mean `{}`? `{name}` {elsewhere}", meant.join("` and `")),
            };
            self.refuse(key.span().start, message, hint);
        }
        self.allow(&[&known]);
        Some(word)
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    pub(super) fn find(&self, key: &str) -> Option<Value<'a>> {
        let (key, item) = self.map.get_key_value(key)?;
        Some(Value { document: self.document, key: key.get_ref(), item })
    }

    /// A required value, decoded, or a placeholder; `example` is a possible value.
    pub(super) fn need<T>(
        &self,
        key: &str,
        example: &str,
        stand_in: T,
        decode: impl FnOnce(Value<'a>) -> Result<T>,
    ) -> T {
        if self.has(key) {
            return self.or(key, stand_in, decode);
        }
        self.lacks(&[key], self.missing(key, example));
        stand_in
    }

    /// The error that a key is missing.
    pub(super) fn missing(&self, key: &str, example: &str) -> Error {
        self.error(format!("`{key}` is missing")).hint(format!("add `{key} = {example}`"))
    }

    /// A value, decoded, or a default if it is absent or invalid.
    pub(super) fn or<T>(&self, key: &str, default: T, decode: impl FnOnce(Value<'a>) -> Result<T>) -> T {
        let Some(value) = self.find(key) else { return default };
        let result = decode(value);
        if result.is_err() {
            self.are_wrong(&[key]);
        }
        value.noting(result, default)
    }

    /// A value, decoded, if it is present and valid.
    pub(super) fn maybe<T>(&self, key: &str, decode: impl FnOnce(Value<'a>) -> Result<T>) -> Option<T> {
        self.or(key, None, |value| decode(value).map(Some))
    }

    /// The first of these keys that is present; more than one is an error.
    pub(super) fn one_of(&self, keys: &[&str]) -> Option<Value<'a>> {
        let mut given = keys.iter().filter_map(|key| self.find(key));
        let first = given.next();
        if let (Some(one), Some(other)) = (first, given.next()) {
            let error = other.error(format!("{} has both `{}` and `{}`", self.title, one.key, other.key));
            self.are_wrong(keys);
            other.note(error.hint(format!("give one of {}", keys.join(", "))));
        }
        first
    }

    /// All entries of the table, in the order of their keys.
    pub(super) fn entries(&self) -> impl Iterator<Item = Value<'a>> {
        let document = self.document;
        self.map.iter().map(move |(key, item)| Value { document, key: key.get_ref(), item })
    }
}

/// The words, each once: groups of keys may have some in common.
fn distinct(words: &[&'static str]) -> Vec<&'static str> {
    let is_first = |(place, word): &(usize, &&'static str)| !words[..*place].contains(word);
    words.iter().enumerate().filter(is_first).map(|(_, word)| *word).collect()
}
