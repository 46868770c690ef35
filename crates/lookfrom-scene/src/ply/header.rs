//! Parser for PLY headers: format, elements, properties and textures.

use std::collections::HashSet;

use super::body::COLORS;
use crate::error::{Error, Location, Result};
use crate::files::LoadContext;
use crate::model::scan::{Scanner, shown};
use crate::model::tally::Tally;

/// The encoding of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Format {
    Ascii,
    LittleEndian,
    BigEndian,
}

/// Types of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

/// A value, or a list of values after its length.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum PropertyKind {
    One(Scalar),
    List { count: Scalar, item: Scalar },
}

pub(super) struct Property {
    pub(super) name: String,
    pub(super) kind: PropertyKind,
}

pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
    /// The location of its declaration.
    pub(super) at: Location,
}

pub(super) struct Header {
    pub(super) format: Format,
    pub(super) elements: Vec<Element>,
    /// Images named by comments.
    pub(super) textures: Vec<String>,
    /// Whether a single number stands for the three channels of colours.
    pub(super) is_gray: bool,
    /// Whether it is a file of our own ([`MARK`]), and then whether its mesh is one of a solid ([`SOLID`]).
    pub(super) own: Option<bool>,
    /// Length of the header in bytes and lines.
    pub(super) length: usize,
    pub(super) lines: u32,
}

