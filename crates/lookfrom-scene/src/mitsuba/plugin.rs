//! Plugins as they are written: a class, a type, and properties with their locations.
//!
//! What a plugin is asked for counts as used; [`Plugin::warn_unused`] tells of the rest.

use std::cell::Cell;
use std::collections::HashMap;
use std::rc::Rc;

use glam::{DMat4, DVec3};

use crate::error::{Error, ErrorKind, Location, Result};
use crate::files::LoadContext;
use crate::spectrum::Curve;
use crate::suggest::nearest;

/// Types that Mitsuba has and this program does not, which are no slips for others.
const MISSING: &[&str] = &["circular", "directionalarea", "ellipsoids", "volume"];

/// Plugins by their `id`.
pub(super) type Ids = HashMap<String, Rc<Plugin>>;

/// An element with a type: a shape, a BSDF, a sensor, …
#[derive(Debug)]
pub(super) struct Plugin {
    /// Its element: `shape`, `bsdf`, …
    pub(super) class: String,
    /// Its type: `sphere`, `diffuse`, …
    pub(super) kind: String,
    /// Its name for references.
    pub(super) id: Option<String>,
    /// The location of its type.
    pub(super) at: Location,
    /// Its properties in the order of the file; parts without a name have an empty one.
    pub(super) properties: Vec<Property>,
    /// Whether anything was asked for.
    is_read: Cell<bool>,
}

/// A property of a plugin.
#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The location of its value.
    pub(super) at: Location,
    pub(super) value: Value,
    is_used: Cell<bool>,
}

/// A value of a property.
#[derive(Debug)]
pub(super) enum Value {
    Float(f64),
    Integer(i64),
    Boolean(bool),
    String(String),
    Vector(DVec3),
    /// Linear Rec. 709.
    Color([f32; 3]),
    /// A spectrum. A constant one is a grey surface, but light of equal energy, which is not quite white.
    Curve(Curve),
    Transform(DMat4),
    Plugin(Rc<Plugin>),
    /// The id of a plugin.
    Reference(String),
}

impl Property {
    pub(super) fn new(name: impl Into<String>, at: Location, value: Value) -> Self {
        Self { name: name.into(), at, value, is_used: Cell::new(false) }
    }

    /// The error for a value of another kind or range than `expected`.
    pub(super) fn wrong(&self, expected: &str) -> Error {
        Error::invalid(&self.at, format!("`{}` has to be {expected}", self.name))
    }

    /// The plugin that is written or referred to here; `None` for another value.
    ///
    /// # Errors
    /// `Invalid` if there is no plugin with this id.
    pub(super) fn plugin(&self, ids: &Ids) -> Result<Option<Rc<Plugin>>> {
        match &self.value {
            Value::Plugin(plugin) => Ok(Some(plugin.clone())),
            Value::Reference(id) => match ids.get(id) {
                Some(plugin) => Ok(Some(plugin.clone())),
                None => Err(unknown(&self.at, "id", id, ids.keys().map(String::as_str))),
            },
            _ => Ok(None),
        }
    }
}

/// The error for an unknown word, with the most similar known one.
pub(super) fn unknown<'a>(
    at: &Location,
    what: &str,
    word: &str,
    known: impl Iterator<Item = &'a str> + Clone,
) -> Error {
    let error = Error::invalid(at, format!("{word:?} is not a known {what}"));
    if let Some(meant) = nearest(word, known.clone()) {
        return error.hint(format!("did you mean {meant:?}?"));
    }
    let mut known: Vec<&str> = known.collect();
    known.sort_unstable();
    known.truncate(20);
    if known.is_empty() { error } else { error.hint(format!("there are: {}", known.join(", "))) }
}

impl Plugin {
    pub(super) fn new(
        class: &str,
        kind: String,
        id: Option<String>,
        at: Location,
        properties: Vec<Property>,
    ) -> Self {
        Self { class: class.to_owned(), kind, id, at, properties, is_read: Cell::new(false) }
    }

