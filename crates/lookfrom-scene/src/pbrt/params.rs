//! Parameter lists of directives.
//!
//! A parameter is `"type name"` with a value or a list of values. A parameter whose type does not fit is an error that
//! names the types that do; parameters that no directive reads are warned of.

use std::borrow::Cow;
use std::cell::{Cell, RefCell};
use std::collections::HashSet;
use std::rc::Rc;

use glam::{DVec3, Vec2, Vec3};

use super::lexer::{Lexer, Token, parse_integer, parse_single};
use super::spectra::Space;
use super::text::Place;
use super::version3::new_kind;
use crate::error::{Error, Result};
use crate::files::LoadContext;
use crate::suggest::nearest;

/// Types of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ParameterType {
    Integer,
    Float,
    Point2,
    Vector2,
    Point3,
    Vector3,
    Normal,
    Bool,
    String,
    Rgb,
    Spectrum,
    Blackbody,
    Texture,
}

const KINDS: [(&str, ParameterType); 13] = [
    ("integer", ParameterType::Integer),
    ("float", ParameterType::Float),
    ("point2", ParameterType::Point2),
    ("vector2", ParameterType::Vector2),
    ("point3", ParameterType::Point3),
    ("vector3", ParameterType::Vector3),
    ("normal", ParameterType::Normal),
    ("bool", ParameterType::Bool),
    ("string", ParameterType::String),
    ("rgb", ParameterType::Rgb),
    ("spectrum", ParameterType::Spectrum),
    ("blackbody", ParameterType::Blackbody),
    ("texture", ParameterType::Texture),
];

/// Types of constant colours.
pub(super) const SPECTRA: &[ParameterType] =
    &[ParameterType::Rgb, ParameterType::Spectrum, ParameterType::Blackbody];

impl ParameterType {
    pub(super) fn word(self) -> &'static str {
        KINDS.iter().find(|entry| entry.1 == self).map_or("", |entry| entry.0)
    }

    /// The number of components of a value.
    fn numbers(self) -> usize {
        match self {
            Self::Point2 | Self::Vector2 => 2,
            Self::Point3 | Self::Vector3 | Self::Normal | Self::Rgb => 3,
            _ => 1,
        }
    }
}

/// The value of a parameter.
#[derive(Debug)]
pub(super) enum Values {
    Integers(Vec<i32>),
    Numbers(Vec<f32>),
    Truths(Vec<bool>),
    Strings(Vec<String>),
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Integers(values) => values.len(),
            Self::Numbers(values) => values.len(),
            Self::Truths(values) => values.len(),
            Self::Strings(values) => values.len(),
        }
    }
}

/// One parameter.
pub(super) struct Parameter {
    pub(super) kind: ParameterType,
    pub(super) name: String,
    pub(super) place: Place,
    pub(super) values: Values,
    /// The type that was written, if only pbrt-v3 has it.
    pub(super) old_kind: Option<&'static str>,
    /// The colour space of its rgb values, if it was fixed at its definition (in `Attribute`).
    pub(super) space: Cell<Option<Space>>,
    used: Cell<bool>,
}

impl Parameter {
    pub(super) fn new(kind: ParameterType, name: &str, place: Place, values: Values) -> Self {
        let (name, space, used) = (name.to_owned(), Cell::new(None), Cell::new(false));
        Self { kind, name, place, values, old_kind: None, space, used }
    }

    /// Its numbers; empty for values of other types.
    pub(super) fn numbers(&self) -> &[f32] {
        match &self.values {
            Values::Numbers(values) => values,
            _ => &[],
        }
    }

    /// Its strings; empty for values of other types.
    pub(super) fn strings(&self) -> &[String] {
        match &self.values {
            Values::Strings(values) => values,
            _ => &[],
        }
    }

    /// The error that its value is not as expected.
    pub(super) fn wrong(&self, expected: impl std::fmt::Display) -> Error {
        self.place.invalid(format!("\"{} {}\": expected {expected}", self.kind.word(), self.name))
    }