impl Scalar {
    /// Size in binary formats in bytes.
    pub(super) fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    fn named(name: &[u8]) -> Option<Self> {
        Some(match name {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }
}

impl Element {
    /// Minimum length of a row in bytes (in ASCII with the space after each value).
    pub(super) fn least_row(&self, format: Format) -> u64 {
        let least = |property: &Property| match (format, property.kind) {
            (Format::Ascii, _) => 2,
            (_, PropertyKind::One(scalar) | PropertyKind::List { count: scalar, .. }) => scalar.size() as u64,
        };
        self.properties.iter().map(least).sum()
    }

    /// The index of the first property with one of these names.
    pub(super) fn find(&self, names: &[&str]) -> Option<usize> {
        self.properties.iter().position(|property| names.contains(&property.name.as_str()))
    }
}

/// The first word of the comment in files of our own, which hold everything that a mesh has, bit by bit.
pub(super) const MARK: &[u8] = b"lookfrom-mesh";

/// The word after it for the surface of a solid.
pub(super) const SOLID: &[u8] = b"solid";

/// Parses the header.
///
/// # Errors
/// `Syntax` at line and column.
pub(super) fn parse(bytes: &[u8], file: &Location, context: &mut LoadContext<'_>) -> Result<Header> {
    let mut scanner = Scanner::new(bytes);
    if scanner.word() != b"ply" {
        return Err(Error::syntax(file, "not a PLY file: it does not start with `ply`"));
    }
    let mut format = None;
    let mut elements: Vec<Element> = Vec::new();
    let mut names = HashSet::new();
    let mut textures = Vec::new();
    let mut own = None;
    let mut strays = Tally::default();
    loop {
        if !scanner.next_line() {
            let message = "the header does not end: expected `end_header`";
            return Err(Error::syntax(&file.at(scanner.line(), 0), message).hint("the file may be cut off"));
        }
        let keyword = scanner.word();
        let at = scanner.at(file);
        match keyword {
            b"" | b"obj_info" => {}
            b"comment" => match scanner.word() {
                b"TextureFile" => {
                    textures.push(String::from_utf8_lossy(scanner.rest_of_line()).replace('\\', "/"));
                }
                MARK => own = Some(scanner.word() == SOLID),
                _ => {}
            },
            b"format" => {
                let word = scanner.word();
                format = Some(match word {
                    b"ascii" => Format::Ascii,
                    b"binary_little_endian" => Format::LittleEndian,
                    b"binary_big_endian" => Format::BigEndian,
                    other => {
                        let message = format!(
                            "expected `ascii`, `binary_little_endian` or `binary_big_endian`, found `{}`",
                            shown(other)
                        );
                        return Err(Error::syntax(&scanner.at(file), message));
                    }
                });
            }
            b"element" => elements.push(element(&mut scanner, at, file, &mut names)?),
            b"property" => {
                let property = property(&mut scanner, file)?;
                let element = elements
                    .last_mut()
                    .ok_or_else(|| Error::syntax(&at, "found `property` before any `element`"))?;
                element.properties.push(property);
            }
            b"end_header" => break,
            // Some programs write comments without the keyword.
            _ => strays.add(scanner.line()),
        }
    }
    strays.warn("line", "of the header ignored: unknown keyword", file, context);
    let Some(format) = format else {
        return Err(Error::syntax(&file.at(scanner.line(), 0), "the header has no `format` line"));
    };
    // Values start after the line's end, which is the same as that of the first line: a line feed may be part of a value.
    let lone_returns = bytes.get(3) == Some(&b'\r') && bytes.get(4) != Some(&b'\n');
    scanner.rest_of_line();
    let before = scanner.position();
    scanner.next_line();
    let length = if lone_returns { (before + 1).min(bytes.len()) } else { scanner.position() };
    Ok(Header { format, elements, textures, is_gray: false, own, length, lines: scanner.line() })
}

impl Header {
    /// Takes an attribute for the colours: properties `NAME_0`, `NAME_1`, … (as Mitsuba writes them), or one that is called so. Those of
    /// `color` may have the usual names too. False if the element has no such one with one or three channels.
    pub(super) fn take_colors_from(&mut self, element: &str, name: &str) -> bool {
        const CHANNELS: [&str; 3] = ["red", "green", "blue"];
        let numbered = |property: &Property, channel: usize| property.name == format!("{name}_{channel}");
        let count = |of: &Element| {
            (0..4).take_while(|&channel| of.properties.iter().any(|p| numbered(p, channel))).count()
        };
        let numbers = self.elements.iter().find(|of| of.name == element).map_or(0, count);
        for of in &mut self.elements {
            let is_it = of.name == element;
            if is_it && numbers == 0 && name == "color" {
                continue;
            }
            for property in &mut of.properties {
                let channel = (0..numbers).find(|&channel| numbered(property, channel));
                let alone = (numbers == 0 && property.name == name).then_some(0);
                if let Some(channel) = channel.or(alone).filter(|channel| is_it && *channel < 3) {
                    CHANNELS[channel].clone_into(&mut property.name);
                } else if COLORS.iter().any(|names| names.contains(&&*property.name)) {
                    property.name.clear();
                }
            }
        }
        let found = self.elements.iter().find(|of| of.name == element);
        let channels = found.map_or(0, |of| COLORS.iter().filter(|names| of.find(names).is_some()).count());
        self.is_gray = channels == 1;
        matches!(channels, 1 | 3) && numbers < 4
    }
}

fn element(
    scanner: &mut Scanner<'_>,
    at: Location,
    file: &Location,
    names: &mut HashSet<String>,
) -> Result<Element> {
    let name = String::from_utf8_lossy(scanner.word()).into_owned();
    if !names.insert(name.clone()) {
        let message = format!("element `{}` is declared twice", shown(name.as_bytes()));
        return Err(Error::syntax(&scanner.at(file), message));
    }
    let word = scanner.word();
    let count = std::str::from_utf8(word).ok().and_then(|word| word.parse().ok()).ok_or_else(|| {
        let message = format!("expected the number of rows of the element, found `{}`", shown(word));
        Error::syntax(&scanner.at(file), message)
    })?;
    Ok(Element { name, count, properties: Vec::new(), at })
}

fn property(scanner: &mut Scanner<'_>, file: &Location) -> Result<Property> {
    let scalar = |word: &[u8], scanner: &Scanner<'_>| {
        Scalar::named(word).ok_or_else(|| {
            let message = format!("expected a type such as `float` or `uchar`, found `{}`", shown(word));
            Error::syntax(&scanner.at(file), message)
        })
    };
    let word = scanner.word();
    let kind = if word == b"list" {
        let count = scanner.word();
        let count = scalar(count, scanner)?;
        if matches!(count, Scalar::F32 | Scalar::F64) {
            return Err(Error::syntax(&scanner.at(file), "the length of a list must have an integer type"));
        }
        let item = scanner.word();
        PropertyKind::List { count, item: scalar(item, scanner)? }
    } else {
        PropertyKind::One(scalar(word, scanner)?)
    };
    Ok(Property { name: String::from_utf8_lossy(scanner.word()).into_owned(), kind })
}
