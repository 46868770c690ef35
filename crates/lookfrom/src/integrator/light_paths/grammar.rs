//! The notation of light-path expressions: that of Open Shading Language, without its custom labels.
//!
//! An expression begins with `C`, the camera. Each time that light is scattered is one event, of a side and a kind:
//! `R` reflection or `T` transmission; `D` diffuse, `G` glossy or `S` specular. `<RD>` is diffuse reflection, `<TS>` clear
//! glass; `D` alone is short for `<.D>`, `R` for `<R.>`; `V` is a medium (a volume), which has neither side nor kind. The last event is where the light comes from: `L` a light, `B` the
//! background or an environment, `O` an object that shines and is no light, `A` Whitted's ambient light; `<L.'lamp'>` is the
//! light of a name. `.` is any event, `[…]` one of several, `[^…]` any other; `(…)`, `|`, `*`, `+`, `?`, `{n}`, `{n,}` and
//! `{n,m}` mean what they mean in regular expressions. Blanks do not count. `volume` is short for `CV.*`, what a medium scatters toward the
//! camera; a layer of `transmittance` has no light, but the part of it that media before the first surface let pass.

use std::fmt::Write as _;

use lookfrom_scene::Error;
use lookfrom_scene::settings::LightPathLayer;

use crate::shading::bsdf::lobes::Lobes;

/// Deepest nesting of parentheses.
const DEEPEST: u32 = 50;

/// Largest number of a repetition.
const MOST_TIMES: u32 = 100;

/// Number of events of scattering: two sides of three kinds, and media.
const SCATTERINGS: u32 = 7;

/// Largest number of different names of lights in all expressions of a picture.
const MOST_LABELS: usize = 29;

/// Number of events at the end of a way, by [`Ending`]: without a name, and with each.
const WITH_LABELS: u32 = 1 + MOST_LABELS as u32;

/// The source of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Ending {
    Light,
    Background,
    Object,
    Ambient,
}

/// One event, by its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Symbol(u8);

impl Symbol {
    /// The byte that the automaton reads.
    pub(super) fn byte(self) -> u8 {
        self.0 + 1
    }

    /// Scattering by a medium.
    pub(super) const MEDIUM: Self = Self(6);

    /// Scattering by one lobe.
    pub(super) fn scattering(lobe: Lobes) -> Self {
        let kind = match () {
            () if lobe.is_specular() => 2,
            () if lobe.intersects(Lobes::DIFFUSE) => 0,
            () => 1,
        };
        Self(3 * u8::from(lobe.is_transmission()) + kind)
    }

    /// The end of a way, at a light whose name is one of the labels or none of them.
    pub(super) fn ending(ending: Ending, label: Option<usize>) -> Self {
        let number = SCATTERINGS + ending as u32 * WITH_LABELS + label.map_or(0, |label| label as u32 + 1);
        Self(number as u8)
    }
}

/// A set of symbols, as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Symbols(u128);

impl Symbols {
    const NONE: Self = Self(0);
    const ALL: Self = Self((1 << (SCATTERINGS + 4 * WITH_LABELS)) - 1);
    const SCATTERINGS: Self = Self((1 << SCATTERINGS) - 1);

    fn sides(side: usize) -> Self {
        Self(0b111 << (3 * side))
    }

    fn kinds(kind: usize) -> Self {
        Self(0b1001 << kind)
    }

    /// All ways of one end.
    fn endings(ending: Ending) -> Self {
        Self(((1 << WITH_LABELS) - 1) << (SCATTERINGS + ending as u32 * WITH_LABELS))
    }

    fn one(symbol: Symbol) -> Self {
        Self(1 << symbol.0)
    }

    fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }

    fn others(self) -> Self {
        Self(!self.0 & Self::ALL.0)
    }

    /// The set as a class of bytes.
    fn write(self, pattern: &mut String) {
        pattern.push('[');
        for number in (0..128).filter(|number| self.0 & 1 << number != 0) {
            // Writing to a string does not fail.
            let _ = write!(pattern, "\\x{:02x}", Symbol(number).byte());
        }
        pattern.push(']');
    }
}