    /// Its class and type, for messages.
    pub(super) fn title(&self) -> String {
        format!("{} {:?}", self.class, self.kind)
    }

    /// The error for a type that has no counterpart here.
    pub(super) fn unsupported(&self, known: &[&str]) -> Error {
        let message = format!("the {} is not supported", self.title());
        let error = Error::new(ErrorKind::Unsupported, &self.at, message);
        match nearest(&self.kind, known.iter().chain(MISSING).copied()) {
            Some(meant) if !MISSING.contains(&meant) => error.hint(format!("did you mean {meant:?}?")),
            _ => error.hint(format!("there are: {}", known.join(", "))),
        }
    }

    /// The property with this name, which counts as used.
    pub(super) fn find(&self, name: &str) -> Option<&Property> {
        self.is_read.set(true);
        let found = self.properties.iter().find(|property| property.name == name)?;
        found.is_used.set(true);
        Some(found)
    }

    /// Lets properties count as used that cannot change a picture here.
    pub(super) fn ignore(&self, names: &[&str]) {
        for name in names {
            self.find(name);
        }
    }

    /// Its properties that have not been used yet.
    pub(super) fn unused(&self) -> impl Iterator<Item = &Property> {
        self.properties.iter().filter(|property| !property.is_used.get())
    }

    /// The plugins of a class among its properties that have not been used yet, with their names.
    pub(super) fn parts(&self, class: &str, ids: &Ids) -> Result<Vec<(&Property, Rc<Plugin>)>> {
        self.is_read.set(true);
        let mut parts = Vec::new();
        for property in self.unused() {
            if let Some(plugin) = property.plugin(ids)?.filter(|plugin| plugin.class == class) {
                property.is_used.set(true);
                parts.push((property, plugin));
            }
        }
        Ok(parts)
    }

    /// The first plugin of a class among its properties, which does not count as used.
    pub(super) fn peek(&self, class: &str, ids: &Ids) -> Result<Option<Rc<Self>>> {
        for property in &self.properties {
            if let Some(plugin) = property.plugin(ids)?.filter(|plugin| plugin.class == class) {
                return Ok(Some(plugin));
            }
        }
        Ok(None)
    }

    /// The only plugin of a class among its properties.
    ///
    /// # Errors
    /// `Invalid` if there are several.
    pub(super) fn part(&self, class: &str, ids: &Ids) -> Result<Option<Rc<Plugin>>> {
        let parts = self.parts(class, ids)?;
        match &parts[..] {
            [] => Ok(None),
            [(_, plugin)] => Ok(Some(plugin.clone())),
            [_, (second, _), ..] => {
                let message = format!("the {} has more than one {class}", self.title());
                Err(Error::invalid(&second.at, message).hint("take all but one out"))
            }
        }
    }

    /// Both plugins of a class among its properties.
    ///
    /// # Errors
    /// `Invalid` if there are not two.
    pub(super) fn two_parts(&self, class: &str, ids: &Ids) -> Result<[Rc<Plugin>; 2]> {
        match &self.parts(class, ids)?[..] {
            [(_, first), (_, second)] => Ok([first.clone(), second.clone()]),
            parts => {
                let message = format!("a {} has two {class}s in it, this one has {}", self.kind, parts.len());
                Err(Error::invalid(&self.at, message))
            }
        }
    }

    pub(super) fn float_or_none(&self, name: &str) -> Result<Option<f64>> {
        let Some(property) = self.find(name) else { return Ok(None) };
        match property.value {
            Value::Float(value) => Ok(Some(value)),
            Value::Integer(value) => Ok(Some(value as f64)),
            _ => Err(property.wrong("a number: <float>")),
        }
    }

    pub(super) fn float(&self, name: &str, default: f64) -> Result<f64> {
        Ok(self.float_or_none(name)?.unwrap_or(default))
    }

    /// A number for which `holds`, `expected` in words.
    pub(super) fn float_where(
        &self,
        name: &str,
        default: f64,
        expected: &str,
        holds: impl Fn(f64) -> bool,
    ) -> Result<f64> {
        let value = self.float(name, default)?;
        if holds(value) { Ok(value) } else { Err(self.refuse(name, &format!("{expected}, found {value}"))) }
    }

