//! A TOML table: keys that must be there, may be there, or are unknown.

use ::toml::Spanned;
use ::toml::de::DeTable;

use super::value::{Document, Value};
use crate::error::{Error, Location, Result};
use crate::suggest::nearest;

/// The types of a thing, and the keys of each.
pub(super) type Kinds = &'static [(&'static str, &'static [&'static str])];

/// A table whose keys are looked up by name.
pub(super) struct Table<'a> {
    document: &'a Document,
    offset: usize,
    title: String,
    map: &'a DeTable<'a>,
}

impl<'a> Table<'a> {
    /// A table that begins at a byte, as `title` in messages.
    pub(super) fn new(document: &'a Document, offset: usize, title: String, map: &'a DeTable<'a>) -> Self {
        Self { document, offset, title, map }
    }

    pub(super) fn at(&self) -> Location {
        self.document.location(self.offset)
    }

    /// An error about the table as a whole.
    pub(super) fn error(&self, message: impl std::fmt::Display) -> Error {
        Error::invalid(&self.at(), format!("{}: {message}", self.title))
    }

    /// Refuses every key that is in none of the groups: a slip of the hand must not pass in silence.
    pub(super) fn allow(&self, groups: &[&[&'static str]]) -> Result<()> {
        let known = || groups.iter().copied().flatten().copied();
        let Some(key) = self.map.keys().find(|key| known().all(|word| word != key.get_ref().as_ref())) else {
            return Ok(());
        };
        let at = self.document.location(key.span().start);
        let error = Error::invalid(&at, format!("unknown key `{}` in {}", key.get_ref(), self.title));
        Err(match nearest(key.get_ref(), known()) {
            Some(meant) => error.hint(format!("did you mean `{meant}`?")),
            None => error.hint(format!("it may have: {}", known().collect::<Vec<_>>().join(", "))),
        })
    }

    /// The type that is asked for, or else the default one. Refuses every key that it does not have, and says so if another
    /// type has it.
    pub(super) fn kind(
        &self,
        kinds: Kinds,
        default: Option<&'static str>,
        common: impl Fn(&'static str) -> &'static [&'static str],
    ) -> Result<&'static str> {
        let words: Vec<(&str, &'static str)> = kinds.iter().map(|&(word, _)| (word, word)).collect();
        let word = match (self.find("type"), default) {
            (None, Some(word)) => word,
            _ => self.need("type", &format!("{:?}", kinds[1].0))?.choice(&words)?,
        };
        let has = |word: &'static str, key: &str| {
            let own = kinds.iter().find(|kind| kind.0 == word).map_or(&[][..], |kind| kind.1);
            own.iter().chain(common(word)).any(|&known| known == key)
        };
        for entry in self.entries() {
            let key = entry.key();
            let others = kinds.iter().filter(|kind| has(kind.0, key)).map(|kind| format!("{:?}", kind.0));
            let others: Vec<String> = others.collect();
            if !has(word, key) && !others.is_empty() {
                let at = self.key_at(key);
                return Err(Error::invalid(&at, format!("{} of type {word:?} has no `{key}`", self.title))
                    .hint(format!("it is for type = {}", others.join(" or "))));
            }
        }
        let own = kinds.iter().find(|kind| kind.0 == word).map_or(&[][..], |kind| kind.1);
        self.allow(&[&["type"], own, common(word)])?;
        Ok(word)
    }

    fn key_at(&self, key: &str) -> Location {
        let span = self.map.keys().find(|known| known.get_ref() == key).map(Spanned::span);
        self.document.location(span.map_or(self.offset, |span| span.start))
    }

    pub(super) fn has(&self, key: &str) -> bool {
        self.map.contains_key(key)
    }

    pub(super) fn find(&self, key: &str) -> Option<Value<'a>> {
        let (key, item) = self.map.get_key_value(key)?;
        Some(Value { document: self.document, key: key.get_ref(), item })
    }

    /// A value that has to be there; `example` shows how it could look.
    pub(super) fn need(&self, key: &str, example: &str) -> Result<Value<'a>> {
        self.find(key)
            .ok_or_else(|| self.error(format!("`{key}` is missing")).hint(format!("add `{key} = {example}`")))
    }

    /// A value decoded, or a default where it is not given.
    pub(super) fn or<T>(
        &self,
        key: &str,
        default: T,
        decode: impl FnOnce(Value<'a>) -> Result<T>,
    ) -> Result<T> {
        self.find(key).map_or(Ok(default), decode)
    }

    /// At most one of these keys may be given: which, if any.
    pub(super) fn one_of(&self, keys: &[&str]) -> Result<Option<Value<'a>>> {
        let mut given = keys.iter().filter_map(|key| self.find(key));
        let first = given.next();
        match (first, given.next()) {
            (Some(one), Some(other)) => Err(other
                .error(format!("{} has both `{}` and `{}`", self.title, one.key, other.key))
                .hint(format!("give one of {}", keys.join(", ")))),
            _ => Ok(first),
        }
    }

    /// All that is in the table, in the order of the names.
    pub(super) fn entries(&self) -> impl Iterator<Item = Value<'a>> {
        let document = self.document;
        self.map.iter().map(move |(key, item)| Value { document, key: key.get_ref(), item })
    }
}