    /// Checks that there is at least one value and that all are complete.
    fn check_length(&self) -> Result<()> {
        let (count, each) = (self.values.len(), self.kind.numbers());
        // A spectrum's numbers come in pairs, which is checked by its reader.
        if count > 0 && count.is_multiple_of(each) {
            return Ok(());
        }
        Err(self.wrong(match each {
            1 => format!("a value, found {count}"),
            _ => format!("{each} numbers for each value, found {count}"),
        }))
    }

    fn single<'a, T>(&self, values: &'a [T]) -> Result<&'a [T]> {
        let each = self.kind.numbers();
        if values.len() == each {
            return Ok(values);
        }
        let word = if each == 1 { "one value".to_owned() } else { format!("{each} numbers") };
        Err(self.wrong(format!("{word}, found {}", values.len())))
    }
}

/// Reads the parameters that follow a directive.
pub(super) fn read(lexer: &mut Lexer<'_>) -> Result<Vec<Parameter>> {
    let mut parameters = Vec::new();
    while let Some(Token::Quoted(raw)) = lexer.peek()? {
        let start = lexer.here();
        lexer.token()?;
        let declaration = lexer.unescape(raw, start)?;
        let place = lexer.place(start);
        let mut words = declaration.split([' ', '\t']).filter(|word| !word.is_empty());
        let (Some(kind), Some(name), None) = (words.next(), words.next(), words.next()) else {
            let error = place.syntax(format!("expected a type and a name, found {declaration:?}"));
            return Err(error.hint("parameters are written as \"float radius\" 2"));
        };
        let (kind, old_kind) = kind_of(kind, name, &place)?;
        let values = values(lexer, kind)?;
        parameters.push(Parameter { old_kind, ..Parameter::new(kind, name, place, values) });
    }
    Ok(parameters)
}

/// The type with a name, and that name if only pbrt-v3 has it.
fn kind_of(word: &str, name: &str, place: &Place) -> Result<(ParameterType, Option<&'static str>)> {
    let named = |word: &str| KINDS.iter().find(|entry| entry.0 == word).map(|entry| entry.1);
    if let Some(kind) = named(word) {
        return Ok((kind, None));
    }
    if word == "normal3" {
        return Ok((ParameterType::Normal, None));
    }
    if let Some((old, new)) = new_kind(word, name)
        && let Some(kind) = named(new)
    {
        return Ok((kind, Some(old)));
    }
    let error = place.invalid(format!("{word:?} is not a type of parameters"));
    let words = || KINDS.iter().map(|entry| entry.0);
    Err(match nearest(word, words()) {
        Some(meant) => error.hint(format!("did you mean \"{meant} {name}\"?")),
        None => error.hint(format!("types are {}", words().collect::<Vec<_>>().join(", "))),
    })
}