    pub(super) fn positive(&self, name: &str, default: f64) -> Result<f64> {
        self.float_where(name, default, "a number greater than 0", |value| value > 0.0)
    }

    pub(super) fn integer(&self, name: &str, default: i64, least: i64, most: i64) -> Result<i64> {
        let value = match self.find(name) {
            None => default,
            Some(Property { value: Value::Integer(value), .. }) => *value,
            Some(property) => return Err(property.wrong("a whole number: <integer>")),
        };
        if (least..=most).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(name, &format!("a whole number from {least} to {most}, found {value}")))
    }

    pub(super) fn boolean(&self, name: &str, default: bool) -> Result<bool> {
        match self.find(name) {
            None => Ok(default),
            Some(Property { value: Value::Boolean(value), .. }) => Ok(*value),
            Some(property) => Err(property.wrong("true or false: <boolean>")),
        }
    }

    pub(super) fn string(&self, name: &str) -> Result<Option<&str>> {
        match self.find(name) {
            None => Ok(None),
            Some(Property { value: Value::String(value), .. }) => Ok(Some(value)),
            Some(property) => Err(property.wrong("a text: <string>")),
        }
    }

    /// One of several words.
    pub(super) fn choice<T: Copy>(&self, name: &str, default: T, words: &[(&str, T)]) -> Result<T> {
        let Some(written) = self.string(name)? else { return Ok(default) };
        match words.iter().find(|(word, _)| *word == written) {
            Some((_, value)) => Ok(*value),
            None => {
                let at = self.find(name).map_or(&self.at, |property| &property.at);
                Err(unknown(at, &format!("`{name}`"), written, words.iter().map(|(word, _)| *word)))
            }
        }
    }

    pub(super) fn vector(&self, name: &str) -> Result<Option<DVec3>> {
        match self.find(name) {
            None => Ok(None),
            Some(Property { value: Value::Vector(value), .. }) => Ok(Some(*value)),
            Some(property) => Err(property.wrong("three numbers: <point> or <vector>")),
        }
    }

    /// A transform; the identity if there is none.
    pub(super) fn transform(&self, name: &str) -> Result<DMat4> {
        match self.find(name) {
            None => Ok(DMat4::IDENTITY),
            Some(Property { value: Value::Transform(value), .. }) => Ok(*value),
            Some(property) => Err(property.wrong("a <transform>")),
        }
    }

    /// `to_world`, which has to be invertible.
    pub(super) fn to_world(&self) -> Result<DMat4> {
        let matrix = self.transform("to_world")?;
        let determinant = matrix.determinant();
        if matrix.is_finite() && matrix.inverse().is_finite() && determinant != 0.0 {
            return Ok(matrix);
        }
        Err(self.refuse("to_world", "a transform that can be inverted"))
    }

    /// The error for the value of a property.
    pub(super) fn refuse(&self, name: &str, expected: &str) -> Error {
        match self.properties.iter().find(|property| property.name == name) {
            Some(property) => property.wrong(expected),
            None => {
                Error::invalid(&self.at, format!("`{name}` of the {} has to be {expected}", self.title()))
            }
        }
    }

    /// Warns of properties that were not used, here and in all parts. Plugins that nothing uses have no effect in Mitsuba, either.
    pub(super) fn warn_unused(&self, context: &mut LoadContext<'_>) {
        for property in &self.properties {
            if self.is_read.get() && !property.is_used.get() {
                let what = match (&property.value, &*property.name) {
                    (Value::Plugin(plugin), "") => plugin.title(),
                    (Value::Reference(id), "") => format!("reference to {id:?}"),
                    (_, name) => format!("`{name}`"),
                };
                context.warn(&property.at, format!("the {what} of the {} has no effect here", self.title()));
            }
            if let Value::Plugin(plugin) = &property.value {
                plugin.warn_unused(context);
            }
        }
    }
}
