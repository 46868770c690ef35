//! Recovery from syntax errors of TOML.
//!
//! After an error (such as a bracket that is not closed) a parser misinterprets the rest. Headers of tables, at the
//! beginnings of lines, are where it can safely restart: each section between two headers is parsed by itself, its first
//! error is reported, and the section is left out.

use ::toml::de::{DeTable, Error as TomlError};

use super::document::Document;
use crate::error::Error;

/// The parser's message for a duplicate key, after which its results are still valid.
const TWICE: &str = "duplicate key";

/// The readable sections of a text with syntax errors.
pub(super) struct Readable {
    /// The text with malformed sections blanked; empty if the other sections are not valid together either.
    pub(super) text: String,
    /// Errors of the malformed sections.
    pub(super) errors: Vec<Error>,
    /// Whether none of the malformed sections defines names.
    pub(super) has_all_names: bool,
}

/// Parses each section of a text with syntax errors.
pub(super) fn readable(document: &Document) -> Readable {
    let (mut errors, mut sound, mut has_all_names) = (Vec::new(), String::new(), true);
    for section in sections(document.text()) {
        let start = sound.len();
        let (_, wrong) = DeTable::parse_recoverable(section.trim_end());
        let is_sound = wrong.is_empty();
        for error in wrong {
            let is_alone = error.message() == TWICE;
            errors.push(told(document, start, &error));
            if !is_alone {
                break;
            }
        }
        if is_sound {
            sound.push_str(section);
        } else {
            has_all_names &= !gives_names(section);
            sound.extend(section.bytes().map(|byte| if byte == b'\n' { '\n' } else { ' ' }));
        }
    }
    // Sections that are not valid together, such as two with the same name.
    let (_, wrong) = DeTable::parse_recoverable(&sound);
    if wrong.is_empty() {
        return Readable { text: sound, errors, has_all_names };
    }
    errors.extend(wrong.iter().map(|error| told(document, 0, error)));
    Readable { text: String::new(), errors, has_all_names: false }
}

/// Whether a section may define names, by itself or by importing files.
fn gives_names(section: &str) -> bool {
    section.lines().map(str::trim_start).any(|line| {
        let is_header = line.starts_with('[');
        is_header
            && ["materials", "media", "textures", "objects", "variables"]
                .iter()
                .any(|word| line.contains(word))
            || line.starts_with("import")
    })
}

fn told(document: &Document, start: usize, error: &TomlError) -> Error {
    let at = document.location(start + error.span().map_or(0, |span| span.start));
    Error::syntax(&at, error.message().replace('\n', "; "))
        .hint("this is not valid TOML; docs/guide/scene-format.md shows how scenes are written")
}

/// The text up to its first header, and from each header to the next.
fn sections(text: &str) -> impl Iterator<Item = &str> {
    let mut starts = vec![0];
    let mut offset = 0;
    for line in text.split_inclusive('\n') {
        if offset > 0 && is_header(line) {
            starts.push(offset);
        }
        offset += line.len();
    }
    let ends = starts.clone().into_iter().skip(1).chain([text.len()]);
    starts.into_iter().zip(ends).map(|(start, end)| &text[start..end])
}

/// Whether a line is `[name]` or `[[name]]`, rather than a nested list.
fn is_header(line: &str) -> bool {
    let line = line.split('#').next().unwrap_or_default().trim();
    let name = line.strip_prefix("[[").and_then(|rest| rest.strip_suffix("]]"));
    let name = name.or_else(|| line.strip_prefix('[')?.strip_suffix(']'));
    name.is_some_and(|name| {
        name.trim().starts_with(|c: char| c.is_alphabetic() || c == '_')
            && name.chars().all(|c| c.is_alphanumeric() || "_-.\"' ".contains(c))
    })
}