/// A value, or a list of them in brackets.
fn values(lexer: &mut Lexer<'_>, kind: ParameterType) -> Result<Values> {
    let start = lexer.here();
    let is_list = lexer.peek()? == Some(Token::Open);
    if is_list {
        lexer.token()?;
    }
    let first = lexer.peek()?;
    let strings = match kind {
        ParameterType::String | ParameterType::Texture | ParameterType::Bool => true,
        // A spectrum is a name or file, or pairs of wavelength and value.
        ParameterType::Spectrum => matches!(first, Some(Token::Quoted(_))),
        _ => false,
    };
    match (is_list, strings) {
        (true, false) if kind == ParameterType::Integer => return Ok(Values::Integers(lexer.integers()?)),
        (true, false) => return Ok(Values::Numbers(lexer.singles()?)),
        _ => {}
    }
    let (mut truths, mut words, mut numbers) = (Vec::new(), Vec::new(), Vec::new());
    let mut integers = Vec::new();
    loop {
        let start = lexer.here();
        let token = lexer.token()?;
        match (token, kind) {
            (Some(Token::Close), _) if is_list => break,
            (Some(Token::Word(b"true") | Token::Quoted(b"true")), ParameterType::Bool) => truths.push(true),
            (Some(Token::Word(b"false") | Token::Quoted(b"false")), ParameterType::Bool) => {
                truths.push(false);
            }
            (Some(Token::Quoted(raw)), _) if strings && kind != ParameterType::Bool => {
                words.push(lexer.unescape(raw, start)?.into_owned());
            }
            (Some(Token::Word(word)), ParameterType::Integer) => {
                integers.push(parse_integer(word).ok_or_else(|| lexer.wrong(start, "a whole number"))?);
            }
            (Some(Token::Word(word)), _) if !strings => {
                numbers.push(parse_single(word).ok_or_else(|| lexer.wrong(start, "a number"))?);
            }
            _ => {
                return Err(lexer.wrong(
                    start,
                    match kind {
                        ParameterType::Bool => "true or false",
                        ParameterType::Integer => "a whole number",
                        _ if strings => "a quoted string",
                        _ => "a number",
                    },
                ));
            }
        }
        if !is_list {
            break;
        }
    }
    Ok(match kind {
        ParameterType::Bool => Values::Truths(truths),
        ParameterType::Integer => Values::Integers(integers),
        _ if strings => Values::Strings(words),
        _ if numbers.is_empty() => return Err(lexer.wrong(start, "a value")),
        _ => Values::Numbers(numbers),
    })
}

/// The parameters of a directive, with those that earlier `Attribute` directives add.
pub(super) struct Parameters {
    /// The directive, for messages: `Shape "sphere"`.
    pub(super) title: String,
    /// The location of the directive.
    pub(super) place: Place,
    /// The colour space of rgb values.
    pub(super) space: Space,
    own: Vec<Parameter>,
    inherited: Inherited,
    asked: RefCell<Vec<&'static str>>,
}

/// Parameters that `Attribute` directives have set: the last, and those before it, which states of the graphics share.
#[derive(Clone, Default)]
pub(super) struct Inherited(Option<Rc<(Parameter, Inherited)>>);

impl Inherited {
    pub(super) fn push(&mut self, parameter: Parameter) {
        let before = std::mem::take(self);
        self.0 = Some(Rc::new((parameter, before)));
    }

    /// From the last to the first.
    fn iter(&self) -> impl Iterator<Item = &Parameter> {
        let links = std::iter::successors(self.0.as_deref(), |(_, before)| before.0.as_deref());
        links.map(|(parameter, _)| parameter)
    }
}

impl Drop for Inherited {
    /// One link after the other: a recursion would be as deep as the list is long.
    fn drop(&mut self) {
        let mut next = self.0.take();
        while let Some((_, mut before)) = next.and_then(Rc::into_inner) {
            next = before.0.take();
        }
    }
}

impl Parameters {
    pub(super) fn new(
        title: String,
        place: Place,
        space: Space,
        own: Vec<Parameter>,
        inherited: &Inherited,
    ) -> Self {
        Self { title, place, space, own, inherited: inherited.clone(), asked: RefCell::default() }
    }

    /// The parameter with this name, if it has one of these types. The last one written counts.
    pub(super) fn find(&self, name: &'static str, kinds: &[ParameterType]) -> Result<Option<&Parameter>> {
        self.asked.borrow_mut().push(name);
        let mut misfit = None;
        for parameter in self.own.iter().rev().filter(|parameter| parameter.name == name) {
            if kinds.contains(&parameter.kind) {
                parameter.used.set(true);
                parameter.check_length()?;
                return Ok(Some(parameter));
            }
            misfit = Some(parameter);
        }
        if let Some(parameter) = misfit {
            let fitting: Vec<String> =
                kinds.iter().map(|kind| format!("\"{} {name}\"", kind.word())).collect();
            let message = format!("{} has no \"{} {name}\"", self.title, parameter.kind.word());
            return Err(parameter.place.invalid(message).hint(format!("write {}", fitting.join(" or "))));
        }
        let found = self.inherited.iter().find(|p| p.name == name && kinds.contains(&p.kind));
        found.map(|parameter| parameter.check_length().map(|()| parameter)).transpose()
    }