/// The names of lights in expressions.
pub(super) type Labels = Vec<String>;

/// A mistake in an expression, and its place: a number of characters from its start.
#[derive(Debug)]
pub(super) struct Fault {
    column: usize,
    message: String,
}

impl Fault {
    /// The error of a layer's expression.
    pub(super) fn of(self, layer: &LightPathLayer) -> Error {
        let Self { column, message } = self;
        let LightPathLayer { name, expression, at } = layer;
        Error::invalid(
            at,
            format!("the light paths of {name:?}: {message} at column {} of {expression:?}", column + 1),
        )
        .hint("C<RD>L is a light on a diffuse surface, C.*L all light of lights: docs/guide/path-tracing.md")
    }
}

/// The name of the light of media, and its expression.
const VOLUME: [&str; 2] = ["volume", "CV.*"];

/// Whether a layer has the transmittance of media.
pub(super) fn is_transmittance(expression: &str) -> bool {
    expression.trim() == "transmittance"
}

/// The regular expression over bytes that an expression means: one that matches no way where that is not one of light.
pub(super) fn pattern(expression: &str, labels: &mut Labels) -> Result<String, Fault> {
    if is_transmittance(expression) {
        return Ok("\\xff".to_owned());
    }
    let expression = if expression.trim() == VOLUME[0] { VOLUME[1] } else { expression };
    let mut parser = Parser { rest: expression, whole: expression, labels, pattern: String::new(), depth: 0 };
    if parser.next() != Some('C') {
        parser.rest = expression;
        return Err(parser.expected("C, the camera,"));
    }
    parser.alternatives()?;
    match parser.peek() {
        None => Ok(parser.pattern),
        Some(_) => Err(parser.expected("an event or the end")),
    }
}

struct Parser<'a, 'b> {
    rest: &'a str,
    whole: &'a str,
    labels: &'b mut Labels,
    pattern: String,
    depth: u32,
}

impl Parser<'_, '_> {
    fn peek(&mut self) -> Option<char> {
        self.rest = self.rest.trim_start();
        self.rest.chars().next()
    }

    fn next(&mut self) -> Option<char> {
        let next = self.peek()?;
        self.rest = &self.rest[next.len_utf8()..];
        Some(next)
    }

    /// Takes a character, if it is the next one.
    fn takes(&mut self, expected: char) -> bool {
        let takes = self.peek() == Some(expected);
        if takes {
            self.next();
        }
        takes
    }

    fn fault(&self, message: String) -> Fault {
        let column = self.whole[..self.whole.len() - self.rest.len()].chars().count();
        Fault { column, message }
    }

    /// The fault that something else is next.
    fn expected(&mut self, what: &str) -> Fault {
        let found = self.peek().map_or("the end".to_owned(), |found| format!("{found:?}"));
        self.fault(format!("expected {what} but found {found}"))
    }