    /// Whether the parameter is present, with any type; it is not marked as read.
    pub(super) fn has(&self, name: &str) -> bool {
        self.own.iter().any(|parameter| parameter.name == name)
            || self.inherited.iter().any(|parameter| parameter.name == name)
    }

    /// The parameter with this name and type, if there is one; one of another type is not an error.
    pub(super) fn of_kind(&self, name: &'static str, kind: ParameterType) -> Result<Option<&Parameter>> {
        let there = |p: &Parameter| p.name == name && p.kind == kind;
        if self.own.iter().any(there) || self.inherited.iter().any(there) {
            self.find(name, &[kind])
        } else {
            self.asked.borrow_mut().push(name);
            Ok(None)
        }
    }

    /// Marks parameters that are known but have no effect here.
    pub(super) fn ignore(&self, names: &[&'static str]) {
        self.asked.borrow_mut().extend(names);
        self.own.iter().filter(|parameter| names.contains(&&*parameter.name)).for_each(|p| p.used.set(true));
    }

    pub(super) fn float_or_none(&self, name: &'static str) -> Result<Option<f32>> {
        let Some(parameter) = self.find(name, &[ParameterType::Float])? else { return Ok(None) };
        Ok(parameter.single(parameter.numbers())?.first().copied())
    }

    pub(super) fn float(&self, name: &'static str, default: f32) -> Result<f32> {
        Ok(self.float_or_none(name)?.unwrap_or(default))
    }

    /// A number that satisfies `ok`.
    pub(super) fn float_where(
        &self,
        name: &'static str,
        default: f32,
        expected: &str,
        ok: impl Fn(f32) -> bool,
    ) -> Result<f32> {
        let value = self.float(name, default)?;
        if ok(value) { Ok(value) } else { Err(self.refuse(name, &format!("{expected}, found {value}"))) }
    }

    /// A number greater than 0.
    pub(super) fn positive(&self, name: &'static str, default: f32) -> Result<f32> {
        self.float_where(name, default, "a number greater than 0", |value| value > 0.0)
    }

    /// The error that a parameter's value is not as expected.
    pub(super) fn refuse(&self, name: &str, expected: &str) -> Error {
        let own = self.own.iter().rev();
        let parameter = own.chain(self.inherited.iter()).find(|p| p.name == name);
        match parameter {
            Some(parameter) => parameter.wrong(expected),
            None => self.place.invalid(format!("{}: expected {expected} as {name:?}", self.title)),
        }
    }

    pub(super) fn integer_or_none(&self, name: &'static str) -> Result<Option<i32>> {
        let Some(parameter) = self.find(name, &[ParameterType::Integer])? else { return Ok(None) };
        let Values::Integers(values) = &parameter.values else { return Ok(None) };
        Ok(parameter.single(values)?.first().copied())
    }

    /// A whole number from `low` to `high`.
    pub(super) fn integer(&self, name: &'static str, default: i32, low: i32, high: i32) -> Result<i32> {
        let value = self.integer_or_none(name)?.unwrap_or(default);
        if (low..=high).contains(&value) {
            return Ok(value);
        }
        Err(self.refuse(
            name,
            &match high {
                i32::MAX => format!("a whole number of at least {low}, found {value}"),
                _ => format!("a whole number from {low} to {high}, found {value}"),
            },
        ))
    }

    pub(super) fn boolean(&self, name: &'static str, default: bool) -> Result<bool> {
        let Some(parameter) = self.find(name, &[ParameterType::Bool])? else { return Ok(default) };
        let Values::Truths(values) = &parameter.values else { return Ok(default) };
        Ok(parameter.single(values)?.first().copied().unwrap_or(default))
    }

    pub(super) fn string(&self, name: &'static str) -> Result<Option<&str>> {
        let Some(parameter) = self.find(name, &[ParameterType::String])? else { return Ok(None) };
        Ok(parameter.single(parameter.strings())?.first().map(String::as_str))
    }

    /// The file of `filename`; an empty name is none, as in pbrt.
    pub(super) fn file_name(&self) -> Result<Option<&str>> {
        Ok(self.string("filename")?.filter(|name| !name.is_empty()))
    }

    /// A word of a fixed set.
    pub(super) fn choice<T: Copy>(
        &self,
        name: &'static str,
        default: T,
        choices: &[(&'static str, T)],
    ) -> Result<T> {
        let Some(word) = self.string(name)? else { return Ok(default) };
        if let Some(choice) = choices.iter().find(|choice| choice.0 == word) {
            return Ok(choice.1);
        }
        let words = || choices.iter().map(|choice| choice.0);
        let quoted: Vec<String> = words().map(|word| format!("{word:?}")).collect();
        let error = self.refuse(name, &format!("one of {}, found {word:?}", quoted.join(", ")));
        Err(match nearest(word, words()) {
            Some(meant) => error.hint(format!("did you mean {meant:?}?")),
            None => error,
        })
    }

    /// All numbers of a list.
    pub(super) fn floats(&self, name: &'static str, kind: ParameterType) -> Result<Option<&[f32]>> {
        Ok(self.find(name, &[kind])?.map(Parameter::numbers))
    }

    /// One point or vector.
    pub(super) fn vector(&self, name: &'static str, kind: ParameterType, default: DVec3) -> Result<DVec3> {
        let Some(parameter) = self.find(name, &[kind])? else { return Ok(default) };
        Ok(match parameter.single(parameter.numbers())? {
            &[x, y, z] => Vec3::new(x, y, z).as_dvec3(),
            _ => default,
        })
    }

    /// A list of points, vectors or normals; empty if absent.
    pub(super) fn vectors(&self, name: &'static str, kind: ParameterType) -> Result<Vec<Vec3>> {
        let numbers = self.floats(name, kind)?.unwrap_or_default();
        Ok(numbers.chunks_exact(3).map(|v| Vec3::new(v[0], v[1], v[2])).collect())
    }

    /// A list of points in the plane; empty if absent.
    pub(super) fn points2(&self, name: &'static str) -> Result<Vec<Vec2>> {
        let numbers = self.floats(name, ParameterType::Point2)?.unwrap_or_default();
        Ok(numbers.chunks_exact(2).map(|v| Vec2::new(v[0], v[1])).collect())
    }

    /// A list of integers; empty if absent.
    pub(super) fn integers(&self, name: &'static str) -> Result<&[i32]> {
        Ok(match self.find(name, &[ParameterType::Integer])?.map(|parameter| &parameter.values) {
            Some(Values::Integers(values)) => values,
            _ => &[],
        })
    }

    /// The parameters themselves, without those that are inherited.
    pub(super) fn own_mut(&mut self) -> &mut Vec<Parameter> {
        &mut self.own
    }

    /// The parameters themselves, for later directives to inherit.
    pub(super) fn into_own(self) -> Vec<Parameter> {
        self.own
    }

    /// Warns of parameters that no directive reads.
    pub(super) fn finish(&self, context: &mut LoadContext<'_>) {
        let given: HashSet<&str> = self.own.iter().map(|parameter| &*parameter.name).collect();
        for parameter in self.own.iter().filter(|parameter| !parameter.used.get()) {
            let asked = self.asked.borrow();
            let mut names: Vec<&str> = asked.clone();
            names.sort_unstable();
            names.dedup();
            let meant: Cow<'_, str> = if names.contains(&&*parameter.name) {
                // Another parameter has the same name.
                "it is overridden by another one".into()
            } else {
                match nearest(&parameter.name, names.into_iter().filter(|name| !given.contains(name))) {
                    Some(meant) => format!("did you mean {meant:?}?").into(),
                    None => "it has no effect".into(),
                }
            };
            let message = format!(
                "{} has no parameter \"{} {}\"; {meant}",
                self.title,
                parameter.kind.word(),
                parameter.name
            );
            context.warn(&parameter.place.location(), message);
        }
    }
}