    fn alternatives(&mut self) -> Result<(), Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(self.fault(format!("more than {DEEPEST} parentheses inside of each other")));
        }
        self.pattern.push_str("(?:");
        self.sequence()?;
        while self.takes('|') {
            self.pattern.push('|');
            // Outside of all parentheses each alternative may have its own camera.
            if self.depth == 1 {
                self.takes('C');
            }
            self.sequence()?;
        }
        self.pattern.push(')');
        self.depth -= 1;
        Ok(())
    }

    fn sequence(&mut self) -> Result<(), Fault> {
        while let Some(next) = self.peek()
            && !matches!(next, '|' | ')')
        {
            if self.takes('(') {
                self.alternatives()?;
                if !self.takes(')') {
                    return Err(self.expected("')'"));
                }
            } else {
                let set = self.set()?;
                if set == Symbols::NONE {
                    return Err(self.fault("a set without any event".to_owned()));
                }
                set.write(&mut self.pattern);
            }
            self.repetition()?;
        }
        Ok(())
    }

    fn repetition(&mut self) -> Result<(), Fault> {
        let Some(next @ ('*' | '+' | '?' | '{')) = self.peek() else { return Ok(()) };
        self.next();
        self.pattern.push(next);
        if next != '{' {
            return Ok(());
        }
        let least = self.number()?;
        if self.takes(',') {
            self.pattern.push(',');
            if self.peek() != Some('}') {
                let most = self.number()?;
                if most < least {
                    return Err(self.fault(format!("at least {least} and at most {most} times")));
                }
            }
        }
        if !self.takes('}') {
            return Err(self.expected("'}'"));
        }
        self.pattern.push('}');
        Ok(())
    }

    fn number(&mut self) -> Result<u32, Fault> {
        self.peek();
        let digits = self.rest.len() - self.rest.trim_start_matches(|c: char| c.is_ascii_digit()).len();
        let number = self.rest[..digits].parse().ok().filter(|number| *number <= MOST_TIMES);
        let Some(number) = number else {
            return Err(self.expected(&format!("a number up to {MOST_TIMES}")));
        };
        self.rest = &self.rest[digits..];
        let _ = write!(self.pattern, "{number}");
        Ok(number)
    }

    /// One event: a letter, `.`, `<…>` or `[…]`.
    fn set(&mut self) -> Result<Symbols, Fault> {
        if self.takes('<') {
            return self.event();
        }
        if !self.takes('[') {
            return self.letter();
        }
        let is_negated = self.takes('^');
        let mut set = Symbols::NONE;
        while !self.takes(']') {
            set = set.or(match self.takes('<') {
                true => self.event()?,
                false => self.letter()?,
            });
        }
        Ok(if is_negated { set.others() } else { set })
    }

    fn letter(&mut self) -> Result<Symbols, Fault> {
        let set = match self.peek() {
            Some('.') => Symbols::ALL,
            Some('R') => Symbols::sides(0),
            Some('T') => Symbols::sides(1),
            Some('D') => Symbols::kinds(0),
            Some('G') => Symbols::kinds(1),
            Some('S') => Symbols::kinds(2),
            Some('V') => Symbols::one(Symbol::MEDIUM),
            Some('L') => Symbols::endings(Ending::Light),
            Some('B') => Symbols::endings(Ending::Background),
            Some('O') => Symbols::endings(Ending::Object),
            Some('A') => Symbols::endings(Ending::Ambient),
            _ => return Err(self.expected("an event: one of D G S R T V L B O A . < [ (")),
        };
        self.next();
        Ok(set)
    }

    /// The rest of `<side kind>`, or of `<end . 'name'>`.
    fn event(&mut self) -> Result<Symbols, Fault> {
        let first = self.part()?;
        let mut set = first;
        if !matches!(self.peek(), Some('>' | '\'')) {
            let second = self.part()?;
            // A dot stands for any kind of scattering, and for any light.
            set = if second == Symbols::ALL { first } else { first.and(second) };
            if first == Symbols::ALL && second == Symbols::ALL {
                set = Symbols::SCATTERINGS;
            }
        }
        if self.takes('\'') {
            let Some(end) = self.rest.find('\'') else { return Err(self.expected("a name and '")) };
            let name = self.rest[..end].to_owned();
            let label = self.label(name)?;
            self.rest = &self.rest[end + 1..];
            let named = [Ending::Light, Ending::Background]
                .map(|ending| Symbols::one(Symbol::ending(ending, Some(label))));
            set = set.and(named[0].or(named[1]));
        }
        match self.takes('>') {
            true => Ok(set),
            false => Err(self.expected("'>'")),
        }
    }

    /// A letter or a set of letters, within `<…>`.
    fn part(&mut self) -> Result<Symbols, Fault> {
        if !self.takes('[') {
            return self.letter();
        }
        let is_negated = self.takes('^');
        let mut set = Symbols::NONE;
        while !self.takes(']') {
            set = set.or(self.letter()?);
        }
        Ok(if is_negated { set.others() } else { set })
    }

    /// The number of a light's name among the labels.
    fn label(&mut self, name: String) -> Result<usize, Fault> {
        if let Some(known) = self.labels.iter().position(|known| *known == name) {
            return Ok(known);
        }
        if self.labels.len() == MOST_LABELS {
            return Err(self.fault(format!("more than {MOST_LABELS} names of lights")));
        }
        self.labels.push(name);
        Ok(self.labels.len() - 1)
    }
}
